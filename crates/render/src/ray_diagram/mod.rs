//! Diagrams of one ray: its path in the image, and sections through the scene that show each step of the ray, of a
//! shadow ray, and of the probes of ambient occlusion (Abt 2022, figures 3, 6, 11 and 14).
//!
//! A diagram is a list of [`Mark`]s. The overlay of a window paints them, and [`RayDiagram::draw_over`] draws them over
//! a finished image.

mod section;

use glam::{DVec3, Vec2, vec2};
use mariana_field::lang::{Light, LightKind};
use mariana_field::ray_probe::{PathRay, PathSurface, Ray, RayProbe, ShadowRay};

use crate::frame::Frame;
use crate::frame::camera::Camera;
use section::Section;

/// A colour: red, green, blue and opacity.
pub type Ink = [u8; 4];

/// A shape of a diagram. Positions and lengths are in pixels of the image, from its upper left corner.
#[derive(Debug, Clone, PartialEq)]
pub enum Mark {
    /// A line of a width.
    Line {
        /// The start.
        from: Vec2,
        /// The end.
        to: Vec2,
        /// The width.
        width: f32,
        /// The colour.
        ink: Ink,
    },
    /// A circle, drawn as a line of a width.
    Circle {
        /// The centre.
        center: Vec2,
        /// The radius.
        radius: f32,
        /// The width of the line.
        width: f32,
        /// The colour.
        ink: Ink,
    },
    /// A filled circle.
    Disc {
        /// The centre.
        center: Vec2,
        /// The radius.
        radius: f32,
        /// The colour.
        ink: Ink,
    },
    /// A filled rectangle.
    Ground {
        /// The upper left corner.
        low: Vec2,
        /// The lower right corner.
        high: Vec2,
        /// The colour.
        ink: Ink,
    },
    /// A line of text.
    Text {
        /// The upper left corner.
        at: Vec2,
        /// The size of the letters.
        size: f32,
        /// The words.
        words: String,
        /// The colour.
        ink: Ink,
    },
}

/// Greatest coordinate and radius of a mark in pixels. Painters lose precision beyond.
const COORDINATE_MAX: f32 = 1e6;

impl Mark {
    /// True if painters can draw the mark.
    fn can_be_drawn(&self) -> bool {
        let is_near = |at: &Vec2| at.abs().max_element() < COORDINATE_MAX && at.is_finite();
        match self {
            Self::Line { from, to, .. } | Self::Ground { low: from, high: to, .. } => {
                is_near(from) && is_near(to)
            }
            Self::Circle { center, radius, .. } | Self::Disc { center, radius, .. } => {
                is_near(center) && *radius < COORDINATE_MAX
            }
            Self::Text { at, .. } => is_near(at),
        }
    }
}

/// Marks that are visible in a rectangle.
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    /// The upper left and the lower right corner.
    pub clip: [Vec2; 2],
    /// The marks, the lowest first.
    pub marks: Vec<Mark>,
}

/// A diagram of one ray.
#[derive(Debug, Clone, PartialEq)]
pub struct RayDiagram {
    /// Width and height of the image in pixels.
    pub size: Vec2,
    /// The groups, the lowest first.
    pub groups: Vec<Group>,
}

const GROUND: Ink = [9, 10, 13, 226];
const FRAME: Ink = [96, 100, 110, 255];
const TEXT: Ink = [232, 234, 237, 255];
const RAY: Ink = [255, 255, 255, 255];
const SURFACE: Ink = [236, 236, 236, 255];
const LEVEL: Ink = [255, 255, 255, 34];
const NORMAL: Ink = [120, 204, 96, 255];
const MIRROR: Ink = [96, 214, 230, 255];
const LIT: [f32; 3] = [255.0, 214.0, 90.0];
const DARK: [f32; 3] = [240.0, 72.0, 60.0];
const HEIGHT: Ink = [96, 150, 255, 255];
const DISTANCE: Ink = [255, 214, 90, 255];
/// Size of the letters relative to the image's height. The next constant limits it, in pixels.
const LETTERS_FRACTION: f32 = 1.0 / 46.0;
const LETTERS: (f32, f32) = (10.0, 34.0);
/// Length in the scene of a ray that meets nothing.
const INTO_THE_SKY: f32 = 100.0;
/// Nothing nearer to the eye than this is projected.
const NEAR: f64 = 0.02;

