//! Three lengths of window: a long one separates low tones, a short one locates high sounds in time.
//!
//! **Three windows.** 16 hops separate the tones of the bass, 2 hops locate a high sound in time, 4 hops are in
//! between. Where one window hands over to the next they are cross-faded by a raised cosine over frequency, so that a
//! tone keeps its level wherever it lies. The long window is computed at an eighth of the rate, for a tenth of the
//! work. Live input has no future, so its windows end at the newest sample (`Alignment::Trailing`) and nothing is
//! waited for.

/// One of the three windows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Resolution {
    /// 16 hops, 171 ms at 48 kHz, bins of 5.9 Hz: the bass.
    Long,
    /// 4 hops, 43 ms, bins of 23 Hz: voices and most instruments.
    Middle,
    /// 2 hops, 21 ms, bins of 47 Hz: the treble, and onsets.
    Short,
}

/// Between these frequencies, in hertz, the middle window takes over from the long one.
const LONG_TO_MIDDLE: (f64, f64) = (200.0, 500.0);

/// The same from the middle to the short one.
const MIDDLE_TO_SHORT: (f64, f64) = (2_000.0, 5_000.0);

impl Resolution {
    /// All, the longest first.
    pub(super) const ALL: [Self; 3] = [Self::Long, Self::Middle, Self::Short];

    /// Length of the window in hops.
    pub(super) const fn hops(self) -> usize {
        match self {
            Self::Long => 16,
            Self::Middle => 4,
            Self::Short => 2,
        }
    }

    /// The share of the power at `hz` that is taken from this window, 0..1; the three shares sum to 1.
    ///
    /// Neighbouring windows are cross-faded by a raised cosine, over a range many times as wide as the wider of the
    /// two main lobes. Within one lobe the share is then nearly a straight line, so that a tone reads its power
    /// wherever it lies: at most 0.04 dB are lost. With a sharp border a tone next to it would lose the part of its
    /// lobes beyond.
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
    fn shares_are_one_in_sum_and_each_window_has_its_range() {
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
