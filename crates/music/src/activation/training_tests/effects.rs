//! Filters and effects.

use std::f32::consts::TAU;

use super::synth::RATE;

pub(super) fn low_passed(sound: &mut [f32], hz: f32) {
    let keep = (-TAU * hz / RATE).exp();
    let mut out = 0.0;
    for x in sound.iter_mut() {
        out = keep * out + (1.0 - keep) * *x;
        *x = out;
    }
}

pub(super) fn high_passed(sound: &mut [f32], hz: f32) {
    let keep = (-TAU * hz / RATE).exp();
    let (mut last, mut out) = (0.0, 0.0);
    for x in sound.iter_mut() {
        out = keep * (out + *x - last);
        last = *x;
        *x = out;
    }
}

/// Adds reverberation: four combs and two all-pass filters (Schroeder 1962).
pub(super) fn reverberated(sound: &mut [f32], seconds: f32, wet: f32) {
    let mut sum = vec![0.0; sound.len()];
    for delay in [0.0297, 0.0371, 0.0411, 0.0437] {
        let gain = 10_f32.powf(-3.0 * delay / seconds);
        let mut ring = vec![0.0; (delay * RATE) as usize];
        let (mut place, mut dull) = (0, 0.0);
        for (x, out) in sound.iter().zip(&mut sum) {
            let late = ring[place];
            dull += 0.6 * (late - dull);
            ring[place] = x + gain * dull;
            place = if place + 1 == ring.len() { 0 } else { place + 1 };
            *out += 0.25 * late;
        }
    }
    for delay in [0.005, 0.0017] {
        let mut ring = vec![0.0; (delay * RATE) as usize];
        let mut place = 0;
        for x in &mut sum {
            let late = ring[place];
            let fed = *x + 0.7 * late;
            *x = late - 0.7 * fed;
            ring[place] = fed;
            place = if place + 1 == ring.len() { 0 } else { place + 1 };
        }
    }
    sound.iter_mut().zip(&sum).for_each(|(x, late)| *x += wet * late);
}

/// Adds echoes.
pub(super) fn echoed(sound: &mut [f32], seconds: f32, gain: f32) {
    let delay = (seconds * RATE) as usize;
    for n in delay..sound.len() {
        sound[n] += gain * sound[n - delay];
    }
}

/// Reduces the level where it is high. The gain recovers with a time constant of `release` seconds.
pub(super) fn compressed(sound: &mut [f32], threshold: f32, release: f32) {
    let keep = (-1.0 / (release * RATE)).exp();
    let mut level = 0.0_f32;
    for x in sound.iter_mut() {
        level = (level * keep).max(x.abs());
        if level > threshold {
            *x *= (threshold / level).powf(0.75);
        }
    }
}

pub(super) fn power(sound: &[f32]) -> f32 {
    sound.iter().map(|x| x * x).sum::<f32>() / sound.len().max(1) as f32
}

pub(super) fn add(out: &mut [f32], sound: &[f32], at: f32, loud: f32) {
    let first = (at.max(0.0) * RATE) as usize;
    for (x, value) in out.iter_mut().skip(first).zip(sound) {
        *x += loud * value;
    }
}
