//! Generated drums and instruments with known strokes and notes: several kits, timbres, patterns, tempos and mixes.

#![allow(dead_code)] // Not every user needs all of these functions.

use std::f64::consts::TAU;

pub(crate) use super::events::{f_of, matches};

use mariana_music::StereoFrame;

pub(crate) const RATE: u32 = 48_000;

/// The drums that the analysis tells apart, and a tom, which is none of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Struck {
    Kick,
    Snare,
    Hat,
    Tom,
}

/// Kits of drums. Each seed gives a kit other parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kit {
    Acoustic,
    Analog,
    Dance,
    Dusty,
    /// Triangle kicks, snares of filtered noise, hats of square waves.
    Electro,
    /// Hard kicks and long snares of three modes.
    Rock,
}

impl Kit {
    pub(crate) const TUNED: [Self; 4] = [Self::Acoustic, Self::Analog, Self::Dance, Self::Dusty];
    pub(crate) const HELD_OUT: [Self; 2] = [Self::Electro, Self::Rock];

    /// Returns a factor from 1 / `most` to `most`, by which the parameters of tuned kits vary; 1 for the others.
    fn spread(self, random: &mut Random, most: f64) -> f64 {
        if Self::HELD_OUT.contains(&self) { 1.0 } else { most.powf(random.white()) }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Timbre {
    Flute,
    Square,
    Strings,
    Saw,
    Organ,
    Plucked,
}

impl Timbre {
    pub(crate) const TUNED: [Self; 3] = [Self::Flute, Self::Square, Self::Strings];
    pub(crate) const HELD_OUT: [Self; 3] = [Self::Saw, Self::Organ, Self::Plucked];

    /// The amplitude of partial `k`, from 1, of a tone of `hz`, `age` seconds after its start.
    fn partial(self, k: usize, hz: f64, age: f64) -> f64 {
        let n = k as f64;
        match self {
            Self::Flute => [1.0, 0.25, 0.12, 0.04].get(k - 1).copied().unwrap_or(0.0),
            Self::Square if k.is_multiple_of(2) => 0.0,
            Self::Square => 0.8 / n,
            Self::Strings => 0.7 * n.powf(-1.3) * (-(n * hz / 6_000.0).powi(2)).exp(),
            Self::Saw => 0.6 / n,
            Self::Organ => [0.7, 0.5, 0.3, 0.35, 0.0, 0.2, 0.0, 0.15].get(k - 1).copied().unwrap_or(0.0),
            Self::Plucked => 0.9 / n.powf(1.1) * (-age * (1.5 + 0.8 * n)).exp(),
        }
    }

    fn envelope(self, age: f64, left: f64) -> f64 {
        let attack = match self {
            Self::Flute | Self::Strings => 0.03,
            Self::Square | Self::Saw | Self::Organ => 0.008,
            Self::Plucked => 0.002,
        };
        (age / attack).min(1.0) * (left / 0.03).clamp(0.0, 1.0)
    }
}

/// A note: start and end in seconds, semitones above A0, loudness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Played {
    pub from: f64,
    pub to: f64,
    pub semitone: usize,
    pub loud: f64,
}

pub(crate) fn semitone_hz(semitone: f64) -> f64 {
    27.5 * (semitone / 12.0).exp2()
}

/// A linear congruential generator.
#[derive(Clone, Debug)]
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        let mut random = Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0x51_7C_C1);
        random.unit();
        random
    }

    /// Returns a number in 0..1.
    pub(crate) fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    pub(crate) fn below(&mut self, count: usize) -> usize {
        ((self.unit() * count as f64) as usize).min(count - 1)
    }

    pub(crate) fn chance(&mut self, probability: f64) -> bool {
        self.unit() < probability
    }

    fn white(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }
}

/// Removes low frequencies with `order` one-pole filters.
fn high_passed(sound: &mut [f64], hz: f64, order: usize) {
    let keep = (-TAU * hz / f64::from(RATE)).exp();
    for _ in 0..order {
        let (mut last, mut out) = (0.0, 0.0);
        for x in sound.iter_mut() {
            out = keep * (out + *x - last);
            last = *x;
            *x = out;
        }
    }
}

