//! How what is low and what is high rises: kicks and basses, hats and snares.

/// Below this frequency lies what kicks and basses fill, in hertz.
const LOW_HZ: f64 = 150.0;
/// Above this frequency lies what hats and noises fill, in hertz.
const HIGH_HZ: f64 = 4_000.0;

/// Time in which the loudest moment, to which low and high sounds are compared, is forgotten, in seconds.
const LOUDEST_SECONDS: f64 = 8.0;

/// Moments between the two that are compared.
const LAG: usize = 2;

/// What was measured of a moment.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LowAndHigh {
    /// Power of everything.
    pub(super) power: f32,
    /// Power of what is low.
    pub(super) low_power: f32,
    /// Rise of the low band's amplitude, relative to the loudest amplitude of late.
    pub(super) low_rise: f32,
    /// The same of what is high.
    pub(super) high_rise: f32,
}

/// Measures rises.
pub(super) struct Rises {
    low_end: usize,
    high_start: usize,
    loudest: f32,
    forget: f32,
    /// Amplitudes of low and high of the last moments, the oldest first.
    before: [[f32; 2]; LAG],
}

impl Rises {
    /// For power spectra of `bins` bins of `bin_hz` hertz, `hop_seconds` apart.
    pub(super) fn new(bins: usize, bin_hz: f64, hop_seconds: f64) -> Self {
        let bin = |hz: f64| ((hz / bin_hz).round() as usize).clamp(1, bins);
        Self {
            low_end: (bin(LOW_HZ) + 1).min(bins),
            high_start: bin(HIGH_HZ),
            loudest: 0.0,
            forget: (-hop_seconds / LOUDEST_SECONDS).exp() as f32,
            before: [[0.0; 2]; LAG],
        }
    }

    /// Forgets everything.
    pub(super) fn restart(&mut self) {
        (self.loudest, self.before) = (0.0, [[0.0; 2]; LAG]);
    }

    /// The rises of the next moment, from its power per bin.
    pub(super) fn follow(&mut self, bins: &[f32]) -> LowAndHigh {
        let sum = |range: std::ops::Range<usize>| bins.get(range).unwrap_or_default().iter().sum::<f32>();
        let power = sum(1..bins.len());
        let (low_power, high_power) = (sum(1..self.low_end), sum(self.high_start..bins.len()));
        self.loudest = power.max(self.loudest * self.forget);
        // Hats are quiet beside kicks: each is weighed on its own logarithmic scale, as the flux is.
        let scale = 1.0 / self.loudest.max(1e-7);
        let now = [low_power, high_power].map(|power| (1.0 + 20.0 * (power * scale).sqrt()).ln());
        let [oldest, ..] = self.before;
        self.before.rotate_left(1);
        self.before[LAG - 1] = now;
        let [low_rise, high_rise] = [0, 1].map(|band| (now[band] - oldest[band]).max(0.0));
        LowAndHigh { power, low_power, low_rise, high_rise }
    }
}
