//! The light path of one ray, step by step: the ray from the eye, its mirror images, and at each surface the shadow rays
//! and the probes of ambient occlusion (Abt 2022, figures 3, 6, 11 and 14).
//!
//! The rays are those of the shaders (`shaders/scene.frag`, `shaders/shadow.glsl`, `shaders/occlusion.glsl`), without
//! the random directions of rough mirrors.

use std::ops::Range;

use super::{Hit, Ray, RayProbe, Traced, Walk, tap_length, unit};
use crate::graph::Point;
use crate::lang::{Light, LightKind, Material};
use crate::rays;
use crate::region::gradient;
use crate::vectors::{cross, difference, dot, length, sum};
use crate::world::FrameValues;

/// Maximum number of surfaces on a path.
const SURFACES_MAX: usize = 5;
/// A path ends if less than this fraction of its light would reach the eye.
const FRACTION_MIN: f32 = 0.004;
/// Minimum distance from a surface to the start of its mirror ray.
const MIRROR_START: f32 = 0.002;

/// An evaluation of the distance along a ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RayStep {
    /// Distance along the ray.
    pub t: f32,
    /// The value of the distance function.
    pub value: f32,
}

/// A ray from the eye or from a mirror.
#[derive(Debug, Clone, PartialEq)]
pub struct PathRay {
    /// The ray.
    pub ray: Ray,
    /// The evaluations of plain sphere tracing, in order. A value that is not a distance is traced with the cells.
    pub steps: Vec<RayStep>,
    /// Number of evaluations with the cells of the tree, which rays skip.
    pub evaluations: u32,
    /// The surface that ends the ray; `None` for the sky.
    pub surface: Option<PathSurface>,
}

/// A surface on a path.
#[derive(Debug, Clone, PartialEq)]
pub struct PathSurface {
    /// The intersection.
    pub hit: Hit,
    /// The normal, of length 1.
    pub normal: [f32; 3],
    /// The rays towards the lights in front of the surface.
    pub shadows: Vec<ShadowRay>,
    /// The probes of ambient occlusion, from the surface outwards.
    pub occlusion: [OcclusionProbe; 4],
    /// The fraction of the ambient light that arrives, 0..1.
    pub openness: f32,
    /// The fraction of the light that the surface mirrors, 0..1.
    pub reflectance: f32,
}

/// A probe of ambient occlusion: a point above a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OcclusionProbe {
    /// Height above the surface, along the normal.
    pub height: f32,
    /// Distance to the nearest surface; without occluders, the height.
    pub distance: f32,
}

