//! Measures the time to type in a long text: the edit, and the colours of the visible lines. Opens no window.

#![allow(missing_docs, clippy::unwrap_used)]

use criterion::{Criterion, criterion_group, criterion_main};
use mariana_editing::{Colors, Editing, Move, own_names, proposals};

const SHOWN: usize = 50;

fn long_text() -> Vec<u8> {
    let line = "object ball { shape = sphere(p - vec3(0, 1.25, 0), 0.5)  material = glow } # one\n";
    line.repeat(400_000 / line.len() + 1).into_bytes()
}

fn type_letters(criterion: &mut Criterion) {
    let mut editing = Editing::new(long_text());
    let middle = editing.buffer().line_count() / 2;
    editing.move_to(editing.buffer().line_start(middle), false);
    let mut colors = Colors::default();
    criterion.bench_function("a letter in the middle of 400 kB", |bencher| {
        bencher.iter(|| {
            editing.insert(b"x").unwrap();
            colors.forget_behind(middle);
            let shown: usize =
                (middle..middle + SHOWN).map(|line| colors.words(editing.buffer(), line).len()).sum();
            editing.delete(Move::Left);
            // The loader gets a copy of the text.
            (shown, editing.buffer().bytes().to_vec())
        });
    });
    criterion.bench_function("completion of a name", |bencher| {
        editing.insert(b"sph").unwrap();
        let own = |from| own_names(editing.buffer(), from);
        bencher.iter(|| proposals(editing.buffer(), &mut colors, editing.cursor(), false, own));
    });
}

criterion_group!(benches, type_letters);
criterion_main!(benches);
