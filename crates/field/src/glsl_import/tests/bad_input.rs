//! Hostile and damaged texts end in a sentence.

use proptest::prelude::*;

use super::super::GlslFile;
use super::agreement::FIXTURES;
use super::{budget, executed};
use crate::lang::{Diagnostic, Fault};
use crate::limits::LIMITS;

/// The first problem of a text: of the file, or of a call of its functions.
fn first_problem(text: &str) -> Option<Diagnostic> {
    let file = match GlslFile::parse(text, &LIMITS) {
        Ok(file) => file,
        Err(problem) => return Some(problem),
    };
    let functions = file.functions().iter().filter(|function| function.is_callable());
    functions.filter_map(|function| executed(&file, function).err()).next()
}

fn refused(text: &str, kind: Fault) {
    let problem = first_problem(text);
    let start: String = text.chars().take(60).collect();
    let problem = problem.unwrap_or_else(|| panic!("accepted: {start}"));
    assert_eq!(problem.fault, kind, "{start}: {problem:?}");
    assert!(!problem.message.is_empty() && problem.message.len() < 400, "{problem:?}");
    assert!(problem.span.start <= problem.span.end && problem.span.end as usize <= text.len());
}

#[test]
fn exponential_functions_reach_a_limit() {
    let mut text = String::from("float f0(vec3 p) { return sin(p.x); }\n");
    for index in 1..=40 {
        let before = index - 1;
        text.push_str(&format!(
            "float f{index}(vec3 p) {{ return f{before}(p) + f{before}(p.yzx * 1.1); }}\n"
        ));
    }
    // The function with the most calls is the last one.
    let file = super::parsed(&text);
    let problem = executed(&file, file.functions().last().unwrap()).unwrap_err();
    assert_eq!(problem.fault, Fault::OverLimit);
}

#[test]
fn macros_that_expand_without_end_reach_a_limit() {
    let doubling = |start: &str, row: &dyn Fn(usize) -> String| {
        let mut text = format!("#define M0 {start}\n");
        for index in 1..=60 {
            text.push_str(&row(index));
        }
        text + "float f(vec3 p) { return M60; }\n"
    };
    let double = |index: usize| format!("#define M{index} M{} + M{}\n", index - 1, index - 1);
    refused(&doubling("p.x", &double), Fault::OverLimit);
    // Expands to nothing, very often.
    let nothing = |index: usize| format!("#define M{index} M{} M{}\n", index - 1, index - 1);
    refused(&doubling("", &nothing), Fault::OverLimit);
    let nested = "F(".repeat(5_000) + "1.0" + &")".repeat(5_000);
    refused(&format!("#define F(x) x\nfloat f(vec3 p) {{ return {nested}; }}"), Fault::OverLimit);
}

#[test]
fn macros_that_use_themselves_stay_names() {
    refused("#define A B\n#define B A\nfloat f(vec3 p) { return A; }", Fault::Malformed);
    refused("#define A(x) A(x) + 1.0\nfloat f(vec3 p) { return A(p.x); }", Fault::Malformed);
}

#[test]
fn long_and_endless_texts_reach_a_limit() {
    refused(&"float f(vec3 p) { return p.x; }\n".repeat(10 << 20 >> 5), Fault::OverLimit);
    refused(&"a ".repeat(LIMITS.scene_bytes_max / 2 - 1), Fault::OverLimit);
    let rounds =
        "float f(vec3 p) { float s = 0.0; for (int i = 0; i < 2147483647; i++) s += 1.0; return s; }";
    refused(rounds, Fault::OverLimit);
    refused("float f(vec3 p) { while (true) { p.x += 1.0; } return p.x; }", Fault::OverLimit);
    refused("float f(vec3 p) { float a[1000000000]; return a[0]; }", Fault::OverLimit);
    refused("float f(vec3 p) { float a[60000][60000]; return a[0][1]; }", Fault::OverLimit);
    refused(
        "float f(vec3 p) { float a[60000], b[60000], c[60000]; return a[0] + b[1] + c[2]; }",
        Fault::OverLimit,
    );
}

#[test]
fn deep_texts_reach_a_limit_before_the_stack_does() {
    let deep = |left: &str, right: &str| {
        let count = 20_000;
        format!("float f(vec3 p) {{ return {}p.x{}; }}", left.repeat(count), right.repeat(count))
    };
    for (left, right) in
        [("(", ")"), ("-", ""), ("!", ""), ("sin(", ")"), ("p.x + ", ""), ("p.x < 1.0 ? 1.0 : ", "")]
    {
        refused(&deep(left, right), Fault::OverLimit);
    }
    let body = |text: &str| format!("float f(vec3 p) {{ {} return 1.0; }}", text.repeat(20_000));
    refused(&body("if (p.x > 0.0) p.x = 1.0; else "), Fault::OverLimit);
    refused(&body("for (;;) "), Fault::OverLimit);
    refused(&(String::from("float f(vec3 p) ") + &"{".repeat(9_000) + &"}".repeat(9_000)), Fault::OverLimit);
    let mut calls = String::from("float f0(float a) { return a; }\n");
    for index in 1..400 {
        calls.push_str(&format!("float f{index}(float a) {{ return f{}(a); }}\n", index - 1));
    }
    refused(&calls, Fault::OverLimit);
    refused(&("#if 1\n".repeat(5_000) + "float f(vec3 p) { return 1.0; }"), Fault::OverLimit);
}

