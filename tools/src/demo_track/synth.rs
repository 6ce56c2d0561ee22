//! Oscillators, envelopes, a filter, and the pitched instruments.
//!
//! Saws and pulses are band-limited with polyBLEP (Välimäki and Huovilainen, "Antialiasing Oscillators in Subtractive
//! Synthesis", 2007). The filter is the trapezoidal state variable filter (Simper, "Linear Trapezoidal Integrated
//! SVF", 2013). Levels are linear, nominally -1..1; times are in seconds.

use super::score::{Note, SAMPLE_RATE};
use std::f32::consts::{FRAC_PI_4, PI, TAU};

/// A stereo sample frame: left, right.
pub type Frame = [f32; 2];

pub const DT: f32 = 1.0 / SAMPLE_RATE as f32;

/// Returns the frequency of a MIDI note in Hz, detuned by `cents`.
pub fn frequency(pitch: u8, cents: f32) -> f32 {
    440.0 * ((f32::from(pitch) - 69.0) / 12.0 + cents / 1200.0).exp2()
}

/// Returns equal-power gains for a pan -1 (left) ..= 1 (right). In the middle, both gains are 0.707.
pub fn pan_gains(pan: f32) -> Frame {
    let angle = (pan.clamp(-1.0, 1.0) + 1.0) * FRAC_PI_4;
    // Use the sine for both sides: unlike the cosine, it is exactly 0 if the sound is on the other side.
    [(2.0 * FRAC_PI_4 - angle).sin(), angle.sin()]
}

/// An oscillator phase in cycles, 0..1. It has 64 bits, so that long notes stay in tune.
#[derive(Clone, Copy, Debug, Default)]
pub struct Phase(f64);

impl Phase {
    /// A phase that starts at a fraction of a cycle.
    pub fn starting_at(cycles: f32) -> Self {
        Self(f64::from(cycles.rem_euclid(1.0)))
    }

    /// Returns the phase and advances it by one sample at `hz`.
    pub fn advance(&mut self, hz: f32) -> f32 {
        let now = self.0 as f32;
        self.0 += f64::from(hz) / f64::from(SAMPLE_RATE);
        self.0 -= self.0.floor();
        now
    }

    pub fn sine(&mut self, hz: f32) -> f32 {
        (TAU * self.advance(hz)).sin()
    }

    /// A band-limited falling saw wave.
    pub fn saw(&mut self, hz: f32) -> f32 {
        let t = self.advance(hz);
        2.0 * t - 1.0 - step_residual(t, hz * DT)
    }

    /// A band-limited pulse wave without DC offset, high for the fraction `width` of a cycle.
    pub fn pulse(&mut self, hz: f32, width: f32) -> f32 {
        let t = self.advance(hz);
        let square = if t < width { 1.0 } else { -1.0 };
        let residual = step_residual(t, hz * DT) - step_residual((t - width).rem_euclid(1.0), hz * DT);
        square + residual - (2.0 * width - 1.0)
    }
}

/// Returns the difference between a band-limited and a naive step of height 2 at phase 0 (polyBLEP). `dt` is the
/// frequency in cycles per sample.
fn step_residual(t: f32, dt: f32) -> f32 {
    if t < dt {
        let u = t / dt;
        2.0 * u - u * u - 1.0
    } else if t > 1.0 - dt {
        let u = (t - 1.0) / dt;
        u * u + 2.0 * u + 1.0
    } else {
        0.0
    }
}

/// An ADSR envelope: attack, decay and release in seconds, sustain as a level 0..1. The level is computed in closed
/// form.
#[derive(Clone, Copy, Debug)]
pub struct Envelope {
    pub attack: f32,
    pub decay: f32,
    pub sustain: f32,
    pub release: f32,
}

impl Envelope {
    fn held_level(&self, t: f32) -> f32 {
        if t < self.attack {
            // A raised cosine has no corner and so causes no click.
            0.5 - 0.5 * (PI * t / self.attack).cos()
        } else {
            self.sustain + (1.0 - self.sustain) * (-(t - self.attack) / self.decay).exp()
        }
    }

