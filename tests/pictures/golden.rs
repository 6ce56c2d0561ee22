//! The renderer's finished images: properties of the passes, reactions to music, cost, and golden images.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use crate::support::compare::{TIGHT, assert_alike, check_golden, difference, pixel_difference};
use crate::support::oracle::{constant, vector_constant};
use crate::support::shader_folder::changed_shaders;
use crate::support::test_renderer::{TestRenderer, loud_music, silence, soft_music, speakers};
use glam::DVec3;
use image::RgbaImage;
use mariana::frame::Frame;
use mariana::frame::picture::Picture;
use mariana::gpu::error::GpuError;
use mariana::gpu::renderer::{Counting, Renderer};
use mariana::gpu::scene_program::{Mode, compiled_variant};
use mariana::gpu::shader_source::ShaderLibrary;
use mariana_field::world::{SceneFeatures, ToneMap};
use mariana_music::{BAND_COUNT, Features};

/// A difference of more steps of 0..255 than this counts as visible.
const VISIBLE: u8 = 8;

#[test]
fn a_frame_has_the_same_bytes_every_time() {
    let mut test_renderer = TestRenderer::new();
    let size = (192, 108);
    let first = test_renderer.picture(3.0, loud_music(), size);
    let other = test_renderer.picture(9.0, silence(), size);
    assert!(difference(&first, &other, VISIBLE).fraction > 0.05, "two moments look the same");
    assert!(first == test_renderer.picture(3.0, loud_music(), size), "the second frame differs");

    let mut second =
        Renderer::new(test_renderer.context.gl(), &ShaderLibrary::embedded(), Counting::Off).unwrap();
    second
        .draw(&test_renderer.frame(3.0, loud_music(), size), &test_renderer.resources, &test_renderer.program)
        .unwrap();
    assert!(first.as_raw() == &second.read(), "another renderer draws a different image");
}

/// Sets a program that shows a computed colour: `body` contains statements that set `vec3 color`.
fn show(test_renderer: &mut TestRenderer, body: &str) {
    let scene = format!(
        "#include \"frame_block.glsl\"\n#include \"sample_place.glsl\"\n#include \"sample_light.glsl\"\nlayout(location = 0) out vec4 sample_color;\n\
         void main() {{\n    vec3 color;\n    {body}\n    sample_color = stored_sample(color, 0.0, pass_sample.z > 0.5);\n}}\n"
    );
    let (_folder, library) = changed_shaders(&[("scene.frag", &scene)]);
    test_renderer.program =
        test_renderer.link(&library, &compiled_variant("", 0, SceneFeatures::default(), Counting::Off));
}

fn drawn(test_renderer: &mut TestRenderer, size: (u32, u32)) -> RgbaImage {
    test_renderer.picture(0.0, silence(), size)
}

#[test]
fn light_is_encoded_once_and_stays_finite() {
    let mut test_renderer = TestRenderer::new();
    test_renderer.adjust = |picture| (picture.tone_map, picture.grain) = (ToneMap::None, 0.0);
    linear_light_becomes_srgb_once(&mut test_renderer);
    for adjust in [
        |picture: &mut Picture| *picture = plain(picture, ToneMap::Agx),
        |picture: &mut Picture| *picture = plain(picture, ToneMap::Aces),
        |picture: &mut Picture| *picture = plain(picture, ToneMap::Reinhard),
    ] {
        test_renderer.adjust = adjust;
        tone_mapping_is_monotonic_and_removes_invalid_light(&mut test_renderer);
    }
}

fn plain(picture: &Picture, tone_map: ToneMap) -> Picture {
    Picture { bloom: 0.0, grain: 0.0, tone_map, ..*picture }
}

/// The sRGB encoding of linear light (IEC 61966-2-1), in steps of 0..255.
fn srgb_steps(linear: f64) -> f64 {
    let encoded = if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
    255.0 * encoded
}

