//! The way from light to the screen: tone maps, bloom, grain, depth of field and antialiased edges, tested on images.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use crate::support::shader_folder::changed_shaders;
use crate::support::test_renderer::{TestRenderer, loud_music, silence};
use image::RgbaImage;
use mariana::export::bench::peak_signal_over_noise;
use mariana::frame::picture::{BLUR_MAX, Picture};
use mariana::gpu::edge_samples::EdgeSamples;
use mariana::gpu::renderer::Counting;
use mariana::gpu::scene_program::{Mode, compiled_variant};
use mariana::scenes::SceneSource;
use mariana_field::world::{SceneFeatures, ToneMap};

/// Sets a program that shows a computed colour: `body` contains statements that set `vec3 color`.
fn show(test_renderer: &mut TestRenderer, body: &str) {
    let scene = format!(
        "#include \"frame_block.glsl\"\n#include \"sample_place.glsl\"\n#include \"sample_light.glsl\"\n\
         layout(location = 0) out vec4 sample_color;\nvoid main() {{\n    vec3 color;\n    {body}\n    \
         sample_color = stored_sample(color, 0.0, pass_sample.z > 0.5);\n}}\n"
    );
    let (_folder, library) = changed_shaders(&[("scene.frag", &scene)]);
    test_renderer.program =
        test_renderer.link(&library, &compiled_variant("", 0, SceneFeatures::default(), Counting::Off));
}

fn plain(picture: &mut Picture) {
    (picture.bloom, picture.grain, picture.tone_map) = (0.0, 0.0, ToneMap::None);
}

fn scene(text: &str) -> TestRenderer {
    TestRenderer::of(&SceneSource::Formula(text.into()), Mode::Compiled, Counting::Off)
}

