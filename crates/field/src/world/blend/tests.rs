//! Tests that compare blends with their two scenes.

use super::*;
use crate::graph::{FrameInputs, Interval, Point, cell_hash};
use crate::lang::LightKind;
use crate::tape::{PointEvaluator, Tape};
use crate::world::testing::{SPEAKERS, world_of};
use proptest::prelude::*;

const SHAPES: [&str; 4] =
    ["sphere(q, 1.2)", "box(q, vec3(1, 0.7, 0.4))", "torus(q, 1, 0.3)", "round_box(q, vec3(0.8), 0.2)"];

fn scene((shape, other): (usize, usize), [x, y, z]: [f32; 3], floor: Option<f32>) -> World {
    let floor = floor.map_or(String::new(), |height| format!("object floor {{ shape = p.y + {height} }}\n"));
    let [shape, other] = [shape, other].map(|number| SHAPES[number % SHAPES.len()]);
    world_of(&format!(
        "fn first(q) = {shape}\nfn second(q) = {other}\n{floor}\
         object first {{ shape = first(p - vec3({x}, {y}, {z})) }}\n\
         object second {{ shape = second(p - vec3({z}, {x}, {y})) }}\n"
    ))
}

fn scenes() -> impl Strategy<Value = World> {
    let places = prop::array::uniform3(-3.0..3.0f32);
    (0..4usize, 0..4usize, places, prop::option::of(2.0..6.0f32))
        .prop_map(|(shape, other, place, floor)| scene((shape, other), place, floor))
}

fn params(from: &World, to: &World, fraction: f32) -> Vec<f32> {
    let both = [from, to].into_iter().flat_map(|world| &world.scene.params);
    both.map(|param| param.default).chain([fraction]).collect()
}

/// Returns a frame at a fraction, seen from far away, so that no solid shrinks because of the eye.
fn frame(from: &World, to: &World, fraction: f32) -> FrameInputs {
    FrameInputs { eye: [10.0, 200.0, -300.0], params: params(from, to, fraction), ..FrameInputs::default() }
}

fn value(world: &World, root: NodeId, p: [f32; 3], inputs: &FrameInputs) -> f32 {
    world.scene.graph.evaluate(&[root], &Point::at(p[0], p[1], p[2]), inputs)[0]
}

