//! Synthetic songs with known beats, bars, sections, builds, drops and key, in several styles and forms.

#[path = "measures.rs"]
mod measures;

use std::f64::consts::TAU;

pub(crate) use measures::*;

use mariana_music::{Meter, Mode, StereoFrame, Tonality};

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Style {
    Rock,
    FourOnTheFloor,
    Syncopated,
    HalfTime,
    Jazz,
    Ballad,
    Waltz,
    SixEight,
}

impl Style {
    pub(crate) const ALL: [Self; 8] = [
        Self::Rock,
        Self::FourOnTheFloor,
        Self::Syncopated,
        Self::HalfTime,
        Self::Jazz,
        Self::Ballad,
        Self::Waltz,
        Self::SixEight,
    ];

    pub(crate) fn meter(self) -> Meter {
        match self {
            Self::Waltz => Meter::ThreeFour,
            Self::SixEight => Meter::SixEight,
            _ => Meter::FourFour,
        }
    }

    /// Returns the strokes of a bar: the position in beats, the drum and the loudness of each stroke.
    fn strokes(self, swing: f64) -> Vec<(f64, Drum, f64)> {
        use Drum::{Hat, Kick, Ride, Snare};
        let beats = self.meter().beats() as u32;
        let eighths = |drum, loud: f64| {
            (0..beats).flat_map(move |beat| {
                [(f64::from(beat), drum, loud), (f64::from(beat) + swing, drum, 0.7 * loud)]
            })
        };
        let snares = |loud| [(1.0, Snare, loud), (3.0, Snare, loud)];
        match self {
            Self::Rock => eighths(Hat, 0.3)
                .chain([(0.0, Kick, 0.9), (2.0, Kick, 0.9), (2.0 + swing, Kick, 0.6)])
                .chain(snares(0.7))
                .collect(),
            Self::FourOnTheFloor => (0..4)
                .flat_map(|beat| [(f64::from(beat), Kick, 0.9), (f64::from(beat) + swing, Hat, 0.4)])
                .chain(snares(0.5))
                .collect(),
            Self::Syncopated => eighths(Hat, 0.3)
                .chain([(0.0, Kick, 0.9), (1.0 + swing, Kick, 0.7), (2.0 + swing, Kick, 0.6)])
                .chain(snares(0.7))
                .collect(),
            Self::HalfTime => eighths(Hat, 0.3).chain([(0.0, Kick, 0.9), (2.0, Snare, 0.8)]).collect(),
            Self::Jazz => [0.0, 1.0, 1.0 + swing, 2.0, 3.0, 3.0 + swing]
                .map(|at| (at, Ride, if at.fract() == 0.0 { 0.5 } else { 0.35 }))
                .into_iter()
                .chain([(1.0, Hat, 0.5), (3.0, Hat, 0.5)])
                .chain((0..4).map(|beat| (f64::from(beat), Kick, 0.35)))
                .collect(),
            Self::Ballad => eighths(Hat, 0.12).chain([(0.0, Kick, 0.5)]).chain(snares(0.3)).collect(),
            Self::Waltz => {
                vec![(0.0, Kick, 0.9), (1.0, Hat, 0.5), (2.0, Hat, 0.5), (1.0, Snare, 0.3), (2.0, Snare, 0.3)]
            }
            Self::SixEight => (0..6)
                .map(|eighth| (f64::from(eighth) / 3.0, Hat, 0.35))
                .chain([(0.0, Kick, 0.9), (1.0, Snare, 0.7), (5.0 / 3.0, Kick, 0.4)])
                .collect(),
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Drum {
    Kick,
    Snare,
    Hat,
    Ride,
    Crash,
    Tom,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) enum Voice {
    #[default]
    Soft,
    Organ,
    Bright,
}

impl Voice {
    fn partials(self) -> &'static [f64] {
        match self {
            Self::Soft => &[1.0, 0.15, 0.05],
            Self::Organ => &[0.8, 0.6, 0.0, 0.4, 0.0, 0.2, 0.0, 0.15],
            Self::Bright => &[0.7, 0.5, 0.4, 0.33, 0.28, 0.25, 0.22, 0.2, 0.18, 0.16, 0.15, 0.14],
        }
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) enum Kind {
    #[default]
    Plain,
    Build,
    /// Ends with a bar of silence.
    Pause,
    Crescendo,
    /// Has no drums and no bass.
    Break,
    /// Begins with a drop if a build or a pause precedes it.
    Drop,
}

#[derive(Clone, Debug, Default)]
pub(crate) struct Part {
    pub letter: char,
    pub bars: usize,
    /// The repeating chords, one per bar: the root in semitones above the tonic, and true for a minor third.
    pub chords: Vec<(u8, bool)>,
    pub drums: bool,
    pub bass: bool,
    pub voice: Voice,
    pub arpeggio: bool,
    pub loud: f64,
    pub kind: Kind,
    /// The notes of a melody.
    pub melody: Vec<Note>,
    /// Semitones by which chords, bass and melody are transposed.
    pub raised: u8,
}

/// A note of a melody.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Note {
    pub bar: usize,
    /// Start and length, in beats of the bar.
    pub beat: f64,
    pub length: f64,
    /// Semitones above the song's tonic.
    pub pitch: u8,
    pub voice: Voice,
}

#[derive(Clone, Debug)]
pub(crate) struct Song {
    pub style: Style,
    /// Beats per minute at the start and at the end.
    pub tempo: (f64, f64),
    /// The position of the second eighth in its beat.
    pub swing: f64,
    pub key: Tonality,
    /// Cents above a' = 440 Hz.
    pub cents: f64,
    pub form: Vec<Part>,
    pub seed: u32,
    /// The largest displacement of a beat from a steady tempo, in beats. The displacement varies smoothly.
    pub sway: f64,
}

#[derive(Clone, Debug, Default)]
pub(crate) struct Truth {
    pub beats: Vec<f64>,
    pub downbeats: Vec<f64>,
    pub borders: Vec<f64>,
    pub letters: Vec<(f64, f64, char)>,
    pub drops: Vec<f64>,
    /// The returns of drums and bass after breaks without a build or a pause. They are no drops, because a chorus enters
    /// in the same way. Live input reports them as drops.
    pub returns: Vec<f64>,
}

impl Truth {
    /// Returns the drops and the returns in the order of time.
    pub(crate) fn drops_and_returns(&self) -> Vec<f64> {
        let mut all = [&self.drops[..], &self.returns].concat();
        all.sort_by(f64::total_cmp);
        all
    }

    /// Returns the borders between parts with different letters.
    pub(crate) fn changes(&self) -> Vec<f64> {
        self.letters.windows(2).filter(|pair| pair[0].2 != pair[1].2).map(|pair| pair[1].0).collect()
    }

    /// Returns the letter of the part that covers most of a stretch.
    fn letter(&self, start: f64, end: f64) -> Option<char> {
        let common = |part: &&(f64, f64, char)| part.1.min(end) - part.0.max(start);
        self.letters.iter().max_by(|a, b| common(a).total_cmp(&common(b))).map(|(.., letter)| *letter)
    }
}

const MAJOR_CHORDS: [[(u8, bool); 4]; 4] = [
    [(0, false), (7, false), (9, true), (5, false)],
    [(5, false), (0, false), (5, false), (7, false)],
    [(9, true), (4, true), (5, false), (7, false)],
    [(0, false), (9, true), (2, true), (7, false)],
];
const MINOR_CHORDS: [[(u8, bool); 4]; 4] = [
    [(0, true), (8, false), (3, false), (10, false)],
    [(5, true), (0, true), (8, false), (7, false)],
    [(8, false), (10, false), (5, true), (0, true)],
    [(0, true), (5, true), (10, false), (3, false)],
];

pub(crate) fn chords(mode: Mode, number: usize) -> Vec<(u8, bool)> {
    match mode {
        Mode::Major => MAJOR_CHORDS[number % 4].to_vec(),
        Mode::Minor => MINOR_CHORDS[number % 4].to_vec(),
    }
}

/// Intro, verse, chorus, verse, chorus, bridge, chorus, outro.
pub(crate) fn pop(mode: Mode) -> Vec<Part> {
    let part = |letter, bars, number, drums, voice, arpeggio, loud| Part {
        letter,
        bars,
        chords: chords(mode, number),
        drums,
        bass: drums,
        voice,
        arpeggio,
        loud,
        ..Part::default()
    };
    let intro = part('I', 4, 0, false, Voice::Soft, false, 0.6);
    let verse = part('V', 8, 0, true, Voice::Organ, false, 0.6);
    let chorus = part('C', 8, 1, true, Voice::Bright, true, 1.0);
    let bridge = part('B', 8, 2, true, Voice::Soft, true, 0.5);
    let outro = part('O', 4, 3, false, Voice::Organ, false, 0.5);
    vec![intro, verse.clone(), chorus.clone(), verse, chorus.clone(), bridge, chorus, outro]
}

/// Intro, build, drop, break, build, drop, outro.
pub(crate) fn club(mode: Mode) -> Vec<Part> {
    let part = |letter, bars, number, drums, bass, voice, arpeggio, loud, kind| Part {
        letter,
        bars,
        chords: chords(mode, number),
        drums,
        bass,
        voice,
        arpeggio,
        loud,
        kind,
        ..Part::default()
    };
    let intro = part('I', 8, 0, true, false, Voice::Soft, false, 0.5, Kind::Plain);
    let build = part('U', 8, 2, false, false, Voice::Soft, true, 0.6, Kind::Build);
    let drop = part('D', 16, 0, true, true, Voice::Bright, true, 1.0, Kind::Drop);
    let rest = part('R', 8, 3, false, false, Voice::Organ, false, 0.5, Kind::Plain);
    let outro = part('I', 8, 0, true, false, Voice::Soft, false, 0.5, Kind::Plain);
    vec![intro, build.clone(), drop.clone(), rest, build, drop, outro]
}

/// A club song whose first build has kicks and bass. Its second drop follows a break that ends with silence.
pub(crate) fn breaks(mode: Mode) -> Vec<Part> {
    let club = club(mode);
    let [intro, build, drop, rest, ..] = club.as_slice() else { return club };
    let intro = Part { drums: false, bass: true, ..intro.clone() };
    let build = Part { bars: 4, drums: true, bass: true, loud: 0.5, ..build.clone() };
    let drop = Part { bars: 8, ..drop.clone() };
    let rest = Part { bars: 4, bass: true, arpeggio: true, kind: Kind::Pause, ..rest.clone() };
    vec![intro.clone(), build, drop.clone(), rest, drop.clone(), drop, intro]
}

/// Ballads without drops, each with one property of music with drops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Swell {
    None,
    Crescendo,
    LateBand,
    Pause,
    /// A bar of silence precedes the last chorus, after a bridge without drums and bass.
    BarePause,
}

impl Swell {
    pub(crate) const ALL: [Self; 5] =
        [Self::None, Self::Crescendo, Self::LateBand, Self::Pause, Self::BarePause];

