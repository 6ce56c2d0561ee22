//! Calls that read pictures: `texture` and `previous` give the channels at a position, and `text`, `image` and the names
//! of the song give the distance to a text or picture.

use super::super::builtin::uses;
use super::super::diagnostic::Diagnostic;
use super::super::path;
use super::super::scene::TextureRef;
use super::super::shape::{ShapeCall, ShapeRef, ShapeSource};
use super::super::source::Span;
use super::super::symbol::Symbol;
use super::super::value::{Value, Vector};
use super::lowering::Lowering;
use crate::graph::{NodeId, Op, SHAPE_NUMBERS};
use crate::limits::LAST_LIGHT_MAX;

/// A call of `texture` or `previous` with the arguments from `mark` on, whose expressions begin at `first` (see `Lowering::apply`).
pub(super) struct TextureRead<'l, 'a> {
    pub outer: &'l mut Lowering<'a>,
    pub mark: usize,
    pub first: u32,
    pub span: Span,
}

impl TextureRead<'_, '_> {
    pub(super) fn value(&mut self) -> Value {
        let (mark, first, span) = (self.mark, self.first, self.span);
        self.use_textures("texture");
        let file = match self.outer.arguments.get(mark).copied() {
            Some(Value::Text(symbol)) => symbol,
            Some(Value::Unknown) | None => return Value::Unknown,
            Some(other) => {
                let message = format!("`texture` takes a file's name in quotes, not {}", other.described());
                let place = self.outer.argument_span(first, 0, span);
                return self
                    .outer
                    .reports
                    .add(Diagnostic::new(place, message).hint("write `texture(\"wood.png\", uv)`"));
            }
        };
        let Some((u, v)) = self.place(1, "texture", "take two components, as in `p.xz`") else {
            return Value::Unknown;
        };
        let Some(number) = self.number(file, self.outer.argument_span(first, 0, span)) else {
            return Value::Unknown;
        };
        let parts = [0, 1, 2, 3].map(|channel| self.outer.graph.texture(number, channel, u, v));
        Value::of(&parts)
    }

    /// Returns the light of the last frame. Its texture holds fractions of [`LAST_LIGHT_MAX`], because bounds of
    /// textures are 0..1.
    pub(super) fn last_frame(&mut self) -> Value {
        let number = self.last_frame_number();
        let hint = "`pixel / resolution` is the place of the pixel that is drawn";
        let Some((u, v)) = self.place(0, "previous", hint) else { return Value::Unknown };
        let Some(number) = number else { return Value::Unknown };
        let most = self.outer.constant(LAST_LIGHT_MAX);
        let graph = &mut self.outer.graph;
        let parts = [0, 1, 2].map(|channel| {
            let fraction = graph.texture(number, channel, u, v);
            graph.mul(fraction, most)
        });
        Value::of(&parts)
    }

    /// Returns the number of the texture that holds the last frame.
    pub(super) fn last_frame_number(&mut self) -> Option<u16> {
        self.use_textures("previous");
        let place = self.outer.reports.library_call.map_or(self.span, |call| call.1);
        self.numbered(TextureRef::last_frame(place))
    }

    fn use_textures(&mut self, name: &str) {
        if let Some(symbol) = self.outer.names.get(name) {
            self.outer.inputs.declare(uses::TEXTURE, symbol, self.span, &mut self.outer.reports);
        }
    }

    /// Returns the position in argument `index`. Reports other values with a hint.
    fn place(&mut self, index: usize, name: &str, hint: &str) -> Option<(NodeId, NodeId)> {
        match self.outer.arguments.get(self.mark + index).copied()? {
            Value::Vector(vector) if vector.len() == 2 => Some((vector.part(0), vector.part(1))),
            Value::Unknown => None,
            other => {
                let message = format!("`{name}` takes a vec2 as its position, not {}", other.described());
                let place = self.outer.argument_span(self.first, index, self.span);
                self.outer.reports.add(Diagnostic::new(place, message).hint(hint));
                None
            }
        }
    }