    /// Returns the level `t` seconds after the onset of a note that is held for `held` seconds. The level is 0 after
    /// `held + release` seconds.
    pub fn level(&self, t: f32, held: f32) -> f32 {
        if t <= held {
            self.held_level(t)
        } else {
            let left = (1.0 - (t - held) / self.release).max(0.0);
            self.held_level(held) * left * left * left
        }
    }

    /// Returns the number of samples until the envelope reaches 0, for a note of `length` samples.
    pub fn samples(&self, length: usize) -> usize {
        length + (self.release * SAMPLE_RATE as f32).ceil() as usize
    }
}

/// The output of a [`Filter`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pass {
    Low,
    Band,
    High,
}

/// A two-pole state variable filter.
#[derive(Clone, Copy, Debug)]
pub struct Filter {
    pass: Pass,
    ic1: f32,
    ic2: f32,
    g: f32,
    k: f32,
}

impl Filter {
    /// A filter with a corner in Hz (clamped to 10..20000) and resonance `q` (0.5 soft, 0.707 flat, higher
    /// peaked).
    pub fn new(pass: Pass, hz: f32, q: f32) -> Self {
        let mut filter = Self { pass, ic1: 0.0, ic2: 0.0, g: 0.0, k: 1.0 / q };
        filter.tune(hz);
        filter
    }

    pub fn tune(&mut self, hz: f32) {
        self.g = (PI * hz.clamp(10.0, 20_000.0) * DT).tan();
    }

    pub fn run(&mut self, input: f32) -> f32 {
        let a1 = 1.0 / (1.0 + self.g * (self.g + self.k));
        let v3 = input - self.ic2;
        let band = a1 * (self.ic1 + self.g * v3);
        let low = self.ic2 + self.g * band;
        self.ic1 = 2.0 * band - self.ic1;
        self.ic2 = 2.0 * low - self.ic2;
        match self.pass {
            Pass::Low => low,
            Pass::Band => self.k * band,
            Pass::High => input - self.k * band - low,
        }
    }
}

/// Number of samples between two updates of a filter whose corner moves.
const TUNE_EVERY: usize = 16;

/// Adds a note to `out`. `voice(n, t)` returns sample `n` at `t` seconds, before envelope and velocity.
fn play(out: &mut [Frame], note: &Note, envelope: Envelope, mut voice: impl FnMut(usize, f32) -> Frame) {
    let held = note.length as f32 * DT;
    let end = out.len().min(note.start + envelope.samples(note.length));
    for (n, frame) in out[note.start.min(end)..end].iter_mut().enumerate() {
        let t = n as f32 * DT;
        let gain = note.velocity * envelope.level(t, held);
        let [left, right] = voice(n, t);
        frame[0] += gain * left;
        frame[1] += gain * right;
    }
}

/// Returns a different but fixed starting phase for every oscillator of every note.
fn start_phase(note: &Note, oscillator: usize) -> Phase {
    let seed = note.start as f32 / 6400.0 + f32::from(note.pitch) * 7.0 + oscillator as f32;
    Phase::starting_at(seed * 0.618_034)
}

/// A warm pad: six detuned saws, three per side, with a slow attack and release. The mix filters all pads together.
pub fn pad(out: &mut [Frame], note: &Note) {
    const CENTS: [f32; 6] = [-11.0, 9.0, -4.0, 4.5, 12.0, -8.0];
    let mut saws: [Phase; 6] = std::array::from_fn(|i| start_phase(note, i));
    let hz = CENTS.map(|cents| frequency(note.pitch, cents));
    let gains = pan_gains(note.pan * 0.6);
    let envelope = Envelope { attack: 0.35, decay: 1.0, sustain: 0.85, release: 0.9 };
    play(out, note, envelope, |_, _| {
        let mut sides = [0.0; 2];
        for (i, saw) in saws.iter_mut().enumerate() {
            sides[i % 2] += saw.saw(hz[i]);
        }
        [sides[0] * gains[0] * 0.3, sides[1] * gains[1] * 0.3]
    });
}

