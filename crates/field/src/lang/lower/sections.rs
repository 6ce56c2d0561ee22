//! Sections, the blocks with fields: objects, materials, lights, cameras, `sky`, `picture` and `about`.
//!
//! The fields of each section are listed in rows (see `lang::fields`). This module evaluates and checks the fields.
//! `objects.rs` then combines the fields of an object or a light.

use super::super::about::{About, TransitionStyle};
use super::super::ast::{Entry, Expr, ExprId, Name, Section};
use super::super::diagnostic::Diagnostic;
use super::super::fields::{DefaultValue, Field, Holds};
use super::super::material::Material;
use super::super::origins::Stretch;
use super::super::scene::{Camera, Light, Medium, Picture, Sky, Swarm, ToneMap};
use super::super::source::Span;
use super::super::suggest;
use super::super::symbol::Symbol;
use super::super::value::Value;
use super::lowering::{A_DISTANCE, A_NUMBER, Lowering};
use super::reports::Reports;
use super::scene::SceneBuilder;
use crate::graph::NodeId;

/// The fields of objects. Their defaults are unused: `objects.rs` handles missing fields.
const OBJECT: &[Field] = &[
    Field::of("shape", Holds::Shape, "the distance from `p` to the object"),
    Field::of("material", Holds::Material, "the name of its material"),
    Field::of("bound", Holds::Shape, "a lower bound of the distance to everything that `shape` leaves out"),
    Field::of(
        "melt",
        Holds::Number,
        "the radius within which the object flows into the previous object; both materials mix there",
    ),
    Field::of(
        "trust",
        Holds::Number,
        "the fraction of `shape` by which rays step, 0..1, for estimates of a distance that are steeper than a distance",
    ),
];

pub(in crate::lang) fn fields(section: Section) -> &'static [Field] {
    SECTIONS[section as usize].2
}

/// Each section: what a scene's text describes by it, and its fields.
const SECTIONS: [(Section, &str, &[Field]); 9] = [
    (Section::Object, "a shape", OBJECT),
    (Section::Material, "a material", Material::FIELDS),
    (Section::Light, "a light", Light::FIELDS),
    (Section::Medium, "a medium", Medium::FIELDS),
    (Section::Swarm, "a swarm", Swarm::FIELDS),
    (Section::Camera, "the camera", Camera::FIELDS),
    (Section::Sky, "the sky", Sky::FIELDS),
    (Section::Picture, "the picture", Picture::FIELDS),
    (Section::About, "the block `about`", About::FIELDS),
];

fn is_field(name: &str) -> bool {
    SECTIONS.iter().flat_map(|row| row.2).any(|field| field.name == name)
}

/// Returns the keyword and the fields of each section.
pub fn section_fields() -> impl Iterator<Item = (&'static str, &'static [Field])> {
    SECTIONS.iter().map(|(section, _, fields)| (section.word(), *fields))
}

/// Returns the plural of a word for a part of a scene.
pub fn plural(word: &str) -> String {
    if word == "medium" { "media".to_owned() } else { format!("{word}s") }
}

fn place(section: Section) -> &'static str {
    SECTIONS[section as usize].1
}

