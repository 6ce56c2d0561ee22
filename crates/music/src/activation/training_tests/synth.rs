//! Sounds of generated training music: instruments and drums.

use std::f32::consts::TAU;

use super::effects::{high_passed, low_passed};

pub(super) const RATE: f32 = 44_100.0;

/// A linear congruential generator.
#[derive(Clone, Debug)]
pub(super) struct Random(u64);

impl Random {
    pub(super) fn new(seed: u64) -> Self {
        let mut random = Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0x51_7C_C1);
        random.unit();
        random.unit();
        random
    }

    /// Returns a number in 0..1.
    pub(super) fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1_u64 << 24) as f32
    }

    pub(super) fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }

    /// Returns a number between two limits, equally likely in each ratio.
    pub(super) fn ratio(&mut self, low: f32, high: f32) -> f32 {
        low * (high / low).powf(self.unit())
    }

    pub(super) fn below(&mut self, count: usize) -> usize {
        ((self.unit() * count as f32) as usize).min(count - 1)
    }

    pub(super) fn chance(&mut self, probability: f32) -> bool {
        self.unit() < probability
    }

    pub(super) fn white(&mut self) -> f32 {
        2.0 * self.unit() - 1.0
    }

    /// Returns a number of nearly normal distribution.
    pub(super) fn normal(&mut self) -> f32 {
        (0..4).map(|_| self.white()).sum::<f32>() * 0.866
    }

    pub(super) fn one<T: Copy>(&mut self, of: &[T]) -> T {
        of[self.below(of.len())]
    }
}

const TABLE: usize = 1024;

/// An instrument: two wave tables for each octave, which fade at different speeds, and an envelope.
pub(super) struct Instrument {
    bright: Vec<Vec<f32>>,
    dark: Vec<Vec<f32>>,
    attack: f32,
    release: f32,
    /// Time constants of the decay of the bright and of the dark table, in seconds.
    decay: [f32; 2],
    vibrato: (f32, f32),
    breath: f32,
}

/// How the tones of an instrument begin and end.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Touch {
    Pad,
    Held,
    Plucked,
}

impl Instrument {
    pub(super) fn new(touch: Touch, random: &mut Random) -> Self {
        let slope = random.between(0.6, 2.6);
        let odd = random.chance(0.25);
        let rough = random.between(0.0, 1.0);
        let formant = random.ratio(300.0, 3_000.0);
        let strength = if random.chance(0.4) { random.between(0.5, 3.0) } else { 0.0 };
        let weights: Vec<f32> = (0..64)
            .map(|n| {
                let n = n as f32 + 1.0;
                let even = if odd && (n as usize).is_multiple_of(2) { 0.03 } else { 1.0 };
                even * n.powf(-slope) * (1.0 - rough * random.unit())
            })
            .collect();
        let phases: Vec<f32> = (0..64).map(|_| random.unit()).collect();
        let table = |octave: usize, darker: f32| {
            let highest = 27.5 * 2_f32.powi(octave as i32 + 1);
            let mut table = vec![0.0; TABLE];
            for (index, (weight, phase)) in weights.iter().zip(&phases).enumerate() {
                let n = index as f32 + 1.0;
                if n * highest > 15_000.0 && index > 0 {
                    break;
                }
                let away = (0.75 * n * highest / formant).log2();
                let weight = weight * n.powf(-darker) * (1.0 + strength * (-away * away).exp());
                for (place, value) in table.iter_mut().enumerate() {
                    *value += weight * (TAU * (n * place as f32 / TABLE as f32 + phase)).sin();
                }
            }
            let power = table.iter().map(|x| x * x).sum::<f32>() / TABLE as f32;
            table.iter_mut().for_each(|x| *x /= power.sqrt().max(1e-6));
            table.push(table[0]);
            table
        };
        let (attack, release, decay) = match touch {
            Touch::Pad => (random.ratio(0.03, 0.6), random.ratio(0.05, 0.5), [20.0, 20.0]),
            Touch::Held => {
                (random.ratio(0.004, 0.06), random.ratio(0.02, 0.1), [random.ratio(0.3, 5.0), 8.0])
            }
            Touch::Plucked => {
                let long = random.ratio(0.08, 1.5);
                (random.ratio(0.001, 0.006), random.ratio(0.02, 0.2), [long * random.between(0.1, 0.6), long])
            }
        };
        let vibrato =
            if touch == Touch::Plucked || random.chance(0.5) { 0.0 } else { random.between(0.001, 0.012) };
        Self {
            bright: (0..8).map(|octave| table(octave, 0.0)).collect(),
            dark: (0..8).map(|octave| table(octave, 0.8)).collect(),
            attack,
            release,
            decay,
            vibrato: (vibrato, random.between(4.0, 7.0)),
            breath: if random.chance(0.2) { random.between(0.0, 0.3) } else { 0.0 },
        }
    }

