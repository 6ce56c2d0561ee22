use super::super::library::{self, Accuracy, TEXTS};
use super::super::{Fault, compile, entries, no_includes};
use super::{distance, scene, value};

/// A point, and the distance at that point.
pub(crate) type Sample = ([f32; 3], f32);

pub(crate) const SHAPES: &[(&str, &[Sample])] = &[
    ("sphere(p, 1)", &[([2.0, 0.0, 0.0], 1.0), ([0.0, 0.0, 0.0], -1.0)]),
    ("box(p, vec3(1, 0.5, 0.75))", &[([4.0, 4.5, 0.0], 5.0), ([0.0, 0.0, 0.0], -0.5)]),
    ("round_box(p, 0.75, 0.25)", &[([2.0, 0.0, 0.0], 1.0)]),
    ("box_frame(p, 1, 0.1)", &[([1.0, 2.0, 1.0], 1.0), ([0.0, 1.0, 0.0], 0.8)]),
    ("torus(p, 1, 0.25)", &[([2.0, 0.0, 0.0], 0.75), ([0.0, 0.0, 0.0], 0.75)]),
    ("capped_torus(p, 1, 1, 0.2)", &[([0.0, 1.5, 0.0], 0.3)]),
    ("link(p, 0.5, 0.5, 0.2)", &[([0.0, 1.5, 0.0], 0.3), ([1.0, 0.0, 0.0], 0.3)]),
    ("cylinder(p, 0.5)", &[([2.0, 9.0, 0.0], 1.5)]),
    ("capped_cylinder(p, 0.5, 1)", &[([0.0, 2.0, 0.0], 1.0), ([2.0, 0.0, 0.0], 1.5)]),
    ("rounded_cylinder(p, 0.5, 1, 0.1)", &[([0.0, 2.0, 0.0], 1.0), ([2.0, 0.0, 0.0], 1.5)]),
    (
        "cone(p, pi / 4, 1)",
        &[
            ([0.0, 1.0, 0.0], 1.0),
            ([0.0, -1.5, 0.0], 0.5),
            ([1.0, 0.0, 0.0], std::f32::consts::FRAC_1_SQRT_2),
        ],
    ),
    (
        "capped_cone(p, 0.5, 1, 0.5)",
        &[([0.0, 1.0, 0.0], 0.5), ([0.0, -1.0, 0.0], 0.5), ([0.0, 0.0, 0.0], -0.5)],
    ),
    ("round_cone(p, 0.5, 0.25, 1)", &[([0.0, 2.0, 0.0], 0.75), ([0.0, -1.0, 0.0], 0.5)]),
    ("plane(p, vec3(0, 2, 0), 0.5)", &[([3.0, 2.0, 1.0], 1.5)]),
    ("hex_prism(p, 0.75, 0.5)", &[([0.0, 1.0, 0.0], 0.25), ([0.0, 0.0, 1.0], 0.5)]),
    ("tri_prism(p, 0.75, 0.5)", &[([0.0, 0.0, 1.5], 1.0), ([0.0, -1.0, 0.0], 0.5669873)]),
    ("capsule(p, vec3(-1, 0, 0), vec3(1, 0, 0), 0.25)", &[([2.0, 0.0, 0.0], 0.75), ([0.0, 1.0, 0.0], 0.75)]),
    ("vertical_capsule(p, 1, 0.25)", &[([0.0, 2.0, 0.0], 0.75), ([1.0, 0.5, 0.0], 0.75)]),
    (
        "ellipsoid(p, vec3(1, 0.5, 0.75))",
        &[([1.0, 0.0, 0.0], 0.0), ([0.0, 0.5, 0.0], 0.0), ([0.0, 0.0, 0.0], -0.5)],
    ),
    ("octahedron(p, 1)", &[([2.0, 0.0, 0.0], 1.0), ([0.0, 0.0, 0.0], -0.57735), ([1.0, 1.0, 1.0], 1.1547)]),
    (
        "pyramid(p, 1)",
        &[([0.0, 0.05, 0.0], -0.05), ([0.0, 1.5, 0.0], 0.5), ([0.0, -0.5, 0.0], 0.5), ([1.0, 0.0, 0.0], 0.5)],
    ),
    ("rhombus(p, 1, 0.5, 0.25, 0.1)", &[([2.1, 0.0, 0.0], 1.0), ([0.0, 1.25, 0.0], 1.0)]),
    ("solid_angle(p, 1, 1)", &[([0.0, 2.0, 0.0], 1.0), ([0.0, -1.0, 0.0], 1.0)]),
    ("cut_sphere(p, 1, 0.25)", &[([0.0, 2.0, 0.0], 1.0), ([0.0, -0.75, 0.0], 1.0)]),
    ("cut_hollow_sphere(p, 1, 0.25, 0.1)", &[([0.0, -2.0, 0.0], 0.9), ([0.0, 0.0, 0.0], 0.9)]),
    ("death_star(p, 1, 0.75, 1)", &[([-2.0, 0.0, 0.0], 1.0), ([1.0, 0.0, 0.0], 0.75)]),
    (
        "triangle(p, vec3(-1, 0, 0), vec3(1, 0, 0), vec3(0, 1, 0))",
        &[([0.0, 0.5, 2.0], 2.0), ([3.0, 0.0, 0.0], 2.0)],
    ),
    (
        "quad(p, vec3(-1, -1, 0), vec3(1, -1, 0), vec3(1, 1, 0), vec3(-1, 1, 0))",
        &[([0.5, 0.0, 2.0], 2.0), ([3.0, 0.0, 0.0], 2.0)],
    ),
    ("gyroid(p, 2, 0.05)", &[]),
    ("circle(p.xy, 1)", &[([0.0, 3.0, 0.0], 2.0)]),
    ("rectangle(p.xy, vec2(1, 0.5))", &[([4.0, 4.5, 0.0], 5.0)]),
    ("round_rectangle(p.xy, vec2(1, 0.5), 0.2)", &[([2.0, 0.0, 0.0], 1.0)]),
    ("segment(p.xy, vec2(-1, 0), vec2(1, 0)) - 0.2", &[([2.0, 0.0, 0.0], 0.8)]),
    ("equilateral(p.xy, 1)", &[([0.0, 2.1547005, 0.0], 1.0), ([0.0, 0.0, 0.0], -0.57735)]),
    ("hexagon(p.xy, 1)", &[([0.0, 2.0, 0.0], 1.0), ([0.0, 0.0, 0.0], -1.0)]),
    ("polygon(p.xy, 5, 1)", &[([0.0, 2.0, 0.0], 1.0)]),
    ("star(p.xy, 5, 1, 0.4)", &[([0.0, 2.0, 0.0], 1.0)]),
    ("ring(p.xy, 1, 0.2)", &[([0.0, 2.0, 0.0], 0.8)]),
    ("pie(p.xy, 1, 1)", &[([0.0, 2.0, 0.0], 1.0)]),
    ("arc(p.xy, 1, 1, 0.2)", &[([0.0, 2.0, 0.0], 0.8)]),
    ("heart(p.xy)", &[([0.0, -1.0, 0.0], 1.0)]),
    ("extrude(circle(p.xy, 0.5), p.z, 0.5)", &[([0.0, 0.0, 2.0], 1.5)]),
    ("rectangle(revolve(p, 1), vec2(0.25, 0.5))", &[([2.0, 0.0, 0.0], 0.75)]),
    ("shell(sphere(p, 1), 0.1)", &[([0.0, 0.0, 0.0], 0.9)]),
    ("voronoi_walls(p) - 0.02", &[]),
    ("voronoi_walls_2d(p.xz) - 0.02", &[]),
    ("displace_fbm(sphere(p, 1), p, 0.5, 0.3, 5)", &[]),
];

