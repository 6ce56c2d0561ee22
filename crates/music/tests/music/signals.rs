//! Signals with known features, and their analysis.

#![allow(dead_code)] // Not every test uses all of these functions.
#![allow(clippy::expect_used)]

use std::f64::consts::TAU;

use mariana_music::{Alignment, Analyzer, Features, Gain, StereoFrame, TimedFeatures};

/// Analyses a whole stream without automatic gain.
pub(crate) fn analyze(rate: u32, frames: &[StereoFrame]) -> Vec<TimedFeatures> {
    analyze_by(Analyzer::with_gain(rate, Alignment::Centred, Gain::Off), frames)
}

pub(crate) fn analyze_by(mut analyzer: Analyzer, frames: &[StereoFrame]) -> Vec<TimedFeatures> {
    let mut moments = Vec::new();
    analyzer.push(frames, &mut |moment| moments.push(moment.clone()));
    analyzer.finish(&mut |moment| moments.push(moment.clone()));
    moments
}

pub(crate) fn signal(rate: u32, seconds: f64, mut sample: impl FnMut(f64) -> [f64; 2]) -> Vec<StereoFrame> {
    let count = (f64::from(rate) * seconds) as usize;
    (0..count).map(|n| sample(n as f64 / f64::from(rate)).map(|x| x as f32)).collect()
}

pub(crate) fn nearest(moments: &[TimedFeatures], time: f64) -> Features {
    let distance = |moment: &TimedFeatures| (moment.time - time).abs();
    moments.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).expect("there are moments").features
}

/// Returns the next number of a linear congruential generator, uniform in -1..1.
pub(crate) fn noise(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

pub(crate) fn cents(a: f64, b: f64) -> f64 {
    1200.0 * (a / b).log2()
}

/// A chord of eight tones over the whole range, with the power of a sine of amplitude `amplitude`.
pub(crate) fn chord(t: f64, amplitude: f64) -> [f64; 2] {
    let tones = [55.0, 110.0, 233.0, 466.0, 932.0, 1864.0, 3728.0, 7456.0];
    [amplitude / 8.0_f64.sqrt() * tones.iter().map(|hz| (TAU * hz * t).sin()).sum::<f64>(); 2]
}

pub(crate) fn leveled(frames: &[StereoFrame]) -> Vec<TimedFeatures> {
    analyze_by(Analyzer::new(48_000, Alignment::Centred), frames)
}
