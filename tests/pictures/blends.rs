//! Blends of two scenes: they have no holes, and both modes draw the same image.
//!
//! The tests draw a few chosen pairs of the shipped scenes, and pairs that a seed draws. `cargo bench --bench transitions`
//! measures the cost of all pairs.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use crate::support::compare::{LOOSE, difference};
use crate::support::expression::Random;
use crate::support::test_renderer::{TestRenderer, loud_sound, ready};
use image::RgbaImage;
use mariana::frame::Frame;
use mariana::gpu::program::Program;
use mariana::gpu::renderer::{Counting, Evaluations};
use mariana::gpu::scene_program::Mode;
use mariana::scenes::{ReadyScene, SceneSource, shipped_names};
use mariana_field::world::{Alignment, BlendKind, PortalShape};

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
    ("metaballs", "village", BlendKind::Portal(PortalShape::Ball), 0.4),
    ("first_steps", "gyroid", BlendKind::Portal(PortalShape::Plane), 0.6),
    ("speakers", "heart", BlendKind::Portal(PortalShape::Own), 0.4),
];

/// Maximum fraction of pixels whose rays reach their step cap.
const CAPPED_MAX: f64 = 0.001;
/// The same limit for portals. Where the floors of the scenes differ, rays take many steps along the floor's edge.
const CAPPED_BY_PORTALS_MAX: f64 = 0.005;

/// A known fault: in this melt the modes differ in 1.9 % of the pixels.
const UNLIKE: (&str, &str) = ("cathedral", "forest");

/// A moment of a transition.
pub(super) struct Pair {
    pub(super) from: String,
    pub(super) to: String,
    pub(super) kind: BlendKind,
    pub(super) fraction: f32,
}

impl Pair {
    /// Pairs of shipped scenes, and melts at a fraction. Like the values of property tests, they are the same in each
    /// run, unless `PROPTEST_RNG_SEED` is another number.
    pub(super) fn drawn(count: usize) -> Vec<Self> {
        let seed = std::env::var("PROPTEST_RNG_SEED").ok().and_then(|seed| seed.parse().ok()).unwrap_or(1);
        let mut random = Random(seed);
        // Scenes that show their last frame have no blends.
        let can_blend =
            |name: &String| ready(&SceneSource::Shipped(name.clone())).world.frame_tape.feedback.is_none();
        let names: Vec<String> = shipped_names().into_iter().filter(can_blend).collect();
        let mut pairs = Vec::new();
        while pairs.len() < count {
            let [from, to] = [0, 1].map(|_| names[random.below(names.len())].clone());
            let fraction = 0.25 * (1 + random.below(3)) as f32;
            let has_glass = |name: &String| ready(&SceneSource::Shipped(name.clone())).world.features.glass;
            if from != to && (&*from, &*to) != UNLIKE && !has_glass(&from) && !has_glass(&to) {
                pairs.push(Self { from, to, kind: BlendKind::Melt, fraction });
            }
        }
        pairs
    }
}

struct Drawn {
    picture: RgbaImage,
    evaluations: Evaluations,
    not_finite: usize,
}

fn draw(test_renderer: &mut TestRenderer, program: &Program, params: &[f32]) -> Drawn {
    let frame = Frame::with_params(test_renderer.world(), TIME, loud_sound(), SIZE, params);
    test_renderer.renderer.draw(&frame, &test_renderer.resources, program).unwrap();
    let picture = RgbaImage::from_raw(SIZE.0, SIZE.1, test_renderer.renderer.read()).unwrap();
    let light = test_renderer.renderer.read_light().unwrap();
    Drawn {
        picture,
        evaluations: test_renderer.renderer.evaluations(1.0),
        not_finite: light.iter().filter(|part| !part.is_finite()).count(),
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

fn check(pair: &Pair) -> Result<(), String> {
    let Pair { from, to, kind, fraction } = pair;
    let [a, b] = [from, to].map(|name| ready(&SceneSource::Shipped(name.clone())));
    let camera = |scene: &ReadyScene| Frame::new(&scene.world, TIME, loud_sound(), SIZE).values.camera;
    let blended = a.blended(&b, *kind, &Alignment::of(&camera(&a), &camera(&b)), 0.5).unwrap();
    let mut test_renderer = TestRenderer::of_ready(blended, Mode::Compiled, Counting::On);
    test_renderer.resources.set_cells(true, Mode::Interpreted);
    let both = [&a, &b].into_iter().flat_map(|ready| &ready.world.scene.params);
    let params: Vec<f32> = both.map(|param| param.default).chain([*fraction]).collect();
    let [compiled, interpreted] = [Mode::Compiled, Mode::Interpreted].map(|mode| {
        let program = test_renderer.program_of(mode, Counting::On);
        draw(&mut test_renderer, &program, &params)
    });
    let faults = faults(*kind, &compiled, &interpreted);
    let shown = format!("{from} into {to}, {kind:?} at {fraction}: {}", faults.join(", "));
    if faults.is_empty() { Ok(()) } else { Err(shown) }
}

#[test]
fn blends_have_no_holes_and_both_modes_agree() {
    let pair = |(from, to, kind, fraction): (&str, &str, BlendKind, f32)| Pair {
        from: from.to_owned(),
        to: to.to_owned(),
        kind,
        fraction,
    };
    let wrong: Vec<String> = SLICE.into_iter().filter_map(|row| check(&pair(row)).err()).collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn blends_of_drawn_pairs_have_no_holes_and_both_modes_agree() {
    let wrong: Vec<String> = Pair::drawn(3).iter().filter_map(|pair| check(pair).err()).collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}
