//! Whole shaders in the dialects of several viewers. The texts are written for these tests.

use std::sync::Arc;

use super::super::{Scene, Span, compile};
use super::pixels::{SCREEN, color_on, drawn, with_glsl};
use crate::glsl_import::{SceneAround, Shown, scene_around, whole};
use crate::graph::{FrameInputs, Point, SoundInput, SoundInputs, TableData, TextureReader};
use crate::limits::LIMITS;

fn around(glsl: &str) -> SceneAround {
    scene_around(glsl, Shown::Picture).unwrap_or_else(|problem| panic!("{problem:?}\n{glsl}"))
}

/// The scene that an import makes.
fn imported(glsl: &str) -> Scene {
    with_glsl(&around(glsl).text("a.glsl"), glsl)
}

/// The colour of a pixel of an imported scene, as the shader gives it.
fn shown(glsl: &str, at: [f32; 2], frame: FrameInputs) -> Vec<f32> {
    let scene = imported(glsl);
    let params = scene.params.iter().map(|param| param.default).collect();
    let frame = FrameInputs { screen: SCREEN, time: 2.0, params, ..frame };
    let light = scene.graph.evaluate(&scene.sky.color, &Point::at(at[0], at[1], 0.0), &frame);
    light
        .into_iter()
        .map(|light| if light < 0.003 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 })
        .collect()
}

#[track_caller]
fn assert_near(found: &[f32], expected: &[f32]) {
    let near = found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 2e-3);
    assert!(near && found.len() == expected.len(), "{found:?} is not {expected:?}");
}

/// A spectrum that is high on the left, and a waveform that is high everywhere.
fn loud() -> FrameInputs {
    let spectrum: Vec<f32> = (0..64).map(|index| if index < 32 { 0.75 } else { 0.25 }).collect();
    let sound =
        SoundInputs::with(&[(SoundInput::Bass, 0.6), (SoundInput::Mid, 0.3), (SoundInput::BassDrive, 1.0)]);
    let (spectrum, waveform) = (TableData::row(spectrum), TableData::row(vec![0.5; 64]));
    FrameInputs { spectrum, waveform, sound, ..FrameInputs::default() }
}

const BALL: &str = "float map(vec3 p) { return length(p - vec3(0.0, 0.0, 3.0)) - 1.0; }
    void mainImage(out vec4 color, in vec2 at) {
        vec3 ray = normalize(vec3((2.0 * at - iResolution.xy) / iResolution.y, 1.5));
        float t = 0.0;
        for (int i = 0; i < 40; i++) t += map(t * ray);
        color = t < 9.0 ? vec4(0.2, 0.4, 0.9, 1.0) : vec4(0.6, 0.1, 0.1, 1.0);
    }";

#[test]
fn a_shader_with_a_distance_and_a_picture_became_clay() {
    assert_near(&shown(BALL, [100.0, 50.0], FrameInputs::default()), &[0.2, 0.4, 0.9]);
    assert_near(&shown(BALL, [3.0, 3.0], FrameInputs::default()), &[0.6, 0.1, 0.1]);
    let own = around(BALL);
    assert!(own.text("a.glsl").contains("--as shape` makes an object of its distance `map`"), "{own:?}");
    assert_eq!(own.left_out, Vec::<String>::new());
    let shape = scene_around(BALL, Shown::Shape).unwrap();
    assert!(shape.text("a.glsl").contains("--as picture") && shape.text("a.glsl").contains("shape = map(p)"));
    assert!(shape.notes()[0].contains("--as picture"), "{:?}", shape.notes());
}

#[test]
fn a_picture_that_no_scene_can_draw_leaves_the_distance() {
    let glsl = BALL.replace("float t = 0.0;", "float t = lost;");
    let around = around(&glsl);
    assert!(around.text("a.glsl").contains("shape = map(p)"));
    assert_eq!(around.left_out[0], "the shader's own picture: there is no `lost` here");
    assert_eq!(around.choice, None);
}

