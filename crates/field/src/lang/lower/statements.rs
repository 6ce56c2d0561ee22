//! Lowers blocks and their statements. Loops are unrolled: a name that a loop changes has one value per iteration.
//!
//! Both sides of an `if` are lowered, and each name that they change becomes a choice between its two values. An early
//! end of a loop is a condition as well: from there on, assignments keep the old value where the condition holds.

use super::super::ast::{Assignment, Expr, ExprId, Loop, Statement, Statements, When};
use super::super::diagnostic::Diagnostic;
use super::super::library;
use super::super::source::Span;
use super::super::symbol::Symbol;
use super::super::value::Value;
use super::builtins::Matrices;
use super::expr::{component, zip};
use super::lowering::Lowering;
use crate::graph::{Interval, NodeId, Op};

/// Lowers the statements of one block.
struct BlockLowering<'l, 'a> {
    outer: &'l mut Lowering<'a>,
    /// Index of the first binding that the block may change. A block that is a value changes only its own names,
    /// because both sides of a choice are lowered.
    floor: usize,
    flow: Flow,
}

/// Where the current statement runs, within the innermost loop. Without a node, the condition is a constant.
#[derive(Debug, Clone, Copy, Default)]
struct Flow {
    /// The condition of all `if`s around the statement; without a node, true.
    path: Option<NodeId>,
    /// The condition that the loop has ended early; without a node, false.
    ended: Option<NodeId>,
    in_loop: bool,
}

impl Lowering<'_> {
    pub(super) fn block(&mut self, first: u32, count: u32, result: ExprId, span: Span) -> Value {
        let mark = self.scope.bindings.len();
        let is_body = std::mem::take(&mut self.scope.enters_body);
        let floor = if is_body { self.scope.frame } else { mark };
        let mut block = BlockLowering { outer: self, floor, flow: Flow::default() };
        block.statements(Statements { first, count });
        let value = self.expr_below(result, span);
        self.scope.unbind(mark);
        value
    }

    /// Evaluates a condition; `None` if a mistake was reported. `what` names the statement in the message.
    pub(super) fn condition(&mut self, id: ExprId, what: &str, span: Span) -> Option<NodeId> {
        match self.expr_below(id, span) {
            Value::Bool(part) => Some(part),
            Value::Unknown => None,
            other => {
                let message = format!("{what} needs a condition, but this is {}", other.described());
                let wrong = Diagnostic::new(self.ast.span(id), message);
                self.reports.refuse(wrong.hint("compare it, as in `a > 0`"))
            }
        }
    }
}

impl BlockLowering<'_, '_> {
    /// Lowers statements; stops after a `break` without a condition.
    fn statements(&mut self, Statements { first, count }: Statements) {
        for index in 0..count {
            let id = ExprId(self.outer.ast.extra(first + index));
            let span = self.outer.ast.span(id);
            if self.has_ended() || !self.outer.step(span) || !self.outer.descend(span) {
                return;
            }
            self.statement(id, span);
            self.outer.budget.depth -= 1;
        }
    }

    fn statement(&mut self, id: ExprId, span: Span) {
        match self.outer.ast.expr(id) {
            Expr::Let(symbol, value) => {
                let from = self.outer.origins.mark();
                let value = self.outer.expr_below(value, span);
                let by = self.outer.origins.since(from);
                self.outer.scope.bind_made(symbol, value, by);
            }
            Expr::Statement(index) => match self.outer.ast.statement(index) {
                Some(Statement::Assign(assignment)) => self.assign(assignment, span),
                Some(Statement::Loop(of)) => self.repeat(of, span),
                Some(Statement::When(when)) => self.when(when, span),
                None => {}
            },
            Expr::Break => {
                let Flow { path, in_loop, .. } = self.flow;
                if !in_loop {
                    let message = "there is no loop here that `break` could end";
                    let hint = "write it among the statements of `for i in 0..8 { … }`";
                    self.outer.reports.add(Diagnostic::new(span, message).hint(hint));
                    return;
                }
                let now = path.unwrap_or_else(|| self.outer.constant(1.0));
                self.end_where(now);
            }
            _ => {}
        }
    }

