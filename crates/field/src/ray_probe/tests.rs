//! Tests of rays in scenes with known surfaces, and comparisons with a second tracer.

use proptest::prelude::*;

use super::{Deciding, Ray, RayProbe, RayStatistics, Traced};
use crate::graph::{FrameInputs, Point};
use crate::region::{RegionOptions, RegionPlan, RegionStats};
use crate::world::World;
use crate::world::testing::{SPEAKERS, world_of};

const NARROW: f32 = 1e-4;

fn frame_of(world: &World, time: f32) -> FrameInputs {
    let params = world.scene.params.iter().map(|param| param.default).collect();
    let mut frame = FrameInputs { time, params, ..FrameInputs::default() };
    frame.eye = world.frame_tape.values(&frame).camera.position;
    frame.hoisted = world.hoisted.values(&frame);
    frame
}

fn with_ray_probe<T>(world: &World, time: f32, cells: bool, look: impl FnOnce(&RayProbe<'_>) -> T) -> T {
    let frame = frame_of(world, time);
    let options = RegionOptions { cells: cells || world.non_lipschitz, ..RegionOptions::default() };
    let regions = RegionPlan::new(world).build(&frame, &options);
    let planes = world.frame_tape.values(&frame).planes;
    look(&RayProbe::new(world, &regions, &frame, &planes))
}

fn ray(origin: [f32; 3], to: [f32; 3]) -> Ray {
    let way: [f32; 3] = std::array::from_fn(|axis| to[axis] - origin[axis]);
    let length = way.iter().map(|part| part * part).sum::<f32>().sqrt();
    Ray { origin, direction: way.map(|part| part / length), spread: NARROW }
}

fn near(a: [f32; 3], b: [f32; 3], by: f32) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= by)
}

const KNOWN: &str = "\
object floor { shape = y + 1 }
object ball {
  shape = sphere(p - vec3(0, 0, 5), 1)
}
object pair { shape = union(
  box(p - vec3(3, 0, 5), vec3(0.5)),
  sphere(p - vec3(-3, 0, 5), 0.5)) }";

#[test]
fn a_ray_that_creeps_along_a_flat_value_is_capped() {
    let world = world_of("0.25 * (y + 0.001 * sin(x))");
    with_ray_probe(&world, 0.0, false, |ray_probe| {
        let along = ray_probe.trace(&ray([0.0, 0.01, 0.0], [1.0, 0.01, 0.0]));
        assert!(along.capped && along.hit.is_none() && along.evaluations == 128, "{along:?}");
        let down = ray_probe.trace(&ray([0.0, 1.0, 0.0], [0.0, 0.0, 0.0]));
        assert!(!down.capped && down.hit.is_some(), "{down:?}");
        let up = ray_probe.trace(&ray([0.0, 1.0, 0.0], [0.0, 2.0, 0.0]));
        assert!(!up.capped && up.hit.is_none(), "{up:?}");
    });
}

#[test]
fn rays_that_end_at_the_bound_of_a_cell_meet_no_surface() {
    let world = world_of(
        "object balls { shape = sphere(repeat(p, vec3(2, 0, 2)), 0.9)  bound = other_cells(p, vec3(2, 0, 2), 0.9) }",
    );
    for cells in [true, false] {
        with_ray_probe(&world, 0.0, cells, |ray_probe| {
            for (to, meets) in [([0.3, 0.35, 1.0], false), ([0.9, 0.2, 0.7], false), ([0.3, -0.4, 1.0], true)]
            {
                let ray = Ray { spread: 0.02, ..ray([0.0, 1.6, -5.0], [to[0], 1.6 + to[1], to[2] - 5.0]) };
                let traced = ray_probe.trace(&ray);
                assert_eq!(traced.hit.is_some(), meets, "{to:?}: {traced:?}");
            }
        });
    }
}

