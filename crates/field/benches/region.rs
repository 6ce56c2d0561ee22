//! How long the tree of a frame takes, on one thread: of some shipped scenes, and of a scene of over 11,000
//! clauses.

use mariana_field::graph::{SoundInput, SoundInputs};
use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use mariana_field::graph::FrameInputs;
use mariana_field::lang::{compile, no_includes};
use mariana_field::region::{RegionOptions, RegionPlan};
use mariana_field::world::World;

/// 400 boxes and 100 balls that flow together.
const MANY: &str = "
fn place(i) = vec3(10 * sin(12.9898 * i), 3 + 3 * sin(78.233 * i), 10 * sin(37.719 * i))
let boxes = union(for i in 0..400: box(p - place(i), vec3(0.2 + 0.1 * sin(i), 0.3, 0.25)))
let balls = smooth_union(for i in 0..100: sphere(p - place(i + 1000), 0.4 + 0.2 * band(0)), 0.3)
min(boxes, balls)
";

const SCENES: [(&str, &str); 6] = [
    ("speakers", include_str!("../../../assets/scenes/speakers.scene")),
    ("gyroid", include_str!("../../../assets/scenes/gyroid.scene")),
    ("lattice", include_str!("../../../assets/scenes/lattice.scene")),
    ("tunnel", include_str!("../../../assets/scenes/tunnel.scene")),
    ("terrain", include_str!("../../../assets/scenes/terrain.scene")),
    ("many", MANY),
];

/// A moment of loud music.
fn inputs_of(world: &World) -> FrameInputs {
    let mut inputs = FrameInputs {
        time: 31.0,
        sound: SoundInputs::with(&[(SoundInput::VolumeLeft, 0.18), (SoundInput::VolumeRight, 0.12)]),
        bands: std::array::from_fn(|band| 0.3 + 0.3 * (1.7 * band as f32).sin()),
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
        let inputs = inputs_of(&world);
        let center = world.frame_tape.values(&inputs).camera.position;
        let eye = world.bounds.is_some_and(|bounds| !world.steep && bounds.hold(center)).then_some(center);
        let options = RegionOptions { cells: true, texels_max: 1 << 22, center, eye };
        let plan = RegionPlan::new(&world);
        eprintln!("{name}: {:?}", plan.build(&inputs, &options).stats);
        group.bench_function(name, |bencher| bencher.iter(|| black_box(plan.build(&inputs, &options))));
    }
    group.finish();
}

criterion_group!(benches, trees);
criterion_main!(benches);
