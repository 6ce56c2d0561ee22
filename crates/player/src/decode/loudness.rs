//! How loud a file says it is.
//!
//! ReplayGain 2.0 gives the gain in decibels that brings a track to -18 LUFS (EBU R128); Opus files give it as
//! `R128_TRACK_GAIN`, a whole number of 1/256 dB towards -23 LUFS (RFC 7845, 5.2.1). Either becomes one factor.
//!
//! **Loudness is the scene's alone.** A track's ReplayGain (or R128) tag multiplies its frames before they are
//! analysed, towards -14 LUFS, by the same function live and offline. A tag is known before the first frame, which a
//! measured loudness would not be; tracks without a tag are left to the analysis. The sound stays as it was mastered,
//! because listeners have a volume control for it, a scene has none, and a gain above 1 could clip.

/// The loudness in LUFS at which tagged tracks drive scenes as untagged music does: streaming services normalise to
/// it.
const SCENE_LUFS: f64 = -14.0;
const REPLAY_GAIN_LUFS: f64 = -18.0;
const R128_LUFS: f64 = -23.0;

/// Gains beyond these, in decibels, are not believed. ReplayGain's own text mentions -51 dB as the lowest and +64 dB
/// as the highest, but no music is that far off.
const GAIN_DB: std::ops::RangeInclusive<f64> = -40.0..=40.0;

/// The gains that a file gives, in decibels towards -18 LUFS.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub(super) struct Loudness {
    track: Option<f64>,
    album: Option<f64>,
}

impl Loudness {
    /// Takes a tag of ReplayGain: "-7.35 dB".
    pub(super) fn replay_gain(&mut self, of_album: bool, text: &str) {
        let number = text.trim().trim_end_matches(['d', 'D', 'b', 'B']).trim_end();
        self.set(of_album, number.parse().ok());
    }

    /// Takes a tag of an Opus file: "-1882".
    pub(super) fn r128(&mut self, of_album: bool, text: &str) {
        let towards_r128 = text.trim().parse::<i32>().ok().map(|q7_8| f64::from(q7_8) / 256.0);
        self.set(of_album, towards_r128.map(|db| db + REPLAY_GAIN_LUFS - R128_LUFS));
    }

    fn set(&mut self, of_album: bool, db: Option<f64>) {
        // A value that is not a number is in no range.
        let Some(db) = db.filter(|db| GAIN_DB.contains(db)) else { return };
        *(if of_album { &mut self.album } else { &mut self.track }) = Some(db);
    }

    /// The factor for samples so that this track drives a scene like every other; 1 without a tag.
    pub(super) fn scene_gain(self) -> f32 {
        let towards_scene = self.track.or(self.album).map(|db| db + SCENE_LUFS - REPLAY_GAIN_LUFS);
        towards_scene.map_or(1.0, |db| 10_f64.powf(db / 20.0) as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gain(tags: &[(&str, &str)]) -> f32 {
        let mut loudness = Loudness::default();
        for (kind, text) in tags {
            match *kind {
                "track" => loudness.replay_gain(false, text),
                "album" => loudness.replay_gain(true, text),
                _ => loudness.r128(false, text),
            }
        }
        loudness.scene_gain()
    }

    #[test]
    fn gains_become_factors_towards_the_scenes_loudness() {
        for (tags, db) in [
            (&[("track", "-4.00 dB")][..], 0.0),
            (&[("album", "+2.0 dB"), ("track", " -24 db ")], -20.0),
            (&[("album", "2")], 6.0),
            // The same loudness in the form of Opus: 5 dB less, towards -23 LUFS.
            (&[("r128", "-2304")], 0.0),
        ] {
            let found = 20.0 * gain(tags).log10();
            assert!((found - db).abs() < 1e-4, "{tags:?}: {found} dB");
        }
    }

    #[test]
    fn absurd_gains_are_not_believed() {
        for text in ["", "dB", "NaN dB", "inf", "-1e9 dB", "64.1 dB", "1 2 dB", "٣ dB"] {
            assert_eq!(gain(&[("track", text)]), 1.0, "{text}");
        }
        assert_eq!(gain(&[("r128", "99999999999999")]), 1.0);
    }
}
