//! Traces rays through a world on the CPU. Finds the hit, its object, and the part of the scene's text that defines the
//! hit surface.
//!
//! Rays use the algorithm of the shaders (`shaders/sphere_tracing.glsl`, `shaders/non_lipschitz.glsl`), with the same
//! tree and the same constants ([`rays`]). A probe for a single point differs only in its narrower cone. The probe
//! counts evaluations and the clauses of the cells' tapes.

mod deciding;
mod light_path;
mod preview;
mod ray_faults;
mod ray_statistics;
#[cfg(test)]
mod tests;

use std::ops::Range;

pub use deciding::Deciding;
pub use light_path::{OcclusionProbe, PathRay, PathSurface, RayStep, ShadowRay, ShadowStep};
pub use preview::preview;
pub use ray_faults::{RayFaults, ray_faults};
pub use ray_statistics::{ObjectCost, Part, PartCost, RayStatistics};

use crate::bounds::Bounds;
use crate::graph::{FrameInputs, NodeId};
use crate::lang::TextPlace;
use crate::rays;
use crate::region::{Cell, Regions, gradient};
use crate::vectors::{cross, length, sum};
use crate::world::World;

/// A ray that has used up its steps counts as a hit if the distance is below this multiple of the cone's radius.
const CAPPED_FRACTION: f32 = 8.0;
/// Maximum length of the last step, as a multiple of the distance.
const SLANT_MAX: f32 = 4.0;
/// Directions in which the normal's four samples are offset: the corners of a tetrahedron.
const TAPS: [[f32; 3]; 4] = [[1.0, -1.0, -1.0], [-1.0, -1.0, 1.0], [-1.0, 1.0, -1.0], [1.0, 1.0, 1.0]];
/// Minimum distance of the normal's samples from the point.
const TAP_MIN: f32 = 4e-4;

/// A ray with the cone of its pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// The start.
    pub origin: [f32; 3],
    /// The direction, of length 1.
    pub direction: [f32; 3],
    /// Growth of the cone's radius per unit of length; greater than 0.
    pub spread: f32,
}

impl Ray {
    /// Returns the point at a distance along the ray.
    pub fn at(&self, t: f32) -> [f32; 3] {
        std::array::from_fn(|axis| self.origin[axis] + t * self.direction[axis])
    }
}

/// The intersection of a ray with a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Distance along the ray.
    pub distance: f32,
    /// Position in the units of the scene.
    pub position: [f32; 3],
    /// Index among the scene's objects.
    pub object: usize,
    /// Index among the world's planes, if the surface is a plane.
    pub plane: Option<usize>,
}

/// The result and the cost of a ray.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Traced {
    /// The surface; `None` for the sky.
    pub hit: Option<Hit>,
    /// Number of evaluations of the distance.
    pub evaluations: u32,
    /// Number of clauses that these evaluations ran.
    pub clauses: u64,
    /// The evaluations, in order.
    pub steps: Vec<RayStep>,
    /// True if the ray used up its steps.
    pub capped: bool,
}

/// A world in one frame, ready for tracing.
#[derive(Clone, Copy)]
pub struct RayProbe<'a> {
    world: &'a World,
    regions: &'a Regions,
    frame: &'a FrameInputs,
    planes: &'a [[f32; 4]],
    /// True if rays do not skip cells.
    is_plain: bool,
}

/// The distance along each axis at which the gradient at a hit is sampled.
fn tap_length(ray: &Ray, hit: &Hit) -> f32 {
    (0.6 * ray.spread * hit.distance).max(TAP_MIN)
}

impl<'a> RayProbe<'a> {
    /// Creates a probe for a frame's tree and planes ([`FrameValues::planes`](crate::world::FrameValues)).
    pub fn new(
        world: &'a World,
        regions: &'a Regions,
        frame: &'a FrameInputs,
        planes: &'a [[f32; 4]],
    ) -> Self {
        Self { world, regions, frame, planes, is_plain: false }
    }