#[test]
fn shapes_have_their_distances() {
    for (call, points) in SHAPES {
        let scene = scene(call);
        for &(at, expected) in *points {
            let got = distance(&scene, at);
            assert!((got - expected).abs() < 2e-5, "{call} at {at:?} is {got}, not {expected}");
        }
    }
}

/// Well distributed points in the cube from -2 to 2, the same in every run.
pub(super) fn points(count: u32) -> impl Iterator<Item = [f32; 3]> {
    (0..count).map(|index| {
        let at = |step: f64| ((f64::from(index) * step).fract() * 4.0 - 2.0) as f32;
        // The R3 sequence: powers of the generalized golden ratio (Martin Roberts).
        [at(0.819_172_513_396_164_4), at(0.671_043_606_703_789_3), at(0.549_700_477_901_960_5)]
    })
}

#[test]
fn no_shape_overestimates_and_exact_ones_have_slope_one() {
    let accuracy = |call: &str| {
        let name = call.split('(').next().unwrap();
        entries().iter().find(|entry| entry.name == name).and_then(|entry| entry.accuracy)
    };
    for (call, _) in SHAPES {
        let scene = scene(call);
        let step = 1e-2;
        let (mut steepest, mut exact, mut total) = (0.0_f32, 0, 0);
        for at in points(400) {
            let here = distance(&scene, at);
            let slope: Vec<f32> = (0..3)
                .map(|axis| {
                    let (mut ahead, mut behind) = (at, at);
                    ahead[axis] += step;
                    behind[axis] -= step;
                    (distance(&scene, ahead) - distance(&scene, behind)) / (2.0 * step)
                })
                .collect();
            let slope = slope.iter().map(|part| part * part).sum::<f32>().sqrt();
            if here > step {
                steepest = steepest.max(slope);
            }
            total += 1;
            exact += usize::from((slope - 1.0).abs() < 0.01);
        }
        // Slopes measured across creases are not 1.
        let fraction = exact as f32 / total as f32;
        match accuracy(call) {
            Some(Accuracy::Exact) => {
                assert!(fraction > 0.9 && steepest < 1.01, "{call}: {fraction} of points, {steepest}")
            }
            Some(Accuracy::Bound) if call.starts_with("ellipsoid") => {
                assert!(steepest < 1.0, "{call}: {steepest}")
            }
            _ => assert!(steepest < 1.01, "{call}: {steepest}"),
        }
    }
}