#[test]
fn rays_hit_a_ball_a_wall_a_floor_and_the_sky() {
    let world = world_of(KNOWN);
    for cells in [true, false] {
        with_ray_probe(&world, 0.0, cells, |ray_probe| {
            let looks = |to: [f32; 3], distance: f32, object: usize, normal: [f32; 3]| {
                let ray = ray([0.0; 3], to);
                let hit = ray_probe.trace(&ray).hit.unwrap_or_else(|| panic!("nothing towards {to:?}"));
                assert!((hit.distance - distance).abs() < 2e-3, "{hit:?}, not {distance}");
                assert!(near(hit.position, ray.at(distance), 2e-3), "{hit:?}");
                assert_eq!(hit.object, object, "{hit:?}");
                let found = ray_probe.normal(&ray, &hit);
                assert!(near(found, normal, 5e-3), "{found:?}, not {normal:?}");
            };
            looks([0.0, 0.0, 5.0], 4.0, 1, [0.0, 0.0, -1.0]);
            let to = [3.0, 0.0, 4.5];
            looks(to, (9.0_f32 + 4.5 * 4.5).sqrt(), 2, [0.0, 0.0, -1.0]);
            looks([1.0, -1.0, 0.0], 2.0_f32.sqrt(), 0, [0.0, 1.0, 0.0]);
            assert_eq!(ray_probe.trace(&ray([0.0; 3], [0.0, 1.0, 0.2])).hit, None);
        });
    }
}

#[test]
fn a_part_of_a_union_is_identified_by_its_line() {
    let world = world_of(KNOWN);
    with_ray_probe(&world, 0.0, true, |ray_probe| {
        let pair = Deciding::new(&world.scene.graph, world.scene.objects[2].shape);
        for (to, words) in [([3.0, 0.0, 5.0], "box(p"), ([-3.0, 0.0, 5.0], "sphere(p - vec3(-3")] {
            let hit = ray_probe.trace(&ray([0.0; 3], to)).hit.unwrap();
            let path = ray_probe.path(&hit, Some(&pair));
            let (_, bytes) = world.scene.origins.written_at(*path.last().unwrap()).unwrap();
            assert!(KNOWN[bytes.clone()].starts_with(words), "{}", &KNOWN[bytes]);
        }
        let floor = ray_probe.trace(&ray([0.0; 3], [0.0, -1.0, 0.1])).hit.unwrap();
        let path = ray_probe.path(&floor, None);
        let (_, bytes) = world.scene.origins.written_at(*path.last().unwrap()).unwrap();
        assert_eq!(&KNOWN[bytes], "y + 1");
    });
}

#[test]
fn a_formula_that_is_no_distance_is_hit_where_its_sign_changes() {
    let world = world_of("x^2 + y^2 + 4 * z^2 - 1 + 0.2 * x * y");
    assert!(world.non_lipschitz, "the test needs a formula that is not a distance");
    with_ray_probe(&world, 0.0, true, |ray_probe| {
        let ray = ray([0.0, 0.0, -3.0], [0.0; 3]);
        let hit = ray_probe.trace(&ray).hit.unwrap();
        assert!((hit.distance - 2.5).abs() < 1e-3, "{hit:?}");
        assert!(near(ray_probe.normal(&ray, &hit), [0.0, 0.0, -1.0], 1e-2));
    });
}

