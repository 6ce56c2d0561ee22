//! The scene as a whole: its items, the order in which they are lowered, and its defaults.

use std::sync::Arc;

use super::super::about::About;
use super::super::ast::{Entry, ExprId, Item, Name, Section};
use super::super::builtin::{INPUTS, InputRow, InputValue, uses};
use super::super::diagnostic::Diagnostic;
use super::super::library;
use super::super::material::Material;
use super::super::origins::Stretch;
use super::super::scene::{Camera, Light, LightKind, Object, Param, Picture, Scene, Sky};
use super::super::source::{Sources, Span};
use super::super::symbol::Symbol;
use super::super::value::Value;
use super::sections::Values;
use super::{GlobalFunction, GlobalLet, GlobalValue, Lowering};
use crate::graph::NodeId;

/// A scene under construction.
#[derive(Default)]
pub(super) struct Parts {
    pub objects: Vec<Object>,
    pub materials: Vec<Material>,
    pub lights: Vec<Light>,
    pub camera: Option<Camera>,
    /// Further ones, with their names.
    pub cameras: Vec<(String, Camera)>,
    pub sky: Option<Sky>,
    pub has_own_sky: bool,
    pub picture: Option<Picture>,
    pub about: Option<About>,
    /// Index of the material of objects that name none.
    pub default_material: Option<usize>,
}

/// The name given to a bare expression.
const BARE_NAME: &str = "shape";

impl<'a> Lowering<'a> {
    pub(super) fn scene(
        mut self,
        items: &'a [Item],
        includes: Vec<String>,
        sources: &Sources,
    ) -> Option<Scene> {
        self.declare(items);
        // In textual order, so that a long chain of them needs no deep recursion.
        self.within(u8::MAX, "", |this| {
            for index in 0..this.lets.len() {
                let span = this.lets[index].span;
                if this.lets[index].known.is_none() && !this.stopped {
                    this.global_let(index, span);
                }
            }
        });
        let mut parts = Parts::default();
        // Materials come first because objects name them.
        for of_materials in [true, false] {
            let wanted = |section: &Section| (*section == Section::Material) == of_materials;
            for item in items {
                if self.stopped {
                    return None;
                }
                match item {
                    Item::Section { section, name, span, entries, broken } if wanted(section) => {
                        let from = self.origins.mark();
                        let values = self.fields(*section, entries, *broken);
                        self.section(&mut parts, *section, *name, *span, &values);
                        self.note_block(&parts, (*section, *span), entries, from, &values);
                    }
                    Item::Bare(value) if wanted(&Section::Object) => self.bare(&mut parts, *value),
                    _ => {}
                }
            }
        }
        self.check_the_unused();
        if let Err(error) = self.graph.check()
            && !self.stopped
        {
            let span = parts.objects.first().map_or(Span::default(), |object| object.span);
            self.stop(span, error.to_string(), "call fewer functions in functions, or shorten the loops");
        }
        let shapes: Vec<NodeId> = parts.objects.iter().map(|object| object.shape).collect();
        let Some(distance) = shapes.into_iter().reduce(|a, b| self.graph.min(a, b)) else {
            if self.diagnostics.is_empty() {
                let text = sources.files().first().map_or(0, |file| file.text.len() as u32);
                let empty = Diagnostic::new(Span::new(text, text), "the scene has no shape");
                let hint = "write an expression in x, y, z, as in `length(p) - 1`, or `object ball { shape = sphere(p, 1) }`";
                self.report(empty.hint(hint));
            }
            return None;
        };
        if parts.lights.is_empty() {
            parts.lights.push(Light {
                position: self.vector([-6.0, 9.0, -6.0]),
                color: self.vector([500.0, 480.0, 450.0]),
                radius: self.constant(0.5),
                ..Light::of(LightKind::Lamp, self.numbers(Light::FIELDS, &Values::default()))
            });
        }
        for number in self.changing.numbers() {
            self.params.push(Param {
                name: String::new(),
                default: number.value,
                min: number.range.0,
                max: number.range.1,
                is_number: true,
                span: Span::new(number.offset, number.offset),
            });
        }
        self.origins.finish(sources);
        let unset = Values::default();
        let camera = parts.camera.unwrap_or_else(|| Camera::of(self.numbers(Camera::FIELDS, &unset)));
        let sky = parts.sky.unwrap_or_else(|| Sky::of(self.numbers(Sky::FIELDS, &unset)));
        let picture = parts.picture.unwrap_or_else(|| Picture::of(self.numbers(Picture::FIELDS, &unset)));
        Some(Scene {
            graph: self.graph,
            objects: parts.objects,
            distance,
            materials: parts.materials,
            lights: parts.lights,
            camera,
            cameras: parts.cameras,
            sky,
            has_own_sky: parts.has_own_sky,
            picture,
            about: parts.about.unwrap_or_default(),
            params: self.params,
            textures: self.textures,
            includes,
            origins: Arc::new(self.origins),
        })
    }

