//! Blocks with fields: objects, materials, lights, the camera, the sky and the picture.
//!
//! One table lists the fields of each block; `objects.rs` and `lights.rs` build the larger ones.

use super::super::ast::{Entry, Expr, ExprId, Name, Section};
use super::super::builtin::uses::{DIRECTION, EYE, FRAME, NORMAL, POINT, TEXTURE};
use super::super::diagnostic::Diagnostic;
use super::super::material::{MATERIAL_NUMBERS, Material};
use super::super::scene::{Camera, Picture, Sky, ToneMap, Vec3};
use super::super::source::Span;
use super::super::suggest;
use super::super::symbol::Symbol;
use super::super::value::Value;
use super::Lowering;
use super::declare::Parts;
use crate::graph::NodeId;

/// The type of a field's value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Holds {
    Number,
    Vector,
    Material,
    ToneMap,
}

/// A field: its name, the type of its value, and the inputs that it may use.
type Field = (&'static str, Holds, u8);

const SURFACE: u8 = POINT | NORMAL | TEXTURE | FRAME | EYE;

const MATERIAL: &[Field] = &{
    let mut fields = [("", Holds::Number, SURFACE); Material::FIELDS.len()];
    let mut at = 0;
    while at < fields.len() {
        let field = &Material::FIELDS[at];
        fields[at] = (field.name, if field.parts == 3 { Holds::Vector } else { Holds::Number }, SURFACE);
        at += 1;
    }
    fields
};

fn fields(section: Section) -> &'static [Field] {
    use Holds::{Material, Number, ToneMap, Vector};
    match section {
        Section::Object => &[
            ("shape", Number, POINT | FRAME),
            ("material", Material, 0),
            ("bound", Number, POINT | FRAME),
            ("melt", Number, FRAME),
        ],
        Section::Material => MATERIAL,
        Section::Light => &[
            ("position", Vector, FRAME),
            ("direction", Vector, FRAME),
            ("color", Vector, FRAME),
            ("radius", Number, FRAME),
            ("range", Number, FRAME),
            ("shadow", Number, FRAME),
            ("right", Vector, FRAME),
            ("up", Vector, FRAME),
        ],
        Section::Camera => &[
            ("position", Vector, FRAME),
            ("target", Vector, FRAME),
            ("fov", Number, FRAME),
            ("roll", Number, FRAME),
            ("aperture", Number, FRAME),
            ("focus", Number, FRAME),
            ("keep", Number, FRAME),
        ],
        Section::Sky => &[
            ("color", Vector, DIRECTION | TEXTURE | FRAME | EYE),
            ("ambient", Vector, DIRECTION | FRAME | EYE),
            ("reach", Number, FRAME),
        ],
        Section::Picture => &[
            ("exposure", Number, FRAME),
            ("bloom", Number, FRAME),
            ("vignette", Number, FRAME),
            ("grain", Number, FRAME),
            ("tone_map", ToneMap, 0),
        ],
    }
}

