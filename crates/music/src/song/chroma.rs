//! Chroma: the peaks of a spectrum, folded into the twelve pitch classes and corrected for the tuning.

/// Thirds of semitones in an octave.
pub(super) const FINE_BINS: usize = 36;

/// The range in hertz. Below the range the window cannot separate semitones; above it, partials outweigh fundamentals.
const RANGE_HZ: (f64, f64) = (58.0, 1_600.0);

/// The minimum power of a peak relative to the mean power of the bins around the peak. Drums have no such peaks.
const PEAK_OVER_MEAN: f32 = 3.0;
/// The mean around a peak is taken over this many bins on each side of the peak.
const SURROUNDINGS: usize = 9;

/// Peaks below this power (-80 dB) are not pitches.
const POWER_MIN: f32 = 1e-8;

/// The tuning of the instruments relative to a' = 440 Hz.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Tuning {
    /// In semitones, -0.5..0.5.
    pub(super) semitones: f64,
}

impl Tuning {
    /// Folds fine bins into the twelve pitch classes, C first.
    pub(super) fn pitch_classes(self, fine: &[f32; FINE_BINS]) -> [f32; 12] {
        let mut classes = [0.0; 12];
        for (bin, amplitude) in fine.iter().enumerate() {
            let class = (bin as f64 / 3.0 - self.semitones).round() as i64;
            classes[class.rem_euclid(12) as usize] += amplitude;
        }
        classes
    }
}

pub(super) struct FineChroma {
    bin_hz: f64,
    first: usize,
    end: usize,
    /// The vector sum of amplitudes, each rotated by its pitch's distance from a semitone (Mauch 2010, section 3.2.3).
    turned: (f64, f64),
}

impl FineChroma {
    pub(super) fn new(bin_hz: f64, bins: usize) -> Self {
        let bin = |hz: f64| (hz / bin_hz) as usize;
        Self {
            bin_hz,
            first: bin(RANGE_HZ.0).max(1),
            end: bin(RANGE_HZ.1).min(bins.saturating_sub(SURROUNDINGS + 1)),
            turned: (0.0, 0.0),
        }
    }

    pub(super) fn tuning(&self) -> Tuning {
        let (sine, cosine) = self.turned;
        Tuning { semitones: sine.atan2(cosine) / std::f64::consts::TAU }
    }

    /// Returns the amplitudes of the peaks, folded into one octave in thirds of semitones; the middle third of C is
    /// first. A peak's frequency is the vertex of a parabola through the logarithms of three bins (Smith and Serra
    /// 1987).
    pub(super) fn chroma(&mut self, power: &[f32]) -> [f32; FINE_BINS] {
        let mut chroma = [0.0; FINE_BINS];
        let mut bin = self.first;
        while bin < self.end {
            let [left, here, right] = [power[bin - 1], power[bin], power[bin + 1]];
            if here < POWER_MIN || here < left || here <= right {
                bin += 1;
                continue;
            }
            let around = &power[bin.saturating_sub(SURROUNDINGS)..=bin + SURROUNDINGS];
            let mean = around.iter().sum::<f32>() / around.len() as f32;
            if here < PEAK_OVER_MEAN * mean {
                bin += 1;
                continue;
            }
            let [l, h, r] = [left, here, right].map(|p| f64::from(p.max(1e-20)).ln());
            let bend = l - 2.0 * h + r;
            let offset = if bend < 0.0 { (0.5 * (l - r) / bend).clamp(-0.5, 0.5) } else { 0.0 };
            let hz = (bin as f64 + offset) * self.bin_hz;
            let pitch = 12.0 * (hz / 440.0).log2() + 69.0;
            // Compress the amplitude, so that loud partials do not drown out the rest of a chord.
            let amplitude = here.powf(0.35);
            let fine = (pitch * 3.0).round() as i64;
            chroma[fine.rem_euclid(FINE_BINS as i64) as usize] += amplitude;
            // Below 150 Hz the window is too short to measure the tuning.
            if hz > 150.0 {
                let (sine, cosine) = (pitch * std::f64::consts::TAU).sin_cos();
                self.turned.0 += f64::from(amplitude) * sine;
                self.turned.1 += f64::from(amplitude) * cosine;
            }
            bin += 2;
        }
        chroma
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pitch_classes_follow_the_tuning() {
        let mut fine = [0.0; FINE_BINS];
        // The fine bin of an A that is a third of a semitone sharp.
        fine[28] = 1.0;
        let at = |semitones| Tuning { semitones }.pitch_classes(&fine)[9];
        assert_eq!((at(0.0), at(1.0 / 3.0), at(-0.4)), (1.0, 1.0, 0.0));
    }
}
