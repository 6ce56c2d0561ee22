//! The stated slopes and bounds of the library, at random points with random arguments.

use proptest::prelude::*;

use super::scene;
use super::shapes::points;
use crate::graph::{FrameInputs, Point};
use crate::tape::{PointEvaluator, Tape};

type Slope = fn(f32, f32, f32) -> f32;

/// Numbers or vectors that depend on `p` and on the arguments `a`, `b` and `m`, and the stated upper bounds of their
/// slopes. A vector is written as its components.
const SLOPES: &[(&[&str], Slope)] = &[
    (&["noise(p)"], |_, _, _| 1.5),
    (&["noise_2d(p.xz)"], |_, _, _| 1.5),
    (&["fbm(p, m)"], |_, _, n| 0.75 * (n + 1.0)),
    (&["fbm_octave(p, m)"], |_, _, _| 0.75),
    (&["ridged(p, m)"], |_, _, n| 1.5 * (n + 1.0)),
    (&["billow(p, m)"], |_, _, n| 1.5 * (n + 1.0)),
    (&["erosion(p.xz, m)"], |_, _, n| 3.4 * (n + 1.0)),
    (&["voronoi(p)"], |_, _, _| 1.0),
    (&["voronoi_2d(p.xz)"], |_, _, _| 1.0),
    (&["voronoi_walls(p)"], |_, _, _| 1.0),
    (&["voronoi_walls_2d(p.xz)"], |_, _, _| 1.0),
    (&["other_cells(p, vec3(a, b, 0), 0.3 * min(a, b))"], |_, _, _| 1.0),
    (&["other_hex_cells(p.xz, a, 0.4 * a)"], |_, _, _| 1.0),
    (
        &["smooth_polar_repeat(p, m + 1, b / 3).x", "p.y", "smooth_polar_repeat(p, m + 1, b / 3).z"],
        |_, _, _| 1.0,
    ),
    (&["warp(p, b, a).x", "warp(p, b, a).y", "warp(p, b, a).z"], |a, b, _| 1.0 + 5.2 * b / a),
    (&["displace_fbm(sphere(p, a), p, b, a, m)"], |_, _, _| 1.0),
    (&["displace_fbm(p.y, p, a, b, m)"], |_, _, _| 1.0),
];

/// The components of a vector as a function of the point.
struct Formula(Vec<Tape>);

impl Formula {
    fn of(components: &[&str], (a, b, n): (f32, f32, u32)) -> Self {
        let tape = |component: &&str| {
            let scene = scene(&format!("let a = {a}\nlet b = {b}\nlet m = {n}\n{component}"));
            Tape::new(&scene.graph, &[scene.distance])
        };
        Self(components.iter().map(tape).collect())
    }

    fn at(&self, [x, y, z]: [f32; 3]) -> Vec<f32> {
        let inputs = FrameInputs::default();
        self.0.iter().map(|tape| PointEvaluator::new(tape, &inputs).at(&Point::at(x, y, z))[0]).collect()
    }

    /// The steepest slope between neighbouring points around `middle`.
    fn steepest(&self, middle: [f32; 3]) -> f32 {
        let step = 2e-3;
        let places: Vec<[f32; 3]> = points(300).collect();
        let ways = points(901).skip(601);
        let mut steepest = 0.0_f32;
        for (place, way) in places.into_iter().zip(ways) {
            let size = way.iter().map(|part| part * part).sum::<f32>().sqrt();
            let here: [f32; 3] = std::array::from_fn(|axis| middle[axis] + place[axis]);
            let there = std::array::from_fn(|axis| here[axis] + step * way[axis] / size);
            let gap = self.at(here).iter().zip(self.at(there)).map(|(a, b)| (a - b) * (a - b)).sum::<f32>();
            steepest = steepest.max(gap.sqrt() / step);
        }
        steepest
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]
    #[test]
    fn no_slope_is_steeper_than_stated(
        row in 0..SLOPES.len(),
        a in 0.3_f32..2.0,
        b in 0.2_f32..1.5,
        n in 1_u32..6,
        middle in prop::array::uniform3(-9.0_f32..9.0),
    ) {
        let (components, slope) = SLOPES[row];
        let steepest = Formula::of(components, (a, b, n)).steepest(middle);
        let stated = slope(a, b, n as f32);
        prop_assert!(steepest < 1.01 * stated, "{components:?}: {steepest}, not {stated}");
    }

