//! Paths of light: known cases, both ways to find lights, both modes, media, the lens, reproducible bytes.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use crate::support::test_renderer::{TestRenderer, silence};
use mariana::frame::Frame;
use mariana::gpu::path_state::KeptPaths;
use mariana::gpu::program::Program;
use mariana::gpu::renderer::{Counting, PathOrder, PathProgress, PathSampling, PathWatcher};
use mariana::gpu::scene_program::{Mode, path_texts, variant_of};
use mariana::gpu::shader_source::ShaderLibrary;
use mariana::scenes::SceneSource;

const SIZE: (u32, u32) = (32, 32);

fn order(samples: u32) -> PathOrder {
    PathOrder { samples, noise: 0.0, first: 0, sampling: PathSampling::Both, is_filtered: false }
}

struct Paths {
    // Dropped before its context.
    program: Program,
    renderer: TestRenderer,
}

/// Watches the progress, and keeps no paths.
struct Watcher<'a>(&'a mut dyn FnMut(PathProgress) -> bool);

impl PathWatcher for Watcher<'_> {
    fn begin(&mut self, _: &Frame, _: usize) -> Option<KeptPaths> {
        None
    }

    fn resume(&mut self, progress: PathProgress, _: &dyn Fn() -> KeptPaths) -> bool {
        (self.0)(progress)
    }

    fn end(&mut self, _: bool, _: &dyn Fn() -> KeptPaths) {}
}

impl Paths {
    fn of(text: &str, mode: Mode) -> Self {
        let renderer = TestRenderer::of(&SceneSource::Formula(text.into()), mode, Counting::Off);
        let gl = renderer.context.gl();
        let (world, buffers, plan) =
            (renderer.world(), renderer.resources.buffers(), renderer.resources.plan());
        let variant = variant_of(world, buffers, plan, mode, gl.info(), Counting::Off).unwrap();
        let texts = path_texts(gl, &ShaderLibrary::embedded(), &variant).unwrap();
        let program = Program::of(gl, &texts).unwrap();
        Self { program, renderer }
    }

    fn draw(&mut self, order: PathOrder, go_on: &mut dyn FnMut(PathProgress) -> bool) -> PathProgress {
        let frame = self.renderer.frame(0.0, silence(), SIZE);
        let TestRenderer { renderer, resources, .. } = &mut self.renderer;
        renderer.draw_paths(&frame, resources, &self.program, order, &mut Watcher(go_on)).unwrap()
    }

    /// Returns the light of each pixel.
    fn light(&mut self, order: PathOrder) -> Vec<[f32; 3]> {
        self.draw(order, &mut |_| true);
        self.lights()
    }

    fn lights(&self) -> Vec<[f32; 3]> {
        let light = self.renderer.renderer.read_light().unwrap();
        light.as_chunks::<4>().0.iter().map(|[r, g, b, _]| [*r, *g, *b]).collect()
    }

    /// Returns the light of each pixel in the raster.
    fn raster(&mut self) -> Vec<[f32; 3]> {
        self.renderer.picture(0.0, silence(), SIZE);
        self.lights()
    }
}

fn mean(light: &[[f32; 3]]) -> [f32; 3] {
    let sum = light.iter().fold([0.0f64; 3], |sum, light| {
        std::array::from_fn(|channel| sum[channel] + f64::from(light[channel]))
    });
    sum.map(|sum| (sum / light.len() as f64) as f32)
}

/// The pixels in the middle of the image.
fn middle(light: &[[f32; 3]]) -> Vec<[f32; 3]> {
    let rows = light.chunks(SIZE.0 as usize).skip(14).take(4);
    rows.flat_map(|row| row[14..18].to_vec()).collect()
}

const PLAIN: &str = "picture { exposure = 1  bloom = 0  vignette = 0 }";

#[track_caller]
fn assert_near(what: &str, found: [f32; 3], expected: [f32; 3], tolerance: f32) {
    let is_near = found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() <= tolerance);
    assert!(is_near, "{what}: {found:?} instead of {expected:?}");
}

/// A white ball in a white sky, which is invisible if no light is lost or added.
fn furnace(material: &str) -> String {
    format!(
        "object ball {{ shape = sphere(p, 1)  material = white }}
         material white {{ color = 1  {material} }}
         sky {{ color = 1  ambient = 1 }}
         light dark {{ position = vec3(0, 90, 0)  color = 0 }} {PLAIN}
         camera {{ position = vec3(0, 0, -3)  target = vec3(0)  fov = 40 }}"
    )
}

