//! Drums and noise sounds, made of sine sweeps and filtered noise. Each stroke has its own fixed noise.

use super::score::{BAR, Drum, Hit, SAMPLE_RATE};
use super::synth::{DT, Filter, Frame, Pass, pan_gains};
use std::f32::consts::{PI, TAU};

/// White noise for sounds and dither: the upper bits of a 64-bit linear congruential generator.
#[derive(Clone, Copy, Debug)]
pub struct Noise(u64);

impl Noise {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0x5DEE_CE66_D1CE_4E5B)
    }

    /// Returns a uniform random number in -1..1.
    pub fn sample(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1_u64 << 23) as f32 - 1.0
    }
}

/// Adds one stroke to `out`. `index` selects its noise.
pub fn strike(out: &mut [Frame], hit: &Hit, index: usize) {
    let seed = index as u64 * 2 + 1;
    match hit.drum {
        Drum::Kick => kick(out, hit, seed),
        Drum::Clap => clap(out, hit, seed),
        Drum::Snare => snare(out, hit, seed),
        Drum::ClosedHat => hiss(out, hit, seed, 7_800.0, 0.028, 0.5),
        Drum::OpenHat => hiss(out, hit, seed, 7_000.0, 0.11, 0.42),
        Drum::Shaker => shaker(out, hit, seed),
        Drum::Crash => hiss(out, hit, seed, 3_800.0, 0.65, 0.4),
        Drum::LowTom => tom(out, hit, 82.0, 0.2),
        Drum::HighTom => tom(out, hit, 123.0, 0.17),
        Drum::Riser => riser(out, hit, seed),
        Drum::Surf => surf(out, hit, seed),
        Drum::Impact => tom(out, hit, 41.2, 0.55),
    }
}

/// Adds `seconds` of the sound `voice(t)` to `out`, panned like `hit`. The last tenth fades to 0.
fn play(out: &mut [Frame], hit: &Hit, seconds: f32, mut voice: impl FnMut(f32) -> Frame) {
    let gains = pan_gains(hit.pan);
    let end = out.len().min(hit.start + (seconds * SAMPLE_RATE as f32) as usize);
    for (n, frame) in out[hit.start.min(end)..end].iter_mut().enumerate() {
        let t = n as f32 * DT;
        let fade = ((seconds - t) / (0.1 * seconds)).clamp(0.0, 1.0) * hit.velocity;
        let [left, right] = voice(t);
        frame[0] += fade * gains[0] * left;
        frame[1] += fade * gains[1] * right;
    }
}

/// Returns the phase in radians of a sine whose frequency falls from `low + drop` to `low` Hz with time constant
/// `tau`.
fn swept_phase(t: f32, low: f32, drop: f32, tau: f32) -> f32 {
    TAU * (low * t + drop * tau * (1.0 - (-t / tau).exp()))
}

fn kick(out: &mut [Frame], hit: &Hit, seed: u64) {
    let mut noise = Noise::new(seed);
    let mut click = Filter::new(Pass::Band, 3_200.0, 0.8);
    play(out, hit, 0.4, |t| {
        let body = swept_phase(t, 49.0, 150.0, 0.026).sin() * (-t / 0.15).exp();
        let tick = click.run(noise.sample()) * (-t / 0.004).exp() * (t / 0.0007).min(1.0) * 0.5;
        let x = (1.7 * body).tanh() + tick;
        [x, x]
    });
}

fn clap(out: &mut [Frame], hit: &Hit, seed: u64) {
    let mut noises = [Noise::new(seed), Noise::new(seed + 1)];
    let mut filters = [Filter::new(Pass::Band, 1_500.0, 0.8), Filter::new(Pass::Band, 1_700.0, 0.8)];
    play(out, hit, 0.45, |t| {
        // Three claps, then the reverberation.
        let burst = |at: f32, tau: f32| {
            if t < at { 0.0 } else { ((t - at) / 0.0008).min(1.0) * (-(t - at) / tau).exp() }
        };
        let level = 0.8 * burst(0.0, 0.004) + 0.8 * burst(0.011, 0.004) + burst(0.023, 0.075);
        std::array::from_fn(|i| 1.7 * level * filters[i].run(noises[i].sample()))
    });
}

fn snare(out: &mut [Frame], hit: &Hit, seed: u64) {
    let mut noises = [Noise::new(seed), Noise::new(seed + 1)];
    let mut filters = [Filter::new(Pass::High, 1_300.0, 0.7); 2];
    play(out, hit, 0.25, |t| {
        let body = 0.6 * swept_phase(t, 190.0, 80.0, 0.02).sin() * (-t / 0.06).exp();
        let rattle = 0.5 * (-t / 0.07).exp() * (t / 0.001).min(1.0);
        std::array::from_fn(|i| body + rattle * filters[i].run(noises[i].sample()))
    });
}

