//! Functions of GLSL files, run by the driver and as expressions of a scene that includes the file. The driver has its
//! own front end, so it shares no mistake with naga.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use crate::support::expression::Random;
use mariana::gpu::headless::Headless;
use mariana_field::graph::{FrameInputs, Point};
use mariana_field::lang::compile;
use mariana_testing::probe::{List, drawn};

const FILES: [(&str, &str); 3] = [
    ("control.glsl", include_str!("../../crates/field/src/glsl_import/tests/fixtures/control.glsl")),
    ("values.glsl", include_str!("../../crates/field/src/glsl_import/tests/fixtures/values.glsl")),
    ("functions.glsl", include_str!("../../crates/field/src/glsl_import/tests/fixtures/functions.glsl")),
];
/// Replacements for words that GLSL 4.30 reserves and that people use as names in shaders for WebGL.
const RENAMED: [(&str, &str); 4] =
    [("sample(", "sampled("), ("buffer", "taken"), ("flat ", "level "), ("#ifdef GL_ES", "#if 1")];
const HEAD: &str = "#version 430 core
layout(location = 0) out vec4 color;
uniform samplerBuffer points;
";
const POINTS: usize = 1000;
/// Largest difference, relative to values above 1.
const TOLERANCE: f32 = 1e-4;
/// llvmpipe computes arcs from polynomials with errors of 2e-4.
const TOLERANCE_OF_ARCS: (&str, f32) = ("trigonometry", 6e-4);
/// For x below 0, this function computes remainders of negative numbers, which GLSL leaves undefined.
const DEFINED_FROM_ZERO: &str = "whole_numbers";
/// Number of points that may be at a jump, where the last bit of an operand decides.
const JUMPS: usize = POINTS / 100;

/// A function of a point.
struct Function<'a> {
    name: &'a str,
    components: usize,
    is_truth: bool,
}

/// The functions of a file that take a point.
fn functions(text: &str) -> Vec<Function<'_>> {
    let function = |line: &'_ str| -> Option<(String, String)> {
        let (head, _) = line.split_once("(vec3 p) {")?;
        let (kind, name) = head.split_once(' ')?;
        Some((kind.to_owned(), name.to_owned()))
    };
    let named = text.lines().filter_map(|line| {
        let (kind, name) = function(line)?;
        let components = match kind.as_str() {
            "float" | "bool" => 1,
            "vec2" => 2,
            "vec3" => 3,
            "vec4" => 4,
            _ => return None,
        };
        let start = line.find(&name)?;
        Some(Function { name: &line[start..start + name.len()], components, is_truth: kind == "bool" })
    });
    named.collect()
}

/// The values by the driver: for each function, those at all points.
fn driven(context: &Headless, text: &str, functions: &[Function], points: &[[f32; 3]]) -> Vec<Vec<[f32; 4]>> {
    let lines: String =
        text.lines().filter(|line| !line.starts_with("#version")).map(|line| format!("{line}\n")).collect();
    let text = RENAMED.iter().fold(lines, |text, (word, other)| text.replace(word, other));
    let cases = functions.iter().enumerate().map(|(row, Function { name, components, is_truth })| {
        let value = if *is_truth { format!("float({name}(p))") } else { format!("{name}(p)") };
        let rest = ", 0.0".repeat(4 - components);
        format!("    if (row == {row}) color = vec4({value}{rest});\n")
    });
    let cases: String = cases.collect();
    let fragment = format!(
        "{HEAD}{text}\nvoid main() {{\n    vec3 p = texelFetch(points, int(gl_FragCoord.x)).xyz;\n    \
         int row = int(gl_FragCoord.y);\n    color = vec4(0.0);\n{cases}}}\n"
    );
    let size = (points.len() as u32, functions.len() as u32);
    let vectors: Vec<_> = points.iter().map(|p| [p[0], p[1], p[2], 0.0]).collect();
    let pixels = drawn(context.gl(), &fragment, size, &[("points", List::Vectors(&vectors))]);
    pixels.chunks(points.len()).map(<[[f32; 4]]>::to_vec).collect()
}

/// The values by the expression graph of a scene that includes the file.
fn included(file: (&str, &str), function: &Function, points: &[[f32; 3]]) -> Vec<[f32; 4]> {
    let name = function.name;
    let mut values = vec![[0.0; 4]; points.len()];
    for component in 0..function.components {
        let value = match (function.components, function.is_truth) {
            (1, true) => format!("if {name}(p) then 1 else 0"),
            (1, false) => format!("{name}(p)"),
            _ => format!("{name}(p).{}", ["x", "y", "z", "w"][component]),
        };
        let text = format!("include \"{}\"\nobject it {{ shape = {value} }}", file.0);
        let compiled = compile("test.scene", &text, &mut |_| Ok(file.1.to_owned()));
        let scene = compiled.scene.as_ref().unwrap_or_else(|| panic!("{name}: {}", compiled.render(false)));
        let root = [scene.objects[0].shape];
        let order = scene.graph.order(&root);
        for (found, [x, y, z]) in values.iter_mut().zip(points) {
            let point = Point::at(*x, *y, *z);
            found[component] = scene.graph.evaluate_in(&order, &root, &point, &FrameInputs::default())[0];
        }
    }
    values
}

#[test]
fn included_functions_have_the_values_that_the_driver_computes() {
    let context = Headless::new(false).unwrap();
    let mut random = Random(37);
    let points: Vec<[f32; 3]> =
        (0..POINTS).map(|_| std::array::from_fn(|_| random.between(-1.5, 1.5))).collect();
    let (mut compared, mut wrong) = (0, Vec::new());
    for file in FILES {
        let functions = functions(file.1);
        let driven = driven(&context, file.1, &functions, &points);
        for (function, driven) in functions.iter().zip(&driven) {
            let included = included(file, function, &points);
            let usable =
                |values: &[f32; 4]| values.iter().all(|value| value.is_finite() && value.abs() < 1e6);
            let tolerance = match TOLERANCE_OF_ARCS {
                (name, tolerance) if name == function.name => tolerance,
                _ => TOLERANCE,
            };
            let is_defined = |[x, ..]: &[f32; 3]| *x >= 0.0 || function.name != DEFINED_FROM_ZERO;
            let differs = |(a, b): (&f32, &f32)| (a - b).abs() > tolerance * a.abs().max(1.0) || b.is_nan();
            let pairs = driven
                .iter()
                .zip(&included)
                .zip(&points)
                .filter(|((driven, _), point)| usable(driven) && is_defined(point));
            let different: Vec<_> =
                pairs.clone().filter(|((a, b), _)| a.iter().zip(*b).any(differs)).collect();
            assert!(pairs.count() * 5 > 2 * POINTS, "{} is defined at few points", function.name);
            compared += 1;
            if different.len() > JUMPS {
                wrong.push(format!("{}: {} points, {:?}", function.name, different.len(), different[0]));
            }
        }
    }
    assert!(wrong.is_empty(), "driver, graph, point:\n{}", wrong.join("\n"));
    assert!(compared >= 85, "only {compared} functions were compared");
}
