//! The energy curve of a song.

use super::heard::{Heard, Moment};

/// The energy curve has one value every this many seconds.
pub(super) const ENERGY_STEP: f64 = 0.25;

/// Energy 0 is this many decibels below the loudest level.
const ENERGY_RANGE_DB: f32 = 36.0;

/// Returns the mean power of each step, smoothed over a second, on a logarithmic scale, 0..1. The loudest step has 1.
pub(super) fn energy(heard: &Heard) -> Vec<f32> {
    let powers = steps(heard, |moments| {
        moments.iter().map(|moment| moment.power).sum::<f32>() / moments.len().max(1) as f32
    });
    let smooth: Vec<f32> = (0..powers.len())
        .map(|index| {
            let around = &powers[index.saturating_sub(2)..(index + 3).min(powers.len())];
            around.iter().sum::<f32>() / around.len() as f32
        })
        .collect();
    let loudest = smooth.iter().copied().fold(0.0_f32, f32::max);
    let height = |power: &f32| {
        if loudest < 1e-9 {
            return 0.0;
        }
        (1.0 + 10.0 * (power / loudest).max(1e-12).log10() / ENERGY_RANGE_DB).clamp(0.0, 1.0)
    };
    smooth.iter().map(height).collect()
}

/// Returns the largest sample magnitude in each [`ENERGY_STEP`].
pub(super) fn peaks(heard: &Heard) -> Vec<f32> {
    steps(heard, |moments| moments.iter().map(|moment| moment.peak).fold(0.0, f32::max))
}

fn steps(heard: &Heard, of: impl Fn(&[Moment]) -> f32) -> Vec<f32> {
    let count = (heard.seconds / ENERGY_STEP).ceil() as usize;
    let place =
        |step: usize| ((step as f64 * ENERGY_STEP / heard.hop_seconds) as usize).min(heard.moments.len());
    (0..count).map(|step| of(&heard.moments[place(step)..place(step + 1)])).collect()
}
