//! Fog, smoke and clouds: known cases of light in media, both modes, mirrors, empty space, invalid values.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use crate::support::compare::{LOOSE, assert_alike};
use crate::support::test_renderer::{TestRenderer, silence};
use mariana::gpu::edge_samples::EdgeSamples;
use mariana::gpu::renderer::Counting;
use mariana::gpu::scene_program::Mode;
use mariana::scenes::SceneSource;

const SIZE: (u32, u32) = (64, 48);

pub(crate) fn renderer(text: &str, mode: Mode, counting: Counting) -> TestRenderer {
    let mut renderer = TestRenderer::of(&SceneSource::Formula(text.into()), mode, counting);
    renderer.renderer.set_edge_samples(EdgeSamples::Sixteen);
    renderer
}

/// Returns the light of the pixel in the middle, without the exposure's effect on other pixels.
pub(crate) fn light_in_the_middle(text: &str, mode: Mode) -> [f32; 3] {
    let mut renderer = renderer(text, mode, Counting::Off);
    renderer.picture(0.0, silence(), SIZE);
    let light = renderer.renderer.read_light().unwrap();
    let pixel = (SIZE.1 / 2 * SIZE.0 + SIZE.0 / 2) as usize;
    light[4 * pixel..][..3].try_into().unwrap()
}

/// A sky of light 1 that is seen through a layer with a thickness of 4, and no light besides it.
fn layer(medium: &str, lights: &str) -> String {
    format!(
        "medium fog {{ {medium}  shape = abs(z) - 2 }}
         sky {{ color = 1  ambient = 0 }}
         picture {{ exposure = 1  bloom = 0  vignette = 0 }}
         light dark {{ position = vec3(0, 90, 0)  color = 0 }} {lights}
         camera {{ position = vec3(0, 0, -6)  target = vec3(0)  fov = 2 }}"
    )
}

#[track_caller]
pub(crate) fn assert_light(text: &str, expected: [f32; 3], tolerance: f32) {
    for mode in [Mode::Compiled, Mode::Interpreted] {
        let found = light_in_the_middle(text, mode);
        let is_near =
            found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() <= tolerance);
        assert!(is_near, "{mode}: {found:?} instead of {expected:?}");
    }
}

#[test]
fn absorbed_light_falls_exponentially() {
    let left = (-4.0f32 * 0.3).exp();
    assert_light(&layer("density = 0.3  scatter = 0", ""), [left; 3], 0.002);
}

#[test]
fn the_densest_fog_keeps_its_color() {
    for density in ["1e4", "1e7", "1e12"] {
        let fog = format!("density = {density}  color = vec3(0.8, 0.4, 0.2)");
        let text = layer(&fog, "").replace("ambient = 0", "ambient = 1");
        assert_light(&text, [0.8, 0.4, 0.2], 0.01);
    }
}

#[test]
fn emitted_light_grows_with_the_length_of_the_way() {
    assert_light(&layer("density = 0  emission = vec3(0.1, 0.2, 0.3)", ""), [1.4, 1.8, 2.2], 0.004);
}

#[test]
fn white_fog_in_ambient_light_is_as_bright_as_that_light() {
    let text = layer("density = 0.7", "").replace("ambient = 0", "ambient = 1");
    assert_light(&text, [1.0; 3], 0.004);
}

#[test]
fn scattered_sunlight_follows_the_phase_function() {
    // Thin fog: light that is scattered once, from a sun at the side, where the fog's own shadow is 1 - e^-x of a long way.
    let phase = |g: f32, cosine: f32| {
        (1.0 - g * g) / (4.0 * std::f32::consts::PI * (1.0 + g * g - 2.0 * g * cosine).powf(1.5))
    };
    for (direction, cosine) in [("vec3(0, 0, 1)", -1.0f32), ("vec3(0, 0, -1)", 1.0)] {
        // `direction` is the direction of the light's rays. A ray of the eye runs along +z, and the cosine is that of
        // the angle between this ray and the way to the light.
        let sun = format!("light sun {{ direction = {direction}  color = vec3(90, 0, 0) }}");
        let text = layer("density = 0.004  phase = 0.5", &sun);
        let scattered = 90.0 * 0.004 * 4.0 * phase(0.5, cosine);
        let left = (-0.016f32).exp();
        assert_light(&text, [left + scattered, left, left], 0.03 * scattered + 0.002);
    }
}

