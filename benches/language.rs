//! Text to words: what an edit of a scene costs before the GPU sees it. Divide by the clauses that are printed.

#![allow(clippy::expect_used)]

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use mariana::lang::{compile, no_includes};
use mariana::tape::{Tape, TapeOptions};

/// The words of a text's distance.
fn words(text: &str) -> Vec<u32> {
    let scene = compile("bench.scene", text, &mut no_includes).scene.expect("the text is a scene");
    let tape = Tape::build(&scene.graph, &[scene.distance], &TapeOptions::default()).expect("it has a tape");
    tape.words()
}

/// A formula of `count` balls that have nothing in common.
fn balls(count: usize) -> String {
    let ball = |i: usize| {
        let [x, y, z] = [7, 13, 29].map(|step| (i * step % 997) as f64 * 0.037 - 15.0);
        format!("length(p - vec3({x:.3}, {y:.3}, {z:.3})) - {:.3}", 0.2 + i as f64 * 0.001)
    };
    format!("union({})", (0..count).map(ball).collect::<Vec<_>>().join(",\n"))
}

fn text_to_words(criterion: &mut Criterion) {
    let speakers = include_str!("../assets/scenes/speakers.scene").to_owned();
    let sphere_and_plane = "min(y, sqrt(x*x+(y-1)*(y-1)+(z-6)*(z-6))-1)".to_owned();
    let texts = [("thesis 4.4", sphere_and_plane), ("speakers", speakers), ("786 balls", balls(786))];
    let mut group = criterion.benchmark_group("text to words");
    for (name, text) in &texts {
        println!("{name}: {} bytes, {} words", text.len(), words(text).len());
        group.bench_function(*name, |bencher| bencher.iter(|| words(black_box(text))));
    }
    group.finish();
}

criterion_group!(benches, text_to_words);
criterion_main!(benches);