    fn assign(&mut self, assignment: Assignment, span: Span) {
        let Assignment { name, components, op, value } = assignment;
        let from = self.outer.origins.mark();
        let mut new = self.outer.expr_below(value, span);
        let Some((old, by)) = self.outer.scope.local(name) else {
            self.unknown_target(name, span);
            return;
        };
        self.outer.origins.uses(by);
        if let Some(op) = op {
            let part = components.map_or(old, |components| self.outer.swizzle(old, components, span));
            new = self.outer.binary(op, part, new, span);
        }
        new = match components {
            Some(components) => self.with_components(old, components, new, span),
            None => self.of_same_type(name, old, new, span),
        };
        if let Some(ended) = self.flow.ended {
            new = Choice { lowering: self.outer, condition: ended, what: "both values", span }
                .between(old, new);
        }
        let by = self.outer.origins.since(from);
        if !self.outer.scope.assign(self.floor, name, new, by) {
            let text = self.outer.name(name);
            let message =
                format!("`{text}` belongs to an outer block, which a value in braces cannot change");
            let hint = format!("choose between values: `{text} = if a then b else c`");
            self.outer.reports.add(Diagnostic::unsupported(span, message).hint(hint));
        }
    }

    #[cold]
    fn unknown_target(&mut self, name: Symbol, span: Span) {
        let text = self.outer.name(name);
        let place = Span::new(span.start, span.start + text.len() as u32);
        let (message, hint) = match library::input(name) {
            Some(_) => (
                format!("`{text}` is an input, which has the same value everywhere in the text"),
                format!("make a copy first: `let {text} = {text}`"),
            ),
            None => (
                format!("a block declares its names with `let`, but `{text}` is not declared"),
                format!("write `let {text} = …`"),
            ),
        };
        self.outer.reports.add(Diagnostic::new(place, message).hint(hint));
        // Report the name once.
        self.outer.scope.bind(name, Value::Unknown);
    }

    /// Returns `new` as a value of the type of `old`. A number is repeated where a vector is expected.
    fn of_same_type(&mut self, name: Symbol, old: Value, new: Value, span: Span) -> Value {
        let types = &self.outer.scope.composites;
        match (old, new) {
            (Value::Unknown, _) | (_, Value::Unknown) => Value::Unknown,
            (Value::Vector(a), Value::Vector(b)) if b.len() == 1 => {
                b.widened(a.len()).map_or(Value::Unknown, Value::Vector)
            }
            (Value::Record(_), Value::Record(_)) => new,
            _ if types.type_of(old) == types.type_of(new) => new,
            _ => {
                let text = self.outer.name(name);
                let message =
                    format!("`{text}` is {}, so it cannot become {}", old.described(), new.described());
                let wrong = Diagnostic::new(span, message);
                let hint = match new {
                    Value::Vector(vector) => format!("declare it as `let {text} = vec{}(0)`", vector.len()),
                    _ => "give the new value another name".to_owned(),
                };
                self.outer.reports.add(wrong.hint(hint))
            }
        }
    }

    /// Returns the vector `old` with the numbers of `new` as its named components.
    fn with_components(&mut self, old: Value, components: Symbol, new: Value, span: Span) -> Value {
        let text = self.outer.name(components);
        let (vector, parts) = match (old, new) {
            (Value::Vector(vector), Value::Vector(parts)) => (vector, parts),
            (Value::Unknown, _) | (_, Value::Unknown) => return Value::Unknown,
            (Value::Vector(_), other) => {
                let message = format!("a component is a number, not {}", other.described());
                return self.outer.reports.add(Diagnostic::new(span, message));
            }
            (other, _) => {
                let message = format!("the components of {} cannot be set", other.described());
                let hint = "set the components of a vector, as in `q.xz = …`";
                return self.outer.reports.add(Diagnostic::new(span, message).hint(hint));
            }
        };
        // Reports components that do not exist.
        if self.outer.swizzle(old, components, span) == Value::Unknown {
            return Value::Unknown;
        }
        let count = text.len();
        let Some(parts) = parts.widened(count) else {
            let message = format!("`.{text}` needs {count} numbers, but gets {}", new.described());
            return self.outer.reports.add(Diagnostic::new(span, message));
        };
        let mut result: Vec<NodeId> = vector.parts().to_vec();
        let mut is_set = [false; 4];
        for (at, byte) in text.bytes().enumerate() {
            let index = component(byte).map_or(0, |(_, index)| index);
            if let (Some(slot), Some(set)) = (result.get_mut(index), is_set.get_mut(index)) {
                if std::mem::replace(set, true) {
                    let message = format!("`.{text}` sets the component `{}` twice", char::from(byte));
                    return self.outer.reports.add(Diagnostic::new(span, message));
                }
                *slot = parts.part(at);
            }
        }
        Value::of(&result)
    }

