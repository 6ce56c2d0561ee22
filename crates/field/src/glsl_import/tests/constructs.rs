//! Types, globals, uniforms, textures and messages of GLSL in scenes.

use super::super::GlslType;
use super::{budget, executed, parsed, values};
use crate::graph::{Graph, Input, Node, Op};
use crate::lang::Fault;
use crate::limits::LIMITS;

fn value(text: &str, name: &str, p: [f32; 3]) -> Vec<f32> {
    let file = parsed(text);
    let function = file.functions().iter().find(|function| function.name == name).unwrap();
    let (graph, nodes) = executed(&file, function).unwrap_or_else(|problem| panic!("{problem:?}"));
    values(&graph, &nodes, &[p]).remove(0)
}

/// The problem with a function's call, and the text that it marks.
fn problem(text: &str, name: &str) -> (Fault, String, String) {
    let file = parsed(text);
    let function = file.functions().iter().find(|function| function.name == name).unwrap();
    let problem = executed(&file, function).unwrap_err();
    let marked = &text[problem.span.start as usize..problem.span.end as usize];
    (problem.fault, problem.message, marked.to_owned())
}

#[test]
fn a_choice_of_the_nearer_shape_is_a_minimum() {
    let file = parsed(
        "vec2 opU(vec2 a, vec2 b) { return a.x < b.x ? a : b; }
         vec2 map(vec3 p) { vec2 r = vec2(p.y, 1.0); r = opU(r, vec2(length(p) - 1.0, 2.0));
             float d = abs(p.x) - 0.1; if (d < r.x) r = vec2(d, 3.0); return r; }",
    );
    let (graph, nodes) = executed(&file, &file.functions()[1]).unwrap();
    assert!(matches!(graph.node(nodes[0]), Node::Binary(Op::Min, ..)), "{:?}", graph.node(nodes[0]));
}

/// naga repeats the vector for each column, so the second interpreter cannot check this.
#[test]
fn a_matrix_of_one_vector_takes_its_components_in_order() {
    let text = "float f(vec3 p) { mat2 m = mat2(vec4(1.0, 2.0, 3.0, 4.0)); return m[0].y * 10.0 + m[1].x; }";
    assert_eq!(value(text, "f", [0.0; 3]), [23.0]);
    let rotated = "float f(vec3 p) { return (mat2(vec4(1.0, 2.0, 3.0, 4.0)) * vec2(0.0, 1.0)).x; }";
    assert_eq!(value(rotated, "f", [0.0; 3]), [3.0]);
}

#[test]
fn a_call_does_not_change_the_globals_of_the_next_call() {
    let text = "float count = 1.0; float next(vec3 p) { count += p.x; return count; }";
    let file = parsed(text);
    let function = &file.functions()[0];
    let mut graph = Graph::new();
    let arguments = vec![[Input::X, Input::Y, Input::Z].map(|input| graph.input(input)).to_vec()];
    let mut session = super::GlslSession::default();
    let mut call = || session.call(&file, function, &arguments, &mut graph, &mut budget(), &[]).unwrap();
    assert_eq!(call(), call());
}

#[test]
fn uniforms_have_the_values_of_a_viewer_of_shaders() {
    let text = "uniform float u_time; uniform vec2 resolution;
        float a(vec3 p) { return iTime + u_time; }
        float b(vec3 p) { return iResolution.x / iResolution.y + resolution.y; }
        float c(vec3 p) { return iMouse.x + iMouse.z + float(iFrame); }";
    let file = parsed(text);
    let (graph, nodes) = executed(&file, &file.functions()[0]).unwrap();
    assert!(graph.order(&nodes).iter().any(|&node| graph.node(node) == Node::Input(Input::T)));
    assert_eq!(value(text, "b", [0.0; 3]), [1280.0 / 720.0 + 720.0]);
    assert_eq!(value(text, "c", [0.0; 3]), [0.0]);
}

#[test]
fn a_uniform_without_a_value_is_a_mistake_where_it_is_read() {
    let text = "uniform float strength; float unused(vec3 p) { return p.x; }
        float used(vec3 p) { return p.x * strength; }";
    assert_eq!(value(text, "unused", [2.0, 0.0, 0.0]), [2.0]);
    let (kind, message, _) = problem(text, "used");
    assert_eq!(kind, Fault::Unsupported);
    assert!(message.contains("`strength`"), "{message}");
    assert_eq!(parsed(text).open_uniforms(), [("strength", 1)]);
}

