//! Media: fog, smoke, clouds, auroras. All media of a scene are one program of the point.
//!
//! ```text
//! media → sums of their densities, of the light that they scatter and emit → a program → box and grid of empty space
//! ```
//!
//! Scattering follows the radiative transfer equation without multiple scattering (Chandrasekhar 1960, "Radiative
//! Transfer"). Ambient light is scattered as if it came equally from all directions.

use crate::bounds::Bounds;
use crate::graph::{FrameInputs, Graph, Input, NodeId, Op};
use crate::lang::{FieldRange, Medium, Scene};
use crate::region::every_frame::EveryFrame;

/// Number of results of a scene's program of media: the density, scattered light in red, green and blue per unit of
/// light and length, emitted light in red, green and blue per unit of length, and the direction of scattering.
pub(crate) const MEDIUM_NUMBERS: usize = 8;
/// The result that holds the phase.
pub(super) const PHASE: usize = MEDIUM_NUMBERS - 1;

/// The results of the program of media ([`MEDIUM_NUMBERS`]).
pub(super) type MediumRoots = [NodeId; MEDIUM_NUMBERS];

/// Where density and emitted light together are below this value, there is no medium.
const THINNEST: f32 = 1e-4;
/// Media beyond this coordinate have no bound there.
const FARTHEST: f32 = 1e7;
/// Number of rounds of the search for bounds.
const ROUNDS: usize = 2;
/// Number of places at which the search for a bound cuts space at once.
const CUTS: usize = 64;
/// The smallest and the largest coordinate at which the search cuts space. The cuts grow by equal factors.
const NEAREST_CUT: f32 = 1.0 / 64.0;
const FARTHEST_CUT: f32 = 4096.0;

/// Returns the sum of a scene's media; `None` if there is no medium.
pub(super) fn sum(scene: &mut Scene) -> Option<MediumRoots> {
    if scene.media.is_empty() {
        return None;
    }
    let ambient = mean_ambient(scene);
    let media = std::mem::take(&mut scene.media);
    let graph = &mut scene.graph;
    let zero = graph.constant(0.0);
    let mut sum = [zero; MEDIUM_NUMBERS];
    // The sum of the directions of scattering, weighted by the scattered light.
    let mut directed = zero;
    for medium in &media {
        let own = numbers(graph, medium);
        directed = graph.add(directed, own[PHASE] * own[2]);
        for (sum, own) in sum.iter_mut().zip(own) {
            *sum = graph.add(*sum, own);
        }
    }
    if media.len() > 1 {
        let weight = graph.max(sum[2], f32::MIN_POSITIVE);
        sum[PHASE] = graph.div(directed, weight);
    }
    for channel in 0..3 {
        sum[4 + channel] = graph.add(sum[4 + channel], sum[1 + channel] * ambient[channel]);
    }
    scene.media = media;
    Some(sum)
}

/// Returns the numbers of one medium, without ambient light.
fn numbers(graph: &mut Graph, medium: &Medium) -> MediumRoots {
    let medium = medium.clone().in_ranges(|number, range| clamped(graph, number, range));
    let is_inside = graph.binary(Op::Less, medium.shape, 0.0);
    let density = graph.select(is_inside, medium.density, 0.0);
    let scattered = graph.mul(density, medium.scatter);
    let [r, g, b] = medium.color.map(|part| graph.mul(scattered, part));
    let [er, eg, eb] = medium.emission.map(|part| graph.select(is_inside, part, 0.0));
    [density, r, g, b, er, eg, eb, medium.phase]
}

fn clamped(graph: &mut Graph, number: NodeId, range: FieldRange) -> NodeId {
    let number = graph.max(number, range.least);
    if range.most.is_infinite() { number } else { graph.min(number, range.most) }
}

/// Returns the mean of the ambient light along the axes. It depends only on the frame, so the CPU computes it.
fn mean_ambient(scene: &mut Scene) -> [NodeId; 3] {
    let graph = &mut scene.graph;
    let mut mean = [graph.constant(0.0); 3];
    for direction in AXES {
        let light = facing(graph, &scene.sky.ambient, direction);
        for (mean, light) in mean.iter_mut().zip(light) {
            *mean = graph.add(*mean, light * (1.0 / 6.0));
        }
    }
    mean
}

/// The directions along each axis and against it.
pub(super) const AXES: [[f32; 3]; 6] =
    [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];

