//! Calls of `texture`: the file's number, and its channels at a position.

use super::super::builtin::uses;
use super::super::diagnostic::Diagnostic;
use super::super::path;
use super::super::scene::TextureRef;
use super::super::source::Span;
use super::super::symbol::Symbol;
use super::super::value::{Value, Vector};
use super::lowering::Lowering;

/// A call of `texture` with the arguments from `mark` on, whose expressions begin at `first` (see `Lowering::apply`).
pub(super) struct TextureRead<'l, 'a> {
    pub outer: &'l mut Lowering<'a>,
    pub mark: usize,
    pub first: u32,
    pub span: Span,
}

impl TextureRead<'_, '_> {
    pub(super) fn value(&mut self) -> Value {
        let (mark, first, span) = (self.mark, self.first, self.span);
        if let Some(symbol) = self.outer.names.get("texture") {
            self.outer.inputs.take(uses::TEXTURE, symbol, span, &mut self.outer.reports);
        }
        let mut arguments = self.outer.arguments.iter().skip(mark).copied();
        let (file, at) = (arguments.next(), arguments.next());
        let file = match file {
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
        let at = match at {
            Some(Value::Vector(vector)) if vector.len() == 2 => vector,
            Some(Value::Unknown) | None => return Value::Unknown,
            Some(other) => {
                let message = format!("`texture` takes a vec2 as its position, not {}", other.described());
                let place = self.outer.argument_span(first, 1, span);
                return self
                    .outer
                    .reports
                    .add(Diagnostic::new(place, message).hint("take two components, as in `p.xz`"));
            }
        };
        let Some(number) = self.number(file, self.outer.argument_span(first, 0, span)) else {
            return Value::Unknown;
        };
        let (u, v) = (at.part(0), at.part(1));
        let parts = [0, 1, 2, 3].map(|channel| self.outer.graph.texture(number, channel, u, v));
        Vector::of(parts).map_or(Value::Unknown, Value::Vector)
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
        if let Some(known) = self.outer.declared.textures.iter().position(|one| one.name == name) {
            return Some(known as u16);
        }
        let max = self.outer.limits.scene_textures_max;
        if self.outer.declared.textures.len() >= max {
            let message = format!("the scene reads more than {max} images");
            self.outer
                .reports
                .add(Diagnostic::over_limit(place, message).hint("combine several images into one file"));
            return None;
        }
        self.outer.declared.textures.push(TextureRef { name, span: place, moves: None });
        Some((self.outer.declared.textures.len() - 1) as u16)
    }
}
