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
use super::call::Call;
use super::lowering::Lowering;
use crate::graph::{NodeId, Op, SHAPE_NUMBERS};
use crate::limits::LAST_LIGHT_MAX;

pub(super) struct Read<'l, 'a> {
    pub outer: &'l mut Lowering<'a>,
    pub name: &'static str,
    pub call: Call,
}

impl Read<'_, '_> {
    fn argument(&self, index: usize) -> Option<Value> {
        self.outer.arguments.get(self.call.mark + index).copied()
    }

    fn place(&self, argument: usize) -> Span {
        let place = self.outer.argument_span(self.call, argument);
        self.outer.reports.library_call.map_or(place, |call| call.1)
    }

    /// Returns a text in quotes. `what` describes it in the message about another value.
    fn text(&mut self, argument: usize, what: &str, hint: impl Into<String>) -> Option<Symbol> {
        match self.argument(argument)? {
            Value::Text(symbol) => Some(symbol),
            Value::Unknown => None,
            other => {
                let message = format!("`{}` takes {what}, not {}", self.name, other.described());
                let wrong = Diagnostic::new(self.place(argument), message).hint(hint);
                self.outer.reports.refuse(wrong)
            }
        }
    }

    /// Returns a position in a picture. Reports other values with a hint.
    fn position(&mut self, argument: usize, hint: &str) -> Option<Vector> {
        match self.argument(argument)? {
            Value::Vector(vector) if vector.len() == 2 => Some(vector),
            Value::Unknown => None,
            other => {
                let message =
                    format!("`{}` takes a vec2 as its position, not {}", self.name, other.described());
                self.outer.reports.refuse(Diagnostic::new(self.place(argument), message).hint(hint))
            }
        }
    }

    /// Returns the checked path of a file. `what` is the file's name in messages.
    fn path(&mut self, file: Symbol, what: &str, place: Span) -> Option<String> {
        let checked = path::checked(self.outer.name(file));
        checked
            .map_err(|(message, hint)| {
                self.outer.reports.add(Diagnostic::new(place, message.replace("file", what)).hint(hint));
            })
            .ok()
    }

    /// Reads a texture.
    pub(super) fn texture(&mut self) -> Option<Value> {
        self.outer.used(uses::TEXTURE, "texture", self.call.span);
        let file = self.text(0, "a file's name in quotes", "write `texture(\"wood.png\", uv)`")?;
        let at = self.position(1, "take two components, as in `p.xz`")?;
        let number = self.number(file, self.place(0))?;
        let [u, v] = [at.part(0), at.part(1)];
        Some(Value::of(&[0, 1, 2, 3].map(|channel| self.outer.graph.texture(number, channel, u, v))))
    }

    /// Returns the light of the last frame. Its texture holds fractions of [`LAST_LIGHT_MAX`], because bounds of
    /// textures are 0..1.
    pub(super) fn last_frame(&mut self) -> Option<Value> {
        let number = self.last_frame_number();
        let at = self.position(0, "`pixel / resolution` is the place of the pixel that is drawn")?;
        let ([u, v], number) = ([at.part(0), at.part(1)], number?);
        let graph = &mut self.outer.graph;
        Some(Value::of(&[0, 1, 2].map(|channel| {
            let fraction = graph.texture(number, channel, u, v);
            graph.mul(fraction, LAST_LIGHT_MAX)
        })))
    }

    /// Returns the number of the texture that holds the last frame.
    pub(super) fn last_frame_number(&mut self) -> Option<u16> {
        self.outer.used(uses::TEXTURE, "previous", self.call.span);
        let place = self.outer.reports.library_call.map_or(self.call.span, |call| call.1);
        self.numbered(TextureRef::last_frame(place))
    }