/// Traces a ray in a second way: short steps with the graph's own evaluator, without the tree.
fn marched(world: &World, frame: &FrameInputs, ray: &Ray, far: f32) -> Option<f32> {
    let at = |t: f32| {
        let [x, y, z] = ray.at(t);
        world.scene.graph.evaluate(&[world.scene.distance], &Point::at(x, y, z), frame)[0]
    };
    let step = 2e-3;
    let mut t = 0.0;
    while t < far {
        let value = at(t);
        if value < 0.0 {
            let (mut outside, mut inside) = (t - step, t);
            for _ in 0..20 {
                let middle = 0.5 * (outside + inside);
                if at(middle) < 0.0 { inside = middle } else { outside = middle }
            }
            return Some(inside);
        }
        t += step.max(0.5 * value);
    }
    None
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn hits_agree_with_the_fields_own_evaluator(
        aim in prop::array::uniform3(-1.0..1.0_f32),
        from in prop::array::uniform3(-4.0..4.0_f32),
        cells in any::<bool>(),
    ) {
        let world = world_of(
            "smooth_union(sphere(p - vec3(0.5, 0, 0), 0.8), box(p + vec3(0.6, 0.2, 0), vec3(0.5)), 0.2)",
        );
        let frame = frame_of(&world, 0.0);
        let inside = |p: [f32; 3]| {
            world.scene.graph.evaluate(&[world.scene.distance], &Point::at(p[0], p[1], p[2]), &frame)[0] < 0.1
        };
        prop_assume!(!inside(from) && from != aim);
        let ray = ray(from, aim);
        let found = with_ray_probe(&world, 0.0, cells, |ray_probe| ray_probe.trace(&ray).hit.map(|hit| hit.distance));
        let wanted = marched(&world, &frame, &ray, 20.0);
        match (found, wanted) {
            (Some(found), Some(wanted)) if (found - wanted).abs() < 0.01 => {}
            // The cone of a grazing ray may hit although its centre line misses, or may hit before the line does.
            (Some(found), wanted) => {
                prop_assert!(wanted.is_none_or(|wanted| found < wanted), "{found}, not {wanted:?}");
                let [x, y, z] = ray.at(found);
                let value = world.scene.graph.evaluate(&[world.scene.distance], &Point::at(x, y, z), &frame)[0];
                prop_assert!(value < 2e-3, "{value}");
            }
            (None, Some(wanted)) => prop_assert!(false, "passed the surface at {wanted}"),
            (None, None) => {}
        }
    }
}

/// Regression: a pixel's cone meets the surface before its ray does; how long before depends on the angle.
#[test]
fn a_ray_that_grazed_a_surface_was_taken_for_one_that_missed_it() {
    let world = world_of(
        "smooth_union(sphere(p - vec3(0.5, 0, 0), 0.8), box(p + vec3(0.6, 0.2, 0), vec3(0.5)), 0.2)",
    );
    let ray = ray([-3.311_311_5, -0.367_897_27, 0.574_094_06], [0.0, 0.0, 0.469_182_85]);
    let found =
        with_ray_probe(&world, 0.0, false, |ray_probe| ray_probe.trace(&ray).hit.map(|hit| hit.distance))
            .unwrap();
    let wanted = marched(&world, &frame_of(&world, 0.0), &ray, 20.0).unwrap();
    assert!(found < wanted && wanted - found < 0.02, "{found}, {wanted}");
    let [x, y, z] = ray.at(found);
    let point = Point::at(x, y, z);
    let value = world.scene.graph.evaluate(&[world.scene.distance], &point, &frame_of(&world, 0.0))[0];
    assert!((0.0..2e-3).contains(&value), "{value}");
}

fn surveyed(world: &World, columns: usize, rows: usize) -> RayStatistics {
    with_ray_probe(world, 1.0, true, |ray_probe| {
        let eye = [0.0, 0.3, -1.0];
        let ray_at = |x: f64, y: f64| {
            let (x, y) = (2.0 * x as f32 - 1.0, 1.0 - 2.0 * y as f32);
            Ray { spread: 0.01, ..ray(eye, [eye[0] + x, eye[1] + y, eye[2] + 1.0]) }
        };
        RayStatistics::of(ray_probe, columns, rows, ray_at, || true).unwrap()
    })
}