#[test]
fn white_surfaces_in_a_white_sky_are_invisible() {
    for material in [
        "metalness = 1  reflect = 1",
        "reflect = 1  blur = 0.5",
        "glass = 1  ior = 1.5",
        "glass = 1  ior = 1.5  blur = 0.3",
        "roughness = 1",
        "roughness = 0.75",
        "roughness = 0.5",
        "roughness = 0.3",
        "roughness = 0",
    ] {
        let mut paths = Paths::of(&furnace(material), Mode::Compiled);
        assert_near(material, mean(&paths.light(order(64))), [1.0; 3], 0.002);
    }
    // Facets hide each other at grazing angles, so that polished metal is white only from the front.
    let mut metal = Paths::of(&furnace("metalness = 1  roughness = 0.1"), Mode::Compiled);
    assert_near("metal", mean(&middle(&metal.light(order(64)))), [1.0; 3], 0.002);
    let mut half = Paths::of(&furnace("glass = 0.5  ior = 1.5"), Mode::Compiled);
    assert_near("half of glass", mean(&half.light(order(64))), [0.99; 3], 0.02);
    // The raster's ambient light ignores facets.
    assert_near("raster", mean(&metal.raster()), [1.0; 3], 0.02);
}

#[test]
fn the_roughest_metal_loses_what_the_formula_of_its_facets_says() {
    // From the front: the integral of cosine / (1 + cosine) over the hemisphere's cosines.
    let mut paths = Paths::of(&furnace("metalness = 1  roughness = 1"), Mode::Compiled);
    let found = mean(&middle(&paths.light(order(256))));
    assert_near("metal", found, [1.0 - std::f32::consts::LN_2; 3], 0.004);
}

/// A floor seen from above, lit by lights alone.
fn floor(lights: &str) -> String {
    format!(
        "object floor {{ shape = p.y  material = satin }}
         material satin {{ color = vec3(0.6, 0.5, 0.4)  roughness = 0.4  coat = 0.3 }}
         object ball {{ shape = sphere(p - vec3(1.2, 0.5, 0), 0.5)  material = satin }}
         sky {{ color = 0  ambient = 0 }} {lights} {PLAIN}
         camera {{ position = vec3(0, 5, -4)  target = vec3(0)  fov = 40 }}"
    )
}

