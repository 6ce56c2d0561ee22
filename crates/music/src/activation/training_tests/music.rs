//! Training music: random pieces of many kinds, whose beats and bars are known.

use super::effects::{add, compressed, echoed, high_passed, low_passed, power, reverberated};
use super::patterns::{Pattern, Time, any_pattern, hat_pattern, kick_pattern, snare_pattern};
use super::synth::{Drum, Instrument, RATE, Random, Touch};
use super::tones::{SCALES, Song, parts, play_tones};

/// A generated piece, in one channel.
pub(super) struct Piece {
    pub(super) sound: Vec<f32>,
    /// The time of each beat in seconds, and true at the start of a bar.
    pub(super) beats: Vec<(f32, bool)>,
}

/// A percussion instrument and its strokes.
struct Voice {
    sound: Vec<f32>,
    soft: Vec<f32>,
    loud: f32,
    pattern: Pattern,
    kind: Drum,
    late: f32,
}

fn voice(kind: Drum, pattern: Pattern, loud: f32, random: &mut Random) -> Voice {
    let sound = kind.sound(random);
    let mut soft = sound.clone();
    low_passed(&mut soft, 3_000.0);
    Voice {
        sound,
        soft,
        loud,
        pattern,
        kind,
        late: if random.chance(0.3) { 0.012 * random.white() } else { 0.0 },
    }
}

fn kit(time: &Time, random: &mut Random) -> Vec<Voice> {
    let mut voices = Vec::new();
    if random.chance(0.92) {
        let kind = if random.chance(0.08) { Drum::Timpani } else { Drum::Kick };
        let pattern = kick_pattern(time, random);
        voices.push(voice(kind, pattern, random.between(0.5, 1.1), random));
    }
    if random.chance(0.85) {
        let kind = random.one(&[Drum::Snare, Drum::Snare, Drum::Snare, Drum::Clap, Drum::Rim]);
        let pattern = snare_pattern(time, random);
        voices.push(voice(kind, pattern, random.between(0.3, 1.0), random));
    }
    if random.chance(0.85) {
        let kind = random.one(&[Drum::Hat, Drum::Hat, Drum::Hat, Drum::Open, Drum::Ride, Drum::Shaker]);
        let pattern = hat_pattern(time, random);
        voices.push(voice(kind, pattern, random.ratio(0.08, 0.9), random));
    }
    for _ in 0..random.below(4) {
        let kind = random.one(&Drum::ALL[2..11]);
        let pattern = any_pattern(time, random);
        voices.push(voice(kind, pattern, random.ratio(0.1, 0.6), random));
    }
    voices
}

struct Buses {
    drums: Vec<f32>,
    music: Vec<f32>,
    kicks: Vec<f32>,
}

fn play_drums(
    buses: &mut Buses,
    time: &Time,
    voices: &[Voice],
    song: &Song,
    bars: std::ops::Range<usize>,
    random: &mut Random,
) {
    let active: Vec<bool> = voices.iter().map(|_| random.chance(0.85)).collect();
    let fill = random.chance(0.6).then(|| (Drum::Tom.sound(random), random.between(1.0, time.bar as f32)));
    let first = bars.start;
    if random.chance(0.4) {
        let crash = Drum::Crash.sound(random);
        add(
            &mut buses.drums,
            &crash,
            time.at((time.first + first * time.bar) as f32),
            random.between(0.3, 0.9),
        );
    }
    for n in bars.clone() {
        let start = (time.first + n * time.bar) as f32;
        let filled = match &fill {
            Some((_, from)) if n + 1 == bars.end => time.bar as f32 - from,
            _ => time.bar as f32,
        };
        for (voice, _) in voices.iter().zip(&active).filter(|(_, active)| **active) {
            for (place, loud) in voice.pattern.iter().filter(|stroke| stroke.0 < filled) {
                if random.chance(0.02) {
                    continue;
                }
                let at = time.at(start + place) + song.jitter * random.normal() + voice.late;
                let loud = loud * random.between(0.8, 1.0);
                let sound = if loud < 0.5 { &voice.soft } else { &voice.sound };
                add(&mut buses.drums, sound, at, voice.loud * loud);
                if voice.kind == Drum::Kick {
                    buses.kicks.push(at);
                }
            }
        }
        if let Some((tom, _)) = fill.as_ref().filter(|_| n + 1 == bars.end) {
            let parts = if time.ternary { 3 } else { 2 + 2 * usize::from(time.tempo < 130.0) };
            let mut place = filled;
            while place < time.bar as f32 {
                if random.chance(0.8) {
                    add(&mut buses.drums, tom, time.at(start + place), random.between(0.3, 0.8));
                }
                place += 1.0 / parts as f32;
            }
        }
    }
}

