//! The parts of the current song, read from its stems while a scene needs them.

use std::sync::Arc;

use crate::song_structures::SongReader;
use crate::stems::Parts;
use mariana_player::track::TrackInfo;

/// The parts of the current track.
pub(super) struct HeardParts {
    pub(super) reader: SongReader<Parts>,
    pub(crate) wanted: bool,
    /// The last track whose parts were found.
    pub(super) found: Option<u64>,
}

impl HeardParts {
    /// Requests the parts of these tracks, the current one first, if a scene needs them.
    pub(super) fn request<'a>(&self, tracks: impl IntoIterator<Item = &'a Arc<TrackInfo>>) {
        if self.wanted {
            self.reader.request(tracks);
        }
    }

    /// Returns the parts of a track once, when they become known or the track becomes the current one.
    pub(super) fn arrived(&mut self, track: u64) -> Option<Arc<Parts>> {
        if self.found == Some(track) {
            return None;
        }
        let parts = self.reader.get(track).filter(|parts| parts.are_complete)?;
        self.found = Some(track);
        Some(parts)
    }

    /// Returns the numbers of the parts at a time of a track in seconds; none, or zeros, while they are unknown.
    pub(super) fn at(&self, track: u64, time: f64) -> Vec<f32> {
        let parts = if self.wanted { self.reader.get(track) } else { None };
        parts.map(|parts| parts.tracks.at(time)).unwrap_or_default()
    }
}
