//! Blocks with fields: objects, materials, lights, the camera, the sky and the picture.
//!
//! A section's rows (see `lang::fields`) say which fields it has. What the fields of an object mean together stands in
//! `objects.rs`, and those of a light in `lights.rs`.

use super::super::ast::{Entry, Expr, ExprId, Name, Section};
use super::super::builtin::uses::{FRAME, NOTHING, POINT};
use super::super::diagnostic::Diagnostic;
use super::super::fields::{DefaultValue, Field, Holds};
use super::super::material::Material;
use super::super::scene::{Camera, Light, Picture, Sky, ToneMap};
use super::super::source::Span;
use super::super::suggest;
use super::super::symbol::Symbol;
use super::super::value::Value;
use super::Lowering;
use super::declare::Parts;
use crate::graph::NodeId;

/// The fields of objects. `objects.rs` makes an object of them, so their defaults are not read.
const OBJECT: &[Field] = &[
    of_object("shape", Holds::Number, POINT | FRAME),
    of_object("material", Holds::Material, NOTHING),
    of_object("bound", Holds::Number, POINT | FRAME),
    of_object("melt", Holds::Number, FRAME),
];

const fn of_object(name: &'static str, holds: Holds, uses: u8) -> Field {
    Field { name, holds, uses, default: DefaultValue::Each(0.0), range: None, doc: "" }
}

fn fields(section: Section) -> &'static [Field] {
    match section {
        Section::Object => OBJECT,
        Section::Material => Material::FIELDS,
        Section::Light => Light::FIELDS,
        Section::Camera => Camera::FIELDS,
        Section::Sky => Sky::FIELDS,
        Section::Picture => Picture::FIELDS,
    }
}

/// Whether any section has a field of this name.
fn is_field(name: &str) -> bool {
    use Section::{Camera, Light, Material, Object, Picture, Sky};
    let sections = [Object, Material, Light, Camera, Sky, Picture];
    sections.into_iter().flat_map(fields).any(|field| field.name == name)
}

/// The word that begins a section.
pub(super) fn word(section: Section) -> &'static str {
    match section {
        Section::Object => "object",
        Section::Material => "material",
        Section::Light => "light",
        Section::Camera => "camera",
        Section::Sky => "sky",
        Section::Picture => "picture",
    }
}

/// The name of a section in messages about inputs that have no value in it.
fn place(section: Section) -> &'static str {
    match section {
        Section::Object => "a shape",
        Section::Material => "a material",
        Section::Light => "a light",
        Section::Camera => "the camera",
        Section::Sky => "the sky",
        Section::Picture => "the picture",
    }
}

/// The values of a section's fields in the order of [`fields`].
#[derive(Default)]
pub(super) struct Values {
    given: Vec<(&'static str, Value, Span)>,
    /// Index of the material that an object names.
    pub(super) material: Option<usize>,
    /// Whether a field was wrong, so that the values are of no use.
    pub(super) broken: bool,
}

impl Values {
    /// The value of the field with that name, and the place where it is given.
    pub(super) fn given(&self, name: &str) -> Option<(Value, Span)> {
        debug_assert!(is_field(name), "no section has a field `{name}`");
        let given = self.given.iter().find(|(given, ..)| *given == name)?;
        Some((given.1, given.2))
    }
}

impl Lowering<'_> {
    pub(super) fn section(
        &mut self,
        parts: &mut Parts,
        section: Section,
        name: Option<Name>,
        span: Span,
        values: &Values,
    ) {
        let title = name.map_or(String::new(), |name| self.name(name.symbol).to_owned());
        match section {
            Section::Object => self.object(parts, title, span, values),
            Section::Material => {
                let max = self.limits.scene_materials_max;
                if parts.materials.len() >= max {
                    let message = format!("the scene has more than {max} materials");
                    self.stop(span, message, "let one material depend on the point");
                    return;
                }
                let material = Material::of(title, self.numbers(Material::FIELDS, values));
                parts.materials.push(material);
                if let Some(global) = name.and_then(|name| self.globals.get_mut(name.symbol.index()))
                    && global.material == 0
                {
                    global.material = parts.materials.len() as u32;
                }
            }
            Section::Light => {
                let max = self.limits.scene_lights_max;
                if parts.lights.len() >= max {
                    let message = format!("the scene has more than {max} lights");
                    self.stop(span, message, "let surfaces shine with `emission` instead");
                } else if let Some(kind) = self.light_kind(&title, span, values) {
                    parts.lights.push(Light::of(kind, self.numbers(Light::FIELDS, values)));
                }
            }
            Section::Camera => {
                let camera = Camera::of(self.numbers(Camera::FIELDS, values));
                self.only(&mut parts.camera, camera, section, span);
            }
            Section::Sky => {
                let sky = Sky::of(self.numbers(Sky::FIELDS, values));
                parts.has_own_sky |= values.given("color").is_some();
                self.only(&mut parts.sky, sky, section, span);
            }
            Section::Picture => {
                let picture = Picture::of(self.numbers(Picture::FIELDS, values));
                self.only(&mut parts.picture, picture, section, span);
            }
        }
    }

    /// Keeps a section of which a scene has one, and reports a second one.
    fn only<T>(&mut self, place: &mut Option<T>, made: T, section: Section, span: Span) {
        if place.replace(made).is_some() {
            let message = format!("the scene has a second {}", word(section));
            self.report(Diagnostic::new(span, message).hint("leave one of them out"));
        }
    }

