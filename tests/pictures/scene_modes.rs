//! A scene looks the same in all modes: interpreted, compiled, or written by hand in GLSL.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use crate::support::compare::{LOOSE, TIGHT, Tolerance, assert_alike, difference};
use crate::support::oracle::BY_HAND;
use crate::support::test_renderer::{
    TestRenderer, driver, loud_music, loud_sound, ready, silence, soft_music, speakers,
};
use image::RgbaImage;
use mariana::config::SdfChoice;
use mariana::export::painter::{SceneChoice, mode_on};
use mariana::export::show_painter::ShowPainter;
use mariana::gpu::error::DoesNotFit;
use mariana::gpu::gl::GlInfo;
use mariana::gpu::mode::CellUse;
use mariana::gpu::program::Program;
use mariana::gpu::renderer::{Counting, Evaluations};
use mariana::gpu::scene_program::{Interpreter, Mode, compiled_variant, compiled_variant_of, without_cells};
use mariana::gpu::shader_source::ShaderLibrary;
use mariana::scenes::SceneSource;
use mariana_music::{Sound, Tables};

const SIZE: (u32, u32) = (240, 135);

/// A fixed plane, a plane that turns with time, and a ball between the planes.
const PLANES: &str = "min(min(y, 0.6*x + 0.8*(9 + sin(t) - z)), sqrt(x*x + (y-1)*(y-1) + (z-4)*(z-4)) - 1)";

const UNBOUNDED: &str = "y + 0.2*sin(x)*sin(z)";

/// Many features of scenes: objects with a bound and planes, two ways of texturing, all material properties, both kinds
/// of light, parameters, a sky, and a camera that rolls.
const MANY: &str = r#"
param size = 1.1 in 0.5 .. 2
param glow = 0.4 in 0 .. 1

# Of eight pillars the one in whose place the point is; the others are no nearer than the place's rim.
fn place_of(x) = clamp(floor(x + 4), 0, 7)
fn pillar(p) {
  let half = 0.4 + 0.8 * band(4 * place_of(p.x))
  round_box(p - vec3(place_of(p.x) - 3.5, half, 7), vec3(0.2, half, 0.2) - 0.05, 0.05)
}
fn others(p) = max(0.3, box(p - vec3(0, 1.2, 7), vec3(4, 1.2, 0.2)))
fn ball_at() = vec3(-1.2, 1.3 + 0.3 * sin(t), 4)

material wood { color = triplanar("wood.png", p * 0.3, n)  roughness = 0.5  coat = 0.7 }
material bird {
  let picture = texture("mallard.png", vec2(p.x, -p.y) * 0.6 + vec2(1.2, 1.3))
  color     = mix(vec3(0.7, 0.6, 0.5), picture.rgb, picture.a)
  roughness = 0.3
  metalness = 0.4
  emission  = glow * vec3(0.3, 0.05, 0.02) * volume.x
}
material mirror { color = vec3(0.1, 0.1, 0.12)  roughness = 0.8  reflect = 0.4  haze = 1 - exp(-dot(p.xz, p.xz) / 900) }

object row   { shape = pillar(p)  bound = others(p)  material = wood }
object ball  { shape = smooth_union(sphere(p - ball_at(), size), box(p - vec3(1.5, 0.6, 4), 0.6), 0.5)  material = bird }
object floor { shape = p.y  material = mirror }
object wall  { shape = 0.6 * p.x + 0.8 * (12 - p.z)  material = wood }

light sun  { direction = vec3(0.4, -1, 0.7)  color = vec3(2, 1.8, 1.5)  radius = 0.05 }
light lamp { position = vec3(4 * cos(t), 5, 1)  color = vec3(20, 30, 60) * (0.5 + volume.y)  radius = 0.4 }
sky {
  color   = mix(vec3(0.3, 0.2, 0.15), vec3(0.05, 0.1, 0.3), clamp(direction.y, 0, 1))
  ambient = vec3(0.1, 0.12, 0.15) * (1 + direction.y)
}
camera { position = vec3(0, 2.5, -2)  target = vec3(0, 1.2, 6)  fov = 55  roll = 0.05 * sin(t) }
"#;