#[test]
fn globals_that_a_drawing_function_sets_have_its_value() {
    let text = "float tt; float glow; float map(vec3 p) { glow += 1.0; return p.x + tt; }
        void mainImage(out vec4 c, in vec2 f) { tt = 3.0 * 2.0; glow = 0.5; vec2 uv = f; c = vec4(map(vec3(uv, 0.0))); }";
    assert_eq!(value(text, "map", [1.0, 0.0, 0.0]), [7.0]);
    assert!(parsed(text).globals.has_drawing);
}

#[test]
fn a_table_of_noise_becomes_a_noise_without_seams() {
    let text = "float noise(in vec3 x) { vec3 p = floor(x), f = fract(x); f = f * f * (3.0 - 2.0 * f);
        vec2 uv = (p.xy + vec2(37.0, 17.0) * p.z) + f.xy;
        vec2 rg = textureLod(iChannel0, (uv + 0.5) / 256.0, 0.0).yx; return mix(rg.x, rg.y, f.z); }
        float solid(vec3 x) { return texture(iChannel1, x / 32.0).x; }";
    for name in ["noise", "solid"] {
        let at = |z: f32| value(text, name, [0.37, 0.81, z])[0];
        for z in [1.0, 2.0, -3.0, 7.5] {
            assert!((at(z - 1e-4) - at(z + 1e-4)).abs() < 1e-2, "{name} jumps at {z}");
        }
        let spread: Vec<f32> = (0..40).map(|index| at(index as f32 + 0.5)).collect();
        assert!(spread.iter().all(|value| (0.0..=1.0).contains(value)), "{spread:?}");
        let (low, high) =
            (spread.iter().copied().fold(1.0, f32::min), spread.iter().copied().fold(0.0, f32::max));
        assert!(high - low > 0.3, "{name} is flat: {low}..{high}");
    }
}

#[test]
fn pictures_have_no_meaning_in_a_shape() {
    let (kind, message, marked) = problem("float f(vec3 p) { return texture(iChannel0, p.xy).x; }", "f");
    assert_eq!((kind, message.as_str()), (Fault::Unsupported, "a shape cannot read a picture"));
    assert!(marked.contains("texture"), "{marked}");
}

#[test]
fn a_mistake_in_one_function_leaves_the_others() {
    let text = "float bad(vec3 p) { return p.x + missing; }\nfloat good(vec3 p) { return p.y; }\n\
        float uses(vec3 p) { return bad(p); }";
    assert_eq!(value(text, "good", [0.0, 2.0, 0.0]), [2.0]);
    for name in ["bad", "uses"] {
        let (kind, message, marked) = problem(text, name);
        assert_eq!(kind, Fault::Malformed);
        assert_eq!(message, "there is no `missing` here");
        assert_eq!(marked, "missing");
    }
}

#[test]
fn typos_are_named_by_their_signs_and_have_suggestions() {
    for (text, message, marked) in [
        ("float f(vec3 p) { float a = p.x\n return a; }", "`return` does not belong here", "return"),
        ("float f(vec3 p) { return p.x }", "`}` does not belong here", "}"),
        ("float f(vec3 p) { return p.x > 0.0 && && p.y > 0.0; }", "`&&` does not belong here", "&&"),
        (
            "float fold(float a) { return a; }\nfloat f(vec3 p) { return fodl(p.x); }",
            "there is no function `fodl`",
            "fodl",
        ),
    ] {
        let (kind, found, place) = problem(text, "f");
        assert_eq!(kind, Fault::Malformed, "{text}");
        assert!(found.starts_with(message) && place.starts_with(marked), "{text}: {found} at {place}");
    }
}

#[test]
fn functions_that_naga_lacks_are_there() {
    let text =
        "float f(vec3 p) { float whole; float part = modf(p.x, whole); return ldexp(part, 3) + whole; }";
    assert_eq!(value(text, "f", [2.25, 0.0, 0.0]), [4.0]);
    assert_eq!(value(text, "f", [-2.25, 0.0, 0.0]), [-4.0]);
}

#[test]
fn places_are_right_after_macros_comments_and_joined_lines() {
    let text = "/* two\n lines */ #define A(x) ((x) * \\\n 2.0)\n#define B 3.0\n\
        float f(vec3 p) { float a = A(p.x); // é\n return a + B + nothing; }";
    let (_, _, marked) = problem(text, "f");
    assert_eq!(marked, "nothing");
    let text = "#define WRONG(x) (x + nowhere)\nfloat f(vec3 p) { return WRONG(p.x); }";
    assert_eq!(problem(text, "f").2, "WRONG");
}