impl RayDiagram {
    /// Draws the diagram of the ray through a point, given as fractions of the image from the upper left corner. `size`
    /// is the image's width and height in pixels.
    pub fn of(probe: &RayProbe<'_>, frame: &Frame, ray: &Ray, names: &[String], size: (u32, u32)) -> Self {
        let path = probe.light_path(ray, &frame.values);
        let size = vec2(size.0 as f32, size.1 as f32);
        let unit = (size.y * LETTERS_FRACTION).clamp(LETTERS.0, LETTERS.1).round();
        let mut drawing = Drawing { probe, camera: &frame.camera, size, unit, groups: Vec::new() };
        drawing.path(&path, &frame.values.lights);
        if let Some(first) = path.first() {
            drawing.sections(first, names);
        }
        Self { size, groups: drawing.groups }.drawable()
    }

    fn drawable(mut self) -> Self {
        self.groups.iter_mut().for_each(|group| group.marks.retain(Mark::can_be_drawn));
        self
    }
}

struct Drawing<'a> {
    probe: &'a RayProbe<'a>,
    camera: &'a Camera,
    size: Vec2,
    /// The size of the letters; the width of lines is a fraction of it.
    unit: f32,
    groups: Vec<Group>,
}

fn ink([red, green, blue]: [f32; 3]) -> Ink {
    [red as u8, green as u8, blue as u8, 255]
}

/// The colour of a shadow ray of which a fraction arrives.
fn ink_of_light(visible: f32) -> Ink {
    ink(std::array::from_fn(|part| DARK[part] + (LIT[part] - DARK[part]) * visible.clamp(0.0, 1.0)))
}

/// The colour of a step, from blue for the first to red for the last.
fn ink_of_step(number: usize, count: usize) -> Ink {
    let fraction = number as f32 / count.saturating_sub(1).max(1) as f32;
    ink(crate::view::scale::heat(fraction).map(|part| 255.0 * (0.25 + 0.75 * part)))
}

/// The number of evaluations with the tree's cells, and of the drawn steps.
fn evaluations(with_cells: usize, drawn: usize) -> String {
    if with_cells == drawn {
        format!("{drawn} evaluations")
    } else {
        format!("{drawn} evaluations ({with_cells} with cells)")
    }
}

fn vector(vector: [f32; 3]) -> DVec3 {
    DVec3::from_array(vector.map(f64::from))
}

fn along(origin: [f32; 3], direction: [f32; 3], t: f32) -> DVec3 {
    DVec3::from_array(std::array::from_fn(|axis| f64::from(origin[axis] + t * direction[axis])))
}