const LIGHTS: [(&str, &str); 6] = [
    ("lamp", "light a { position = vec3(-1, 2, 0)  color = 12  radius = 0.5 }"),
    ("lamp with a range and half a shadow", "light a { position = vec3(2, 2, 1)  color = 12  radius = 0.5  range = 4  shadow = 0.5 }"),
    ("lamp around everything", "light a { position = vec3(0, 0, 0)  color = 90  radius = 9 }"),
    ("sun", "light a { direction = vec3(1, -2, 0.5)  color = 3  radius = 0.3 }"),
    ("panel", "light a { position = vec3(-0.5, 2, 0)  right = vec3(0.8, 0, 0)  up = vec3(0, 0, 0.6)  color = 4 }"),
    ("several", "light a { position = vec3(-1, 2, 0)  color = 12  radius = 0.5 }
                 light b { direction = vec3(1, -2, 0.5)  color = 1  radius = 0.3 }
                 light c { position = vec3(0.5, 1.5, 0)  right = vec3(0.8, 0, 0)  up = vec3(0, 0.2, 0.6)  color = 4 }"),
];

#[test]
fn rays_towards_lights_and_rays_that_meet_them_give_the_same_light() {
    for (name, lights) in LIGHTS {
        let mut paths = Paths::of(&floor(lights), Mode::Compiled);
        let mut of = |sampling| mean(&paths.light(PathOrder { sampling, ..order(256) }));
        let [both, lights, lobes] =
            [PathSampling::Both, PathSampling::Lights, PathSampling::Lobes].map(&mut of);
        assert_near(name, lights, both, 0.01 * both[0]);
        assert_near(name, lobes, both, 0.025 * both[0]);
    }
}

#[test]
fn small_lights_are_as_bright_as_in_the_raster() {
    for lights in [
        "light a { position = vec3(-1, 3, 0)  color = 12  radius = 0.02 }",
        "light a { direction = vec3(1, -2, 0.5)  color = 1  radius = 0.01 }",
        "light a { position = vec3(-0.5, 3, 0)  right = vec3(0.05, 0, 0)  up = vec3(0, 0, 0.05)  color = 400 }",
    ] {
        let mut paths = Paths::of(&floor(lights).replace("0.5, 0), 0.5)", "-90, 0), 0.5)"), Mode::Compiled);
        let found = mean(&paths.light(order(64)));
        assert_near(lights, found, mean(&paths.raster()), 0.015 * found[0]);
    }
}

/// Everything at once, in motion.
const EVERYTHING: &str = "
object floor { shape = y + 1  material = tiles }
material tiles { color = vec3(0.6, 0.5, 0.4)  reflect = 0.3  blur = 0.4 }
object ball { shape = sphere(p - vec3(1, 0, 0.5), 0.7)  material = satin }
material satin { color = vec3(0.8, 0.3, 0.2)  roughness = 0.4  coat = 1  haze = 0.1 }
object tube { shape = capsule(p, vec3(-1.4, -0.5, 0), vec3(-1, 0.8, 0), 0.2)  material = neon }
material neon { color = 0  emission = vec3(0.2, 1, 3) }
medium smoke { density = 0.3 * noise(3 * p)  phase = 0.3  color = vec3(0.9, 0.8, 0.7)  shape = sphere(p, 2) }
light lamp { position = vec3(-3, 4, -3)  color = vec3(60, 50, 40)  radius = 0.3 }
light panel { position = vec3(0, 2, 0)  right = vec3(0.5, 0, 0)  up = vec3(0, 0, 0.5)  color = 3 }
sky { color = vec3(0.1, 0.2, 0.4)  ambient = vec3(0.1, 0.2, 0.4) }
camera { position = vec3(0, 1, -5)  target = vec3(0)  aperture = 0.05 }
picture { exposure = 1  bloom = 0  vignette = 0 }
";

#[test]
fn both_modes_draw_the_same_light_and_each_command_the_same_bytes() {
    let [compiled, interpreted] = [Mode::Compiled, Mode::Interpreted].map(|mode| {
        let mut paths = Paths::of(EVERYTHING, mode);
        let light = paths.light(order(32));
        assert_eq!(light, paths.light(order(32)), "{mode}");
        let other = paths.light(PathOrder { first: 32, ..order(32) });
        assert_ne!(light, other, "{mode}: other numbers are the same paths");
        light
    });
    let [compiled, interpreted] = [mean(&compiled), mean(&interpreted)];
    assert_near("both modes", interpreted, compiled, 0.02 * compiled[0]);
}

#[test]
fn paths_end_where_the_noise_is_low() {
    let mut paths = Paths::of(EVERYTHING, Mode::Compiled);
    let all = paths.draw(order(256), &mut |_| true).paths;
    assert_eq!(all, 256 * 32 * 32);
    let exact = paths.lights();
    let fewer = paths.draw(PathOrder { noise: 0.05, ..order(256) }, &mut |_| true).paths;
    assert!(fewer * 3 < 2 * all && fewer >= 16 * 32 * 32, "{fewer} of {all}");
    let (expected, found) = (mean(&exact), mean(&paths.lights()));
    assert_near("the mean", found, expected, 0.02 * expected[0]);
}

#[test]
fn an_interrupted_image_has_whole_paths() {
    let mut paths = Paths::of(&furnace("reflect = 1  blur = 0.5"), Mode::Compiled);
    let mut calls = 0;
    let done = paths.draw(order(60_000), &mut |_| {
        calls += 1;
        calls < 2
    });
    assert!(done.paths < 200 * 32 * 32, "{}", done.paths);
    assert_near("interrupted", mean(&paths.lights()), [1.0; 3], 0.002);
}

/// The sum of squared differences of red light.
fn difference(a: &[[f32; 3]], b: &[[f32; 3]]) -> f64 {
    let error = |(a, b): (&[f32; 3], &[f32; 3])| f64::from((a[0] - b[0]).powi(2)).min(1.0);
    a.iter().zip(b).map(error).sum()
}

/// Returns the image with `many` paths, and with `samples` without and with the filter.
fn filtered(text: &str, many: u32, samples: u32) -> [Vec<[f32; 3]>; 3] {
    let mut paths = Paths::of(text, Mode::Compiled);
    [(many, false), (samples, false), (samples, true)]
        .map(|(samples, is_filtered)| paths.light(PathOrder { is_filtered, ..order(samples) }))
}

#[test]
fn the_filter_removes_noise_but_no_light() {
    let [exact, noisy, smooth] = filtered(EVERYTHING, 1024, 8);
    let [before, after] = [&noisy, &smooth].map(|light| difference(light, &exact));
    assert!(after < 0.75 * before, "{after} {before}");
    assert_near("the mean", mean(&smooth), mean(&noisy), 0.05 * mean(&noisy)[0]);
}

#[test]
fn the_filter_draws_no_halos_around_dark_things_that_shine() {
    let balls = "shape = sphere(p - vec3(round(p.x), 0, 0), 0.3)  material = lamp";
    for shining in [
        format!("object balls {{ {balls} }} material lamp {{ color = 0  emission = vec3(1, 0.2, 0.1) }}"),
        "swarm balls { count = 9  position = vec3(index - 4, 0, 0)  size = 0.3  color = 0  emission = vec3(1, 0.2, 0.1) }".into(),
    ] {
        let [exact, noisy, smooth] = filtered(&in_front_of_a_camera(&shining), 512, 64);
        let [before, after] = [&noisy, &smooth].map(|light| difference(light, &exact));
        assert!(after < 0.75 * before, "{shining}: {after} {before}");
    }
}

#[test]
fn the_filter_smooths_fog_before_the_sky() {
    let fog = "medium fog { density = 0.05 } camera { position = vec3(0)  target = vec3(0, 1, 1) }";
    let [exact, noisy, smooth] = filtered(&format!("{fog} {PLAIN}"), 512, 8);
    let [before, after] = [&noisy, &smooth].map(|light| difference(light, &exact));
    assert!(after < 0.75 * before, "{after} {before}");
}

#[test]
fn the_filter_keeps_mirror_images() {
    for mirror in
        ["color = 0  reflect = 1  roughness = 0", "color = 0.3  reflect = 0.4", "glass = 1  ior = 1.1"]
    {
        let balls = "shape = sphere(p - vec3(round(p.x), 0.3, 0), 0.3)  material = orange";
        let text = format!(
            "object balls {{ {balls} }} material orange {{ color = vec3(1, 0.4, 0.1) }}
             object mirror {{ shape = box(p - vec3(0, 1, 2), vec3(5, 3, 0.1))  material = mirror }}
             material mirror {{ {mirror} }}"
        );
        let [exact, _, smooth] = filtered(&in_front_of_a_camera(&text), 512, 64);
        let error = difference(&smooth, &exact);
        assert!(error < 0.06, "{mirror}: {error}");
    }
}

#[test]
fn the_filter_leaves_no_dots_on_edges_and_no_bright_specks() {
    // A room with columns. Only the light of the sunny spot on the floor reaches most of it.
    let text = "object room {
            let window = box(p - vec3(3, 0.5, 0), vec3(1, 0.7, 2))
            shape = max(box(p, vec3(3.2, 2.2, 6.2)), -box(p, vec3(3, 2, 6)), -window)
        }
        object columns { shape = length(vec2(p.x - round(p.x), abs(p.z) - 1)) - 0.15 }
        light sun { direction = vec3(1, 0.8, 0)  color = 40 }
        sky { color = 0  ambient = 0 }
        camera { position = vec3(-1.5, 0.5, -5.5)  target = vec3(0)  fov = 60 }";
    let [_, noisy, smooth] = filtered(&format!("{text} {PLAIN}"), 1, 16);
    let [before, after] = [&noisy, &smooth].map(|light| dots(light));
    assert!(before > 20 && after < 6, "{before} {after}");
}

