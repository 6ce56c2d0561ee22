//! Paths of light: known cases, both ways to find lights, both modes, media, the lens, reproducible bytes.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use crate::support::test_renderer::{TestRenderer, silence};
use mariana::gpu::program::Program;
use mariana::gpu::renderer::{Counting, PathOrder, PathProgress, PathSampling};
use mariana::gpu::scene_program::{Mode, link_paths, variant_of};
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

impl Paths {
    fn of(text: &str, mode: Mode) -> Self {
        let renderer = TestRenderer::of(&SceneSource::Formula(text.into()), mode, Counting::Off);
        let gl = renderer.context.gl();
        let (world, buffers, plan) =
            (renderer.world(), renderer.resources.buffers(), renderer.resources.plan());
        let variant = variant_of(world, buffers, plan, mode, gl.info(), Counting::Off).unwrap();
        let program = link_paths(gl, &ShaderLibrary::embedded(), &variant).unwrap();
        Self { program, renderer }
    }

    fn draw(&mut self, order: PathOrder, go_on: &mut dyn FnMut(PathProgress) -> bool) -> PathProgress {
        let frame = self.renderer.frame(0.0, silence(), SIZE);
        let TestRenderer { renderer, resources, .. } = &mut self.renderer;
        renderer.draw_paths(&frame, (resources, &self.program), order, go_on).unwrap()
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
#[allow(dead_code)]
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
fn a_white_mirror_in_a_white_sky_is_invisible() {
    for material in
        ["metalness = 1  reflect = 1", "metalness = 1  roughness = 0.1", "reflect = 1  blur = 0.5"]
    {
        let mut paths = Paths::of(&furnace(material), Mode::Compiled);
        let light = paths.light(order(64));
        eprintln!(
            "{material}: {:?} {:?} raster {:?}",
            mean(&light),
            mean(&middle(&light)),
            mean(&paths.raster())
        );
    }
    for material in [
        "roughness = 1",
        "roughness = 0.5",
        "roughness = 0",
        "metalness = 1 roughness = 1",
        "metalness = 1",
        "coat = 1",
    ] {
        let mut paths = Paths::of(&furnace(material), Mode::Compiled);
        let light = paths.light(order(256));
        eprintln!(
            "{material}: {:?} {:?} raster {:?}",
            mean(&light),
            mean(&middle(&light)),
            mean(&middle(&paths.raster()))
        );
    }
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
        eprintln!("{name}: {both:?} {lights:?} {lobes:?} {:?}", mean(&paths.raster()));
    }
}

#[test]
fn small_lights_are_as_bright_as_in_the_raster() {
    for (name, lights) in [
        ("lamp", "light a { position = vec3(-1, 3, 0)  color = 12  radius = 0.02 }"),
        ("sun", "light a { direction = vec3(1, -2, 0.5)  color = 1  radius = 0.01 }"),
        (
            "panel",
            "light a { position = vec3(-0.5, 3, 0)  right = vec3(0.05, 0, 0)  up = vec3(0, 0, 0.05)  color = 400 }",
        ),
    ] {
        let text =
            floor(lights).replace("object ball", "object none").replace("0.5, 0), 0.5)", "-90, 0), 0.5)");
        let mut paths = Paths::of(&text, Mode::Compiled);
        let light = mean(&paths.light(order(64)));
        eprintln!("{name}: {light:?} raster {:?}", mean(&paths.raster()));
    }
}