const PUFFS: &str = "
object floor { shape = y + 1  material = tiles }
material tiles { color = vec3(0.6)  reflect = 0.4 }
object ball { shape = sphere(p - vec3(1, 0, 0.5), 0.7)  material = tiles }
medium smoke { density = 3 * (0.3 + noise(3 * p + vec3(t, 0, 0)))  phase = 0.3  color = vec3(0.9, 0.8, 0.7)
               shape = min(sphere(p - vec3(-1, 0, 0), 0.6), sphere(p - vec3(6, 1, 7), 0.8)) }
light lamp { position = vec3(-3, 4, -3)  color = vec3(60, 50, 40) }
camera { position = vec3(0, 1, -5)  target = vec3(0, 0, 0) }
";

#[test]
fn both_modes_draw_the_same_media() {
    let [compiled, interpreted] = [Mode::Compiled, Mode::Interpreted]
        .map(|mode| renderer(PUFFS, mode, Counting::Off).picture(1.0, silence(), (320, 180)));
    assert_alike("puffs of smoke", &compiled, &interpreted, LOOSE);
    let clear = PUFFS.replace("density = 3", "density = 0");
    let clear = renderer(&clear, Mode::Compiled, Counting::Off).picture(1.0, silence(), (320, 180));
    let changed = clear.pixels().zip(compiled.pixels()).filter(|(a, b)| a != b).count();
    assert!(changed > 3000, "only {changed} pixels show smoke or its reflection");
}

#[test]
fn empty_space_is_skipped() {
    let mut renderer = renderer(&PUFFS.replace("reflect", "coat"), Mode::Compiled, Counting::On);
    renderer.picture(1.0, silence(), (160, 90));
    let counts = renderer.renderer.evaluations(1.0);
    // Without the grid, every ray would take all of its steps through the box around both puffs.
    let rays = f64::from(80 * 45);
    let all = 24.0 * rays;
    assert!(counts.media_steps > 0.0 && 3.0 * counts.media_steps < all, "{} of {all}", counts.media_steps);
}

#[test]
fn a_mirror_shows_fog_that_the_eye_does_not_see() {
    // The eye is behind the fog and looks away from it, into a mirror.
    let mirrored = |density: &str| {
        format!(
            "object mirror {{ shape = 3 - z  material = silver }}
             material silver {{ color = 1  metalness = 1  reflect = 1  roughness = 0 }}
             medium fog {{ density = {density}  scatter = 0  shape = abs(z + 8) - 2 }}
             sky {{ color = 1  ambient = 0 }}
             picture {{ exposure = 1  bloom = 0  vignette = 0 }}
             light dark {{ position = vec3(0, 90, 0)  color = 0 }}
             camera {{ position = vec3(0, 0, -1)  target = vec3(0, 0, 3)  fov = 2 }}"
        )
    };
    assert_light(&mirrored("0"), [1.0; 3], 0.01);
    assert_light(&mirrored("0.3"), [(-1.2f32).exp(); 3], 0.01);
}

#[test]
fn invalid_media_leave_a_valid_picture() {
    for medium in [
        "density = 1 / (y - y)",
        "density = -5",
        "density = sqrt(-1 - y * y)",
        "density = 1e30  emission = vec3(1e30)",
        "density = exp(99 + t)  scatter = 9  color = vec3(-3, 9, log(-1))",
        "density = 0.2  phase = 1e9",
        "density = 0.2  phase = 1 / (y - y)  emission = vec3(-1)",
        "density = 0.2  shape = log(-2 - y * y)",
    ] {
        let text = PUFFS.replace("medium smoke", &format!("medium invalid {{ {medium} }}\nmedium smoke"));
        for mode in [Mode::Compiled, Mode::Interpreted] {
            let mut renderer = renderer(&text, mode, Counting::Off);
            renderer.picture(0.0, silence(), (48, 27));
            let light = renderer.renderer.read_light().unwrap();
            assert!(light.iter().all(|value| value.is_finite()), "{medium}, {mode}");
        }
    }
}