/// Adds a hat or cymbal: high-passed noise that decays with time constant `tau`. Each side has different noise.
fn hiss(out: &mut [Frame], hit: &Hit, seed: u64, corner: f32, tau: f32, level: f32) {
    let mut noises = [Noise::new(seed), Noise::new(seed + 1)];
    let mut filters = [[Filter::new(Pass::High, corner, 0.9); 2]; 2];
    play(out, hit, 6.0 * tau, |t| {
        let envelope = level * (-t / tau).exp() * (t / 0.0008).min(1.0);
        std::array::from_fn(|i| {
            let [first, second] = &mut filters[i];
            envelope * second.run(first.run(noises[i].sample()))
        })
    });
}

fn shaker(out: &mut [Frame], hit: &Hit, seed: u64) {
    let mut noise = Noise::new(seed);
    let mut filter = Filter::new(Pass::Band, 6_200.0, 1.4);
    play(out, hit, 0.1, |t| {
        let x = 0.5 * (0.5 - 0.5 * (TAU * (t / 0.1).powf(0.6)).cos()) * filter.run(noise.sample());
        [x, x]
    });
}

fn tom(out: &mut [Frame], hit: &Hit, low: f32, tau: f32) {
    play(out, hit, 5.0 * tau, |t| {
        let x = (1.3 * swept_phase(t, low, 0.9 * low, 0.05).sin() * (-t / tau).exp()).tanh();
        [x, x]
    });
}

/// Adds two bars of band-passed noise. The band rises from 400 Hz to 9 kHz, and the sound swings between the sides
/// faster and faster.
fn riser(out: &mut [Frame], hit: &Hit, seed: u64) {
    let seconds = (2 * BAR) as f32 * DT * 0.875; // the last beat before the loud part stays free
    let mut noises = [Noise::new(seed), Noise::new(seed + 1)];
    let mut filters = [Filter::new(Pass::Band, 400.0, 1.3); 2];
    play(out, hit, seconds, |t| {
        let u = t / seconds;
        let swing = 0.6 * u * (PI * 14.0 * u * u).sin();
        std::array::from_fn(|i| {
            filters[i].tune(400.0 * 22.5_f32.powf(u));
            let side = if i == 0 { 1.0 - swing } else { 1.0 + swing };
            0.5 * u * u * side * filters[i].run(noises[i].sample())
        })
    });
}

fn surf(out: &mut [Frame], hit: &Hit, seed: u64) {
    let seconds = (3 * BAR) as f32 * DT;
    let mut noises = [Noise::new(seed), Noise::new(seed + 1)];
    let mut filters = [Filter::new(Pass::Band, 3_000.0, 0.5); 2];
    play(out, hit, seconds, |t| {
        let swell = 0.5 - 0.5 * (TAU * t / seconds).cos();
        std::array::from_fn(|i| {
            filters[i].tune(2_500.0 + 6_000.0 * swell);
            0.25 * swell * filters[i].run(noises[i].sample())
        })
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Drum; 12] = [
        Drum::Kick,
        Drum::Clap,
        Drum::Snare,
        Drum::ClosedHat,
        Drum::OpenHat,
        Drum::Shaker,
        Drum::Crash,
        Drum::LowTom,
        Drum::HighTom,
        Drum::Riser,
        Drum::Surf,
        Drum::Impact,
    ];

    #[test]
    fn every_drum_sounds_starts_softly_and_ends_at_zero() {
        for drum in ALL {
            let mut out = vec![[0.0; 2]; 7 * SAMPLE_RATE as usize];
            strike(&mut out, &Hit { drum, start: 100, velocity: 1.0, pan: 0.0 }, 3);
            let peak = out.iter().flatten().fold(0.0_f32, |m, x| m.max(x.abs()));
            assert!((0.1..1.5).contains(&peak), "{drum:?} {peak}");
            assert!(out[..=100].iter().flatten().all(|&x| x == 0.0), "{drum:?}");
            let last = out.iter().rposition(|f| f[0] != 0.0).unwrap_or(0);
            assert!(last + 1 < out.len() && out[last][0].abs() < 1e-4, "{drum:?}");
        }
    }

    #[test]
    fn noise_is_centred_and_fills_its_range() {
        let mut noise = Noise::new(7);
        let samples: Vec<f32> = (0..100_000).map(|_| noise.sample()).collect();
        let mean = samples.iter().sum::<f32>() / 1e5;
        let power = samples.iter().map(|x| x * x).sum::<f32>() / 1e5;
        assert!(mean.abs() < 0.01 && (power - 1.0 / 3.0).abs() < 0.01, "{mean} {power}");
    }
}