fn distance(world: &World, p: [f32; 3], inputs: &FrameInputs) -> f32 {
    value(world, world.scene.distance, p, inputs)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn a_melt_adds_no_solids_and_has_the_slope_of_a_distance(
        (a, b) in (scenes(), scenes()),
        fraction in 0.0..=1.0f32,
        points in prop::collection::vec(prop::array::uniform3(-5.0..5.0f32), 96),
    ) {
        let melt = World::blend(&a, &b, BlendKind::Melt, &Alignment::NONE, 0.5).unwrap();
        prop_assert!(!melt.non_lipschitz);
        let inputs = frame(&a, &b, fraction);
        let silence = FrameInputs::default();
        let mut before: Option<([f32; 3], f32)> = None;
        for p in points {
            let melted = distance(&melt, p, &inputs);
            let [own, other] = [&a, &b].map(|world| distance(world, p, &silence));
            if a.planes.is_empty() || b.planes.is_empty() {
                prop_assert!(melted >= own.min(other) - 1e-3, "{melted} at {p:?} is less than {own} and {other}");
            }
            if let Some((q, other)) = before {
                let way = (0..3).map(|axis| (p[axis] - q[axis]).powi(2)).sum::<f32>().sqrt();
                prop_assert!((melted - other).abs() <= 1.0001 * way + 1e-4, "from {q:?} to {p:?}");
            }
            before = Some((p, melted));
        }
    }

    #[test]
    fn intervals_hold_what_is_in_them(
        (a, b) in (scenes(), scenes()),
        fraction in 0.0..=1.0f32,
        low in prop::array::uniform3(-6.0..6.0f32),
        size in 0.01..4.0f32,
    ) {
        for (kind, ..) in BlendKind::ALL {
            let blend = World::blend(&a, &b, kind, &Alignment::NONE, 0.5).unwrap();
            let tape = Tape::new(&blend.scene.graph, &[blend.scene.distance]);
            let inputs = frame(&a, &b, fraction);
            let ([x, y, z], none) = (low.map(|low| Interval::new(low, low + size)), Interval::point(0.0));
            let over = [x, y, z, none, none, none];
            let bounds = blend.scene.graph.bounds(blend.scene.distance, over, &inputs);
            let mut points = PointEvaluator::new(&tape, &inputs);
            for corner in 0..27 {
                let at = |axis: i32| low[axis as usize] + 0.5 * size * (corner / 3_i32.pow(axis as u32) % 3) as f32;
                let value = points.at(&Point::at(at(0), at(1), at(2)))[0];
                prop_assert!(bounds.lo <= value && value <= bounds.hi, "{value} is not in {bounds:?}");
            }
        }
    }

    #[test]
    fn solids_above_the_planes_are_within_the_bounds(
        (heights, kinds) in (prop::array::uniform2(2.0..6.0f32), prop::array::uniform2(0..4usize)),
        places in prop::array::uniform2(prop::array::uniform3(-2.0..2.0f32)),
        fraction in 0.0..=1.0f32,
        points in prop::collection::vec(prop::array::uniform3(-12.0..12.0f32), 64),
    ) {
        let [a, b] = [0, 1].map(|side| scene((kinds[side], kinds[1 - side]), places[side], Some(heights[side])));
        let melt = World::blend(&a, &b, BlendKind::Melt, &Alignment::NONE, 0.5).unwrap();
        let bounds = melt.bounds.unwrap();
        let inputs = frame(&a, &b, fraction);
        prop_assert_eq!(melt.planes.len(), 1);
        let mixed = inputs.params.last().copied().unwrap();
        for p in points {
            let plane = value(&melt, melt.planes[0].shape, p, &inputs);
            let height = (1.0 - mixed) * heights[0] + mixed * heights[1];
            prop_assert!((plane - p[1] - height).abs() < 1e-4);
            prop_assert!(plane < 0.0 || bounds.hold(p) || distance(&melt, p, &inputs) > 0.0, "{p:?}");
        }
    }

    #[test]
    fn a_portal_has_one_scene_inside_and_the_other_outside(
        (a, b) in (scenes(), scenes()),
        fraction in 0.1..0.9f32,
        ball in any::<bool>(),
        points in prop::collection::vec(prop::array::uniform3(-8.0..8.0f32), 24),
    ) {
        let shape = if ball { PortalShape::Ball } else { PortalShape::Plane };
        let blend = World::blend(&a, &b, BlendKind::Portal(shape), &Alignment::NONE, 0.5).unwrap();
        let inputs = frame(&a, &b, fraction);
        let camera = blend.frame_tape.values(&inputs).camera;
        let length = (0..3).map(|axis| (camera.target[axis] - camera.position[axis]).powi(2)).sum::<f32>().sqrt();
        for p in points {
            let away = match shape {
                PortalShape::Ball => {
                    let off = (0..3).map(|axis| (p[axis] - camera.target[axis]).powi(2)).sum::<f32>().sqrt();
                    off - length * fraction / (1.0 - fraction)
                }
                // Both cameras are the default one and look along z.
                PortalShape::Plane | PortalShape::Own => p[0] - camera.target[0] - length * (1.0 / (1.0 - fraction) - 1.0 / fraction),
            };
            let own = distance(if away < 0.0 { &b } else { &a }, p, &FrameInputs::default());
            if away.abs() > 1e-3 && own.abs() > 1e-3 {
                let is_solid = distance(&blend, p, &inputs) < 0.0;
                prop_assert_eq!(is_solid, own < 0.0, "{:?}, {} from the portal", p, away);
            }
        }
    }
}

