//! Scenes that include GLSL.

use super::super::{Compiled, Fault, compile};
use super::distance;
use crate::glsl_import::{Shown, scene_around};

fn with_glsl(scene: &str, glsl: &str) -> Compiled {
    compile("test.scene", scene, &mut |name| match name {
        "a.glsl" => Ok(glsl.to_owned()),
        "b.frag" => Ok("float twin(vec3 p) { return p.z; }\nfloat other(float a) { return a; }".to_owned()),
        other => Err(format!("there is no {other}")),
    })
}

fn value(scene: &str, glsl: &str, at: [f32; 3]) -> f32 {
    let compiled = with_glsl(scene, glsl);
    let scene = compiled.scene.as_ref().unwrap_or_else(|| panic!("{}", compiled.render(false)));
    distance(scene, at)
}

/// The first mistake: its kind, its message, and the file and line of its place.
fn mistake(scene: &str, glsl: &str) -> (Fault, String, String) {
    let compiled = with_glsl(scene, glsl);
    let first = compiled.diagnostics.first().unwrap_or_else(|| panic!("no mistake found in {scene}"));
    let place = compiled.sources.place(first.span.start).unwrap();
    (first.fault, first.message.clone(), format!("{}:{}", place.file.name, place.line))
}

const HEAD: &str = "include \"a.glsl\"\nobject a { shape = ";

#[test]
fn functions_of_a_glsl_file_are_functions_of_the_scene() {
    let scene = format!("{HEAD}map(p).x }}");
    assert_eq!(
        value(&scene, "vec2 map(vec3 p) { return vec2(length(p) - 1.0, 2.0); }", [0.0, 3.0, 0.0]),
        2.0
    );
}

#[test]
fn overloads_are_chosen_by_the_types_of_the_arguments() {
    let glsl =
        "float f(float a) { return 1.0; } float f(vec2 a) { return 2.0; } float f(vec3 a) { return 3.0; }
        float f(vec3 a, int n) { return float(n) / 2.0; } float g(vec3 a, bool b) { return b ? a.y : 0.0; }";
    for (call, expected) in [
        ("f(x)", 1.0),
        ("f(p.xy)", 2.0),
        ("f(p)", 3.0),
        ("f(2, 5)", 2.5),
        ("f(p, 7)", 3.5),
        ("g(2, x < 1)", 2.0),
    ] {
        assert_eq!(value(&format!("{HEAD}{call} }}"), glsl, [0.0; 3]), expected, "{call}");
    }
}

#[test]
fn a_function_of_the_file_hides_the_library_where_its_parameters_fit() {
    let glsl = "float sphere(vec3 p, float r) { return 42.0; } float min(vec3 a) { return 5.0; }";
    assert_eq!(value(&format!("{HEAD}sphere(p, 1) }}"), glsl, [0.0; 3]), 42.0);
    assert_eq!(value(&format!("{HEAD}min(3, 7, 2) }}"), glsl, [0.0; 3]), 2.0);
    let own = format!("fn sphere(a, b) = 7\n{HEAD}sphere(p, 1) }}");
    assert_eq!(value(&own, glsl, [0.0; 3]), 7.0);
}

#[test]
fn parameters_and_lets_of_the_scene_set_uniforms() {
    let glsl = "uniform float size; uniform vec2 bass_and_time; uniform float kept = 4.0;
        float map(vec3 p) { return p.x * size + bass_and_time.y + kept + iTime; }";
    let scene = format!(
        "param size = 3 in 0 .. 5\nlet bass_and_time = vec2(bass, 2 * t)\nlet iTime = 100\n{HEAD}map(p) }}"
    );
    // The time of the tests' frame is 2.
    assert_eq!(value(&scene, glsl, [10.0, 0.0, 0.0]), 30.0 + 4.0 + 4.0 + 100.0);
}

