//! Motion blur: a frame is the mean of several exposures, in linear light, during the time that the shutter is open.

use super::error::ExportError;
use super::show_painter::Heard;
use super::song_features::SongFeatures;
use mariana_music::Sound;

/// A camera's shutter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shutter {
    /// The part of a frame's time during which the shutter is open: 360 is the whole time, 0 is a moment.
    pub degrees: f64,
    /// The number of exposures in this time.
    pub exposures: u32,
}

impl Shutter {
    /// A shutter without motion blur.
    pub const MOMENT: Self = Self { degrees: 0.0, exposures: Self::EXPOSURES };
    /// The default number of exposures.
    pub const EXPOSURES: u32 = 8;

    /// Returns the exposures of a frame, which is shown for `seconds`: moments around its time, and their sounds.
    pub(super) fn exposures(
        &self,
        song: &mut SongFeatures,
        time: f64,
        sound: Sound,
        seconds: f64,
    ) -> Result<Vec<Heard>, ExportError> {
        if self.degrees <= 0.0 {
            return Ok(vec![(time, sound)]);
        }
        let count = f64::from(self.exposures);
        let moment = |number: u32| {
            let offset = (f64::from(number) + 0.5) / count - 0.5;
            let then = (time + offset * seconds * self.degrees / 360.0).max(0.0);
            // Moments after the song's end have the sound of the frame's time.
            let heard = song.sound_at(then)?.unwrap_or_else(|| sound.clone());
            Ok((then, heard))
        };
        (0..self.exposures).map(moment).collect()
    }
}