#[test]
fn the_texture_of_the_sound_was_silent() {
    let glsl = "void mainImage(out vec4 c, in vec2 f) { float x = f.x / iResolution.x;
        float row = f.y < 50.0 ? 0.25 : 0.75;
        c = vec4(texture(iChannel0, vec2(x, row)).x, texture(iChannel0, vec2(0.75, x * 0.0)).x,
            texelFetch(iChannel0, ivec2(int(f.x), 1), 0).x, 1.0); }";
    // 110 Hz and 11 kHz are on the two sides of the spectrum's middle; silence of the waveform is 0.5.
    assert_near(&shown(glsl, [2.0, 5.0], loud()), &[0.75, 0.25, 0.75]);
    assert_near(&shown(glsl, [190.0, 5.0], loud()), &[0.25, 0.25, 0.75]);
    assert_near(&shown(glsl, [190.0, 95.0], loud()), &[0.75, 0.25, 0.75]);
    assert_near(&shown(glsl, [2.0, 5.0], FrameInputs::default()), &[0.0, 0.0, 0.5]);
}

#[test]
fn the_sound_of_other_viewers_is_the_sound_of_the_scene() {
    let bonzomatic = "#version 410 core
        uniform float fGlobalTime; uniform vec2 v2Resolution; uniform sampler1D texFFT, texFFTSmoothed;
        uniform sampler1D texFFTIntegrated; layout(location = 0) out vec4 out_color;
        void main(void) { vec2 uv = gl_FragCoord.xy / v2Resolution;
            out_color = vec4(texture(texFFT, 0.001).r, texture(texFFTIntegrated, 0.1).r / 3, uv.x, 1); }";
    let amplitude = 10_f32.powf((0.75 * 72.0 - 84.0) / 20.0);
    assert_near(&shown(bonzomatic, [50.0, 1.0], loud()), &[amplitude, 0.5, 0.25]);
    let veda =
        "/*{ \"audio\": true }*/ precision mediump float; uniform vec2 resolution; uniform float volume;
        uniform sampler2D spectrum, samples;
        void main() { vec2 uv = gl_FragCoord.xy / resolution;
            gl_FragColor = vec4(texture2D(spectrum, vec2(0.002, 0.5)).g,
            texture2D(samples, uv).r, volume / 255.0, 1.0); }";
    assert_near(&shown(veda, [50.0, 1.0], loud()), &[0.75, 0.75, 0.3]);
    let kodelife = "#version 150
        uniform vec2 resolution; uniform vec3 spectrum; uniform float bass;
        in VertexData { vec4 v_position; vec3 v_normal; vec2 v_texcoord; } inData; out vec4 fragColor;
        void main(void) { fragColor = vec4(spectrum.x, bass, inData.v_texcoord.y, 1.0); }";
    assert_near(&shown(kodelife, [50.0, 25.0], loud()), &[0.6, 0.6, 0.25]);
    let isf = "/*{ \"ISFVSN\": \"2\", \"INPUTS\": [ { \"NAME\": \"wave\", \"TYPE\": \"audio\" },
        { \"NAME\": \"levels\", \"TYPE\": \"audioFFT\" } ] }*/
        void main() { gl_FragColor = vec4(IMG_NORM_PIXEL(levels, vec2(0.002, 0.5)).r,
            IMG_NORM_PIXEL(wave, isf_FragNormCoord).r, 0.0, 1.0); }";
    assert_near(&shown(isf, [50.0, 25.0], loud()), &[0.75, 0.75, 0.0]);
}

#[test]
fn names_of_time_size_and_place_are_known_in_every_dialect() {
    for (glsl, expected) in [
        // Bonzomatic; GLSL Sandbox; the Book of Shaders; an input from an earlier stage.
        (
            "#version 410 core
        uniform float fGlobalTime; uniform vec2 v2Resolution; layout(location = 0) out vec4 out_color;
        void main() { out_color = vec4(gl_FragCoord.xy / v2Resolution, 0.25 * fGlobalTime, 1.0); }",
            [0.25, 0.2, 0.5],
        ),
        (
            "uniform float time; varying vec2 surfacePosition;
        void main() { gl_FragColor = vec4(surfacePosition + vec2(1.0, 0.5), 0.25 * time, 1.0); }",
            [0.5, 0.2, 0.5],
        ),
        (
            "uniform vec2 u_resolution; uniform float u_time; uniform vec2 u_mouse;
        void main() { gl_FragColor = vec4(u_mouse / u_resolution, 0.25 * u_time, 1.0); }",
            [0.25, 0.75, 0.5],
        ),
        (
            "#version 330
        in vec2 uv; out vec4 color; uniform float uTime;
        void main() { color = vec4(uv, 0.25 * uTime, 1.0); }",
            [0.25, 0.2, 0.5],
        ),
        (
            "void mainImage(out vec4 c, in vec2 f) { c = vec4(f / iResolution.xy, 0.25 * iTime, 1.0); }",
            [0.25, 0.2, 0.5],
        ),
    ] {
        assert_near(&shown(glsl, [50.0, 20.0], FrameInputs::default()), &expected);
        assert_eq!(around(glsl).left_out, Vec::<String>::new(), "{glsl}");
    }
}

#[test]
fn inputs_of_isf_become_sliders_with_their_defaults() {
    let glsl = "/*{ \"ISFVSN\": \"2\", \"CATEGORIES\": [\"x\"], \"INPUTS\": [
        { \"NAME\": \"size\", \"TYPE\": \"float\", \"DEFAULT\": 0.3, \"MIN\": 0.1, \"MAX\": 2.0 },
        { \"NAME\": \"mode\", \"TYPE\": \"long\", \"VALUES\": [0, 1, 2], \"DEFAULT\": 1 },
        { \"NAME\": \"invert\", \"TYPE\": \"bool\", \"DEFAULT\": true },
        { \"NAME\": \"volume\", \"TYPE\": \"float\", \"DEFAULT\": 0.5 },
        { \"NAME\": \"waves\", \"TYPE\": \"float\", \"DEFAULT\": 30 },
        { \"NAME\": \"tint\", \"TYPE\": \"color\", \"DEFAULT\": [1.0, 0.5, 0.25, 1.0] } ],
        \"PASSES\": [ { \"TARGET\": \"last\", \"PERSISTENT\": true }, {} ] }*/
        void main() {
            if (PASSINDEX == 0) gl_FragColor = vec4(1.0);
            else if (invert) gl_FragColor = vec4(2.0 * tint.rgb * size * float(mode) * (2.0 * volume), 0.5);
            else gl_FragColor = vec4(IMG_THIS_PIXEL(last).rgb, 1.0);
        }";
    let text = around(glsl).text("a.glsl");
    for line in [
        "param size = 0.3 in 0.1 .. 2",
        "param waves = 30 in 0 .. 30",
        "let mode = 1",
        "let invert = 1",
        "let tint = vec4(1, 0.5, 0.25, 1)",
    ] {
        assert!(text.contains(line), "no `{line}` in {text}");
    }
    assert!(!text.contains("volume"), "{text}");
    assert_near(&shown(glsl, [50.0, 20.0], FrameInputs::default()), &[0.3, 0.15, 0.075]);
    let broken =
        scene_around("/*{ \"ISFVSN\": \"2\", \"INPUTS\": [ }*/ void main() { }", Shown::Picture).unwrap_err();
    assert!(broken.message.contains("JSON"), "{broken:?}");
}

#[test]
fn the_last_frame_is_read_by_its_names() {
    for name in ["backbuffer", "texPreviousFrame", "prevFrame"] {
        let glsl = format!(
            "uniform sampler2D {name}; uniform vec2 resolution;
            void main() {{ vec4 last = texture2D({name}, gl_FragCoord.xy / resolution);
                gl_FragColor = 0.9 * last + gl_FragCoord.x / 999.0; }}"
        );
        let scene = imported(&glsl);
        assert!(scene.textures.iter().any(|texture| texture.is_last_frame()), "{name}");
    }
}

/// Every image: red rises to the right, green downwards.
#[derive(Debug)]
struct Image;

impl TextureReader for Image {
    fn read(&self, _: u16, channel: u8, u: f32, v: f32) -> f32 {
        [u, v, 0.0, 1.0][usize::from(channel)]
    }
}

#[test]
fn a_scene_names_the_images_of_a_shader() {
    let isf = "/*{ \"ISFVSN\": \"2\", \"INPUTS\": [ { \"NAME\": \"inputImage\", \"TYPE\": \"image\" } ] }*/
        void main() { gl_FragColor = IMG_THIS_PIXEL(inputImage); }";
    let text = around(isf).text("a.glsl");
    assert!(text.contains("let inputImage = \"cover\""), "{text}");
    let named = "void mainImage(out vec4 c, in vec2 f) { c = texture(iChannel1, f / iResolution.xy); }";
    let scene =
        "include \"a.glsl\"\nlet iChannel1 = \"leaf.png\"\nsky { color = srgb(mainImage(pixel).rgb) }";
    for (scene, glsl) in [(text.as_str(), isf), (scene, named)] {
        let compiled = with_glsl(scene, glsl);
        let frame = FrameInputs { screen: SCREEN, textures: Some(Arc::new(Image)), ..FrameInputs::default() };
        let point = Point::at(100.0, 20.0, 0.0);
        let light = compiled.graph.evaluate(&compiled.sky.color, &point, &frame);
        // Images begin at the top, and hold light.
        assert_near(&light, &[0.5, 0.8, 0.0]);
        assert_eq!(compiled.textures.len(), 1, "{scene}");
    }
}

#[test]
fn pictures_are_named_where_black_or_a_noise_stands_for_them() {
    let glsl = "void mainImage(out vec4 c, in vec2 f) { vec2 uv = f / iResolution.xy;
        c = vec4(texture(iChannel0, uv).rgb, 1.0) + uv.x; }";
    assert_eq!(around(glsl).left_out, ["the pictures of `iChannel0`: black or a noise is drawn instead"]);
    let text = "include \"a.glsl\"\nsky { color = mainImage(pixel).rgb }";
    let compiled = compile("test.scene", text, &mut |_| Ok(glsl.to_owned()));
    let [warning] = compiled.warnings.as_slice() else { panic!("{:?}", compiled.warnings) };
    assert!(warning.message.contains("leaves out the pictures of `iChannel0`"), "{warning:?}");
    let flat = glsl.replace(" + uv.x", "");
    let problem = scene_around(&flat, Shown::Picture).unwrap_err();
    assert_eq!(problem.message, "without the pictures of `iChannel0` this shader draws one colour");
    // A read that tells what a channel is counts for the reads before it.
    let late = "void mainImage(out vec4 c, in vec2 f) { vec2 uv = f / iResolution.xy;
        c = vec4(texture(iChannel0, uv).x) + texture(iChannel0, vec2(uv.x, 0.25)).x; }";
    assert_eq!(around(late).left_out, Vec::<String>::new());
    assert_near(&shown(late, [1.0, 95.0], loud())[..1], &[1.0]);
}

#[test]
fn uniforms_with_names_that_a_scene_has_already_keep_a_value() {
    let glsl = "uniform float x, fn, let, t; uniform vec3 p; void main() {
        gl_FragColor = vec4(0.5 * x, p.y * fn * let * step(1.0, gl_FragCoord.x), 0.25 * t, 1.0); }";
    assert_near(&shown(glsl, [50.0, 20.0], FrameInputs::default()), &[0.5, 0.5, 0.5]);
}

#[test]
fn one_colour_is_told() {
    let glsl = "uniform vec2 windowSize; void main() { gl_FragColor = vec4(windowSize, 0.0, 1.0); }";
    let left_out = around(glsl).left_out.join("\n");
    assert!(left_out.contains("values of `windowSize`") && left_out.contains("one colour"), "{left_out}");
}

#[test]
fn a_small_figure_on_a_plain_ground_was_one_colour() {
    let glsl = "void mainImage(out vec4 c, in vec2 f) {
        vec2 q = f / iResolution.xy - 0.5 - 0.3 * vec2(cos(iTime), sin(iTime));
        c = mix(texture(iChannel0, f), vec4(1.0, 0.5, 0.0, 1.0), step(length(q), 0.06)); }";
    assert_eq!(around(glsl).left_out, ["the pictures of `iChannel0`: black or a noise is drawn instead"]);
}

#[test]
fn discarded_pixels_are_black() {
    let glsl = "float cut(vec2 a) { if (a.x < 0.5) { if (a.y < 0.5) discard; } return a.y; }
        void mainImage(out vec4 c, in vec2 f) { vec2 uv = f / iResolution.xy; c = vec4(1.0);
            for (int i = 0; i < 3; i++) { if (i == 2) c.y = cut(uv); } }";
    for (at, expected) in
        [([10.0, 10.0], [0.0; 3]), ([10.0, 80.0], [1.0, 0.8, 1.0]), ([150.0, 10.0], [1.0, 0.1, 1.0])]
    {
        let found = drawn("mainImage(pixel).rgb", glsl, at);
        assert_near(&found, &expected);
    }
}

#[test]
fn a_loop_that_counts_nothing_ends() {
    let glsl = "void mainImage(out vec4 c, in vec2 f) { float t = 0.0;
        while (true) { t += 0.001 * f.x; if (t > 1.0) break; } c = vec4(t); }";
    let around = around(glsl);
    assert!(around.left_out[0].contains("after the first 256"), "{around:?}");
    assert_near(&drawn("mainImage(pixel).rgb", glsl, [110.0, 1.0])[..1], &[1.1]);
    // What counts its rounds keeps them.
    let counted = "void mainImage(out vec4 c, in vec2 f) { float t = 0.0;
        for (int i = 0; i < 1000; i++) { t += 0.001; if (t > f.x) break; } c = vec4(t); }";
    assert_near(&drawn("mainImage(pixel).rgb", counted, [100.0, 1.0])[..1], &[1.0]);
}

#[test]
fn files_that_a_shader_includes_are_read_from_its_folder() {
    let glsl = "#include \"lib/ring.glsl\"\n#include <common>\n#include \"lib/ring.glsl\"\n\
        void mainImage(out vec4 c, in vec2 f) { c = vec4(ring(f.x), twice(0.2), 0.0, 1.0); }";
    let read = |name: &str| match name {
        "a.glsl" => Ok(glsl.to_owned()),
        "lib/ring.glsl" => {
            Ok("#include \"../deep.glsl\"\nfloat ring(float a) { return deep(a); }".to_owned())
        }
        "deep.glsl" => Ok("float deep(float a) { return a * 0.01; }".to_owned()),
        "common.glsl" => Ok("float twice(float a) { return 2.0 * a; }".to_owned()),
        other => Err(format!("there is no {other}")),
    };
    let text = "include \"a.glsl\"\nsky { color = mainImage(pixel).rgb }";
    let compiled = compile("test.scene", text, &mut |name| read(name));
    let scene = compiled.scene.unwrap_or_else(|| panic!("no scene"));
    assert_near(&color_on(&scene, [50.0, 0.0], SCREEN), &[0.5, 0.4, 0.0]);
    assert!(scene.includes.iter().any(|file| file == "deep.glsl"), "{:?}", scene.includes);
    // A mistake is marked where the text or its include stands.
    let report = |glsl: &str| {
        let compiled = compile("test.scene", text, &mut |name| {
            if name == "a.glsl" { Ok(glsl.to_owned()) } else { read(name) }
        });
        compiled.render(false)
    };
    let wrong = report(&glsl.replace("twice(0.2)", "missing"));
    assert!(wrong.contains("a.glsl:4") && wrong.contains("missing"), "{wrong}");
    let wrong =
        report("#include \"../secret.glsl\"\nvoid mainImage(out vec4 c, in vec2 f) { c = vec4(1.0); }");
    assert!(wrong.contains("a.glsl:1") && wrong.contains("is not in the folder of this shader"), "{wrong}");
}

#[test]
fn files_that_include_each_other_end() {
    let text = "#include \"a.glsl\"\nfloat f(vec3 p) { return 1.0; }\n";
    let all = whole(text, &mut |_| Some(text.to_owned()));
    assert_eq!(all.files, ["a.glsl"]);
    let mut count = 0;
    let endless = whole(text, &mut |_| {
        count += 1;
        Some(format!("#include \"b{count}.glsl\"\n#include \"c{count}.glsl\"\n"))
    });
    assert!(endless.files.len() <= LIMITS.scene_includes_max, "{}", endless.files.len());
    let mut reads = 0;
    let many = (0..9_000).map(|at| format!("#include \"{at}.glsl\"\n")).collect::<String>();
    whole(&many, &mut |_| {
        reads += 1;
        Some("x".repeat(LIMITS.scene_bytes_max + 1))
    });
    assert_eq!(reads, LIMITS.scene_includes_max, "a long file was read again and again");
    let place = endless.place(Span::new(endless.text.len() as u32 - 3, endless.text.len() as u32));
    assert!(place.end as usize <= text.len(), "{place:?}");
}

#[test]
fn a_number_that_names_a_sampler_overflowed_or_read_an_image_that_nobody_named() {
    let glsl =
        "void mainImage(out vec4 c, in vec2 f) { c = vec4(0.2) + texture(iChannel0, f / iResolution.xy); }";
    for number in ["1e30", "-1e30", "-2", "3"] {
        let text =
            format!("include \"a.glsl\"\nlet iChannel0 = {number}\nsky {{ color = mainImage(pixel).rgb }}");
        assert_near(&color_on(&with_glsl(&text, glsl), [10.0, 10.0], SCREEN), &[0.2, 0.2, 0.2]);
    }
}

#[test]
fn a_mask_of_the_upper_bits_of_a_negative_number_was_four_thousand_million_too_large() {
    let glsl = "void mainImage(out vec4 c, in vec2 f) { int a = int(floor(f.x)) - 15;
        c = vec4(float(a & ~7) / 64.0 + 0.5, 0.5, 0.5, 1.0); }";
    assert_near(&shown(glsl, [10.5, 3.0], FrameInputs::default()), &[0.5 - 8.0 / 64.0, 0.5, 0.5]);
}

#[test]
fn inputs_with_names_of_the_language_made_scenes_with_mistakes() {
    let input = |name: &str, kind: &str| format!("{{\"NAME\": \"{name}\", \"TYPE\": \"{kind}\"}}");
    let names = ["t", "p", "pixel", "then", "let", "beat", "glsl_value", "size", "size"];
    let mut inputs: Vec<String> = Vec::new();
    for kind in ["float", "image", "color"] {
        inputs.extend(names.iter().map(|name| input(name, kind)));
    }
    inputs.extend((0..100).map(|number| input(&format!("a{number}"), "float")));
    let range = ", \"TYPE\": \"float\", \"MIN\": 1e20, \"MAX\": 1e20, \"DEFAULT\": 1e300}";
    inputs.push(format!("{{\"NAME\": \"far\"{range}"));
    let header = format!("/*{{\"ISFVSN\": \"2\", \"INPUTS\": [{}]}}*/", inputs.join(", "));
    let glsl = format!("{header}\nvoid main() {{ gl_FragColor = vec4(isf_FragNormCoord, size, 1.0); }}");
    let scene = imported(&glsl);
    assert_eq!(scene.params.len(), LIMITS.scene_params_max);
}