#[test]
fn mistakes_point_into_the_glsl() {
    let scene = format!("{HEAD}map(p) }}");
    let (fault, message, place) = mistake(&scene, "\nfloat map(vec3 p) {\n  return missing;\n}");
    assert_eq!((fault, place.as_str()), (Fault::Malformed, "a.glsl:3"), "{message}");
    let (fault, message, place) = mistake(&scene, "float map(vec3 p) {\n return 1.0;\n");
    assert_eq!((fault, place.as_str()), (Fault::Malformed, "a.glsl:1"), "{message}");
    let (fault, _, place) = mistake(&scene, "float map(vec3 p) {\n\n return texture(iChannel0, p.xy).x; }");
    assert_eq!((fault, place.as_str()), (Fault::Unsupported, "a.glsl:3"));
    let endless = "float map(vec3 p) {\n for (;;) p.x += 1.0;\n return p.x; }";
    assert_eq!(mistake(&scene, endless).0, Fault::OverLimit);
}

#[test]
fn calls_that_do_not_fit_name_the_declarations() {
    let glsl = "float map(vec3 p, float a) { return p.x; } void change(inout vec3 p) { p.x = 1.0; }";
    let (fault, message, place) = mistake(&format!("{HEAD}map(p) }}"), glsl);
    assert_eq!((fault, place.as_str()), (Fault::Malformed, "test.scene:2"));
    assert_eq!(message, "`map` cannot be called with a vec3");
    let compiled = with_glsl(&format!("{HEAD}map(p) }}"), glsl);
    assert!(compiled.render(false).contains("map(p: vec3, a: number)"), "{}", compiled.render(false));
    let (fault, message, _) = mistake(&format!("{HEAD}change(p) }}"), glsl);
    assert_eq!(fault, Fault::Unsupported);
    assert!(message.contains("only from GLSL"), "{message}");
}

#[test]
fn two_files_with_the_same_function_are_told_apart() {
    let scene = "include \"a.glsl\"\ninclude \"b.frag\"\nobject a { shape = twin(p) }";
    let (_, message, _) = mistake(scene, "float twin(vec3 p) { return p.x; }");
    assert!(message.contains("two GLSL files"), "{message}");
    let other = "include \"a.glsl\"\ninclude \"b.frag\"\nobject a { shape = other(x) + twin(p.xy) }";
    assert_eq!(value(other, "float twin(vec2 p) { return p.y; }", [1.0, 2.0, 0.0]), 3.0);
}

#[test]
fn a_scene_is_fixed_where_glsl_reads_the_time() {
    let scene = format!("param a = f(1)\n{HEAD}length(p) - a }}");
    assert!(with_glsl(&scene, "float f(float a) { return a * 0.5; }").scene.is_some());
    assert_eq!(mistake(&scene, "float f(float a) { return a * iTime; }").0, Fault::Unsupported);
}

#[test]
fn an_imported_shader_is_a_scene_without_mistakes() {
    let glsl = "uniform float strength; uniform vec4 levels; float glow;
        vec2 near(vec2 a, vec2 b) { return a.x < b.x ? a : b; }
        vec2 map(vec3 p) { glow += 1.0; vec2 r = near(vec2(p.y + 1.0, 1.0), vec2(length(p) - strength, 2.0));
            return near(r, vec2(length(p - vec3(2.0, 0.0, levels.x)) - 0.5, 3.5)); }
        void mainImage(out vec4 c, in vec2 f) { glow = 0.0; c = texture(iChannel0, f); }";
    let around = scene_around(glsl, Shown::Shape).unwrap();
    let compiled = with_glsl(&around.text("a.glsl"), glsl);
    let scene = compiled
        .scene
        .as_ref()
        .unwrap_or_else(|| panic!("{}\n{}", compiled.render(false), around.text("a.glsl")));
    assert!(
        around.text("a.glsl").contains("number < 1.5") && around.text("a.glsl").contains("number < 2.75"),
        "{}",
        around.text("a.glsl")
    );
    let [x, y, z] = scene.camera.position.map(|node| scene.graph.as_constant(node).unwrap());
    assert!(distance(scene, [x, y, z]) > 0.5, "the camera is in a shape: {}", around.text("a.glsl"));
    let left_out = around.left_out.join("\n");
    assert!(left_out.contains("mainImage") && left_out.contains("`glow`"), "{left_out}");
    let none = scene_around("float noise(vec2 p) { return p.x; }", Shown::Picture).unwrap_err();
    assert!(none.hint.as_deref().unwrap_or_default().contains("noise"), "{none:?}");
}

