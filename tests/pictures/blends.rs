//! Blends of two scenes: they have no holes, and both modes draw the same image.
//!
//! The test draws a few pairs of the shipped scenes. `MARIANA_PAIRS=all` draws every pair at three fractions and prints
//! a table. `MARIANA_PAIRS=orb,city` draws only pairs with one of these names. `MARIANA_BLEND` sets the kind of blend.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::collections::BTreeMap;

use crate::support::compare::{LOOSE, difference};
use crate::support::test_renderer::{TestRenderer, loud_sound, ready};
use cpu_time::ProcessTime;
use image::RgbaImage;
use mariana::frame::Frame;
use mariana::gpu::program::Program;
use mariana::gpu::renderer::{Counting, Evaluations};
use mariana::gpu::scene_program::Mode;
use mariana::scenes::{ReadyScene, SceneSource, shipped_names};
use mariana_field::world::{Alignment, BlendKind, PortalShape, World, blended_params};

const SIZE: (u32, u32) = (96, 54);
const TIME: f64 = 20.0;

/// The pairs that are always drawn. In order, the melts test planes in both scenes, a non-Lipschitz scene with a
/// distance field, a closed space, a bounded scene with an unbounded scene, many interpreter registers, and an endless
/// wall with a single object. The other pairs are portals.
const SLICE: [(&str, &str, BlendKind, f32); 9] = [
    ("speakers", "first_steps", BlendKind::Melt, 0.5),
    ("heart", "terrain", BlendKind::Melt, 0.25),
    ("tunnel", "city", BlendKind::Melt, 0.5),
    ("orb", "letters", BlendKind::Melt, 0.75),
    ("kaleidoscope", "lattice", BlendKind::Melt, 0.5),
    ("clockwork", "orb", BlendKind::Melt, 0.5),
    ("metaballs", "moonrise", BlendKind::Portal(PortalShape::Ball), 0.4),
    ("first_steps", "gyroid", BlendKind::Portal(PortalShape::Plane), 0.6),
    ("speakers", "heart", BlendKind::Portal(PortalShape::Own), 0.4),
];

/// Maximum fraction of pixels whose rays reach their step cap.
const CAPPED_MAX: f64 = 0.001;
/// The same limit for portals. Where the floors of the scenes differ, rays take many steps along the floor's edge.
const CAPPED_BY_PORTALS_MAX: f64 = 0.005;

struct Drawn {
    picture: RgbaImage,
    evaluations: Evaluations,
    not_finite: usize,
    cpu_ms: f64,
}

fn draw(test_renderer: &mut TestRenderer, program: &Program, params: &[f32]) -> Drawn {
    let frame = Frame::with_params(test_renderer.world(), TIME, loud_sound(), SIZE, params);
    let start = ProcessTime::now();
    test_renderer.renderer.draw(&frame, &test_renderer.resources, program).unwrap();
    let picture = RgbaImage::from_raw(SIZE.0, SIZE.1, test_renderer.renderer.read()).unwrap();
    let cpu_ms = start.elapsed().as_secs_f64() * 1e3;
    let light = test_renderer.renderer.read_light().unwrap();
    Drawn {
        picture,
        evaluations: test_renderer.renderer.evaluations(),
        not_finite: light.iter().filter(|part| !part.is_finite()).count(),
        cpu_ms,
    }
}

fn faults(kind: BlendKind, compiled: &Drawn, interpreted: &Drawn) -> Vec<String> {
    let mut faults = Vec::new();
    let pixels = f64::from(SIZE.0 * SIZE.1);
    let capped_max = if kind == BlendKind::Melt { CAPPED_MAX } else { CAPPED_BY_PORTALS_MAX };
    for (mode, drawn) in [("compiled", compiled), ("interpreted", interpreted)] {
        let capped = drawn.evaluations.capped_rays / pixels;
        if capped > capped_max {
            faults.push(format!("{mode}: {:.2} % of the rays reach the step cap", 100.0 * capped));
        }
        if drawn.not_finite > 0 {
            faults.push(format!("{mode}: {} values are not finite", drawn.not_finite));
        }
    }
    let found = difference(&compiled.picture, &interpreted.picture, LOOSE.visible);
    if found.mean > LOOSE.mean_max || found.fraction > LOOSE.fraction_max {
        faults.push(format!("modes differ in {:.2} %", 100.0 * found.fraction));
    }
    faults
}

fn shipped(name: &str) -> ReadyScene {
    ready(&SceneSource::Shipped(name.to_owned()))
}

/// Returns the renderer, the compile time in milliseconds and the number of clauses.
fn test_renderer_of(
    from: &ReadyScene,
    to: &ReadyScene,
    kind: BlendKind,
) -> (TestRenderer, [Program; 2], [f64; 2]) {
    let camera = |scene: &ReadyScene| Frame::new(&scene.world, TIME, loud_sound(), SIZE).values.camera;
    let blended = from.blended(to, kind, &Alignment::of(&camera(from), &camera(to)), 0.5).unwrap();
    let start = ProcessTime::now();
    let test_renderer = TestRenderer::of_ready(blended, Mode::Compiled, Counting::On);
    let compiled_ms = start.elapsed().as_secs_f64() * 1e3;
    test_renderer.resources.set_cells(true, Mode::Interpreted);
    let programs =
        [Mode::Compiled, Mode::Interpreted].map(|mode| test_renderer.program_of(mode, Counting::On));
    let clauses = test_renderer.resources.buffers().cost.total as f64;
    (test_renderer, programs, [compiled_ms, clauses])
}