#[test]
fn functions_with_types_that_scenes_lack_are_listed_but_not_callable() {
    let text =
        "struct S { float a; }; S make(vec3 p) { return S(p.x); } void out_only(out float a) { a = 1.0; }
        mat3 turn(vec3 a) { return mat3(a.x); } bool inside(vec3 p, int n) { return p.x > float(n); }";
    let file = parsed(text);
    let callable: Vec<bool> = file.functions().iter().map(|function| function.is_callable()).collect();
    assert_eq!(callable, [false, false, false, true]);
    let inside = &file.functions()[3];
    assert_eq!(inside.result, Some(GlslType::Bool));
    assert_eq!(inside.to_string(), "inside(p: vec3, n: whole number)");
}

#[test]
fn unsupported_constructs_have_their_own_messages() {
    let cases = [
        ("float f(vec3 p) { return f(p) + 1.0; }", "calls itself"),
        ("float f(vec3 p) { return dFdx(p.x); }", "compare pixels"),
        ("float f(vec3 p) { if (p.x > 0.0) discard; return 1.0; }", "`discard`"),
        ("float f(vec3 p) { return float(bitCount(int(p.x))); }", "the bits of a whole number"),
        ("float g(vec3 p); float f(vec3 p) { return g(p); }", "has no body"),
    ];
    for (text, expected) in cases {
        let (kind, message, _) = problem(text, "f");
        assert!(message.contains(expected), "{text}: {message}");
        assert!(kind != Fault::OverLimit, "{text}");
    }
}

#[test]
fn bits_of_whole_numbers_that_depend_on_the_point_were_refused() {
    for (expression, of) in [
        ("a ^ b", (|a, b| a ^ b) as fn(i32, i32) -> i32),
        ("a & b", |a, b| a & b),
        ("a | b", |a, b| a | b),
        ("a & 0x3f0", |a, _| a & 0x3f0),
        ("(a >> (b & 7)) & 5", |a, b| (a >> (b & 7)) & 5),
        ("(a << 3) ^ a", |a, _| (a << 3) ^ a),
        ("b | (a & 15) << 4", |a, b| b | (a & 15) << 4),
    ] {
        let text =
            format!("float f(vec3 p) {{ int a = int(p.x), b = int(p.y); return float({expression}); }}");
        for (a, b) in [(0, 0), (12, 10), (1023, 511), (40_000, 21_845), (-5, 3), (-7, -12), (6, -1)] {
            assert_eq!(
                value(&text, "f", [a as f32, b as f32, 0.0]),
                [of(a, b) as f32],
                "{expression} of {a}, {b}"
            );
        }
    }
}

/// Products of 32 bits are no numbers of a formula; what a hash makes of them is random in any case.
#[test]
fn hashes_of_whole_numbers_become_other_random_numbers() {
    for hash in [
        "int n = int(p.x) + int(p.y) * 57; n = (n << 13) ^ n;
         return float((n * (n * n * 15731 + 789221) + 1376312589) & 0x7fffffff) / 2147483648.0;",
        "uint n = uint(p.x) * 747796405u + uint(p.y) * 2891336453u; n = ((n >> 16u) ^ n) * 277803737u;
         return float((n >> 22u) ^ n) / 4294967295.0;",
        "uvec2 q = floatBitsToUint(p.xy); uint h = q.x * 1664525u + q.y; h ^= h >> 16u;
         return uintBitsToFloat((h >> 9u) | 0x3f800000u) - 1.0;",
    ] {
        let text = format!("float f(vec3 p) {{ {hash} }}");
        let values: Vec<f32> =
            (0..400).map(|at| value(&text, "f", [(at % 20) as f32, (at / 20) as f32, 0.0])[0]).collect();
        assert!(values.iter().all(|value| (0.0..=1.0).contains(value)), "{hash}");
        let mean = values.iter().sum::<f32>() / 400.0;
        let near = values.windows(2).filter(|pair| (pair[0] - pair[1]).abs() < 0.1).count();
        assert!((mean - 0.5).abs() < 0.06 && (30..130).contains(&near), "{hash}: mean {mean}, {near} near");
    }
}

#[test]
fn small_limits_end_in_errors_of_their_own() {
    let file = parsed(
        "float f(vec3 p) { float s = 0.0; for (int i = 0; i < 100; i++) s += sin(p.x + s); return s; }",
    );
    let function = &file.functions()[0];
    for (steps, rounds_max, memory_max) in [(100, 4096, 4096), (1 << 20, 10, 4096), (1 << 20, 4096, 1)] {
        let mut graph = Graph::with_limits(&LIMITS);
        let arguments = vec![[Input::X, Input::Y, Input::Z].map(|input| graph.input(input)).to_vec()];
        let mut budget = super::Budget { steps, rounds_max, memory_max };
        let result =
            super::GlslSession::default().call(&file, function, &arguments, &mut graph, &mut budget, &[]);
        assert_eq!(result.unwrap_err().fault, Fault::OverLimit);
    }
}