fn low_passed(sound: &mut [f64], hz: f64) {
    let keep = (-TAU * hz / f64::from(RATE)).exp();
    let mut out = 0.0;
    for x in sound.iter_mut() {
        out = keep * out + (1.0 - keep) * *x;
        *x = out;
    }
}

fn sound(seconds: f64, mut value: impl FnMut(f64) -> f64) -> Vec<f64> {
    (0..(seconds * f64::from(RATE)) as usize)
        .map(|n| {
            let t = n as f64 / f64::from(RATE);
            value(t) * (t / 0.0005).min(1.0)
        })
        .collect()
}

fn leveled(mut sound: Vec<f64>, peak: f64) -> Vec<f64> {
    let largest = sound.iter().fold(1e-9_f64, |largest, x| largest.max(x.abs()));
    sound.iter_mut().for_each(|x| *x *= peak / largest);
    sound
}

fn kick(kit: Kit, random: &mut Random) -> Vec<f64> {
    let [end, sweep, fast, decay, click] = match kit {
        Kit::Acoustic => [random.between(52.0, 72.0), 60.0, 0.015, 0.09, 0.25],
        Kit::Analog => [random.between(42.0, 55.0), random.between(30.0, 90.0), 0.03, 0.25, 0.05],
        Kit::Dance => [random.between(46.0, 58.0), random.between(150.0, 300.0), 0.022, 0.13, 0.2],
        Kit::Dusty => [random.between(58.0, 85.0), 70.0, 0.02, 0.07, 0.12],
        Kit::Electro => [random.between(44.0, 62.0), random.between(80.0, 250.0), 0.026, 0.16, 0.08],
        Kit::Rock => [random.between(50.0, 75.0), random.between(60.0, 120.0), 0.012, 0.11, 0.4],
    };
    let [end, sweep, fast, decay, click] = [
        end * kit.spread(random, 1.1),
        sweep * kit.spread(random, 1.8),
        fast * kit.spread(random, 1.5),
        decay * kit.spread(random, 1.6),
        click * kit.spread(random, 2.0),
    ];
    let mut noise = random.clone();
    let body = sound(5.0 * decay, |t| {
        let turns = end * t + sweep * fast * (1.0 - (-t / fast).exp());
        let wave = match kit {
            Kit::Electro => 4.0 * ((turns + 0.75).fract() - 0.5).abs() - 1.0,
            Kit::Rock => (2.0 * (TAU * turns).sin()).tanh(),
            _ => (TAU * turns).sin(),
        };
        wave * (-t / decay).exp() + click * noise.white() * (-t / 0.004).exp()
    });
    leveled(body, 0.9)
}

fn snare(kit: Kit, random: &mut Random) -> Vec<f64> {
    let [hz, body, body_decay, decay, cut] = match kit {
        Kit::Acoustic => [random.between(175.0, 220.0), 0.6, 0.06, 0.09, 300.0],
        Kit::Analog => [random.between(165.0, 190.0), 0.7, 0.07, 0.08, 900.0],
        Kit::Dance => [random.between(190.0, 240.0), 0.4, 0.05, 0.12, 500.0],
        Kit::Dusty => [random.between(170.0, 230.0), 0.5, 0.05, 0.06, 200.0],
        Kit::Electro => [random.between(180.0, 230.0), 0.4, 0.06, 0.13, 700.0],
        Kit::Rock => [random.between(170.0, 210.0), 0.6, 0.08, 0.14, 250.0],
    };
    let ratio = random.between(1.55, 1.85);
    let [hz, body, body_decay, decay, cut] = [
        hz * kit.spread(random, 1.15),
        body * kit.spread(random, 1.6),
        body_decay * kit.spread(random, 1.5),
        decay * kit.spread(random, 1.5),
        cut * kit.spread(random, 1.7),
    ];
    let dull = 8_000.0 * kit.spread(random, 2.0);
    let mut noise = random.clone();
    let mut wires = sound(6.0 * decay, |t| noise.white() * (-t / decay).exp());
    high_passed(&mut wires, cut, 1);
    match kit {
        Kit::Dusty => low_passed(&mut wires, 5_000.0),
        Kit::Electro => low_passed(&mut wires, 9_000.0),
        Kit::Rock => {}
        _ => low_passed(&mut wires, dull),
    }
    let wires = leveled(wires, 0.7);
    let modes = sound(6.0 * decay, |t| {
        let mode = |r: f64| (TAU * r * hz * t).sin();
        let third = if kit == Kit::Rock { 0.5 * mode(2.3) } else { 0.0 };
        let bent = if kit == Kit::Electro { (TAU * hz * t + 1.5 * mode(ratio)).sin() } else { mode(1.0) };
        body * (bent + 0.5 * mode(ratio) + third) * (-t / body_decay).exp()
    });
    leveled(wires.iter().zip(&modes).map(|(a, b)| a + b).collect(), 0.8)
}

