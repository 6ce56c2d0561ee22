//! Points of swarms, and rays through their trees.

use super::*;
use crate::limits::LIMITS;
use crate::world::testing::world_of;
use crate::world::{Alignment, BlendKind, TILE_PARTS, World};

const SIZE: [u32; 2] = [1000, 600];
/// An eye that looks towards +z, with 500 pixels to a slope of 0.5.
const VIEW: SwarmView = SwarmView {
    eye: [0.0, 1.0, -20.0],
    pixel: 0.0005,
    picture: Some(SwarmPicture {
        forward: [0.0, 0.0, 1.0],
        half: [[0.5, 0.0, 0.0], [0.0, 0.3, 0.0]],
        size: SIZE,
    }),
    mirror: None,
};

fn plan(world: &World) -> SwarmPlan {
    SwarmPlan::of(&world.scene, world.features.mirrors).unwrap()
}

fn points(text: &str, time: f32) -> Vec<Swarm<f32>> {
    let plan = plan(&world_of(text));
    plan.points(&FrameInputs { time, ..FrameInputs::default() }, 0..plan.point_count())
}

/// Returns the texels of all points that a ray may meet in a tree: 0 for the balls, 1 for everything faint.
fn walk(texels: &[[f32; 4]], tree: usize, origin: [f32; 3], direction: [f32; 3]) -> Vec<[f32; 4]> {
    let (first, count) = (texels[0][2 * tree] as usize, texels[0][2 * tree + 1] as usize);
    let (mut node, mut met) = (0, Vec::new());
    while node < count {
        let [low, high] = [0, 1].map(|corner| texels[first + 2 * node + corner]);
        let (mut enters, mut leaves) = (0.0f32, f32::INFINITY);
        for axis in 0..3 {
            let [a, b] = [low, high].map(|corner| (corner[axis] - origin[axis]) / direction[axis]);
            (enters, leaves) = (enters.max(a.min(b)), leaves.min(a.max(b)));
        }
        if enters > leaves {
            assert!(low[3] as usize > node, "a walk goes forward");
            node = low[3] as usize;
            continue;
        }
        node += 1;
        met.extend((high[3] > 0.0).then(|| texels[high[3] as usize]));
    }
    met
}

/// Returns the texels of all points that a ray of the eye may meet, or its mirrored ray, as the list of its tile has them.
/// `head` is the texel of the tiles.
fn look_up(texels: &[[f32; 4]], head: usize, pixel: [f32; 2]) -> Vec<[f32; 4]> {
    let [first, side, columns, _] = texels[head];
    let at = pixel.map(|place| place / side);
    let tile = texels[(first + at[1].floor() * columns + at[0].floor()) as usize];
    let own = at.map(|place| TILE_PARTS * place.fract());
    let is_in =
        |axis: usize, packed: f32| (packed.floor()..=TILE_PARTS * packed.fract() + 1.0).contains(&own[axis]);
    let entries = &texels[tile[0] as usize..tile[2] as usize];
    let met = entries.iter().filter(|entry| is_in(0, entry[0]) && is_in(1, entry[1]));
    met.map(|entry| texels[entry[3] as usize]).collect()
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    (0..3).map(|axis| a[axis] * b[axis]).sum()
}

/// Returns `a + scale * b`.
fn sum(a: [f32; 3], scale: f32, b: [f32; 3]) -> [f32; 3] {
    std::array::from_fn(|axis| a[axis] + scale * b[axis])
}

fn length(a: [f32; 3]) -> f32 {
    dot(a, a).sqrt()
}

/// Returns the distance between a ray and the streak of a point.
fn distance(point: &Swarm<f32>, origin: [f32; 3], direction: [f32; 3]) -> f32 {
    let steps = if point.stretch == [0.0; 3] { 1 } else { 400 };
    let from = |step: usize| {
        let off = sum(sum(point.position, step as f32 / 400.0, point.stretch), -1.0, origin);
        length(sum(off, -dot(off, direction).max(0.0), direction))
    };
    (0..steps).map(from).fold(f32::INFINITY, f32::min)
}

fn assert_that_rays_find_all(text: &str) {
    let world = world_of(text);
    let plan = plan(&world);
    let inputs = FrameInputs { time: 3.0, ..FrameInputs::default() };
    let points = plan.points(&inputs, 0..plan.point_count());
    let texels = plan.texels(&points, &inputs, &VIEW, 1 << 22);
    let least = HEAD + points.len() * POINT_TEXELS_MAX + 2;
    assert!(plan.texels(&points, &inputs, &VIEW, least).len() <= least);
    let (mut found, mut tested) = (0, 0);
    for ray in 0..400u32 {
        let part = |step: u32| (ray.wrapping_mul(step) % 9973) as f32 / 9973.0 - 0.5;
        // Some rays start at the eye, others anywhere, as mirrored ones do.
        let origin = if ray % 2 == 0 { VIEW.eye } else { [20.0 * part(31), 20.0 * part(71), 20.0 * part(7)] };
        let target = [7919, 104_729, 1_299_709].map(|step| 12.0 * part(step));
        let way = sum(target, -1.0, origin);
        let direction = way.map(|part| part / length(way));
        let met = [0, 1].map(|tree| walk(&texels, tree, origin, direction)).concat();
        tested += met.len();
        for radius in [(|point| point.size) as fn(&Swarm<f32>) -> f32, |point| point.reach] {
            for point in &points {
                let pixel = VIEW.pixel * WIDEST * length(sum(point.position, -1.0, VIEW.eye));
                if radius(point) > 0.0 && distance(point, origin, direction) < radius(point).hypot(pixel) {
                    found += 1;
                    let [x, y, z] = point.position;
                    assert!(met.contains(&[x, y, z, radius(point)]), "{point:?} of ray {ray}");
                }
            }
        }
    }
    assert!(found > 200, "only {found} points were on rays");
    assert!(tested < 800 * points.len() / 4, "rays test {tested} points of {}", points.len());
}