#[test]
fn operators_move_space() {
    let at = [1.0, 2.0, 3.0];
    for (text, expected) in [
        ("translate(p, vec3(1, 0, 0)).x", 0.0),
        ("rotate_z(p, pi / 2).x", 2.0),
        ("rotate_x(p, pi / 2).y", 3.0),
        ("rotate_y(p, pi / 2).z", 1.0),
        ("length(rotate(p, vec3(0, 0, 5), 0.7) - rotate_z(p, 0.7))", 0.0),
        ("length(rotate(p, vec3(1, 0, 0), 0.7) - rotate_x(p, 0.7))", 0.0),
        ("length(rotate(p, vec3(0, 1, 0), 0.7) - rotate_y(p, 0.7))", 0.0),
        ("rotate_2d(p.xy, pi / 2).x", 2.0),
        ("sphere(scale(p, 2), 1) * 2", 14.0_f32.sqrt() - 2.0),
        ("repeat(p, vec3(2, 0, 2)).z", -1.0),
        ("repeat(p, vec3(2, 0, 2)).y", 2.0),
        ("repeat_limited(p, 1, 1).z", 2.0),
        ("mirror(p, vec3(0, -1, 0)).y", -2.0),
        ("mirror_x(-p).x", 1.0),
        ("mirror_y(-p).y + mirror_z(-p).z", 5.0),
        ("length(polar_repeat(p, 4).xz)", 10.0_f32.sqrt()),
        ("polar_repeat(p, 4).x", 3.0),
        ("twist(p, 0).x + bend(p, 0).y", 3.0),
        ("twist(p, pi / 4).x", -3.0),
        ("elongate(p, vec3(0, 1, 0)).y", 1.0),
        ("displace(1, 0.5, 1)", 0.25),
        ("smooth_union(1, 3, 1)", 1.0),
        ("smooth_union(1, 1, 1)", 0.75),
        ("smooth_union(1, 2, 0)", 1.0),
        ("smooth_union(3, 2, 1, 0.5)", 1.0),
        ("smooth_subtract(1, 1, 1)", 1.0),
        ("smooth_intersect(1, 1, 1)", 1.25),
        ("subtract(-3, -1, -2)", 2.0),
        ("intersect(1, 2, 3)", 3.0),
        ("union(for i in 0..8: abs(x - i) + 0.5)", 0.5),
        ("morph(1, 3, 0.5)", 2.0),
        ("chamfer_union(0.5, 0.5, 1)", 0.0),
        ("hsv(1 / 3, 1, 0.5).g", 0.5),
        ("palette(0, 0.5, 0.5, 1, 0).r", 1.0),
    ] {
        let got = value(text, at);
        assert!((got - expected).abs() < 1e-5, "{text} is {got}, not {expected}");
    }
}

