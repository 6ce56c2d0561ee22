//! The speakers, written by hand in GLSL. They check the compiled scene, and tell tests the positions of the speakers'
//! parts.

use glam::DVec3;

pub(crate) const BY_HAND: &str = include_str!("../oracle/speakers.glsl");

/// Reads the arguments of `const TYPE NAME = ...;`.
fn constant_numbers(name: &str) -> Vec<f64> {
    let value = BY_HAND
        .lines()
        .filter_map(|line| line.trim().strip_prefix("const ")?.split_once(" = "))
        .find(|(declared, _)| declared.split_whitespace().nth(1) == Some(name))
        .and_then(|(_, rest)| rest.split_once(';'))
        .map(|(value, _)| value.trim())
        .unwrap_or_else(|| panic!("the oracle has no constant {name}; tests place their probes by it"));
    let inner = value.split_once('(').map_or(value, |(_, arguments)| arguments.trim_end_matches(')'));
    inner
        .split(',')
        .map(|number| number.trim().parse().unwrap_or_else(|_| panic!("{name} is {value}, expected numbers")))
        .collect()
}

pub(crate) fn constant(name: &str) -> f64 {
    let numbers = constant_numbers(name);
    assert_eq!(numbers.len(), 1, "{name} is not a single number");
    numbers[0]
}

pub(crate) fn vector_constant(name: &str) -> DVec3 {
    let numbers = constant_numbers(name);
    assert_eq!(numbers.len(), 3, "{name} is not a vector of three numbers");
    DVec3::new(numbers[0], numbers[1], numbers[2])
}
