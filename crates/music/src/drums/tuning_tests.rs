//! Computes the weights of the classifiers from generated tracks, and measures other tracks:
//! `MARIANA_FIGURES=1 cargo test --release -p mariana-music drums::tuning -- --nocapture`

#![expect(clippy::needless_range_loop, reason = "matrices are clearer with indices")]

use super::*;
use crate::{Alignment, Analyzer};

#[path = "../../tests/music/events.rs"]
mod events;
#[path = "../../tests/music/played.rs"]
mod played;

use played::{Kit, Mix, RATE, Random, Struck, Timbre, Track, f_of, matches, steady_noise, track};

const OF: [Struck; DRUMS] = [Struck::Kick, Struck::Snare, Struck::Hat];

/// The range of hops after a stroke in which a moment shows the stroke, and the range of hops that may show it.
const SHOWS: (f64, f64) = (2.0, 3.0);
const MAY_SHOW: (f64, f64) = (0.5, 6.0);

fn mixes(kits: &[Kit], timbres: &[Timbre], first_seed: u64, count: u64) -> Vec<Mix> {
    let levels = [None, Some(-12.0), Some(-6.0), Some(0.0), Some(3.0)];
    (0..count)
        .map(|n| {
            let mut random = Random::new(first_seed + n);
            let kit = (n % 9 != 8).then(|| kits[random.below(kits.len())]);
            let music_db = if kit.is_none() { Some(0.0) } else { levels[n as usize % levels.len()] };
            Mix {
                seed: first_seed + n,
                kit,
                timbre: timbres[random.below(timbres.len())],
                music_db,
                seconds: 20.0,
            }
        })
        .collect()
}

fn heard(track: &Track, mut see: impl FnMut(f64, &Drums)) {
    let mut analyzer = Analyzer::new(RATE, Alignment::Trailing);
    for hop in track.frames.chunks(512) {
        let mut time = None;
        analyzer.push(hop, &mut |moment| time = Some(moment.time));
        if let Some(time) = time {
            see(time, &analyzer.sounds.drums);
        }
    }
}

/// The evidence of a moment, and for each drum 1, 0, or `None` if the moment may show a stroke.
type Row = ([f32; NUMBERS], [Option<f32>; DRUMS]);

fn rows(track: &Track) -> Vec<Row> {
    let mut rows = Vec::new();
    let hop = 512.0 / f64::from(RATE);
    heard(track, |time, drums| {
        let labels = OF.map(|drum| {
            let of_drum = track.strokes.iter().filter(|stroke| stroke.1 == drum);
            let inside = |range: (f64, f64)| {
                of_drum.clone().any(|stroke| (range.0..range.1).contains(&((time - stroke.0) / hop)))
            };
            if inside(SHOWS) {
                Some(1.0)
            } else if inside(MAY_SHOW) {
                None
            } else {
                Some(0.0)
            }
        });
        rows.push((drums.evidence, labels));
    });
    rows
}

/// Solves a symmetric positive definite system by Gaussian elimination.
fn solved(mut a: Vec<Vec<f64>>, mut b: Vec<f64>) -> Vec<f64> {
    let n = b.len();
    for i in 0..n {
        for j in i + 1..n {
            let factor = a[j][i] / a[i][i];
            for k in i..n {
                a[j][k] -= factor * a[i][k];
            }
            b[j] -= factor * b[i];
        }
    }
    for i in (0..n).rev() {
        for k in i + 1..n {
            b[i] -= a[i][k] * b[k];
        }
        b[i] /= a[i][i];
    }
    b
}

/// Fits a logistic regression by Newton's method, with a small penalty on large weights.
fn fitted(rows: &[Row], drum: usize) -> [f32; NUMBERS] {
    const PENALTY: f64 = 0.1;
    let mut weights = [0.0_f64; NUMBERS];
    for _ in 0..20 {
        let mut gradient: Vec<f64> = weights.iter().map(|weight| -PENALTY * weight).collect();
        let mut curvature = vec![vec![0.0; NUMBERS]; NUMBERS];
        (0..NUMBERS).for_each(|i| curvature[i][i] = PENALTY);
        for (evidence, labels) in rows {
            let Some(label) = labels[drum] else { continue };
            let sum: f64 = evidence.iter().zip(&weights).map(|(x, weight)| f64::from(*x) * weight).sum();
            let p = 1.0 / (1.0 + (-sum).exp());
            let v = (p * (1.0 - p)).max(1e-6);
            for i in 0..NUMBERS {
                let x = f64::from(evidence[i]);
                gradient[i] += (f64::from(label) - p) * x;
                for j in 0..=i {
                    curvature[i][j] += v * x * f64::from(evidence[j]);
                }
            }
        }
        for i in 0..NUMBERS {
            for j in 0..i {
                curvature[j][i] = curvature[i][j];
            }
        }
        let step = solved(curvature, gradient);
        weights.iter_mut().zip(step).for_each(|(weight, step)| *weight += step);
    }
    weights.map(|weight| weight as f32)
}

