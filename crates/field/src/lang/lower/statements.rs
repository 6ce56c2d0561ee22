//! Lowers blocks and their statements. Loops are unrolled: a name that a loop changes has one value per iteration.
//!
//! Both sides of an `if` are lowered, and each name that they change becomes a choice between its two values. An early
//! end of a loop is a condition as well: from there on, assignments keep the old value where the condition holds.

use super::super::ast::{Assignment, Expr, ExprId, Loop, Statements, When};
use super::super::diagnostic::Diagnostic;
use super::super::library;
use super::super::source::Span;
use super::super::symbol::Symbol;
use super::super::value::{Value, Vector};
use super::expr::{component, is_swizzle};
use super::lowering::Lowering;
use super::scope::Flow;
use crate::graph::{FrameInputs, NodeId, Op};

impl Lowering<'_> {
    pub(super) fn block(&mut self, first: u32, count: u32, result: ExprId, span: Span) -> Value {
        let mark = self.scope.bindings.len();
        let is_body = std::mem::take(&mut self.scope.enters_body);
        let floor = if is_body { self.scope.frame } else { mark };
        let outside = (self.scope.floor, self.scope.flow);
        // A block that is a value does not end the loop around it, because both sides of a choice are lowered.
        (self.scope.floor, self.scope.flow) = (floor, Flow::default());
        self.statements(Statements { first, count });
        let value = self.expr_below(result, span);
        self.scope.unbind(mark);
        (self.scope.floor, self.scope.flow) = outside;
        value
    }

    /// Lowers statements; stops after a `break` without a condition.
    fn statements(&mut self, Statements { first, count }: Statements) {
        for index in 0..count {
            let id = ExprId(self.ast.extra(first + index));
            let span = self.ast.span(id);
            let has_ended = self.scope.flow.ended.and_then(|ended| self.graph.as_constant(ended));
            if has_ended.is_some_and(|ended| ended != 0.0) || !self.step(span) {
                return;
            }
            if self.budget.depth >= self.limits.scene_depth_max {
                self.too_deep(span);
                return;
            }
            self.budget.depth += 1;
            self.statement(id, span);
            self.budget.depth -= 1;
        }
    }

    fn statement(&mut self, id: ExprId, span: Span) {
        match self.ast.expr(id) {
            Expr::Let(symbol, value) => {
                let from = self.origins.mark();
                let value = self.expr_below(value, span);
                let by = self.origins.since(from);
                self.scope.bind_made(symbol, value, by);
            }
            Expr::Assign(index) => {
                if let Some(assignment) = self.ast.assignment(index) {
                    self.assign(assignment, span);
                }
            }
            Expr::Loop(index) => {
                if let Some(of) = self.ast.loop_at(index) {
                    self.repeat(of, span);
                }
            }
            Expr::When(index) => {
                if let Some(when) = self.ast.when(index) {
                    self.when(when, span);
                }
            }
            Expr::Break => {
                let Flow { path, in_loop, .. } = self.scope.flow;
                if !in_loop {
                    let message = "there is no loop here that `break` could end";
                    let hint = "write it among the statements of `for i in 0..8 { … }`";
                    self.reports.add(Diagnostic::new(span, message).hint(hint));
                    return;
                }
                let now = path.unwrap_or_else(|| self.constant(1.0));
                self.end_where(now);
            }
            _ => {}
        }
    }

    fn assign(&mut self, assignment: Assignment, span: Span) {
        let Assignment { name, components, op, value } = assignment;
        let from = self.origins.mark();
        let mut new = self.expr_below(value, span);
        let Some((old, by)) = self.scope.local(name) else {
            self.unknown_target(name, span);
            return;
        };
        self.origins.uses(by);
        if let Some(op) = op {
            let part = components.map_or(old, |components| self.swizzle(old, components, span));
            new = self.binary(op, part, new, span);
        }
        new = match components {
            Some(components) => self.with_components(old, components, new, span),
            None => self.of_same_type(name, old, new, span),
        };
        if let Some(ended) = self.scope.flow.ended {
            new = self.either(ended, old, new, "both values", span);
        }
        let by = self.origins.since(from);
        if !self.scope.assign(name, new, by) {
            let text = self.name(name);
            let message =
                format!("`{text}` belongs to an outer block, which a value in braces cannot change");
            let hint = format!("choose between values: `{text} = if a then b else c`");
            self.reports.add(Diagnostic::unsupported(span, message).hint(hint));
        }
    }

    #[cold]
    fn unknown_target(&mut self, name: Symbol, span: Span) {
        let text = self.name(name);
        let place = Span::new(span.start, span.start + text.len() as u32);
        let is_input = library::input_index(name).is_some();
        let message = match is_input {
            true => format!("`{text}` is an input, which has the same value everywhere in the text"),
            false => format!("a block declares its names with `let`, but `{text}` is not declared"),
        };
        let hint = match is_input {
            true => format!("make a copy first: `let {text} = {text}`"),
            false => format!("write `let {text} = …`"),
        };
        self.reports.add(Diagnostic::new(place, message).hint(hint));
        // Report the name once.
        self.scope.bind(name, Value::Unknown);
    }

    /// Returns `new` as a value of the type of `old`. A number is repeated where a vector is expected.
    fn of_same_type(&mut self, name: Symbol, old: Value, new: Value, span: Span) -> Value {
        let types = &self.scope.composites;
        match (old, new) {
            (Value::Unknown, _) | (_, Value::Unknown) => Value::Unknown,
            (Value::Vector(a), Value::Vector(b)) if b.len() == 1 => {
                b.widened(a.len()).map_or(Value::Unknown, Value::Vector)
            }
            (Value::Record(_), Value::Record(_)) => new,
            _ if types.type_of(old) == types.type_of(new) => new,
            _ => {
                let text = self.name(name);
                let message =
                    format!("`{text}` is {}, so it cannot become {}", old.described(), new.described());
                let wrong = Diagnostic::new(span, message);
                let hint = match new {
                    Value::Vector(vector) => format!("declare it as `let {text} = vec{}(0)`", vector.len()),
                    _ => "give the new value another name".to_owned(),
                };
                self.reports.add(wrong.hint(hint))
            }
        }
    }

    /// Returns the vector `old` with the named components replaced by those of `new`.
    fn with_components(&mut self, old: Value, components: Symbol, new: Value, span: Span) -> Value {
        let text = self.name(components);
        let (vector, parts) = match (old, new) {
            (Value::Vector(vector), Value::Vector(parts)) => (vector, parts),
            (Value::Unknown, _) | (_, Value::Unknown) => return Value::Unknown,
            (Value::Vector(_), other) => {
                let message = format!("a component is a number, not {}", other.described());
                return self.reports.add(Diagnostic::new(span, message));
            }
            (other, _) => {
                let message = format!("the components of {} cannot be set", other.described());
                let hint = "set the components of a vector, as in `q.xz = …`";
                return self.reports.add(Diagnostic::new(span, message).hint(hint));
            }
        };
        // Reports components that do not exist.
        if !is_swizzle(text) || self.swizzle(old, components, span) == Value::Unknown {
            return self.swizzle(old, components, span);
        }
        let count = text.len();
        let Some(parts) = parts.widened(count) else {
            let message = format!("`.{text}` needs {count} numbers, but gets {}", new.described());
            return self.reports.add(Diagnostic::new(span, message));
        };
        let mut result: Vec<NodeId> = vector.parts().to_vec();
        let mut is_set = [false; 4];
        for (at, byte) in text.bytes().enumerate() {
            let index = component(byte).map_or(0, |(_, index)| index);
            if let (Some(slot), Some(set)) = (result.get_mut(index), is_set.get_mut(index)) {
                if std::mem::replace(set, true) {
                    let message = format!("`.{text}` sets the component `{}` twice", char::from(byte));
                    return self.reports.add(Diagnostic::new(span, message));
                }
                *slot = parts.part(at);
            }
        }
        Vector::from_slice(&result).map_or(Value::Unknown, Value::Vector)
    }

    /// Lowers `if condition { … } else { … }`.
    fn when(&mut self, When { condition, yes, no }: When, span: Span) {
        let from = self.origins.mark();
        let Some(condition) = self.condition(condition, "`if`", span) else { return };
        if let Some(known) = self.graph.as_constant(condition) {
            self.branch(if known != 0.0 { yes } else { no }, None);
            return;
        }
        let before = self.scope.values();
        self.branch(yes, Some(condition));
        let after_yes = self.scope.values();
        self.scope.put_back(&before);
        let otherwise = self.graph.not(condition);
        self.branch(no, Some(otherwise));
        let after_no = self.scope.values();
        let merged: Vec<Value> = after_yes
            .iter()
            .zip(&after_no)
            .map(|(yes, no)| self.either(condition, *yes, *no, "both values", span))
            .collect();
        let by = self.origins.since(from);
        self.scope.change(&before, &merged, by);
    }

    /// Lowers statements that run only where `condition` holds.
    fn branch(&mut self, statements: Statements, condition: Option<NodeId>) {
        let (mark, outside) = (self.scope.bindings.len(), self.scope.flow.path);
        if let Some(condition) = condition {
            let path = outside.map_or(condition, |path| self.graph.min(path, condition));
            self.scope.flow.path = Some(path);
        }
        self.statements(statements);
        self.scope.unbind(mark);
        self.scope.flow.path = outside;
    }

    /// Lowers a loop with state.
    fn repeat(&mut self, of: Loop, span: Span) {
        let from = self.origins.mark();
        let (start, end) = (self.loop_bound(of.first), self.loop_end(of.end));
        let (Some(start), Some((end, last))) = (start, end) else { return };
        if self.is_too_long(start, end, "a loop ends after a known number of iterations", span) {
            return;
        }
        let (before, outside) = (self.scope.values(), self.scope.flow);
        (self.scope.flow.path, self.scope.flow.in_loop) = (None, true);
        let mark = self.scope.bindings.len();
        for number in start..end {
            if self.reports.stopped {
                break;
            }
            let number = self.constant(number as f32);
            self.scope.bind(of.variable, Value::scalar(number));
            if let Some(last) = last {
                let is_past = self.graph.binary(Op::LessEqual, last, number);
                self.end_where(is_past);
            }
            if let Some(condition) = of.condition {
                let Some(goes_on) = self.condition(condition, "`while`", span) else { break };
                let is_over = self.graph.not(goes_on);
                self.end_where(is_over);
            }
            self.statements(of.body);
            self.scope.unbind(mark);
            let ended = self.scope.flow.ended.and_then(|ended| self.graph.as_constant(ended));
            if ended.is_some_and(|ended| ended != 0.0) {
                break;
            }
        }
        self.scope.unbind(mark);
        self.scope.flow = outside;
        let by = self.origins.since(from);
        let after = self.scope.values();
        self.scope.change(&before, &after, by);
    }

    fn end_where(&mut self, condition: NodeId) {
        let ended = self.scope.flow.ended;
        self.scope.flow.ended = Some(ended.map_or(condition, |ended| self.graph.max(ended, condition)));
    }

    /// Evaluates a loop's end. If it depends on parameters, returns the largest end and the node of the actual end.
    fn loop_end(&mut self, id: ExprId) -> Option<(i64, Option<NodeId>)> {
        let span = self.ast.span(id);
        let end = match self.expr_below(id, span) {
            Value::Vector(vector) if vector.len() == 1 => vector.first(),
            Value::Unknown => return None,
            other => {
                let message = format!("a loop's end must be a number, but this is {}", other.described());
                self.reports.add(Diagnostic::new(span, message));
                return None;
            }
        };
        if let Some(known) = self.known(end) {
            return self.whole_bound(known, span).map(|known| (known, None));
        }
        let ranges = self.declared.params.iter().map(|param| (param.min, param.max));
        let most = self.graph.bounds_of(end, &FrameInputs::any(ranges)).ok()?.hi;
        if most > self.limits.scene_loop_max as f32 || !most.is_finite() {
            let wrong = Diagnostic::unsupported(span, "the largest number of iterations is not known");
            let hint = "let a loop's end depend on parameters only, as in `param rounds = 8 in 1 .. 12`, or clamp it";
            self.reports.add(wrong.hint(hint));
            return None;
        }
        Some((most.ceil() as i64, Some(end)))
    }

    /// Evaluates a condition; `None` if a mistake was reported. `what` names the statement in the message.
    pub(super) fn condition(&mut self, id: ExprId, what: &str, span: Span) -> Option<NodeId> {
        match self.expr_below(id, span) {
            Value::Bool(part) => Some(part),
            Value::Unknown => None,
            other => {
                let message = format!("{what} needs a condition, but this is {}", other.described());
                let wrong = Diagnostic::new(self.ast.span(id), message);
                self.reports.add(wrong.hint("compare it, as in `a > 0`"));
                None
            }
        }
    }
}
