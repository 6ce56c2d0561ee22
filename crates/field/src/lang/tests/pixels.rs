//! Scenes that draw in two dimensions: the pixel, the picture's size and the pointer in the sky's formula.

use super::super::{Diagnostic, Scene, compile};
use super::scene;
use crate::glsl_import::{Shown, scene_around};
use crate::graph::{FrameInputs, Point, Screen};
use crate::world::World;

pub(super) const SCREEN: Screen = Screen { size: [200.0, 100.0], pointer: [0.25, 0.75], pressed: true };

pub(super) fn color_on(scene: &Scene, [x, y]: [f32; 2], screen: Screen) -> Vec<f32> {
    let frame = FrameInputs { screen, time: 2.0, ..FrameInputs::default() };
    scene.graph.evaluate(&scene.sky.color, &Point::at(x, y, 0.0), &frame)
}

pub(super) fn with_glsl(text: &str, glsl: &str) -> Scene {
    let compiled = compile("test.scene", text, &mut |_| Ok(glsl.to_owned()));
    let report = compiled.render(false);
    compiled.scene.unwrap_or_else(|| panic!("{report}"))
}

/// The colour of a pixel of the sky `color`, with the functions of a GLSL file.
pub(super) fn drawn(color: &str, glsl: &str, at: [f32; 2]) -> Vec<f32> {
    color_on(&with_glsl(&format!("include \"a.glsl\"\nsky {{ color = {color} }}"), glsl), at, SCREEN)
}

#[test]
fn a_sky_alone_is_a_scene_that_reads_the_pixel_the_size_and_the_pointer() {
    let all = scene("sky { color = vec3(pixel.x, resolution.y, mouse.z) }");
    assert_eq!(color_on(&all, [3.5, 4.5], SCREEN), [3.5, 100.0, 1.0]);
    let pointer = scene("let at = mouse.xy / resolution\nsky { color = vec3(at, pixel.y) }");
    assert_eq!(color_on(&pointer, [3.5, 4.5], SCREEN), [0.25, 0.75, 4.5]);
    assert!(World::new("test", pointer, Vec::new()).unwrap().follows_pointer());
    let still = scene("sky { color = vec3(pixel / resolution, 0) }");
    assert_eq!(color_on(&still, [50.0, 50.0], Screen::of_size((200, 100))), [0.25, 0.5, 0.0]);
    assert!(!World::new("test", still, Vec::new()).unwrap().follows_pointer());
}

#[test]
fn the_picture_may_follow_the_pointer() {
    let scene = scene("sky { color = vec3(1) }\npicture { exposure = mouse.x / resolution.x }");
    let world = World::new("test", scene, Vec::new()).unwrap();
    let frame = FrameInputs { screen: SCREEN, ..FrameInputs::default() };
    assert_eq!(world.frame_tape.values(&frame).picture.exposure, 0.25);
}

#[test]
fn a_scene_may_use_the_names_for_its_own_values() {
    let own = scene(
        "param resolution = 2 in 1 .. 4\nlet mouse = 3\nfn pixel(a) = a\nsphere(p, resolution + pixel(mouse))",
    );
    assert_eq!(own.params.len(), 1);
}

#[test]
fn a_shader_sees_the_picture_in_the_sky_and_a_fixed_size_in_a_shape() {
    let glsl = "float wide(vec3 p) { return p.x + iResolution.x + iMouse.x; }";
    assert_eq!(drawn("vec3(wide(vec3(1)))", glsl, [0.0; 2]), [1.0 + 200.0 + 50.0; 3]);
    let text = "include \"a.glsl\"\nobject a { shape = wide(p) }\nsky { color = vec3(wide(vec3(0))) }";
    let both = with_glsl(text, glsl);
    let shape = both.graph.evaluate(&[both.distance], &Point::at(1.0, 0.0, 0.0), &FrameInputs::default());
    assert_eq!(shape, [1281.0]);
    assert_eq!(color_on(&both, [0.0; 2], SCREEN), [250.0; 3]);
}

#[test]
fn functions_that_draw_are_functions_of_the_pixel() {
    for glsl in [
        "void mainImage(out vec4 c, in vec2 f) { c = vec4(f / iResolution.xy, iTime, 1.0); }",
        "void mainImage(inout vec4 fragColor, vec2 fragCoord) { fragColor = vec4(fragCoord / iResolution.xy, iTime, 1.0); }",
        "uniform vec2 u_resolution; uniform float u_time;
        void main() { gl_FragColor = vec4(gl_FragCoord.xy / u_resolution, u_time, 1.0); }",
        "#version 330 core\nlayout(location = 0) out vec4 result; uniform vec2 iResolution; uniform float iTime;
        vec2 place() { return gl_FragCoord.xy / iResolution; }
        void main() { result = vec4(place(), iTime, 1.0); }",
        "void mainImage(out vec4 c, in vec2 f) { c = vec4(f / iResolution.xy, iTime, 1.0); }
        void main() { mainImage(gl_FragColor, gl_FragCoord.xy); }",
    ] {
        assert_eq!(drawn("mainImage(pixel).rgb", glsl, [50.0, 20.0]), [0.25, 0.2, 2.0], "{glsl}");
    }
}

#[test]
fn differences_between_pixels_are_those_of_the_formula() {
    let glsl = "void mainImage(out vec4 c, in vec2 f) { float a = f.x * f.x - 3.0 * f.y;
        c = vec4(dFdx(a), dFdy(a), fwidth(a), 1.0); }";
    assert_eq!(drawn("mainImage(pixel).rgb", glsl, [2.0, 7.0]), [5.0, -3.0, 8.0]);
}

#[test]
fn the_pointer_of_a_shader_is_at_0_until_its_button_is_held() {
    let glsl = "void mainImage(out vec4 c, in vec2 f) { c = vec4(iMouse.xy, iMouse.z, 1.0); }";
    assert_eq!(drawn("mainImage(pixel).rgb", glsl, [0.0; 2]), [50.0, 75.0, 50.0]);
    let text = "include \"a.glsl\"\nsky { color = mainImage(pixel).rgb }";
    let released = color_on(&with_glsl(text, glsl), [0.0; 2], Screen { pressed: false, ..SCREEN });
    assert_eq!(released, [0.0; 3], "at rest");
}

#[test]
fn a_shader_that_draws_and_has_no_distance_becomes_a_scene_of_sky() {
    let glsl = "float f(vec3 x) { return fract(sin(x.x) * 9.0); }
        void mainImage(out vec4 c, in vec2 p) { c = vec4(vec3(f(vec3(p, 0.0))), 1.0); }";
    let around = scene_around(glsl, Shown::Picture).unwrap();
    assert!(
        around.text("a.glsl").contains("sky { color = srgb(mainImage(pixel).rgb) }"),
        "{}",
        around.text("a.glsl")
    );
    assert!(around.left_out.is_empty(), "{:?}", around.left_out);
    assert!(with_glsl(&around.text("a.glsl"), glsl).objects.is_empty());
    let broken = "void mainImage(out vec4 c, in vec2 f) { c = vec4(a); }";
    let Diagnostic { message, .. } = scene_around(broken, Shown::Picture).unwrap_err();
    assert_eq!(message, "there is no `a` here");
}

#[test]
fn a_color_of_the_screen_becomes_light() {
    let light = color_on(&scene("sky { color = srgb(vec3(0.5, 0.02, 2)) }"), [0.0; 2], SCREEN);
    for (light, expected) in light.into_iter().zip([0.214_041, 0.001_548, 1.0]) {
        assert!((light - expected).abs() < 1e-5, "{light} {expected}");
    }
}
