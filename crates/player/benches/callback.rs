//! Measures the duration of the audio callback for a buffer of 1024 stereo frames, which lasts 21.3 ms at 48 kHz.

use std::hint::black_box;
use std::sync::Arc;
use std::time::{Duration, Instant};

use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use mariana_player::output::{Controls, OutputCallback, OutputCallbackLink, Segment};

const FRAMES: usize = 1024;

fn playing(volume: f32) -> (OutputCallback, OutputCallbackLink) {
    let (mut output_callback, mut link) =
        OutputCallback::new(48_000, FRAMES, Arc::new(Controls::new(volume, false)));
    let (mut ring, _, segment) = Segment::new(1, 4 * FRAMES);
    ring.push_entire_slice(&[[0.5, -0.25]; 4 * FRAMES]).unwrap_or_default();
    drop(link.offer(segment));
    output_callback.fill(&mut [0.0_f32; 2 * FRAMES], 2, Instant::now(), None);
    (output_callback, link)
}

fn callback(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("callback, 1024 frames");
    let latency = Some(Duration::from_millis(20));
    for (name, channels) in [("mono", 1), ("stereo", 2), ("7.1", 8)] {
        let mut data = vec![0.0_f32; FRAMES * channels];
        group.bench_function(format!("f32 {name}"), |bencher| {
            bencher.iter_batched_ref(
                || playing(0.8),
                |(output_callback, _)| {
                    output_callback.fill(black_box(&mut data), channels, Instant::now(), latency)
                },
                BatchSize::SmallInput,
            );
        });
    }
    let mut data = vec![0_i16; FRAMES * 2];
    group.bench_function("i16 stereo", |bencher| {
        bencher.iter_batched_ref(
            || playing(0.8),
            |(output_callback, _)| output_callback.fill(black_box(&mut data), 2, Instant::now(), latency),
            BatchSize::SmallInput,
        );
    });
    group.finish();
}

criterion_group!(benches, callback);
criterion_main!(benches);
