//! Values of blocks with statements, of matrices and of records.

use super::super::compile;
use super::super::no_includes;
use super::{distance, scene, value};
use crate::graph::{FrameInputs, Graph, Interval, Point, ShapeAtlas};
use crate::lang::Scene;
use proptest::prelude::*;

const AT: [f32; 3] = [0.5, -2.0, 3.0];

#[test]
fn statements_mean_what_they_mean_in_glsl() {
    for (text, expected) in [
        ("{ let a = 1  a = a + 1  a *= 3  a -= 1  a /= 5  a }", 1.0),
        ("{ let q = p  q.xz = q.zx  q.y += 10  q.x + 10 * q.y + 100 * q.z }", 133.0),
        ("{ let q = p  q.rg *= vec2(2, 3)  q.x + q.y }", -5.0),
        ("{ let q = vec3(0)  q = 2  q.x + q.y + q.z }", 6.0),
        // Loops.
        ("{ let s = 0  for i in 0..5 { s += i }  s }", 10.0),
        ("{ let s = 0  for i in 2..5 { let k = i * i  s += k }  s }", 29.0),
        ("{ let a = 0  let b = 1  for i in 0..10 { let c = a + b  a = b  b = c }  a }", 55.0),
        ("{ let s = 0  for i in 0..3 { for j in 0..i { s += 10 * i + j } }  s }", 51.0),
        ("{ let s = 1  for i in 5..5 { s = 100 }  s }", 1.0),
        // Early ends, on constants and on values that depend on the point.
        ("{ let s = 1  for i in 0..50 while s < 40 { s *= 2 }  s }", 64.0),
        ("{ let s = 1  for i in 0..50 { if s > 40 { break }  s *= 2 }  s }", 64.0),
        ("{ let s = z - 2  for i in 0..9 while s < 40 { s *= 2 }  s }", 64.0),
        (
            "{ let s = z - 2  let n = 0  for i in 0..9 { s *= 2  if s > 40 { break }  n += 1 }  100 * n + s }",
            564.0,
        ),
        ("{ let s = z - 2  for i in 0..9 { if s > 40 { s = -1  break  s = -2 }  s *= 2 }  s }", -1.0),
        (
            "{ let s = 0  for i in 0..4 { for j in 0..9 { if j > z { break }  s += 1 }  if i > z - 2 { break }  s += 100 }  s }",
            212.0,
        ),
        ("{ let s = 0  if z > 0 { for i in 0..5 { if i > z { break }  s += 1 } } else { s = 50 }  s }", 4.0),
        ("{ let s = 0  for i in 0..9 { if i > 2 break; s += z }  s }", 9.0),
        // Choices.
        ("{ let a = 1  let b = 2  if x > 0 { a = 10  b += a } else { b = 50 }  a + b }", 22.0),
        (
            "{ let a = 1  if x < 0 { a = 10 } else if z > 5 { a = 20 } else if z > 2 { a = 30 } else { a = 40 }  a }",
            30.0,
        ),
        ("{ let a = 1  if (x > 0) a = 2; else a = 3; a }", 2.0),
        ("{ let q = p  if x > 0 { q.y = 5 }  q.y }", 5.0),
        ("{ let a = 1  { let a = 2  a = 3  a } + a }", 4.0),
        ("{ let a = true  if x > 1 { a = false }  if a then 1 else 2 }", 1.0),
        // Matrices: columns, products from both sides, inverses.
        ("(mat2(1, 2, 3, 4) * vec2(10, 100)).x", 310.0),
        ("(vec2(10, 100) * mat2(1, 2, 3, 4)).x", 210.0),
        ("(mat2(vec2(1, 2), vec2(3, 4)) * mat2(0, 1, 1, 0) * vec2(1, 0)).y", 4.0),
        ("(mat3(2) * p).z + (mat3(p, p, p) * vec3(0, 1, 0)).y", 4.0),
        ("(transpose(mat2(1, 2, 3, 4)) * vec2(1, 0)).y", 3.0),
        ("determinant(mat2(1, 2, 3, 5)) + determinant(mat3(2, 0, 0, 0, 3, 0, 7, 0, 4))", 23.0),
        ("(inverse(mat2(1, 2, 3, 5)) * mat2(1, 2, 3, 5) * p.xy).y", -2.0),
        ("(inverse(mat2(x - 0.5)) * p.xy).y", 0.0),
        ("(mat2(mat3(1, 2, 3, 4, 5, 6, 7, 8, 9)) * vec2(0, 1)).y", 5.0),
        ("((mat2(1) + mat2(1, 2, 3, 4) / 2 - 0.5) * vec2(1, 0)).y", 0.5),
        ("{ let q = p  q.xz *= mat2(0, -1, 1, 0)  q.x + 10 * q.z }", 2.0),
        ("{ let m = mat2(1)  for i in 0..3 { m *= mat2(1, 1, 0, 1) }  (m * vec2(1, 0)).y }", 3.0),
        ("{ let m = mat2(1)  if x > 0 { m = mat2(3) }  (m * vec2(1, 0)).x }", 3.0),
        ("rotate_2d(p.xy, 0.7).x - (p.xy * rotation_2d(0.7)).x", 0.0),
        ("length(rotate_x(p, 0.7) - p * rotation_x(0.7))", 0.0),
        ("length(rotate_y(p, 0.7) - p * rotation_y(0.7))", 0.0),
        ("length(rotate_z(p, 0.7) - p * rotation_z(0.7))", 0.0),
        ("length(rotate(p, vec3(1, 2, -2), 0.7) - p * rotation(vec3(1, 2, -2), 0.7))", 0.0),
        // Records.
        ("(near = x, index = 3).index", 3.0),
        ("{ let r = (d = x, inner = (a = 1, b = p))  r.inner.b.y }", -2.0),
        ("{ let r = (d = 1, i = 2)  if x > 0 { r = (d = 5, i = 6) }  r.d + r.i }", 11.0),
        ("(if x < 0 then (d = 1, i = 2) else (d = 3, i = p.z)).i", 3.0),
        // Words of GLSL.
        ("float(3) + int(-2.7) + float(x > 0)", 2.0),
    ] {
        let got = value(text, AT);
        assert!((got - expected).abs() < 2e-5, "{text} is {got}, not {expected}");
    }
}