/// Texts and pictures as shapes, in shapes and in a material, beside the tables of the sound.
const WORDS: &str = r#"
material paint {
  color = vec3(0.5, 0.2, 0.1) + 0.4 * spectrum(0.5 + p.x / 12) * vec3(0.2, 0.5, 0.1) + 0.3 * step(image("mallard.png", p.xz / 2), 0)
}
object word { shape = extrude(text("Ägir 8&", p.xy - vec2(-1, 0.7 + 0.3 * band(3))), p.z - 4, 0.2)  material = paint }
object bird { shape = round(extrude(image("mallard.png", p.xy - vec2(2.6, 0.6)), p.z - 4, 0.1), 0.03) }
object floor { shape = p.y  material = paint }
light sun { direction = vec3(0.4, -1, 0.7)  color = vec3(2, 1.8, 1.5)  radius = 0.05 }
camera { position = vec3(-1, 2.2, -3)  target = vec3(0, 0.8, 4)  fov = 50 }
"#;

/// A scene that reads every sound value: hills from the history of the spectrum, a floor with the waveform, and a ball.
const HEARS_ALL: &str = r#"
fn hills(p) = 0.25 * (p.y - 1.6 * history(0.5 + p.x / 12, p.z / 20))
fn ball_at() = vec3(6 * pitch - 2 + 0.2 * bass_drive, 2.6 + volume_mid, 6 + phase)
material lines {
  color    = vec3(0.2, 0.25, 0.3) + 0.5 * spectrum(0.5 + p.x / 12) * vec3(0.5, 0.2, 0.1)
  emission = vec3(0, 0.4, 0.1) * step(abs(p.z - 4 - 2 * waveform(0.5 + p.x / 8)), 0.1)
}
material heard { color = vec3(bass, mid, treble)  emission = beat * vec3(0.2, 0.1, 0.1) + vec3(0, 0, volume_side) }
object land { shape = hills(p)  material = lines }
object ball { shape = sphere(p - ball_at(), 0.6 + 0.004 * tempo * beat)  material = heard }
light sun { direction = vec3(0.4, -1, 0.7)  color = vec3(2, 1.8, 1.5)  radius = 0.05 }
camera { position = vec3(0.3 * sin(t), 4, -3)  target = vec3(0, 1, 7)  fov = 60 }
"#;

/// A forest by repetition. At each point, some 350 non-Lipschitz clauses compute the nearest trees. By interval
/// arithmetic, the ellipsoids have slopes in the thousands.
const FOREST: &str = r#"
fn tree(p, height) = union(
  round_cone(p, 0.12, 0.05, height),
  ellipsoid(p - vec3(0, height, 0), vec3(0.5, 0.4 + 0.3 * height, 0.5)))
fn tree_of(p, cell) {
  let offset = 0.6 * (vec2(hash(vec3(cell, 2)), hash(vec3(cell, 3))) - 0.5)
  let grown = hash(vec3(cell, 1))
  let foot = vec3(2 * cell.x + offset.x, 0, 2 * cell.y + offset.y)
  tree(p - foot, 0.6 + 1.2 * grown + 0.3 * band(floor(31 * grown)))
}
fn forest(p) {
  let cell = floor(p.xz / 2)
  union(for i in 0..2: for j in 0..2: tree_of(p, cell + vec2(i, j)))
}
material leaf { color = mix(vec3(0.1, 0.35, 0.08), vec3(0.5, 0.35, 0.05), hash(vec3(round(p.xz / 2), 4))) }
material ground { color = vec3(0.15, 0.12, 0.06) }
object trees { shape = forest(p)  material = leaf }
object ground { shape = p.y  material = ground }
light sun { direction = vec3(1, -1, 0.4)  color = vec3(3, 2.6, 2) }
camera { position = vec3(8, 2.5, -6)  target = vec3(10, 1, 4) }
"#;

fn drawn(
    test_renderer: &mut TestRenderer,
    program: &Program,
    time: f64,
    sound: impl Into<Sound>,
    size: (u32, u32),
) -> (RgbaImage, Evaluations) {
    let frame = test_renderer.frame(time, sound, size);
    test_renderer.renderer.draw(&frame, &test_renderer.resources, program).unwrap();
    let picture = RgbaImage::from_raw(size.0, size.1, test_renderer.renderer.read()).unwrap();
    (picture, test_renderer.renderer.evaluations(1.0))
}

/// Like [`drawn`], in loud music. Without a program, draws with the renderer's own.
fn counted(
    test_renderer: &mut TestRenderer,
    program: Option<&Program>,
    time: f64,
    size: (u32, u32),
) -> (RgbaImage, Evaluations) {
    match program {
        Some(program) => drawn(test_renderer, program, time, loud_sound(), size),
        None => (test_renderer.picture(time, loud_sound(), size), test_renderer.renderer.evaluations(1.0)),
    }
}