    pub(super) fn number(&mut self, file: Symbol, span: Span) -> Option<u16> {
        let place = self.outer.reports.library_call.map_or(span, |call| call.1);
        let name = match path::checked(self.outer.name(file)) {
            Ok(name) => name,
            Err((message, hint)) => {
                self.outer.reports.add(Diagnostic::new(place, message).hint(hint));
                return None;
            }
        };
        self.numbered(TextureRef { name, span: place, moves: None })
    }

    /// Returns the number of a texture. A new texture takes the next number.
    fn numbered(&mut self, texture: TextureRef) -> Option<u16> {
        if let Some(known) = self.outer.declared.textures.iter().position(|one| one.name == texture.name) {
            return Some(known as u16);
        }
        let max = self.outer.limits.scene_textures_max;
        if self.outer.declared.textures.len() >= max {
            let message = format!("the scene reads more than {max} images; the last frame counts as one");
            let wrong = Diagnostic::over_limit(texture.span, message);
            self.outer.reports.add(wrong.hint("combine several images into one file"));
            return None;
        }
        self.outer.declared.textures.push(texture);
        Some((self.outer.declared.textures.len() - 1) as u16)
    }
}

// Calls of `text`, `image`, `title`, `artist` and `lyrics`: the 2D distance to a text or picture.
//
// The distance is read from the grid at the nearest point of its rectangle. Beyond the rectangle, the distance to the
// rectangle is also a lower bound. Within it that distance is negative and never the larger one, because the grid is
// positive at its rim. A cell of the tree on one side of the rim therefore drops the other side.

/// A call with the arguments from `mark` on, whose expressions begin at `first` (see `Lowering::apply`).
pub(super) struct ShapeRead<'l, 'a> {
    pub outer: &'l mut Lowering<'a>,
    pub name: &'static str,
    pub call: ShapeCall,
    pub mark: usize,
    pub first: u32,
    pub span: Span,
}

impl ShapeRead<'_, '_> {
    pub(super) fn value(&mut self) -> Value {
        let words = match self.words_place() {
            Some(place) => match self.words(place) {
                Some(words) => Some(words),
                None => return Value::Unknown,
            },
            None => None,
        };
        let Some(at) = self.position(self.position_place()) else { return Value::Unknown };
        let font = match self.argument(self.font_place()) {
            Some(_) => match self.words(self.font_place()) {
                Some(font) => Some(font),
                None => return Value::Unknown,
            },
            None => None,
        };
        let Some(source) = self.source(words, font) else { return Value::Unknown };
        match self.number(source) {
            Some(number) => Value::scalar(self.distance(number, at)),
            None => Value::Unknown,
        }
    }

    /// The number of the argument with the text or file; the song's texts have none.
    fn words_place(&self) -> Option<usize> {
        (!matches!(self.call, ShapeCall::Song(_))).then_some(0)
    }

    fn position_place(&self) -> usize {
        self.words_place().map_or(0, |words| words + 1)
    }

    fn font_place(&self) -> usize {
        self.position_place() + 1
    }

    fn argument(&self, place: usize) -> Option<Value> {
        self.outer.arguments.get(self.mark + place).copied()
    }

    fn place(&self, argument: usize) -> Span {
        let place = self.outer.argument_span(self.first, argument, self.span);
        self.outer.reports.library_call.map_or(place, |call| call.1)
    }

    fn words(&mut self, argument: usize) -> Option<String> {
        match self.argument(argument) {
            Some(Value::Text(symbol)) => Some(self.outer.name(symbol).to_owned()),
            Some(Value::Unknown) | None => None,
            Some(other) => {
                let what = match (self.call, argument) {
                    (ShapeCall::Text, 0) => "a text in quotes",
                    (ShapeCall::Image, 0) => "a file's name in quotes",
                    _ => "the name of a font in quotes",
                };
                let message = format!("`{}` takes {what}, not {}", self.name, other.described());
                let hint = self.example();
                let wrong = Diagnostic::new(self.place(argument), message).hint(hint);
                self.outer.reports.add(wrong);
                None
            }
        }
    }