/// Returns the expressions for a surface or a ray with this normal or direction.
pub(super) fn facing(graph: &mut Graph, roots: &[NodeId], normal: [f32; 3]) -> Vec<NodeId> {
    graph.with_inputs(roots, |graph, input| {
        let axis = [Input::NX, Input::NY, Input::NZ].iter().position(|axis| *axis == input)?;
        Some(graph.constant(normal[axis]))
    })
}

/// Returns a box that contains all media in all frames of `any`. A side without a bound is infinite.
///
/// At each face, half-spaces at growing distances are tested at once. A second round looks only inside the box of the
/// first one.
pub(super) fn bounds(graph: &mut Graph, roots: &MediumRoots, any: &FrameInputs) -> Bounds {
    let absence = absence(graph, roots);
    let (mut search, whole) = EveryFrame::new(graph, absence, any);
    let mut found = Bounds { low: [f32::NEG_INFINITY; 3], high: [f32::INFINITY; 3] };
    for _ in 0..ROUNDS {
        for face in 0..6 {
            let outwards = if face < 3 { -1.0 } else { 1.0 };
            let searched = Bounds {
                low: found.low.map(|at| at.max(-FARTHEST)),
                high: found.high.map(|at| at.min(FARTHEST)),
            };
            // `cuts` grow outwards at both faces of an axis.
            let mut first_without = |cuts: &[f32; CUTS]| {
                let beyond = |cut: &f32| {
                    let mut part = searched;
                    *part.face_mut((face + 3) % 6) = outwards * cut;
                    part
                };
                let open = search.open(&whole, &cuts.map(|cut| beyond(&cut)));
                (CUTS as u32 - open.leading_zeros()) as usize
            };
            let cuts = coarse_cuts();
            let number = first_without(&cuts);
            let Some(end) = cuts.get(number).copied() else { continue };
            let start = number.checked_sub(1).and_then(|before| cuts.get(before)).copied().unwrap_or(end);
            let fine = std::array::from_fn(|cut| start + (end - start) * (cut + 1) as f32 / CUTS as f32);
            let end = fine.get(first_without(&fine)).copied().unwrap_or(end);
            *found.face_mut(face) = outwards * end;
        }
    }
    found
}

/// Returns coordinates from far inside to far outside, which grow by equal factors on both sides of 0.
fn coarse_cuts() -> [f32; CUTS] {
    let half = CUTS / 2;
    let factor = (FARTHEST_CUT / NEAREST_CUT).powf(1.0 / (half - 1) as f32);
    let size = |number: usize| NEAREST_CUT * factor.powi(number as i32);
    std::array::from_fn(|cut| if cut < half { -size(half - 1 - cut) } else { size(cut - half) })
}

