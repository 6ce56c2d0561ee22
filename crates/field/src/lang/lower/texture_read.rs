//! Calls of `texture` and `previous`: the texture's number, and its channels at a position.

use super::super::builtin::uses;
use super::super::diagnostic::Diagnostic;
use super::super::path;
use super::super::scene::TextureRef;
use super::super::source::Span;
use super::super::symbol::Symbol;
use super::super::value::{Value, Vector};
use super::lowering::Lowering;
use crate::graph::NodeId;
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
        Vector::of(parts).map_or(Value::Unknown, Value::Vector)
    }

    /// Returns the light of the last frame. Its texture holds fractions of [`LAST_LIGHT_MAX`], because bounds of
    /// textures are 0..1.
    pub(super) fn last_frame(&mut self) -> Value {
        self.use_textures("previous");
        let hint = "`pixel / resolution` is the place of the pixel that is drawn";
        let Some((u, v)) = self.place(0, "previous", hint) else { return Value::Unknown };
        let place = self.outer.reports.library_call.map_or(self.span, |call| call.1);
        let Some(number) = self.numbered(TextureRef::last_frame(place)) else { return Value::Unknown };
        let most = self.outer.constant(LAST_LIGHT_MAX);
        let graph = &mut self.outer.graph;
        let parts = [0, 1, 2].map(|channel| {
            let fraction = graph.texture(number, channel, u, v);
            graph.mul(fraction, most)
        });
        Vector::of(parts).map_or(Value::Unknown, Value::Vector)
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

    fn number(&mut self, file: Symbol, span: Span) -> Option<u16> {
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
