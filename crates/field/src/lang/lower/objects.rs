//! Objects, lights and the picture: their blocks, and warnings about their numbers.
//!
//! The field `melt` merges an object with the previous one. Melting happens entirely in this module: the merged object has one shape and one material, and shaders need no
//! code for it.

use super::super::ast::Section;
use super::super::diagnostic::Diagnostic;
use super::super::fields::Field;
use super::super::material::Material;
use super::super::scene::{LightKind, Object, Picture, TextureRef};
use super::super::source::Span;
use super::super::value::Value;
use super::scene::SceneBuilder;
use super::sections::{Values, fields};
use crate::graph::{FrameInputs, Graph, Input, NodeId, Point, Screen};
use crate::limits::{FEEDBACK_DECAY_MAX, FEEDBACK_FRAMES_MAX, FEEDBACK_RATE};

impl SceneBuilder<'_> {
    pub(super) fn object(&mut self, name: String, span: Span, values: &Values) {
        let material = match (values.material, values.given("material")) {
            (Some(index), _) => index,
            (None, Some(_)) => return,
            (None, None) => self.default_material(),
        };
        let shape = match values.given("shape") {
            Some((Value::Vector(shape), _)) => shape.first(),
            Some(_) => return,
            None if values.broken => return,
            None => {
                let missing = Diagnostic::new(span, format!("the object `{name}` has no shape"));
                self.report(missing.hint("write `shape = sphere(p, 1)`, or any other distance"));
                return;
            }
        };
        let trust = values.given("trust").map(|_| self.lowering.number_of(values, "trust", shape));
        let shape = trust.map_or(shape, |trust| self.lowering.graph.mul(shape, trust));
        let bound = values.given("bound").map(|_| self.lowering.number_of(values, "bound", shape));
        let object = Object { name, span, shape, bound, material, trusted: trust.is_some() };
        let Some((_, melts)) = values.given("melt") else { return self.add_object(object) };
        let radius = self.lowering.number_of(values, "melt", shape);
        match self.parts.objects.pop() {
            Some(before) => {
                if let Some(both) = self.melted(before, object, radius) {
                    self.parts.objects.push(both);
                }
            }
            None => {
                let alone = Diagnostic::new(
                    melts,
                    format!("the object `{}` has no previous object to melt into", object.name),
                );
                self.report(alone.hint("declare another object before it, or leave out `melt`"));
            }
        }
    }

    /// Blends the shapes, and mixes the materials where the distances to both shapes differ by less than `radius`.
    /// Where they are equal, half of each material is used.
    fn melted(&mut self, a: Object, b: Object, radius: NodeId) -> Option<Object> {
        let radius = self.lowering.graph.max(radius, 1e-4);
        let shape = self.lowering.library_number("smooth_union", &[a.shape, b.shape, radius])?;
        let bound = match (a.bound, b.bound) {
            (Some(a), Some(b)) => Some(self.lowering.graph.min(a, b)),
            (a, b) => a.or(b),
        };
        let material = if a.material == b.material {
            a.material
        } else {
            if self.refuses_material("materials, including mixtures made by `melt`", b.span) {
                return None;
            }
            let difference = (a.shape - b.shape) / radius;
            let fraction = self.lowering.graph.clamp(difference * 0.5 + 0.5, 0.0, 1.0);
            let (one, other) = (self.parts.materials.get(a.material)?, self.parts.materials.get(b.material)?);
            let mixed = mixed(&mut self.lowering.graph, one, other, fraction);
            self.lowering.origins.of_mixture(self.parts.materials.len(), [a.material, b.material]);
            self.parts.materials.push(mixed);
            self.parts.materials.len() - 1
        };
        let name = format!("{} and {}", a.name, b.name);
        Some(Object { name, span: a.span, shape, bound, material, trusted: a.trusted || b.trusted })
    }

    /// Returns the kind of a light, determined by the fields that are set. Reports invalid combinations of fields.
    pub(super) fn light_kind(&mut self, name: &str, span: Span, values: &Values) -> Option<LightKind> {
        let given = |field: &str| values.given(field).map(|(_, span)| span);
        let (place, message, hint) =
            match (given("position"), given("direction"), given("right"), given("up")) {
                (Some(_), None, None, None) => return Some(LightKind::Lamp),
                (None, Some(_), None, None) => {
                    self.warn_of_rising_light(values);
                    return Some(LightKind::Sun);
                }
                (Some(_), None, Some(_), Some(_)) => return Some(LightKind::Panel),
                (Some(_), Some(second), ..) => (
                    second,
                    format!("the light `{name}` has both a position and a direction"),
                    "a lamp has a `position`; a light at infinity, such as the sun, has a `direction`",
                ),
                (None, Some(_), Some(side), _) | (None, Some(_), _, Some(side)) => (
                    side,
                    format!("the light `{name}` has both a direction and sides"),
                    "a panel has a `position`, its centre, and shines towards cross(right, up)",
                ),
                (_, _, Some(side), None) | (_, _, None, Some(side)) => (
                    side,
                    format!("the panel `{name}` has only one of `right` and `up`"),
                    "set both: the vectors from the centre to the middle of the right and of the upper side",
                ),
                (None, None, ..) if values.broken => return None,
                (None, None, ..) => (
                    span,
                    format!("the light `{name}` has no position or direction"),
                    "write `position = vec3(…)` for a lamp or `direction = vec3(…)` for a sun",
                ),
            };
        self.lowering.reports.refuse(Diagnostic::new(place, message).hint(hint))
    }

    /// Notes a sun whose light always rises, which leaves floors and the tops of objects dark.
    fn warn_of_rising_light(&mut self, values: &Values) {
        if let Some((Value::Vector(direction), span)) = values.given("direction")
            && direction.len() == 3
            && self.lowering.known(direction.part(1)).is_some_and(|y| y > 0.0)
        {
            self.parts.rising.push(span);
        }
    }

    /// Warns if the light of all lights rises. One such light among others may be intended.
    pub(super) fn warn_of_light_from_below(&mut self) {
        if self.parts.rising.len() < self.parts.lights.len() {
            return;
        }
        for span in std::mem::take(&mut self.parts.rising) {
            let warning = Diagnostic::warning(span, "this sun shines from below");
            self.lowering.reports.diagnostics.warn(warning.hint(
                "`direction` is the direction in which the light travels: for a sun in the sky, its y is negative",
            ));
        }
    }

    /// Reports fields that depend on the pixel through a `let` of the block, which only the field `allowed` may do.
    /// Silent after other mistakes, which may be the same.
    pub(super) fn refuse_pixels(&mut self, fields: &[(&str, &[NodeId])], allowed: &str, values: &Values) {
        if !self.lowering.reports.diagnostics.is_empty() {
            return;
        }
        for (name, numbers) in fields {
            let Some((_, span)) = values.given(name) else { continue };
            let used = self.lowering.graph.inputs_used(numbers);
            if used.inputs.contains(&Input::X) || used.inputs.contains(&Input::Y) {
                let message = format!("`{name}` cannot depend on `pixel`, which is a place in the picture");
                let wrong = Diagnostic::unsupported(span, message);
                self.report(wrong.hint(format!("use `pixel` in {allowed} alone")));
            }
        }
    }

    pub(super) fn check_picture(&mut self, picture: &Picture, values: &Values) {
        let fields = [
            ("exposure", &[picture.exposure][..]),
            ("bloom", &[picture.bloom]),
            ("vignette", &[picture.vignette]),
            ("grain", &[picture.grain]),
            ("decay", &[picture.decay]),
            ("blur", &[picture.blur]),
        ];
        self.refuse_pixels(&fields, "`warp`", values);
        let any = self.lowering.any_frame();
        let decay = picture.largest_decay(&self.lowering.graph, &any);
        let is_warped_away = values.given("warp").is_some() && self.is_warped_away(picture);
        let mut warn = |span, message: String, hint: &str| {
            self.lowering.reports.diagnostics.warn(Diagnostic::warning(span, message).hint(hint));
        };
        match values.given("decay") {
            Some((_, span)) if decay > FEEDBACK_DECAY_MAX => warn(
                span,
                format!("`decay` may be above {FEEDBACK_DECAY_MAX}, so trails would last too long"),
                "larger values are limited to it; `min` or `clamp` show that yours are smaller",
            ),
            Some((_, span)) if decay <= 0.0 => warn(
                span,
                "`decay` is never above 0, so there are no trails".to_owned(),
                "write the fraction of the light that stays, as in `decay = 0.95`",
            ),
            _ => {}
        }
        for name in ["warp", "blur"] {
            if let Some((_, span)) = values.given(name)
                && decay <= 0.0
            {
                warn(span, format!("`{name}` has no effect without trails"), "set `decay = 0.95`");
            }
        }
        if let Some((_, span)) = values.given("warp")
            && is_warped_away
        {
            warn(
                span,
                "`warp` takes all trails from outside of the picture".to_owned(),
                "places are 0 to 1, as in `pixel / resolution`",
            );
        }
        let most = FEEDBACK_FRAMES_MAX / FEEDBACK_RATE;
        let memory = self.lowering.graph.as_constant(picture.memory);
        if let Some((_, span)) = values.given("memory") {
            match memory {
                Some(memory) if (0.0..=most as f32).contains(&memory) => {
                    self.parts.memory = Some(span).filter(|_| decay <= 0.0);
                    let frames = (memory * FEEDBACK_RATE as f32).ceil();
                    let left = decay.clamp(0.0, FEEDBACK_DECAY_MAX).powf(frames);
                    if memory > 0.0 && left > VISIBLE {
                        warn(
                            span,
                            outlasting("trails last", left, frames as u32),
                            "leave `memory` out, because it follows from `decay`, or lower `decay`",
                        );
                    }
                }
                Some(memory) if memory > most as f32 => warn(
                    span,
                    format!("a `memory` of {memory} s would delay each still and each jump"),
                    &format!("it is limited to {most} s"),
                ),
                _ if !self.lowering.reports.diagnostics.is_empty() => {}
                _ => {
                    let wrong = Diagnostic::new(span, "`memory` is no number of seconds");
                    self.report(wrong.hint(format!("write a number from 0 to {most}")));
                }
            }
        }
    }

    /// True if no trail at some pixels comes from a place in the picture, at the start of a silent song.
    fn is_warped_away(&self, picture: &Picture) -> bool {
        let params = self.lowering.declared.params.iter().map(|param| param.default).collect();
        let screen = Screen::of_size((1280, 720));
        let inputs = FrameInputs { params, screen, ..FrameInputs::default() };
        (1..16).all(|at| {
            let point = Point::at(80.0 * at as f32, 45.0 * at as f32, 0.0);
            let place = self.lowering.graph.evaluate(&picture.warp, &point, &inputs);
            place.iter().all(|part| part.is_finite()) && place.iter().any(|part| !(0.0..=1.0).contains(part))
        })
    }

    /// Warns of a `memory` without anything to remember; after all blocks, which may call `previous`.
    pub(super) fn check_memory(&mut self) {
        let is_read = self.lowering.declared.textures.iter().any(TextureRef::is_last_frame);
        if let Some(span) = self.parts.memory.filter(|_| !is_read) {
            let warning = Diagnostic::warning(span, "`memory` has no effect without trails and `previous`");
            self.lowering.reports.diagnostics.warn(warning.hint("set `decay = 0.95`, or leave `memory` out"));
        }
    }

    /// Warns of constants that are clamped to another value, and of fields without the field that they need.
    ///
    /// Numbers that are being edited are no constants here, and so remain inputs.
    pub(super) fn warn_of_values(&mut self, section: Section, values: &Values) {
        for field in fields(section) {
            let Some((Value::Vector(value), span)) = values.given(field.name) else { continue };
            let name = field.name;
            let clamped = field.range.and_then(|range| {
                let numbers = value.parts().iter().filter_map(|part| self.lowering.graph.as_constant(*part));
                let mut clamped = numbers.map(|number| (range, number, range.clamp(number)));
                clamped.find(|(_, number, clamped)| !number.is_nan() && number != clamped)
            });
            if let Some((range, number, clamped)) = clamped {
                let message = format!("`{name}` cannot be {number}: it counts as {clamped}");
                let screen = if field.is_color() && number > 1.0 {
                    "; colours of 0 to 255 become light by `srgb(vec3(255, 0, 0) / 255)`"
                } else {
                    ""
                };
                let hint = format!("write a number {range}{screen}");
                self.lowering.reports.diagnostics.warn(Diagnostic::warning(span, message).hint(hint));
            }
            for (_, _, needs) in NEEDS.iter().filter(|row| row.0 == section && row.1 == name) {
                if needs.iter().any(|need| self.may_be_positive(section, need, values)) {
                    continue;
                }
                let others = needs.iter().filter(|need| **need != name);
                let all: Vec<String> = others.map(|need| format!("`{need}`")).collect();
                let message = format!("`{name}` shows nothing without {} above 0", all.join(" or "));
                let hint = format!("set {}, or remove `{name}`", all.join(" or "));
                self.lowering.reports.diagnostics.warn(Diagnostic::warning(span, message).hint(hint));
            }
        }
    }

    /// False if all numbers of a field are constants that are not above 0.
    fn may_be_positive(&mut self, section: Section, name: &str, values: &Values) -> bool {
        let field: Vec<Field> = fields(section).iter().filter(|field| field.name == name).copied().collect();
        let numbers: Vec<NodeId> = self.lowering.numbers(&field, values);
        let graph = &self.lowering.graph;
        numbers.into_iter().any(|number| graph.as_constant(number).is_none_or(|number| number > 0.0))
    }
}

