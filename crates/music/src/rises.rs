//! The rise in loudness of low frequencies (kicks and basses) and of high frequencies (hats and snares).

/// The upper end of the low band (kicks and basses), in hertz.
const LOW_HZ: f64 = 150.0;
/// The lower end of the high band (hats and noises), in hertz.
const HIGH_HZ: f64 = 4_000.0;

/// Time constant of the decay of the loudest power, in seconds.
const LOUDEST_SECONDS: f64 = 8.0;

/// The distance between the two compared moments, in hops.
const LAG: usize = 2;

#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LowAndHigh {
    pub(super) power: f32,
    pub(super) low_power: f32,
    /// The rise of each band's amplitude, relative to the loudest recent amplitude.
    pub(super) low_rise: f32,
    pub(super) high_rise: f32,
}

pub(super) struct Rises {
    low_end: usize,
    high_start: usize,
    loudest: f32,
    forget: f32,
    /// The low and high amplitudes of the last moments, the oldest first.
    before: [[f32; 2]; LAG],
}

impl Rises {
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

    pub(super) fn follow(&mut self, bins: &[f32]) -> LowAndHigh {
        let sum = |range: std::ops::Range<usize>| bins.get(range).unwrap_or_default().iter().sum::<f32>();
        let power = sum(1..bins.len());
        let (low_power, high_power) = (sum(1..self.low_end), sum(self.high_start..bins.len()));
        self.loudest = power.max(self.loudest * self.forget);
        // Hats are quieter than kicks, so each band is compressed logarithmically, like the flux.
        let scale = 1.0 / self.loudest.max(1e-7);
        let now = [low_power, high_power].map(|power| (1.0 + 20.0 * (power * scale).sqrt()).ln());
        let [oldest, ..] = self.before;
        self.before.rotate_left(1);
        self.before[LAG - 1] = now;
        let [low_rise, high_rise] = [0, 1].map(|band| (now[band] - oldest[band]).max(0.0));
        LowAndHigh { power, low_power, low_rise, high_rise }
    }
}
