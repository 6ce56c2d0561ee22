//! How much the beats of a live input repeat at a period: the autocorrelation of their strengths, which forgets the past
//! exponentially. Noise and speech do not repeat.

/// The longest compared distance, in seconds, and the number of compared multiples of a period.
const LONGEST_SECONDS: f64 = 5.3;
const MULTIPLES: usize = 8;
/// The time constant of forgetting, in seconds.
const FORGET_SECONDS: f64 = 6.0;
/// The time constant of the mean strength that is subtracted, in seconds.
const MEAN_SECONDS: f64 = 0.4;

pub(super) struct Repetition {
    /// The past strengths, the newest first.
    past: Vec<f32>,
    sums: Vec<f32>,
    kept: f32,
    mean: f32,
    learned: f32,
}

impl Repetition {
    pub(super) fn new(hop_seconds: f64) -> Self {
        let lags = (LONGEST_SECONDS / hop_seconds) as usize;
        Self {
            past: vec![0.0; lags],
            sums: vec![0.0; lags],
            kept: (-hop_seconds / FORGET_SECONDS).exp() as f32,
            mean: 0.0,
            learned: (hop_seconds / MEAN_SECONDS).min(1.0) as f32,
        }
    }

    pub(super) fn restart(&mut self) {
        self.past.fill(0.0);
        self.sums.fill(0.0);
        self.mean = 0.0;
    }

    pub(super) fn follow(&mut self, strength: f32) {
        self.mean += self.learned * (strength - self.mean);
        let excess = (strength - self.mean).max(0.0);
        self.past.rotate_right(1);
        self.past[0] = excess;
        for (sum, past) in self.sums.iter_mut().zip(&self.past) {
            *sum = self.kept * *sum + excess * past;
        }
    }

    /// Returns the mean autocorrelation at the multiples of `period` hops, relative to the mean over all distances: 0
    /// without repetition, 1 at most.
    pub(super) fn at(&self, period: f32) -> f32 {
        let own = self.sums.first().copied().unwrap_or_default();
        if own <= 0.0 {
            return 0.0;
        }
        let mean = self.sums.iter().skip(1).sum::<f32>() / self.sums.len() as f32;
        let near = |multiple: usize| {
            let middle = (multiple as f32 * period).round() as usize;
            let around = self.sums.get(middle.saturating_sub(1)..middle + 2).unwrap_or_default();
            around.iter().fold(0.0_f32, |most, sum| most.max(*sum - mean))
        };
        (1..=MULTIPLES).map(near).sum::<f32>() / (MULTIPLES as f32 * own)
    }
}