#[test]
fn rays_find_every_point_that_they_meet() {
    assert_that_rays_find_all(
        "swarm dust { count = 900  position = 10 * (hash_3(vec3(index, 1, 2)) - 0.5)
                      size = 0.3 * hash(vec3(index, 5, 0)) - 0.05  glow = vec3(1)  reach = hash(vec3(index, 6, 0)) }",
    );
}

#[test]
fn rays_find_streaks_and_clusters_with_a_point_far_away() {
    assert_that_rays_find_all(
        "swarm rain { count = 300  position = 8 * (hash_3(vec3(index, 1, t)) - 0.5)  size = 0.05
                      stretch = 3 * (hash_3(vec3(index, 7, 2)) - 0.5)  glow = vec3(0, 1, 0)  reach = 0.1 }
         swarm same { count = 40  position = vec3(1, 2, 3)  size = 0.2 }
         swarm far { count = 1  position = vec3(90000, 5, 3)  size = 0.2  glow = 1 }",
    );
}

#[test]
fn rays_of_the_eye_find_every_point_in_the_list_of_their_tile() {
    let text = "swarm dust { count = 700  position = vec3(20, 12, 44) * (hash_3(vec3(index, 1, 2)) - 0.5)
                             size = 0.3 * hash(vec3(index, 5, 0)) - 0.05  glow = vec3(1)
                             reach = 0.4 * hash(vec3(index, 6, 0))
                             stretch = step(200, index) * 2 * (hash_3(vec3(index, 7, 2)) - 0.5) }
                swarm near { count = 20  position = vec3(0.3, 1, -19.9) + 0.2 * hash_3(vec3(index, 9, 9)) - 0.1
                             size = 0.05  glow = 1  reach = 0.06 }";
    let world = world_of(text);
    let plan = plan(&world);
    let inputs = FrameInputs::default();
    let points = plan.points(&inputs, 0..plan.point_count());
    let whole = HEAD + points.len() * POINT_TEXELS_MAX + 2;
    for room in [1 << 22, 40_000, whole] {
        let texels = plan.texels(&points, &inputs, &VIEW, room);
        let (mut found, mut tested) = (0, 0);
        for ray in 0..150u32 {
            let part = |step: u32| (ray.wrapping_mul(step) % 9973) as f32 / 9973.0;
            let pixel = [part(7919) * SIZE[0] as f32, part(104_729) * SIZE[1] as f32];
            let way = [pixel[0] / 1000.0 - 0.5, pixel[1] / 1000.0 - 0.3, 1.0];
            let direction = way.map(|part| part / length(way));
            let met = look_up(&texels, 7, pixel);
            tested += met.len();
            for radius in [(|point| point.size) as fn(&Swarm<f32>) -> f32, |point| point.reach] {
                for point in &points {
                    if radius(point) > 0.0 && distance(point, VIEW.eye, direction) < radius(point) {
                        found += 1;
                        let [x, y, z] = point.position;
                        assert!(
                            met.contains(&[x, y, z, radius(point)]),
                            "{point:?} at {pixel:?}, room {room}"
                        );
                    }
                }
            }
        }
        assert!(found > 100, "only {found} points were on rays");
        let is_fine = room < 40_000 || tested < 4 * found;
        assert!(is_fine, "rays test {tested} points, and meet {found}");
    }
}