    pub(super) fn number(&mut self, file: Symbol, place: Span) -> Option<u16> {
        let name = self.path(file, "file", place)?;
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
            return self.outer.reports.refuse(wrong.hint("combine several images into one file"));
        }
        self.outer.declared.textures.push(texture);
        Some((self.outer.declared.textures.len() - 1) as u16)
    }

    // Calls of `text`, `image`, `title`, `artist` and `lyrics`: the 2D distance to a text or picture.
    //
    // The distance is read from the grid at the nearest point of its rectangle. Beyond the rectangle, the distance to
    // the rectangle is also a lower bound. Within it that distance is negative and never the larger one, because the
    // grid is positive at its rim. A cell of the tree on one side of the rim therefore drops the other side.

    pub(super) fn shape(&mut self, call: ShapeCall) -> Option<Value> {
        let (what, example) = match call {
            ShapeCall::Text => ("a text in quotes", "text(\"MARIANA\", p.xy)".to_owned()),
            ShapeCall::Image => ("a file's name in quotes", "image(\"logo.png\", p.xy)".to_owned()),
            ShapeCall::Song(_) => ("", format!("{}(p.xy)", self.name)),
        };
        let hint = format!("write `{example}`");
        // The song's texts have no argument with the words.
        let has_words = !matches!(call, ShapeCall::Song(_));
        let words = if has_words { Some(self.text(0, what, hint.as_str())?) } else { None };
        let position = usize::from(has_words);
        let at = self.position(position, "take two components, as in `p.xy`")?;
        let mut font = None;
        if self.argument(position + 1).is_some() {
            let name = self.text(position + 1, "the name of a font in quotes", hint)?;
            font = Some(self.path(name, "font", self.place(position + 1))?);
        }
        let source = self.source(call, words, font)?;
        let number = self.shape_number(source)?;
        Some(Value::scalar(self.distance(number, at)))
    }

    /// Returns what to bake. Reports a text or file that cannot exist.
    fn source(
        &mut self,
        call: ShapeCall,
        words: Option<Symbol>,
        font: Option<String>,
    ) -> Option<ShapeSource> {
        let place = self.place(0);
        match (call, words) {
            (ShapeCall::Song(what), _) => {
                self.outer.used(uses::FRAME, self.name, self.call.span);
                Some(ShapeSource::Song { what, font })
            }
            (ShapeCall::Image, Some(file)) => self.path(file, "file", place).map(ShapeSource::Image),
            (_, words) => {
                let text = words.map_or("", |words| self.outer.name(words)).to_owned();
                let (letters, max) = (text.chars().count(), self.outer.limits.shape_letters_max);
                let wrong = if text.trim().is_empty() {
                    Diagnostic::new(place, "this text has no letters").hint("write a word in the quotes")
                } else if letters > max {
                    let message = format!("this text has {letters} letters, and a shape has at most {max}");
                    Diagnostic::over_limit(place, message).hint("divide it into several texts")
                } else {
                    return Some(ShapeSource::Text { text, font });
                };
                self.outer.reports.refuse(wrong)
            }
        }
    }

    fn shape_number(&mut self, source: ShapeSource) -> Option<usize> {
        let span = self.place(0);
        let (shapes, max) = (&mut self.outer.declared.shapes, self.outer.limits.scene_shapes_max);
        if let Some(known) = shapes.iter().position(|one| one.source == source) {
            return Some(known);
        }
        if shapes.len() >= max {
            let message = format!("the scene has more than {max} different texts and pictures as shapes");
            let wrong = Diagnostic::over_limit(span, message).hint("write several words as one text");
            return self.outer.reports.refuse(wrong);
        }
        shapes.push(ShapeRef { source, span, baker: None });
        Some(shapes.len() - 1)
    }

    fn distance(&mut self, number: usize, at: Vector) -> NodeId {
        let graph = &mut self.outer.graph;
        let numbers: [NodeId; SHAPE_NUMBERS] = std::array::from_fn(|place| {
            graph.unary(Op::ShapeNumber, (SHAPE_NUMBERS * number + place) as f32)
        });
        let [width, height, per_unit, column, row] = numbers;
        let [x, y] = [at.part(0), at.part(1)];
        let [across, up] = [(x, width, column), (y, height, row)].map(|(at, half, middle)| {
            let inside = graph.clamp(at, Op::Neg.of(half), half);
            graph.add(inside * per_unit, middle)
        });
        let mut distance = graph.binary(Op::Shape, across, up);
        for (at, half) in [(y, height), (x, width)] {
            distance = graph.max(Op::Abs.of(at) - half, distance);
        }
        distance
    }
}