#[test]
fn statistics_count_rays_and_clauses_by_object() {
    let world = world_of(KNOWN);
    let ray_statistics = surveyed(&world, 48, 32);
    assert_eq!(ray_statistics.cells.len(), 48 * 32);
    let rays: u32 = ray_statistics.objects.iter().map(|object| object.rays).sum();
    assert_eq!((rays + ray_statistics.sky.0) as usize, 48 * 32);
    for object in &ray_statistics.objects {
        assert!(object.rays > 0 && object.clauses.0 > 0, "{object:?}");
    }
    let names: Vec<&str> = ray_statistics.objects.iter().map(|object| object.name.as_str()).collect();
    assert_eq!(names, ["floor", "ball", "pair"]);
    let line = |byte: usize| KNOWN[..byte].matches('\n').count() + 1;
    let of_pair: Vec<Vec<usize>> = ray_statistics
        .parts
        .iter()
        .filter(|part| part.object == 2)
        .map(|part| part.places.iter().map(|(_, byte)| line(*byte)).collect())
        .collect();
    assert!(
        of_pair.len() == 2 && of_pair.iter().any(|lines| lines.contains(&6) && !lines.contains(&7)),
        "{of_pair:?}"
    );
    let [floor, ball, pair] = &ray_statistics.objects[..] else { panic!("{:?}", ray_statistics.objects) };
    assert_eq!([floor, ball].map(|object| object.parts.len()), [1, 1]);
    let written: Vec<&str> = pair.parts.iter().map(|part| &KNOWN[part.written.1.clone()]).collect();
    assert!(written.len() == 2 && written.contains(&"box(p - vec3(3, 0, 5), vec3(0.5))"), "{written:?}");
    assert_eq!(pair.rays, pair.parts.iter().map(|part| part.rays).sum::<u32>());
    assert_eq!(pair.run, pair.parts.iter().map(|part| part.run).sum::<u64>());
    assert!(pair.parts[0].run >= pair.parts[1].run && pair.parts[1].rays > 0, "{:?}", pair.parts);
    let at = |row: usize| ray_statistics.cells[row * 48 + 24];
    let ball = ray_statistics.parts.iter().position(|part| part.object == 1).unwrap() as u16 + 1;
    assert_eq!((at(17), at(0)), (ball, 0));
}

#[test]
fn parts_of_a_smooth_union_are_distinguished_by_the_nearer_one() {
    let text = "object one { shape = smooth_union(\n  box(p - vec3(1.5, 0, 5), vec3(1)),\n  \
                sphere(p - vec3(-1.5, 0, 5), 1),\n  sphere(p - vec3(0, 1.5, 5), 0.5), 0.8) }\n\
                object dented { shape = smooth_subtract(box(p - vec3(0, -4, 5), vec3(1)),\n  \
                sphere(p - vec3(0, -4, 4), 0.6), 0.1) }\n\
                let q = abs(p - vec3(0, 4, 5)) - 1\n\
                object by_hand { shape = length(max(q, vec3(0))) + min(max(q.x, q.y, q.z), 0) }";
    let world = world_of(text);
    let written = |to: [f32; 3]| {
        with_ray_probe(&world, 0.0, true, |ray_probe| {
            let hit =
                ray_probe.trace(&ray([0.0; 3], to)).hit.unwrap_or_else(|| panic!("nothing towards {to:?}"));
            let deciding = Deciding::new(&world.scene.graph, world.scene.objects[hit.object].shape);
            let path = ray_probe.path(&hit, Some(&deciding));
            let known = path.iter().rev().find_map(|node| world.scene.origins.written_at(*node));
            text[known.unwrap_or_else(|| panic!("the part at {to:?} has no origin in the text")).1].to_owned()
        })
    };
    for (to, words) in [
        ([1.5, 0.0, 5.0], "box(p - vec3(1.5, 0, 5), vec3(1))"),
        ([-1.5, 0.0, 5.0], "sphere(p - vec3(-1.5, 0, 5), 1)"),
        ([0.0, 1.5, 5.0], "sphere(p - vec3(0, 1.5, 5), 0.5)"),
        ([0.8, -4.0, 4.0], "box(p - vec3(0, -4, 5), vec3(1))"),
        ([0.0, -4.0, 4.5], "sphere(p - vec3(0, -4, 4), 0.6)"),
        // This sum contains a minimum and maxima, but it is not a union.
        ([0.0, 4.0, 5.0], "length(max(q, vec3(0))) + min(max(q.x, q.y, q.z), 0)"),
    ] {
        assert_eq!(written(to), words, "{to:?}");
    }
}

#[test]
fn unwanted_statistics_are_cancelled() {
    let world = world_of(SPEAKERS);
    with_ray_probe(&world, 1.0, true, |ray_probe| {
        let ray_at = |_: f64, _: f64| ray([0.0, 3.0, -3.0], [0.0, 3.0, 10.0]);
        let rounds = std::cell::Cell::new(0);
        let is_wanted = || {
            rounds.set(rounds.get() + 1);
            rounds.get() < 5
        };
        assert_eq!(RayStatistics::of(ray_probe, 4, 1_000_000_000, ray_at, is_wanted), None);
    });
}