fn linear_light_becomes_srgb_once(test_renderer: &mut TestRenderer) {
    // The half floats between the passes represent these fractions exactly.
    for linear in [0.0, 1.0 / 512.0, 1.0 / 16.0, 0.25, 0.5, 1.0] {
        show(test_renderer, &format!("color = vec3({linear:?});"));
        let picture = drawn(test_renderer, (64, 64));
        let expected = srgb_steps(linear);
        for pixel in picture.pixels() {
            let off =
                pixel.0[..3].iter().map(|&value| (f64::from(value) - expected).abs()).fold(0.0, f64::max);
            assert!(off <= 1.01, "{linear} becomes {pixel:?}, not {expected:.2}");
            assert_eq!(pixel.0[3], 255, "the image is not opaque");
        }
        // Dithering has no bias, except at the ends of the range.
        let mean = picture.pixels().map(|pixel| f64::from(pixel.0[0])).sum::<f64>() / (64.0 * 64.0);
        if linear > 0.0 && linear < 1.0 {
            assert!((mean - expected).abs() < 0.1, "{linear} is {mean:.2} on average, not {expected:.2}");
        }
    }
    show(test_renderer, "color = vec3(0.5);");
    let middle = drawn(test_renderer, (64, 64));
    let steps: std::collections::BTreeSet<u8> = middle.pixels().map(|pixel| pixel.0[0]).collect();
    assert_eq!(steps, [187, 188].into(), "0.5 is between two steps, and dithering shows both");
}

fn tone_mapping_is_monotonic_and_removes_invalid_light(test_renderer: &mut TestRenderer) {
    const NAN: &str = "uintBitsToFloat(0x7fc00000u)";
    const INFINITY: &str = "uintBitsToFloat(0x7f800000u)";
    let grey = |value: &str| format!("vec3({value})");
    let black: Vec<String> = [
        grey(NAN),
        grey(INFINITY),
        grey(&format!("-{INFINITY}")),
        format!("vec3({NAN}, 0.5, 0.5)"),
        format!("vec3(0.5, 0.5, {NAN})"),
        format!("vec3({INFINITY}, 0.5, 0.5)"),
        format!("vec3({INFINITY}, -{INFINITY}, 0.5)"),
        grey("-1.0"),
        grey("-1e30"),
        grey("0.0"),
    ]
    .into();
    let bright = ["1e-6", "0.001", "0.01", "0.1", "0.5", "1.0", "3.0", "10.0", "100.0", "1e4", "1e8"];
    let all: Vec<String> = black.iter().cloned().chain(bright.map(grey)).collect();
    // Each column has a value. The shader reads the values from an array, so that no driver folds them as constants.
    let body = format!(
        "vec3 lights[{count}] = vec3[{count}]({lights});\n    \
         color = lights[int(sample_place().x) % {count}];",
        count = all.len(),
        lights = all.join(", ")
    );
    let width = all.len() as u32;
    show(test_renderer, &body);
    let picture = drawn(test_renderer, (width, 8));
    // The brightest channel of a column. Dithering changes a channel by up to half a step.
    let steps = |column: u32| {
        (0..8).map(|y| picture.get_pixel(column, y).0[..3].iter().max().copied()).max().flatten()
    };
    for (light, column) in black.iter().zip(0..) {
        assert!(steps(column) <= Some(1), "{light} becomes {:?} of 255, not black", steps(column));
    }
    let brights: Vec<u8> = (black.len() as u32..width).filter_map(steps).collect();
    assert!(brights.is_sorted(), "more light is darker: {bright:?} become {brights:?}");
    assert!(brights[0] <= 1 && brights[10] == 255, "the tone map does not use the whole range: {brights:?}");
    assert!(brights[4] < 255, "0.5 is clipped: {brights:?}");
}

fn fraction_of(picture: &RgbaImage, test: impl Fn(u8) -> bool) -> f64 {
    let hits = picture.pixels().filter(|pixel| pixel.0[..3].iter().all(|&value| test(value))).count();
    hits as f64 / (f64::from(picture.width()) * f64::from(picture.height()))
}

#[test]
fn no_frame_is_mostly_black_or_clipped() {
    let mut test_renderer = TestRenderer::new();
    let features = [silence(), soft_music(), loud_music()];
    for (time, size) in [
        (0.0, (160, 90)),
        (7.0, (160, 90)),
        (19.0, (90, 160)),
        (31.6, (60, 240)),
        (31.6, (160, 90)),
        (60.0, (240, 60)),
        (1234.5, (120, 120)),
    ] {
        for features in features {
            let picture = test_renderer.picture(time, features, size);
            let seen = format!("{size:?} at {time} s, volume {:?}", features.volume);
            let (black, white) =
                (fraction_of(&picture, |value| value == 0), fraction_of(&picture, |value| value == 255));
            assert!(black <= 0.30, "{black:.3} of the pixels are black: {seen}");
            assert!(white <= 0.02, "{white:.3} of the pixels are white: {seen}");
        }
    }
}