const RICH: &str = "param size = 1.5 in 0 .. 3\nparam glow = 0.25 in 0 .. 1\n\
    material red { color = vec3(0.8, 0.1, glow) roughness = 0.9 emission = vec3(glow, 0, 0) }\n\
    material floor { color = 0.3 reflect = 0.5 }\n\
    object ball { shape = sphere(p - vec3(0, 1, 4), size) material = red }\n\
    object floor { shape = 2 * p.y + 1 material = floor }\n\
    light sun { direction = vec3(0, -1, 0.5) color = vec3(2, 1, 1) }\n\
    light lamp { position = vec3(1, 5, 0) color = 30 }\n\
    sky { color = vec3(direction.y, 0.2, 0.3) ambient = 0.1 reach = 2 }\n\
    camera { position = vec3(0, 1, 9) target = vec3(0, 1, 4) fov = 60 roll = 0.2 aperture = 0.1 }\n\
    picture { exposure = 2 tone_map = none }";

#[test]
fn at_either_end_a_blend_is_the_scene_there() {
    let (a, b) = (world_of(RICH), world_of(SPEAKERS));
    let silence = |world: &World| FrameInputs {
        params: world.scene.params.iter().map(|param| param.default).collect(),
        ..FrameInputs::default()
    };
    for (kind, name, _) in BlendKind::ALL {
        let blend = World::blend(&a, &b, kind, &Alignment::NONE, 0.5).unwrap();
        for (fraction, alone) in [(0.0, &a), (1.0, &b)] {
            let near = |found: f32, expected: f32| (found - expected).abs() <= 1e-4 * (1.0 + expected.abs());
            let (found, expected) =
                (blend.frame_tape.values(&frame(&a, &b, fraction)), alone.frame_tape.values(&silence(alone)));
            let numbers = found.camera.numbers().into_iter().zip(expected.camera.numbers());
            for ((number, expected), field) in
                numbers.zip(["x", "y", "z", "x", "y", "z", "fov", "roll", "lens"])
            {
                assert!(near(number, expected), "{name} at {fraction}: {field} is {number}, not {expected}");
            }
            assert!(near(found.reach, expected.reach));
            for (number, expected) in found.picture.numbers().into_iter().zip(expected.picture.numbers()) {
                // Infinite numbers are not near each other.
                let is_same = number == expected || near(number, expected);
                assert!(is_same, "{name} at {fraction}: {number} and {expected}");
            }
            let shining = found.lights.iter().filter(|light| light.color != [0.0; 3]).cloned();
            assert_eq!(shining.collect::<Vec<_>>(), expected.lights, "{name} at {fraction}");
            let point = Point { position: [0.2, -0.5, 3.1], normal: [0.0, 1.0, 0.0] };
            let of = |world: &World, roots: &[NodeId], inputs: &FrameInputs| {
                world.scene.graph.evaluate(roots, &point, inputs)
            };
            let floor = alone.scene.objects.iter().find(|object| object.name == "floor").unwrap();
            let expected = of(alone, &alone.scene.materials[floor.material].numbers(), &silence(alone));
            let found = of(&blend, &blend.scene.materials[0].numbers(), &frame(&a, &b, fraction));
            for (found, expected) in found.iter().zip(&expected) {
                assert!(near(*found, *expected), "{name} at {fraction}: {found} and {expected}");
            }
            let sky = of(&blend, &blend.scene.sky.color, &frame(&a, &b, fraction));
            assert_eq!(sky, of(alone, &alone.scene.sky.color, &silence(alone)));
        }
    }
}