#[test]
fn forty_kilobytes_of_components_used_up_the_stack() {
    let body = |body: &str| format!("float f(vec3 p) {{ {body} }}");
    let chain = |link: &str, count: usize| body(&format!("mat4 m; return p{};", link.repeat(count)));
    refused(&chain(".xyz", 10_000), Fault::OverLimit);
    refused(&chain("[0]", 60_000), Fault::OverLimit);
    refused(&chain("[0].x", 20_000), Fault::OverLimit);
    refused(&body(&format!("return 0.{};", ".x".repeat(10_000))), Fault::OverLimit);
    // Each level has few links, but all levels together are deep.
    let levels = "p[int(".repeat(50) + "0.0" + &(String::from(")]") + &".x".repeat(90)).repeat(50);
    refused(&body(&format!("return {levels};")), Fault::OverLimit);
    let inner: String = (1..2_000).map(|at| format!("struct S{at} {{ S{} a; }};\n", at - 1)).collect();
    refused(&(String::from("struct S0 { float a; };\n") + &inner), Fault::OverLimit);
    assert_eq!(first_problem(&body("mat4 m; return p.xyz.zyx.x + m[0][1];")), None);
}

#[test]
fn brackets_without_semicolons_were_searched_to_the_end_of_the_file_for_each() {
    refused(&format!("float f(vec3 p) {{ {} }}", "{a b}".repeat(90_000)), Fault::Malformed);
    let names: Vec<String> = (0..90_000).map(|at| format!("a{at}")).collect();
    refused(&format!("#define F({}) 1\n", names.join(",")), Fault::OverLimit);
}

#[test]
fn large_files_with_a_mistake_in_each_function_end_soon() {
    let text: String = (0..12_000)
        .map(|index| format!("float f{index}(vec3 p) {{ return p.x + lost{index}; }}\n"))
        .collect();
    refused(&text, Fault::Malformed);
}

#[test]
fn structs_that_double_in_size_have_no_values() {
    let mut text = String::from("struct S0 { float a; };\n");
    for index in 1..60 {
        text.push_str(&format!("struct S{index} {{ S{0} a; S{0} b; }};\n", index - 1));
    }
    refused(&(text + "float f(vec3 p) { S59 s; return p.x; }"), Fault::OverLimit);
}

#[test]
fn damaged_texts_are_malformed() {
    for text in [
        "float f(vec3 p) { return 1e999; }",
        "float f(vec3 p) { return p.x +; }",
        "float f(vec3 p) { return p.x;",
        "float f(vec3 p) } return p.x; {",
        "float f(vec3 p) { return p.q; }",
        "float f(vec3 p { return 1.0; }",
        "/* no end",
        "#if 1\nfloat f(vec3 p) { return 1.0; }",
        "#endif",
        "#error no",
        "float f(vec3 p) { return é; }",
        "x",
        "42",
        "float f(vec3 p) { float a[2]; return a[5]; }",
    ] {
        refused(text, Fault::Malformed);
    }
    for text in ["", "\u{feff}", "\n\n", "#version 300 es\nprecision highp float;", ";;;"] {
        assert_eq!(first_problem(text), None, "{text:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn changed_fixtures_never_panic(which in 0_usize..3, cuts in prop::collection::vec((0.0_f64..1.0, 0_usize..40, 0_usize..12), 1..4)) {
        const PIECES: [&str; 12] = ["", "(", ")", "{", "}", ";", " 0 ", " if ", "[", " float x", "\n#define p q\n", "1e9"];
        let mut text = FIXTURES[which].1.to_owned();
        for (at, length, piece) in cuts {
            let mut start = (at * text.len() as f64) as usize;
            while !text.is_char_boundary(start) { start -= 1; }
            let mut end = (start + length).min(text.len());
            while !text.is_char_boundary(end) { end += 1; }
            text.replace_range(start..end, PIECES[piece]);
        }
        if let Some(problem) = first_problem(&text) {
            prop_assert!(problem.span.end as usize <= text.len());
        }
    }

    #[test]
    fn junk_never_panics(text in "[a-z0-9(){}\\[\\];,.+*/<>=!&|?:#\"\\\\ \n-]{0,200}") {
        let _ = first_problem(&text);
        let _ = budget();
    }
}
