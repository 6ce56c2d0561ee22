//! Measures the time to build the region trees of consecutive frames on one thread, for some shipped scenes, a scene of
//! over 6,000 clauses, and a union of 1,000 things. `first` builds a tree from nothing. `next` reuses the previous
//! frame's tree; frames are 1/60 s apart, and the music changes. `tapes` writes the programs of materials and light.

use mariana_field::graph::{SoundInput, SoundInputs};
use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use mariana_field::graph::{FrameInputs, Levels, TableData};
use mariana_field::lang::{compile, no_includes};
use mariana_field::region::{Part, RegionOptions, RegionPlan};
use mariana_field::world::{ShortPrograms, World};

const MANY: &str = "
fn place(i) = vec3(10 * sin(12.9898 * i), 3 + 3 * sin(78.233 * i), 10 * sin(37.719 * i))
let boxes = union(for i in 0..400: box(p - place(i), vec3(0.2 + 0.1 * sin(i), 0.3, 0.25)))
let balls = smooth_union(for i in 0..100: sphere(p - place(i + 1000), 0.4 + 0.2 * band(0)), 0.3)
min(boxes, balls)
";

const SCENES: [(&str, &str); 9] = [
    ("speakers", include_str!("../../../assets/scenes/speakers.scene")),
    ("gyroid", include_str!("../../../assets/scenes/gyroid.scene")),
    ("lattice", include_str!("../../../assets/scenes/lattice.scene")),
    ("tunnel", include_str!("../../../assets/scenes/tunnel.scene")),
    ("terrain", include_str!("../../../assets/scenes/terrain.scene")),
    ("city", include_str!("../../../assets/scenes/city.scene")),
    ("letters", include_str!("../../../assets/scenes/letters.scene")),
    ("many", MANY),
    ("things", include_str!("things.scene")),
];

/// The sequence repeats after this many frames.
const FRAMES: usize = 64;

/// Columns and rows of the spectrum's history.
const HEARD: (usize, usize) = (64, 600);

/// Returns the spectra of the frames up to `frame`, the newest first.
fn heard_until(frame: usize) -> Vec<f32> {
    let of = |row: usize, column: usize| {
        0.3 + 0.3 * (0.4 * column as f32 + 0.1 * (frame as f32 - row as f32)).sin()
    };
    (0..HEARD.1).flat_map(|row| (0..HEARD.0).map(move |column| of(row, column))).collect()
}

fn inputs_of(world: &World, frame: usize) -> FrameInputs {
    let mut inputs = FrameInputs {
        time: 31.0 + frame as f32 / 60.0,
        sound: SoundInputs::with(&[(SoundInput::VolumeLeft, 0.18), (SoundInput::VolumeRight, 0.12)]),
        levels: Levels::each(|_, number| 0.3 + 0.3 * (1.7 * number as f32 + 0.1 * frame as f32).sin()),
        history: TableData::rows(heard_until(frame), HEARD.0),
        params: world.scene.params.iter().map(|param| param.default).collect(),
        ..FrameInputs::default()
    };
    inputs.hoisted = world.hoisted.values(&inputs);
    inputs
}

fn trees(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("tree");
    group.sample_size(10);
    for (name, text) in SCENES {
        let Some(scene) = compile(name, text, &mut no_includes).scene else { continue };
        let Ok(world) = World::new(name, scene, Vec::new()) else { continue };
        let frames: Vec<FrameInputs> = (0..FRAMES).map(|frame| inputs_of(&world, frame)).collect();
        let inputs = frames[0].clone();
        let center = world.frame_tape.values(&inputs).camera.position;
        let eye =
            world.bounds.is_some_and(|bounds| !world.non_lipschitz && bounds.hold(center)).then_some(center);
        let options = RegionOptions { cells: true, texels_max: 1 << 22, center, eye };
        let plan = RegionPlan::new(&world);
        group.bench_function(format!("{name}, first"), |bencher| {
            bencher.iter(|| black_box(plan.build(&inputs, &options)))
        });
        let mut last = plan.build(&inputs, &options);
        eprintln!("{name}: {:?}", last.stats);
        let mut frame = 0;
        group.bench_function(format!("{name}, next"), |bencher| {
            bencher.iter(|| {
                frame = (frame + 1) % FRAMES;
                last = black_box(plan.build_in_parts(Some(&last), &frames[frame], &options, 1, |parts| {
                    parts.iter_mut().for_each(Part::build)
                }));
            })
        });
        eprintln!("{name}: {:?}", last.stats);
        let (buffers, whole) = (world.tape_buffers(), ShortPrograms::default());
        group.bench_function(format!("{name}, tapes"), |bencher| {
            bencher.iter(|| black_box(buffers.texels(&inputs, &whole)))
        });
    }
    group.finish();
}

criterion_group!(benches, trees);
criterion_main!(benches);
