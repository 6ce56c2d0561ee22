//! Traces melts of the shipped scenes: at fractions from 0.2 to 0.8, both scenes must be visible.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use crate::expression::Random;
use mariana_field::graph::{FrameInputs, Levels, Point, SoundInput, SoundInputs, TableData};
use mariana_field::lang::{compile, no_includes};
use mariana_field::tape::{PointEvaluator, Tape};
use mariana_field::world::{Alignment, BlendKind, World};

const RAYS: (usize, usize) = (32, 18);
const STEPS: usize = 160;
/// A ray hits a surface if the distance is less than this fraction of the ray's length.
const NEAR: f32 = 0.004;
const FAR: f32 = 60.0;

/// Returns the shipped scene `name`, with all surfaces in the grey `color` and without images.
fn scene(name: &str, color: f32) -> World {
    let path = format!("{}/../../assets/scenes/{name}.scene", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(path).unwrap();
    let mut scene = compile(name, &text, &mut no_includes).scene.unwrap();
    let color = scene.graph.constant(color);
    scene.materials.iter_mut().for_each(|material| material.color = [color; 3]);
    World::new(name, scene, Vec::new()).unwrap()
}

fn inputs(params: Vec<f32>) -> FrameInputs {
    let heights = |count: usize| (0..count).map(|at| 0.4 + 0.3 * (0.7 * at as f32).sin()).collect::<Vec<_>>();
    FrameInputs {
        time: 20.0,
        sound: SoundInputs::with(&[(SoundInput::VolumeLeft, 0.2), (SoundInput::VolumeRight, 0.2)]),
        levels: Levels::each(|_, number| 0.4 + 0.3 * (1.7 * number as f32).sin()),
        spectrum: TableData::row(heights(512)),
        waveform: TableData::row(heights(512)),
        history: TableData::rows(heights(128 * 240), 128),
        params,
        ..FrameInputs::default()
    }
}

fn own_params(world: &World) -> Vec<f32> {
    world.scene.params.iter().map(|param| param.default).collect()
}

/// The fractions of an image's rays that hit the first scene, that hit the second scene, and that hit no surface.
fn shown(melt: &World, inputs: FrameInputs) -> [f32; 3] {
    let camera = melt.frame_tape.values(&inputs).camera;
    let inputs = FrameInputs { eye: camera.position, ..inputs };
    let tape_of = |roots: &[_]| Tape::new(&melt.scene.graph, roots);
    let (distance, owner) = (tape_of(&[melt.scene.distance]), tape_of(&melt.scene.materials[0].color[..1]));
    let (mut distance, mut owner) =
        (PointEvaluator::new(&distance, &inputs), PointEvaluator::new(&owner, &inputs));
    let ray_probe = [0, 1, 2].map(|axis| camera.target[axis] - camera.position[axis]);
    let level = ray_probe[0].hypot(ray_probe[2]).max(1e-3);
    let ahead = ray_probe.map(|part| part / level.hypot(ray_probe[1]));
    let right = [ray_probe[2] / level, 0.0, -ray_probe[0] / level];
    let up = [
        ahead[1] * right[2] - ahead[2] * right[1],
        ahead[2] * right[0] - ahead[0] * right[2],
        ahead[0] * right[1] - ahead[1] * right[0],
    ];
    let high = (0.5 * camera.fov.to_radians()).tan();
    let mut counts = [0.0; 3];
    for ray in 0..RAYS.0 * RAYS.1 {
        let place = |index: usize, count: usize| 2.0 * (index as f32 + 0.5) / count as f32 - 1.0;
        let (x, y) = (place(ray % RAYS.0, RAYS.0) * high * 16.0 / 9.0, place(ray / RAYS.0, RAYS.1) * high);
        let way = [0, 1, 2].map(|axis| ahead[axis] + x * right[axis] + y * up[axis]);
        let length = way.iter().map(|part| part * part).sum::<f32>().sqrt();
        let at = |t: f32| Point {
            position: [0, 1, 2].map(|axis| camera.position[axis] + t * way[axis] / length),
            normal: [0.0, 1.0, 0.0],
        };
        let mut t = 0.0;
        let mut left = STEPS;
        while left > 0 && t < FAR {
            left -= 1;
            let free = distance.at(&at(t))[0];
            if free < NEAR * (1.0 + t) {
                let second = owner.at(&at(t))[0];
                counts[0] += 1.0 - second;
                counts[1] += second;
                break;
            }
            t += 0.9 * free;
        }
        counts[2] += f32::from(u8::from(left == 0));
    }
    counts.map(|count| count / (RAYS.0 * RAYS.1) as f32)
}

fn melt_of(from: &World, to: &World) -> World {
    let [a, b] = [from, to].map(|world| world.frame_tape.values(&inputs(own_params(world))).camera);
    World::blend(from, to, BlendKind::Melt, &Alignment::of(&a, &b), 0.5).unwrap()
}

#[test]
fn a_melt_shows_both_scenes() {
    const NAMES: [&str; 17] = [
        "barth",
        "city",
        "clockwork",
        "first_steps",
        "gyroid",
        "heart",
        "kaleidoscope",
        "lattice",
        "letters",
        "metaballs",
        "moonrise",
        "orb",
        "quadric",
        "speakers",
        "terrain",
        "tunnel",
        "wave_tank",
    ];
    let mut random = Random(5);
    let mut pairs = vec![(5, 15)];
    while pairs.len() < 30 {
        let pair = (random.below(NAMES.len()), random.below(NAMES.len()));
        if pair.0 != pair.1 && !pairs.contains(&pair) {
            pairs.push(pair);
        }
    }
    let mut wrong = Vec::new();
    for (from, to) in pairs {
        let (from, to) = (scene(NAMES[from], 0.0), scene(NAMES[to], 1.0));
        let melt = melt_of(&from, &to);
        let mut line = format!("{}:", melt.name);
        let mut is_missing = false;
        for fraction in [0.2, 0.35, 0.5, 0.65, 0.8] {
            let both = [&from, &to].into_iter().flat_map(|world| &world.scene.params);
            let params = both.map(|param| param.default).chain([fraction]).collect();
            let [first, second, capped] = shown(&melt, inputs(params));
            line += &format!(" {fraction}: {first:.3} {second:.3} ({capped:.3})");
            // The lattice itself covers little of the picture.
            let least = if melt.name.contains("lattice") { 0.005 } else { 0.01 };
            is_missing |= first < least || second < least;
        }
        println!("{line}");
        if is_missing {
            wrong.push(line);
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