/// Returns an expression that is positive where there is no medium.
fn absence(graph: &mut Graph, roots: &MediumRoots) -> NodeId {
    let [density, _, _, _, r, g, b, _] = *roots;
    graph.sub(THINNEST, density + Op::Max.pair(Op::Max.pair(r, g), b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::Point;
    use crate::region::MEDIUM_SIDE;
    use crate::world::testing::world_of;
    use crate::world::{Alignment, BlendKind, World};

    fn medium_at(world: &World, inputs: &FrameInputs, place: [f32; 3]) -> Vec<f32> {
        let roots = world.roots.medium.unwrap();
        let mut inputs = inputs.clone();
        inputs.hoisted = world.hoisted.values(&inputs);
        let [x, y, z] = place;
        world.graph.evaluate(&roots, &Point::at(x, y, z), &inputs)
    }

    #[test]
    fn overlapping_media_add_up() {
        let world = world_of(
            "sphere(p, 1)\nsky { ambient = vec3(1, 2, 0) }\n\
             medium a { density = 0.5  color = vec3(1, 0.5, 0)  phase = 0.5  shape = x }\n\
             medium b { density = 1.5  scatter = 0.5  emission = vec3(0, 0, 3)  phase = -0.5 }",
        );
        let inputs = FrameInputs::default();
        let near = |found: Vec<f32>, expected: [f32; 8]| {
            let is_near = found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-5);
            assert!(is_near, "{found:?} instead of {expected:?}");
        };
        near(medium_at(&world, &inputs, [1.0, 0.0, 0.0]), [1.5, 0.75, 0.75, 0.75, 0.75, 1.5, 3.0, -0.5]);
        // The phase is the mean, weighted by the scattered green light.
        near(medium_at(&world, &inputs, [-1.0, 0.0, 0.0]), [2.0, 1.25, 1.0, 0.75, 1.25, 2.0, 3.0, -0.25]);
    }

    #[test]
    fn values_beyond_their_ranges_are_clamped() {
        let world = world_of(
            "medium a { density = -3  scatter = 7  color = vec3(9)  emission = vec3(-1)  phase = 5 }",
        );
        let found = medium_at(&world, &FrameInputs::default(), [0.0; 3]);
        assert_eq!(found[..7], [0.0; 7]);
        assert_eq!(found[7], 0.95);
    }

    #[test]
    fn bounds_hold_the_media_and_may_be_endless() {
        let bounds = |medium: &str| world_of(&format!("medium a {{ {medium} }}")).medium_bounds;
        let ball = bounds("density = 2 + bass  shape = sphere(p - vec3(3, 0, 0), 1.5)");
        for (axis, middle) in [3.0, 0.0, 0.0].into_iter().enumerate() {
            assert!((-0.1..=0.0).contains(&(ball.low[axis] - (middle - 1.5))), "{ball:?}");
            assert!((0.0..=0.1).contains(&(ball.high[axis] - (middle + 1.5))), "{ball:?}");
        }
        let layer = bounds("density = 0.3 * exp(-2 * abs(y))");
        assert!(layer.low[0] == f32::NEG_INFINITY && layer.high[2] == f32::INFINITY);
        // 0.3 * exp(-2 * 4) is THINNEST.
        assert!((3.9..4.2).contains(&layer.high[1]) && (-4.2..-3.9).contains(&layer.low[1]), "{layer:?}");
        let everywhere = bounds("density = 1");
        assert!(everywhere.low.iter().chain(&everywhere.high).all(|at| at.is_infinite()));
        let nowhere = bounds("density = 0");
        assert!(
            (0..3).all(|axis| nowhere.high[axis] - nowhere.low[axis] <= 2.0 * FARTHEST_CUT),
            "{nowhere:?}"
        );
    }

    #[test]
    fn no_cell_of_the_grid_is_less_dense_than_its_points() {
        let text = "param k = 1 in 0 .. 3\n\
                    medium a { density = k * (noise(2 * p + vec3(t, 0, 0)) - 0.4)  shape = sphere(p, 2) }\n\
                    medium b { density = 0  emission = vec3(0, 1, 0)  shape = box(p - vec3(4, 0, 0), 0.5) }";
        let world = world_of(text);
        let mut inputs = FrameInputs { time: 3.7, params: vec![2.0], ..FrameInputs::default() };
        inputs.hoisted = world.hoisted.values(&inputs);
        let grid = world.tape_buffers().medium.as_ref().unwrap().grid(&inputs, [0.0; 3]);
        let side = MEDIUM_SIDE as f32;
        let mut empty = 0;
        for number in 0..40_000u32 {
            let part = |step: u32| (number.wrapping_mul(step) % 9973) as f32 / 9973.0;
            let place: [f32; 3] = std::array::from_fn(|axis| {
                grid.low[axis] + grid.size[axis] * part([7919, 104_729, 1_299_709][axis])
            });
            let cell: [usize; 3] = std::array::from_fn(|axis| {
                (((place[axis] - grid.low[axis]) / grid.size[axis] * side) as usize).min(MEDIUM_SIDE - 1)
            });
            let bound = grid.densities[cell[0] + MEDIUM_SIDE * (cell[1] + MEDIUM_SIDE * cell[2])];
            let found = medium_at(&world, &inputs, place);
            assert!(found[0] <= bound * 1.00001, "{} above {bound} at {place:?}", found[0]);
            assert!(bound > 0.0 || found[5] <= 0.0, "light in an empty cell at {place:?}");
            empty += u32::from(bound == 0.0);
        }
        assert!(empty > 20_000, "only {empty} of 40,000 points are in empty cells");
    }

    #[test]
    fn a_blend_mixes_the_media_of_both_scenes() {
        let fog = world_of("medium a { density = 1  phase = 0.5 }");
        let clear = world_of("sphere(p, 1)");
        for (from, to, expected) in [(&fog, &clear, 0.75), (&clear, &fog, 0.25), (&fog, &fog, 1.0)] {
            let blend = World::blend(from, to, BlendKind::Melt, &Alignment::NONE, 0.25).unwrap();
            assert!(blend.features.media);
            let inputs = FrameInputs { params: vec![0.25], ..FrameInputs::default() };
            let found = medium_at(&blend, &inputs, [0.0, 5.0, 0.0]);
            assert!((found[0] - expected).abs() < 1e-5, "{found:?} instead of {expected}");
        }
    }
}