#[test]
fn a_portal_of_a_scene_has_the_shape_that_it_names() {
    // The portal is an eighth of space: to the right of the target, above it, and nearer than it.
    let outside = world_of("sphere(p + vec3(0, 50, 0), 1)\nabout { portal = 1 }");
    let corner = world_of(
        "param k = 0.25 in 0 .. 1\nabout { portal = max(k - p.x, k - p.y, k - p.z) }\n-1\n\
         camera { position = vec3(0, 4, -3) target = vec3(0) }",
    );
    let shape = BlendKind::Portal(PortalShape::Own);
    let blend = World::blend(&outside, &corner, shape, &Alignment::NONE, 0.5).unwrap();
    let solid = |fraction: f32, [right, up, near]: [f32; 3]| {
        let inputs = FrameInputs { eye: [-1e5, -1e5, 1e5], ..frame(&outside, &corner, fraction) };
        let camera = blend.frame_tape.values(&inputs).camera;
        let view = [0, 1, 2].map(|axis| camera.target[axis] - camera.position[axis]);
        let length = view.iter().map(|part| part * part).sum::<f32>().sqrt();
        let size = length * fraction / (1.0 - fraction);
        let [x, y, z] = view.map(|part| part / length);
        let level = (x * x + z * z).sqrt();
        let (to_right, above) = ([z / level, 0.0, -x / level], [-y * x / level, level, -y * z / level]);
        let p = [0, 1, 2].map(|axis| {
            let way = right * to_right[axis] + up * above[axis] - near * [x, y, z][axis];
            camera.target[axis] + size * way
        });
        distance(&blend, p, &inputs) < -1e-4
    };
    for fraction in [0.3, 0.5, 0.7] {
        assert!(solid(fraction, [0.4, 0.4, 0.4]), "inside at {fraction}");
        for outside in [[0.1, 0.4, 0.4], [0.4, 0.1, 0.4], [0.4, 0.4, 0.1], [-0.4, 0.4, 0.4]] {
            assert!(!solid(fraction, outside), "{outside:?} at {fraction}");
        }
    }
    assert!(!solid(0.001, [9.0, 9.0, 9.0]), "the infinite shape emerges from a point");
    assert!(solid(0.999, [-0.1, -0.1, -0.1]), "it is filled up in the end");

    let nameless = world_of("sphere(p, 1)");
    let [own, ball] = [PortalShape::Own, PortalShape::Ball].map(|shape| {
        World::blend(&outside, &nameless, BlendKind::Portal(shape), &Alignment::NONE, 0.5).unwrap()
    });
    assert_eq!(own.roots, ball.roots, "a scene without its own shape appears in a ball");
}

#[test]
fn materials_at_a_portals_cut_do_not_depend_on_rounding() {
    let [solid, empty] = ["1", "0"].map(|color| {
        let shape = if color == "1" { "length(p) - 50" } else { "length(p - vec3(0, 90, 0)) - 1" };
        world_of(&format!("material m {{ color = {color} }}\nobject o {{ shape = {shape} material = m }}"))
    });
    let portal = BlendKind::Portal(PortalShape::Ball);
    for (from, to, color) in [(&solid, &empty, 1.0), (&empty, &solid, 1.0)] {
        let blend = World::blend(from, to, portal, &Alignment::NONE, 0.5).unwrap();
        let inputs = frame(from, to, 0.5);
        let camera = blend.frame_tape.values(&inputs).camera;
        let radius =
            (0..3).map(|axis| (camera.target[axis] - camera.position[axis]).powi(2)).sum::<f32>().sqrt();
        for number in 0..200 {
            let off = [0, 1, 2].map(|axis| cell_hash(number as f32, axis as f32) - 0.5);
            let length = off.iter().map(|part| part * part).sum::<f32>().sqrt();
            let near = radius * (1.0 + 1e-4 * (cell_hash(number as f32, 3.0) - 0.5));
            let p = [0, 1, 2].map(|axis| camera.target[axis] + off[axis] / length * near);
            let found = value(&blend, blend.scene.materials[0].color[0], p, &inputs);
            assert_eq!(found, color, "{p:?}");
        }
    }
}

