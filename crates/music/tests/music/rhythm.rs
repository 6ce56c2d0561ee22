//! Synthetic rhythms with known beats: clicks and drums at any tempo, with swing and ramps.

use std::f64::consts::TAU;

use mariana_music::StereoFrame;

pub(crate) const RATE: u32 = 48_000;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Drum {
    Click,
    Kick,
    Snare,
    Hat,
    Ride,
}

/// A stroke of a pattern: position in beats, drum and loudness.
pub(crate) type Stroke = (f64, Drum, f64);

#[derive(Clone, Debug)]
pub(crate) struct Pattern {
    pub name: &'static str,
    pub beats: f64,
    pub strokes: Vec<Stroke>,
}

pub(crate) fn clicks() -> Pattern {
    Pattern { name: "clicks", beats: 1.0, strokes: vec![(0.0, Drum::Click, 0.8)] }
}

/// Drum patterns. `swing` is the position of the second eighth in its beat: 0.5 for straight eighths, 0.667 for
/// triplets.
pub(crate) fn drums(swing: f64) -> Vec<Pattern> {
    let eighths = |drum, loud: f64| {
        (0..4).flat_map(move |beat| {
            [(f64::from(beat), drum, loud), (f64::from(beat) + swing, drum, 0.7 * loud)]
        })
    };
    let backbeat = [(1.0, Drum::Snare, 0.7), (3.0, Drum::Snare, 0.7)];
    let of = |name, strokes: Vec<Stroke>| Pattern { name, beats: 4.0, strokes };
    vec![
        of(
            "rock",
            [(0.0, Drum::Kick, 0.9), (2.0, Drum::Kick, 0.9)]
                .into_iter()
                .chain(backbeat)
                .chain(eighths(Drum::Hat, 0.25))
                .collect(),
        ),
        of(
            "four on the floor",
            (0..4)
                .flat_map(|beat| {
                    [(f64::from(beat), Drum::Kick, 0.9), (f64::from(beat) + swing, Drum::Hat, 0.35)]
                })
                .chain(backbeat.map(|(at, drum, loud)| (at, drum, 0.7 * loud)))
                .collect(),
        ),
        of(
            "syncopated",
            [(0.0, Drum::Kick, 0.9), (1.0 + swing, Drum::Kick, 0.7), (2.0, Drum::Kick, 0.8)]
                .into_iter()
                .chain(backbeat)
                .chain(eighths(Drum::Hat, 0.25))
                .collect(),
        ),
        of(
            "jazz",
            [0.0, 1.0, 1.0 + swing, 2.0, 3.0, 3.0 + swing]
                .map(|at| (at, Drum::Ride, if at.fract() == 0.0 { 0.5 } else { 0.35 }))
                .into_iter()
                .chain([(1.0, Drum::Hat, 0.5), (3.0, Drum::Hat, 0.5)])
                .chain((0..4).map(|beat| (f64::from(beat), Drum::Kick, 0.35)))
                .collect(),
        ),
    ]
}

/// Returns the samples and the times of the beats; `tempo(t)` gives beats per minute at `t` seconds.
pub(crate) fn play(
    pattern: &Pattern,
    seconds: f64,
    tempo: impl Fn(f64) -> f64,
) -> (Vec<StereoFrame>, Vec<f64>) {
    let count = (seconds * f64::from(RATE)) as usize;
    let mut frames = vec![[0.0_f32; 2]; count];
    let mut beats = Vec::new();
    let mut noise = 12_345_u32;
    let (mut beat, mut last) = (0.0_f64, -1e-9_f64);
    for n in 0..count {
        let time = n as f64 / f64::from(RATE);
        if beat.floor() > last.floor() {
            beats.push(time);
        }
        for (at, drum, loud) in &pattern.strokes {
            let passed = |beat: f64| ((beat - at) / pattern.beats).floor();
            if passed(beat) > passed(last) {
                strike(&mut frames[n..], *drum, *loud, &mut noise);
            }
        }
        last = beat;
        beat += tempo(time) / 60.0 / f64::from(RATE);
    }
    (frames, beats)
}

fn strike(frames: &mut [StereoFrame], drum: Drum, loud: f64, noise: &mut u32) {
    let (length, pan) = match drum {
        Drum::Click => (0.02, 0.0),
        Drum::Kick => (0.25, 0.0),
        Drum::Snare => (0.18, 0.1),
        Drum::Hat => (0.06, -0.3),
        Drum::Ride => (0.3, 0.3),
    };
    let mut last = 0.0;
    for (n, frame) in frames.iter_mut().take((length * f64::from(RATE)) as usize).enumerate() {
        let t = n as f64 / f64::from(RATE);
        *noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let white = f64::from(*noise) / f64::from(u32::MAX) * 2.0 - 1.0;
        let bright = white - last;
        last = white;
        let value = match drum {
            Drum::Click => (TAU * 1_500.0 * t).sin() * (-t / 0.004).exp(),
            // The pitch falls from 150 to 50 Hz.
            Drum::Kick => {
                let turns = 50.0 * t + 100.0 * 0.03 * (1.0 - (-t / 0.03).exp());
                (TAU * turns).sin() * (-t / 0.08).exp() + 0.2 * white * (-t / 0.004).exp()
            }
            Drum::Snare => {
                0.5 * (TAU * 190.0 * t).sin() * (-t / 0.06).exp() + 0.6 * white * (-t / 0.07).exp()
            }
            Drum::Hat => 0.5 * bright * (-t / 0.02).exp(),
            Drum::Ride => {
                0.25 * bright * (-t / 0.12).exp() + 0.2 * (TAU * 5_200.0 * t).sin() * (-t / 0.1).exp()
            }
        };
        let rise = (t / 0.0005).min(1.0);
        frame[0] += (0.6 * loud * value * rise * (1.0 - pan)) as f32;
        frame[1] += (0.6 * loud * value * rise * (1.0 + pan)) as f32;
    }
}

/// Returns the F-measure of beats between two times in seconds. Each beat is matched with a true beat within 70 ms.
pub(crate) fn f_measure(found: &[f64], truth: &[f64], from: f64, to: f64) -> f64 {
    const TOLERANCE: f64 = 0.07;
    let inside = |time: &f64| (from..to).contains(time);
    let (mut hits, mut next) = (0, 0);
    let mut false_beats = found.iter().filter(|beat| inside(beat)).count();
    for time in truth {
        while found.get(next).is_some_and(|beat| *beat < time - TOLERANCE) {
            next += 1;
        }
        if let Some(beat) = found.get(next).filter(|beat| **beat <= time + TOLERANCE) {
            next += 1;
            // One beat of a matched pair may be outside the range.
            hits += usize::from(inside(time));
            false_beats -= usize::from(inside(beat));
        }
    }
    let truths = truth.iter().filter(|beat| inside(beat)).count();
    2.0 * hits as f64 / (hits + false_beats + truths).max(1) as f64
}
