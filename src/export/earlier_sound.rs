//! The sound of earlier moments, on which an image depends in a scene with feedback.

use super::error::ExportError;
use super::song_features::SongFeatures;
use mariana_music::Sound;

/// Decoded sound stays available for this time, in seconds.
const KEPT: f64 = 3.0;

pub(super) struct EarlierSound {
    song: SongFeatures,
    /// The song opened at an earlier moment, and the time of the last request.
    opened: Option<(SongFeatures, f64)>,
}

impl EarlierSound {
    /// Takes what is known of `song`.
    ///
    /// # Errors
    /// Fails if the song cannot be decoded.
    pub(super) fn of(song: &SongFeatures) -> Result<Self, ExportError> {
        Ok(Self { song: song.beside(0.0)?, opened: None })
    }

    /// Returns the sound at `time` seconds; silence after the end of the song. Times should rise, apart from jumps.
    pub(super) fn at(&mut self, time: f64) -> Result<Sound, ExportError> {
        let known = self.opened.take().filter(|(_, last)| (last - KEPT..last + KEPT).contains(&time));
        let mut song = match known {
            Some((song, _)) => song,
            None => self.song.beside(time)?,
        };
        let sound = song.sound_at(time)?.unwrap_or_default();
        self.opened = Some((song, time));
        Ok(sound)
    }
}