#[test]
fn functions_change_their_parameters_and_not_their_callers() {
    let text =
        "fn f(p) { p.xz *= 2  for i in 0..2 { p += 1 }  p }\nfn g(a) { let b = f(vec3(a))  a + b.x }\ng(x)";
    assert_eq!(value(text, AT), 0.5 + 1.0 + 2.0);
}

#[test]
fn a_parameter_can_be_the_number_of_iterations() {
    let text = "param rounds = 3 in 0 .. 6\n{ let s = x  for i in 0..rounds { s += 1 }  s }";
    let scene = scene(text);
    for (rounds, expected) in [(0.0, 0.5), (3.0, 3.5), (4.2, 5.5), (6.0, 6.5)] {
        let frame = FrameInputs { params: vec![rounds], ..FrameInputs::default() };
        let at = Point::at(AT[0], AT[1], AT[2]);
        let found = scene.graph.evaluate(&[scene.distance], &at, &frame)[0];
        assert_eq!(found, expected, "{rounds} rounds");
    }
    let too_many = "param rounds = 3 in 0 .. 60000\n{ let s = x  for i in 0..rounds { s += 1 }  s }";
    let compiled = compile("s", too_many, &mut no_includes);
    assert!(compiled.render(false).contains("the largest number of iterations is not known"));
}

/// The Mandelbulb of power 8 after White and Nylander, as a loop and as eight copies of its body.
const BULB_ROUND: &str = "r = length(z)\n dr = if r < 2 then 8 * r^7 * dr + 1 else dr\n \
    z = if r < 2 then r^8 * vec3(sin(8 * acos(z.z / r)) * cos(8 * atan(z.y, z.x)), \
    sin(8 * acos(z.z / r)) * sin(8 * atan(z.y, z.x)), cos(8 * acos(z.z / r))) + p else z\n";

fn bulbs() -> (Scene, Scene) {
    let head = "{ let z = p  let dr = 1  let r = 0\n";
    let tail = "0.5 * log(r) * r / dr }";
    let written = format!("{head}{}{tail}", BULB_ROUND.repeat(4));
    let looped = format!(
        "{head}for i in 0..4 {{\n r = length(z)\n if r >= 2 {{ break }}\n dr = 8 * r^7 * dr + 1\n \
         let theta = 8 * acos(z.z / r)\n let phi = 8 * atan(z.y, z.x)\n \
         z = r^8 * vec3(sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)) + p\n}}\n{tail}"
    );
    (scene(&written), scene(&looped))
}

proptest! {
    #[test]
    fn a_loop_equals_its_written_out_iterations(x in -1.5_f32..1.5, y in -1.5_f32..1.5, z in -1.5_f32..1.5) {
        let (written, looped) = bulbs();
        prop_assert_eq!(distance(&written, [x, y, z]), distance(&looped, [x, y, z]));
    }

    #[test]
    fn bounds_of_a_value_hold_it(low in -3.0_f32..3.0, width in 0.0_f32..3.0, share in 0.0_f32..=1.0) {
        let high = low + width;
        let any = FrameInputs::any(Graph::new().ranges([(low, high)]), &ShapeAtlas::NONE);
        let frame = FrameInputs { params: vec![low + share * width], ..FrameInputs::default() };
        let text = "param a = 0 in -9 .. 9\nround(a * a - 2)";
        let scene = super::scene(text);
        let value = scene.graph.evaluate(&[scene.distance], &Point::default(), &frame)[0];
        let Interval { lo, hi } = scene.graph.bounds(scene.distance, [Interval::ANY; 6], &any);
        prop_assert!(lo <= value && value <= hi, "{} is not in {}..{}", value, lo, hi);
    }
}