#[derive(Default)]
pub(super) struct Values {
    given: Vec<(&'static str, Value, Span)>,
    pub(super) material: Option<usize>,
    /// The notes of all values except an object's shape (see `lang::origins`).
    pub(super) beside_the_shape: Vec<Stretch>,
    pub(super) broken: bool,
}

impl Values {
    /// Returns the value of a field and the location of its name; `None` if the section does not set it.
    pub(super) fn given(&self, name: &str) -> Option<(Value, Span)> {
        debug_assert!(is_field(name), "no section has a field `{name}`");
        let given = self.given.iter().find(|(given, ..)| *given == name)?;
        Some((given.1, given.2))
    }
}

impl SceneBuilder<'_> {
    pub(super) fn section(&mut self, section: Section, name: Option<Name>, span: Span, values: &Values) {
        let title = name.map_or(String::new(), |name| self.lowering.name(name.symbol).to_owned());
        let limits = self.lowering.limits;
        match section {
            Section::Object => self.object(title, span, values),
            Section::Material => {
                if self.refuses_material("materials", span) {
                    return;
                }
                let material = Material::of(title, self.lowering.numbers(Material::FIELDS, values));
                self.parts.materials.push(material);
                if let Some(global) =
                    name.and_then(|name| self.lowering.declared.globals.get_mut(name.symbol.index()))
                    && global.material == 0
                {
                    global.material = self.parts.materials.len() as u32;
                }
            }
            Section::Light => {
                let (count, max) = (self.parts.lights.len(), limits.scene_lights_max);
                let hint = "use materials with `emission` instead";
                if !self.lowering.reports.is_full(count, max, "lights", hint, span)
                    && let Some(kind) = self.light_kind(&title, span, values)
                {
                    let light = Light::of(kind, self.lowering.numbers(Light::FIELDS, values));
                    self.parts.lights.push(light);
                }
            }
            Section::Medium => {
                let (count, max) = (self.parts.media.len(), limits.scene_media_max);
                let hint = "add the densities of several media in one, and mix their colours by `p`";
                if !self.lowering.reports.is_full(count, max, "media", hint, span) {
                    let medium = self.lowering.numbers(Medium::FIELDS, values);
                    self.parts.media.push(Medium::of(medium));
                }
            }
            Section::Swarm => self.swarm(span, values),
            Section::Camera => {
                let camera = Camera::of(self.lowering.numbers(Camera::FIELDS, values));
                let (count, max) = (self.parts.cameras.len(), limits.scene_cameras_max);
                let hint = "move one camera instead";
                if name.is_none() {
                    only(&mut self.lowering.reports, &mut self.parts.camera, camera, section, span);
                } else if !self.lowering.reports.is_full(count, max, "named cameras", hint, span) {
                    self.parts.cameras.push((title, camera));
                }
            }
            Section::Sky => {
                let sky = Sky::of(self.lowering.numbers(Sky::FIELDS, values));
                self.parts.has_own_sky |= values.given("color").is_some();
                self.refuse_pixels(
                    &[("ambient", &sky.ambient[..]), ("reach", &[sky.reach]), ("bounce", &[sky.bounce])],
                    "the sky's colour",
                    values,
                );
                only(&mut self.lowering.reports, &mut self.parts.sky, sky, section, span);
            }
            Section::Picture => {
                let picture = Picture::of(self.lowering.numbers(Picture::FIELDS, values));
                self.check_picture(&picture, values);
                only(&mut self.lowering.reports, &mut self.parts.picture, picture, section, span);
            }
            Section::About => {
                let about = self.about(values);
                only(&mut self.lowering.reports, &mut self.parts.about, about, section, span);
            }
        }
    }

    /// Reports a material beyond the limit. `what` names the materials.
    pub(super) fn refuses_material(&mut self, what: &str, span: Span) -> bool {
        let (count, max) = (self.parts.materials.len(), self.lowering.limits.scene_materials_max);
        let hint = "use one material whose fields depend on `p`";
        self.lowering.reports.is_full(count, max, what, hint, span)
    }

    fn swarm(&mut self, span: Span, values: &Values) {
        let limits = self.lowering.limits;
        let (count, points_max) = (self.parts.swarms.len(), limits.scene_swarm_points_max);
        let hint = "let `index` decide what each point of one swarm does";
        if self.lowering.reports.is_full(count, limits.scene_swarms_max, "swarms", hint, span) {
            return;
        }
        let numbers = self.lowering.numbers(Swarm::FIELDS, values);
        let swarm = Swarm::of(0, numbers);
        if values.broken {
            return;
        }
        let place = values.given("count").map_or(span, |(_, place)| place);
        let Some(count) = self.lowering.known(swarm.count) else {
            // An input in the field itself was already reported.
            if self.lowering.reports.diagnostics.is_empty() {
                let wrong = Diagnostic::new(place, "`count` must be a number that never changes");
                self.report(wrong.hint("write a number, as in `count = 10000`"));
            }
            return;
        };
        if !(count >= 1.0 && count.fract() == 0.0) {
            let message =
                format!("`count` must be a whole number of points, at least 1, but this is {count}");
            self.report(Diagnostic::new(place, message).hint("write a number, as in `count = 10000`"));
            return;
        }
        // A count is saturated, and the sum of a few cannot overflow.
        let points = (count as usize).min(u32::MAX as usize);
        let all = self.parts.swarms.iter().fold(points, |all, other| all.saturating_add(other.points));
        if all > points_max {
            let message =
                format!("the swarms of a scene can have {points_max} points together, but these are {all}");
            let hint = "lower `count`; fewer, larger points with more `glow` look as dense";
            self.report(Diagnostic::over_limit(place, message).hint(hint));
            return;
        }
        self.parts.swarms.push(Swarm { points, ..swarm });
    }

