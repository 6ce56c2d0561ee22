//! The tags, the length and the cover image of a file, from its headers.

use std::path::Path;

use symphonia::core::meta::StandardVisualKey;

use super::error::DecodeError;
use super::input::MediaInput;
use super::packets::PacketReader;
use crate::limits;

/// The data about a file that lists show.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TrackTags {
    /// Title on one line, if the file has one.
    pub title: Option<String>,
    /// Artist on one line, if the file has one.
    pub artist: Option<String>,
    /// Length in seconds, as the container claims it. The delay of some encoders is included.
    pub duration: Option<f64>,
}

/// Reads the tags and the length of a file from its headers, without decoding sound.
///
/// # Errors
/// Fails if the file cannot be read, or if only ffmpeg can read it: starting ffmpeg for each file of a list is slow.
pub fn tags_of(path: &Path) -> Result<TrackTags, DecodeError> {
    let input = MediaInput::file(path)?;
    let mut reader = PacketReader::open(&input, None).map_err(|problem| problem.of(&input.name))?;
    let duration = reader.claimed_rate().and_then(|rate| reader.length(rate).1);
    let tags = reader.tags();
    let filled = |text: Option<String>| text.filter(|text| !text.is_empty());
    Ok(TrackTags { title: filled(tags.title), artist: filled(tags.artist), duration })
}

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
    /// Recognizes the encoding of an image. Returns `None` for other encodings, and for images over the limit.
    pub(crate) fn from_bytes(bytes: Vec<u8>) -> Option<Self> {
        let kind = match &bytes[..] {
            [0xff, 0xd8, 0xff, ..] => CoverKind::Jpeg,
            [0x89, b'P', b'N', b'G', ..] => CoverKind::Png,
            [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => CoverKind::WebP,
            [b'B', b'M', ..] => CoverKind::Bmp,
            _ => return None,
        };
        (bytes.len() <= limits::COVER_BYTES_MAX).then_some(Self { kind, bytes })
    }
}

pub(super) fn cover_of(input: &MediaInput) -> Result<Option<Cover>, DecodeError> {
    let mut opened = input.open(limits::COVER_BYTES_MAX).map_err(|problem| problem.of(&input.name))?;
    let mut metadata = opened.format.metadata();
    let mut first = None;
    loop {
        let visuals = metadata.current().into_iter().flat_map(|revision| {
            let of_tracks = revision.per_track.iter().flat_map(|track| &track.metadata.visuals);
            revision.media.visuals.iter().chain(of_tracks)
        });
        for visual in visuals {
            let cover = Cover::from_bytes(visual.data.to_vec());
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