    pub(crate) fn ballad(self, mode: Mode) -> Vec<Part> {
        let mut form = ballad(mode);
        match self {
            Self::None => {}
            Self::Crescendo => {
                form.iter_mut().filter(|part| part.letter == 'V').for_each(|verse| {
                    (verse.kind, verse.loud) = (Kind::Crescendo, 0.8);
                });
            }
            Self::LateBand => {
                form.iter_mut().take(3).for_each(|part| (part.drums, part.bass) = (false, false))
            }
            Self::Pause | Self::BarePause => {
                form.iter_mut().filter(|part| part.letter == 'B').for_each(|bridge| {
                    bridge.kind = Kind::Pause;
                    (bridge.drums, bridge.bass) = (self == Self::Pause, self == Self::Pause);
                });
            }
        }
        form
    }
}

fn ballad(mode: Mode) -> Vec<Part> {
    let mut form = pop(mode);
    for part in &mut form {
        part.arpeggio = false;
        part.loud = 0.5 + 0.3 * f64::from(u8::from(part.letter == 'C'));
        part.voice = if part.letter == 'C' { Voice::Organ } else { Voice::Soft };
    }
    form
}

struct Synthesizer {
    rate: f64,
    frames: Vec<StereoFrame>,
    noise: u32,
    drums: Vec<(Drum, Vec<f32>)>,
    tables: Vec<(Voice, Vec<f32>)>,
}

fn white(noise: &mut u32) -> f64 {
    *noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
    f64::from(*noise) / f64::from(u32::MAX) * 2.0 - 1.0
}

impl Synthesizer {
    fn new(rate: u32, seconds: f64, seed: u32) -> Self {
        let rate = f64::from(rate);
        let mut noise = seed.wrapping_mul(2_654_435_761).wrapping_add(12_345);
        let drums = [Drum::Kick, Drum::Snare, Drum::Hat, Drum::Ride, Drum::Crash, Drum::Tom];
        let drums = drums.map(|drum| (drum, drum_sound(drum, rate, &mut noise))).to_vec();
        let table = |voice: Voice| {
            let value = |n: usize| {
                let partials = voice.partials().iter().enumerate();
                let sum: f64 = partials
                    .map(|(k, a)| a * (TAU * (k + 1) as f64 * (n as f64 / 2048.0 + 0.13 * k as f64)).sin())
                    .sum();
                (0.5 * sum) as f32
            };
            (0..2048).map(value).collect()
        };
        let tables = [Voice::Soft, Voice::Organ, Voice::Bright].map(|voice| (voice, table(voice))).to_vec();
        Self { rate, frames: vec![[0.0; 2]; (seconds * rate) as usize], noise, drums, tables }
    }