fn kinds(all: &Evaluations) -> [f64; 5] {
    [all.primary, all.reflection, all.normal, all.shadow, all.occlusion]
}

/// Shipped scenes that are also drawn by programs without code for cells: swarms, rough mirrors, glass and velvet; media;
/// panels and textures; translucent bodies and bounced light; feedback and a sky of pixels; a tunnel; none of these. The
/// scenes of this file are drawn so, too.
const WITHOUT_CELLS: [&str; 7] = ["rain", "cathedral", "speakers", "wax_world", "ink", "tunnel", "orb"];

/// How images of both modes are compared.
struct Comparison<'a> {
    /// In seconds.
    times: &'a [f64],
    size: (u32, u32),
    tolerance: Tolerance,
    /// True if no ray may reach its step cap.
    is_complete: bool,
    /// True to draw also by a program without code for cells.
    is_without_cells: bool,
}

fn assert_modes_agree(name: &str, scene: &SceneSource, times: &[f64]) {
    let mut test_renderer = TestRenderer::of(scene, Mode::Compiled, Counting::On);
    let comparison =
        Comparison { times, size: SIZE, tolerance: TIGHT, is_complete: false, is_without_cells: true };
    compare_modes(name, &mut test_renderer, &comparison);
}

/// Compares the modes of a shipped scene. `test_renderer` has its compiled program, which counts.
pub(super) fn check_modes(name: &str, test_renderer: &mut TestRenderer) {
    // In these small images, many details are finer than a pixel, so rounding can decide on which side of a detail's
    // edge a ray ends.
    let is_without_cells = WITHOUT_CELLS.contains(&name);
    let comparison =
        Comparison { times: &[40.0], size: (160, 90), tolerance: LOOSE, is_complete: true, is_without_cells };
    compare_modes(name, test_renderer, &comparison);
}

/// Compares both modes, with and without regions, in loud music. Fails unless the images match and the numbers of
/// evaluations without regions are about equal.
fn compare_modes(name: &str, test_renderer: &mut TestRenderer, comparison: &Comparison) {
    let &Comparison { times, size, tolerance, is_complete, is_without_cells } = comparison;
    let interpreter = test_renderer.program_of(Mode::Interpreted, Counting::On);
    let world = test_renderer.resources.world();
    let non_lipschitz = world.non_lipschitz;
    // A scene of sky and planes alone evaluates no distance.
    let has_surfaces = world.has_rest;
    let without_code = (is_without_cells && !non_lipschitz).then(|| {
        let variant = compiled_variant_of(test_renderer.world(), Counting::On).unwrap();
        test_renderer.link(&ShaderLibrary::embedded(), &without_cells(variant))
    });
    let mut first: Option<RgbaImage> = None;
    for &time in times {
        let both = |test_renderer: &mut TestRenderer| {
            let compiled = counted(test_renderer, None, time, size);
            [compiled, counted(test_renderer, Some(&interpreter), time, size)]
        };
        test_renderer.resources.set_cells(true, Mode::Interpreted);
        let [skipping, short] = both(test_renderer);
        test_renderer.resources.set_cells(false, Mode::Interpreted);
        let [compiled, interpreted] = both(test_renderer);
        assert_alike(&format!("{name}-at-{time}-skipping"), &skipping.0, &compiled.0, tolerance);
        assert_alike(&format!("{name}-at-{time}-short"), &short.0, &compiled.0, tolerance);
        if is_complete {
            assert_eq!([&skipping, &short].map(|drawn| drawn.1.capped_rays), [0.0; 2], "{name} at {time} s");
        }
        let (fewer, all) = (short.1, interpreted.1);
        // Non-Lipschitz scenes use cells even if the test requests no regions.
        assert!(
            !has_surfaces || non_lipschitz || (fewer.total() <= all.total() && fewer.clauses < all.clauses),
            "{name}: {fewer:?}, but {all:?}"
        );
        assert_alike(&format!("{name}-at-{time}"), &interpreted.0, &compiled.0, tolerance);
        if let Some(program) = &without_code {
            let bare = counted(test_renderer, Some(program), time, size);
            assert_alike(&format!("{name}-at-{time}-without-code"), &bare.0, &compiled.0, TIGHT);
            assert_eq!(
                kinds(&bare.1),
                kinds(&compiled.1),
                "{name} at {time} s: unused code for cells changes the evaluations"
            );
            assert_eq!(bare.1.lookups, 0.0);
        }
        let (a, b) = (interpreted.1, compiled.1);
        assert!(
            !has_surfaces || b.primary > 0.0 && b.normal > 0.0,
            "{name}: primary or normal evaluations were not counted: \
            {b:?}"
        );
        for (a_kind, b_kind) in kinds(&a).into_iter().zip(kinds(&b)) {
            // The cells of non-Lipschitz scenes save the interpreter some occlusion probes.
            let fewer = non_lipschitz && a_kind < b_kind;
            assert!(
                fewer || (a_kind - b_kind).abs() <= 0.02 * b_kind,
                "{name} at {time} s: {a:?}, but {b:?}"
            );
        }
        assert_eq!(b.clauses, 0.0, "{name}: a compiled scene counted clauses");
        assert!(
            !has_surfaces || a.clauses > a.total(),
            "{name}: an evaluation has more than one clause: {a:?}"
        );
        // Two black images would also match, so the frame must differ from the previous one.
        let seen = first.get_or_insert_with(|| RgbaImage::new(size.0, size.1));
        let fraction = difference(seen, &compiled.0, TIGHT.visible).fraction;
        assert!(fraction > 0.05, "{name}: nothing is visible or moves at {time} s: {fraction}");
        first = Some(compiled.0);
    }
}