#[test]
fn a_melt_has_no_more_mirrors_and_lamps_than_one_scene() {
    let [matt, bright] = [(0.0, -9), (0.4, 9)].map(|(reflect, x)| {
        world_of(&format!(
            "material m {{ reflect = {reflect} }}\nobject o {{ shape = sphere(p, 1) material = m }}\n\
             light l {{ position = vec3({x}, 9, 0) color = 1 }}"
        ))
    });
    for (from, to, mirrors) in [
        (&matt, &bright, [0.0, 0.0, 0.2, 0.4]),
        (&bright, &matt, [0.4, 0.2, 0.0, 0.0]),
        (&bright, &bright, [0.4; 4]),
    ] {
        let melt = World::blend(from, to, BlendKind::Melt, &Alignment::NONE, 0.5).unwrap();
        for (fraction, mirror) in [0.0, 0.25, 0.75, 1.0].into_iter().zip(mirrors) {
            let inputs = frame(from, to, fraction);
            let found = value(&melt, melt.scene.materials[0].reflect, [0.0, 1.0, 0.0], &inputs);
            assert!((found - mirror).abs() < 1e-6, "{found} at {fraction}, not {mirror}");
            let lights = melt.frame_tape.values(&inputs).lights;
            let shining = lights.iter().filter(|light| light.color != [0.0; 3]).count();
            assert_eq!(shining, 1, "at {fraction}");
        }
        let both = melt.frame_tape.values(&frame(from, to, 0.5)).lights;
        assert!(both.iter().all(|light| light.color == [0.5; 3]), "{both:?}");
    }
}

#[test]
fn parameters_of_both_scenes_are_independent() {
    let (a, b) =
        (world_of("param r = 1 in 0 .. 2\nsphere(p, r)"), world_of("param r = 2 in 0 .. 4\nsphere(p, r)"));
    let melt = World::blend(&a, &b, BlendKind::Melt, &Alignment::NONE, 0.75).unwrap();
    let params = vec![1.5, 0.5, 0.25];
    let inputs = FrameInputs { params, ..frame(&a, &b, 0.25) };
    let [inside, outside] = [1.4, 1.6].map(|x| distance(&melt, [x, 0.0, 0.0], &inputs));
    assert!(inside < 0.0 && outside > 0.0, "{inside} {outside}");
    let defaults: Vec<f32> = melt.scene.params.iter().map(|param| param.default).collect();
    assert_eq!(defaults, [1.0, 2.0, 0.75]);
}

#[test]
fn far_from_a_scene_rays_are_as_fast_as_in_it_alone() {
    // Upwards from the ground, the ground's value rises as fast as the value in the tunnel's rock falls.
    let (ground, tunnel) = (world_of("p.y + 2 + 0*length(p)"), world_of("2 - length(p.xy)"));
    let melt = World::blend(&ground, &tunnel, BlendKind::Melt, &Alignment::NONE, 0.5).unwrap();
    let at = |x: f32, y: f32| distance(&melt, [x, y, 0.0], &frame(&ground, &tunnel, 0.5));
    for height in [10.0, 100.0, 400.0] {
        // The rock ends at a distance of 5 from the tunnel's axis.
        assert!(at(0.0, height) > 0.9 * (height - 5.0), "{} at {height}", at(0.0, height));
    }
    assert!(at(0.0, -3.5) >= -1.5, "solids may shrink only a little around the eye");
}

#[test]
fn materials_ran_off_their_surfaces_in_a_melt() {
    let [ball, wall] = [("sphere(p, 1)", "0"), ("p.z - 4 + 0*length(p)", "1")].map(|(shape, color)| {
        world_of(&format!("material m {{ color = {color} }}\nobject o {{ shape = {shape} material = m }}"))
    });
    let melt = World::blend(&ball, &wall, BlendKind::Melt, &Alignment::NONE, 0.5).unwrap();
    for fraction in [0.2, 0.5, 0.8] {
        let inputs = frame(&ball, &wall, fraction);
        let color = |p: [f32; 3]| value(&melt, melt.scene.materials[0].color[0], p, &inputs);
        let colors = [color([0.0, 0.9, 0.0]), color([3.0, 0.0, 3.9])];
        assert!(colors[0] < 1e-6 && colors[1] > 1.0 - 1e-6, "{colors:?} at {fraction}");
        assert!(distance(&melt, [0.0; 3], &inputs) < 0.0, "the ball is gone at {fraction}");
    }
}

