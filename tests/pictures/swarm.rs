//! Swarms: known cases of their light, both modes, mirrors, walls, fog, tiny points, invalid values.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use crate::support::compare::{LOOSE, assert_alike};
use crate::support::test_renderer::{TestRenderer, silence};
use mariana::gpu::edge_samples::EdgeSamples;
use mariana::gpu::renderer::Counting;
use mariana::gpu::scene_program::Mode;
use mariana::scenes::SceneSource;

const SIZE: (u32, u32) = (64, 48);
const MODES: [Mode; 2] = [Mode::Compiled, Mode::Interpreted];

fn renderer(text: &str, mode: Mode) -> TestRenderer {
    let mut renderer = TestRenderer::of(&SceneSource::Formula(text.into()), mode, Counting::Off);
    renderer.renderer.set_edge_samples(EdgeSamples::Sixteen);
    renderer
}

fn light(text: &str, mode: Mode, size: (u32, u32)) -> Vec<[f32; 4]> {
    let mut renderer = renderer(text, mode);
    renderer.picture(0.0, silence(), size);
    renderer.renderer.read_light().unwrap().as_chunks().0.to_vec()
}

fn in_the_middle(text: &str, mode: Mode) -> [f32; 3] {
    let [r, g, b, _] = light(text, mode, SIZE)[(SIZE.1 / 2 * SIZE.0 + SIZE.0 / 2) as usize];
    [r, g, b]
}

#[track_caller]
fn assert_light(text: &str, expected: [f32; 3], tolerance: f32) {
    for mode in MODES {
        let found = in_the_middle(text, mode);
        let is_near = found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= tolerance);
        assert!(is_near, "{mode}: {found:?} instead of {expected:?}");
    }
}

/// A scene without any other light, seen from (0, 0, -6) towards +z.
fn dark(parts: &str) -> String {
    format!(
        "{parts}
         sky {{ color = 0  ambient = 0 }}
         picture {{ exposure = 1  bloom = 0  vignette = 0 }}
         light dark {{ position = vec3(0, 90, 0)  color = 0 }}
         camera {{ position = vec3(0, 0, -6)  target = vec3(0)  fov = 20 }}"
    )
}

const SPARKS: &str = "
object floor { shape = y + 1  material = tiles }
material tiles { color = vec3(0.5)  reflect = 0.5 }
object ball { shape = sphere(p - vec3(1, 0, 0.5), 0.7)  material = tiles }
swarm sparks { let h = hash_3(vec3(index, 3, 1))  count = 400  position = vec3(4, 2, 4) * (h - 0.5)
               size = 0.02 + 0.05 * h.x  color = h  emission = step(0.8, h.y) * vec3(2, 1, 0)
               glow = step(h.z, 0.3) * vec3(0, 0.3, 1)  reach = 0.3  stretch = step(0.9, h.x) * vec3(0.4, 0.2, 0) }
light lamp { position = vec3(-3, 4, -3)  color = vec3(60, 50, 40) }
camera { position = vec3(0, 1, -5)  target = vec3(0, 0, 0) }
";

#[test]
fn both_modes_draw_the_same_swarm() {
    let [compiled, interpreted] =
        MODES.map(|mode| renderer(SPARKS, mode).picture(1.0, silence(), (320, 180)));
    assert_alike("sparks", &compiled, &interpreted, LOOSE);
    let without = SPARKS.replace("count = 400", "count = 1");
    let without = renderer(&without, Mode::Compiled).picture(1.0, silence(), (320, 180));
    let changed = without.pixels().zip(compiled.pixels()).filter(|(a, b)| a != b).count();
    assert!(changed > 9000, "only {changed} pixels show sparks, their glow or their reflection");
}

#[test]
fn a_ball_hides_the_glow_behind_it() {
    let glow = "swarm a { count = 1  position = vec3(0, 0, 5)  size = 0  glow = vec3(3, 2, 1)  reach = 4 }";
    assert_light(&dark(glow), [3.0, 2.0, 1.0], 0.03);
    let ball = format!("{glow}\nswarm b {{ count = 1  size = 0.5  emission = vec3(0.25, 0.5, 1) }}");
    assert_light(&dark(&ball), [0.25, 0.5, 1.0], 0.005);
}

#[test]
fn a_wall_hides_what_is_behind_it() {
    let point = |z: f32| {
        dark(&format!(
            "object wall {{ shape = box(p, vec3(5, 5, 0.1)) }}
             swarm a {{ count = 1  position = vec3(0, 0, {z})  size = 0.2  emission = 1  glow = 1  reach = 0.5 }}"
        ))
    };
    assert_light(&point(2.0), [0.0; 3], 0.0);
    let found = in_the_middle(&point(-2.0), Mode::Compiled);
    assert!(found[0] > 0.9, "{found:?}");
}

#[test]
fn balls_are_lit_and_shadowed_by_the_scene() {
    let lit = |wall: &str| {
        dark(&format!(
            "{wall} light sun {{ direction = vec3(0, 0, 1)  color = 2 }}
             swarm a {{ count = 1  size = 0.5  color = vec3(1, 0.5, 0) }}"
        ))
    };
    let bright = in_the_middle(&lit(""), Mode::Compiled);
    assert!(bright[0] > 0.3 && (bright[0] - 2.0 * bright[1]).abs() < 0.2 * bright[0], "{bright:?}");
    assert_light(&lit("object wall { shape = box(p + vec3(0, 0, 9), vec3(5, 5, 0.1)) }"), [0.0; 3], 0.001);
}