/// A pluck: saw and pulse through a filter that closes quickly. `brightness` scales the filter's opening.
pub fn pluck(out: &mut [Frame], note: &Note, brightness: f32) {
    let (mut saw, mut pulse) = (start_phase(note, 0), start_phase(note, 1));
    let (hz, hz_pulse) = (frequency(note.pitch, -3.0), frequency(note.pitch, 4.0));
    let mut filter = Filter::new(Pass::Low, 500.0, 1.1);
    let gains = pan_gains(note.pan);
    let envelope = Envelope { attack: 0.003, decay: 0.16, sustain: 0.0, release: 0.3 };
    play(out, note, envelope, |n, t| {
        if n % TUNE_EVERY == 0 {
            filter.tune(350.0 + hz + brightness * note.velocity * 5200.0 * (-t / 0.075).exp());
        }
        let x = filter.run(0.5 * saw.saw(hz) + 0.4 * pulse.pulse(hz_pulse, 0.35));
        [x * gains[0], x * gains[1]]
    });
}

/// The lead: two saws and a sine through a soft filter, with a delayed vibrato.
pub fn lead(out: &mut [Frame], note: &Note) {
    let mut saws = [start_phase(note, 0), start_phase(note, 1)];
    let (mut body, mut vibrato) = (Phase::default(), Phase::default());
    let base = [frequency(note.pitch, -5.0), frequency(note.pitch, 5.0)];
    let middle = frequency(note.pitch, 0.0);
    let mut filters = [Filter::new(Pass::Low, 1000.0, 0.9); 2];
    let gains = pan_gains(note.pan);
    let envelope = Envelope { attack: 0.02, decay: 0.5, sustain: 0.7, release: 0.22 };
    play(out, note, envelope, |n, t| {
        let depth = 0.0035 * ((t - 0.2) / 0.4).clamp(0.0, 1.0);
        let bend = 1.0 + depth * vibrato.sine(5.2);
        if n % TUNE_EVERY == 0 {
            let corner = 900.0 + 1.2 * middle + 1900.0 * (-t / 0.35).exp() * (t / 0.03).min(1.0);
            filters.iter_mut().for_each(|f| f.tune(corner));
        }
        let sine = 0.45 * body.sine(middle * bend);
        let voices: [f32; 2] = std::array::from_fn(|i| saws[i].saw(base[i] * bend));
        // Each side has more of one saw than of the other. This widens the sound slightly and does not move it.
        let left = filters[0].run(0.35 * voices[0] + 0.15 * voices[1]) + sine;
        let right = filters[1].run(0.15 * voices[0] + 0.35 * voices[1]) + sine;
        [left * gains[0], right * gains[1]]
    });
}

/// A bell: sine partials. The higher a partial is, the faster it decays.
pub fn bell(out: &mut [Frame], note: &Note) {
    // The columns are the ratio to the fundamental, the level, and the decay time in seconds.
    const PARTIALS: [(f32, f32, f32); 6] = [
        (1.0, 0.60, 1.1),
        (2.0, 0.25, 0.7),
        (3.01, 0.16, 0.45),
        (4.17, 0.10, 0.28),
        (6.24, 0.07, 0.15),
        (9.1, 0.04, 0.07),
    ];
    let hz = frequency(note.pitch, 0.0);
    let mut phases = [Phase::default(); 6];
    let gains = pan_gains(note.pan);
    let envelope = Envelope { attack: 0.002, decay: 10.0, sustain: 0.9, release: 1.6 };
    play(out, note, envelope, |_, t| {
        let x: f32 = PARTIALS
            .iter()
            .zip(&mut phases)
            .filter(|((ratio, _, _), _)| hz * ratio < 18_000.0)
            .map(|(&(ratio, level, decay), phase)| level * (-t / decay).exp() * phase.sine(hz * ratio))
            .sum();
        [x * gains[0], x * gains[1]]
    });
}

