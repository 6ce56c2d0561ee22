//! The light path of one ray, step by step: the ray from the eye, its mirror images, and at each surface the shadow rays
//! and the probes of ambient occlusion (Abt 2022, figures 3, 6, 11 and 14).
//!
//! The rays are those of the shaders (`shaders/scene.frag`, `shaders/shadow.glsl`, `shaders/occlusion.glsl`), without
//! the random directions of rough mirrors.

use super::shadow_ray::ShadowRay;
use super::{Hit, Ray, RayProbe, Traced, add, tap_length, unit};
use crate::graph::Point;
use crate::lang::{Light, Material};
use crate::rays;

/// Maximum number of surfaces on a path.
const SURFACES_MAX: usize = 5;
/// A path ends if less than this fraction of its light would reach the eye.
const FRACTION_MIN: f32 = 0.004;
/// Minimum distance from a surface to the start of its mirror ray.
const MIRROR_START: f32 = 0.002;

/// The inputs of a frame that light needs.
#[derive(Debug, Clone, Copy)]
pub struct FrameLight<'a> {
    /// The lights.
    pub lights: &'a [Light<f32>],
    /// The distance within which objects block ambient light.
    pub reach: f32,
}

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
    /// Follows a ray from the eye over mirrors, and examines the light on each surface.
    pub fn light_path(&self, ray: &Ray, light: FrameLight<'_>) -> Vec<PathRay> {
        let mut path = Vec::new();
        let (mut ray, mut travelled, mut throughput) = (*ray, 0.0, 1.0);
        for _ in 0..SURFACES_MAX {
            let Traced { hit, evaluations, .. } = self.trace(&ray);
            let steps = self.steps_of(&ray);
            let Some(hit) = hit else {
                path.push(PathRay { ray, steps, evaluations, surface: None });
                break;
            };
            travelled += hit.distance;
            let cone = ray.spread * travelled;
            let surface = self.surface(&ray, hit, cone, light);
            let (normal, is_plane) = (surface.normal, hit.plane.is_some());
            throughput *= surface.reflectance;
            path.push(PathRay { ray, steps, evaluations, surface: Some(surface) });
            if throughput < FRACTION_MIN {
                break;
            }
            let off = if is_plane { 0.0 } else { cone.max(MIRROR_START) };
            let mirrored = reflected(ray.direction, normal);
            // Keep the mirrored ray from entering the surface.
            let lift = (0.02 - dot(mirrored, normal)).max(0.0);
            ray = Ray {
                origin: add(hit.position, normal.map(|part| part * off)),
                direction: unit(add(mirrored, normal.map(|part| part * lift))),
                spread: ray.spread,
            };
        }
        path
    }

    fn steps_of(&self, ray: &Ray) -> Vec<RayStep> {
        let begun = self.steps.replace(Some(Vec::new()));
        debug_assert!(begun.is_none(), "rays are recorded one after another");
        self.without_cells(|plain| plain.trace(ray));
        self.steps.take().unwrap_or_default()
    }

    fn surface(&self, ray: &Ray, hit: Hit, cone: f32, light: FrameLight<'_>) -> PathSurface {
        let normal = self.normal(ray, &hit);
        let occlusion = self.occlusion(ray, &hit, normal, light.reach);
        let blocked = occlusion
            .iter()
            .zip(rays::PROBE_WEIGHTS)
            .map(|(probe, weight)| weight * ((probe.height - probe.distance) / probe.height).clamp(0.0, 1.0));
        let weights: f32 = rays::PROBE_WEIGHTS.iter().sum();
        let shadows = light.lights.iter().enumerate();
        PathSurface {
            hit,
            normal,
            shadows: shadows
                .filter_map(|(number, light)| self.shadow_ray((number, light), hit.position, normal, cone))
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
            let place = add(hit.position, normal.map(|part| part * height));
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
        let sum = self.tapped(hit.position, h);
        (dot(sum, sum).sqrt() / (4.0 * h)).max(1e-6)
    }

    /// Returns the fraction of the light that a surface mirrors, by Schlick's approximation.
    fn reflectance(&self, ray: &Ray, hit: &Hit, normal: [f32; 3]) -> f32 {
        let material = self.world.scene.objects.get(hit.object).map_or(0, |object| object.material);
        let Some(roots) = self.world.roots.materials.get(material) else { return 0.0 };
        let point = Point { position: hit.position, normal };
        let Ok(numbers) = self.world.graph.evaluate(roots, &point, self.frame) else { return 0.0 };
        let material = Material::of(String::new(), numbers);
        let fraction = |value: f32| if value > 0.0 { value.min(1.0) } else { 0.0 };
        let reflect = fraction(material.reflect);
        if reflect == 0.0 {
            return 0.0;
        }
        let grazing = (1.0 + dot(ray.direction, normal)).clamp(0.0, 1.0).powi(5);
        let most = (1.0 - fraction(material.blur)).max(reflect);
        (reflect + (most - reflect) * grazing) * (1.0 - fraction(material.haze))
    }
}

fn reflected(direction: [f32; 3], normal: [f32; 3]) -> [f32; 3] {
    let along = 2.0 * dot(direction, normal);
    std::array::from_fn(|axis| direction[axis] - along * normal[axis])
}

pub(super) fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
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
        probe.light_path(&ray, FrameLight { lights: &values.lights, reach: values.reach })
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