    /// Follows a ray to the first surface.
    pub fn trace(&self, ray: &Ray) -> Traced {
        let behind = self.plane_on(ray);
        let mut traced = Traced { hit: behind, ..Traced::default() };
        let Some(mut span) = self.traced_span(ray, None) else { return traced };
        span.end = behind.map_or(span.end, |hit| span.end.min(hit.distance));
        if !span.is_empty() {
            let met = match self.world.non_lipschitz {
                true => self.trace_non_lipschitz(ray, rays::past(span.start)..span.end, &mut traced),
                false => self.trace_distance(ray, span, &mut traced),
            };
            if let Some(t) = met {
                let position = ray.at(t);
                let object = self.regions.object(position, self.frame) as usize;
                traced.hit = Some(Hit { distance: t, position, object, plane: None });
            }
        }
        traced
    }

    /// Returns the normal at `hit`, of length 1.
    pub fn normal(&self, ray: &Ray, hit: &Hit) -> [f32; 3] {
        if let Some([a, b, c, _]) = hit.plane.and_then(|plane| self.planes.get(plane)) {
            return unit([*a, *b, *c]);
        }
        unit(self.tapped(hit.position, tap_length(ray, hit)))
    }

    /// Returns the gradient at a point times 4 * h, from the distances at four points around it.
    fn tapped(&self, point: [f32; 3], h: f32) -> [f32; 3] {
        let mut sum = [0.0; 3];
        for tap in TAPS {
            let place = std::array::from_fn(|axis| point[axis] + h * tap[axis]);
            let [_, estimate] = self.regions.distance(place, 0.0, self.frame);
            sum = std::array::from_fn(|axis| sum[axis] + estimate * tap[axis]);
        }
        sum
    }

    /// True if the values along rays are distances.
    pub fn is_distance(&self) -> bool {
        !self.world.non_lipschitz
    }

    /// Returns the value of the scene at a point: the distance to the nearest surface.
    pub fn distance_at(&self, point: [f32; 3]) -> f32 {
        let rest = match self.world.has_rest {
            true => self.regions.distance(point, 0.0, self.frame)[1],
            false => rays::FAR,
        };
        self.heights(point).fold(rest, f32::min)
    }

    /// The heights of a point above the planes.
    fn heights(&self, point: [f32; 3]) -> impl Iterator<Item = f32> {
        self.planes.iter().filter_map(move |[a, b, c, d]| {
            let slope = (a * a + b * b + c * c).sqrt();
            let height = (a * point[0] + b * point[1] + c * point[2] + d) / slope;
            (slope > 0.0 && height.is_finite()).then_some(height)
        })
    }

    /// Returns the path from a shape to the hit part, up to the last node whose origin in the text is known. `deciding`
    /// belongs to the hit object.
    pub fn path(&self, hit: &Hit, deciding: Option<&Deciding<'_>>) -> Vec<NodeId> {
        let plane = hit.plane.and_then(|plane| self.world.planes.get(plane));
        let mut path = match (plane, deciding) {
            (Some(plane), _) => vec![plane.shape],
            (None, Some(deciding)) => deciding.path(hit.position, self.frame),
            (None, None) => Vec::new(),
        };
        path.retain(|node| self.world.scene.origins.knows(*node));
        path
    }

    /// Returns the positions in the text that contribute to the end of a path.
    pub fn places(&self, object: usize, path: &[NodeId]) -> Vec<TextPlace> {
        let scene = &self.world.scene;
        let material = scene.objects.get(object).map_or(usize::MAX, |object| object.material);
        scene.origins.places(object, material, path)
    }

    /// Returns the first plane that the ray hits from its upper side.
    fn plane_on(&self, ray: &Ray) -> Option<Hit> {
        let mut first: Option<Hit> = None;
        for (index, [a, b, c, d]) in self.planes.iter().enumerate() {
            let along = |v: [f32; 3]| a * v[0] + b * v[1] + c * v[2];
            let (approach, height) = (-along(ray.direction), along(ray.origin) + d);
            let t = height / approach.max(1e-9);
            let is_first = first.is_none_or(|hit| t < hit.distance);
            if approach > 1e-5 && height >= 0.0 && t < 1e9 && is_first {
                let object = self.world.planes.get(index).map_or(0, |plane| plane.object);
                first = Some(Hit { distance: t, position: ray.at(t), object, plane: Some(index) });
            }
        }
        first
    }