#[test]
fn a_polynomial_melts_with_the_slope_of_a_distance() {
    // Barth's sextic has slope 0 at its double points; elsewhere its slope grows with the fifth power of the distance.
    let star = world_of(include_str!("../../../../../assets/scenes/barth.scene"));
    assert!(star.non_lipschitz);
    let ball = world_of("sphere(p - vec3(0, 2.5, 0), 1)");
    for (from, to) in [(&star, &ball), (&ball, &star)] {
        let melt = World::blend(from, to, BlendKind::Melt, &Alignment::NONE, 0.5).unwrap();
        assert!(!melt.non_lipschitz, "rays may step by it");
        for fraction in [0.1, 0.5, 0.9] {
            let inputs = frame(from, to, fraction);
            let random = |number: usize, axis: usize| cell_hash(number as f32, axis as f32);
            let non_lipschitz = (0..4_000).filter(|&number| {
                let p = [0, 1, 2].map(|axis| 8.0 * random(number, axis) - 4.0 + [0.0, 2.5, 0.0][axis]);
                let value = |p: [f32; 3]| value(&melt, melt.scene.distance, p, &inputs);
                let q = [0, 1, 2].map(|axis| p[axis] + 2e-3 * (random(number, axis + 3) - 0.5));
                let way = (0..3).map(|axis| (p[axis] - q[axis]).powi(2)).sum::<f32>().sqrt();
                (value(p) - value(q)).abs() > 1.1 * way + 1e-6
            });
            let non_lipschitz = non_lipschitz.count();
            assert!(non_lipschitz < 40, "{non_lipschitz} of 4000 at {fraction}");
        }
    }
}

#[test]
fn floors_of_any_slope_stay_planes() {
    let tilted = world_of("min(3 * p.y + p.x, sphere(p, 1))");
    let level = world_of("min(0.5 * p.y + 1, sphere(p, 1))");
    let melt = World::blend(&tilted, &level, BlendKind::Melt, &Alignment::NONE, 0.5).unwrap();
    assert_eq!(melt.planes.len(), 1);
    let inputs = frame(&tilted, &level, 0.5);
    let slopes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|p| {
        value(&melt, melt.planes[0].shape, p, &inputs) - value(&melt, melt.planes[0].shape, [0.0; 3], &inputs)
    });
    let non_lipschitz = 10.0_f32.sqrt();
    for (slope, expected) in
        slopes.into_iter().zip([0.5 / non_lipschitz, 0.5 * (3.0 / non_lipschitz + 1.0), 0.0])
    {
        assert!((slope - expected).abs() < 1e-5, "{slopes:?}");
    }
}

#[test]
fn values_that_are_not_distances_have_the_weight_of_one() {
    let polynomial = world_of("x^2 + 9/4*z^2 + y^2 - 1");
    assert!(polynomial.non_lipschitz);
    let ball = world_of("sphere(p, 1)");
    let melt = World::blend(&polynomial, &ball, BlendKind::Melt, &Alignment::NONE, 0.5).unwrap();
    assert!(!melt.non_lipschitz, "rays may step by it");
    let surface = |fraction: f32| {
        let inputs = frame(&polynomial, &ball, fraction);
        (0..2_000)
            .map(|step| step as f32 * 1e-3)
            .find(|z| distance(&melt, [0.0, 0.0, *z], &inputs) > 0.0)
            .unwrap()
    };
    let [begin, middle, end] = [0.0, 0.5, 1.0].map(surface);
    assert!((begin - 2.0 / 3.0).abs() < 2e-3 && (end - 1.0).abs() < 2e-3, "{begin} {end}");
    assert!((0.7..=1.0).contains(&middle), "{middle}");
}