    fn strike(&mut self, time: f64, drum: Drum, loud: f64) {
        // Players are a few milliseconds early or late.
        let time = time + 0.004 * white(&mut self.noise);
        let start = (time * self.rate).max(0.0) as usize;
        let loud = (0.5 * loud * (1.0 + 0.1 * white(&mut self.noise))) as f32;
        let Some((_, sound)) = self.drums.iter().find(|(known, _)| *known == drum) else { return };
        for (frame, value) in self.frames.iter_mut().skip(start).zip(sound) {
            *frame = frame.map(|x| x + loud * value);
        }
    }

    fn note(&mut self, from: f64, to: f64, hz: f64, voice: Voice, loud: f64, (attack, decay): (f64, f64)) {
        let start = (from * self.rate).max(0.0) as usize;
        let count = ((to - from) * self.rate) as usize;
        let Some((_, table)) = self.tables.iter().find(|(known, _)| *known == voice) else { return };
        let step = hz / self.rate * 2048.0;
        let (rise, fall) = ((1.0 / (attack * self.rate)) as f32, (-1.0 / (decay * self.rate)).exp() as f32);
        let release = (0.02 * self.rate) as f32;
        let (mut phase, mut level) = (0.0_f64, loud as f32);
        for (n, frame) in self.frames.iter_mut().skip(start).take(count).enumerate() {
            let envelope = (n as f32 * rise).min(1.0).min((count - n) as f32 / release);
            let value = level * envelope * table[phase as usize & 2047];
            *frame = frame.map(|x| x + value);
            phase += step;
            level *= fall;
        }
    }