    pub(super) fn fields(&mut self, section: Section, entries: &[Entry], broken: bool) -> Values {
        let known = fields(section);
        let mut values = Values { broken, ..Values::default() };
        let mark = self.lowering.scope.bindings.len();
        let outside = std::mem::replace(&mut self.lowering.scope.frame, mark);
        let all = known.iter().fold(0, |all, field| all | field.uses);
        for entry in entries {
            let from = self.lowering.origins.mark();
            if entry.is_let {
                self.lowering.origins.begins(entry.name.span);
                let value = self.lowering.within(all, place(section), |this| this.expr(entry.value));
                let by = self.lowering.origins.since(from);
                self.lowering.scope.bind_made(entry.name.symbol, value, by);
                continue;
            }
            let text = self.lowering.name(entry.name.symbol);
            let Some(field) = known.iter().find(|field| field.name == text) else {
                values.broken = true;
                self.unknown_field(section, entry.name);
                continue;
            };
            if let Some((_, first)) = values.given(text) {
                let message = format!("`{text}` is set twice");
                let twice = Diagnostic::new(entry.name.span, message).note(first, "the first one is here");
                self.report(twice.hint("leave one of them out"));
                continue;
            }
            if let Some(end) = entry.end
                && field.holds != Holds::Range
            {
                values.broken = true;
                let message = format!("`{text}` is one value, not a range");
                self.report(
                    Diagnostic::new(self.lowering.ast.span(end), message)
                        .hint("leave out `..` and the second value"),
                );
                continue;
            }
            let value = match field.holds {
                Holds::Material => {
                    values.material = self.material_index(entry.value);
                    values.broken |= values.material.is_none();
                    values.given.push((field.name, Value::Unknown, entry.name.span));
                    continue;
                }
                Holds::ToneMap => {
                    self.one_of("tone map", &ToneMap::ALL.map(|map| (map.name(), map.number())), entry.value)
                }
                Holds::TransitionStyle => {
                    let styles = TransitionStyle::ALL.map(|style| (style.name(), style.number()));
                    self.one_of("transition", &styles, entry.value)
                }
                Holds::Text => self.text(field.name, entry.value),
                Holds::Range => self.range(field.name, entry.value, entry.end),
                Holds::Number | Holds::Vector | Holds::Place | Holds::Shape => {
                    self.lowering.inputs.field = Some((field.name, known));
                    let value =
                        self.lowering.within(field.uses, place(section), |this| this.expr(entry.value));
                    self.lowering.inputs.field = None;
                    self.field_value(value, field.holds, text, self.lowering.ast.span(entry.value))
                }
            };
            if field.name != "shape" {
                values.beside_the_shape.push(self.lowering.origins.since(from));
            }
            values.broken |= value == Value::Unknown;
            values.given.push((field.name, value, entry.name.span));
        }
        self.lowering.scope.unbind(mark);
        self.lowering.scope.frame = outside;
        values
    }