#[test]
fn the_eye_is_never_in_a_solid() {
    let outside = world_of("sphere(p, 1)\ncamera { position = vec3(0, 0, -6) target = vec3(0) }");
    let inside = world_of(
        "1 - length(p.xy - vec2(20, 0))\ncamera { position = vec3(20, 0, 0) target = vec3(20, 0, 5) }",
    );
    for (kind, name, _) in BlendKind::ALL {
        let blend = World::blend(&outside, &inside, kind, &Alignment::NONE, 0.5).unwrap();
        for step in 0..=50 {
            let mut inputs = frame(&outside, &inside, step as f32 / 50.0);
            inputs.eye = blend.frame_tape.values(&inputs).camera.position;
            let free = distance(&blend, inputs.eye, &inputs);
            assert!(free > 0.4, "{name}: {free} at {step}");
        }
    }
}

#[test]
fn cameras_on_opposite_sides_go_around_their_target() {
    let camera = |z: f32| {
        world_of(&format!("sphere(p, 1)\ncamera {{ position = vec3(0, 1, {z}) target = vec3(0, 1, 0) }}"))
    };
    let (a, b) = (camera(-6.0), camera(6.0));
    let melt = World::blend(&a, &b, BlendKind::Melt, &Alignment::NONE, 0.5).unwrap();
    for step in 0..=20 {
        let camera = melt.frame_tape.values(&frame(&a, &b, step as f32 / 20.0)).camera;
        let [x, y, z] = camera.position;
        assert!((x.hypot(z) - 6.0).abs() < 1e-4 && (y - 1.0).abs() < 1e-5, "{:?}", camera.position);
        assert!(camera.focus.is_finite());
    }
}

#[test]
fn exceeded_limits_are_named() {
    let light = |number: i32| format!("light lamp{number} {{ position = vec3(0, 5, 0) color = 10 }}\n");
    let many = world_of(&format!("{}sphere(p, 1)", (0..9).map(light).collect::<String>()));
    assert_eq!(many.scene.lights[0].kind, LightKind::Lamp);
    let refused = World::blend(&many, &many, BlendKind::Melt, &Alignment::NONE, 0.5).unwrap_err().to_string();
    assert!(refused.contains("18 lights") && refused.contains("16"), "{refused}");
}

#[test]
fn a_kind_is_known_by_its_name() {
    for (kind, name, _) in BlendKind::ALL {
        assert_eq!(BlendKind::named(name), Some(kind));
    }
    assert_eq!(BlendKind::named("dissolve"), None);
}