/// Whether any section has a field of this name.
fn is_field(name: &str) -> bool {
    use Section::{Camera, Light, Material, Object, Picture, Sky};
    let sections = [Object, Material, Light, Camera, Sky, Picture];
    sections.into_iter().flat_map(fields).any(|field| field.0 == name)
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
    /// The tone map that a picture names.
    tone_map: Option<ToneMap>,
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
                let material = self.material(title, values);
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
                } else if let Some(light) = self.light(title, span, values) {
                    parts.lights.push(light);
                }
            }
            Section::Camera => {
                if parts.camera.is_some() {
                    return self.second(section, span);
                }
                let base = self.default_camera();
                parts.camera = Some(Camera {
                    position: self.vector_of(values, "position", base.position),
                    target: self.vector_of(values, "target", base.target),
                    fov: self.number_of(values, "fov", base.fov),
                    roll: self.number_of(values, "roll", base.roll),
                    aperture: self.number_of(values, "aperture", base.aperture),
                    focus: values.given("focus").map(|_| self.number_of(values, "focus", base.fov)),
                    keep: self.number_of(values, "keep", base.keep),
                });
            }
            Section::Sky => {
                if parts.sky.is_some() {
                    return self.second(section, span);
                }
                let base = self.default_sky();
                parts.sky = Some(Sky {
                    color: self.vector_of(values, "color", base.color),
                    ambient: self.vector_of(values, "ambient", base.ambient),
                    reach: self.number_of(values, "reach", base.reach),
                });
            }
            Section::Picture => {
                if parts.picture.is_some() {
                    return self.second(section, span);
                }
                let base = self.default_picture();
                parts.picture = Some(Picture {
                    exposure: self.number_of(values, "exposure", base.exposure),
                    bloom: self.number_of(values, "bloom", base.bloom),
                    vignette: self.number_of(values, "vignette", base.vignette),
                    grain: self.number_of(values, "grain", base.grain),
                    tone_map: values.tone_map.unwrap_or(base.tone_map),
                });
            }
        }
    }

    fn second(&mut self, section: Section, span: Span) {
        let message = format!("the scene has a second {}", word(section));
        self.report(Diagnostic::new(span, message).hint("leave one of them out"));
    }

    /// Lowers a section's lets and fields in their order.
    pub(super) fn fields(&mut self, section: Section, entries: &[Entry], broken: bool) -> Values {
        let known = fields(section);
        let mut values = Values { broken, ..Values::default() };
        let mark = self.scope.len();
        let outside = std::mem::replace(&mut self.frame, mark);
        let all = known.iter().fold(0, |all, field| all | field.2);
        for entry in entries {
            if entry.is_let {
                let value = self.within(all, place(section), |this| this.expr(entry.value));
                self.bind(entry.name.symbol, value);
                continue;
            }
            let text = self.name(entry.name.symbol);
            let Some(index) = known.iter().position(|field| field.0 == text) else {
                values.broken = true;
                self.unknown_field(section, entry.name);
                continue;
            };
            let (name, holds, allowed) = known[index];
            if let Some((_, first)) = values.given(name) {
                let message = format!("`{text}` is given twice");
                let twice = Diagnostic::new(entry.name.span, message).note(first, "the first one is here");
                self.report(twice.hint("leave one of them out"));
                continue;
            }
            let value = match holds {
                Holds::Material => {
                    values.material = self.material_index(entry.value);
                    values.broken |= values.material.is_none();
                    values.given.push((name, Value::Unknown, entry.name.span));
                    continue;
                }
                Holds::ToneMap => {
                    values.tone_map = self.tone_map(entry.value);
                    values.broken |= values.tone_map.is_none();
                    values.given.push((name, Value::Unknown, entry.name.span));
                    continue;
                }
                _ => {
                    let value = self.within(allowed, place(section), |this| this.expr(entry.value));
                    self.field_value(value, holds, text, self.ast.span(entry.value))
                }
            };
            values.broken |= value == Value::Unknown;
            values.given.push((name, value, entry.name.span));
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
        let known = fields(section).iter().map(|field| field.0);
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

    /// The tone map that an expression names.
    fn tone_map(&mut self, value: ExprId) -> Option<ToneMap> {
        let span = self.ast.span(value);
        let names = ToneMap::ALL.map(ToneMap::name);
        let all = names.map(|name| format!("`{name}`")).join(", ");
        let Expr::Name(symbol) = self.ast.expr(value) else {
            if self.ast.expr(value) != Expr::Error {
                let wrong = Diagnostic::new(span, "a tone map must be given by its name");
                self.report(wrong.hint(format!("the tone maps are {all}")));
            }
            return None;
        };
        let name = self.name(symbol);
        let known = ToneMap::ALL.into_iter().find(|map| map.name() == name);
        if known.is_none() {
            let near = suggest::nearest(name, names);
            let unknown = Diagnostic::new(span, format!("there is no tone map `{name}`"));
            let unknown = match near {
                Some(_) => unknown.did_you_mean(near),
                None => unknown.hint(format!("the tone maps are {all}")),
            };
            self.report(unknown);
        }
        known
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

    pub(super) fn material(&mut self, name: String, values: &Values) -> Material {
        let mut numbers = Vec::with_capacity(MATERIAL_NUMBERS);
        for field in Material::FIELDS {
            if field.parts == 3 {
                let default = self.vector([field.default; 3]);
                numbers.extend(self.vector_of(values, field.name, default));
            } else {
                let default = self.constant(field.default);
                numbers.push(self.number_of(values, field.name, default));
            }
        }
        Material::of(name, numbers)
    }

    pub(super) fn vector_of(&mut self, values: &Values, name: &str, default: Vec3) -> Vec3 {
        match values.given(name) {
            Some((Value::Vector(vector), _)) => [vector.part(0), vector.part(1), vector.part(2)],
            _ => default,
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
