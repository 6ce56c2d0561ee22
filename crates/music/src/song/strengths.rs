//! The strengths of onsets, relative to the usual strength nearby.

use std::collections::VecDeque;

use super::heard::Heard;
use crate::onset::FLUX_MIN;

/// Onset strengths are relative to the largest flux within this many seconds before and after the moment.
const LARGEST_SECONDS: f64 = 1.5;
/// The time over which the mean onset strength is subtracted, and over which the strengths are scaled, in seconds.
const MEAN_SECONDS: f64 = 0.4;
const SCALE_SECONDS: f64 = 6.0;
/// The root mean square of the strengths counts as at least this much.
const SCALE_MIN: f32 = 0.02;

/// Returns onset strengths, 0..1, relative to the largest flux nearby ([`LARGEST_SECONDS`]).
pub(super) fn onset_strengths(heard: &Heard) -> Vec<f32> {
    let reach = (LARGEST_SECONDS / heard.hop_seconds) as usize;
    let flux: Vec<f32> = heard.moments.iter().map(|moment| moment.flux).collect();
    let largest = largest_around(&flux, reach);
    flux.iter().zip(largest).map(|(flux, largest)| flux / largest.max(FLUX_MIN)).collect()
}

/// Returns the largest value within `reach` of each index. The queue holds decreasing candidates (Lemire 2006).
pub(super) fn largest_around(values: &[f32], reach: usize) -> Vec<f32> {
    let mut queue = VecDeque::new();
    let mut ahead = values.iter().copied().enumerate();
    let enter = |queue: &mut VecDeque<(usize, f32)>, (index, value): (usize, f32)| {
        while queue.back().is_some_and(|(_, smaller)| *smaller <= value) {
            queue.pop_back();
        }
        queue.push_back((index, value));
    };
    ahead.by_ref().take(reach).for_each(|entry| enter(&mut queue, entry));
    let largest = |middle: usize| {
        if let Some(entry) = ahead.next() {
            enter(&mut queue, entry);
        }
        while queue.front().is_some_and(|(index, _)| index + reach < middle) {
            queue.pop_front();
        }
        queue.front().map_or(0.0, |(_, value)| *value)
    };
    (0..values.len()).map(largest).collect()
}

/// Returns how much each value exceeds the mean around it, relative to the root mean square of these excesses nearby.
pub(super) fn excesses(values: &[f32], hop_seconds: f64) -> Vec<f32> {
    let reach = |seconds: f64| (0.5 * seconds / hop_seconds) as usize;
    let means = means_around(values.iter().copied(), reach(MEAN_SECONDS));
    let above: Vec<f32> = values.iter().zip(means).map(|(value, mean)| (value - mean).max(0.0)).collect();
    let squares = means_around(above.iter().map(|value| value * value), reach(SCALE_SECONDS));
    above.iter().zip(squares).map(|(value, square)| value / square.max(0.0).sqrt().max(SCALE_MIN)).collect()
}

/// Returns the mean of the values within `reach` of each value.
fn means_around(values: impl Iterator<Item = f32>, reach: usize) -> Vec<f32> {
    let mut sums = vec![0.0_f64];
    for value in values {
        sums.push(sums.last().copied().unwrap_or_default() + f64::from(value));
    }
    let count = sums.len() - 1;
    let mean = |index: usize| {
        let (from, to) = (index.saturating_sub(reach), (index + reach + 1).min(count));
        ((sums[to] - sums[from]) / (to - from) as f64) as f32
    };
    (0..count).map(mean).collect()
}

pub(super) fn deviation(values: &[f32]) -> f32 {
    let count = values.len().max(1) as f32;
    let mean = values.iter().sum::<f32>() / count;
    (values.iter().map(|value| (value - mean).powi(2)).sum::<f32>() / count).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn largest_around_matches_a_plain_search() {
        let values: Vec<f32> = (0..40_u32).map(|n| ((n * 7919) % 101) as f32).collect();
        for reach in [1, 3, 8, 25] {
            let plain = (0..values.len()).map(|index: usize| {
                values[index.saturating_sub(reach)..(index + reach + 1).min(values.len())]
                    .iter()
                    .fold(0.0_f32, |a, b| a.max(*b))
            });
            assert_eq!(largest_around(&values, reach), plain.collect::<Vec<f32>>(), "reach {reach}");
        }
    }
}
