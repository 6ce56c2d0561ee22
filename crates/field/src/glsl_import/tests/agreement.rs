//! The graph against a second interpreter, for functions as people write them.

use super::super::{GlslFile, GlslFunction, GlslType};
use super::witness::{Value, Witness};
use super::{executed, parsed, points, values, width};

pub(super) const FIXTURES: [(&str, &str); 3] = [
    ("control.glsl", include_str!("fixtures/control.glsl")),
    ("values.glsl", include_str!("fixtures/values.glsl")),
    ("functions.glsl", include_str!("fixtures/functions.glsl")),
];

/// Largest difference, relative to values above 1.
const TOLERANCE: f32 = 1e-4;
/// Fraction of points that may be at a jump, where the last bit of an operand decides.
const JUMPS: f32 = 0.01;

/// The result by the second interpreter.
fn witnessed(file: &GlslFile, function: &GlslFunction, p: [f32; 3]) -> Vec<f32> {
    let mut witness = Witness::new(&file.module, &file.starts);
    let mut rest = p.into_iter().cycle();
    let arguments = function.parameters.iter().map(|parameter| {
        let parts: Vec<Value> = rest.by_ref().take(width(parameter.of)).map(Value::Float).collect();
        match (parameter.of, parts.as_slice()) {
            (Some(GlslType::Whole), [one]) => Value::Int(one.float() as i32),
            (_, [one]) => one.clone(),
            _ => Value::List(parts),
        }
    });
    let arguments = arguments.collect();
    let mut numbers = Vec::new();
    witness.call(function.handle, arguments).unwrap().numbers(&mut numbers);
    numbers
}

/// Compares all functions of a file that a scene can call. Returns their number.
pub(super) fn compare(name: &str, text: &str, count: usize) -> usize {
    let file = parsed(text);
    let points = points(count);
    let mut compared = 0;
    for function in file.functions() {
        let label = format!("{name}: {function}");
        assert_eq!(file.problem_of(function), None, "{label}");
        let takes_whole = function.parameters.iter().any(|one| one.of == Some(GlslType::Whole));
        if !function.is_callable() || takes_whole {
            continue;
        }
        let (graph, nodes) =
            executed(&file, function).unwrap_or_else(|problem| panic!("{label}: {problem:?}"));
        let (mut wrong, mut seen, mut example) = (0, 0, String::new());
        for (p, found) in points.iter().zip(values(&graph, &nodes, &points)) {
            let expected = witnessed(&file, function, *p);
            assert_eq!(expected.len(), found.len(), "{label}");
            if expected.iter().any(|value| !value.is_finite() || value.abs() > 1e6) {
                continue;
            }
            seen += 1;
            let differs = |(a, b): (&f32, &f32)| (a - b).abs() > TOLERANCE * a.abs().max(1.0) || b.is_nan();
            if expected.iter().zip(&found).any(differs) {
                wrong += 1;
                example = format!("at {p:?}: {expected:?}, but the graph has {found:?}");
            }
        }
        assert!(seen * 2 > count, "{label} is defined at {seen} of {count} points only");
        assert!(wrong as f32 <= JUMPS * count as f32, "{label} differs at {wrong} points, {example}");
        compared += 1;
    }
    compared
}

#[test]
fn functions_of_the_fixtures_have_the_values_of_a_second_interpreter() {
    let counts = FIXTURES.map(|(name, text)| compare(name, text, 300));
    assert!(counts.iter().sum::<usize>() >= 95, "{counts:?}");
}

#[test]
fn a_wrong_value_is_noticed() {
    // The same text under another name of a macro: the comparison must be able to fail.
    let text = "float f(vec3 p) { return p.x * 2.0; }";
    let file = parsed(text);
    let other = parsed("float f(vec3 p) { return p.x * 2.001; }");
    let (graph, nodes) = executed(&file, &file.functions()[0]).unwrap();
    let p = [1.0, 0.0, 0.0];
    let found = values(&graph, &nodes, &[p]);
    assert_eq!(found[0], witnessed(&file, &file.functions()[0], p));
    assert_ne!(found[0], witnessed(&other, &other.functions()[0], p));
}
