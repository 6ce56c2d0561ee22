//! Title, artist and length of a file, from its headers.

use super::error::DecodeError;
use super::input::Input;
use super::packets::PacketReader;

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

pub(super) fn of(input: &Input) -> Result<TrackTags, DecodeError> {
    let mut reader = PacketReader::open(input, None)?;
    let duration = reader.claimed_rate().and_then(|rate| reader.length(rate).1);
    let tags = reader.tags();
    let filled = |text: Option<String>| text.filter(|text| !text.is_empty());
    Ok(TrackTags { title: filled(tags.title), artist: filled(tags.artist), duration })
}
