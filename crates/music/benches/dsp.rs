//! Measures the speed of the analysis: 10 s of stereo at 48 kHz, in blocks of 512 sample frames as in playback. Divide
//! the time per iteration by 10 s to get the load of one core during live analysis.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use mariana_music::{Alignment, Analyzer, FeatureTrack, StereoFrame};

const RATE: u32 = 48_000;

/// 10 s of two chords with noise, so that every band has a signal.
fn music() -> Vec<StereoFrame> {
    let mut state = 1_u32;
    (0..10 * RATE)
        .map(|n| {
            let t = f64::from(n) / f64::from(RATE) * std::f64::consts::TAU;
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let noise = f64::from(state) / f64::from(u32::MAX) * 0.1 - 0.05;
            let left = 0.2 * ((55.0 * t).sin() + (220.0 * t).sin() + (277.0 * t).sin()) + noise;
            let right = 0.2 * ((55.0 * t).sin() + (330.0 * t).sin() + (415.0 * t).sin()) - noise;
            [left as f32, right as f32]
        })
        .collect()
}

fn analysis(criterion: &mut Criterion) {
    let frames = music();
    let mut track = FeatureTrack::default();
    for (alignment, name) in [(Alignment::Centred, "a file"), (Alignment::Trailing, "live input")] {
        let mut analyzer = Analyzer::new(RATE, alignment);
        criterion.bench_function(&format!("analysis of 10 s of {name} at 48 kHz stereo"), |bencher| {
            bencher.iter(|| {
                analyzer.restart(0);
                for block in frames.chunks(512) {
                    analyzer.push(black_box(block), &mut |moment| track.push(moment));
                }
            });
        });
    }
    criterion.bench_function("features at one moment", |bencher| {
        bencher.iter(|| black_box(track.at(black_box(5.0012))));
    });
    criterion.bench_function("features and curves at one moment", |bencher| {
        bencher.iter(|| black_box(track.sound_at(black_box(9.0012))));
    });
}

criterion_group!(benches, analysis);
criterion_main!(benches);
