//! Scenes in two dimensions: the colours of pixels, in both modes and at any resolution of the frame.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use crate::support::test_renderer::{TestRenderer, silence};
use image::RgbaImage;
use mariana::gpu::renderer::Counting;
use mariana::gpu::scene_program::Mode;
use mariana::scenes::SceneSource;
use mariana_field::graph::Screen;

const FLAT: &str = "\npicture { tone_map = none  bloom = 0  grain = 0 }";
const MODES: [Mode; 2] = [Mode::Interpreted, Mode::Compiled];

fn renderer(text: &str, mode: Mode) -> TestRenderer {
    TestRenderer::of(&SceneSource::Formula(format!("{text}{FLAT}")), mode, Counting::Off)
}

fn assert_colors(picture: &RgbaImage, what: &str, color: impl Fn(f32, f32) -> [f32; 3]) {
    let height = picture.height() as f32;
    for (x, y, pixel) in picture.enumerate_pixels() {
        // Rows of images begin at the top.
        let wanted = color(x as f32 + 0.5, height - y as f32 - 0.5);
        for (byte, wanted) in pixel.0.iter().zip(wanted) {
            let wanted = 255.0 * wanted.clamp(0.0, 1.0);
            // Light has 16 bits, and dither adds up to half a step.
            assert!((f32::from(*byte) - wanted).abs() < 1.6, "{what}: {pixel:?} at {x},{y}, not {wanted}");
        }
    }
}

#[test]
fn pixels_have_the_colors_of_the_formula() {
    let text = "sky { color = srgb(vec3(pixel / resolution, mouse.x / resolution.x + mouse.z)) }";
    for mode in MODES {
        let picture = renderer(text, mode).picture(0.0, silence(), (40, 24));
        assert_colors(&picture, &mode.to_string(), |x, y| [x / 40.0, y / 24.0, 0.5]);
    }
}

#[test]
fn a_frame_with_fewer_pixels_shows_the_same_picture() {
    let text = "sky { color = srgb(vec3(fract(pixel / 32), mouse.y / 100 + 0.1 * mouse.z)) }";
    for mode in MODES {
        let mut drawn = renderer(text, mode);
        let screen = Screen { size: [80.0, 48.0], pointer: [0.0, 0.75], pressed: true };
        let frame = drawn.frame(0.0, silence(), (40, 24)).on_screen(drawn.world(), screen);
        let picture = drawn.of_frame(&frame).unwrap();
        assert_colors(&picture, &mode.to_string(), |x, y| [(x / 16.0).fract(), (y / 16.0).fract(), 0.46]);
    }
}

/// The sky's program is shortened over directions, on which the pixel does not depend.
#[test]
fn long_formulas_of_the_pixel_agree_in_both_modes() {
    let text = "sky {\n  let uv = (pixel - 0.5 * resolution) / resolution.y\n\
                let rings = sum(for i in 0..12: sin(9 * length(uv - 0.3 * vec2(cos(i), sin(2 * i))) + i * direction.x))\n\
                color = srgb(vec3(0.5 + 0.04 * rings, max(uv.x, uv.y), min(abs(uv.x), 0.5 + uv.y)))\n}";
    let [interpreted, compiled] = MODES.map(|mode| renderer(text, mode).picture(0.0, silence(), (64, 36)));
    let differs = |(a, b): (&u8, &u8)| a.abs_diff(*b) > 1;
    let different = interpreted.as_raw().iter().zip(compiled.as_raw()).filter(|pair| differs(*pair)).count();
    assert_eq!(different, 0);
}