impl Drawing<'_> {
    fn project(&self, point: DVec3) -> Option<Vec2> {
        let (x, y) = self.camera.project(point)?;
        Some(vec2((0.5 + 0.5 * x as f32) * self.size.x, (0.5 - 0.5 * y as f32) * self.size.y))
    }

    fn depth(&self, point: DVec3) -> f64 {
        (point - self.camera.position).dot(self.camera.forward)
    }

    /// The part of a line in the scene that is in front of the eye.
    fn line(&self, from: DVec3, to: DVec3, width: f32, ink: Ink) -> Option<Mark> {
        let (near, far) = (self.depth(from), self.depth(to));
        if near.max(far) < NEAR {
            return None;
        }
        let cut = |a: DVec3, b: DVec3, da: f64, db: f64| {
            if da < NEAR { a + (b - a) * ((NEAR - da) / (db - da)) } else { a }
        };
        let (from, to) = (cut(from, to, near, far), cut(to, from, far, near));
        Some(Mark::Line { from: self.project(from)?, to: self.project(to)?, width, ink })
    }

    /// A ball in the scene, as a circle.
    fn ball(&self, center: DVec3, radius: f32, width: f32, ink: Ink) -> Option<Mark> {
        let depth = self.depth(center);
        let radius = f64::from(radius) / (depth * self.camera.tan_half.1) * 0.5 * f64::from(self.size.y);
        let center = self.project(center).filter(|_| depth > NEAR)?;
        Some(Mark::Circle { center, radius: radius as f32, width, ink })
    }

    fn dot(&self, center: DVec3, ink: Ink) -> Option<Mark> {
        Some(Mark::Disc { center: self.project(center)?, radius: 0.22 * self.unit, ink })
    }

    /// Draws the path over the image: mirror rays, shadow rays and the probes of occlusion.
    fn path(&mut self, path: &[PathRay], lights: &[Light<f32>]) {
        let (thin, wide) = (0.07 * self.unit, 0.15 * self.unit);
        let mut marks = Vec::new();
        for (number, one) in path.iter().enumerate() {
            let end = one.surface.as_ref().map_or(INTO_THE_SKY, |surface| surface.hit.distance);
            // The ray from the eye is a single point of the image.
            if number > 0 {
                let at = |t: f32| along(one.ray.origin, one.ray.direction, t);
                marks.extend(self.line(at(0.0), at(end), wide, MIRROR));
                for step in &one.steps {
                    marks.extend(self.ball(at(step.t), step.value, thin, [96, 214, 230, 110]));
                }
            }
            let Some(surface) = &one.surface else { continue };
            let place = vector(surface.hit.position);
            for shadow in &surface.shadows {
                self.shadow_path(shadow, lights, &mut marks);
            }
            for probe in &surface.occlusion {
                let at = along(surface.hit.position, surface.normal, probe.height);
                marks.extend(self.line(place, at, wide, HEIGHT));
                marks.extend(self.ball(at, probe.distance.max(0.0), thin, DISTANCE));
            }
            marks.extend(self.dot(place, RAY));
        }
        self.groups.push(Group { clip: [Vec2::ZERO, self.size], marks });
    }

    fn shadow_path(&self, shadow: &ShadowRay, lights: &[Light<f32>], marks: &mut Vec<Mark>) {
        let ink = ink_of_light(shadow.visible);
        let lamp = lights.get(shadow.light).filter(|light| light.kind != LightKind::Sun);
        let last = shadow.steps.last().map_or(shadow.end, |step| step.t);
        let blocked = shadow.visible == 0.0;
        let end = match lamp {
            _ if blocked => along(shadow.origin, shadow.direction, last),
            Some(light) => vector(light.place()),
            None => along(shadow.origin, shadow.direction, INTO_THE_SKY),
        };
        marks.extend(self.line(vector(shadow.origin), end, 0.1 * self.unit, ink));
        marks.extend(self.dot(end, ink).filter(|_| blocked || lamp.is_some()));
    }

    /// Draws the sections at the right edge: the ray from the eye, a shadow ray, and the probes of occlusion.
    fn sections(&mut self, first: &PathRay, names: &[String]) {
        let gap = (0.6 * self.unit).round();
        let width = (0.4 * self.size.x).round();
        let height = ((self.size.y - 4.0 * gap) / 3.0).floor();
        if width < 12.0 * self.unit || height < 5.0 * self.unit {
            return;
        }
        let (left, mut top) = (self.size.x - gap - width, gap);
        let mut next = || {
            let low = vec2(left, top);
            top += height + gap;
            [low, low + vec2(width, height)]
        };
        let mut made = vec![self.eye_ray(first, next(), names)];
        if let Some(surface) = &first.surface {
            let by_steps = |shadow: &&ShadowRay| shadow.steps.len();
            if let Some(shadow) =
                surface.shadows.iter().filter(|shadow| !shadow.steps.is_empty()).max_by_key(by_steps)
            {
                made.push(self.shadow_ray(shadow, surface.normal, next()));
            }
            made.push(self.occlusion(surface, first.ray.direction, next()));
        }
        self.groups.extend(made);
    }

    fn eye_ray(&self, first: &PathRay, place: [Vec2; 2], names: &[String]) -> Group {
        let direction = vector(first.ray.direction);
        let last = first.steps.last().map_or(1.0, |step| step.t + step.value.max(0.0));
        let (reached, up) = match &first.surface {
            Some(surface) => (surface.hit.distance, vector(surface.normal)),
            None => (last.min(INTO_THE_SKY), self.camera.up),
        };
        let origin = vector(first.ray.origin);
        let mut section = Section::new(place, self.unit, origin, direction, up, self.camera.up);
        section.show([-0.03 * reached, 1.12 * reached], 0.5);
        let object = first.surface.as_ref().and_then(|surface| names.get(surface.hit.object));
        let count = first.steps.len();
        let found = match object {
            Some(name) => format!("hits {name} at {reached:.2}"),
            None => "sky".to_owned(),
        };
        section.title(&format!("eye ray: {}, {found}", evaluations(first.evaluations as usize, count)));
        section.contour(|point| self.probe.distance_at(point));
        section.line([0.0, 0.0], [if object.is_some() { reached } else { 1.12 * reached }, 0.0], 0.1, RAY);
        for (number, step) in first.steps.iter().enumerate() {
            // A value that is not a distance has no free ball: the circle shows the step.
            let next = first.steps.get(number + 1).map_or(reached, |next| next.t);
            let radius = if self.probe.is_distance() { step.value } else { next - step.t };
            section.circle([step.t, 0.0], radius.max(0.0), 0.09, ink_of_step(number, count));
            section.disc([step.t, 0.0], 0.16, ink_of_step(number, count));
        }
        if let Some(surface) = &first.surface {
            let normal = section.direction(surface.normal);
            let length = 0.16 * reached;
            section.line([reached, 0.0], [reached + length * normal[0], length * normal[1]], 0.14, NORMAL);
            if surface.reflectance > 0.0 {
                let back = 2.0 * normal[0];
                let mirrored = [1.0 - back * normal[0], -back * normal[1]];
                let end = [reached + 9.0 * length * mirrored[0], 9.0 * length * mirrored[1]];
                section.line([reached, 0.0], end, 0.1, MIRROR);
            }
            section.disc([reached, 0.0], 0.26, RAY);
        }
        section.finish()
    }

    fn shadow_ray(&self, shadow: &ShadowRay, normal: [f32; 3], place: [Vec2; 2]) -> Group {
        let [direction, normal] = [shadow.direction, normal].map(vector);
        let mut section = Section::new(place, self.unit, vector(shadow.origin), direction, normal, normal);
        let last = shadow.steps.last().map_or(1.0, |step| step.t + step.nearest.max(0.0));
        let end = last.min(shadow.end).max(0.1);
        section.show([-0.06 * end, 1.06 * end], 0.5);
        let (number, count) = (shadow.light + 1, shadow.steps.len());
        let percent = (100.0 * shadow.visible).round();
        let evaluations = evaluations(shadow.evaluations, count);
        section.title(&format!("shadow ray to light {number}: {evaluations}, {percent} % arrives"));
        section.contour(|point| self.probe.distance_at(point));
        section.line([0.0, 0.0], [1.06 * end, 0.0], 0.1, ink_of_light(shadow.visible));
        let fractions = shadow.steps.iter().map(|step| step.fraction);
        // Only distances have a closest pass.
        let least = fractions.enumerate().min_by(|a, b| a.1.total_cmp(&b.1)).map(|(number, _)| number);
        let least = least.filter(|_| self.probe.is_distance());
        for (number, step) in shadow.steps.iter().enumerate() {
            let is_near_least = least.is_some_and(|least| number == least || number + 1 == least);
            let width = if is_near_least { 0.14 } else { 0.06 };
            let color = if is_near_least { DISTANCE } else { [160, 164, 172, 150] };
            section.circle([step.t, 0.0], step.nearest.max(0.0), width, color);
            section.disc([step.t, 0.0], 0.14, color);
            if step.behind > 0.0 || least == Some(number) {
                let (at, width) = (step.t - step.behind, if least == Some(number) { 0.16 } else { 0.08 });
                let color = if least == Some(number) { ink(DARK) } else { [240, 120, 100, 160] };
                section.line([at, -step.closest], [at, step.closest], width, color);
            }
        }
        if let Some(step) = least.and_then(|least| shadow.steps.get(least)) {
            section.write_line(&format!("closest pass: {:.3} at {:.2}", step.closest, step.t - step.behind));
        }
        section.finish()
    }

    fn occlusion(&self, surface: &PathSurface, direction: [f32; 3], place: [Vec2; 2]) -> Group {
        let [normal, direction] = [surface.normal, direction].map(vector);
        // The section of the ray from the eye, turned so that the normal points up.
        let level = direction - normal * direction.dot(normal);
        let level = level.normalize_or(self.camera.right);
        let mut section = Section::new(place, self.unit, vector(surface.hit.position), level, normal, normal);
        let reach = surface.occlusion.last().map_or(1.0, |probe| probe.height);
        section.show_height([-0.3 * reach, 2.05 * reach]);
        let percent = (100.0 * surface.openness).round();
        section.title(&format!("occlusion: {percent} % of the ambient light arrives"));
        section.contour(|point| self.probe.distance_at(point));
        for probe in &surface.occlusion {
            section.circle([0.0, probe.height], probe.height, 0.06, [96, 150, 255, 150]);
            section.circle([0.0, probe.height], probe.distance.clamp(0.0, probe.height), 0.12, DISTANCE);
            section.line([0.0, 0.0], [0.0, probe.height], 0.14, HEIGHT);
        }
        for probe in &surface.occlusion {
            section.disc([0.0, probe.height], 0.2, HEIGHT);
        }
        section.write_line("blue: height of a probe, yellow: distance to the scene");
        section.finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::testing::world_of;
    use mariana_field::region::{RegionOptions, RegionPlan};
    use mariana_music::Features;

    const SIZE: (u32, u32) = (640, 360);

    /// The diagram of the ray through the middle of the image.
    fn diagram(text: &str, size: (u32, u32)) -> RayDiagram {
        let world = world_of(text);
        let frame = Frame::new(&world, 0.0, Features::SILENCE, size);
        let regions = RegionPlan::new(&world).build(&frame.inputs, &RegionOptions::default());
        let probe = RayProbe::new(&world, &regions, &frame.inputs, &frame.values.planes);
        let camera = &frame.camera;
        let ray = Ray {
            origin: camera.position.as_vec3().to_array(),
            direction: camera.forward.as_vec3().to_array(),
            spread: 1e-3,
        };
        RayDiagram::of(&probe, &frame, &ray, &["ball".to_owned()], size)
    }

    fn words(diagram: &RayDiagram) -> Vec<&str> {
        let marks = diagram.groups.iter().flat_map(|group| &group.marks);
        marks
            .filter_map(|mark| if let Mark::Text { words, .. } = mark { Some(&**words) } else { None })
            .collect()
    }

    // The small sphere extends the scene's bounds, so that the ray to the lamp has steps.
    const BALL: &str = "material mirror { reflect = 0.5 }\n\
                        object ball { shape = union(sphere(p, 1), sphere(p - vec3(-3, 3, -1), 0.2))  material = mirror }\n\
                        camera { position = vec3(0, 0, -5)  target = vec3(0) }\nlight lamp { position = vec3(-4, 4, -4) }";

    #[test]
    fn a_surface_has_a_path_and_three_sections_within_the_image() {
        let found = diagram(BALL, SIZE);
        let titles = words(&found).join("\n");
        for part in
            ["eye ray: ", "hits ball at 4.00", "shadow ray to light 1", "100 % arrives", "occlusion: 100 %"]
        {
            assert!(titles.contains(part), "{titles}");
        }
        assert_eq!(found.groups.len(), 4);
        for group in &found.groups {
            let [low, high] = group.clip;
            assert!(low.cmpge(Vec2::ZERO).all() && high.cmple(found.size).all() && low.cmplt(high).all());
        }
        // The lamp is up and to the left in the image.
        let path = &found.groups[0].marks;
        let to_lamp = path.iter().any(|mark| {
            matches!(mark, Mark::Line { from, to, ink, .. }
                if *ink == ink_of_light(1.0) && to.x < from.x - 50.0 && to.y < from.y - 50.0)
        });
        assert!(to_lamp, "{path:?}");
    }

    #[test]
    fn the_sky_has_one_section_and_a_small_image_none() {
        let sky = "sphere(p - vec3(9, 0, 0), 1)\ncamera { position = vec3(0, 0, -5)  target = vec3(0) }";
        let found = diagram(sky, SIZE);
        assert_eq!(found.groups.len(), 2);
        assert!(words(&found)[0].ends_with(", sky"), "{:?}", words(&found));
        assert_eq!(diagram(BALL, (120, 60)).groups.len(), 1);
    }

    #[test]
    fn marks_are_drawn_inside_their_clip_only() {
        let clip = [vec2(4.0, 4.0), vec2(12.0, 12.0)];
        let ink = [255, 0, 0, 255];
        let marks = vec![
            Mark::Line { from: vec2(-1e4, 8.0), to: vec2(1e4, 8.0), width: 2.0, ink },
            Mark::Circle { center: vec2(8.0, 8.0), radius: f32::INFINITY, width: 1.0, ink },
            Mark::Disc { center: vec2(f32::NAN, 0.0), radius: 3.0, ink },
            Mark::Line { from: vec2(-1e30, 5.0), to: vec2(1e30, 5.0), width: 2.0, ink },
        ];
        let mut rgba = vec![0; 4 * 16 * 16];
        let diagram = RayDiagram { size: vec2(16.0, 16.0), groups: vec![Group { clip, marks }] }.drawable();
        assert_eq!(diagram.groups[0].marks.len(), 1);
        diagram.draw_over(&mut rgba);
        let red = |x: usize, y: usize| rgba[4 * (16 * y + x)];
        assert_eq!([red(3, 8), red(4, 8), red(11, 7), red(12, 8), red(8, 5)], [0, 255, 255, 0, 0]);
    }
}
