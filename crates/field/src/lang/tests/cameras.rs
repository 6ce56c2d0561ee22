//! Camera paths of the library: they go through their points, are smooth, and have weights that sum to 1.

use super::value;

fn part(formula: &str, axis: &str) -> f32 {
    value(&format!("{{ let v = {formula}  v.{axis} }}"), [0.0; 3])
}

fn place(formula: &str) -> [f32; 3] {
    ["x", "y", "z"].map(|axis| part(formula, axis))
}

fn assert_near(found: [f32; 3], wanted: [f32; 3], what: &str) {
    let near = found.iter().zip(wanted).all(|(found, wanted)| (found - wanted).abs() < 2e-5);
    assert!(near, "{what}: {found:?}, not {wanted:?}");
}

const POINTS: [[f32; 3]; 6] = [
    [0.0, 1.0, -4.0],
    [3.0, 2.0, -1.0],
    [2.0, 0.5, 3.0],
    [-2.0, 4.0, 2.0],
    [-3.0, 1.0, 0.0],
    [-1.0, 2.0, -2.0],
];

fn points(count: usize) -> String {
    POINTS[..count].iter().map(|[x, y, z]| format!(", vec3({x}, {y}, {z})")).collect()
}

#[test]
fn an_orbit_keeps_its_distance_and_comes_back() {
    assert_near(place("orbit(vec3(1, 2, 3), 5, 1.5, 0)"), [1.0, 3.5, -2.0], "the start");
    assert_near(place("orbit(vec3(1, 2, 3), 5, 1.5, 0.25)"), [6.0, 3.5, 3.0], "a quarter");
    assert_near(place("orbit(vec3(1, 2, 3), 5, 1.5, 3)"), [1.0, 3.5, -2.0], "three turns");
}

#[test]
fn a_swing_reaches_its_ends() {
    let swing = |turns: f32| place(&format!("swing(vec3(0, 1, 2), vec3(4, 1, -2), {turns})"));
    assert_near(swing(0.0), [0.0, 1.0, 2.0], "one end");
    assert_near(swing(0.5), [4.0, 1.0, -2.0], "the other");
    assert_near(swing(1.25), [2.0, 1.0, 0.0], "the middle");
}

#[test]
fn paths_go_through_their_points() {
    for count in [4_usize, 6] {
        for (index, point) in POINTS[..count].iter().enumerate() {
            for turn in [0.0, 1.0, -1.0] {
                let at = index as f32 / count as f32 + turn;
                let formula = format!("loop_{count}({at}{})", points(count));
                assert_near(place(&formula), *point, &formula);
            }
            let at = index as f32 / (count - 1) as f32;
            let formula = format!("path_{count}({at}{})", points(count));
            assert_near(place(&formula), *point, &formula);
        }
        for (at, point) in [(-3.0, POINTS[0]), (7.5, POINTS[count - 1])] {
            assert_near(place(&format!("path_{count}({at}{})", points(count))), point, "beyond the end");
        }
    }
}

#[test]
fn paths_have_no_kinks() {
    let count = 6;
    let way = |name: &str, at: f32| place(&format!("{name}_{count}({at}{})", points(count)));
    for (name, whole) in [("loop", 6.0), ("path", 5.0)] {
        for knot in 1..5 {
            let at = |offset: f32| way(name, (knot as f32 + offset) / whole);
            let (before, here, after) = (at(-0.01), at(0.0), at(0.01));
            for axis in 0..3 {
                let (left, right) = (here[axis] - before[axis], after[axis] - here[axis]);
                assert!((left - right).abs() < 2e-3, "{name} at {knot}: {left} and {right}");
            }
        }
    }
}

#[test]
fn weights_of_any_number_of_points_sum_to_one() {
    for count in [3, 4, 5, 9] {
        for at in [-0.7, 0.0, 0.3, 1.5, 2.9, 7.25] {
            for name in ["loop_share", "path_share"] {
                let formula = format!("sum(for i in 0..{count}: {name}({at}, i, {count}))");
                let sum = value(&formula, [0.0; 3]);
                assert!((sum - 1.0).abs() < 1e-5, "{formula} is {sum}");
            }
        }
    }
    assert_eq!(value("sum(for i in 0..2: (3 + 4 * i) * path_share(0.25, i, 2))", [0.0; 3]), 4.0);
}
