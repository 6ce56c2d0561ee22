//! Shadow rays, with the triangulation between their steps (`shaders/shadow.glsl`; Abt 2022, figure 11).

use super::light_path::dot;
use super::{Ray, RayProbe, Walk, add};
use crate::lang::{Light, LightKind};
use crate::rays;
use crate::region::gradient;

/// Maximum number of steps through distances, and through values that are not distances.
const STEPS_MAX: (usize, usize) = (96, 512);
/// Growth of the shortest step through values that are not distances.
const STEP_GROWTH: f32 = 0.002;
/// A ray whose light has fallen below this fraction ends.
const VISIBLE_MIN: f32 = 0.004;
/// A distance below this length is a hit.
const HIT: f32 = 0.002;
/// The previous distance and step before the first step, and after skipped cells.
const NO_SPHERE: f32 = 1e4;

/// A ray from a surface towards a light.
#[derive(Debug, Clone, PartialEq)]
pub struct ShadowRay {
    /// Index of the light.
    pub light: usize,
    /// The start, slightly above the surface.
    pub origin: [f32; 3],
    /// The direction, of length 1.
    pub direction: [f32; 3],
    /// The part of the ray that is traced, or the distance of the plane that blocks it.
    pub end: f32,
    /// The evaluations of the distance without skipping cells, in order. A value that is not a distance is traced with
    /// the cells.
    pub steps: Vec<ShadowStep>,
    /// Number of evaluations with the cells of the tree, which rays skip.
    pub evaluations: usize,
    /// The fraction of the light that arrives, 0..1.
    pub visible: f32,
}

/// An evaluation of the distance along a shadow ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShadowStep {
    /// Distance along the ray.
    pub t: f32,
    /// The distance to the nearest surface.
    pub nearest: f32,
    /// Distance from this point back to the closest pass between the last two points, by triangulation.
    pub behind: f32,
    /// The estimated distance of the closest pass.
    pub closest: f32,
    /// The fraction of the light that passes there, not below 0; above 1 if all of it passes.
    pub fraction: f32,
}

/// A light as seen from a point: direction, distance, and the tangent of half its angle.
struct Incoming {
    direction: [f32; 3],
    t: f32,
    widening: f32,
}

impl Incoming {
    fn of(light: &Light<f32>, p: [f32; 3]) -> Self {
        let place = light.place();
        let is_sun = light.kind == LightKind::Sun;
        let way =
            if is_sun { place.map(|part| -part) } else { std::array::from_fn(|axis| place[axis] - p[axis]) };
        let length = dot(way, way).sqrt().max(1e-6);
        let t = if is_sun { rays::SUN_DISTANCE } else { length };
        let ([a, b, c], [x, y, z]) = (light.right, light.up);
        let across = [b * z - c * y, c * x - a * z, a * y - b * x];
        let widening = match light.kind {
            LightKind::Sun => light.radius,
            LightKind::Lamp => light.radius / t.max(1e-3),
            LightKind::Panel => (dot(across, across).sqrt() / std::f32::consts::PI).sqrt() / t.max(1e-3),
        };
        Self { direction: way.map(|part| part / length), t, widening }
    }
}