/// Projects a point of the scene to pixels from the upper left corner of the image.
fn pixel_of(frame: &Frame, point: DVec3) -> (f64, f64) {
    let (x, y) = frame.camera.project(point).expect("the point is in front of the camera");
    (0.5 * (x + 1.0) * f64::from(frame.size.0), 0.5 * (1.0 - y) * f64::from(frame.size.1))
}

fn changed_around(a: &RgbaImage, b: &RgbaImage, (x, y): (f64, f64), radius: f64) -> f64 {
    let (mut all, mut changed) = (0_u32, 0_u32);
    for (column, row, pixel) in a.enumerate_pixels() {
        if (f64::from(column) + 0.5 - x).hypot(f64::from(row) + 0.5 - y) <= radius {
            all += 1;
            changed += u32::from(pixel_difference(pixel, b.get_pixel(column, row)) > VISIBLE);
        }
    }
    assert!(all > 20, "{all} pixels are too few for a comparison");
    f64::from(changed) / f64::from(all)
}

#[test]
fn music_is_visible_and_each_channel_moves_its_own_woofer() {
    let mut test_renderer = TestRenderer::new();
    let size = (256, 144);
    for time in [0.0, 12.0, 40.0] {
        let silent = test_renderer.picture(time, silence(), size);
        let loud = test_renderer.picture(time, loud_music(), size);
        let fraction = difference(&silent, &loud, VISIBLE).fraction;
        assert!(fraction >= 0.05, "loud music changes only {fraction:.3} of the pixels at {time} s");

        let frame = test_renderer.frame(time, silence(), size);
        let centre = vector_constant("SPEAKER_CENTRE");
        let half_size = vector_constant("CABINET_HALF");
        let front = centre.z - half_size.z - constant("CABINET_ROUNDING");
        let woofer_y = centre.y + constant("WOOFER_Y");
        for (channel, name) in ["left", "right"].into_iter().enumerate() {
            let mut features = silence();
            features.volume[channel] = 0.3;
            let picture = test_renderer.picture(time, features, size);
            let changed = |side: f64| {
                let woofer = pixel_of(&frame, DVec3::new(side * centre.x, woofer_y, front));
                // The loudest woofer has a radius of 1.7 units.
                let rim = pixel_of(&frame, DVec3::new(side * centre.x, woofer_y + 1.7, front));
                changed_around(&silent, &picture, woofer, (rim.1 - woofer.1).abs())
            };
            let own_side = if channel == 0 { -1.0 } else { 1.0 };
            let (own, other) = (changed(own_side), changed(-own_side));
            assert!(own >= 0.15, "the {name} volume changes {own:.3} of its woofer at {time} s");
            assert!(other <= 0.01, "the {name} volume changes {other:.3} of the other woofer at {time} s");
        }
    }
}

#[test]
fn each_band_moves_its_own_bar() {
    let mut test_renderer = TestRenderer::new();
    let size = (432, 288);
    let silent = test_renderer.picture(0.0, silence(), size);
    let frame = test_renderer.frame(0.0, silence(), size);
    let spacing = constant("BAR_SPACING");
    let front = constant("BAR_Z") - constant("BAR_HALF_DEPTH");
    let level = 0.6;
    let height = level * constant("BAR_HEIGHT");
    let x_of = |bar: usize| (bar as f64 - 0.5 * (BAND_COUNT as f64 - 1.0)) * spacing;
    for band in 0..BAND_COUNT {
        let mut features = silence();
        features.bands[band] = level as f32;
        let picture = test_renderer.picture(0.0, features, size);
        // The mean change along a bar, from a third to nine tenths of its maximum height.
        let change = |bar: usize| {
            let probes = (0..12).map(|i| {
                let y = height * (0.33 + 0.57 * f64::from(i) / 11.0);
                let (x, y) = pixel_of(&frame, DVec3::new(x_of(bar), y, front));
                let (x, y) = (x as u32, y as u32);
                f64::from(pixel_difference(silent.get_pixel(x, y), picture.get_pixel(x, y)))
            });
            probes.sum::<f64>() / 12.0
        };
        let changes: Vec<f64> = (0..BAND_COUNT).map(change).collect();
        assert!(changes[band] > 40.0, "band {band} changes its bar by only {:.1} steps", changes[band]);
        // The bar's shadow also changes distant bars, but less.
        for (bar, other) in changes.iter().enumerate().filter(|(bar, _)| *bar != band) {
            let allowed = if bar.abs_diff(band) <= 3 { 0.25 } else { 0.9 };
            assert!(*other < allowed * changes[band], "band {band} moves bar {bar} as well: {changes:.0?}");
        }
    }
}

