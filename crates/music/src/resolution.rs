//! Three window lengths: 16 hops separate the tones of the bass, 2 hops locate a high sound in time, and 4 hops are in
//! between. Adjacent windows are cross-faded over frequency. The long window is computed at an eighth of the sample
//! rate, which takes a tenth of the work. For live input the windows end at the newest sample, so they add no delay.

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Resolution {
    /// 16 hops, 171 ms at 48 kHz, bins of 5.9 Hz: the bass.
    Long,
    /// 4 hops, 43 ms, bins of 23 Hz: voices and most instruments.
    Middle,
    /// 2 hops, 21 ms, bins of 47 Hz: the treble, and onsets.
    Short,
}

/// The crossover ranges between adjacent windows, in hertz.
const LONG_TO_MIDDLE: (f64, f64) = (200.0, 500.0);
const MIDDLE_TO_SHORT: (f64, f64) = (2_000.0, 5_000.0);

impl Resolution {
    pub(super) const ALL: [Self; 3] = [Self::Long, Self::Middle, Self::Short];

    pub(super) const fn hops(self) -> usize {
        match self {
            Self::Long => 16,
            Self::Middle => 4,
            Self::Short => 2,
        }
    }

    /// Returns the fraction of the power at `hz` that is taken from this window, 0..1. The fractions of the three
    /// windows sum to 1. The cross-fade is a raised cosine, many times wider than a main lobe, so a tone loses at most
    /// 0.04 dB. A sharp border would cut off part of a nearby tone's lobes.
    pub(super) fn fraction(self, hz: f64) -> f64 {
        let passed = |(low, high): (f64, f64)| {
            let way = ((hz - low) / (high - low)).clamp(0.0, 1.0);
            0.5 - 0.5 * (std::f64::consts::PI * way).cos()
        };
        let (middle, short) = (passed(LONG_TO_MIDDLE), passed(MIDDLE_TO_SHORT));
        match self {
            Self::Long => 1.0 - middle,
            Self::Middle => middle - short,
            Self::Short => short,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fractions_sum_to_one_and_each_window_has_its_range() {
        for hz in (0..2_400).map(|step| f64::from(step) * 10.0) {
            let fractions = Resolution::ALL.map(|resolution| resolution.fraction(hz));
            assert!((fractions.iter().sum::<f64>() - 1.0).abs() < 1e-12, "{fractions:?} at {hz} Hz");
            assert!(
                fractions.iter().all(|fraction| (0.0..=1.0).contains(fraction)),
                "{fractions:?} at {hz} Hz"
            );
        }
        for (resolution, hz) in Resolution::ALL.into_iter().zip([100.0, 1_000.0, 8_000.0]) {
            assert_eq!(resolution.fraction(hz), 1.0, "{resolution:?}");
        }
    }
}