    fn example(&self) -> String {
        match self.call {
            ShapeCall::Text => "write `text(\"MARIANA\", p.xy)`".to_owned(),
            ShapeCall::Image => "write `image(\"logo.png\", p.xy)`".to_owned(),
            ShapeCall::Song(_) => format!("write `{}(p.xy)`", self.name),
        }
    }

    fn position(&mut self, argument: usize) -> Option<Vector> {
        match self.argument(argument) {
            Some(Value::Vector(vector)) if vector.len() == 2 => Some(vector),
            Some(Value::Unknown) | None => None,
            Some(other) => {
                let message =
                    format!("`{}` takes a vec2 as its position, not {}", self.name, other.described());
                let wrong =
                    Diagnostic::new(self.place(argument), message).hint("take two components, as in `p.xy`");
                self.outer.reports.add(wrong);
                None
            }
        }
    }

    /// Returns what to bake. Reports a text, file or font that cannot exist.
    fn source(&mut self, words: Option<String>, font: Option<String>) -> Option<ShapeSource> {
        let font = match font.map(|font| path::checked(&font)).transpose() {
            Ok(font) => font,
            Err((message, hint)) => {
                let message = message.replace("file", "font");
                self.outer.reports.add(Diagnostic::new(self.place(self.font_place()), message).hint(hint));
                return None;
            }
        };
        let place = self.place(0);
        match (self.call, words) {
            (ShapeCall::Song(what), _) => {
                if let Some(symbol) = self.outer.names.get(self.name) {
                    self.outer.inputs.declare(uses::FRAME, symbol, self.span, &mut self.outer.reports);
                }
                Some(ShapeSource::Song { what, font })
            }
            (ShapeCall::Image, Some(file)) => match path::checked(&file) {
                Ok(file) => Some(ShapeSource::Image(file)),
                Err((message, hint)) => {
                    self.outer.reports.add(Diagnostic::new(place, message).hint(hint));
                    None
                }
            },
            (_, words) => {
                let text = words.unwrap_or_default();
                let (letters, max) = (text.chars().count(), self.outer.limits.shape_letters_max);
                let wrong = if text.trim().is_empty() {
                    Diagnostic::new(place, "this text has no letters").hint("write a word in the quotes")
                } else if letters > max {
                    let message = format!("this text has {letters} letters, and a shape has at most {max}");
                    Diagnostic::over_limit(place, message).hint("divide it into several texts")
                } else {
                    return Some(ShapeSource::Text { text, font });
                };
                self.outer.reports.add(wrong);
                None
            }
        }
    }

    fn number(&mut self, source: ShapeSource) -> Option<usize> {
        let span = self.place(0);
        let (shapes, max) = (&mut self.outer.declared.shapes, self.outer.limits.scene_shapes_max);
        if let Some(known) = shapes.iter().position(|one| one.source == source) {
            return Some(known);
        }
        if shapes.len() >= max {
            let message = format!("the scene has more than {max} different texts and pictures as shapes");
            let wrong = Diagnostic::over_limit(span, message).hint("write several words as one text");
            self.outer.reports.add(wrong);
            return None;
        }
        shapes.push(ShapeRef { source, span, baker: None });
        Some(shapes.len() - 1)
    }

    fn distance(&mut self, number: usize, at: Vector) -> NodeId {
        let graph = &mut self.outer.graph;
        let numbers: [NodeId; SHAPE_NUMBERS] = std::array::from_fn(|place| {
            let index = graph.constant((SHAPE_NUMBERS * number + place) as f32);
            graph.unary(Op::ShapeNumber, index)
        });
        let [width, height, per_unit, column, row] = numbers;
        let [x, y] = [at.part(0), at.part(1)];
        let [across, up] = [(x, width, column), (y, height, row)].map(|(at, half, middle)| {
            let least = graph.neg(half);
            let inside = graph.clamp(at, least, half);
            let scaled = graph.mul(inside, per_unit);
            graph.add(scaled, middle)
        });
        let mut distance = graph.binary(Op::Shape, across, up);
        for (at, half) in [(y, height), (x, width)] {
            let off = graph.abs(at);
            let beyond = graph.sub(off, half);
            distance = graph.max(beyond, distance);
        }
        distance
    }
}