#[test]
fn both_modes_show_the_same_planes() {
    assert_modes_agree("planes", &SceneSource::Formula(PLANES.into()), &[0.0]);
}

#[test]
fn both_modes_show_the_same_scene_of_many_parts() {
    assert_modes_agree("many", &SceneSource::Formula(MANY.into()), &[3.0, 5.0]);
}

#[test]
fn both_modes_show_the_same_texts_and_pictures() {
    let scene = SceneSource::Formula(WORDS.into());
    assert_modes_agree("words", &scene, &[3.0]);
    let world = TestRenderer::of(&scene, Mode::Compiled, Counting::Off).resources.world().clone();
    assert!(!world.non_lipschitz, "the texts are not distances");
    assert!(world.scene.atlas.rows() > 200, "{} rows", world.scene.atlas.rows());
}

#[test]
fn both_modes_show_the_same_scene_with_every_sound_value() {
    let scene = SceneSource::Formula(HEARS_ALL.into());
    assert_modes_agree("hears-all", &scene, &[3.0]);

    // Removing one of the sound tables must change the image.
    let mut test_renderer = TestRenderer::of(&scene, Mode::Compiled, Counting::Off);
    let whole = test_renderer.picture(3.0, loud_sound(), SIZE);
    let sounds: [fn(&mut Tables); 3] = [|t| t.spectrum = None, |t| t.waveform = None, |t| t.history = None];
    for (number, take) in sounds.iter().enumerate() {
        let mut sound = loud_sound();
        take(&mut sound.tables);
        let without = test_renderer.picture(3.0, sound, SIZE);
        let fraction = difference(&whole, &without, TIGHT.visible).fraction;
        assert!(fraction > 0.01, "table {number} has no effect: {fraction}");
    }
}

#[test]
fn both_modes_show_the_same_surface_without_bounds() {
    let scene = SceneSource::Formula(UNBOUNDED.into());
    assert!(ready(&scene).world.bounds.is_none(), "the scene has bounds");
    assert_modes_agree("unbounded", &scene, &[0.0]);
}

/// The interpreter's loops once exceeded llvmpipe's limit of rounds, and later code read stale registers.
#[test]
fn an_interpreted_forest_matches_the_compiled_one() {
    let mut test_renderer =
        TestRenderer::of(&SceneSource::Formula(FOREST.into()), Mode::Compiled, Counting::Off);
    let programs =
        [Mode::Compiled, Mode::Interpreted].map(|mode| test_renderer.program_of(mode, Counting::Off));
    let [compiled, interpreted] =
        programs.map(|program| drawn(&mut test_renderer, &program, 3.0, loud_sound(), (160, 90)).0);
    assert_alike("forest", &interpreted, &compiled, LOOSE);
}

/// Rays once reached their step cap in front of the trees in large images, where steps are shorter.
#[test]
fn the_trees_of_a_forest_are_complete_in_larger_images() {
    let mut test_renderer =
        TestRenderer::of(&SceneSource::Formula(FOREST.into()), Mode::Compiled, Counting::On);
    let program = test_renderer.program_of(Mode::Compiled, Counting::On);
    let [(small, _), (large, counts)] =
        [(240, 135), (480, 270)].map(|size| drawn(&mut test_renderer, &program, 3.0, loud_sound(), size));
    let half = image::imageops::resize(&large, 240, 135, image::imageops::FilterType::Triangle);
    let apart = difference(&half, &small, 48);
    assert!(apart.mean < 3.0 && apart.fraction < 0.01, "the larger image differs: {apart:?}");
    assert!(counts.capped_rays < 0.001, "{counts:?}");
}