fn params(from: &World, to: &World, fraction: f32) -> Vec<f32> {
    blended_params((&from.scene, &[]), (&to.scene, &[]), fraction)
}

#[test]
fn blends_have_no_holes_and_both_modes_agree() {
    let mut wrong = Vec::new();
    for (from, to, kind, fraction) in SLICE {
        let [a, b] = [from, to].map(shipped);
        let (mut test_renderer, programs, _) = test_renderer_of(&a, &b, kind);
        let params = params(&a.world, &b.world, fraction);
        let [compiled, interpreted] = [0, 1].map(|mode| draw(&mut test_renderer, &programs[mode], &params));
        let faults = faults(kind, &compiled, &interpreted);
        if !faults.is_empty() {
            wrong.push(format!("{from} into {to} at {fraction}: {}", faults.join(", ")));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn all_pairs() {
    let Ok(wanted) = std::env::var("MARIANA_PAIRS") else { return };
    let kind = std::env::var("MARIANA_BLEND").ok();
    let kind = kind.map_or(BlendKind::Melt, |name| BlendKind::named(&name).unwrap());
    let names = shipped_names();
    let wanted = |from: &str, to: &str| {
        wanted == "all" || wanted.split(',').any(|one| one == from || one == format!("{from}:{to}"))
    };
    let scenes: BTreeMap<&str, ReadyScene> =
        names.iter().map(|name| (name.as_str(), shipped(name))).collect();
    let alone: BTreeMap<&str, [Drawn; 2]> = scenes
        .iter()
        .map(|(name, scene)| {
            let mut test_renderer = TestRenderer::of_ready(scene.clone(), Mode::Compiled, Counting::On);
            test_renderer.resources.set_cells(true, Mode::Interpreted);
            let both = [Mode::Compiled, Mode::Interpreted].map(|mode| {
                let program = test_renderer.program_of(mode, Counting::On);
                draw(&mut test_renderer, &program, &[]);
                draw(&mut test_renderer, &program, &[])
            });
            (*name, both)
        })
        .collect();
    println!(
        "pair fraction | capped compiled, interpreted % | modes differ % | evaluations, clauses, CPU ms \
         compiled and interpreted, each with its ratio to the sum | compiling ms, clauses"
    );
    for (from, a) in &scenes {
        for (to, b) in &scenes {
            if from == to || !wanted(from, to) {
                continue;
            }
            let (mut test_renderer, programs, [compiling, clauses]) = test_renderer_of(a, b, kind);
            for fraction in [0.25, 0.5, 0.75] {
                let params = params(&a.world, &b.world, fraction);
                let [compiled, interpreted] = [0, 1].map(|mode| {
                    // Draw a frame before the measurement, because the first frame builds the region tree.
                    draw(&mut test_renderer, &programs[mode], &params);
                    draw(&mut test_renderer, &programs[mode], &params)
                });
                if let Some(folder) = std::env::var_os("MARIANA_PICTURES") {
                    let name = format!("{from}-{to}-{fraction}.png");
                    compiled.picture.save(std::path::Path::new(&folder).join(name)).unwrap();
                }
                let pixels = f64::from(SIZE.0 * SIZE.1);
                let sum = |of: &dyn Fn(&[Drawn; 2]) -> f64| of(&alone[from]) + of(&alone[to]);
                let evaluations = compiled.evaluations.total() / sum(&|both| both[0].evaluations.total());
                let clauses_of = |e: &Evaluations| e.clauses + e.surface_clauses;
                let run =
                    clauses_of(&interpreted.evaluations) / sum(&|both| clauses_of(&both[1].evaluations));
                let cpu = [&compiled, &interpreted].map(|drawn| drawn.cpu_ms);
                let cpu_ratio = [cpu[0] / sum(&|both| both[0].cpu_ms), cpu[1] / sum(&|both| both[1].cpu_ms)];
                let capped = [&compiled, &interpreted].map(|d| 100.0 * d.evaluations.capped_rays / pixels);
                let modes = difference(&compiled.picture, &interpreted.picture, LOOSE.visible);
                println!(
                    "{from}:{to} {fraction} | {:.3} {:.3} | {:.2} | {:.1} {evaluations:.2} {run:.2} {:.0} {:.2} {:.0} {:.2} | {compiling:.0} {clauses} | {}",
                    capped[0],
                    capped[1],
                    100.0 * modes.fraction,
                    compiled.evaluations.total() / pixels,
                    cpu[0],
                    cpu_ratio[0],
                    cpu[1],
                    cpu_ratio[1],
                    faults(kind, &compiled, &interpreted).join(", ")
                );
            }
        }
    }
}