/// A whole text, without an include.
fn whole(text: &str) -> Compiled {
    compile("folder/test.scene", text, &mut |name| match name {
        "near.glsl" => Ok("float near = 2.0;".to_owned()),
        other => Err(format!("there is no {other}")),
    })
}

#[test]
fn a_text_in_glsl_is_the_scene_that_an_import_makes_of_it() {
    for (text, objects) in [
        ("void mainImage(out vec4 c, in vec2 f) { c = vec4(f / iResolution.xy, 0.5, 1.0); }", 0),
        (
            "\u{feff}// a ball\n#define R \\\n 2.0\n/* of\nradius R */ float map(vec3 p) { return length(p) - R; }",
            1,
        ),
        ("#include \"near.glsl\"\nfloat map(vec3 p) { return length(p) - near; }", 1),
        (
            "float map(vec3 p) { return length(p) - 1.0; }\n/* see https://mariana.example */\n  #ifdef A\n  #endif",
            1,
        ),
        (
            "#version 330\nlayout(location = 0) out vec4 c; void main() { c = vec4(gl_FragCoord.xy / 9e2, 0, 1); }",
            0,
        ),
    ] {
        let compiled = whole(text);
        let scene = compiled.scene.as_ref().unwrap_or_else(|| panic!("{text}\n{}", compiled.render(false)));
        assert_eq!(scene.objects.len(), objects, "{text}");
        let body = scene_around(text.trim_start_matches('\u{feff}'), Shown::default());
        if let (1, Ok(body)) = (objects, body) {
            let imported = with_glsl(&body.text("a.glsl"), text);
            let at = [0.3, 2.5, -1.0];
            assert_eq!(distance(scene, at), distance(&imported.scene.unwrap(), at), "{text}");
        }
    }
}

#[test]
fn mistakes_in_a_text_in_glsl_are_reported_at_its_lines() {
    for (text, line, wanted) in [
        ("float map(vec3 p) {\n  return lenth(p) - 1.0;\n}", 2, "lenth"),
        ("float map(vec3 p) {\n  float r = 1.0;\n  return length(p) - r\n}", 4, "`}` does not belong here"),
        ("void mainImage(out vec4 c, in vec2 f) {\n  c = vec4(1);\n  c.x =", 1, "never closed"),
        ("float halved(float a) { return a / 2.0; }", 1, "no function of this file looks like the distance"),
    ] {
        let compiled = whole(text);
        let all: Vec<_> = compiled.diagnostics.iter().map(|one| one.message.clone()).collect();
        let first = compiled.diagnostics.first().unwrap_or_else(|| panic!("no mistake found in {text}"));
        let place = compiled.sources.place(first.span.start).unwrap();
        assert_eq!(
            (all.len(), place.file.name.as_str(), place.line),
            (1, "folder/test.scene", line),
            "{all:?}"
        );
        assert!(first.message.contains(wanted), "{all:?}");
    }
}

#[test]
fn what_the_scene_of_a_shader_leaves_out_is_a_warning() {
    let compiled = whole("uniform float speed;\nfloat map(vec3 p) { return length(p) - speed; }");
    let warning = compiled.warnings.first().map(|warning| warning.message.as_str()).unwrap_or_default();
    assert!(warning.contains("leaves out values of `speed`"), "{warning}");
}

#[test]
fn a_scene_is_not_taken_for_glsl() {
    for text in [
        "# void main() {\nlength(p) - 1",
        "vec3(1).x - length(p)",
        "#define\n",
        "",
        "floaty",
        "const float R = 2.0;\nobject ball { shape = length(p) - R }",
        "uniform float a;\nlet b = a;",
        "float r = 1.0;\nlength(p) - r",
        "float f(vec3 p) { 1 }",
    ] {
        let messages: Vec<_> = whole(text).diagnostics.into_iter().map(|one| one.message).collect();
        assert!(!messages.iter().any(|message| message.contains("function of this file")), "{messages:?}");
    }
}