    /// Notes which text an object or a material is made of, of which the fields were noted from a mark on.
    fn note_block(
        &mut self,
        parts: &Parts,
        (section, span): (Section, Span),
        entries: &[Entry],
        from: u32,
        values: &Values,
    ) {
        let inside = self.origins.since(from);
        let fields = entries.iter().filter(|entry| !entry.is_let).map(|entry| entry.name.span);
        let head = self.origins.head([span].into_iter().chain(fields), &values.beside_the_shape);
        let whole = self.origins.head([].into_iter(), &[head, inside]);
        match (section, parts.objects.len().checked_sub(1), parts.materials.len().checked_sub(1)) {
            (Section::Object, Some(object), _) => self.origins.of_object(object, head, whole),
            (Section::Material, _, Some(material)) => self.origins.of_material(material, whole),
            _ => {}
        }
    }

    fn bare(&mut self, parts: &mut Parts, value: ExprId) {
        let span = self.ast.span(value);
        if let Some(first) = parts.objects.iter().find(|object| object.name == BARE_NAME) {
            let second = Diagnostic::new(span, "this is a second expression for the scene's shape");
            let second = second.note(first.span, "the first one is here");
            self.report(second.hint("combine them: `union(a, b)`; or give this one a name with `let`"));
            return;
        }
        let from = self.origins.mark();
        let shape = self.within(uses::POINT | uses::FRAME, "a shape", |this| this.expr(value));
        let by = self.origins.since(from);
        if let Some(shape) = self.one_number(shape, "a shape", span) {
            let material = self.default_material(parts);
            self.add_object(parts, Object { name: BARE_NAME.to_owned(), span, shape, bound: None, material });
            self.origins.of_object(parts.objects.len().saturating_sub(1), Stretch::default(), by);
        }
    }

    pub(super) fn add_object(&mut self, parts: &mut Parts, object: Object) {
        let max = self.limits.scene_objects_max;
        if parts.objects.len() >= max {
            let message = format!("the scene has more than {max} objects");
            self.stop(object.span, message, "combine shapes of one material by `union`");
        } else {
            parts.objects.push(object);
        }
    }

    /// Lowers something with its own set of allowed inputs.
    pub(super) fn within<T>(
        &mut self,
        allowed: u8,
        place: &'static str,
        lower: impl FnOnce(&mut Self) -> T,
    ) -> T {
        let outside = (self.allowed, self.place);
        (self.allowed, self.place) = (allowed, place);
        let result = lower(self);
        (self.allowed, self.place) = outside;
        result
    }

    /// The number that `what` must be; `None` if it is not one, which is then reported.
    pub(super) fn one_number(&mut self, value: Value, what: &str, span: Span) -> Option<NodeId> {
        match value {
            Value::Unknown => None,
            Value::Vector(vector) if vector.len() == 1 => Some(vector.first()),
            other => {
                let wrong = Diagnostic::new(
                    span,
                    format!("{what} must be a number, but this is {}", other.described()),
                );
                let wrong = match other {
                    Value::Vector(_) => {
                        wrong.hint("a distance is made by `length(…)` or by a shape such as `sphere(p, 1)`")
                    }
                    _ => wrong,
                };
                self.report(wrong);
                None
            }
        }
    }