impl RayProbe<'_> {
    /// Follows a ray from the eye over mirrors, and examines the light of a frame on each surface.
    pub fn light_path(&self, ray: &Ray, values: &FrameValues) -> Vec<PathRay> {
        let mut path = Vec::new();
        let (mut ray, mut travelled, mut throughput) = (*ray, 0.0, 1.0);
        for _ in 0..SURFACES_MAX {
            let Traced { hit, evaluations, .. } = self.trace(&ray);
            let steps = self.without_cells().trace(&ray).steps;
            let Some(hit) = hit else {
                path.push(PathRay { ray, steps, evaluations, surface: None });
                break;
            };
            travelled += hit.distance;
            let cone = ray.spread * travelled;
            let surface = self.surface(&ray, hit, cone, values);
            let (normal, is_plane) = (surface.normal, hit.plane.is_some());
            throughput *= surface.reflectance;
            path.push(PathRay { ray, steps, evaluations, surface: Some(surface) });
            if throughput < FRACTION_MIN {
                break;
            }
            let off = if is_plane { 0.0 } else { cone.max(MIRROR_START) };
            let along = 2.0 * dot(ray.direction, normal);
            let mirrored = difference(ray.direction, normal.map(|part| along * part));
            // Keep the mirrored ray from entering the surface.
            let lift = (0.02 - dot(mirrored, normal)).max(0.0);
            ray = Ray {
                origin: sum(hit.position, normal.map(|part| part * off)),
                direction: unit(sum(mirrored, normal.map(|part| part * lift))),
                spread: ray.spread,
            };
        }
        path
    }

    fn surface(&self, ray: &Ray, hit: Hit, cone: f32, values: &FrameValues) -> PathSurface {
        let normal = self.normal(ray, &hit);
        let occlusion = self.occlusion(ray, &hit, normal, values.reach);
        let blocked = occlusion
            .iter()
            .zip(rays::PROBE_WEIGHTS)
            .map(|(probe, weight)| weight * ((probe.height - probe.distance) / probe.height).clamp(0.0, 1.0));
        let weights: f32 = rays::PROBE_WEIGHTS.iter().sum();
        let shadows = values.lights.iter().enumerate();
        PathSurface {
            hit,
            normal,
            shadows: shadows
                .filter_map(|(number, light)| self.shadow_ray(number, light, hit.position, normal, cone))
                .collect(),
            occlusion,
            openness: (1.0 - blocked.sum::<f32>() / weights).clamp(0.0, 1.0),
            reflectance: self.reflectance(ray, &hit, normal),
        }
    }

    fn occlusion(&self, ray: &Ray, hit: &Hit, normal: [f32; 3], reach: f32) -> [OcclusionProbe; 4] {
        // A value that is not a distance is compared with its slope at the surface.
        let slope = if self.world.non_lipschitz && hit.plane.is_none() { self.slope(ray, hit) } else { 1.0 };
        rays::PROBE_FRACTIONS.map(|fraction| {
            let height = reach.max(1e-4) * fraction;
            let place = sum(hit.position, normal.map(|part| part * height));
            let mut distance = height;
            if self.world.has_rest {
                distance = distance.min(self.regions.distance(place, 0.0, self.frame)[1] / slope);
            }
            let distance = self.heights(place).fold(distance, |distance, above| distance.min(above.max(0.0)));
            OcclusionProbe { height, distance: if distance.is_finite() { distance } else { 0.0 } }
        })
    }

    fn slope(&self, ray: &Ray, hit: &Hit) -> f32 {
        let h = tap_length(ray, hit);
        (length(self.tapped(hit.position, h)) / (4.0 * h)).max(1e-6)
    }

    /// Returns the fraction of the light that a surface mirrors, by Schlick's approximation.
    fn reflectance(&self, ray: &Ray, hit: &Hit, normal: [f32; 3]) -> f32 {
        let material = self.world.scene.objects.get(hit.object).map_or(0, |object| object.material);
        let Some(roots) = self.world.roots.materials.get(material) else { return 0.0 };
        let point = Point { position: hit.position, normal };
        let material = Material::of(String::new(), self.world.graph.evaluate(roots, &point, self.frame));
        let fraction = |value: f32| if value > 0.0 { value.min(1.0) } else { 0.0 };
        let reflect = fraction(material.reflect);
        if reflect == 0.0 {
            return 0.0;
        }
        let grazing = (1.0 + dot(ray.direction, normal)).clamp(0.0, 1.0).powi(5);
        let most = (1.0 - fraction(material.blur)).max(reflect);
        (reflect + (most - reflect) * grazing) * (1.0 - fraction(material.haze))
    }

    /// Follows the ray from a surface to a light. `None` if the light is behind the surface.
    pub(super) fn shadow_ray(
        &self,
        number: usize,
        light: &Light<f32>,
        p: [f32; 3],
        normal: [f32; 3],
        cone: f32,
    ) -> Option<ShadowRay> {
        let incoming = Incoming::of(light, p);
        if dot(normal, incoming.direction) <= 0.0 {
            return None;
        }
        let sharpness = (1.0 / incoming.widening.max(1e-4)).clamp(rays::SHARPNESS_MIN, rays::SHARPNESS_MAX);
        let origin = sum(p, normal.map(|part| part * (2.0 * cone).max(0.012)));
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
        let Some(span) = self.traced_span(&ray, penumbra) else { return Some(shadow) };
        let span = span.start.max(rays::SHADOW_START)..span.end.min(incoming.t);
        if !span.is_empty() {
            shadow.end = span.end;
            let follow = |probe: &Self| {
                let mut steps = Vec::new();
                let visible = match probe.world.non_lipschitz {
                    true => probe.follow_sharp(&ray, span.clone(), sharpness, &mut steps),
                    false => probe.follow_soft(&ray, span.clone(), sharpness, &mut steps),
                };
                (visible, steps)
            };
            let (visible, steps) = follow(self);
            (shadow.visible, shadow.evaluations) = (visible, steps.len());
            shadow.steps = follow(&self.without_cells()).1;
        }
        Some(shadow)
    }

    fn follow_soft(&self, ray: &Ray, span: Range<f32>, sharpness: f32, steps: &mut Vec<ShadowStep>) -> f32 {
        let (walk, Range { start: mut t, end }) = (Walk::of(self.regions, ray), span);
        let (mut visible, mut previous, mut stride) = (1.0_f32, NO_SPHERE, NO_SPHERE);
        for step in 0..STEPS_MAX.0 {
            let mut cell = self.cell_at(&walk, t);
            for _ in 0..rays::SKIPS_MAX {
                let Some(known) = cell.filter(|cell| cell.bound > 0.0 && t < end) else { break };
                let leaves = walk.exit_of(&known, t);
                if sharpness * known.bound < visible * leaves {
                    break;
                }
                (t, previous, stride) = (leaves, NO_SPHERE, NO_SPHERE);
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
            let narrow = visible / sharpness;
            let unseen = (bound - narrow * t) / (1.0 + narrow);
            let longest = rays::SHADOW_STEP_MAX.max(0.5 * bound).max(unseen);
            stride = bound.min(longest).max(rays::SHADOW_STEP_MIN + growth);
            t += stride;
        }
        visible * visible * (3.0 - 2.0 * visible)
    }

    fn follow_sharp(&self, ray: &Ray, span: Range<f32>, sharpness: f32, steps: &mut Vec<ShadowStep>) -> f32 {
        let (walk, Range { start: mut t, end }) = (Walk::of(self.regions, ray), span);
        for step in 0..STEPS_MAX.1 {
            let mut cell = self.cell_at(&walk, t);
            for _ in 0..rays::SKIPS_MAX {
                let Some(known) = cell.filter(|cell| cell.bound > 0.0 && t < end) else { break };
                t = walk.exit_of(&known, t);
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
                stride = stride.min(walk.exit_of(cell, t) - t);
            }
            let growth = STEP_GROWTH + self.world.shadow_step_growth();
            t += stride.max(rays::SHADOW_STEP_MIN + growth * step as f32);
        }
        1.0
    }
}

