//! Counts beats, for sines that take several beats.

const BEATS_IN_BAR: f64 = 4.0;

/// A position in beats. Once the song's bars are known, a multiple of four is the first beat of a bar.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct BeatCount {
    whole: f64,
    phase: f32,
}

impl BeatCount {
    /// Notes the position in the beat, 0..1, and the beat's number in its bar, from 1; 0 while unknown.
    pub(super) fn record(&mut self, phase: f32, beat_in_bar: f32) {
        let phase = if phase.is_finite() { phase.clamp(0.0, 1.0) } else { 0.0 };
        if phase < self.phase - 0.5 {
            self.whole += 1.0;
        } else if phase > self.phase + 0.5 {
            self.whole -= 1.0;
        }
        if beat_in_bar >= 1.0 {
            let off = (f64::from(beat_in_bar) - 1.0 - self.whole).rem_euclid(BEATS_IN_BAR);
            self.whole += if off > 0.5 * BEATS_IN_BAR { off - BEATS_IN_BAR } else { off };
        }
        self.phase = phase;
    }

    pub(super) fn beats(&self) -> f64 {
        self.whole + f64::from(self.phase)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn beats_are_counted_and_aligned_with_bars() {
        let mut count = BeatCount::default();
        for (phase, beats) in
            [(0.2, 0.2), (0.6, 0.6), (0.9, 0.9), (0.1, 1.1), (0.6, 1.6), (0.05, 2.05), (0.95, 1.95)]
        {
            count.record(phase, 0.0);
            assert!((count.beats() - beats).abs() < 1e-6, "{count:?}, not {beats}");
        }
        count.record(0.5, 1.0);
        assert!((count.beats() - 0.5).abs() < 1e-6, "the nearest first beat: {count:?}");
        count.record(f32::NAN, 4.0);
        assert_eq!(count.beats(), -1.0);
    }
}