    fn declare(&mut self, items: &'a [Item]) {
        let mut taken: Vec<(Section, Name)> = Vec::new();
        let limits = self.limits;
        let named_max = limits.scene_objects_max
            + limits.scene_materials_max
            + limits.scene_lights_max
            + limits.scene_cameras_max;
        for item in items {
            match item {
                Item::Param { name, value, range } => self.param(*name, *value, *range),
                Item::Let { name, value } => {
                    if self.may_declare(*name) {
                        let index = self.lets.len() as u32;
                        self.globals[name.symbol.index()].value = GlobalValue::Let(index);
                        let (name, span) = (name.symbol, name.span);
                        self.lets.push(GlobalLet {
                            name,
                            span,
                            value: *value,
                            known: None,
                            by: Stretch::default(),
                            open: false,
                        });
                    }
                }
                Item::Fn(function) => {
                    let index = function.name.symbol.index();
                    let known = self.globals[index].function;
                    if let Some(first) = self.functions.get((known as usize).wrapping_sub(1)) {
                        let span = first.function.name.span;
                        self.twice("function", function.name, span);
                        continue;
                    }
                    self.functions.push(GlobalFunction { function, called: false, open: false });
                    self.globals[index].function = self.functions.len() as u32;
                }
                // Names need no comparing beyond the limit on all of them together, which is reported later.
                Item::Section { section, name: Some(name), .. } if taken.len() < named_max => {
                    let first = taken.iter().find(|(of, one)| of == section && one.symbol == name.symbol);
                    if let Some((_, first)) = first {
                        let span = first.span;
                        self.twice(super::sections::word(*section), *name, span);
                    }
                    taken.push((*section, *name));
                }
                Item::Broken(name) => self.globals[name.symbol.index()].broken = true,
                Item::Section { .. } | Item::Bare(_) | Item::Include { .. } => {}
            }
            if self.stopped {
                return;
            }
        }
    }

    fn twice(&mut self, what: &str, name: Name, first: Span) {
        let message = format!("two {what}s are called `{}`", self.name(name.symbol));
        let wrong = Diagnostic::new(name.span, message).note(first, "the first one is here");
        self.report(wrong.hint("give one of them another name"));
    }

    /// Whether a value of the scene can have this name; reports it if not. It may hide a number of the song: those have
    /// names that scenes gave to values of their own before there was such a number.
    fn may_declare(&mut self, name: Name) -> bool {
        let input = library::input_index(name.symbol).and_then(|index| INPUTS.get(index));
        let may_hide = |row: &InputRow| matches!(row.value, InputValue::One(input) if input.is_of_song());
        if input.is_some_and(|row| !may_hide(row)) {
            let message = format!("`{}` is an input of every scene", self.name(name.symbol));
            self.report(Diagnostic::new(name.span, message).hint("choose another name"));
            return false;
        }
        let first = match self.globals[name.symbol.index()].value {
            GlobalValue::None => return true,
            GlobalValue::Let(index) => self.lets.get(index as usize).map(|one| one.span),
            GlobalValue::Param(index) => self.params.get(index as usize).map(|one| one.span),
        };
        self.twice("value", name, first.unwrap_or(name.span));
        false
    }

