//! Choices between two values, of which records and matrices have several numbers.

use super::super::diagnostic::Diagnostic;
use super::super::source::Span;
use super::super::symbol::Symbol;
use super::super::value::Value;
use super::composites::Matrices;
use super::expr::zip;
use super::lowering::Lowering;
use crate::graph::NodeId;

/// A choice that depends on a condition.
pub(super) struct Choice<'l, 'a> {
    pub lowering: &'l mut Lowering<'a>,
    pub condition: NodeId,
    /// The name of the two values in messages.
    pub what: &'static str,
    pub span: Span,
}

impl Choice<'_, '_> {
    /// Returns `yes` where the condition holds, else `no`.
    pub(super) fn between(&mut self, yes: Value, no: Value) -> Value {
        let condition = self.condition;
        match (yes, no) {
            _ if yes == no => yes,
            (Value::Unknown, _) | (_, Value::Unknown) => Value::Unknown,
            (Value::Vector(a), Value::Vector(b)) => {
                let len = a.len().max(b.len());
                match (a.widened(len), b.widened(len)) {
                    (Some(a), Some(b)) => {
                        zip(&mut self.lowering.graph, a, b, |graph, a, b| graph.select(condition, a, b))
                    }
                    _ => self.types_differ(yes, no),
                }
            }
            (Value::Bool(a), Value::Bool(b)) => Value::Bool(self.lowering.graph.select(condition, a, b)),
            (Value::Text(_), Value::Text(_)) => {
                let wrong = Diagnostic::unsupported(self.span, "an `if` cannot choose between files");
                let hint = "read both textures and choose between their colours";
                self.lowering.reports.add(wrong.hint(hint))
            }
            (Value::Matrix(a), Value::Matrix(b)) => Matrices::of(self.lowering)
                .pair(a, b, |graph, a, b| graph.select(condition, a, b))
                .unwrap_or_else(|| self.types_differ(yes, no)),
            (Value::Record(a), Value::Record(b)) => self.between_records(a, b),
            _ => self.types_differ(yes, no),
        }
    }

    #[cold]
    fn types_differ(&mut self, yes: Value, no: Value) -> Value {
        let (what, yes, no) = (self.what, yes.described(), no.described());
        let message = format!("{what} must have the same type, not {yes} and {no}");
        self.lowering.reports.add(Diagnostic::new(self.span, message))
    }

    /// Chooses between two records with the same names.
    fn between_records(&mut self, yes: u32, no: u32) -> Value {
        let composites = &self.lowering.scope.composites;
        let (yes, no) = (composites.record(yes), composites.record(no));
        let names = |fields: &[(Symbol, Value)]| fields.iter().map(|field| field.0).collect::<Vec<_>>();
        if names(yes) != names(no) {
            let message = format!("{} must have the same names in the same order", self.what);
            return self.lowering.reports.add(Diagnostic::new(self.span, message));
        }
        let pairs: Vec<_> = yes.iter().zip(no).map(|(yes, no)| (yes.0, yes.1, no.1)).collect();
        let fields = pairs.into_iter().map(|(name, yes, no)| (name, self.between(yes, no))).collect();
        self.lowering.scope.composites.add_record(fields)
    }
}