    fn riser(&mut self, from: f64, to: f64, loud: f64) {
        let start = (from * self.rate) as usize;
        let count = ((to - from) * self.rate) as usize;
        let mut last = 0.0;
        for (n, frame) in self.frames.iter_mut().skip(start).take(count).enumerate() {
            let fraction = n as f64 / count as f64;
            let noise = white(&mut self.noise);
            let value = (loud * fraction * fraction * (noise - (1.0 - fraction) * last)) as f32;
            last = noise;
            *frame = frame.map(|x| x + value);
        }
    }
}

fn drum_sound(drum: Drum, rate: f64, noise: &mut u32) -> Vec<f32> {
    let length = match drum {
        Drum::Kick | Drum::Tom => 0.25,
        Drum::Snare => 0.18,
        Drum::Hat => 0.06,
        Drum::Ride => 0.3,
        Drum::Crash => 1.2,
    };
    let mut last = 0.0;
    let value = |n: usize| {
        let t = n as f64 / rate;
        let white = white(noise);
        let bright = white - last;
        last = white;
        let value = match drum {
            Drum::Kick => {
                let turns = 50.0 * t + 3.0 * (1.0 - (-t / 0.03).exp());
                (TAU * turns).sin() * (-t / 0.08).exp() + 0.2 * white * (-t / 0.004).exp()
            }
            Drum::Tom => (TAU * 120.0 * t).sin() * (-t / 0.1).exp() + 0.2 * white * (-t / 0.01).exp(),
            Drum::Snare => {
                0.5 * (TAU * 190.0 * t).sin() * (-t / 0.06).exp() + 0.6 * white * (-t / 0.07).exp()
            }
            Drum::Hat => 0.5 * bright * (-t / 0.02).exp(),
            Drum::Ride => {
                0.25 * bright * (-t / 0.12).exp() + 0.2 * (TAU * 5_200.0 * t).sin() * (-t / 0.1).exp()
            }
            Drum::Crash => 0.5 * bright * (-t / 0.4).exp(),
        };
        (value * (t / 0.0005).min(1.0)) as f32
    };
    (0..(length * rate) as usize).map(value).collect()
}

impl Song {
    pub(crate) fn new(style: Style, tempo: f64, key: Tonality, form: Vec<Part>) -> Self {
        Self { style, tempo: (tempo, tempo), swing: 0.5, key, cents: 0.0, form, seed: 1, sway: 0.0 }
    }