    /// Adds a tone. The pitch is in semitones above A0, times are in seconds.
    pub(super) fn play(
        &self,
        out: &mut [f32],
        from: f32,
        to: f32,
        pitch: f32,
        loud: f32,
        random: &mut Random,
    ) {
        let hz = 27.5 * (pitch / 12.0).exp2();
        let octave = ((pitch / 12.0).max(0.0) as usize).min(self.bright.len() - 1);
        let (bright, dark) = (&self.bright[octave], &self.dark[octave]);
        let first = (from.max(0.0) * RATE) as usize;
        let length = (to - from).max(0.01);
        let count = ((length + 3.0 * self.release) * RATE) as usize;
        let (mut phase, mut levels, mut rise) = (random.unit() * TABLE as f32, [0.0_f32; 2], 0.0);
        let step = hz * TABLE as f32 / RATE;
        let mut turned = step;
        let mut noise = random.clone();
        for (n, x) in out.iter_mut().skip(first).take(count).enumerate() {
            if n % 32 == 0 {
                let age = n as f32 / RATE;
                let held = if age < length { 1.0 } else { (-(age - length) / self.release * 2.5).exp() };
                rise = (age / self.attack).min(1.0);
                levels = self.decay.map(|decay| 0.5 * loud * held * (-age / decay).exp());
                turned =
                    step * (1.0 + self.vibrato.0 * (TAU * self.vibrato.1 * age).sin() * (age * 4.0).min(1.0));
            }
            let (whole, rest) = (phase as usize, phase.fract());
            let at = |table: &[f32]| table[whole] + rest * (table[whole + 1] - table[whole]);
            let mut value = levels[0] * at(bright) + levels[1] * at(dark);
            if self.breath > 0.0 {
                value += self.breath * levels[1] * noise.white();
            }
            *x += rise * value;
            phase += turned;
            if phase >= TABLE as f32 {
                phase -= TABLE as f32;
            }
        }
    }
}

fn sound(seconds: f32, mut value: impl FnMut(f32) -> f32) -> Vec<f32> {
    (0..(seconds.min(3.0) * RATE) as usize)
        .map(|n| {
            let t = n as f32 / RATE;
            value(t) * (t / 0.0005).min(1.0)
        })
        .collect()
}

fn leveled(mut sound: Vec<f32>, peak: f32) -> Vec<f32> {
    let largest = sound.iter().fold(1e-9_f32, |largest, x| largest.max(x.abs()));
    sound.iter_mut().for_each(|x| *x *= peak / largest);
    sound
}

/// Percussion instruments.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Drum {
    Kick,
    Snare,
    Clap,
    Rim,
    Hat,
    Open,
    Ride,
    Shaker,
    Tom,
    Conga,
    Bell,
    Crash,
    Timpani,
}

impl Drum {
    pub(super) const ALL: [Self; 13] = [
        Self::Kick,
        Self::Snare,
        Self::Clap,
        Self::Rim,
        Self::Hat,
        Self::Open,
        Self::Ride,
        Self::Shaker,
        Self::Tom,
        Self::Conga,
        Self::Bell,
        Self::Crash,
        Self::Timpani,
    ];