#[test]
fn a_mirror_shows_points_that_the_eye_does_not_see() {
    let mirrored = dark(
        "object mirror { shape = 3 - z  material = silver }
         material silver { color = 1  metalness = 1  reflect = 1  roughness = 0 }
         swarm a { count = 1  position = vec3(0, 0, -9)  size = 0.5  emission = vec3(0, 1, 0.5) }",
    );
    assert_light(&mirrored, [0.0, 1.0, 0.5], 0.01);
}

#[test]
fn the_light_of_a_tiny_point_does_not_depend_on_the_resolution() {
    // The half angle of the picture is 10 degrees, and the point is 6 away.
    let height = 2.0 * 6.0 * 10.0f32.to_radians().tan();
    for (point, light_of_radius) in [
        ("size = RADIUS  emission = 9", 9.0 * std::f32::consts::PI),
        ("size = 0  glow = 9  reach = RADIUS", 0.0),
    ] {
        let mut sums = Vec::new();
        for (radius, heights) in [(0.004, [24, 48, 96]), (0.004, [30, 60, 120])] {
            for (number, rows) in heights.into_iter().enumerate() {
                let point = point.replace("RADIUS", &radius.to_string());
                let place = format!("vec3({}, {}, 0)", 0.013 * number as f32, -0.021 * number as f32);
                let text = dark(&format!("swarm a {{ count = 1  position = {place}  {point} }}"));
                let pixels = light(&text, Mode::Compiled, (rows * 4 / 3, rows));
                let pixel = (height / rows as f32).powi(2);
                sums.push(pixels.iter().map(|light| light[0]).sum::<f32>() * pixel / (radius * radius));
            }
        }
        let mean = sums.iter().sum::<f32>() / sums.len() as f32;
        assert!(mean > 1.0 && sums.iter().all(|sum| (sum / mean - 1.0).abs() < 0.2), "{point}: {sums:?}");
        if light_of_radius > 0.0 {
            assert!((mean / light_of_radius - 1.0).abs() < 0.1, "{mean} instead of {light_of_radius}");
        }
    }
}

#[test]
fn fog_dims_points_by_the_way_before_them() {
    let fog = |z: f32| {
        dark(&format!(
            "medium fog {{ density = 0.2  scatter = 0 }}
             object wall {{ shape = box(p - vec3(0, 0, 14), vec3(9, 9, 1)) }}
             swarm a {{ count = 1  position = vec3(0, 0, {z})  size = 0  glow = 4  reach = 2 }}"
        ))
    };
    for z in [-3.0, 2.0, 6.0f32] {
        assert_light(&fog(z), [4.0 * (-0.2 * (z + 6.0)).exp(); 3], 0.06);
    }
}

#[test]
fn invalid_points_leave_the_picture_as_it_is() {
    let valid = SPARKS.replace("count = 400", "count = 9");
    for invalid in
        ["position = vec3(exp(99 + index))", "size = 1e30 * (1 + index)", "glow = vec3(exp(99 + index))"]
    {
        let text = format!("{valid}\nswarm invalid {{ count = 50  {invalid} }}");
        for mode in MODES {
            let [with, without] =
                [&text, &valid].map(|text| renderer(text, mode).picture(0.0, silence(), SIZE));
            assert!(with == without, "{invalid}, {mode}");
        }
    }
}

#[test]
fn a_crowd_at_one_place_leaves_a_valid_picture() {
    let text = "swarm a { count = 65536  size = 0.001 * index  glow = vec3(0.001)  reach = 9 }
                object wall { shape = box(p - vec3(0, 0, 14), vec3(9, 9, 1)) }";
    for mode in MODES {
        let light = light(&dark(text), mode, (16, 12));
        assert!(light.iter().flatten().all(|part| part.is_finite()), "{mode}");
    }
}

#[test]
fn streaks_before_a_rough_mirror_are_not_taken_for_its_noise() {
    let wet = "object floor { shape = y + 1  material = wet }
        material wet { color = 0.1  reflect = 0.3  blur = 0.3 }
        swarm rain { let h = hash_3(vec3(index, 1, 2))  count = 400  position = vec3(4, 2, 4) * (h - vec3(0.5, 0.4, 0.5))
                     stretch = vec3(0, -0.3, 0)  size = 0.001  emission = 0.6 }
        sky { color = 0.05  ambient = 0.05 }
        picture { exposure = 1  bloom = 0  vignette = 0 }
        light dark { position = vec3(0, 90, 0)  color = 0 }
        camera { position = vec3(0, 1.5, -5)  target = vec3(0, -1, 0)  fov = 30 }";
    let mut renderer = renderer(wet, Mode::Compiled);
    renderer.picture(0.0, silence(), (320, 180));
    let part = renderer.renderer.edge_pixels() / (320.0 * 180.0);
    // The edges of the streaks alone are 0.30.
    assert!(part < 0.33, "{part} of the pixels get more samples");
}