/// Counts the matches of each drum at a threshold of its certainty.
fn counted(
    track: &Track,
    rows: &[Row],
    weights: &[[f32; NUMBERS]; DRUMS],
    certain: [f32; DRUMS],
) -> [[usize; 3]; DRUMS] {
    let hop = 512.0 / f64::from(RATE);
    std::array::from_fn(|drum| {
        let truth: Vec<f64> =
            track.strokes.iter().filter(|stroke| stroke.1 == OF[drum]).map(|stroke| stroke.0).collect();
        let (mut found, mut armed, mut last) = (Vec::new(), true, -1.0);
        for (n, (evidence, _)) in rows.iter().enumerate() {
            let time = n as f64 * hop;
            let certainty = certainty(evidence, drum, &weights[drum]);
            armed |= certainty < ARMED * certain[drum];
            if certainty >= certain[drum] && armed && time - last >= APART_SECONDS {
                (armed, last) = (false, time);
                found.push(time);
            }
        }
        matches(&found, &truth, 0.05)
    })
}

fn added(sums: &mut [[usize; 3]; DRUMS], counts: [[usize; 3]; DRUMS]) {
    sums.iter_mut().flatten().zip(counts.as_flattened()).for_each(|(sum, count)| *sum += count);
}

/// With `MARIANA_FIGURES` set, fits the weights to all tracks, which takes minutes, and prints them with their figures.
#[test]
fn fitted_weights_find_the_strokes_of_the_tuning_tracks() {
    let every = if std::env::var_os("MARIANA_FIGURES").is_some() { 1 } else { 60 };
    let sets = [
        ("tuning", mixes(&Kit::TUNED, &Timbre::TUNED, 1_000, 180 / every)),
        ("held out", mixes(&Kit::HELD_OUT, &Timbre::HELD_OUT, 9_000, 60 / every)),
    ];
    let sets = sets.map(|(name, mixes)| {
        let tracks: Vec<_> = mixes
            .iter()
            .map(|mix| {
                let track = track(mix);
                let rows = rows(&track);
                (*mix, track, rows)
            })
            .collect();
        (name, tracks)
    });
    let noises = (0..if every == 1 { 24 } else { 4 }).map(|seed| rows(&steady_noise(seed, 20.0)));
    let all: Vec<Row> =
        sets[0].1.iter().flat_map(|(_, _, rows)| rows.iter().copied()).chain(noises.flatten()).collect();
    let weights: [[f32; NUMBERS]; DRUMS] = std::array::from_fn(|drum| fitted(&all, drum));
    for (drum, weights) in weights.iter().enumerate() {
        println!("    // {:?}", OF[drum]);
        println!("    [");
        for line in weights.chunks(BANDS) {
            println!(
                "    {},",
                line.iter().map(|weight| format!("{weight:.2}")).collect::<Vec<_>>().join(", ")
            );
        }
        println!("    ],");
    }
    let mut found = [[0; 3]; DRUMS];
    for (_, track, rows) in &sets[0].1 {
        added(&mut found, counted(track, rows, &weights, CERTAIN));
    }
    assert!(found.iter().all(|counts| f_of(*counts) > 0.7), "{:.3?}", found.map(f_of));
    if every > 1 {
        return;
    }
    for seed in 100..112 {
        let track = steady_noise(seed, 20.0);
        println!("noise {seed}: {:?}", counted(&track, &rows(&track), &weights, CERTAIN));
    }
    for (name, tracks) in &sets {
        for threshold in [0.2, 0.3, 0.4, 0.5, 0.6, 0.7] {
            let mut sums = [[0; 3]; DRUMS];
            for (_, track, rows) in tracks {
                added(&mut sums, counted(track, rows, &weights, [threshold; DRUMS]));
            }
            println!("{name} at {threshold}: F {:.3?} of {sums:?}", sums.map(f_of));
        }
        for level in [None, Some(-12.0), Some(-6.0), Some(0.0), Some(3.0)] {
            let mut sums = [[0; 3]; DRUMS];
            for (_, track, rows) in
                tracks.iter().filter(|(mix, _, _)| mix.kit.is_some() && mix.music_db == level)
            {
                added(&mut sums, counted(track, rows, &weights, CERTAIN));
            }
            println!("{name}, music {level:?} dB: F {:.3?}", sums.map(f_of));
        }
        for kit in Kit::TUNED.into_iter().chain(Kit::HELD_OUT).map(Some).chain([None]) {
            let mut sums = [[0; 3]; DRUMS];
            for (_, track, rows) in tracks.iter().filter(|(mix, _, _)| mix.kit == kit) {
                added(&mut sums, counted(track, rows, &weights, CERTAIN));
            }
            println!("{name}, {kit:?}: F {:.3?} of {sums:?}", sums.map(f_of));
        }
    }
}