fn hat(kit: Kit, random: &mut Random, open: bool) -> Vec<f64> {
    let decay = if open { random.between(0.12, 0.3) } else { random.between(0.015, 0.045) };
    let ratios = [2.0, 3.0, 4.16, 5.43, 6.79, 8.21];
    let base = random.between(380.0, 480.0);
    let metal = match kit {
        Kit::Acoustic => 0.3,
        Kit::Analog => 0.7,
        Kit::Dance => 0.4,
        Kit::Dusty | Kit::Rock => 0.1,
        Kit::Electro => 1.0,
    };
    let metal = (metal * kit.spread(random, 1.6)).min(1.0);
    let mut noise = random.clone();
    let mut struck = sound(5.0 * decay, |t| {
        let ring = ratios.iter().map(|ratio| {
            let wave = (TAU * base * ratio * t).sin();
            if kit == Kit::Electro { wave.signum() } else { (3.0 * wave).sin() }
        });
        (metal * ring.sum::<f64>() / 3.0 + (1.0 - metal) * noise.white()) * (-t / decay).exp()
    });
    let cut = if kit == Kit::Dusty { 4_000.0 } else { random.between(6_000.0, 8_000.0) };
    let cut = cut * kit.spread(random, 1.5);
    high_passed(&mut struck, cut, 3);
    if kit == Kit::Dusty {
        low_passed(&mut struck, 9_000.0);
    }
    leveled(struck, 0.4)
}

fn tom(random: &mut Random) -> Vec<f64> {
    let hz = random.between(90.0, 170.0);
    let mut noise = random.clone();
    leveled(
        sound(0.5, |t| {
            (TAU * (hz * t + 0.4 * (1.0 - (-t / 0.03).exp()))).sin() * (-t / 0.12).exp()
                + 0.1 * noise.white() * (-t / 0.006).exp()
        }),
        0.8,
    )
}

/// Adds a tone to `out`.
pub(crate) fn play_note(out: &mut [f64], timbre: Timbre, note: Played) {
    let rate = f64::from(RATE);
    let hz = semitone_hz(note.semitone as f64);
    let length = note.to - note.from;
    let first = (note.from * rate).max(0.0) as usize;
    let partials = ((9_000.0 / hz) as usize).clamp(1, 24);
    for k in 1..=partials {
        let (sine, cosine) = (TAU * k as f64 * hz / rate).sin_cos();
        let mut turning = (TAU * 0.37 * (k * k) as f64).sin_cos();
        let mut amplitude = 0.0;
        for (n, x) in out.iter_mut().skip(first).take((length * rate) as usize).enumerate() {
            if n.is_multiple_of(32) {
                let age = n as f64 / rate;
                amplitude = note.loud * timbre.envelope(age, length - age) * timbre.partial(k, hz, age);
            }
            *x += amplitude * turning.0;
            turning = (turning.0 * cosine + turning.1 * sine, turning.1 * cosine - turning.0 * sine);
        }
    }
}

/// What a generated track contains.
#[derive(Clone, Debug)]
pub(crate) struct Track {
    pub frames: Vec<StereoFrame>,
    pub strokes: Vec<(f64, Struck)>,
    /// The notes of bass, chords and melody.
    pub notes: Vec<Played>,
    pub melody: Vec<Played>,
    /// Times of chords, their roots from C, and true for minor.
    pub chords: Vec<(f64, usize, bool)>,
}

/// How a track is generated.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mix {
    pub seed: u64,
    pub kit: Option<Kit>,
    pub timbre: Timbre,
    /// The level of the music relative to the drums in decibels, by power; `None` for drums alone.
    pub music_db: Option<f64>,
    pub seconds: f64,
}