    /// The bound of a repetition whose cells differ, against all cells in the neighbourhood.
    #[test]
    fn no_shape_of_another_cell_is_nearer_than_the_bound(
        size in prop::array::uniform2(0.5_f32..3.0),
        at in prop::array::uniform3(-9.0_f32..9.0),
    ) {
        let [a, b] = size;
        let reach = 0.48 * a.min(b);
        let text = |formula: &str| Formula::of(&[formula], (a, b, 1)).at(at)[0];
        let radius = |cell: &str| format!("{reach} * (0.2 + 0.8 * hash(vec3({cell}, 3)))");
        let all = format!(
            "union(for i in -2..3: for j in -2..3: length(p - vec3(a, 0, b) * vec3(cell_of(p.x, a) + i, 0, cell_of(p.z, b) + j)) - {})",
            radius("cell_of(p.x, a) + i, cell_of(p.z, b) + j"),
        );
        let own = format!(
            "sphere(repeat(p, vec3(a, 0, b)), {})", radius("cell_of(p.x, a), cell_of(p.z, b)"));
        let bounded = format!("min({own}, other_cells(p, vec3(a, 0, b), {reach}))");
        prop_assert!(text(&bounded) <= text(&all) + 1e-4, "{} > {}", text(&bounded), text(&all));
        prop_assert!(text(&own) >= text(&all) - 1e-4);
        // In hexagons, whose neighbours are at (1, 0), (0.5, 0.87) and so on.
        let radius = |cell: &str| format!("0.48 * a * (0.2 + 0.8 * hash(vec3({cell}, 3)))");
        let cell = "hex_cell(p.xz, a)";
        let own = format!("length(hex_repeat(p.xz, a)) - {}", radius(cell));
        let all = format!(
            "union(for i in -2..3: for j in -1..2: length(hex_repeat(p.xz, a) - a * vec2(i + 0.5 * j, 0.8660254 * j)) - {})",
            radius(&format!("{cell} + vec2(2 * i + j, j)")),
        );
        let bounded = format!("min({own}, other_hex_cells(p.xz, a, 0.48 * a))");
        prop_assert!(text(&bounded) <= text(&all) + 1e-4, "{} > {}", text(&bounded), text(&all));
    }

    /// The nearest of the points of more cells, and the region of a second point.
    #[test]
    fn voronoi_finds_the_nearest_point_and_never_overestimates_walls(
        at in prop::array::uniform3(-9.0_f32..9.0),
        to in prop::array::uniform3(-1.0_f32..1.0),
    ) {
        let value = |formula: &str, at: [f32; 3]| Formula::of(&[formula], (1.0, 1.0, 1)).at(at)[0];
        let near = "for i in -2..3: for j in -2..3:";
        let all = format!("min({near} for k in -2..3: voronoi_point(p, floor(p) + vec3(i, j, k)))");
        let all_2d = format!("min({near} voronoi_point_2d(p.xz, floor(p.xz) + vec2(i, j)))");
        prop_assert!((value("voronoi(p)", at) - value(&all, at)).abs() < 1e-5);
        prop_assert!((value("voronoi_2d(p.xz)", at) - value(&all_2d, at)).abs() < 1e-5);
        for (walls, region, axes) in [
            ("voronoi_walls(p)", "voronoi_hash(p)", [1.0, 1.0, 1.0]),
            ("voronoi_walls_2d(p.xz)", "voronoi_hash_2d(p.xz)", [1.0, 0.0, 1.0]),
        ] {
            let way: [f32; 3] = std::array::from_fn(|axis| axes[axis] * to[axis]);
            let there = std::array::from_fn(|axis| at[axis] + way[axis]);
            let length = way.iter().map(|part| part * part).sum::<f32>().sqrt();
            if (value(region, at) - value(region, there)).abs() > 1e-2 {
                prop_assert!(value(walls, at) <= length + 1e-3, "{walls}: {} > {length}", value(walls, at));
            }
        }
    }

    /// A bound per octave keeps the surface: it has the sign of the displaced shape, and is nowhere below the bound that
    /// evaluates all octaves.
    #[test]
    fn octaves_left_out_move_no_surface(
        a in 0.2_f32..2.0,
        b in 0.05_f32..1.0,
        n in 1_u32..8,
        middle in prop::array::uniform3(-2.0_f32..2.0),
    ) {
        let arguments = (a, b, n);
        let plain = Formula::of(&["sphere(p, 1) - b * fbm(p / a, m)"], arguments);
        let bounded = Formula::of(&["displace_fbm(sphere(p, 1), p, a, b, m)"], arguments);
        let slope = 1.0 + 0.75 * n as f32 * b / (a * (1.0 - 0.5_f32.powi(n as i32)));
        for place in points(50) {
            let at = std::array::from_fn(|axis| middle[axis] + 0.3 * place[axis]);
            let (plain, bounded) = (plain.at(at)[0], bounded.at(at)[0]);
            prop_assert!(bounded >= plain / slope - 1e-4, "{bounded} < {plain} / {slope}");
            prop_assert!(plain > 1e-4 || bounded < 1e-4, "{bounded}, but {plain}");
        }
    }
}

/// Stated slopes are not far too large: some point comes near them.
#[test]
fn stated_slopes_are_nearly_reached() {
    for (formula, least) in [
        ("noise(p)", 1.0),
        ("noise_2d(p.xz)", 1.0),
        ("voronoi(p)", 0.99),
        ("voronoi_walls_2d(p.xz)", 0.95),
        ("fbm(p, 2)", 0.9),
        ("ridged(p, 2)", 1.8),
        ("erosion(p.xz, 3)", 2.0),
    ] {
        let tape = Formula::of(&[formula], (1.0, 1.0, 1));
        let steepest = (0..8).map(|i| tape.steepest([4.0 * i as f32, 0.0, 0.0])).fold(0.0, f32::max);
        assert!(steepest > least, "{formula}: {steepest}");
    }
}