#[test]
fn tracing_stays_within_its_budget_and_counting_changes_nothing() {
    let mut counting = TestRenderer::of(&speakers(), Mode::Compiled, Counting::On);
    let mut plain = Renderer::new(counting.context.gl(), &ShaderLibrary::embedded(), Counting::Off).unwrap();
    let plain_program = counting.program_of(Mode::Compiled, Counting::Off);
    for (time, size) in [(0.0, (320, 180)), (7.0, (320, 180)), (31.0, (320, 180)), (12.0, (640, 360))] {
        let picture = counting.picture(time, loud_music(), size);
        let each = counting.renderer.evaluations(f64::from(size.0 * size.1));
        assert!(
            each.primary >= 0.3 && each.shadow > 0.3 && each.normal > 0.3,
            "primary, shadow or normal evaluations were not counted: {each:?}"
        );
        assert!(
            each.reflection > 0.01 && each.occlusion > 0.3,
            "reflection or occlusion evaluations were \
            not counted: {each:?}"
        );
        assert_eq!(each.capped_rays, 0.0, "rays reach their step cap at {time} s");
        assert!(each.total() <= 60.0, "{:.1} evaluations per pixel at {time} s: {each:?}", each.total());

        plain.draw(&counting.frame(time, loud_music(), size), &counting.resources, &plain_program).unwrap();
        let uncounted = RgbaImage::from_raw(size.0, size.1, plain.read()).unwrap();
        assert_alike("counting", &picture, &uncounted, TIGHT);
        assert_eq!(plain.evaluations(1.0).total(), 0.0, "a renderer without counting has counted");
    }
}

#[test]
fn supported_sizes_are_drawn_and_larger_ones_refused() {
    let mut test_renderer = TestRenderer::new();
    for size in [(1, 1), (1, 64), (3000, 1), (64, 64), (65, 33)] {
        let picture = test_renderer.picture(5.0, soft_music(), size);
        assert!(fraction_of(&picture, |value| value == 0) <= 0.30, "{size:?} is black");
        assert!(picture.pixels().all(|pixel| pixel.0[3] == 255), "{size:?} is not opaque");
    }
    let before = test_renderer.picture(5.0, soft_music(), (64, 64));
    let limit = test_renderer.context.gl().info().texture_side_max;
    for size in [(limit + 1, 1), (1, limit + 1), (u32::MAX, u32::MAX)] {
        match test_renderer.try_picture(5.0, soft_music(), size) {
            Err(GpuError::TooLarge { width, height, limit: reported }) => {
                assert_eq!((width, height, reported), (size.0, size.1, limit));
            }
            Err(other) => panic!("{size:?}: {other}"),
            Ok(_) => panic!("{size:?} was drawn"),
        }
        let after = test_renderer.picture(5.0, soft_music(), (64, 64));
        assert!(before == after, "the image differs after {size:?} was refused");
    }
}

#[test]
fn images_match_the_golden_images() {
    let mut test_renderer = TestRenderer::new();
    let scenes: [(&str, f64, Features, (u32, u32)); 3] = [
        ("silent", 0.0, silence(), (256, 144)),
        ("loud", 12.0, loud_music(), (256, 144)),
        ("tall", 12.0, loud_music(), (144, 256)),
    ];
    let results = scenes
        .map(|(name, time, features, size)| check_golden(name, &test_renderer.picture(time, features, size)));
    let failures: Vec<String> = results.into_iter().filter_map(Result::err).collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}