#[test]
fn noise_is_smooth_and_keeps_its_bounds() {
    for (text, slope) in [("noise(p * 3) / 3", 1.5), ("noise_2d(p.xy * 3) / 3", 1.5), ("fbm(p, 4)", 3.75)] {
        let scene = scene(text);
        let (mut least, mut most, mut steepest) = (1.0_f32, 0.0_f32, 0.0_f32);
        for at in points(2000) {
            let here = distance(&scene, at);
            let there = distance(&scene, [at[0] + 0.01, at[1], at[2]]);
            (least, most) = (least.min(here), most.max(here));
            steepest = steepest.max((there - here).abs() / 0.01);
        }
        assert!(least >= 0.0 && most <= 1.0 && most - least > 0.15, "{text}: {least}..{most}");
        assert!(steepest < slope && steepest > 0.2, "{text}: {steepest}");
    }
}

#[test]
fn the_library_has_no_mistakes_and_documents_every_function() {
    let text: String = TEXTS.iter().map(|(_, text)| *text).collect();
    // Compile the library as a scene, so that functions without calls are checked as well.
    let compiled = compile("library", &format!("{text}\nlength(p)"), &mut no_includes);
    assert!(compiled.scene.is_some(), "{}", compiled.render(false));
    let library = library::library();
    let all = entries();
    for function in &library.functions {
        let name = library.names.name(function.name.symbol);
        let entry =
            all.iter().find(|entry| entry.name == name).unwrap_or_else(|| panic!("{name} has no entry"));
        assert!(!entry.doc.is_empty() && !entry.source.is_empty(), "{name}: {entry:?}");
        assert!(entry.doc.ends_with('.') || entry.doc.ends_with('`'), "{name}: {}", entry.doc);
    }
    let exact_or_bound = |entry: &&super::super::Entry| entry.group.starts_with("Shapes");
    assert!(all.iter().filter(exact_or_bound).filter(|entry| entry.accuracy.is_some()).count() >= 40);
    for (name, _) in super::super::builtin::FOLDS {
        assert!(all.iter().any(|entry| entry.name == *name), "{name}");
    }
}

#[test]
fn wrong_arguments_of_the_library_are_the_callers_mistakes() {
    for text in
        ["sphere(p, vec3(1))", "box(p)", "triplanar(p, p, p)", "smooth_union(p, 1, 2)", "rotate_x(1, 2, 3)"]
    {
        let compiled = compile("s", text, &mut no_includes);
        let first = &compiled.diagnostics[0];
        assert_eq!(first.fault, Fault::Malformed);
        assert!(first.span.end as usize <= text.len(), "{text}: {first:?}");
    }
}
