//! A song: a file or a track embedded in the program.

use std::fs::{self, File};
use std::io::{self, Read as _};
use std::path::PathBuf;

use super::decode::{DecodeError, Decoder};
pub use super::one_line::one_line;

const PIECE_BYTES: usize = 1 << 16;

/// A song that can be opened any number of times.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Song {
    /// A track embedded in the program.
    Embedded {
        /// The name that the track would have as a file.
        name: &'static str,
        /// The encoded bytes.
        bytes: &'static [u8],
    },
    /// The path of a file.
    File(PathBuf),
}

impl Song {
    /// Opens the song for decoding from its start.
    pub fn open(&self) -> Result<Decoder, DecodeError> {
        match self {
            Song::Embedded { name, bytes } => Decoder::from_bytes(name, bytes),
            Song::File(path) => Decoder::open(path),
        }
    }

    /// Passes the encoded bytes to `take`, piece by piece, until `take` returns false.
    ///
    /// # Errors
    /// Fails if the file cannot be read or is no regular file. A pipe is refused, because opening it would wait for its
    /// writer and consume its data.
    pub fn read(&self, mut take: impl FnMut(&[u8]) -> bool) -> io::Result<()> {
        match self {
            Song::Embedded { bytes, .. } => {
                take(bytes);
            }
            Song::File(path) => {
                if !fs::metadata(path)?.is_file() {
                    return Err(io::ErrorKind::InvalidInput.into());
                }
                let (mut file, mut piece) = (File::open(path)?, vec![0; PIECE_BYTES]);
                loop {
                    let count = file.read(&mut piece)?;
                    if count == 0 || !take(piece.get(..count).unwrap_or_default()) {
                        break;
                    }
                }
            }
        }
        Ok(())
    }
}

/// The display name of a song: artist and title if the file has tags, otherwise the file name.
pub fn display_name(decoder: &Decoder) -> String {
    let info = decoder.info();
    track_name(info.artist.as_deref(), info.title.as_deref(), &info.name)
}

pub(super) fn track_name(artist: Option<&str>, title: Option<&str>, file: &str) -> String {
    let tag = |tag: Option<&str>| tag.map(one_line).filter(|tag| !tag.is_empty());
    match (tag(artist), tag(title)) {
        (Some(artist), Some(title)) => format!("{artist} - {title}"),
        (None, Some(title)) => title,
        _ => one_line(file),
    }
}
