//! Short-term loudness: ITU-R BS.1770-4, with the window of 3 s of EBU Tech 3341.
//!
//! The crate `ebur128`, which measures whole songs here, adds up the squares of all 3 s at each query: at 48 kHz 288,000
//! products per hop. This module keeps one sum per hop.

use super::StereoFrame;

/// The length of the window, in seconds.
const SECONDS: f64 = 3.0;

/// After a start or seek, the loudness is measured over the known sound, but over at least this time in seconds.
const SECONDS_MIN: f64 = 0.4;

/// The least loudness in LUFS, which is the absolute gate of BS.1770. Silence has this loudness.
pub const LOUDNESS_FLOOR: f32 = -70.0;

/// A second-order section: b0, b1, b2, a1, a2.
#[derive(Clone, Copy, Debug)]
struct Section([f64; 5]);

impl Section {
    /// The high shelf of the head. The standard gives coefficients at 48 kHz; these parameters of the analog filter
    /// (Mansbridge, Finn and Reiss 2012) give the same coefficients, and others at other rates.
    fn shelf(rate: f64) -> Self {
        let (hz, gain_db, q) = (1_681.974_450_955_533, 3.999_843_853_973_347, 0.707_175_236_955_419_6);
        let k = (std::f64::consts::PI * hz / rate).tan();
        let high = 10_f64.powf(gain_db / 20.0);
        let band = high.powf(0.499_666_774_154_541_6);
        let a0 = 1.0 + k / q + k * k;
        Self([
            (high + band * k / q + k * k) / a0,
            2.0 * (k * k - high) / a0,
            (high - band * k / q + k * k) / a0,
            2.0 * (k * k - 1.0) / a0,
            (1.0 - k / q + k * k) / a0,
        ])
    }

    /// The high pass.
    fn high_pass(rate: f64) -> Self {
        let (hz, q) = (38.135_470_876_024_44, 0.500_327_037_323_877_3);
        let k = (std::f64::consts::PI * hz / rate).tan();
        let a0 = 1.0 + k / q + k * k;
        Self([1.0, -2.0, 1.0, 2.0 * (k * k - 1.0) / a0, (1.0 - k / q + k * k) / a0])
    }

    /// Filters a frame (transposed direct form II).
    fn follow(&self, x: [f64; 2], state: &mut [[f64; 2]; 2]) -> [f64; 2] {
        let [b0, b1, b2, a1, a2] = self.0;
        let [first, second] = state;
        std::array::from_fn(|side| {
            let y = b0 * x[side] + first[side];
            first[side] = b1 * x[side] - a1 * y + second[side];
            second[side] = b2 * x[side] - a2 * y;
            y
        })
    }
}

pub(super) struct Loudness {
    sections: [Section; 2],
    states: [[[f64; 2]; 2]; 2],
    /// The mean square of each of the last hops, both channels added.
    hops: Vec<f64>,
    next: usize,
    taken: usize,
    least: usize,
}

impl Loudness {
    pub(super) fn new(rate: f64, hop_seconds: f64) -> Self {
        let count = |seconds: f64| (seconds / hop_seconds).round() as usize;
        Self {
            sections: [Section::shelf(rate), Section::high_pass(rate)],
            states: [[[0.0; 2]; 2]; 2],
            hops: vec![0.0; count(SECONDS)],
            next: 0,
            taken: 0,
            least: count(SECONDS_MIN),
        }
    }

    pub(super) fn restart(&mut self) {
        self.states = [[[0.0; 2]; 2]; 2];
        self.hops.fill(0.0);
        (self.next, self.taken) = (0, 0);
    }

    /// Adds a hop. Returns the loudness in LUFS, at least [`LOUDNESS_FLOOR`].
    pub(super) fn follow(&mut self, frames: &[StereoFrame]) -> f32 {
        let mut sum = 0.0;
        for frame in frames {
            let mut x = frame.map(f64::from);
            for (section, state) in self.sections.iter().zip(&mut self.states) {
                x = section.follow(x, state);
            }
            sum += x[0] * x[0] + x[1] * x[1];
        }
        // Decaying states become subnormal numbers, which are slow.
        for value in self.states.as_flattened_mut().as_flattened_mut() {
            if value.abs() < 1e-30 {
                *value = 0.0;
            }
        }
        if let Some(slot) = self.hops.get_mut(self.next) {
            *slot = sum / frames.len().max(1) as f64;
        }
        self.next = (self.next + 1) % self.hops.len();
        self.taken = (self.taken + 1).min(self.hops.len());
        let power = self.hops.iter().sum::<f64>() / self.taken.max(self.least) as f64;
        (-0.691 + 10.0 * power.log10()).max(f64::from(LOUDNESS_FLOOR)) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ebur128::{EbuR128, Mode};

    fn after(rate: u32, frames: &[StereoFrame]) -> f32 {
        let hop = rate as usize / 100;
        let mut loudness = Loudness::new(f64::from(rate), 0.01);
        frames.chunks(hop).fold(LOUDNESS_FLOOR, |_, hop| loudness.follow(hop))
    }

    fn tone(rate: u32, hz: f64, seconds: f64, amplitude: [f64; 2]) -> Vec<StereoFrame> {
        let sine = |n: u32| (std::f64::consts::TAU * hz * f64::from(n) / f64::from(rate)).sin();
        (0..(seconds * f64::from(rate)) as u32)
            .map(|n| amplitude.map(|amplitude| (amplitude * sine(n)) as f32))
            .collect()
    }

    /// EBU Tech 3341, test signals 1 and 2: a stereo sine of 1 kHz at -23 dB has -23 LUFS.
    #[test]
    fn the_test_signals_have_their_loudness() {
        for rate in [44_100, 48_000, 96_000] {
            for level in [-23.0, -33.0] {
                let amplitude = 10_f64.powf(level / 20.0);
                let found = f64::from(after(rate, &tone(rate, 1_000.0, 5.0, [amplitude; 2])));
                assert!((found - level).abs() < 0.1, "{level} LUFS at {rate} Hz: {found}");
            }
        }
    }

    #[test]
    fn agrees_with_another_implementation() {
        for rate in [8_000, 44_100, 48_000] {
            for (hz, amplitude) in [(40.0, [0.5, 0.5]), (300.0, [0.3, 0.0]), (3_000.0, [0.05, 0.2])] {
                let frames = tone(rate, hz, 6.0, amplitude);
                let mut meter = EbuR128::new(2, rate, Mode::S).unwrap();
                meter.add_frames_f32(frames.as_flattened()).unwrap();
                let (found, expected) =
                    (f64::from(after(rate, &frames)), meter.loudness_shortterm().unwrap());
                assert!((found - expected).abs() < 0.05, "{hz} Hz at {rate} Hz: {found}, not {expected}");
            }
        }
    }

    #[test]
    fn silence_has_the_floor() {
        assert_eq!(after(48_000, &[[0.0; 2]; 96_000]), LOUDNESS_FLOOR);
        assert_eq!(after(48_000, &[]), LOUDNESS_FLOOR);
    }

    #[test]
    fn the_start_is_measured_over_the_known_sound() {
        let frames = tone(48_000, 1_000.0, 1.0, [0.1; 2]);
        assert!((after(48_000, &frames) + 20.0).abs() < 0.2, "{}", after(48_000, &frames));
    }
}
