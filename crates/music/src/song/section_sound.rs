//! How a section of a song sounds: onset density, brightness and percussion.

use serde::{Deserialize, Serialize};

use super::heard::{Heard, SLOW_HOPS, TIMBRE_BANDS};
use super::units::units;

/// How a section sounds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize)]
pub struct SectionSound {
    /// Onsets per second, 0 and more.
    pub onsets: f32,
    /// The mean position on a logarithmic scale from 30 Hz to 16 kHz (0..1), weighted by amplitude (spectral centroid).
    /// Frequencies below 500 Hz count as lower than they are, because the bands there are coarse.
    pub brightness: f32,
    /// The share of percussion: how much the spectral flux exceeds the flux of noise, on average; 0 and more. Strings
    /// have about 0.02, fast drums 0.1. The flux is relative to the loudest recent sound, so the level does not count.
    pub percussive: f32,
}

/// Measures the sound from `start` to `end`, in seconds. In silence all values are 0.
pub(super) fn section_sound(heard: &Heard, start: f64, end: f64) -> SectionSound {
    let place = |time: f64, step: f64, count: usize| ((time / step).round().max(0.0) as usize).min(count);
    let range = |step: f64, count: usize| place(start, step, count)..place(end, step, count);
    let moments = heard.moments.get(range(heard.hop_seconds, heard.moments.len())).unwrap_or_default();
    let slow_seconds = heard.hop_seconds * SLOW_HOPS as f64;
    let slow = heard.slow.get(range(slow_seconds, heard.slow.len())).unwrap_or_default();
    let seconds = (moments.len() as f64 * heard.hop_seconds) as f32;
    let onsets = moments.iter().filter(|moment| moment.begins).count() as f32;
    let (mut all, mut weighted) = (0.0_f32, 0.0_f32);
    for (band, power) in slow.iter().flat_map(|moment| moment.timbre.iter().enumerate()) {
        let amplitude = power.max(0.0).sqrt();
        all += amplitude;
        weighted += amplitude * band as f32 / (TIMBRE_BANDS - 1) as f32;
    }
    SectionSound {
        onsets: if seconds > 0.0 { onsets / seconds } else { 0.0 },
        brightness: if all > 0.0 { weighted / all } else { 0.0 },
        percussive: units(heard, &[start, end]).first().map_or(0.0, |unit| unit.onsets),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{SongListener, StereoFrame};

    const RATE: u32 = 48_000;

    /// Returns the sound of the middle section of ten seconds, where `sample` returns the sample at a time.
    fn sound(sample: impl Fn(f64) -> f64) -> SectionSound {
        let frames: Vec<StereoFrame> = (0..10 * RATE)
            .map(|n| {
                let sample = sample(f64::from(n) / f64::from(RATE)) as f32;
                [sample; 2]
            })
            .collect();
        let mut listener = SongListener::new(RATE);
        listener.push(&frames);
        let structure = listener.finish();
        assert_eq!(structure.sounds.len(), structure.sections.len());
        structure.sounds.get(structure.sounds.len() / 2).copied().unwrap_or_default()
    }

    fn tone(hz: f64, time: f64) -> f64 {
        0.3 * (std::f64::consts::TAU * hz * time).sin()
    }

    #[test]
    fn hits_are_counted_and_percussive() {
        let hit = |time: f64| (-40.0 * (4.0 * time).fract() / 4.0).exp() * tone(2_000.0, time);
        let (hits, held) = (sound(hit), sound(|time| tone(2_000.0, time)));
        assert!((hits.onsets - 4.0).abs() < 0.5, "{hits:?}");
        assert!(held.onsets < 0.5, "{held:?}");
        assert!(hits.percussive > 0.04 && held.percussive < 0.005, "{hits:?} {held:?}");
    }

    #[test]
    fn high_tones_are_bright() {
        let octaves = (16_000.0_f64 / 30.0).log2();
        for hz in [700.0_f64, 2_000.0, 6_000.0] {
            let place = (hz / 30.0).log2() / octaves;
            let found = sound(|time| tone(hz, time)).brightness;
            assert!((f64::from(found) - place).abs() < 0.08, "{hz} Hz: {found}, not {place}");
        }
        assert_eq!(sound(|_| 0.0), SectionSound::default());
    }
}
