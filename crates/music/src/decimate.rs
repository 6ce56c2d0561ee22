//! Decimation of the stream for low frequencies: a long window with few samples.

use super::StereoFrame;

/// The number of frames per hop at the lower rate. A hop with fewer frames is not decimated.
const KEPT_PER_HOP: usize = 64;

const ORDER: usize = 4;

/// A decimating low-pass filter. It averages `step` frames, four times in succession, and keeps one of every `step`
/// frames (Hogenauer 1981). The filter's zeros are at all multiples of the lower rate, so aliases below 500 Hz are
/// attenuated by 80 dB.
pub(super) struct Decimator {
    pub(super) step: usize,
    taps: Vec<f32>,
}

impl Decimator {
    pub(super) fn new(hop: usize) -> Self {
        let step = (hop / KEPT_PER_HOP).max(1);
        let mut taps = vec![1.0_f64];
        for _ in 0..ORDER {
            let mut longer = vec![0.0; taps.len() + step - 1];
            for (at, tap) in taps.iter().enumerate() {
                longer[at..at + step].iter_mut().for_each(|sum| *sum += tap / step as f64);
            }
            taps = longer;
        }
        Self { step, taps: taps.into_iter().map(|tap| tap as f32).collect() }
    }

    /// An output frame describes the moment this many input frames before its last input frame.
    pub(super) fn delay(&self) -> usize {
        self.taps.len() / 2
    }

    pub(super) fn power_gain(&self, hz: f64, sample_rate: f64) -> f64 {
        let half_angle = std::f64::consts::PI * hz / sample_rate;
        if half_angle == 0.0 {
            return 1.0;
        }
        let mean = (self.step as f64 * half_angle).sin() / (self.step as f64 * half_angle.sin());
        mean.powi(2 * ORDER as i32)
    }

    /// Fills `kept` with the newest output frames. The last output frame ends with the last frame of `frames`.
    pub(super) fn keep(&self, frames: &[StereoFrame], kept: &mut [StereoFrame]) {
        for (back, frame) in kept.iter_mut().rev().enumerate() {
            let end = frames.len().saturating_sub(back * self.step);
            let from = frames.get(end.saturating_sub(self.taps.len())..end).unwrap_or_default();
            let mut sum = [0.0; 2];
            for ([left, right], tap) in from.iter().zip(&self.taps) {
                sum[0] += tap * left;
                sum[1] += tap * right;
            }
            *frame = sum;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tones_are_attenuated_by_the_reported_gain() {
        for (hz, least) in [(100.0, 0.99), (500.0, 0.9), (5_600.0, 0.0), (11_700.0, 0.0)] {
            let decimator = Decimator::new(512);
            let tone = |n: usize| (std::f64::consts::TAU * hz * n as f64 / 48_000.0).sin() as f32;
            let frames: Vec<StereoFrame> = (0..48_000).map(|n| [tone(n), -tone(n)]).collect();
            let mut kept = vec![[0.0; 2]; 5_880];
            decimator.keep(&frames, &mut kept);
            let power = kept.iter().map(|[left, _]| 2.0 * f64::from(left * left)).sum::<f64>() / 5_880.0;
            let expected = decimator.power_gain(hz, 48_000.0);
            assert!((power - expected).abs() < 1e-3, "{hz} Hz: {power}, not {expected}");
            assert!(power >= least && (least > 0.0 || power < 1e-7), "{hz} Hz: {power}");
            assert!(kept.iter().all(|[left, right]| *left == -right));
        }
    }

    #[test]
    fn short_hops_are_not_decimated() {
        let decimator = Decimator::new(32);
        let mut kept = [[0.0; 2]; 2];
        decimator.keep(&[[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]], &mut kept);
        assert_eq!((decimator.step, decimator.delay(), kept), (1, 0, [[3.0, 4.0], [5.0, 6.0]]));
    }
}