/// The number of pixels that are much darker or much brighter than all their neighbours.
fn dots(light: &[[f32; 3]]) -> usize {
    let width = SIZE.0 as usize;
    let rows: Vec<Vec<f32>> =
        light.chunks(width).map(|row| row.iter().map(|light| light.iter().sum()).collect()).collect();
    let is_dot = |rows: &[Vec<f32>], at: usize| {
        let own = rows[1][at];
        let around = (0..9).filter(|i| *i != 4).map(|i| rows[i / 3][at + i % 3 - 1]);
        let (least, most) =
            around.fold((f32::MAX, 0.0_f32), |(least, most), one| (least.min(one), most.max(one)));
        own < 0.5 * least || own > 2.0 * most
    };
    rows.windows(3).map(|rows| (1..width - 1).filter(|at| is_dot(rows, *at)).count()).sum()
}

/// A scene on a floor, in the light of a lamp.
fn in_front_of_a_camera(things: &str) -> String {
    format!(
        "object floor {{ shape = p.y + 1 }} {things}
         light lamp {{ position = vec3(-3, 5, -4)  color = 60  radius = 0.3 }} {PLAIN}
         camera {{ position = vec3(0, 1.5, -7)  target = vec3(0)  fov = 40 }}"
    )
}

/// A sky of light 1 that is seen through a layer with a thickness of 4.
fn layer(medium: &str, ambient: &str) -> String {
    format!(
        "medium fog {{ {medium}  shape = abs(z) - 2 }}
         sky {{ color = 1  ambient = {ambient} }} {PLAIN}
         light dark {{ position = vec3(0, 90, 0)  color = 0 }}
         camera {{ position = vec3(0, 0, -6)  target = vec3(0)  fov = 2 }}"
    )
}