/// The linear light of a byte, by IEC 61966-2-1.
fn linear(byte: u8) -> f64 {
    let encoded = f64::from(byte) / 255.0;
    if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

fn steps(linear: f64) -> f64 {
    255.0 * if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

fn energy(picture: &RgbaImage) -> f64 {
    picture.pixels().flat_map(|pixel| pixel.0[..3].iter().map(|&byte| linear(byte)).collect::<Vec<_>>()).sum()
}

type Rgb = [f64; 3];

fn times(rows: [Rgb; 3], v: Rgb) -> Rgb {
    rows.map(|row| row.iter().zip(v).map(|(a, b)| a * b).sum())
}

/// Computes a tone map as its source defines it. For AgX, this uses the original sigmoid, which the shader
/// approximates by a polynomial.
fn witness(map: ToneMap, color: Rgb) -> Rgb {
    match map {
        ToneMap::Agx => {
            let inset = [
                [0.842479062253094, 0.0784335999999992, 0.0792237451477643],
                [0.0423282422610123, 0.878468636469772, 0.0791661274605434],
                [0.0423756549057051, 0.0784336, 0.879142973793104],
            ];
            let outset = [
                [1.19687900512017, -0.0980208811401368, -0.0990297440797205],
                [-0.0528968517574562, 1.15190312990417, -0.0989611768448433],
                [-0.0529716355144438, -0.0980434501171241, 1.15107367264116],
            ];
            let encoded = times(inset, color)
                .map(|light| agx_sigmoid(((light.max(1e-10).log2() + 12.47393) / 16.5).clamp(0.0, 1.0)));
            let grey: f64 = [0.2126, 0.7152, 0.0722].iter().zip(encoded).map(|(a, b)| a * b).sum();
            times(outset, encoded.map(|value| grey + 1.4 * (value - grey)))
                .map(|value| value.clamp(0.0, 1.0).powf(2.36))
        }
        ToneMap::Aces => {
            let inset =
                [[0.59719, 0.35458, 0.04823], [0.07600, 0.90834, 0.01566], [0.02840, 0.13383, 0.83777]];
            let outset =
                [[1.60475, -0.53108, -0.07367], [-0.10208, 1.10813, -0.00605], [-0.00327, -0.07276, 1.07602]];
            let fitted = times(inset, color.map(|light| 1.6 * light))
                .map(|v| (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.4329510) + 0.238081));
            times(outset, fitted).map(|value| value.clamp(0.0, 1.0))
        }
        ToneMap::Reinhard => {
            let color = color.map(|light| 1.35 * light);
            let l: f64 = [0.2126, 0.7152, 0.0722].iter().zip(color).map(|(a, b)| a * b).sum();
            color.map(|light| (light * (1.0 + l / 36.0) / (1.0 + l)).clamp(0.0, 1.0))
        }
        ToneMap::None => color.map(|light| light.clamp(0.0, 1.0)),
    }
}

/// Sobotka's curve: two hyperbolas that meet at the pivot.
fn agx_sigmoid(x: f64) -> f64 {
    let (px, py, slope) = (10.0 / 16.5, 0.48, 2.2);
    let (towards, power) = if x < px { (-1.0, 1.6_f64) } else { (1.0, 2.4) };
    let (room_x, room_y) = if x < px { (px, py) } else { (1.0 - px, 1.0 - py) };
    let scale =
        ((slope * room_x).powf(-power) * ((slope * room_x / room_y).powf(power) - 1.0)).powf(-1.0 / power);
    let t = slope * (x - px) * towards / scale;
    py + towards * scale * t / (1.0 + t.powf(power)).powf(1.0 / power)
}

#[test]
fn tone_maps_match_their_definitions_and_keep_hues() {
    let mut test_renderer = TestRenderer::new();
    let hues: [Rgb; 6] = [
        [1.0, 1.0, 1.0],
        [1.0, 0.1, 0.05],
        [0.1, 1.0, 0.2],
        [0.05, 0.2, 1.0],
        [1.0, 0.6, 0.1],
        [0.6, 0.1, 1.0],
    ];
    let lights: Vec<Rgb> =
        (-8..=6).flat_map(|stop| hues.map(|hue| hue.map(|part| part * 2f64.powi(stop)))).collect();
    let listed: Vec<String> = lights.iter().map(|[r, g, b]| format!("vec3({r:?}, {g:?}, {b:?})")).collect();
    show(
        &mut test_renderer,
        &format!(
            "vec3 lights[{0}] = vec3[{0}]({1});\n    color = lights[int(sample_place().x) % {0}];",
            lights.len(),
            listed.join(", ")
        ),
    );
    for map in ToneMap::ALL {
        test_renderer.adjust = match map {
            ToneMap::Agx => |picture| {
                plain(picture);
                picture.tone_map = ToneMap::Agx;
            },
            ToneMap::Aces => |picture| {
                plain(picture);
                picture.tone_map = ToneMap::Aces;
            },
            ToneMap::Reinhard => |picture| {
                plain(picture);
                picture.tone_map = ToneMap::Reinhard;
            },
            ToneMap::None => plain,
        };
        let picture = test_renderer.picture(0.0, silence(), (lights.len() as u32, 1));
        let mut greys = Vec::new();
        for ((pixel, light), number) in picture.pixels().zip(&lights).zip(0..) {
            let expected = witness(map, *light).map(steps);
            let seen = [0, 1, 2].map(|channel| f64::from(pixel.0[channel]));
            // The polynomial's error is at most 0.003. Saturation and matrices enlarge this error.
            let off = if map == ToneMap::Agx { 4.0 } else { 1.6 };
            assert!(
                seen.iter().zip(expected).all(|(a, b)| (a - b).abs() <= off),
                "{map:?} of {light:?} is {seen:?}, not {expected:?}"
            );
            // The strongest channel stays the strongest, and grey stays grey. ACES shifts bright colours, so a larger
            // error is allowed.
            let turned = if map == ToneMap::Aces { 8.0 } else { 1.0 };
            let strongest = (0..3).max_by(|&a, &b| light[a].total_cmp(&light[b])).unwrap();
            let most = seen.iter().fold(0.0_f64, |most, &part| most.max(part));
            assert!(seen[strongest] >= most - turned, "{map:?} shifts the hue of {light:?}: {seen:?}");
            if number % hues.len() == 0 {
                assert!(
                    seen.iter().all(|part| (part - seen[0]).abs() <= 1.0),
                    "{map:?} colours a grey: {seen:?}"
                );
                greys.push(seen[0]);
            }
        }
        assert!(greys.is_sorted(), "{map:?}: {greys:?}");
        // The tone map does not crush blacks: light seven stops below 1 is brighter than light eight stops below 1.
        assert!(greys[1] > greys[0] && greys[0] >= 0.0, "{map:?}: {greys:?}");
    }
}

#[test]
fn bloom_scatters_light_and_adds_none() {
    let mut test_renderer = TestRenderer::new();
    // The square is dark, because bright pixels get a reduced weight.
    show(
        &mut test_renderer,
        "vec2 off = abs(sample_place() - vec2(96.0, 54.0));\n    \
         color = max(off.x, off.y) < 20.0 ? vec3(0.10, 0.06, 0.02) : vec3(0.005);",
    );
    let size = (192, 108);
    test_renderer.adjust = plain;
    let sharp = test_renderer.picture(0.0, silence(), size);
    test_renderer.adjust = |picture| {
        plain(picture);
        picture.bloom = 1.0;
    };
    let scattered = test_renderer.picture(0.0, silence(), size);
    let (before, after) = (energy(&sharp), energy(&scattered));
    assert!((after / before - 1.0).abs() < 0.04, "{before:.2} became {after:.2}");
    let beside = |picture: &RgbaImage| linear(picture.get_pixel(120, 54).0[0]);
    assert!(beside(&scattered) > 1.5 * beside(&sharp), "the bloom adds no light next to the square");

    test_renderer.adjust = |picture| {
        plain(picture);
        picture.bloom = 0.04;
    };
    // A single pixel must not glow, even with maximal brightness or an invalid value.
    for one in ["1e30", "uintBitsToFloat(0x7f800000u)", "uintBitsToFloat(0x7fc00000u)"] {
        show(
            &mut test_renderer,
            &format!(
                "color = vec3(0.01);\n    if (ivec2(sample_place()) == ivec2(96, 54)) color = vec3({one});"
            ),
        );
        let picture = test_renderer.picture(0.0, silence(), size);
        let around = picture.enumerate_pixels().filter(|(x, y, _)| x.abs_diff(96).max(y.abs_diff(53)) > 3);
        let most = around.map(|(_, _, pixel)| pixel.0[0]).max().unwrap();
        assert!(f64::from(most) < steps(0.02), "{one} glows: {most}");
    }
}

#[test]
fn every_size_has_its_bloom_and_its_lens() {
    let mut test_renderer = scene(
        "camera { aperture = 0.2 focus = 3 }\npicture { bloom = 0.3 vignette = 1 }\nmin(y + 1, length(p) - 1)",
    );
    for size in [(1, 1), (2, 1), (1, 3), (7, 5), (640, 2), (2048, 1), (1, 2048)] {
        let picture = test_renderer.picture(0.5, loud_music(), size);
        assert_eq!(picture.dimensions(), size);
        assert!(
            picture == test_renderer.picture(0.5, loud_music(), size),
            "{size:?} differs between two \
            frames"
        );
        assert!(picture.pixels().any(|pixel| pixel.0[..3].iter().any(|&byte| byte > 8)), "{size:?} is black");
    }
}

#[test]
fn grain_is_slight_unbiased_and_still() {
    let mut test_renderer = TestRenderer::new();
    show(&mut test_renderer, "color = vec3(0.2);");
    test_renderer.adjust = |picture| {
        plain(picture);
        picture.grain = 1.0;
    };
    let picture = test_renderer.picture(0.0, silence(), (128, 128));
    assert!(
        picture == test_renderer.picture(7.0, silence(), (128, 128)),
        "grain moves over a constant image"
    );
    let mean = picture.pixels().map(|pixel| f64::from(pixel.0[0])).sum::<f64>() / (128.0 * 128.0);
    assert!((mean - steps(0.2)).abs() < 0.1, "{mean} instead of {}", steps(0.2));
    let far = picture.pixels().map(|pixel| (f64::from(pixel.0[0]) - steps(0.2)).abs()).fold(0.0, f64::max);
    assert!((1.0..=2.0).contains(&far), "grain of {far} steps");
}

/// A wall at z = 6 that emits light where x > 0, seen from the origin.
fn wall(camera: &str) -> TestRenderer {
    let mut test_renderer = scene(&format!(
        "material halves {{ color = 0 emission = if p.x > 0 then 0.5 else 0 }}\n\
         object wall {{ shape = 6 - z material = halves }}\n\
         light none {{ position = vec3(0) color = 0 }}\nsky {{ color = 0 ambient = 0 }}\n\
         camera {{ position = vec3(0) target = vec3(0, 0, 1) fov = 45 {camera} }}"
    ));
    test_renderer.adjust = plain;
    test_renderer
}

/// Returns the edge's width in pixels on the middle row, from a tenth to nine tenths of the brighter side's light.
fn edge_width(picture: &RgbaImage) -> f64 {
    let row: Vec<f64> =
        (0..picture.width()).map(|x| linear(picture.get_pixel(x, picture.height() / 2).0[0])).collect();
    let high = row.iter().copied().fold(0.0, f64::max);
    let crossing = |fraction: f64| {
        let at = row
            .windows(2)
            .position(|pair| (pair[0] < fraction * high) != (pair[1] < fraction * high))
            .unwrap();
        at as f64 + (fraction * high - row[at]) / (row[at + 1] - row[at])
    };
    (crossing(0.9) - crossing(0.1)).abs()
}

#[test]
fn the_edge_of_a_sharp_surface_before_a_blurred_one_has_no_dots() {
    let mut renderer = scene(
        "material even { color = 0  emission = 0.5 }
         object ball { shape = sphere(p - vec3(0, 0, 6), 1)  material = even }
         light none { position = vec3(0)  color = 0 }
         sky { color = if fract(60 * direction.x) < 0.5 then 0 else 1  ambient = 0 }
         camera { position = vec3(0)  target = vec3(0, 0, 1)  fov = 45  aperture = 0.6  focus = 6 }",
    );
    renderer.adjust = plain;
    let picture = renderer.picture(0.0, silence(), (320, 200));
    // The blurred stripes are about as bright as the ball.
    for (x, y, pixel) in picture.enumerate_pixels() {
        let light = linear(pixel.0[0]);
        let is_inner = (40..280).contains(&x) && (20..180).contains(&y);
        assert!(!is_inner || (0.35..0.6).contains(&light), "{light:.2} at {x}, {y}");
    }
}

#[test]
fn a_lens_blurs_like_a_thin_lens() {
    let size = (320, 200);
    let pinhole = wall("").picture(0.0, silence(), size);
    let focused = wall("aperture = 0.15 focus = 6").picture(0.0, silence(), size);
    assert!(pinhole == focused, "the plane in focus is blurred");
    assert!(edge_width(&pinhole) < 1.1);
    // Half of a pixel's width at distance 1.
    let half_pixel = 22.5_f64.to_radians().tan() / f64::from(size.1);
    for (aperture, focus) in [(0.1, 3.0), (0.15, 3.0), (0.18, 3.2), (0.1, 20.0), (0.2, 20.0)] {
        let radius = aperture * (1.0 / focus - 1.0 / 6.0_f64).abs() / (2.0 * half_pixel);
        assert!(radius < f64::from(BLUR_MAX) * f64::from(size.1), "the blur exceeds its limit");
        let picture = wall(&format!("aperture = {aperture} focus = {focus}")).picture(0.0, silence(), size);
        // A line at 0.687 of a disc's radius from its centre leaves 0.9 of the disc's area on one side.
        let (expected, found) = (2.0 * 0.687 * radius, edge_width(&picture));
        assert!(
            (found - expected).abs() < 0.15 * expected + 0.8,
            "{aperture} at {focus}: {found:.2} pixels, not {expected:.2}"
        );
    }
}

#[test]
fn a_sharp_foreground_is_not_covered_by_blur() {
    let text = |lens: &str| {
        format!(
            "material dark {{ color = 0 emission = 0.02 }}\nmaterial bright {{ color = 0 emission = 0.6 }}\n\
             object near {{ shape = box(p - vec3(0, 0, 5), vec3(1, 1, 0.1)) material = dark }}\n\
             object far {{ shape = 40 - z material = bright }}\n\
             light none {{ position = vec3(0) color = 0 }}\nsky {{ color = 0 ambient = 0 }}\n\
             camera {{ position = vec3(0) target = vec3(0, 0, 1) fov = 45 {lens} }}"
        )
    };
    let size = (320, 200);
    let draw = |lens: &str| {
        let mut test_renderer = scene(&text(lens));
        test_renderer.adjust = plain;
        test_renderer.picture(0.0, silence(), size)
    };
    let (pinhole, lens) = (draw(""), draw("aperture = 0.2 focus = 4.9"));
    // The box's front is 98.5 pixels wide.
    for x in 160 - 46..160 + 46 {
        let (a, b) = (pinhole.get_pixel(x, 100).0[0], lens.get_pixel(x, 100).0[0]);
        assert!(a.abs_diff(b) <= 2, "the background blurs over the box at {x}: {a} becomes {b}");
    }
}

#[test]
fn edges_of_stills_are_close_to_sixty_four_samples() {
    let mut test_renderer = TestRenderer::new();
    test_renderer.adjust = |picture| picture.grain = 0.0;
    let frame = test_renderer.frame(0.0, silence(), (320, 180));
    test_renderer.renderer.draw_reference(&frame, &test_renderer.resources, &test_renderer.program).unwrap();
    let reference = test_renderer.renderer.read();
    for (samples, least) in [
        (EdgeSamples::Two, 34.0),
        (EdgeSamples::Four, 36.0),
        (EdgeSamples::Eight, 39.0),
        (EdgeSamples::Sixteen, 42.0),
    ] {
        test_renderer.renderer.set_edge_samples(samples);
        test_renderer.renderer.draw(&frame, &test_renderer.resources, &test_renderer.program).unwrap();
        let found = peak_signal_over_noise(&test_renderer.renderer.read(), &reference);
        assert!((least..80.0).contains(&found), "{samples:?}: {found:.2} dB");
    }
}
