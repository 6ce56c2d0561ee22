//! The depth of the visible solids in a scene.

use super::melt::HOLLOW;
use super::side::Side;
use crate::graph::{FrameInputs, Graph, Point};
use crate::tape::{PointEvaluator, Tape};
use crate::vectors::{cross, length};

const RAYS: (usize, usize) = (15, 9);
/// Maximum number of steps of a ray, and the minimum length of a step.
const STEPS: usize = 96;
const STEP_MIN: f32 = 0.01;
/// Number of steps into a solid, and the length of a step.
const STEPS_IN: usize = 40;
const STEP_IN: f32 = 0.04;
/// Depths are clamped to this range. The upper end is the depth of a hollow shell.
const RANGE: (f32, f32) = (0.05, 0.5 * HOLLOW);
/// The depth of a scene is this quantile of its rays' depths.
const QUANTILE: f32 = 0.5;

/// Casts rays from the side's camera at time 0, in silence. Returns the median depth of the solids that they hit. If
/// all rays miss, the result is the upper limit. Planes are ignored if the side has other surfaces.
pub(super) fn of(graph: &Graph, side: &Side) -> f32 {
    let mut depths = of_rays(graph, side).unwrap_or_default();
    depths.sort_by(f32::total_cmp);
    let middle = depths.get((QUANTILE * depths.len() as f32) as usize);
    middle.map_or(RANGE.1, |depth| depth.clamp(RANGE.0, RANGE.1))
}

fn of_rays(graph: &Graph, side: &Side) -> Option<Vec<f32>> {
    let [_, estimate] = side.rest.or_else(|| side.planes.first().map(|plane| [*plane; 2]))?;
    let inputs = FrameInputs { params: side.params.clone(), ..FrameInputs::default() };
    let roots = side.camera.position.into_iter().chain(side.camera.target).chain([side.camera.fov]);
    let roots: Vec<_> = roots.collect();
    let camera = graph.evaluate(&roots, &Point::default(), &inputs);
    let [x, y, z, tx, ty, tz, fov] = camera[..] else { return None };
    let (eye, view) = ([x, y, z], [tx - x, ty - y, tz - z]);
    let inputs = FrameInputs { eye, ..inputs };
    // Textures read 0 here.
    let tape = Tape::new(graph, &[estimate]);
    let mut evaluator = PointEvaluator::new(&tape, &inputs);
    let mut value = |p: [f32; 3]| evaluator.at(&Point::at(p[0], p[1], p[2])).first().copied().unwrap_or(0.0);
    let level = view[0].hypot(view[2]).max(1e-3);
    let far = level.hypot(view[1]);
    let ahead = view.map(|part| part / far);
    let right = [view[2] / level, 0.0, -view[0] / level];
    let up = cross(ahead, right);
    let height = (0.5 * fov.to_radians()).tan();
    let mut depths = Vec::new();
    for number in 0..RAYS.0 * RAYS.1 {
        let place = |index: usize, count: usize| 2.0 * (index as f32 + 0.5) / count as f32 - 1.0;
        let across = place(number % RAYS.0, RAYS.0) * height * 16.0 / 9.0;
        let above = place(number / RAYS.0, RAYS.1) * height;
        let way = [0, 1, 2].map(|axis| ahead[axis] + across * right[axis] + above * up[axis]);
        let size = length(way);
        depths.extend(depth_along(&mut value, eye, way.map(|part| part / size)));
    }
    Some(depths)
}

fn depth_along(value: &mut impl FnMut([f32; 3]) -> f32, eye: [f32; 3], way: [f32; 3]) -> Option<f32> {
    let at = |t: f32| [0, 1, 2].map(|axis| eye[axis] + t * way[axis]);
    let mut t = 0.0;
    let met = (0..STEPS).find_map(|_| {
        let distance = value(at(t));
        t += distance.max(STEP_MIN);
        (distance <= 0.0).then_some(t)
    })?;
    let inside = (0..STEPS_IN).map(|step| value(at(met + step as f32 * STEP_IN)));
    let deepest = inside.take_while(|value| *value <= 0.0).fold(0.0, f32::min);
    Some(-deepest)
}