    fn beats(&self) -> f64 {
        let bars: usize = self.form.iter().map(|part| part.bars).sum();
        (bars * self.style.meter().beats()) as f64
    }

    /// Returns the time of a beat. The song begins after half a second of silence, and its tempo changes linearly per
    /// beat.
    fn time(&self, beat: f64) -> f64 {
        let (from, to) = self.tempo;
        let rise = (to - from) / self.beats();
        let beat = beat + self.sway * 0.5 * ((TAU * beat / 13.0).sin() + (TAU * beat / 31.0).sin());
        let spent = if rise.abs() < 1e-9 { beat / from } else { (1.0 + rise * beat / from).ln() / rise };
        0.5 + 60.0 * spent
    }

    pub(crate) fn play(&self, rate: u32) -> (Vec<StereoFrame>, Truth) {
        let mut synthesizer = Synthesizer::new(rate, self.time(self.beats()) + 1.0, self.seed);
        let mut truth = Truth::default();
        let per_bar = self.style.meter().beats();
        let mut bar = 0;
        let mut before = Kind::Plain;
        for (number, part) in self.form.iter().enumerate() {
            let (start, end) =
                (self.time((bar * per_bar) as f64), self.time(((bar + part.bars) * per_bar) as f64));
            if number > 0 {
                truth.borders.push(start);
            }
            truth.letters.push((start, end, part.letter));
            match (before, part.kind) {
                (Kind::Build | Kind::Pause, Kind::Drop) => truth.drops.push(start),
                (Kind::Break, Kind::Drop) => truth.returns.push(start),
                _ => {}
            }
            before = part.kind;
            if part.drums && number > 0 {
                synthesizer.strike(start, Drum::Crash, 0.5);
            }
            for of_part in 0..part.bars {
                self.play_bar(&mut synthesizer, part, bar, of_part);
                truth.downbeats.push(self.time((bar * per_bar) as f64));
                truth.beats.extend((0..per_bar).map(|beat| self.time((bar * per_bar + beat) as f64)));
                bar += 1;
            }
        }
        (synthesizer.frames, truth)
    }