    /// Lowers `if condition { … } else { … }`.
    fn when(&mut self, When { condition, yes, no }: When, span: Span) {
        let from = self.outer.origins.mark();
        let Some(condition) = self.outer.condition(condition, "`if`", span) else { return };
        if let Some(known) = self.outer.graph.as_constant(condition) {
            self.branch(if known != 0.0 { yes } else { no }, None);
            return;
        }
        let before = self.outer.scope.values(self.floor);
        self.branch(yes, Some(condition));
        let after_yes = self.outer.scope.values(self.floor);
        self.outer.scope.put_back(self.floor, &before);
        let otherwise = self.outer.graph.not(condition);
        self.branch(no, Some(otherwise));
        let after_no = self.outer.scope.values(self.floor);
        let mut choice = Choice { lowering: self.outer, condition, what: "both values", span };
        let merged = after_yes.iter().zip(&after_no).map(|(yes, no)| choice.between(*yes, *no));
        let merged: Vec<Value> = merged.collect();
        let by = self.outer.origins.since(from);
        self.outer.scope.change(self.floor, &before, &merged, by);
    }

    /// Lowers statements that run only where `condition` holds.
    fn branch(&mut self, statements: Statements, condition: Option<NodeId>) {
        let (mark, outside) = (self.outer.scope.bindings.len(), self.flow.path);
        if let Some(condition) = condition {
            let path = outside.map_or(condition, |path| self.outer.graph.min(path, condition));
            self.flow.path = Some(path);
        }
        self.statements(statements);
        self.outer.scope.unbind(mark);
        self.flow.path = outside;
    }

    /// Lowers a loop with state.
    fn repeat(&mut self, of: Loop, span: Span) {
        let from = self.outer.origins.mark();
        let (start, end) = (self.outer.loop_bound(of.first), self.loop_end(of.end));
        let (Some(start), Some((end, last))) = (start, end) else { return };
        if self.outer.reports.loop_too_long(
            end - start,
            self.outer.limits,
            "a loop ends after a known number of iterations",
            span,
        ) {
            return;
        }
        let (before, outside) = (self.outer.scope.values(self.floor), self.flow);
        (self.flow.path, self.flow.in_loop) = (None, true);
        let mark = self.outer.scope.bindings.len();
        for number in start..end {
            if self.outer.reports.stopped {
                break;
            }
            let number = self.outer.constant(number as f32);
            self.outer.scope.bind(of.variable, Value::scalar(number));
            if let Some(last) = last {
                let is_past = self.outer.graph.binary(Op::LessEqual, last, number);
                self.end_where(is_past);
            }
            if let Some(condition) = of.condition {
                let Some(goes_on) = self.outer.condition(condition, "`while`", span) else { break };
                let is_over = self.outer.graph.not(goes_on);
                self.end_where(is_over);
            }
            self.statements(of.body);
            self.outer.scope.unbind(mark);
            if self.has_ended() {
                break;
            }
        }
        self.outer.scope.unbind(mark);
        self.flow = outside;
        let by = self.outer.origins.since(from);
        let after = self.outer.scope.values(self.floor);
        self.outer.scope.change(self.floor, &before, &after, by);
    }

    /// True if the loop has ended at all points.
    fn has_ended(&self) -> bool {
        let ended = self.flow.ended.and_then(|ended| self.outer.graph.as_constant(ended));
        ended.is_some_and(|ended| ended != 0.0)
    }

    fn end_where(&mut self, condition: NodeId) {
        let ended = self.flow.ended;
        self.flow.ended = Some(ended.map_or(condition, |ended| self.outer.graph.max(ended, condition)));
    }

    /// Evaluates a loop's end. If it depends on parameters, returns the largest end and the node of the actual end.
    fn loop_end(&mut self, id: ExprId) -> Option<(i64, Option<NodeId>)> {
        let span = self.outer.ast.span(id);
        let end = match self.outer.expr_below(id, span) {
            Value::Vector(vector) if vector.len() == 1 => vector.first(),
            Value::Unknown => return None,
            other => {
                let message = format!("a loop's end must be a number, but this is {}", other.described());
                return self.outer.reports.refuse(Diagnostic::new(span, message));
            }
        };
        if let Some(known) = self.outer.known(end) {
            return self.outer.reports.whole_bound(known, span).map(|known| (known, None));
        }
        let most = self.outer.graph.bounds(end, [Interval::ANY; 6], &self.outer.any_frame()).hi;
        if most > self.outer.limits.scene_loop_max as f32 || !most.is_finite() {
            let wrong = Diagnostic::unsupported(span, "the largest number of iterations is not known");
            let hint = "let a loop's end depend on parameters only, as in `param rounds = 8 in 1 .. 12`, or clamp it";
            return self.outer.reports.refuse(wrong.hint(hint));
        }
        Some((most.ceil() as i64, Some(end)))
    }
}

// Choices between two values, of which records and matrices have several numbers.

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