#[test]
fn light_in_media_follows_known_laws() {
    let absorbed = (-4.0f32 * 0.3).exp();
    for (medium, ambient, expected) in [
        ("density = 0.3  scatter = 0", "0", [absorbed; 3]),
        ("density = 0  emission = vec3(0.1, 0.2, 0.3)", "0", [1.4, 1.8, 2.2]),
        // All orders of scattering.
        ("density = 0.7", "1", [1.0; 3]),
        ("density = 0.7  phase = 0.8", "1", [1.0; 3]),
    ] {
        for mode in [Mode::Compiled, Mode::Interpreted] {
            let found = mean(&Paths::of(&layer(medium, ambient), mode).light(order(64)));
            assert_near(medium, found, expected, 0.01);
        }
    }
}

#[test]
fn endless_fog_is_about_as_bright_as_in_the_window() {
    for density in [0.05, 0.5] {
        let fog = format!(" medium fog {{ density = {density} }}");
        for mode in [Mode::Compiled, Mode::Interpreted] {
            let found = mean(&Paths::of(&(furnace("roughness = 1") + &fog), mode).light(order(64)));
            assert_near("a white sky", found, [1.0; 3], 0.01);
        }
        let scene = format!(
            "object floor {{ shape = p.y + 1 }} object ball {{ shape = sphere(p, 1) }}
             light sun {{ direction = vec3(1, -1, 1)  color = 2 }}
             sky {{ color = vec3(0.2, 0.3, 0.6)  ambient = vec3(0.1, 0.2, 0.5) }} {PLAIN}
             camera {{ position = vec3(2, 1.5, -7)  target = vec3(0) }} {fog}"
        );
        let mut paths = Paths::of(&scene, Mode::Compiled);
        let expected = mean(&paths.raster());
        assert_near(&fog, mean(&paths.light(order(64))), expected, 0.3 * expected[0]);
    }
}

#[test]
fn light_scattered_once_follows_the_phase_function() {
    let sun = "light sun { direction = vec3(0, 0, -1)  color = vec3(90, 0, 0) }";
    let text = layer("density = 0.004  phase = 0.5", "0") + sun;
    let phase = 0.75 / (4.0 * std::f32::consts::PI * 0.25f32.powf(1.5));
    let found = mean(&Paths::of(&text, Mode::Compiled).light(order(64)));
    let left = (-0.016f32).exp();
    let scattered = 90.0 * 0.004 * 4.0 * phase;
    assert_near("red", found, [left + scattered, left, left], 0.03 * scattered);
}

#[test]
fn glass_absorbs_light_along_the_way_through_it() {
    let text = furnace("glass = 1  ior = 1.0001  absorb = vec3(0.3, 0.6, 0)")
        .replace("sphere(p, 1)", "box(p, vec3(9, 9, 1))");
    let found = mean(&middle(&Paths::of(&text, Mode::Compiled).light(order(64))));
    assert_near("glass", found, [(-0.6f32).exp(), (-1.2f32).exp(), 1.0], 0.01);
}

#[test]
fn an_opaque_thing_in_solid_glass_is_seen_through_the_glass() {
    let text = furnace("glass = 1  ior = 1.0001  absorb = vec3(0.3, 0.6, 0)")
        .replace("object ball", "object core { shape = 0.5 - z  material = core } material core { color = 0  emission = 0.8 } object ball")
        .replace("sphere(p, 1)", "box(p, vec3(9, 9, 1))");
    // A plane, and the same surface as a shape.
    for core in ["0.5 - z", "box(p - vec3(0, 0, 2), vec3(9, 9, 1.5))"] {
        let text = text.replace("0.5 - z", core);
        for mode in [Mode::Compiled, Mode::Interpreted] {
            let found = mean(&middle(&Paths::of(&text, mode).light(order(64))));
            let left = [0.3f32, 0.6, 0.0].map(|absorb| 0.8 * (-1.5 * absorb).exp());
            assert_near(&format!("{core}, {mode}"), found, left, 0.05);
        }
    }
}

