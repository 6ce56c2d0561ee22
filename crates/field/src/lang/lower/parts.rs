//! Inputs of a part of the song: `drums.volume`, `vocals.band(3)`.

use super::super::ast::{Expr, ExprId};
use super::super::builtin::uses;
use super::super::diagnostic::Diagnostic;
use super::super::library;
use super::super::source::Span;
use super::super::symbol::Symbol;
use super::super::value::Value;
use super::builtins::Number;
use super::declared::GlobalValue;
use super::expr::is_swizzle;
use super::lowering::Lowering;
use crate::graph::{LevelList, NodeId, Op, PartInput, PartNumber, SongPart};

impl Lowering<'_> {
    /// Returns the part with this name, unless the scene declares a value of the same name.
    pub(super) fn part(&self, symbol: Symbol) -> Option<SongPart> {
        let place = self.library.parts.iter().position(|part| *part == symbol)?;
        let global = self.declared.global(symbol);
        let is_own = self.reports.library_call.is_none()
            && (global.broken || !matches!(global.value, GlobalValue::None));
        if is_own || self.scope.local(symbol).is_some() { None } else { SongPart::ALL.get(place).copied() }
    }

    /// Returns the value of `of.name` if `of` is a part of the song. Returns `None` for components of a vector.
    pub(super) fn part_input(&mut self, of: ExprId, name: Symbol, span: Span) -> Option<Value> {
        let Expr::Name(symbol) = self.ast.expr(of) else { return None };
        let part = self.part(symbol)?;
        let text = self.name(name);
        let numbers = PartInput::sounds().filter(|input| input.name().split('.').next() == Some(text));
        let indices: Vec<usize> =
            numbers.map(|input| PartInput { part, number: PartNumber::Sound(input) }.index()).collect();
        if indices.is_empty() {
            // `bass.xx` is a vector of the low frequencies.
            let is_vector = library::input(symbol).is_some() && is_swizzle(text);
            return (!is_vector).then(|| self.reports.no_such_number(part, text, span));
        }
        self.inputs.declare(uses::FRAME, symbol, span, &mut self.reports);
        let numbers: Vec<NodeId> =
            indices.into_iter().map(|index| self.graph.unary(Op::Part, index as f32)).collect();
        Some(Value::of(&numbers))
    }

    /// Returns the value of `part.band(index)`.
    pub(super) fn part_band(&mut self, of: Symbol, index: ExprId, span: Span) -> Value {
        let Some(part) = self.part(of) else {
            let message = format!("`{}` has no function `band`", self.name(of));
            let names = SongPart::ALL.map(SongPart::name).join("`, `");
            let hint =
                format!("the parts of the song have it: `{names}`, unless the scene uses the name otherwise");
            return self.reports.add(Diagnostic::new(span, message).hint(hint));
        };
        self.inputs.declare(uses::FRAME, of, span, &mut self.reports);
        let index_span = self.ast.span(index);
        let value = self.expr_below(index, span);
        let Some(index) = self.number(value, index_span, || "`band`".to_owned()) else {
            return Value::Unknown;
        };
        let first = PartInput::first_band(part).index();
        Value::scalar(match self.level_number(LevelList::Band, index, index_span) {
            Some(Number::Known(band)) => self.graph.unary(Op::Part, (first + band) as f32),
            Some(Number::Computed(index)) => {
                let band = self.graph.clamp(index, 0.0, (LevelList::Band.count() - 1) as f32);
                // Round before the sum, which may round up.
                self.graph.unary(Op::Part, first as f32 + Op::Floor.of(band))
            }
            None => return Value::Unknown,
        })
    }
}