#[test]
fn an_aligned_scene_is_seen_as_by_its_own_camera() {
    let (a, b) = (world_of(RICH), world_of(SPEAKERS));
    let silence = |world: &World| FrameInputs {
        time: 7.0,
        params: world.scene.params.iter().map(|param| param.default).collect(),
        ..FrameInputs::default()
    };
    let camera = |world: &World| world.frame_tape.values(&silence(world)).camera;
    let alignment = Alignment::of(&camera(&a), &camera(&b));
    let melt = World::blend(&a, &b, BlendKind::Melt, &alignment, 0.5).unwrap();
    let at = |fraction: f32| FrameInputs { time: 7.0, ..frame(&a, &b, fraction) };
    let near = |a: f32, b: f32| (a - b).abs() < 1e-3;
    // The eye does not move, and at the middle it looks as far to the side as either camera.
    for fraction in [0.0, 0.5, 1.0] {
        let found = melt.frame_tape.values(&at(fraction)).camera;
        for (axis, own) in camera(&a).position.into_iter().enumerate() {
            let room = if fraction == 0.5 { 0.8 } else { 1e-3 };
            assert!((found.position[axis] - own).abs() < room, "{fraction}: {:?}", found.position);
        }
    }
    let (found, own) = (melt.frame_tape.values(&at(1.0)), camera(&b));
    let seen = |camera: &crate::lang::Camera<f32>, way: [f32; 3]| {
        let [x, y, z] = [0, 1, 2].map(|axis| camera.target[axis] - camera.position[axis]);
        let level = x.hypot(z);
        let (sin, cos) = (x / level, z / level);
        let turned = [cos * way[0] + sin * way[2], way[1], cos * way[2] - sin * way[0]];
        (turned, [0, 1, 2].map(|axis| camera.position[axis] + turned[axis]), y)
    };
    for way in [[0.3, -0.2, 3.0], [-1.0, 0.4, 8.0], [2.0, -1.0, 11.0], [0.0, 3.0, 20.0]] {
        let ((direction, p, _), (own_direction, q, _)) = (seen(&found.camera, way), seen(&own, way));
        let (there, here) = (distance(&melt, p, &at(1.0)), distance(&b, q, &silence(&b)));
        assert!(near(there, here), "{there} and {here} on the way {way:?}");
        let sky = |world: &World, normal: [f32; 3], inputs: &FrameInputs| {
            let point = Point { position: [0.0; 3], normal };
            world.scene.graph.evaluate(&world.scene.sky.color, &point, inputs)
        };
        let (there, here) = (sky(&melt, direction, &at(1.0)), sky(&b, own_direction, &silence(&b)));
        assert!(there.iter().zip(&here).all(|(a, b)| near(*a, *b)), "{there:?} and {here:?}");
    }
    let away = |place: [f32; 3], eye: [f32; 3]| {
        (0..3).map(|axis| (place[axis] - eye[axis]).powi(2)).sum::<f32>().sqrt()
    };
    let own_light = &b.frame_tape.values(&silence(&b)).lights[0];
    let light = &found.lights[a.scene.lights.len()];
    assert!(near(away(light.position, found.camera.position), away(own_light.position, own.position)));
    assert_eq!(
        Alignment::of(&camera(&a), &crate::lang::Camera { position: [f32::NAN; 3], ..own }),
        Alignment::NONE
    );
}

/// The second scene is turned to the first scene's camera, but a pixel is a place in the picture.
#[test]
fn the_pixel_of_the_sky_stays_where_it_is() {
    let scene = |x: f32| {
        let camera = format!("camera {{ position = vec3({x}, 3, -4)  target = vec3(1, {x}, 0) }}");
        world_of(&format!("sky {{ color = vec3(pixel, {x}) }}\nsphere(p, 1)\n{camera}"))
    };
    let (a, b) = (scene(0.0), scene(6.0));
    let alignment = Alignment::of(
        &a.frame_tape.values(&FrameInputs::default()).camera,
        &b.frame_tape.values(&FrameInputs::default()).camera,
    );
    assert_ne!(alignment, Alignment::NONE);
    let melt = World::blend(&a, &b, BlendKind::Melt, &alignment, 0.5).unwrap();
    for (fraction, third) in [(0.0, 0.0), (0.5, 3.0), (1.0, 6.0)] {
        let sky =
            melt.scene.sky.color.map(|part| value(&melt, part, [30.0, 40.0, 0.0], &frame(&a, &b, fraction)));
        assert!(
            sky.iter().zip([30.0, 40.0, third]).all(|(a, b)| (a - b).abs() < 1e-4),
            "{sky:?} at {fraction}"
        );
    }
}

#[test]
fn a_melt_with_glass_showed_opaque_slabs() {
    let [bell, ball] = [
        "material glass { glass = 1 }\nobject bell { shape = sphere(p, 1)  material = glass }",
        "sphere(p, 2)",
    ]
    .map(world_of);
    for (from, to) in [(&bell, &ball), (&ball, &bell)] {
        let melt = World::blend(from, to, BlendKind::Melt, &Alignment::NONE, 0.5);
        assert!(matches!(melt, Err(BlendError::Glass(_))));
        let portal = World::blend(from, to, BlendKind::Portal(PortalShape::Ball), &Alignment::NONE, 0.5);
        assert!(portal.is_ok());
    }
}