/// Mixes two materials. At fraction 0 the result is the first material.
fn mixed(graph: &mut Graph, a: &Material, b: &Material, fraction: NodeId) -> Material {
    let both: Vec<_> = a.numbers().into_iter().zip(b.numbers()).collect();
    let mixed = both.into_iter().map(|(a, b)| graph.mix(a, b, fraction));
    Material::of(format!("{} and {}", a.name, b.name), mixed)
}

// Checks of the blocks `picture` and `sky` beyond the types of their fields: what may depend on the pixel, and feedback
// that never ends or never begins.

/// Light is forgotten when less than this fraction is left.
pub(crate) const FORGOTTEN: f32 = 1.0 / 255.0;
/// A scene changes visibly when a history begins if more than this fraction of light is left by then.
pub(crate) const VISIBLE: f32 = 4.0 * FORGOTTEN;

/// Returns the message about light that outlasts the frames that a scene remembers.
pub(crate) fn outlasting(light: &str, left: f32, frames: u32) -> String {
    let seconds = frames as f32 / FEEDBACK_RATE as f32;
    format!(
        "{light} longer than the scene's memory of {seconds} s: {:.0} % is left when it ends, so the brightness changes \
         every {seconds} s",
        100.0 * left
    )
}

// Warnings of numbers that a field's range excludes, and of fields that need another field.

/// Fields that cannot be seen unless one of others is above 0.
const NEEDS: &[(Section, &str, &[&str])] = &[
    (Section::Material, "film", &["reflect", "metalness"]),
    (Section::Material, "blur", &["reflect", "glass"]),
    (Section::Material, "ior", &["glass"]),
    (Section::Material, "absorb", &["glass"]),
    (Section::Material, "depth", &["translucent"]),
    (Section::Medium, "density", &["density", "emission"]),
    (Section::Medium, "color", &["density"]),
    (Section::Medium, "scatter", &["density"]),
    (Section::Medium, "phase", &["density"]),
    (Section::Swarm, "size", &["size", "glow"]),
    (Section::Swarm, "color", &["size"]),
    (Section::Swarm, "emission", &["size"]),
    (Section::Swarm, "glow", &["reach"]),
    (Section::Swarm, "reach", &["glow"]),
    (Section::Camera, "focus", &["aperture"]),
    (Section::Sky, "bounce", &["reach"]),
];