#[test]
fn the_compiled_speakers_match_the_hand_written_ones() {
    let mut test_renderer = TestRenderer::new();
    let textures = test_renderer.world().pictures.len();
    let variant = compiled_variant(BY_HAND, textures, test_renderer.world().features, Counting::Off);
    let by_hand = test_renderer.link(&ShaderLibrary::embedded(), &variant);
    let compiled = test_renderer.program_of(Mode::Compiled, Counting::Off);
    for (name, time, features) in
        [("loud", 12.0, loud_music()), ("soft", 33.3, soft_music()), ("silent", 61.7, silence())]
    {
        let size = (320, 180);
        let (expected, _) = drawn(&mut test_renderer, &by_hand, time, features, size);
        let (actual, _) = drawn(&mut test_renderer, &compiled, time, features, size);
        assert_alike(&format!("by-hand-{name}"), &actual, &expected, TIGHT);
    }
}

#[test]
fn a_tape_too_large_for_the_driver_is_compiled() {
    let scene = ready(&speakers());
    let needed = scene.buffers.texels_max();
    assert!(needed > 100, "the speakers take only {needed} texels");
    let with = |texels: usize| GlInfo { list_texels_max: texels as u32, ..driver(false) };

    assert_eq!(Interpreter::fits(&scene.buffers, &scene.plan, &with(needed)), Ok(()));
    assert_eq!(
        mode_on(SdfChoice::Interpreted, &scene.buffers, &scene.plan, &with(needed)),
        Mode::Interpreted
    );

    let available = needed - 1;
    let error = Interpreter::fits(&scene.buffers, &scene.plan, &with(available)).unwrap_err();
    assert_eq!(error, DoesNotFit::Texels { needed, available });
    let message = error.to_string();
    let reported: Vec<usize> =
        message.split(|c: char| !c.is_ascii_digit()).filter_map(|word| word.parse().ok()).collect();
    assert_eq!(reported, [needed, available], "{message}");
    assert_eq!(
        mode_on(SdfChoice::Interpreted, &scene.buffers, &scene.plan, &with(available)),
        Mode::Compiled
    );
}

#[test]
fn a_painter_uses_the_requested_mode() {
    for (sdf, expected) in [
        (SdfChoice::Interpreted, Mode::Interpreted),
        (SdfChoice::Compiled, Mode::Compiled),
        (SdfChoice::Auto, Mode::Compiled),
    ] {
        let source = SceneSource::Formula(PLANES.into());
        let choice = SceneChoice { sdf, cells: CellUse::Always, ..SceneChoice::from(source) };
        let ready = choice.source.ready().unwrap();
        let mut painter = ShowPainter::of_scene(&choice, ready, &[]).unwrap();
        painter.draw(0.0, vec![(0.0, silence().into())], Vec::new(), (16, 9)).unwrap();
        assert_eq!(painter.mode(), Some(expected));
        assert_eq!(painter.read().len(), 16 * 9 * 4);
    }
}

#[test]
fn a_compiled_scene_uses_cells_only_if_they_pay_or_are_requested() {
    let foam = |count: usize| {
        let ball =
            "sphere(p - vec3(3 * sin(i * 12.9898), 2 + 2 * sin(i * 78.233), 3 * sin(i * 37.719)), 0.3)";
        SceneSource::Formula(format!("object foam {{ shape = union(for i in 0..{count}: {ball}) }}"))
    };
    let cells = |scene: &SceneSource, change| {
        let test_renderer = TestRenderer::of(scene, Mode::Interpreted, Counting::Off);
        [Mode::Interpreted, Mode::Compiled].map(|mode| test_renderer.resources.uses_cells(change, mode))
    };
    assert_eq!(cells(&foam(9), CellUse::WhereTheyPay), [true, false]);
    assert_eq!(cells(&foam(300), CellUse::WhereTheyPay), [true, true]);
    assert_eq!(cells(&foam(9), CellUse::Always), [true, true]);
    assert_eq!(cells(&foam(300), CellUse::Never), [false, false]);
    let non_lipschitz = SceneSource::Formula("sin(x)*cos(y) + sin(y)*cos(z) + sin(z)*cos(x)".into());
    assert_eq!(
        cells(&non_lipschitz, CellUse::Never),
        [true, true],
        "without cells, rays would miss the \
        surface"
    );
}