#[test]
fn glass_casts_no_shadow() {
    let lamp = "light a { position = vec3(0, 6, 6)  color = 40  radius = 1.5 }";
    let glass = "object shade { shape = sphere(p - vec3(0, 6, 6), 2)  material = clear }
                 material clear { glass = 0.9  roughness = 1 }";
    // Rays find most of the light in the highlight of metal by chance, but not through glass.
    for material in ["roughness = 0.4", "roughness = 0.3  metalness = 1"] {
        let bare = floor(lamp).replace("roughness = 0.4", material);
        let of = |text: &str, mode| mean(&Paths::of(text, mode).light(order(128)));
        let expected = of(&bare, Mode::Compiled);
        for mode in [Mode::Compiled, Mode::Interpreted] {
            let found = of(&format!("{bare} {glass}"), mode);
            assert_near(&format!("{material}, {mode}"), found, expected, 0.02 * expected[0]);
        }
    }
}

#[test]
fn a_lens_blurs_what_is_out_of_focus() {
    let sharpness = |focus: &str| {
        let text = format!(
            "object wall {{ shape = 5 - z  material = stripes }}
             material stripes {{ color = 0  roughness = 1  emission = vec3(step(0.5, fract(x))) }}
             sky {{ color = 0  ambient = 0 }} {PLAIN} light dark {{ position = vec3(0, 90, 0)  color = 0 }}
             camera {{ position = vec3(0)  target = vec3(0, 0, 1)  fov = 60  aperture = 0.3  focus = {focus} }}"
        );
        let light = Paths::of(&text, Mode::Compiled).light(order(64));
        light.windows(2).map(|two| (two[0][0] - two[1][0]).abs()).sum::<f32>()
    };
    let (sharp, blurred) = (sharpness("5"), sharpness("1"));
    assert!(blurred < 0.3 * sharp && sharp > 100.0, "{blurred} {sharp}");
}

#[test]
fn invalid_values_give_finite_light() {
    for text in [
        "object a { shape = sphere(p, 0) } light l { position = vec3(0, 0, 0)  color = 1000 }",
        "object a { shape = sphere(p, 9)  material = m } material m { roughness = -5  metalness = 70  reflect = 9  blur = 100  coat = -3  color = vec3(-1, 1e30, 7)  glass = 3  ior = 0 }",
        "object a { shape = p.y } light l { position = vec3(0, 0, 0)  right = vec3(0)  up = vec3(0)  color = 1 }
         light m { position = vec3(0, 1, 2)  right = vec3(1e30, 0, 0)  up = vec3(0, 0, 1e30)  color = 1e30 }",
        "object a { shape = p.y } light l { direction = vec3(0)  color = 9 } medium m { density = 1 / (y - y)  emission = vec3(1e38) }",
        "object a { shape = log(p.x) * 0 + (exp(999) - exp(999)) } camera { position = vec3(1e30)  fov = 9000  roll = 1e30  aperture = 1e30 }",
    ] {
        let light = Paths::of(text, Mode::Compiled).light(PathOrder { is_filtered: true, ..order(4) });
        assert!(light.as_flattened().iter().all(|value| value.is_finite()), "{text}");
    }
}

#[test]
fn paths_meet_swarms_as_the_raster_does() {
    let text = format!(
        "swarm sparks {{ let h = hash_3(vec3(index, 3, 1))  count = 300  position = vec3(2, 2, 1) * (h - 0.5)
                         size = 0.004 + 0.1 * step(0.9, h.x)  color = 0  emission = vec3(1, 0.5, 0.2)
                         glow = vec3(0, 0.1, 0.3)  reach = 0.2 }}
         sky {{ color = 0.1  ambient = 0 }}
         light dark {{ position = vec3(0, 90, 0)  color = 0 }} {PLAIN}
         camera {{ position = vec3(0, 0, -4)  target = vec3(0)  fov = 40 }}"
    );
    for mode in [Mode::Compiled, Mode::Interpreted] {
        let mut paths = Paths::of(&text, mode);
        let (raster, found) = (mean(&paths.raster()), mean(&paths.light(order(64))));
        assert!(raster[0] > 0.15, "{mode}: the raster shows few sparks: {raster:?}");
        assert_near("sparks", found, raster, 0.03 * raster[0]);
    }
}