    fn param(&mut self, name: Name, value: ExprId, range: Option<(ExprId, ExprId)>) {
        if !self.may_declare(name) {
            return;
        }
        let max = self.limits.scene_params_max;
        if self.params.len() >= max {
            let message = format!("the scene has more than {max} parameters");
            self.stop(name.span, message, "turn some of them into `let`");
            return;
        }
        self.globals[name.symbol.index()].broken = true;
        let Some(default) = self.fixed(value, "a parameter") else { return };
        let (min, max) = match range {
            Some((min, max)) => match (self.fixed(min, "a parameter"), self.fixed(max, "a parameter")) {
                (Some(min), Some(max)) => (min, max),
                _ => return,
            },
            None => (default.min(0.0), default.max(1.0)),
        };
        let name_text = self.name(name.symbol).to_owned();
        if min >= max {
            let message = format!("the range of `{name_text}` is empty: {min} is not below {max}");
            let span = range.map_or(name.span, |(min, max)| self.ast.span(min).to(self.ast.span(max)));
            self.report(Diagnostic::new(span, message).hint("write the smaller number first"));
            return;
        }
        if default < min || default > max {
            let message =
                format!("the default of `{name_text}`, {default}, is outside its range {min} .. {max}");
            let span = self.ast.span(value);
            self.report(Diagnostic::new(span, message).hint("widen the range or move the default"));
            return;
        }
        let global = &mut self.globals[name.symbol.index()];
        global.value = GlobalValue::Param(self.params.len() as u32);
        global.broken = false;
        self.params.push(Param { name: name_text, default, min, max, is_number: false, span: name.span });
    }

    /// A number that is known before the music plays.
    pub(super) fn fixed(&mut self, value: ExprId, what: &'static str) -> Option<f32> {
        let span = self.ast.span(value);
        let result = self.within(uses::NOTHING, what, |this| this.expr(value));
        let part = self.one_number(result, what, span)?;
        // An input was used here that was already reported.
        self.known(part).filter(|number| number.is_finite())
    }

    /// Lowers functions that were never called, with unknown arguments, to find their mistakes.
    fn check_the_unused(&mut self) {
        self.within(u8::MAX, "", |this| {
            for index in 0..this.functions.len() {
                if this.stopped || std::mem::replace(&mut this.functions[index].called, true) {
                    continue;
                }
                let function = this.functions[index].function;
                this.functions[index].open = true;
                this.calls.push((function.name.symbol, function.name.span));
                let mark = this.arguments.len();
                this.put_in(function, mark);
                this.calls.pop();
                this.functions[index].open = false;
            }
        });
    }

    pub(super) fn default_material(&mut self, parts: &mut Parts) -> usize {
        if let Some(index) = parts.default_material {
            return index;
        }
        let material = Material::of("default".to_owned(), self.numbers(Material::FIELDS, &Values::default()));
        parts.materials.push(material);
        parts.default_material = Some(parts.materials.len() - 1);
        parts.materials.len() - 1
    }

    /// A library function that gives a colour for a direction.
    pub(super) fn library_color(&mut self, name: &str) -> Option<[NodeId; 3]> {
        let symbol = self.names.get(name)?;
        let direction = self.names.get("direction")?;
        let value = self.within(uses::DIRECTION | uses::FRAME, "the sky", |this| {
            let argument = this.lookup(direction, Span::default());
            let mark = this.arguments.len();
            this.arguments.push(argument);
            let value = this.library_value(symbol, mark);
            this.arguments.truncate(mark);
            value
        });
        match value {
            Value::Vector(vector) => Some([vector.part(0), vector.part(1), vector.part(2)]),
            _ => None,
        }
    }

    /// The result of a library function for numbers, if that is a number.
    pub(super) fn library_number(&mut self, name: &str, arguments: &[NodeId]) -> Option<NodeId> {
        let symbol = self.names.get(name)?;
        let mark = self.arguments.len();
        self.arguments.extend(arguments.iter().map(|&argument| Value::scalar(argument)));
        let value = self.library_value(symbol, mark);
        self.arguments.truncate(mark);
        match value {
            Value::Vector(vector) => Some(vector.first()),
            _ => None,
        }
    }

    fn library_value(&mut self, symbol: Symbol, mark: usize) -> Value {
        let library = self.library;
        let index = library.by_symbol.get(symbol.index()).copied().unwrap_or(0) as usize;
        let Some(function) = library.functions.get(index.wrapping_sub(1)) else { return Value::Unknown };
        let outside = (self.ast, self.library_call);
        (self.ast, self.library_call) = (&library.ast, Some((symbol, Span::default())));
        let value = self.put_in(function, mark);
        (self.ast, self.library_call) = outside;
        value
    }
}