fn power(sound: &[f64]) -> f64 {
    sound.iter().map(|x| x * x).sum::<f64>() / sound.len().max(1) as f64
}

/// The probability of each drum on each sixteenth of a bar, as digits in tenths.
const STYLES: [[&str; 3]; 6] = [
    ["9001000090010000", "0000900100009001", "9060906090609060"],
    ["9000900090009000", "0000900000009000", "0090009000900090"],
    ["9090000000900100", "0000900101009001", "9393939393939393"],
    ["9000000100000000", "0000000090000000", "9090909090909090"],
    ["9001001090000300", "0000900000009002", "0000000000000000"],
    ["9000000090000100", "0000600000006000", "8383838383838383"],
];

fn drums(mix: &Mix, kit: Kit, times: &[f64], random: &mut Random) -> (Vec<f64>, Vec<(f64, Struck)>) {
    let mut out = vec![0.0; (mix.seconds * f64::from(RATE)) as usize];
    let mut strokes = Vec::new();
    let sounds =
        [kick(kit, random), snare(kit, random), hat(kit, random, false), hat(kit, random, true), tom(random)];
    let style = &STYLES[random.below(STYLES.len())];
    let hat_loud = random.between(0.35, 1.0);
    let has_toms = random.chance(0.25);
    for (step, &time) in times.iter().enumerate() {
        let fill = has_toms && step % 64 >= 60;
        for (row, drum) in [Struck::Kick, Struck::Snare, Struck::Hat].into_iter().enumerate() {
            let digit = style[row].as_bytes()[step % 16] - b'0';
            if !random.chance(f64::from(digit) / 9.0) || (fill && drum != Struck::Kick) {
                continue;
            }
            let accent = if digit > 4 { 1.0 } else { 0.7 };
            let loud = accent * random.between(0.75, 1.0) * if drum == Struck::Hat { hat_loud } else { 1.0 };
            let open = drum == Struck::Hat && random.chance(0.1);
            let at = (time + 0.004 * random.white()).max(0.0);
            add(&mut out, &sounds[if open { 3 } else { row }], at, loud);
            strokes.push((at, drum));
        }
        if fill {
            add(&mut out, &sounds[4], time, random.between(0.6, 1.0));
            strokes.push((time, Struck::Tom));
        }
    }
    (out, strokes)
}

fn add(out: &mut [f64], sound: &[f64], at: f64, loud: f64) {
    let first = (at * f64::from(RATE)) as usize;
    for (x, value) in out.iter_mut().skip(first).zip(sound) {
        *x += loud * value;
    }
}

/// Returns the times of the sixteenths, in seconds, and the mean time between them.
fn sixteenths(mix: &Mix, random: &mut Random) -> (Vec<f64>, f64) {
    let tempo = random.between(75.0, 170.0);
    let swing = if random.chance(0.35) { random.between(0.54, 0.67) } else { 0.5 };
    let sixteenth = 15.0 / tempo;
    let start = random.between(0.3, 0.8);
    let count = ((mix.seconds - 1.0 - start) / sixteenth) as usize;
    let times = (0..count).map(|step| {
        let pair = 2.0 * (step / 2) as f64;
        start + sixteenth * (pair + if step % 2 == 0 { 0.0 } else { 2.0 * swing })
    });
    (times.collect(), sixteenth)
}

/// Mixes drums and music, at this level relative to full scale.
fn mixed(mix: &Mix, beaten: &[f64], music: &[f64], loudest: f64) -> Vec<StereoFrame> {
    let level = match mix.music_db {
        Some(db) if mix.kit.is_some() => {
            (power(beaten) / power(music).max(1e-12)).sqrt() * 10_f64.powf(db / 20.0)
        }
        _ => 0.5,
    };
    let mixed: Vec<f64> = beaten.iter().zip(music).map(|(a, b)| a + level * b).collect();
    let peak = mixed.iter().fold(1e-9_f64, |peak, x| peak.max(x.abs()));
    mixed.iter().map(|x| [(loudest / peak * x) as f32; 2]).collect()
}