/// Generates a piece.
pub(super) fn piece(seed: u64, seconds: f32) -> Piece {
    let random = &mut Random::new(seed);
    if random.chance(0.04) {
        return Piece { sound: beatless(seconds, random), beats: vec![] };
    }
    let has_drums = random.chance(0.8);
    let time = Time::new(seconds, has_drums, random);
    let song = Song {
        scale: random.one(&SCALES),
        key: random.below(12) as i32,
        chords_per_bar: random.one(&[
            1.0,
            1.0,
            1.0,
            1.0,
            0.5,
            0.5,
            0.25,
            if time.bar.is_multiple_of(2) { 2.0 } else { 1.0 },
        ]),
        pushed: random.chance(0.1),
        jitter: if random.chance(0.5) { random.between(0.0, 0.012) } else { 0.0 },
        legato: random.between(0.4, 1.0),
        arpeggio_soft: random.between(0.6, 1.0),
    };
    let count = (seconds * RATE) as usize;
    let mut buses = Buses { drums: vec![0.0; count], music: vec![0.0; count], kicks: vec![] };
    let all_bars = (time.beats.len() - 2 - time.first) / time.bar;
    let length = random.one(&[4, 4, 8, 8, 16]);
    let mut chords: Vec<i32> = (0..4).map(|_| random.one(&[0, 0, 3, 4, 5, 1, 2])).collect();
    chords[0] = 0;
    let mut voices = if has_drums { kit(&time, random) } else { vec![] };
    let mut tones = parts(&time, random, has_drums);
    let mut bar = 0;
    let mut drums_play = true;
    while bar < all_bars {
        let end = (bar + length).min(all_bars);
        if bar > 0 && random.chance(0.25) {
            tones = parts(&time, random, has_drums);
        }
        if bar > 0 && has_drums && random.chance(0.25) {
            let pattern = hat_pattern(&time, random);
            if let Some(voice) = voices.iter_mut().find(|voice| matches!(voice.kind, Drum::Hat | Drum::Ride))
            {
                voice.pattern = pattern;
            }
            let pattern = kick_pattern(&time, random);
            if let Some(voice) = voices.iter_mut().find(|voice| voice.kind == Drum::Kick) {
                voice.pattern = pattern;
            }
        }
        if bar > 0 || random.chance(0.3) {
            drums_play = random.chance(0.88);
        }
        if drums_play {
            play_drums(&mut buses, &time, &voices, &song, bar..end, random);
        }
        play_tones(&mut buses.music, &time, &tones, &chords, &song, bar..end, random);
        bar = end;
    }
    let sound = mixed(buses, &time, random);
    let bar_start = |index: usize| index >= time.first && (index - time.first).is_multiple_of(time.bar);
    let beats = time.beats.iter().enumerate().map(|(index, beat)| (*beat, bar_start(index)));
    Piece { sound, beats: beats.filter(|(beat, _)| (0.0..seconds).contains(beat)).collect() }
}