impl RayProbe<'_> {
    /// Follows the ray from a surface to a light. `None` if the light is behind the surface.
    pub(super) fn shadow_ray(
        &self,
        (number, light): (usize, &Light<f32>),
        p: [f32; 3],
        normal: [f32; 3],
        cone: f32,
    ) -> Option<ShadowRay> {
        let incoming = Incoming::of(light, p);
        if dot(normal, incoming.direction) <= 0.0 {
            return None;
        }
        let sharpness = (1.0 / incoming.widening.max(1e-4)).clamp(rays::SHARPNESS_MIN, rays::SHARPNESS_MAX);
        let origin = add(p, normal.map(|part| part * (2.0 * cone).max(0.012)));
        let ray = Ray { origin, direction: incoming.direction, spread: 0.0 };
        let mut shadow = ShadowRay {
            light: number,
            origin,
            direction: incoming.direction,
            end: incoming.t,
            steps: Vec::new(),
            evaluations: 0,
            visible: 1.0,
        };
        if let Some(hit) = self.plane_on(&ray).filter(|hit| hit.distance < incoming.t) {
            (shadow.end, shadow.visible) = (hit.distance, 0.0);
            return Some(shadow);
        }
        let penumbra = (!self.world.non_lipschitz).then_some(sharpness);
        let Some((start, end)) = self.traced_span(&ray, penumbra) else { return Some(shadow) };
        let span = (start.max(rays::SHADOW_START), end.min(incoming.t));
        if span.0 < span.1 {
            shadow.end = span.1;
            let follow = |probe: &Self| {
                let mut steps = Vec::new();
                let visible = match probe.world.non_lipschitz {
                    true => probe.follow_sharp(&ray, span, sharpness, &mut steps),
                    false => probe.follow_soft(&ray, span, sharpness, &mut steps),
                };
                (visible, steps)
            };
            let (visible, steps) = follow(self);
            (shadow.visible, shadow.evaluations) = (visible, steps.len());
            shadow.steps = self.without_cells(follow).1;
        }
        Some(shadow)
    }

    fn follow_soft(
        &self,
        ray: &Ray,
        (mut t, end): (f32, f32),
        sharpness: f32,
        steps: &mut Vec<ShadowStep>,
    ) -> f32 {
        let walk = Walk::of(self.regions, ray);
        let (mut visible, mut previous, mut stride) = (1.0_f32, NO_SPHERE, NO_SPHERE);
        for step in 0..STEPS_MAX.0 {
            let mut cell = self.cell_at(&walk, t);
            for _ in 0..rays::SKIPS_MAX {
                let Some(known) = cell else { break };
                let leaves = rays::past(t).max(walk.exit_of(&known, t));
                if !(known.bound > 0.0 && sharpness * known.bound >= visible * leaves) {
                    break;
                }
                (t, previous, stride) = (leaves, NO_SPHERE, NO_SPHERE);
                if t >= end {
                    break;
                }
                cell = self.cell_at(&walk, t);
            }
            if t >= end {
                break;
            }
            let tape = self.tape_of(cell.as_ref());
            let [bound, d] = self.regions.run(tape, ray.at(t), t / sharpness, self.frame);
            let behind = if stride > previous {
                0.0
            } else {
                let behind = (d * d + stride * stride - previous * previous) / (2.0 * stride);
                behind.min(d.min(stride)).max(0.0)
            };
            let closest = (d * d - behind * behind).max(0.0).sqrt();
            let fraction = sharpness * closest / (t - behind).max(1e-3);
            steps.push(ShadowStep { t, nearest: d, behind, closest, fraction });
            visible = visible.min(fraction);
            // A NaN also ends the ray.
            if d.is_nan() || d < HIT || visible < VISIBLE_MIN {
                return 0.0;
            }
            previous = d;
            let growth = self.world.shadow_step_growth() * step as f32;
            stride = bound.min(rays::SHADOW_STEP_MAX.max(0.5 * bound)).max(rays::SHADOW_STEP_MIN + growth);
            t += stride;
            if t >= end {
                break;
            }
        }
        visible * visible * (3.0 - 2.0 * visible)
    }

    fn follow_sharp(
        &self,
        ray: &Ray,
        (mut t, end): (f32, f32),
        sharpness: f32,
        steps: &mut Vec<ShadowStep>,
    ) -> f32 {
        let walk = Walk::of(self.regions, ray);
        for step in 0..STEPS_MAX.1 {
            let mut cell = self.cell_at(&walk, t);
            for _ in 0..rays::SKIPS_MAX {
                let Some(known) = cell.filter(|cell| cell.bound > 0.0 && t < end) else { break };
                t = rays::past(t).max(walk.exit_of(&known, t));
                cell = self.cell_at(&walk, t);
            }
            if t >= end {
                break;
            }
            let tape = self.tape_of(cell.as_ref());
            let [bound, d] = self.regions.run(tape, ray.at(t), t / sharpness, self.frame);
            steps.push(ShadowStep { t, nearest: d, behind: 0.0, closest: d, fraction: 1.0 });
            if d.is_nan() || d <= 0.0 {
                return 0.0;
            }
            let towards = cell.map_or(0.0, |cell| gradient::slope_towards(cell.slopes, ray.direction));
            let mut stride = if towards > 0.0 { bound / towards } else { rays::FAR };
            if let Some(cell) = &cell {
                stride = stride.min(rays::past(t).max(walk.exit_of(cell, t)) - t);
            }
            let growth = STEP_GROWTH + self.world.shadow_step_growth();
            t += stride.max(rays::SHADOW_STEP_MIN + growth * step as f32);
            if t >= end {
                break;
            }
        }
        1.0
    }
}