#[derive(Debug)]
struct Cost {
    stats: RegionStats,
    evaluations: u64,
    clauses: u64,
}

/// Counts what 1,600 rays run.
fn cost_of(text: &str) -> Cost {
    let world = world_of(text);
    let frame = frame_of(&world, 0.0);
    let options = RegionOptions { texels_max: 1 << 22, ..RegionOptions::default() };
    let regions = RegionPlan::new(&world).build(&frame, &options);
    let ray_probe = RayProbe::new(&world, &regions, &frame, &[]);
    let mut cost = Cost { stats: regions.stats, evaluations: 0, clauses: 0 };
    for place in 0..40 * 40 {
        let [x, y] = [place % 40, place / 40].map(|along| 0.35 * (along as f32 - 19.5));
        let traced = ray_probe.trace(&ray(frame.eye, [x, y, 0.0]));
        cost.evaluations += u64::from(traced.evaluations);
        cost.clauses += traced.clauses;
    }
    cost
}

/// Regression: a box that was too large, and cells without grandchildren, left hundreds of clauses in each cell.
#[test]
fn a_union_of_a_thousand_things_runs_few_clauses() {
    let cost = cost_of(include_str!("../../benches/things.scene"));
    assert!(cost.stats.whole_clauses > 10_000, "{cost:?}");
    assert!(cost.evaluations > 1_600 && cost.clauses < 64 * cost.evaluations, "{cost:?}");
    assert!(cost.stats.passes < 4_000, "{cost:?}");
}

/// Regression: each link of a chain lowered the lower bound, so that all balls seemed to overlap.
#[test]
fn a_long_chain_of_blends_runs_few_clauses() {
    let pasted = (0..80)
        .fold("ball(p, 100)".to_owned(), |chain, ball| format!("mixed({chain}, ball(p, {ball}), 0.6)"));
    for (chain, most) in [("smooth_union(for i in 0..200: ball(p, i), 0.6)", 28), (&pasted, 40)] {
        let cost = cost_of(&format!(
            "fn place(i) = vec3(14, 7, 14) * (vec3(cell_hash(i, 1), cell_hash(i, 2), cell_hash(i, 3)) - 0.5)
            fn ball(p, i) = sphere(p - place(i), 0.3)
            fn mixed(a, b, k) {{
              let h = clamp(0.5 + 0.5 * (b - a) / k, 0, 1)
              mix(b, a, h) - k * h * (1 - h)
            }}
            object balls {{ shape = {chain} }}
            camera {{ position = vec3(9, 6, -11) target = vec3(0) }}",
        ));
        assert!(cost.stats.whole_clauses > 900, "{cost:?}");
        assert!(cost.evaluations > 1_600 && cost.clauses < most * cost.evaluations, "{cost:?}");
    }
}

/// Regression: no term of a sum was ever left out.
#[test]
fn exponentials_too_small_to_count_are_left_out() {
    let cost = cost_of(
        "fn place(i) = vec3(14, 7, 14) * (vec3(cell_hash(i, 1), cell_hash(i, 2), cell_hash(i, 3)) - 0.5)
        object balls { shape = -log(sum(for i in 0..60: exp(-20 * sphere(p - place(i), 0.5)))) / 20 }
        camera { position = vec3(9, 6, -11) target = vec3(0) }",
    );
    assert!(cost.stats.whole_clauses > 400, "{cost:?}");
    assert!(cost.evaluations > 800 && cost.clauses < 40 * cost.evaluations, "{cost:?}");
}

#[test]
fn clauses_are_counted_where_they_are_run() {
    let world = world_of("object a { shape = sphere(p - vec3(0, 0, 5), 1) }");
    with_ray_probe(&world, 0.0, false, |ray_probe| {
        let Traced { evaluations, clauses, .. } = ray_probe.trace(&ray([0.0; 3], [0.0, 0.0, 1.0]));
        let whole = ray_probe.regions.clauses_of(ray_probe.regions.whole_tape);
        assert!(evaluations > 0 && whole > 0);
        assert_eq!(clauses, u64::from(evaluations) * whole);
    });
}
