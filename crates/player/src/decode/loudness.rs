//! Loudness tags of files. ReplayGain 2.0 stores the gain in decibels that brings a track to -18 LUFS (EBU R128);
//! Opus files store `R128_TRACK_GAIN`, an integer of 1/256 dB towards -23 LUFS (RFC 7845, 5.2.1).
//!
//! **The gain applies only to the analysis.** Live and offline, a track's frames are multiplied by one factor before
//! they are analysed, to bring the track to -14 LUFS. Tracks without a tag have the factor 1. Playback stays unchanged,
//! because listeners have a volume control, and a gain above 1 could clip.

/// Tagged tracks are scaled to this loudness for scenes. Streaming services use it too, so untagged music is close.
const SCENE_LUFS: f64 = -14.0;
const REPLAY_GAIN_LUFS: f64 = -18.0;
const R128_LUFS: f64 = -23.0;

/// Accepted gains, in decibels. The ReplayGain specification mentions -51 dB as the lowest and +64 dB as the highest
/// gain, but no music needs such a gain.
const GAIN_DB: std::ops::RangeInclusive<f64> = -40.0..=40.0;

/// The gains in a file's tags, in decibels towards -18 LUFS.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub(crate) struct Loudness {
    track: Option<f64>,
    album: Option<f64>,
}

impl Loudness {
    pub(crate) fn replay_gain(&mut self, of_album: bool, text: &str) {
        let number = text.trim().trim_end_matches(['d', 'D', 'b', 'B']).trim_end();
        self.set(of_album, number.parse().ok());
    }

    pub(crate) fn r128(&mut self, of_album: bool, text: &str) {
        let towards_r128 = text.trim().parse::<i32>().ok().map(|q7_8| f64::from(q7_8) / 256.0);
        self.set(of_album, towards_r128.map(|db| db + REPLAY_GAIN_LUFS - R128_LUFS));
    }

    fn set(&mut self, of_album: bool, db: Option<f64>) {
        // NaN is in no range.
        let Some(db) = db.filter(|db| GAIN_DB.contains(db)) else { return };
        *(if of_album { &mut self.album } else { &mut self.track }) = Some(db);
    }

    pub(crate) fn scene_gain(self) -> f32 {
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
            // As an Opus tag, the same gain is 5 dB less, because the tag is relative to -23 LUFS.
            (&[("r128", "-2304")], 0.0),
        ] {
            let found = 20.0 * gain(tags).log10();
            assert!((found - db).abs() < 1e-4, "{tags:?}: {found} dB");
        }
    }

    #[test]
    fn implausible_gains_are_ignored() {
        for text in ["", "dB", "NaN dB", "inf", "-1e9 dB", "64.1 dB", "1 2 dB", "٣ dB"] {
            assert_eq!(gain(&[("track", text)]), 1.0, "{text}");
        }
        assert_eq!(gain(&[("r128", "99999999999999")]), 1.0);
    }
}