#[test]
fn mirrored_rays_find_every_point_in_the_list_of_their_tile() {
    let text = "object floor { shape = y  material = water }
                material water { reflect = 0.5 }
                swarm dust { count = 700  position = vec3(20, 12, 44) * (hash_3(vec3(index, 1, 2)) - vec3(0.5, 0, 0.5))
                             size = 0.3 * hash(vec3(index, 5, 0)) - 0.05
                             stretch = step(200, index) * 2 * (hash_3(vec3(index, 7, 2)) - 0.5) }";
    let plan = plan(&world_of(text));
    let inputs = FrameInputs::default();
    let points = plan.points(&inputs, 0..plan.point_count());
    let view = SwarmView { mirror: Some((0, [0.0, 1.0, 0.0, 0.0])), ..VIEW };
    let least = HEAD + points.len() * POINT_TEXELS_MAX + 2;
    for room in [1 << 22, least] {
        let texels = plan.texels(&points, &inputs, &view, room);
        assert!(texels.len() <= room && texels[8][3] == 1.0);
        let mut found = 0;
        for ray in 0..300u32 {
            let part = |step: u32| (ray.wrapping_mul(step) % 9973) as f32 / 9973.0;
            let pixel = [part(7919) * SIZE[0] as f32, part(104_729) * SIZE[1] as f32];
            let way = [pixel[0] / 1000.0 - 0.5, pixel[1] / 1000.0 - 0.3, 1.0];
            if way[1] >= 0.0 {
                continue;
            }
            let [x, y, z] = way.map(|part| part / length(way));
            // On the floor, y is 0.
            let origin = sum(view.eye, -view.eye[1] / y, [x, y, z]);
            let met = look_up(&texels, 8, pixel);
            for point in points.iter().filter(|point| point.size > 0.0) {
                if distance(point, origin, [x, -y, z]) < point.size {
                    found += 1;
                    let [x, y, z] = point.position;
                    assert!(met.contains(&[x, y, z, point.size]), "{point:?} at {pixel:?}, room {room}");
                }
            }
        }
        assert!(found > 30, "only {found} points were on rays");
    }
    let dry = SwarmPlan { has_mirrors: false, ..plan };
    assert_eq!(dry.texels(&points, &inputs, &view, 1 << 22)[8], [0.0; 4]);
}

#[test]
fn points_know_their_number_and_the_time() {
    let found = points("swarm a { count = 3  position = vec3(index, t, 2 * index)  size = 1 + index }", 0.5);
    let places: Vec<_> = found.iter().map(|point| (point.position, point.size)).collect();
    assert_eq!(places, [([0.0, 0.5, 0.0], 1.0), ([1.0, 0.5, 2.0], 2.0), ([2.0, 0.5, 4.0], 3.0)]);
}

#[test]
fn parts_of_several_swarms_are_the_whole() {
    let world = world_of(
        "swarm a { count = 70  position = vec3(index, 1, 0) }\nswarm b { count = 5  position = vec3(index, 2, 0) }",
    );
    let (plan, inputs) = (plan(&world), FrameInputs::default());
    let whole = plan.points(&inputs, 0..plan.point_count());
    assert_eq!(whole.len(), 75);
    let parts = [0..3, 3..69, 69..72, 72..75].map(|part| plan.points(&inputs, part)).concat();
    assert_eq!(parts, whole);
}

#[test]
fn a_point_with_an_invalid_value_is_left_out() {
    for value in [
        "position = vec3(0, exp(99 + index), 0)",
        "size = exp(99 * index)",
        "glow = vec3(0, 1e30 * index, 0)",
        "stretch = vec3(1e7 * index)",
    ] {
        let found = points(&format!("swarm a {{ count = 3  {value} }}"), 0.0);
        assert!(found.len() < 3, "{value}: {found:?}");
        assert!(found.iter().all(|point| point.numbers().iter().all(|number| number.is_finite())));
    }
}

#[test]
fn values_beyond_their_ranges_are_clamped() {
    let found =
        points("swarm a { count = 1  color = vec3(-1, 0.5, 9)  emission = -1  glow = vec3(-3, 2, 0) }", 0.0);
    assert_eq!(
        (found[0].color, found[0].emission, found[0].glow),
        ([0.0, 0.5, 1.0], [0.0; 3], [0.0, 2.0, 0.0])
    );
}

#[test]
fn a_blend_shrinks_and_dims_the_swarms_of_both_scenes() {
    let sparks = world_of(
        "param far = 4 in 0 .. 9\nsphere(p, 1)\n\
         swarm a { count = 2  position = vec3(index, far, 0)  size = 0.5  glow = 8  emission = vec3(1, 2, 3) }",
    );
    let calm = world_of("param near = 1 in 0 .. 9\nsphere(p, 1)");
    for (from, to, part) in [(&sparks, &calm, 0.75), (&calm, &sparks, 0.25)] {
        let blend = World::blend(from, to, BlendKind::Melt, &Alignment::NONE, 0.25).unwrap();
        assert!(blend.features.swarm);
        let params = blend.scene.params.iter().map(|param| param.default).collect();
        let plan = plan(&blend);
        let found = plan.points(&FrameInputs { params, ..FrameInputs::default() }, 0..plan.point_count());
        let places: Vec<_> = found.iter().map(|point| point.position).collect();
        assert_eq!(places, [[0.0, 4.0, 0.0], [1.0, 4.0, 0.0]]);
        assert_eq!((found[1].size, found[1].glow), (0.5 * part, [8.0 * part; 3]));
        assert_eq!(found[1].emission, [part, 2.0 * part, 3.0 * part]);
    }
}

#[test]
fn two_scenes_with_too_many_points_cannot_be_blended() {
    let many = world_of(&format!("swarm a {{ count = {} }}", LIMITS.scene_swarm_points_max));
    let one = world_of("swarm a { count = 1 }");
    let error = World::blend(&many, &one, BlendKind::Melt, &Alignment::NONE, 0.5).unwrap_err();
    assert!(error.to_string().contains("65537 points in swarms"), "{error}");
}
