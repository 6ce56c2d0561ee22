//! Cover images in music files.

use symphonia::core::meta::{StandardVisualKey, Visual};

use super::error::DecodeError;
use super::input::{Input, TagBytes};
use crate::limits::LIMITS;

/// A cover image as stored in the file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Cover {
    /// The encoding.
    pub kind: CoverKind,
    /// The encoded bytes.
    pub bytes: Vec<u8>,
}

/// The supported encodings of covers, recognised by their first bytes. Covers in any other encoding are ignored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CoverKind {
    /// JPEG.
    Jpeg,
    /// PNG.
    Png,
    /// WebP.
    WebP,
    /// BMP.
    Bmp,
}

impl Cover {
    fn of(visual: &Visual) -> Option<Self> {
        Self::from_bytes(visual.data.to_vec())
    }

    /// Recognizes the encoding of an image. Returns `None` for other encodings, and for images over the limit.
    pub(crate) fn from_bytes(bytes: Vec<u8>) -> Option<Self> {
        let kind = match &bytes[..] {
            [0xff, 0xd8, 0xff, ..] => CoverKind::Jpeg,
            [0x89, b'P', b'N', b'G', ..] => CoverKind::Png,
            [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => CoverKind::WebP,
            [b'B', b'M', ..] => CoverKind::Bmp,
            _ => return None,
        };
        (bytes.len() <= LIMITS.cover_bytes_max).then_some(Self { kind, bytes })
    }
}

pub(super) fn of(input: &Input) -> Result<Option<Cover>, DecodeError> {
    // Comments hold covers in base64, so the text limit is twice the cover limit.
    let limits = TagBytes { text: 2 * LIMITS.cover_bytes_max, picture: LIMITS.cover_bytes_max };
    let mut opened = input.open_with(limits)?;
    let mut metadata = opened.format.metadata();
    let mut first = None;
    loop {
        let visuals = metadata.current().into_iter().flat_map(|revision| {
            let of_tracks = revision.per_track.iter().flat_map(|track| &track.metadata.visuals);
            revision.media.visuals.iter().chain(of_tracks)
        });
        for visual in visuals {
            let cover = Cover::of(visual);
            if cover.is_some() && visual.usage == Some(StandardVisualKey::FrontCover) {
                return Ok(cover);
            }
            first = first.or(cover);
        }
        if metadata.pop().is_none() {
            return Ok(first);
        }
    }
}