    /// Returns the part of the ray that may meet surfaces other than planes, or in which they may dim a light of this
    /// sharpness.
    fn traced_span(&self, ray: &Ray, sharpness: Option<f32>) -> Option<Range<f32>> {
        if !self.world.has_rest {
            return None;
        }
        let mut span = 0.0_f32..rays::FAR;
        let low = self.regions.low;
        let tree = Some(Bounds { low, high: sum(low, self.regions.size) });
        let boxes = [self.regions.bounds, tree.filter(|_| self.world.non_lipschitz)];
        for Bounds { low, high } in boxes.into_iter().flatten() {
            for axis in 0..3 {
                let slow = ray.direction[axis] + 1e-9_f32.copysign(ray.direction[axis]);
                let two = [low[axis], high[axis]].map(|face| (face - ray.origin[axis]) / slow);
                let (mut near, mut far) = (two[0].min(two[1]), two[0].max(two[1]));
                if let Some(sharpness) = sharpness {
                    // The bounds are within t / sharpness of the ray (`shaders/shadow.glsl`).
                    let k = sharpness * ray.direction[axis].abs();
                    near *= k / (k + 1.0);
                    far = if k > 1.0 { far * k / (k - 1.0) } else { rays::FAR };
                }
                span = span.start.max(near)..span.end.min(far);
            }
        }
        Some(span)
    }

    fn tape_of(&self, cell: Option<&Cell>) -> u32 {
        cell.map_or(self.regions.whole_tape, |cell| cell.tape)
    }

    /// Returns the lower bound of the distance, and the distance itself, which is larger where an object has a bound.
    fn values(&self, cell: Option<&Cell>, point: [f32; 3], traced: &mut Traced) -> [f32; 2] {
        let tape = self.tape_of(cell);
        traced.evaluations += 1;
        traced.clauses += self.regions.clauses_of(tape);
        self.regions.run(tape, point, 0.0, self.frame)
    }

    fn value(&self, cell: Option<&Cell>, point: [f32; 3], traced: &mut Traced) -> f32 {
        self.values(cell, point, traced)[0]
    }

    /// Returns a probe whose rays do not skip cells, if the values are distances. Other values need the cells.
    fn without_cells(&self) -> Self {
        Self { is_plain: self.is_distance(), ..*self }
    }

    fn trace_distance(&self, ray: &Ray, span: Range<f32>, traced: &mut Traced) -> Option<f32> {
        let walk = Walk::of(self.regions, ray);
        let Range { start: mut t, end } = span;
        let (mut d, mut before) = (0.0_f32, 0.0_f32);
        traced.capped = true;
        for step in 0..rays::STEPS_MAX {
            let reach = rays::hit_fraction(step) * ray.spread;
            let mut cell = self.cell_at(&walk, t);
            for _ in 0..rays::SKIPS_MAX {
                let Some(known) = cell.filter(|cell| cell.bound > reach * t) else { break };
                before = 0.0;
                t = (t + known.bound).max(walk.exit_of(&known, t));
                if t >= end {
                    traced.capped = false;
                    return None;
                }
                cell = self.cell_at(&walk, t);
            }
            let bound;
            [bound, d] = self.values(cell.as_ref(), ray.at(t), traced);
            traced.steps.push(RayStep { t, value: d });
            // A NaN also ends the ray.
            if d.is_nan() || d < reach * t {
                traced.capped = false;
                break;
            }
            let stride = d.min(bound.max(reach * t));
            t += stride;
            before = if stride < d { 0.0 } else { d };
            if t >= end {
                traced.capped = false;
                return None;
            }
        }
        if d > CAPPED_FRACTION * ray.spread * t {
            return None;
        }
        let slant = if before > d { (before / (before - d)).min(SLANT_MAX) } else { 1.0 };
        Some(if d > 0.0 { t + d * slant } else { t })
    }

