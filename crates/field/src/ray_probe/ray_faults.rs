//! Faults of a scene that its picture may hide: rays that use up their steps, steps over surfaces, and a camera inside of
//! an object.

use super::{Ray, RayProbe, Traced, sides, unit};
use crate::graph::FrameInputs;
use crate::lang::{Diagnostic, Span};
use crate::rays;
use crate::region::{RegionOptions, RegionPlan};
use crate::vectors::{difference, length};
use crate::world::World;
use std::ops::Range;

/// The fractions of a step at which a surface is searched.
const BETWEEN: [f32; 4] = [0.3, 0.55, 0.75, 0.9];
/// A ray has stepped over a surface if it passed a point this deep inside, as a fraction of the step.
const DEEP: f32 = 0.02;
/// An object is reported if at least this many rays step over its surface, and the scene if at least this fraction of the
/// rays use up their steps.
const OVERSTEPPED_MIN: u32 = 3;
const CAPPED_MIN: f32 = 0.005;
/// Clauses that may be run before no further rays are followed: about a second.
const CLAUSES_MAX: u64 = 1 << 28;
/// Below this slope, a factor makes steps noticeably longer.
const FLAT: f32 = 0.7;

/// Costs and faults of the rays of a scene's camera.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RayFaults {
    /// The object that contains the camera.
    pub around: Option<Span>,
    /// Number of rays.
    pub rays: u32,
    /// Number of evaluations of the distance.
    pub evaluations: u64,
    /// Number of clauses that these evaluations ran.
    pub clauses: u64,
    /// Number of rays that used up their steps.
    pub capped: u32,
    /// The usual slope of the value at the ends of those rays: 1 for a distance. `None` without such rays.
    pub slope: Option<f32>,
    /// For each object, the number of rays that stepped over its surface.
    pub overstepped: Vec<u32>,
}

impl RayFaults {
    /// Returns warnings, at the objects of `world`.
    pub fn warnings(&self, world: &World) -> Vec<Diagnostic> {
        let objects = world.scene.objects.iter();
        let mut warnings: Vec<Diagnostic> = objects
            .zip(&self.overstepped)
            .filter(|(_, rays)| **rays >= OVERSTEPPED_MIN)
            .map(|(object, _)| {
                let message = format!(
                    "rays step over the surface of `{}`, because its value is larger than the distance to it",
                    object.name
                );
                Diagnostic::warning(object.span, message).hint(
                    "if the cells of a repetition differ, add `bound = other_cells(p, size, reach)` to the object: a \
                     shape in another cell may be nearer; otherwise divide the value by its steepest slope",
                )
            })
            .collect();
        if let Some(span) = self.around {
            let warning =
                Diagnostic::warning(span, "the camera is inside of this object, and sees nothing else");
            warnings.push(warning.hint("move the camera's `position` out of the object"));
        }
        if self.capped as f32 >= CAPPED_MIN * self.rays.max(1) as f32
            && let Some(object) = world.scene.objects.first()
        {
            let percent = 100.0 * self.capped as f32 / self.rays as f32;
            let message = format!(
                "{percent:.1} % of the camera's rays use up their steps before they reach a surface or the sky"
            );
            let hint = match self.slope.filter(|slope| *slope < FLAT && *slope > 0.0) {
                Some(slope) => format!(
                    "the value is flat: its slope is about {slope:.2} where these rays end. Multiply it by {:.1}",
                    1.0 / slope
                ),
                None => "the value stays small far from the surface, or is steep in places: keep its slope near 1, \
                         and combine shapes with `union`, `intersect` and their smooth forms"
                    .to_owned(),
            };
            warnings.push(Diagnostic::warning(object.span, message).hint(hint));
        }
        warnings
    }
}