/// Generates a track of drums, a bass, chords and a melody.
pub(crate) fn track(mix: &Mix) -> Track {
    let mut random = Random::new(mix.seed);
    let (times, sixteenth) = sixteenths(mix, &mut random);
    let (beaten, strokes) = match mix.kit {
        Some(kit) => drums(mix, kit, &times, &mut random),
        None => (vec![0.0; (mix.seconds * f64::from(RATE)) as usize], Vec::new()),
    };

    let (mut music, mut notes, mut melody, mut chords) = (vec![0.0; beaten.len()], vec![], vec![], vec![]);
    if mix.music_db.is_some() {
        let key = random.below(12);
        let bass_voice = [Timbre::Plucked, Timbre::Square, Timbre::Flute][random.below(3)];
        let bass_every = [2, 4, 8][random.below(3)];
        let stabs = random.chance(0.3);
        let mut tune = 40 + random.below(12);
        let scale = [0, 2, 4, 5, 7, 9, 11];
        for bar in 0..times.len() / 16 {
            let at = |step: usize| times.get(bar * 16 + step).copied().unwrap_or(mix.seconds - 1.0);
            let (degree, minor) =
                [(0, false), (9, true), (5, false), (7, false), (2, true), (4, true)][random.below(6)];
            // Semitone 3 is C1.
            let root = (key + degree) % 12;
            chords.push((at(0), root, minor));
            let end = times.get(bar * 16 + 16).copied().unwrap_or(mix.seconds - 1.0);
            let mut play =
                |timbre: Timbre, from: f64, to: f64, semitone: usize, loud: f64, notes: &mut Vec<Played>| {
                    let note = Played { from, to, semitone, loud };
                    play_note(&mut music, timbre, note);
                    // A plucked string has fallen by 20 dB after a second.
                    let heard = if timbre == Timbre::Plucked { to.min(from + 1.0) } else { to };
                    notes.push(Played { to: heard, ..note });
                };
            for step in (0..16).step_by(bass_every) {
                let to = if step + bass_every < 16 { at(step + bass_every) } else { end };
                let semitone = 3 + root + if root < 4 { 12 } else { 0 };
                play(bass_voice, at(step), to - 0.02, semitone, 0.35, &mut notes);
            }
            let triad = [root, root + if minor { 3 } else { 4 }, root + 7];
            for tone in triad {
                let semitone = 27 + tone % 12 + if tone % 12 < 4 { 12 } else { 0 };
                if stabs {
                    for step in [2, 6, 10, 14] {
                        play(mix.timbre, at(step), at(step) + 1.5 * sixteenth, semitone, 0.2, &mut notes);
                    }
                } else {
                    play(mix.timbre, at(0), end - 0.01, semitone, 0.16, &mut notes);
                }
            }
            let mut step = 0;
            while step < 16 {
                let length = [2, 2, 4, 6][random.below(4)].min(16 - step);
                tune = (tune + random.below(9)).saturating_sub(4).clamp(39, 62);
                while !scale.contains(&((tune + 9 + 12 - key) % 12)) {
                    tune += 1;
                }
                let to = if step + length < 16 { at(step + length) } else { end };
                if random.chance(0.85) {
                    let mut line = vec![];
                    play(mix.timbre, at(step), to - 0.015, tune, 0.3, &mut line);
                    notes.extend(&line);
                    melody.extend(line);
                }
                step += length;
            }
        }
    }
    let frames = mixed(mix, &beaten, &music, random.between(0.25, 0.95));
    Track { frames, strokes, notes, melody, chords }
}

/// Generates steady noise: white, dull, brown or hissing.
pub(crate) fn steady_noise(seed: u64, seconds: f64) -> Track {
    let mut random = Random::new(seed);
    let mut noise: Vec<f64> = (0..(seconds * f64::from(RATE)) as usize).map(|_| random.white()).collect();
    match seed % 4 {
        0 => {}
        1 => low_passed(&mut noise, 1_000.0),
        2 => low_passed(&mut noise, 50.0),
        _ => high_passed(&mut noise, 5_000.0, 2),
    }
    let frames = leveled(noise, 0.5).iter().map(|x| [*x as f32; 2]).collect();
    Track { frames, strokes: vec![], notes: vec![], melody: vec![], chords: vec![] }
}