    /// Returns a stroke with random parameters.
    pub(super) fn sound(self, random: &mut Random) -> Vec<f32> {
        match self {
            Self::Kick => {
                let bend = random.ratio(20.0, 320.0);
                let decay = random.ratio(0.05, 0.3);
                let click = random.ratio(0.02, 0.6);
                pitched(random, (42.0, 85.0), bend, decay, click)
            }
            Self::Tom => {
                let decay = random.ratio(0.08, 0.3);
                pitched(random, (80.0, 220.0), 30.0, decay, 0.1)
            }
            Self::Conga => {
                let decay = random.ratio(0.04, 0.15);
                pitched(random, (180.0, 420.0), 10.0, decay, 0.2)
            }
            Self::Timpani => {
                let decay = random.ratio(0.3, 0.9);
                pitched(random, (60.0, 130.0), 4.0, decay, 0.08)
            }
            Self::Rim => {
                let decay = random.ratio(0.006, 0.02);
                pitched(random, (700.0, 2_200.0), 100.0, decay, 0.4)
            }
            Self::Bell => {
                let (hz, ratio) = (random.ratio(500.0, 1_500.0), random.between(1.4, 1.6));
                let decay = random.ratio(0.03, 0.3);
                let tone = |t: f32| {
                    ((TAU * hz * t).sin() * 2.0).tanh() + ((TAU * ratio * hz * t).sin() * 2.0).tanh()
                };
                leveled(sound(5.0 * decay, |t| tone(t) * (-t / decay).exp()), 0.4)
            }
            Self::Snare => {
                let (hz, ratio) = (random.between(150.0, 260.0), random.between(1.5, 1.9));
                let (body_decay, decay) = (random.ratio(0.03, 0.1), random.ratio(0.04, 0.2));
                let body = random.between(0.1, 0.9);
                let (low, high) = (random.ratio(150.0, 1_200.0), random.ratio(3_000.0, 14_000.0));
                let mut noise = random.clone();
                let mut wires = sound(6.0 * decay, |t| noise.white() * (-t / decay).exp());
                high_passed(&mut wires, low);
                low_passed(&mut wires, high);
                let wires = leveled(wires, 0.7);
                let modes = sound(6.0 * decay, |t| {
                    body * ((TAU * hz * t).sin() + 0.5 * (TAU * ratio * hz * t).sin())
                        * (-t / body_decay).exp()
                });
                leveled(wires.iter().zip(&modes).map(|(a, b)| a + b).collect(), 0.8)
            }
            Self::Clap => {
                let (decay, low) = (random.ratio(0.04, 0.15), random.ratio(600.0, 1_500.0));
                let mut noise = random.clone();
                let mut burst = sound(6.0 * decay, |t| {
                    let bursts =
                        if t < 0.03 { (-(t % 0.01) / 0.004).exp() } else { (-(t - 0.03) / decay).exp() };
                    noise.white() * bursts
                });
                high_passed(&mut burst, low);
                low_passed(&mut burst, 8.0 * low);
                leveled(burst, 0.7)
            }
            Self::Hat => metal(random, (0.012, 0.06)),
            Self::Open => metal(random, (0.1, 0.35)),
            Self::Ride => metal(random, (0.15, 0.5)),
            Self::Crash => metal(random, (0.4, 1.0)),
            Self::Shaker => {
                let (rise, decay) = (random.ratio(0.005, 0.05), random.ratio(0.015, 0.06));
                let low = random.ratio(3_000.0, 7_000.0);
                let mut noise = random.clone();
                let mut shaken = sound(rise + 5.0 * decay, |t| {
                    noise.white() * if t < rise { t / rise } else { (-(t - rise) / decay).exp() }
                });
                high_passed(&mut shaken, low);
                leveled(shaken, 0.3)
            }
        }
    }
}

fn pitched(random: &mut Random, hz: (f32, f32), bend: f32, decay: f32, click: f32) -> Vec<f32> {
    let hz = random.ratio(hz.0, hz.1);
    let fast = random.ratio(0.01, 0.04);
    let drive = random.ratio(0.3, 4.0);
    let mut noise = random.clone();
    leveled(
        sound(5.0 * decay, |t| {
            let turns = hz * t + bend * fast * (1.0 - (-t / fast).exp());
            (drive * (TAU * turns).sin()).tanh() * (-t / decay).exp()
                + click * noise.white() * (-t / 0.004).exp()
        }),
        0.9,
    )
}

fn metal(random: &mut Random, decay: (f32, f32)) -> Vec<f32> {
    let decay = random.ratio(decay.0, decay.1);
    let base = random.between(300.0, 550.0);
    let ringing = random.unit();
    let low = random.ratio(2_500.0, 9_000.0);
    let mut noise = random.clone();
    let mut struck = sound(4.0 * decay, |t| {
        let ring: f32 =
            [2.0, 3.0, 4.16, 5.43, 6.79, 8.21].iter().map(|r| (TAU * base * r * t).sin().signum()).sum();
        (ringing * ring / 4.0 + (1.0 - ringing) * noise.white()) * (-t / decay).exp()
    });
    high_passed(&mut struck, low);
    high_passed(&mut struck, low);
    leveled(struck, 0.4)
}