    fn field_value(&mut self, value: Value, holds: Holds, name: &str, span: Span) -> Value {
        let (wanted, hint) = match (holds, value) {
            (Holds::Place, Value::Vector(vector)) if vector.len() == 2 => return value,
            (Holds::Vector, Value::Vector(vector)) if matches!(vector.len(), 1 | 3) => return value,
            (Holds::Place | Holds::Vector, Value::Unknown) => return value,
            (Holds::Place, _) => {
                ("a vec2", "write a place in the picture, as in `pixel / resolution + vec2(0, 0.01)`")
            }
            (Holds::Vector, Value::Vector(vector)) if vector.len() == 4 => {
                ("a vec3", "take three components: `.rgb` or `.xyz`")
            }
            (Holds::Vector, _) => ("a vec3", "write `vec3(a, b, c)`, or one number for all three"),
            _ => {
                let hint = if holds == Holds::Shape { A_DISTANCE } else { A_NUMBER };
                let part = self.lowering.one_number(value, &format!("`{name}`"), hint, span);
                return part.map_or(Value::Unknown, Value::scalar);
            }
        };
        let message = format!("`{name}` must be {wanted}, but this is {}", value.described());
        self.report(Diagnostic::new(span, message).hint(hint))
    }

    fn unknown_field(&mut self, section: Section, name: Name) {
        let text = self.lowering.name(name.symbol);
        let known = fields(section).iter().map(|field| field.name);
        let near = suggest::nearest(text, known.clone());
        let owner = place_of_field(section);
        let all = known.map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
        let others = section_fields().filter(|(_, fields)| fields.iter().any(|field| field.name == text));
        let others: Vec<String> = others.map(|(other, _)| format!("`{other}`")).collect();
        let hint = match others.is_empty() {
            true => format!("its fields are {all}; introduce other names with `let`"),
            false => format!("this is a field of {}; {owner} has {all}", others.join(" and ")),
        };
        let wrong = Diagnostic::new(name.span, format!("{owner} has no field `{text}`"));
        self.report(wrong.hint(hint).did_you_mean(near));
    }