    fn trace_non_lipschitz(&self, ray: &Ray, span: Range<f32>, traced: &mut Traced) -> Option<f32> {
        let walk = Walk::of(self.regions, ray);
        let Range { start: mut t, end } = span;
        // The last point outside with its value, and the first point inside.
        let (mut outside, mut inside): ((f32, f32), Option<(f32, f32)>) = ((t, 0.0), None);
        let mut closings = 0;
        for step in 0..rays::NON_LIPSCHITZ_STEPS_MAX {
            let mut cell = self.cell_at(&walk, t);
            for _ in 0..rays::SKIPS_MAX {
                let Some(known) = cell.filter(|cell| cell.bound > 0.0 && inside.is_none()) else { break };
                outside = (t, 0.0);
                t = walk.exit_of(&known, t);
                if t >= end {
                    return None;
                }
                cell = self.cell_at(&walk, t);
            }
            if t >= end {
                return None;
            }
            let value = self.value(cell.as_ref(), ray.at(t), traced);
            traced.steps.push(RayStep { t, value });
            let radius = ray.spread * t;
            if value > 0.0 {
                outside = (t, value);
            } else {
                inside = Some((t, value));
            }
            if let Some((far, below)) = inside {
                let (near, above) = outside;
                let close = far - near < rays::CLOSE_ENOUGH * radius;
                if above <= 0.0 || close || closings == rays::CLOSINGS_MAX {
                    return Some(far);
                }
                closings += 1;
                t = near + (far - near) * (above / (above - below)).clamp(0.1, 0.9);
                continue;
            }
            let (slope, leaves) = match &cell {
                Some(cell) => {
                    (gradient::slope_towards(cell.slopes, ray.direction), walk.exit_of(cell, t) - t)
                }
                // The point is outside the tree because of rounding, so there is no cell to leave.
                None => (f32::INFINITY, 0.0),
            };
            let radius = ray.spread * t.max(rays::NON_LIPSCHITZ_NEAR);
            t += rays::non_lipschitz_step(step, value, slope, leaves, t..end, radius);
        }
        traced.capped = true;
        inside.map(|(t, _)| t)
    }

    fn cell_at(&self, walk: &Walk<'_>, t: f32) -> Option<Cell> {
        if self.is_plain { None } else { self.regions.cell_at(walk.place_on(t)) }
    }
}

/// A ray through the tree. The cell is looked up slightly ahead, so that the ray does not get stuck at a face.
struct Walk<'a> {
    ray: &'a Ray,
    ahead: [f32; 3],
}

impl<'a> Walk<'a> {
    fn of(regions: &Regions, ray: &'a Ray) -> Self {
        let side = regions.size.map(|size| size / rays::ROOT_SIDE);
        let roots = |axis: usize| match side[axis] > 0.0 {
            true => ((ray.origin[axis] - regions.low[axis]) / side[axis] - 0.5 * rays::ROOT_SIDE).abs(),
            false => 0.0,
        };
        let nudge = rays::AHEAD + rays::AHEAD_OF_FAR * roots(0).max(roots(1)).max(roots(2));
        Self { ray, ahead: std::array::from_fn(|axis| (nudge * side[axis]).copysign(ray.direction[axis])) }
    }

    fn place_on(&self, t: f32) -> [f32; 3] {
        sum(self.ray.at(t), self.ahead)
    }

    /// Returns the distance at which the ray, from `t` on, has left a cell.
    fn exit_of(&self, cell: &Cell, t: f32) -> f32 {
        let ray = self.ray;
        let exits = (0..3).map(|axis| {
            let slow = ray.direction[axis] + 1e-12_f32.copysign(ray.direction[axis]);
            let face = if ray.direction[axis] >= 0.0 { cell.high[axis] } else { cell.low[axis] };
            (face - ray.origin[axis]) / slow
        });
        exits.fold(f32::INFINITY, f32::min).max(rays::past(t))
    }
}

/// Returns the directions to the right of and above a view ahead.
fn sides(ahead: [f32; 3]) -> [[f32; 3]; 2] {
    let right = unit([ahead[2], 0.0, -ahead[0]]);
    [right, cross(ahead, right)]
}

/// Scales a vector to length 1. Returns the upward direction if the vector has no direction.
fn unit(v: [f32; 3]) -> [f32; 3] {
    let size = length(v);
    if size > 1e-12 && size < 1e12 { v.map(|part| part / size) } else { [0.0, 1.0, 0.0] }
}
