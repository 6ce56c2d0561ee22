//! The values of expressions: operators, swizzles, choices, blocks and names.

use super::super::ast::{BinaryOp, Expr, ExprId};
use super::super::builtin::INPUTS;
use super::super::diagnostic::Diagnostic;
use super::super::glsl_names;
use super::super::library;
use super::super::source::Span;
use super::super::suggest;
use super::super::symbol::Symbol;
use super::super::value::{Value, Vector};
use super::declared::GlobalValue;
use super::lowering::Lowering;
use super::statements::Choice;
use crate::graph::{Graph, NodeId, Op};

impl Lowering<'_> {
    /// Lowers an expression. Chains of operators and swizzles are followed in a loop, so they need no recursion.
    pub(super) fn expr(&mut self, id: ExprId) -> Value {
        let base = self.spine.len();
        let from = self.origins.mark();
        let mut inner = id;
        let mut value = loop {
            let span = self.ast.span(inner);
            if !self.step(span) {
                break Value::Unknown;
            }
            let expr = self.ast.expr(inner);
            if self.reports.library_call.is_none() && !matches!(expr, Expr::Name(_) | Expr::Number(_)) {
                self.origins.begins(span);
            }
            match expr {
                Expr::Binary(_, left, _) => {
                    self.spine.push(inner);
                    inner = left;
                }
                Expr::Swizzle(of, name) => {
                    if let Some(value) = self.part_input(of, name, span) {
                        break value;
                    }
                    self.spine.push(inner);
                    inner = of;
                }
                Expr::Number(value) => break self.written_number(value, inner),
                Expr::Name(symbol) => break self.lookup(symbol, span),
                Expr::Text(symbol) => break Value::Text(symbol),
                Expr::Bool(value) => break Value::Bool(self.graph.constant(f32::from(u8::from(value)))),
                Expr::Error => break Value::Unknown,
                nested => break self.nested(nested, span),
            }
        };
        self.record_origin(value, inner, from);
        while self.spine.len() > base {
            let Some(outer) = self.spine.pop() else { break };
            let span = self.ast.span(outer);
            value = match self.ast.expr(outer) {
                Expr::Binary(op, _, right) => {
                    let right = self.expr_below(right, span);
                    self.binary(op, value, right, span)
                }
                Expr::Swizzle(_, components) => self.swizzle(value, components, span),
                _ => Value::Unknown,
            };
            self.record_origin(value, outer, from);
        }
        value
    }

    /// If the value is a number, records this expression and the notes since the mark `from` as its origin.
    #[inline]
    fn record_origin(&mut self, value: Value, id: ExprId, from: u32) {
        if self.reports.library_call.is_none()
            && let Value::Vector(vector) = value
            && vector.len() == 1
        {
            self.origins.makes(vector.first(), self.ast.span(id), from);
        }
    }

    pub(super) fn expr_below(&mut self, id: ExprId, span: Span) -> Value {
        match self.ast.expr(id) {
            Expr::Number(value) => return self.written_number(value, id),
            Expr::Name(symbol) => {
                let span = self.ast.span(id);
                return if self.step(span) { self.lookup(symbol, span) } else { Value::Unknown };
            }
            _ => {}
        }
        if !self.descend(span) {
            return Value::Unknown;
        }
        let value = self.expr(id);
        self.budget.depth -= 1;
        value
    }

    /// Goes one level deeper. Returns false at the limit; otherwise the caller goes back.
    #[inline]
    pub(super) fn descend(&mut self, span: Span) -> bool {
        let may_descend = self.budget.depth < self.limits.scene_depth_max;
        if may_descend {
            self.budget.depth += 1;
        } else if !self.reports.stopped {
            self.reports.too_deep(self.limits.scene_depth_max, span);
        }
        may_descend
    }

    fn nested(&mut self, expr: Expr, span: Span) -> Value {
        match expr {
            Expr::Negate(inner) => {
                let value = self.expr_below(inner, span);
                if let Value::Matrix(_) = value {
                    let minus = Value::scalar(self.graph.constant(-1.0));
                    return self.matrix_binary(BinaryOp::Multiply, value, minus, span);
                }
                match self.number(value, span, || "`-`".to_owned()) {
                    Some(vector) => Value::Vector(vector.map(|part| self.graph.neg(part))),
                    None => Value::Unknown,
                }
            }
            Expr::Not(inner) => match self.expr_below(inner, span) {
                Value::Bool(part) => Value::Bool(self.graph.not(part)),
                Value::Unknown => Value::Unknown,
                other => {
                    let message = format!("`!` negates a condition, but this is {}", other.described());
                    self.reports.add(Diagnostic::new(span, message).hint("compare it, as in `a > 0`"))
                }
            },
            Expr::If(condition, yes, no) => self.choice(condition, yes, no, span),
            Expr::PartBand(part, index) => self.part_band(part, index, span),
            Expr::Block(first, count, result) => self.block(first, count, result, span),
            Expr::Call(name, first, count) => {
                if !self.descend(span) {
                    return Value::Unknown;
                }
                let value = self.call(name, first, count, span);
                self.budget.depth -= 1;
                value
            }
            Expr::For(_) => {
                let message = "a loop has many values, but a single one is needed here";
                let hint = "combine them: `union(for …)`, `sum(for …)`, `min(for …)`, `max(for …)`";
                self.reports.add(Diagnostic::unsupported(span, message).hint(hint))
            }
            Expr::Record(first, count) => self.record(first, count, span),
            _ => Value::Unknown,
        }
    }

    fn choice(&mut self, condition: ExprId, yes: ExprId, no: ExprId, span: Span) -> Value {
        let part = self.condition(condition, "`if`", span);
        // For a constant condition only one side is lowered, so that iterations of a loop can use different sides.
        if let Some(value) = part.and_then(|part| self.graph.as_constant(part)) {
            return self.expr_below(if value != 0.0 { yes } else { no }, span);
        }
        let (yes, no) = (self.expr_below(yes, span), self.expr_below(no, span));
        match part {
            Some(condition) => {
                Choice { lowering: self, condition, what: "both results of `if`", span }.between(yes, no)
            }
            None => Value::Unknown,
        }
    }

    /// Returns the vector in a value. Reports values that are not numbers or vectors; `what` names the operation in the
    /// message.
    pub(super) fn number(
        &mut self,
        value: Value,
        span: Span,
        what: impl FnOnce() -> String,
    ) -> Option<Vector> {
        match value {
            Value::Vector(vector) => Some(vector),
            Value::Unknown => None,
            other => {
                let message =
                    format!("{} works on numbers and vectors, but this is {}", what(), other.described());
                let wrong = Diagnostic::new(span, message);
                self.reports.refuse(match other {
                    Value::Bool(_) => wrong.hint("a condition becomes a number with `if a then 1 else 0`"),
                    Value::Record(record) => {
                        wrong.hint(self.scope.composites.fields_in_words(record, self.names))
                    }
                    _ => wrong,
                })
            }
        }
    }

    #[inline]
    pub(super) fn binary(&mut self, op: BinaryOp, left: Value, right: Value, span: Span) -> Value {
        let (Value::Vector(a), Value::Vector(b)) = (left, right) else {
            return self.binary_of_others(op, left, right, span);
        };
        if a.len() != b.len() && a.len() != 1 && b.len() != 1 {
            return self.reports.sizes_differ(&format!("`{}`", op.sign()), left, right, span);
        }
        let operator = match op {
            BinaryOp::Add => Op::Add,
            BinaryOp::Subtract => Op::Sub,
            BinaryOp::Multiply => Op::Mul,
            BinaryOp::Divide | BinaryOp::Modulo => {
                let zero = b.parts().iter().any(|&part| self.known(part) == Some(0.0));
                if zero && self.reports.library_call.is_none() {
                    let wrong = Diagnostic::new(span, "this divides by zero");
                    let hint =
                        "write another divisor; in a loop use `if`, as in `if i == 0 then 0 else 1 / i`";
                    return self.reports.add(wrong.hint(hint));
                }
                if op == BinaryOp::Divide { Op::Div } else { Op::Mod }
            }
            BinaryOp::Power => {
                let b = self.with_known(b);
                return zip(&mut self.graph, a, b, |graph, a, b| graph.pow(a, b));
            }
            _ => return self.comparison(op, a, b, span),
        };
        zip(&mut self.graph, a, b, |graph, a, b| graph.binary(operator, a, b))
    }

    fn comparison(&mut self, op: BinaryOp, a: Vector, b: Vector, span: Span) -> Value {
        if matches!(op, BinaryOp::And | BinaryOp::Or) {
            let message = format!("`{}` joins conditions, but these are numbers", op.sign());
            let hint = "compare them, as in `a > 0 && b > 0`";
            return self.reports.add(Diagnostic::new(span, message).hint(hint));
        }
        if a.len() != 1 || b.len() != 1 {
            let message = format!("`{}` compares numbers, not vectors", op.sign());
            return self.reports.add(Diagnostic::new(span, message).hint("compare components or lengths"));
        }
        let (a, b) = (a.first(), b.first());
        let graph = &mut self.graph;
        Value::Bool(match op {
            BinaryOp::Less => graph.binary(Op::Less, a, b),
            BinaryOp::LessEqual => graph.binary(Op::LessEqual, a, b),
            BinaryOp::Greater => graph.binary(Op::Less, b, a),
            BinaryOp::GreaterEqual => graph.binary(Op::LessEqual, b, a),
            BinaryOp::Equal => graph.binary(Op::Equal, a, b),
            _ => {
                let equal = graph.binary(Op::Equal, a, b);
                graph.not(equal)
            }
        })
    }

    #[cold]
    fn binary_of_others(&mut self, op: BinaryOp, left: Value, right: Value, span: Span) -> Value {
        match (op, left, right) {
            (_, Value::Unknown, _) | (_, _, Value::Unknown) => Value::Unknown,
            (_, Value::Matrix(_), _) | (_, _, Value::Matrix(_)) => self.matrix_binary(op, left, right, span),
            (BinaryOp::And, Value::Bool(a), Value::Bool(b)) => Value::Bool(self.graph.min(a, b)),
            (BinaryOp::Or, Value::Bool(a), Value::Bool(b)) => Value::Bool(self.graph.max(a, b)),
            (BinaryOp::Equal, Value::Bool(a), Value::Bool(b)) => {
                Value::Bool(self.graph.binary(Op::Equal, a, b))
            }
            (BinaryOp::NotEqual, Value::Bool(a), Value::Bool(b)) => {
                let equal = self.graph.binary(Op::Equal, a, b);
                Value::Bool(self.graph.not(equal))
            }
            _ => {
                let (a, b) = (left.described(), right.described());
                let message = format!("`{}` cannot combine {a} and {b}", op.sign());
                let hint = match op {
                    BinaryOp::Less | BinaryOp::LessEqual | BinaryOp::Greater | BinaryOp::GreaterEqual => {
                        "join two comparisons with `&&`: `a < b && b < c`"
                    }
                    BinaryOp::And | BinaryOp::Or => "it joins conditions, as in `a > 0 && b > 0`",
                    _ => "a condition becomes a number with `if a then 1 else 0`",
                };
                self.reports.add(Diagnostic::new(span, message).hint(hint))
            }
        }
    }

    pub(super) fn swizzle(&mut self, value: Value, components: Symbol, span: Span) -> Value {
        let vector = match value {
            Value::Vector(vector) => vector,
            Value::Unknown => return Value::Unknown,
            Value::Record(record) => return self.record_field(record, components, span),
            other => {
                let message = format!("{} has no components", other.described());
                return self.reports.add(Diagnostic::new(span, message));
            }
        };
        let text = self.name(components);
        if !is_swizzle(text) {
            let message =
                format!("`.{}` does not name components", text.chars().take(20).collect::<String>());
            let hint = "write up to four letters of `xyzw` or of `rgba`, as in `.xz`";
            return self.reports.add(Diagnostic::new(span, message).hint(hint));
        }
        let mut parts = [vector.first(); 4];
        for (part, byte) in parts.iter_mut().zip(text.bytes()) {
            let index = component(byte).map_or(0, |(_, index)| index);
            if index >= vector.len() {
                let message = format!("{} has no component `{}`", value.described(), char::from(byte));
                return self.reports.add(Diagnostic::new(span, message));
            }
            *part = vector.part(index);
        }
        Value::of(parts.get(..text.len()).unwrap_or(&parts))
    }

    #[cold]
    pub(super) fn unknown_name(&mut self, symbol: Symbol, span: Span) -> Value {
        let name = self.name(symbol);
        let short: String = name.chars().take(60).collect();
        let unknown = Diagnostic::new(span, format!("there is no `{short}` here"));
        if self.is_function(symbol) {
            let hint = format!("`{name}` is a function: call it, as in `{name}(…)`");
            return self.reports.add(unknown.hint(hint));
        }
        if self.part(symbol).is_some() {
            let hint =
                format!("`{name}` is a part of the song: read one of its inputs, as in `{name}.volume`");
            return self.reports.add(unknown.hint(hint));
        }
        let globals = self.declared.globals.iter().enumerate();
        let globals = globals.filter(|(_, global)| !matches!(global.value, GlobalValue::None));
        let globals = globals.map(|(index, _)| self.names.name(Symbol(index as u32)));
        let locals =
            self.scope.bindings.iter().skip(self.scope.frame).map(|binding| self.names.name(binding.symbol));
        let own = locals.chain(globals);
        let unknown = match glsl_names::value(name) {
            // A similar name of the scene is more likely than an input of GLSL.
            Some(hint) => unknown.hint(hint).did_you_mean(suggest::nearest(name, own)),
            None => {
                unknown.did_you_mean(suggest::nearest(name, own.chain(INPUTS.iter().map(|row| row.name))))
            }
        };
        self.reports.add(unknown)
    }

    pub(super) fn is_function(&self, symbol: Symbol) -> bool {
        let own = self.declared.globals.get(symbol.index()).is_some_and(|global| global.function > 0);
        let shared = library::function(symbol).is_some() || library::builtin(symbol).is_some();
        own || shared || self.declared.foreign.is_function(symbol)
    }
}

/// True for up to four letters of one set of components.
pub(super) fn is_swizzle(text: &str) -> bool {
    let set = text.bytes().next().and_then(component).map(|(set, _)| set);
    set.is_some() && text.len() <= 4 && text.bytes().all(|byte| component(byte).map(|(set, _)| set) == set)
}

/// Returns the set (`xyzw`, `rgba` or `stpq`) that contains a component's letter, and the letter's index in the set.
pub(super) fn component(letter: u8) -> Option<(usize, usize)> {
    let sets = [*b"xyzw", *b"rgba", *b"stpq"];
    let index_in = |set: &[u8; 4]| set.iter().position(|own| *own == letter);
    sets.iter().enumerate().find_map(|(number, set)| Some((number, index_in(set)?)))
}

/// Applies a function of two numbers to each pair of components. The sizes must fit.
pub(super) fn zip(
    graph: &mut Graph,
    a: Vector,
    b: Vector,
    mut f: impl FnMut(&mut Graph, NodeId, NodeId) -> NodeId,
) -> Value {
    a.zip(b, |a, b| f(graph, a, b)).map_or(Value::Unknown, Value::Vector)
}