    /// Evaluates an expression that must be one of the names in `known`, and returns the number of that name.
    fn one_of(&mut self, what: &str, known: &[(&'static str, f32)], value: ExprId) -> Value {
        let span = self.lowering.ast.span(value);
        let names = || known.iter().map(|(name, _)| *name);
        let all = names().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
        let all = format!("choose one of {all}");
        let wrong = match self.lowering.ast.expr(value) {
            Expr::Error => return Value::Unknown,
            Expr::Name(symbol) => {
                let name = self.lowering.name(symbol);
                if let Some((_, number)) = known.iter().find(|(known, _)| *known == name) {
                    return Value::scalar(self.lowering.constant(*number));
                }
                let unknown = Diagnostic::new(span, format!("there is no {what} `{name}`"));
                unknown.hint(all).did_you_mean(suggest::nearest(name, names()))
            }
            _ => Diagnostic::new(span, format!("a {what} must be given by its name")).hint(all),
        };
        self.report(wrong)
    }

    fn text(&mut self, field: &str, value: ExprId) -> Value {
        match self.lowering.ast.expr(value) {
            Expr::Error => Value::Unknown,
            Expr::Text(symbol) => Value::Text(symbol),
            _ => {
                let wrong =
                    Diagnostic::new(self.lowering.ast.span(value), format!("`{field}` must be a text"));
                self.report(wrong.hint("put it in quotes"))
            }
        }
    }

    /// Evaluates a range of two numbers in 0..1, the smaller one first.
    fn range(&mut self, field: &'static str, first: ExprId, last: Option<ExprId>) -> Value {
        let span = self.lowering.ast.span(first);
        let Some(last) = last else {
            if self.lowering.ast.expr(first) == Expr::Error {
                return Value::Unknown;
            }
            let wrong = Diagnostic::new(span, format!("`{field}` must be a range"));
            return self.report(wrong.hint(format!("write `{field} = 0.2 .. 0.6`")));
        };
        let (Some(low), Some(high)) = (self.fixed(first, field), self.fixed(last, field)) else {
            return Value::Unknown;
        };
        if !(0.0 <= low && low <= high && high <= 1.0) {
            let wrong = Diagnostic::new(
                span.to(self.lowering.ast.span(last)),
                format!("`{field}` must be a range within 0 .. 1, but this is {low} .. {high}"),
            );
            return self.report(wrong.hint("write two numbers from 0 to 1, the smaller number first"));
        }
        Value::of(&[low, high].map(|number| self.lowering.constant(number)))
    }

    fn about(&self, values: &Values) -> About {
        let text = |name: &str| match values.given(name) {
            Some((Value::Text(symbol), _)) => Some(self.lowering.name(symbol).to_owned()),
            _ => None,
        };
        let number = |name: &str, part: usize| match values.given(name) {
            Some((Value::Vector(vector), _)) => self.lowering.known(vector.part(part)),
            _ => None,
        };
        let portal = match values.given("portal") {
            Some((Value::Vector(vector), _)) => Some(vector.part(0)),
            _ => None,
        };
        let style = |name: &str| number(name, 0).and_then(TransitionStyle::numbered);
        let words = |name: &str| -> Vec<String> {
            let words = text(name).unwrap_or_default();
            words.split(',').map(str::trim).filter(|word| !word.is_empty()).map(str::to_lowercase).collect()
        };
        About {
            title: text("title"),
            author: text("author"),
            license: text("license"),
            energy: (number("energy", 0).unwrap_or(0.0), number("energy", 1).unwrap_or(1.0)),
            moods: words("moods"),
            follows: words("follows"),
            enter: style("enter"),
            leave: style("leave"),
            portal,
        }
    }

    fn material_index(&mut self, value: ExprId) -> Option<usize> {
        let span = self.lowering.ast.span(value);
        let Expr::Name(symbol) = self.lowering.ast.expr(value) else {
            if self.lowering.ast.expr(value) != Expr::Error {
                let wrong = Diagnostic::new(span, "`material` must be the name of a material");
                self.report(wrong.hint("declare `material wood { … }` and write `material = wood`"));
            }
            return None;
        };
        let global = self.lowering.declared.global(symbol);
        if global.material > 0 {
            return Some(global.material as usize - 1);
        }
        if global.broken {
            return None;
        }
        let globals =
            self.lowering.declared.globals.iter().enumerate().filter(|(_, global)| global.material > 0);
        let names = globals.map(|(index, _)| self.lowering.names.name(Symbol(index as u32)));
        let near = suggest::nearest(self.lowering.name(symbol), names);
        let unknown = Diagnostic::new(span, format!("there is no material `{}`", self.lowering.name(symbol)));
        let hint = format!("declare it: `material {} {{ color = vec3(0.5) }}`", self.lowering.name(symbol));
        self.lowering.reports.refuse(unknown.hint(hint).did_you_mean(near))
    }
}

impl Lowering<'_> {
    /// Returns the numbers of a section in the order of its fields. Missing fields have their defaults.
    pub(super) fn numbers(&mut self, fields: &[Field], values: &Values) -> Vec<NodeId> {
        let mut numbers = Vec::new();
        for field in fields {
            let default = self.default_of(field.default);
            let parts = match values.given(field.name) {
                Some((Value::Vector(vector), _)) => [0, 1, 2].map(|part| vector.part(part)),
                _ => default,
            };
            numbers.extend(parts.into_iter().take(field.holds.parts()));
        }
        numbers
    }

    fn default_of(&mut self, default: DefaultValue) -> [NodeId; 3] {
        match default {
            DefaultValue::Each(number) => self.vector([number; 3]),
            DefaultValue::Parts(parts) => self.vector(parts),
            DefaultValue::Library(name) => match self.library_color(name) {
                Some(color) => color,
                None => self.vector([0.0; 3]),
            },
        }
    }

    pub(super) fn number_of(&mut self, values: &Values, name: &str, default: NodeId) -> NodeId {
        match values.given(name) {
            Some((Value::Vector(vector), _)) => vector.first(),
            _ => default,
        }
    }
}

fn place_of_field(section: Section) -> &'static str {
    match section {
        Section::Object => "an object",
        other => place(other),
    }
}

/// Stores a section that a scene may have only once. Reports a second such section.
fn only<T>(reports: &mut Reports, place: &mut Option<T>, made: T, section: Section, span: Span) {
    if place.replace(made).is_some() {
        let message = format!("the scene has a second block `{}`", section.word());
        reports.add(Diagnostic::new(span, message).hint("leave one of them out"));
    }
}

#[cfg(test)]
mod tests {
    use super::SECTIONS;

    #[test]
    fn the_rows_have_the_order_of_the_sections() {
        for (place, (section, ..)) in SECTIONS.iter().enumerate() {
            assert_eq!(*section as usize, place);
        }
    }
}