// Shadow rays, with the triangulation between their steps (`shaders/shadow.glsl`; Abt 2022, figure 11).

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
        let way = if is_sun { place.map(|part| -part) } else { difference(place, p) };
        let far = length(way).max(1e-6);
        let t = if is_sun { rays::SUN_DISTANCE } else { far };
        let widening = match light.kind {
            LightKind::Sun => light.radius,
            LightKind::Lamp => light.radius / t.max(1e-3),
            LightKind::Panel => {
                (length(cross(light.right, light.up)) / std::f32::consts::PI).sqrt() / t.max(1e-3)
            }
        };
        Self { direction: way.map(|part| part / far), t, widening }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::FrameInputs;
    use crate::region::{RegionOptions, RegionPlan};
    use crate::world::World;
    use crate::world::testing::world_of;

    fn path_of(world: &World, ray: Ray) -> Vec<PathRay> {
        let frame =
            FrameInputs { hoisted: world.hoisted.values(&FrameInputs::default()), ..FrameInputs::default() };
        let values = world.frame_tape.values(&frame);
        let regions = RegionPlan::new(world).build(&frame, &RegionOptions::default());
        let probe = RayProbe::new(world, &regions, &frame, &values.planes);
        probe.light_path(&ray, &values)
    }

    const FORWARD: Ray = Ray { origin: [0.0, 0.0, -5.0], direction: [0.0, 0.0, 1.0], spread: 1e-3 };

    #[test]
    fn a_ray_steps_by_the_distance_to_the_surface() {
        let path = path_of(&world_of("sphere(p, 1)"), FORWARD);
        let [only] = &path[..] else { panic!("{path:?}") };
        let surface = only.surface.as_ref().unwrap();
        assert!((surface.hit.distance - 4.0).abs() < 1e-2, "{:?}", surface.hit);
        for step in &only.steps {
            assert!((step.value - (4.0 - step.t)).abs() < 1e-3, "{step:?}");
        }
        assert!(surface.openness > 0.999, "{surface:?}");
        assert_eq!(surface.reflectance, 0.0);
    }

    #[test]
    fn mirrors_continue_the_path_and_corners_are_occluded() {
        let world = world_of(
            "material mirror { reflect = 0.5 }\nobject wall { shape = box(p, vec3(9, 9, 1))  material = mirror }\n\
             object ball { shape = sphere(p - vec3(0, 0, -9), 1) }\nsky { reach = 1 }",
        );
        let slanted = Ray { direction: [0.0, 0.6, 0.8], ..FORWARD };
        let path = path_of(&world, slanted);
        assert_eq!(path.len(), 2, "{path:?}");
        assert!((path[1].ray.direction[2] + 0.8).abs() < 1e-3);
        assert!(path[1].surface.is_none());
        let corner = world_of("union(box(p, vec3(9, 9, 1)), box(p - vec3(0, -1, -2), 1))\nsky { reach = 1 }");
        let at = |y: f32| {
            let path = path_of(&corner, Ray { origin: [0.0, y, -5.0], ..FORWARD });
            path[0].surface.clone().unwrap()
        };
        assert!(at(0.05).openness < 0.9 && at(3.0).openness > 0.999);
        assert!(at(0.05).occlusion[3].distance < 0.2);
    }

    #[test]
    fn shadow_rays_end_at_blockers_and_find_the_closest_pass_between_steps() {
        let text = |x: f32| {
            format!(
                "object floor {{ shape = box(p, vec3(20, 1, 20)) }}\nobject ball {{ shape = sphere(p - vec3({x}, 5, 0), 1) }}\n\
                 light lamp {{ position = vec3(0, 9, 0)  radius = 1 }}"
            )
        };
        let down = Ray { origin: [0.0, 3.0, 0.0], direction: [0.0, -1.0, 0.0], spread: 1e-3 };
        let shadow =
            |x: f32| path_of(&world_of(&text(x)), down)[0].surface.clone().unwrap().shadows[0].clone();
        assert_eq!(shadow(0.5).visible, 0.0);
        assert_eq!(shadow(9.0).visible, 1.0);
        let half = shadow(1.3);
        assert!(half.visible > 0.05 && half.visible < 0.95, "{half:?}");
        // The closest pass of the ray to the ball is 0.3 at the ball's height.
        let closest = half.steps.iter().min_by(|a, b| a.fraction.total_cmp(&b.fraction)).unwrap();
        assert!((closest.closest - 0.3).abs() < 0.1, "{closest:?}");
        assert!((closest.t - closest.behind - 4.0).abs() < 0.6, "{closest:?}");
    }
}
