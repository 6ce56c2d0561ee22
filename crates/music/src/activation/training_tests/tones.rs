//! Basses, chords, arpeggios and melodies.

use super::patterns::{Pattern, Time, any_pattern, beats, every, likely, off, strong, thirds, with};
use super::synth::{Instrument, Random, Touch};

/// The parts of a piece that play tones.
pub(super) struct Parts {
    bass: Option<(Instrument, Pattern, bool)>,
    pad: Option<Instrument>,
    chops: Option<(Instrument, Pattern, f32)>,
    arpeggio: Option<(Instrument, usize, usize, f32)>,
    melody: Option<(Instrument, f32, f32)>,
}

pub(super) fn parts(time: &Time, random: &mut Random, has_drums: bool) -> Parts {
    let touch = |random: &mut Random| random.one(&[Touch::Held, Touch::Plucked, Touch::Plucked]);
    let bass = random.chance(if has_drums { 0.8 } else { 0.6 }).then(|| {
        let pattern = match random.below(12) {
            0..=1 => strong(time),
            2 => beats(time),
            3..=4 => every(time, if time.ternary { 3 } else { 2 }, random),
            5 => off(time),
            6 => with(vec![(0.0, 1.0)], thirds(time), 0.9),
            7..=8 => with(vec![(0.0, 1.0)], likely(time, 0.4, random.unit(), random), 0.9),
            9 => {
                let parts = time.parts(random);
                every(time, parts, random)
            }
            _ => vec![(0.0, 1.0)],
        };
        (Instrument::new(touch(random), random), pattern, random.chance(0.3))
    });
    let chops = random.chance(0.5).then(|| {
        let pattern = any_pattern(time, random);
        (Instrument::new(touch(random), random), pattern, random.ratio(0.1, 1.0))
    });
    let arpeggio = random.chance(if has_drums { 0.3 } else { 0.5 }).then(|| {
        let parts = time.parts(random);
        (Instrument::new(touch(random), random), parts, random.below(4), random.between(0.3, 1.2))
    });
    let mut pad = random.chance(0.5).then(|| Instrument::new(Touch::Pad, random));
    let melody = random
        .chance(0.65)
        .then(|| (Instrument::new(touch(random), random), random.unit(), random.between(0.4, 1.1)));
    let none = bass.is_none() && chops.is_none() && arpeggio.is_none() && melody.is_none();
    if none && !has_drums {
        pad = Some(Instrument::new(Touch::Held, random));
    }
    Parts { bass, pad, chops, arpeggio, melody }
}

/// A phrase of a melody: position and length in beats, and the step of the scale.
fn phrase(time: &Time, bars: usize, syncopated: f32, random: &mut Random) -> Vec<(f32, f32, i32)> {
    let end = (bars * time.bar) as f32;
    let slow = 1.0 / (1.0 + ((time.tempo - 95.0) / 15.0).exp());
    let unit = match time.ternary {
        true => 1.0 / 3.0,
        false if random.chance(0.6 * slow) => 0.25,
        false if random.chance(0.15 + 0.3 * (1.0 - slow)) => 1.0,
        false => 0.5,
    };
    let lengths: Vec<f32> = [1.0, 2.0, 3.0, 4.0, 6.0, 8.0].iter().map(|n| n * unit).collect();
    let mut notes = Vec::new();
    let mut place: f32 = if random.chance(0.3) { random.below(4) as f32 * unit } else { 0.0 };
    let mut step = random.below(7) as i32;
    while place < end {
        let mut length = lengths[random.below(lengths.len())];
        let rest = 1.0 - place.fract();
        if rest > 0.01 && length > rest + 0.01 && !random.chance(syncopated) {
            length = rest;
        }
        length = length.min(end - place);
        if random.chance(0.88) {
            notes.push((place, length, step));
        }
        step = (step + random.below(7) as i32 - 3).clamp(-4, 11);
        place += length;
    }
    notes
}

pub(super) const SCALES: [[i32; 7]; 4] =
    [[0, 2, 4, 5, 7, 9, 11], [0, 2, 3, 5, 7, 8, 10], [0, 2, 3, 5, 7, 9, 10], [0, 2, 3, 5, 7, 8, 11]];

fn pitch(scale: &[i32; 7], key: i32, step: i32) -> f32 {
    (key + 12 * step.div_euclid(7) + scale[step.rem_euclid(7) as usize]) as f32
}

/// Returns the step of the scale, above the chord, of a note of an arpeggio.
fn arpeggio_step(order: usize, index: usize) -> i32 {
    match order {
        0 => [0, 2, 4, 7][index % 4],
        1 => [0, 4, 2, 4][index % 4],
        2 => [0, 2, 4, 7, 4, 2][index % 6],
        _ => [7, 4, 2, 0][index % 4],
    }
}

