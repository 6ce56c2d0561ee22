//! Mean measurements of stretches of time, such as beats or bars.

use std::ops::Range;

use super::heard::{Heard, Moment, SLOW_HOPS, SlowMoment, TIMBRE_BANDS};
use super::strengths::deviation;

/// The approximate flux of noise.
const FLUX_OF_NOISE: f32 = 0.1;

/// Quieter levels count as this many decibels below the loudest moment.
const RANGE_DB: f32 = 60.0;

#[derive(Clone, Copy, Debug)]
pub(super) struct Unit {
    /// The level of each band, 0..60 decibels above the floor.
    pub(super) timbre: [f32; TIMBRE_BANDS],
    /// The fraction of each pitch class, C first. The fractions sum to 1, or to 0 without pitches.
    pub(super) chroma: [f32; 12],
    /// The levels of all bands and of the low band, in decibels above the floor.
    pub(super) level: f32,
    pub(super) low: f32,
    /// How much the flux exceeds the flux of noise, on average: a measure of onset density.
    pub(super) onsets: f32,
}

impl Unit {
    /// Returns the level-weighted mean position among the bands (spectral centroid), 0..1.
    pub(super) fn brightness(&self) -> f32 {
        let sum: f32 = self.timbre.iter().sum();
        let weighed: f32 = self.timbre.iter().enumerate().map(|(band, level)| band as f32 * level).sum();
        if sum > 0.0 { weighed / sum / (TIMBRE_BANDS - 1) as f32 } else { 0.0 }
    }
}

/// Returns one unit for each stretch between consecutive `times` (in seconds), so one unit fewer than times.
pub(super) fn units(heard: &Heard, times: &[f64]) -> Vec<Unit> {
    let loudest = heard.slow.iter().map(|slow| slow.timbre.iter().sum::<f32>()).fold(1e-7_f32, f32::max);
    times.windows(2).map(|pair| unit(heard, pair[0], pair[1], loudest)).collect()
}

fn unit(heard: &Heard, from: f64, to: f64, loudest: f32) -> Unit {
    let level = |power: f32| (10.0 * (power / loudest).max(1e-12).log10() + RANGE_DB).clamp(0.0, RANGE_DB);
    let (moments, slow) = within(heard, from, to);
    let mut timbre = [0.0; TIMBRE_BANDS];
    for moment in slow {
        for (sum, power) in timbre.iter_mut().zip(&moment.timbre) {
            *sum += power / slow.len() as f32;
        }
    }
    let count = moments.len().max(1) as f32;
    let mean = |of: fn(&Moment) -> f32| moments.iter().map(of).sum::<f32>() / count;
    Unit {
        timbre: timbre.map(level),
        chroma: chroma(heard, from, to),
        level: level(mean(|moment| moment.power)),
        low: level(mean(|moment| moment.low_power)),
        onsets: mean(|moment| (moment.flux - FLUX_OF_NOISE).max(0.0)),
    }
}

/// Returns the moments and the slow moments between two times, at least one of each.
pub(super) fn within(heard: &Heard, from: f64, to: f64) -> (&[Moment], &[SlowMoment]) {
    let moments = places(from..to, heard.moments.len(), heard.hop_seconds, 0.0);
    let slow = places(from..to, heard.slow.len(), heard.hop_seconds * SLOW_HOPS as f64, 0.0);
    (&heard.moments[moments], &heard.slow[slow])
}

/// Returns the indices of the measurements within `times`, at least one. There are `count`; they are `seconds` apart,
/// and `late` by this many measurements.
fn places(times: Range<f64>, count: usize, seconds: f64, late: f64) -> Range<usize> {
    let place = |time: f64| ((time / seconds + late).round().max(0.0) as usize).min(count);
    let start = place(times.start).min(count.saturating_sub(1));
    start..place(times.end).max(start + 1).min(count)
}

/// Returns the fraction of each pitch class, C first. The fractions sum to 1, or to 0 without pitches.
pub(super) fn chroma(heard: &Heard, from: f64, to: f64) -> [f32; 12] {
    let late = heard.chroma_late as f64 - 0.5;
    let places = places(from..to, heard.slow.len(), heard.hop_seconds * SLOW_HOPS as f64, late);
    let mut chroma = [0.0; 12];
    for moment in heard.slow.get(places).unwrap_or_default() {
        let classes = heard.tuning.pitch_classes(&moment.chroma);
        chroma.iter_mut().zip(classes).for_each(|(sum, amplitude)| *sum += amplitude);
    }
    let sum: f32 = chroma.iter().sum();
    if sum > 0.0 { chroma.map(|amplitude| amplitude / sum) } else { chroma }
}

pub(super) fn distance(a: &[f32], b: &[f32]) -> f32 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f32>().sqrt()
}

pub(super) fn standardised(values: &[f32], least: f32) -> Vec<f32> {
    let mean = values.iter().sum::<f32>() / values.len().max(1) as f32;
    let deviation = deviation(values).max(least);
    values.iter().map(|value| (value - mean) / deviation).collect()
}