/// The bass: a sine for woofers, and a filtered, gently distorted saw for small loudspeakers.
pub fn bass(out: &mut [Frame], note: &Note) {
    let hz = frequency(note.pitch, 0.0);
    let (mut sub, mut saw) = (Phase::default(), Phase::starting_at(0.5));
    let mut filter = Filter::new(Pass::Low, 200.0, 0.9);
    let gains = pan_gains(note.pan);
    let envelope = Envelope { attack: 0.006, decay: 0.35, sustain: 0.65, release: 0.09 };
    play(out, note, envelope, |n, t| {
        if n % TUNE_EVERY == 0 {
            filter.tune(110.0 + 2.0 * hz + 1100.0 * note.velocity * (-t / 0.09).exp());
        }
        let growl = (1.6 * filter.run(saw.saw(hz))).tanh();
        let x = 0.8 * sub.sine(hz) + 0.42 * growl;
        [x * gains[0], x * gains[1]]
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rising_zero_crossings(samples: &[f32]) -> usize {
        samples.windows(2).filter(|w| w[0] < 0.0 && w[1] >= 0.0).count()
    }

    #[test]
    fn oscillators_are_in_tune() {
        let mut phases = [Phase::starting_at(0.3); 3];
        let mut sounds = [Vec::new(), Vec::new(), Vec::new()];
        for _ in 0..SAMPLE_RATE {
            sounds[0].push(phases[0].sine(441.0));
            sounds[1].push(phases[1].saw(441.0));
            sounds[2].push(phases[2].pulse(441.0, 0.35));
        }
        for sound in sounds {
            assert!((440..=442).contains(&rising_zero_crossings(&sound)));
        }
        assert!((frequency(57, 0.0) - 220.0).abs() < 1e-3);
    }

    /// Partials above half the sample rate alias. PolyBLEP must make the strongest alias far weaker than in a naive
    /// saw.
    #[test]
    fn the_saw_is_band_limited() {
        let hz = 5_000.0; // the fifth partial, 25 kHz, folds to 23 kHz; the seventh, 35 kHz, folds to 13 kHz
        let level = |wave: &dyn Fn(&mut Phase) -> f32, at: f32| {
            let (mut phase, mut re, mut im) = (Phase::default(), 0.0_f64, 0.0_f64);
            for n in 0..48_000 {
                let x = f64::from(wave(&mut phase));
                let angle = std::f64::consts::TAU * f64::from(at) * f64::from(n) / 48_000.0;
                (re, im) = (re + x * angle.cos(), im + x * angle.sin());
            }
            (re * re + im * im).sqrt() / 24_000.0
        };
        let naive = |p: &mut Phase| 2.0 * p.advance(hz) - 1.0;
        let blep = |p: &mut Phase| p.saw(hz);
        assert!(level(&blep, 13_000.0) < 0.25 * level(&naive, 13_000.0));
        assert!(level(&blep, hz) > 0.8 * level(&naive, hz));
    }

    #[test]
    fn envelopes_start_and_end_at_zero_without_a_jump() {
        let envelope = Envelope { attack: 0.003, decay: 0.16, sustain: 0.3, release: 0.2 };
        let levels: Vec<f32> =
            (0..=envelope.samples(9600)).map(|n| envelope.level(n as f32 * DT, 9600.0 * DT)).collect();
        assert_eq!((levels[0], levels[levels.len() - 1]), (0.0, 0.0));
        assert!(levels.windows(2).all(|w| (w[1] - w[0]).abs() < 0.02));
        assert!(levels.iter().any(|&l| l > 0.99));
    }

    #[test]
    fn the_far_side_of_a_hard_pan_is_silent() {
        assert_eq!(pan_gains(-1.0)[1], 0.0);
        assert_eq!(pan_gains(1.0)[0], 0.0);
        assert!((pan_gains(0.0)[0] - std::f32::consts::FRAC_1_SQRT_2).abs() < 1e-4);
    }
}