/// Follows rays of the scene's camera at a time without sound, in a grid of `columns` by `rows`; fewer rays if the scene
/// is large. Steps over surfaces are searched only in a scene whose value is a distance: for other values the tree's
/// bounds make steps safe.
pub fn ray_faults(world: &World, time: f32, columns: usize, rows: usize) -> RayFaults {
    let params = world.scene.params.iter().map(|param| param.default).collect();
    let mut frame = FrameInputs { time, params, shapes: world.scene.atlas.clone(), ..FrameInputs::default() };
    let camera = world.frame_tape.values(&frame).camera;
    frame.eye = camera.position;
    frame.hoisted = world.hoisted.values(&frame);
    let regions = RegionPlan::new(world).build(&frame, &RegionOptions::default());
    let planes = world.frame_tape.values(&frame).planes;
    let around = world.object_around(camera.position, &frame).map(|object| object.span);
    let ray_probe = RayProbe::new(world, &regions, &frame, &planes);
    let forward = unit(difference(camera.target, camera.position));
    let [right, up] = sides(forward);
    let half = (0.5 * camera.fov.to_radians()).tan();
    let wide = columns as f32 / rows.max(1) as f32;
    let mut faults =
        RayFaults { around, overstepped: vec![0; world.scene.objects.len()], ..RayFaults::default() };
    let mut slopes = Vec::new();
    let mut searched = Traced::default();
    for place in 0..columns * rows {
        if faults.clauses + searched.clauses > CLAUSES_MAX {
            break;
        }
        let fraction = |place: usize, of: usize| 2.0 * (place as f32 + 0.5) / of as f32 - 1.0;
        let (a, b) = (fraction(place % columns, columns), -fraction(place / columns, rows));
        let direction = unit(std::array::from_fn(|i| forward[i] + half * (wide * a * right[i] + b * up[i])));
        let ray = Ray { origin: camera.position, direction, spread: half / rows as f32 };
        let traced = ray_probe.trace(&ray);
        faults.rays += 1;
        faults.evaluations += u64::from(traced.evaluations);
        faults.clauses += traced.clauses;
        if traced.capped {
            faults.capped += 1;
            slopes.extend(slope_at_the_end(&ray_probe, &ray, &traced));
        }
        let passed = if world.non_lipschitz { None } else { passed_surface(&ray_probe, &ray, &mut searched) };
        if let Some(count) = passed.and_then(|object| faults.overstepped.get_mut(object)) {
            *count += 1;
        }
    }
    slopes.sort_by(f32::total_cmp);
    faults.slope = slopes.get(slopes.len() / 2).copied();
    faults
}

/// Returns the object whose surface the steps of a ray pass.
fn passed_surface(probe: &RayProbe<'_>, ray: &Ray, cost: &mut Traced) -> Option<usize> {
    let Range { start: mut t, end } = probe.traced_span(ray, None)?;
    let mut value = |t: f32| {
        let place = ray.at(t);
        probe.value(probe.regions.cell_at(place).as_ref(), place, cost)
    };
    for step in 0..rays::STEPS_MAX {
        let d = value(t);
        if d.is_nan() || d < rays::hit_fraction(step) * ray.spread * t || t + d >= end {
            return None;
        }
        if let Some(part) = BETWEEN.into_iter().find(|part| value(t + part * d) < -DEEP * d) {
            return Some(probe.regions.object(ray.at(t + part * d), probe.frame) as usize);
        }
        t += d;
    }
    None
}

/// Returns the slope of the value where a ray that used up its steps ended; `None` if that is not known.
fn slope_at_the_end(probe: &RayProbe<'_>, ray: &Ray, traced: &Traced) -> Option<f32> {
    let hit = traced.hit.filter(|hit| hit.plane.is_none())?;
    let h = ray.spread * hit.distance;
    let slope = length(probe.tapped(hit.position, h)) / (4.0 * h);
    Some(slope).filter(|slope| slope.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::testing::world_of;

    fn faults(text: &str) -> RayFaults {
        ray_faults(&world_of(text), 0.0, 32, 18)
    }

    #[test]
    fn a_ball_has_no_faults() {
        let faults = faults("sphere(p, 1)");
        assert_eq!((faults.rays, faults.capped, faults.slope), (576, 0, None));
        assert_eq!(faults.overstepped, [0]);
        assert!(faults.evaluations > 100 && faults.clauses > faults.evaluations);
    }

    #[test]
    fn faults_are_warned_of_with_a_remedy() {
        let world = world_of("object one { shape = sphere(p, 1) }\nobject two { shape = y - sin(x) }");
        let fine =
            RayFaults { rays: 1000, capped: 4, slope: Some(0.2), overstepped: vec![2, 0], ..faults("x") };
        assert!(fine.warnings(&world).is_empty());
        let faulty = RayFaults { capped: 20, overstepped: vec![0, 3], ..fine.clone() };
        let warnings = faulty.warnings(&world);
        let hints: Vec<&str> = warnings.iter().filter_map(|one| one.hint.as_deref()).collect();
        assert_eq!(warnings.len(), 2);
        assert!(warnings[0].message.contains("surface of `two`") && hints[0].contains("other_cells"));
        assert!(
            warnings[1].message.starts_with("2.0 %") && hints[1].contains("Multiply it by 5.0"),
            "{hints:?}"
        );
        let steep = RayFaults { capped: 20, slope: Some(0.9), ..fine };
        assert!(steep.warnings(&world)[0].hint.as_ref().unwrap().contains("slope near 1"));
    }

    #[test]
    fn rays_step_over_surfaces_of_a_repetition_whose_cells_differ() {
        let differing = "\
object floor { shape = y + 1 }
object balls { shape = sphere(repeat(p, vec3(2, 0, 2)), 0.3 + 0.65 * hash(round(p / 2))) }";
        assert!(faults(differing).overstepped[1] > 20, "{:?}", faults(differing));
        let alike = differing.replace("hash(round(p / 2))", "0.5");
        assert_eq!(faults(&alike).overstepped, [0, 0]);
    }
}