fn mixed(mut buses: Buses, time: &Time, random: &mut Random) -> Vec<f32> {
    if random.chance(0.2) {
        let (depth, release) = (random.between(0.3, 1.0), random.between(0.06, 0.25));
        for kick in &buses.kicks {
            let first = (kick.max(0.0) * RATE) as usize;
            for (n, x) in buses.music.iter_mut().skip(first).take((3.0 * release * RATE) as usize).enumerate()
            {
                *x *= 1.0 - depth * (-(n as f32 / RATE) / release).exp();
            }
        }
    }
    let beat = 60.0 / time.tempo;
    if random.chance(0.2) {
        echoed(&mut buses.music, beat * random.one(&[0.5, 0.75, 1.0]), random.between(0.15, 0.5));
    }
    let (seconds, wet) = (random.ratio(0.3, 3.0), random.ratio(0.05, 0.8));
    if random.chance(0.6) {
        reverberated(&mut buses.music, seconds, wet);
    }
    if random.chance(0.4) {
        reverberated(&mut buses.drums, seconds, random.ratio(0.03, 0.4));
    }
    let (drums, music) = (power(&buses.drums), power(&buses.music));
    let level = if drums > 1e-9 && music > 1e-9 {
        (drums / music).sqrt() * 10_f32.powf(random.between(-9.0, 9.0) / 20.0)
    } else {
        1.0
    };
    let mut sound: Vec<f32> = buses.drums.iter().zip(&buses.music).map(|(a, b)| a + level * b).collect();
    match random.below(8) {
        0 => low_passed(&mut sound, random.ratio(2_000.0, 9_000.0)),
        1 => high_passed(&mut sound, random.ratio(60.0, 300.0)),
        _ => {}
    }
    let scale = 0.3 / power(&sound).sqrt().max(1e-6);
    sound.iter_mut().for_each(|x| *x *= scale);
    if random.chance(0.5) {
        compressed(&mut sound, random.between(0.15, 0.8), random.ratio(0.05, 0.4));
    }
    if random.chance(0.3) {
        let drive = random.ratio(1.0, 4.0);
        sound.iter_mut().for_each(|x| *x = (drive * *x).tanh());
    }
    if random.chance(0.3) {
        let loud = 0.3 * 10_f32.powf(random.between(-50.0, -15.0) / 20.0);
        sound.iter_mut().for_each(|x| *x += loud * random.white());
    }
    sound
}

/// Generates sounds without a beat: noise in syllables, rain, drones.
fn beatless(seconds: f32, random: &mut Random) -> Vec<f32> {
    let count = (seconds * RATE) as usize;
    let mut sound = vec![0.0; count];
    match random.below(4) {
        0 => {
            let mut time = 0.0;
            while time < seconds {
                let length = random.between(0.06, 0.4);
                let first = (time * RATE) as usize;
                let hz = random.ratio(500.0, 5_000.0);
                let mut part: Vec<f32> = (0..(length * RATE) as usize)
                    .map(|n| (std::f32::consts::PI * n as f32 / (length * RATE)).sin() * random.white())
                    .collect();
                low_passed(&mut part, hz);
                sound.iter_mut().skip(first).zip(&part).for_each(|(x, y)| *x += y);
                time += length + if random.chance(0.2) { random.between(0.0, 0.8) } else { 0.0 };
            }
        }
        1 => {
            let drops = random.between(2.0, 20.0) * seconds;
            for _ in 0..drops as usize {
                let drop = random.one(&[Drum::Rim, Drum::Hat, Drum::Conga]).sound(random);
                add(&mut sound, &drop, random.unit() * seconds, random.ratio(0.05, 1.0));
            }
        }
        2 => sound.iter_mut().for_each(|x| *x = 0.3 * random.white()),
        _ => {
            for _ in 0..random.below(12) + 3 {
                let instrument = Instrument::new(Touch::Pad, random);
                let from = random.between(-5.0, seconds);
                let to = from + random.between(2.0, 15.0);
                instrument.play(&mut sound, from, to, random.between(12.0, 60.0), 0.2, random);
            }
        }
    }
    sound.iter_mut().for_each(|x| *x += 1e-4 * random.white());
    sound
}