    fn play_bar(&self, synthesizer: &mut Synthesizer, part: &Part, bar: usize, of_part: usize) {
        let per_bar = self.style.meter().beats();
        let first = (bar * per_bar) as f64;
        let at = |beat: f64| self.time(first + beat);
        let hz = |pitch: f64| 440.0 * ((pitch - 69.0 + self.cents / 100.0) / 12.0).exp2();
        let last = of_part + 1 == part.bars;
        if last && part.kind == Kind::Pause {
            return;
        }
        let fraction = (of_part + 1) as f64 / part.bars as f64;
        let swell = if part.kind == Kind::Crescendo { 0.3 + 0.7 * fraction } else { 1.0 };
        if part.drums {
            let fill_from = if last { per_bar as f64 - 1.0 } else { f64::INFINITY };
            let is_build = part.kind == Kind::Build;
            for (place, drum, loud) in self.style.strokes(self.swing) {
                if place < fill_from || drum == Drum::Kick && !is_build {
                    synthesizer.strike(at(place), drum, swell * part.loud.max(0.7) * loud);
                }
            }
            if last && !is_build {
                (0..4).for_each(|n| synthesizer.strike(at(fill_from + f64::from(n) / 4.0), Drum::Tom, 0.6));
            }
        }
        if part.kind == Kind::Build {
            // Claps become faster: quarters, eighths, sixteenths. The last beat is a pause.
            let per_beat = [1, 1, 2, 4][(of_part * 4 / part.bars).min(3)];
            let strokes = per_bar * per_beat - if last { per_beat } else { 0 };
            for n in 0..strokes {
                synthesizer.strike(at(n as f64 / per_beat as f64), Drum::Snare, 0.2 + 0.4 * fraction);
            }
            if of_part == 0 {
                synthesizer.riser(at(0.0), at((part.bars * per_bar) as f64 - 1.0), 0.25);
            }
        }
        let (root, minor) = part.chords[of_part % part.chords.len()];
        let tonic = 48.0 + f64::from(self.key.root + part.raised);
        let third = if minor { 3.0 } else { 4.0 };
        let chord = [0.0, third, 7.0].map(|tone| {
            let pitch = tonic + f64::from(root) + tone;
            // Keep the chord within an octave and a half.
            if pitch > 66.0 { pitch - 12.0 } else { pitch }
        });
        let loud = 0.12 * swell * part.loud;
        for pitch in chord {
            synthesizer.note(at(0.0), at(per_bar as f64), hz(pitch), part.voice, loud, (0.02, 6.0));
        }
        if part.bass {
            let pitch = 36.0 + f64::from((self.key.root + part.raised + root) % 12);
            for beat in 0..per_bar - usize::from(last && part.kind == Kind::Build) {
                let place = beat as f64;
                synthesizer.note(
                    at(place),
                    at(place + 0.9),
                    hz(pitch),
                    Voice::Organ,
                    0.2 * swell * part.loud,
                    (0.008, 0.6),
                );
            }
        }
        for note in part.melody.iter().filter(|note| note.bar == of_part) {
            let (from, to) = (at(note.beat), at(note.beat + 0.95 * note.length));
            let pitch = tonic + 12.0 + f64::from(note.pitch);
            synthesizer.note(from, to, hz(pitch), note.voice, 1.6 * loud, (0.01, 0.8));
        }
        if part.arpeggio {
            let per_beat = if self.style == Style::SixEight { 3 } else { 2 };
            for eighth in 0..per_bar * per_beat {
                let place = eighth as f64 / per_beat as f64;
                let pitch = chord[[0, 1, 2, 1][eighth % 4]] + 12.0;
                synthesizer.note(at(place), at(place + 0.45), hz(pitch), part.voice, loud, (0.005, 0.25));
            }
        }
    }
}