/// Plays the tones of the bars `from..to` into the buses.
pub(super) fn play_tones(
    out: &mut [f32],
    time: &Time,
    parts: &Parts,
    chords: &[i32],
    song: &Song,
    bars: std::ops::Range<usize>,
    random: &mut Random,
) {
    let (scale, key) = (&song.scale, song.key);
    let bar = time.bar as f32;
    let start = |n: usize| (time.first + n * time.bar) as f32;
    let per_bar = song.chords_per_bar;
    let jitter = song.jitter;
    let active: [bool; 5] = std::array::from_fn(|_| random.chance(0.85));
    let phrase_bars = 2;
    let tune = parts.melody.as_ref().map(|(_, syncopated, _)| phrase(time, phrase_bars, *syncopated, random));
    for n in bars {
        let chord_at = |place: f32| {
            let place = place + if song.pushed { 0.5 } else { 0.0 };
            let index = ((n as f32 + place / bar) * per_bar + 1e-3) as usize;
            chords[index % chords.len()]
        };
        let mut at = |place: f32| time.at(start(n) + place) + jitter * random.normal();
        if let (Some((instrument, pattern, moves)), true) = (&parts.bass, active[0]) {
            for (index, (place, loud)) in pattern.iter().enumerate() {
                let next = pattern.iter().map(|p| p.0).filter(|p| *p > *place).fold(bar, f32::min);
                let (from, to) = (at(*place), at(*place + (next - place).min(2.0) * song.legato));
                let step = chord_at(*place) + if *moves { [0, 4, 7, 2][index % 4] } else { 0 };
                let tone = pitch(scale, key, step);
                let tone = if tone > 28.0 { tone - 12.0 } else { tone } + 3.0;
                instrument.play(out, from, to, tone, 0.45 * loud, &mut song.noise(n));
            }
        }
        let begins_chord = n % (1.0 / per_bar).max(1.0) as usize == 0;
        if let (Some(instrument), true) = (&parts.pad, active[1] && begins_chord) {
            let count = per_bar.ceil().max(1.0) as usize;
            for part in 0..count {
                let place = part as f32 * bar / count as f32;
                let shift = if song.pushed && n > 0 { 0.5 } else { 0.0 };
                let length = bar / per_bar;
                for voice in [0, 2, 4] {
                    let tone = pitch(scale, key, chord_at(place) + voice) + 24.0;
                    let (from, to) = (at(place - shift), at(place - shift + length));
                    instrument.play(out, from, to, tone, 0.13, &mut song.noise(n));
                }
            }
        }
        if let (Some((instrument, pattern, length)), true) = (&parts.chops, active[2]) {
            for (place, loud) in pattern {
                let (from, to) = (at(*place), at(place + length));
                for voice in [0, 2, 4] {
                    let tone = pitch(scale, key, chord_at(*place) + voice) + 24.0;
                    instrument.play(out, from, to, tone, 0.16 * loud, &mut song.noise(n));
                }
            }
        }
        if let (Some((instrument, count, order, loud)), true) = (&parts.arpeggio, active[3]) {
            for index in 0..count * time.bar {
                let place = index as f32 / *count as f32;
                let turn = arpeggio_step(*order, index);
                let accent = if index % count == 0 { 1.0 } else { song.arpeggio_soft };
                let (from, to) = (at(place), at(place + song.legato / *count as f32));
                let tone = pitch(scale, key, chord_at(place) + turn) + 27.0;
                instrument.play(out, from, to, tone, 0.25 * loud * accent, &mut song.noise(n));
            }
        }
        if let (Some((instrument, _, loud)), Some(tune), true) = (&parts.melody, &tune, active[4]) {
            let from_beat = ((n % phrase_bars) * time.bar) as f32;
            for (place, length, step) in
                tune.iter().filter(|note| (from_beat..from_beat + bar).contains(&note.0))
            {
                let place = place - from_beat;
                let (from, to) = (at(place), at(place + length * song.legato));
                let tone = pitch(scale, key, *step) + 36.0;
                instrument.play(out, from, to, tone, 0.3 * loud, &mut song.noise(n));
            }
        }
    }
}

pub(super) struct Song {
    pub(super) scale: [i32; 7],
    pub(super) key: i32,
    pub(super) chords_per_bar: f32,
    pub(super) pushed: bool,
    pub(super) jitter: f32,
    pub(super) legato: f32,
    pub(super) arpeggio_soft: f32,
}

impl Song {
    fn noise(&self, bar: usize) -> Random {
        Random::new(bar as u64)
    }
}