    /// Lowers a section's lets and fields in their order.
    pub(super) fn fields(&mut self, section: Section, entries: &[Entry], broken: bool) -> Values {
        let known = fields(section);
        let mut values = Values { broken, ..Values::default() };
        let mark = self.scope.len();
        let outside = std::mem::replace(&mut self.frame, mark);
        let all = known.iter().fold(0, |all, field| all | field.uses);
        for entry in entries {
            if entry.is_let {
                let value = self.within(all, place(section), |this| this.expr(entry.value));
                self.bind(entry.name.symbol, value);
                continue;
            }
            let text = self.name(entry.name.symbol);
            let Some(field) = known.iter().find(|field| field.name == text) else {
                values.broken = true;
                self.unknown_field(section, entry.name);
                continue;
            };
            if let Some((_, first)) = values.given(text) {
                let message = format!("`{text}` is given twice");
                let twice = Diagnostic::new(entry.name.span, message).note(first, "the first one is here");
                self.report(twice.hint("leave one of them out"));
                continue;
            }
            let value = match field.holds {
                Holds::Material => {
                    values.material = self.material_index(entry.value);
                    values.broken |= values.material.is_none();
                    values.given.push((field.name, Value::Unknown, entry.name.span));
                    continue;
                }
                Holds::ToneMap => self.tone_map(entry.value),
                Holds::Number | Holds::Vector => {
                    let value = self.within(field.uses, place(section), |this| this.expr(entry.value));
                    self.field_value(value, field.holds, text, self.ast.span(entry.value))
                }
            };
            values.broken |= value == Value::Unknown;
            values.given.push((field.name, value, entry.name.span));
        }
        self.unbind(mark);
        self.frame = outside;
        values
    }

    fn field_value(&mut self, value: Value, holds: Holds, name: &str, span: Span) -> Value {
        if holds == Holds::Number {
            return match self.one_number(value, &format!("`{name}`"), span) {
                Some(part) => Value::scalar(part),
                None => Value::Unknown,
            };
        }
        match value {
            Value::Unknown => Value::Unknown,
            Value::Vector(vector) if matches!(vector.len(), 1 | 3) => Value::Vector(vector),
            other => {
                let message = format!("`{name}` must be a vec3, but this is {}", other.described());
                let wrong = Diagnostic::new(span, message);
                let wrong = match other.type_of() {
                    Some(super::super::ast::Type::Vec4) => {
                        wrong.hint("take three components: `.rgb` or `.xyz`")
                    }
                    _ => wrong.hint("write `vec3(a, b, c)`, or one number for all three"),
                };
                self.report(wrong)
            }
        }
    }

    fn unknown_field(&mut self, section: Section, name: Name) {
        let text = self.name(name.symbol);
        let known = fields(section).iter().map(|field| field.name);
        let near = suggest::nearest(text, known.clone());
        let message = format!("{} has no field `{text}`", place_of_field(section));
        let wrong = Diagnostic::new(name.span, message);
        let wrong = match near {
            Some(_) => wrong.did_you_mean(near),
            None => {
                let all: Vec<String> = known.map(|name| format!("`{name}`")).collect();
                wrong.hint(format!("its fields are {}; introduce other names with `let`", all.join(", ")))
            }
        };
        self.report(wrong);
    }

    /// The number of the tone map that an expression names.
    fn tone_map(&mut self, value: ExprId) -> Value {
        let span = self.ast.span(value);
        let names = ToneMap::ALL.map(ToneMap::name);
        let all = names.map(|name| format!("`{name}`")).join(", ");
        let wrong = match self.ast.expr(value) {
            Expr::Error => return Value::Unknown,
            Expr::Name(symbol) => {
                let name = self.name(symbol);
                if let Some(known) = ToneMap::ALL.into_iter().find(|map| map.name() == name) {
                    return Value::scalar(self.constant(known.number()));
                }
                let unknown = Diagnostic::new(span, format!("there is no tone map `{name}`"));
                match suggest::nearest(name, names) {
                    near @ Some(_) => unknown.did_you_mean(near),
                    None => unknown.hint(format!("the tone maps are {all}")),
                }
            }
            _ => Diagnostic::new(span, "a tone map must be given by its name")
                .hint(format!("the tone maps are {all}")),
        };
        self.report(wrong)
    }

    /// The material that an expression names, as its index.
    fn material_index(&mut self, value: ExprId) -> Option<usize> {
        let span = self.ast.span(value);
        let Expr::Name(symbol) = self.ast.expr(value) else {
            if self.ast.expr(value) != Expr::Error {
                let wrong = Diagnostic::new(span, "an object's material must be given by its name");
                self.report(wrong.hint("declare `material wood { … }` and write `material = wood`"));
            }
            return None;
        };
        let global = self.globals.get(symbol.index()).copied().unwrap_or_default();
        if global.material > 0 {
            return Some(global.material as usize - 1);
        }
        if global.broken {
            return None;
        }
        let globals = self.globals.iter().enumerate().filter(|(_, global)| global.material > 0);
        let names = globals.map(|(index, _)| self.names.name(Symbol(index as u32)));
        let near = suggest::nearest(self.name(symbol), names);
        let unknown = Diagnostic::new(span, format!("there is no material `{}`", self.name(symbol)));
        let unknown = match near {
            Some(_) => unknown.did_you_mean(near),
            None => {
                unknown.hint(format!("declare it: `material {} {{ color = vec3(0.5) }}`", self.name(symbol)))
            }
        };
        self.report(unknown);
        None
    }

    /// The numbers of a section, in the order of its fields.
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
