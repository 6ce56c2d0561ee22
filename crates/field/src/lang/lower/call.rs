//! Lowers calls of functions: built-in, from the library or from the scene. Folds combine any number of arguments.

use super::super::ast::{Expr, ExprId, Function, Type};
use super::super::builtin::{BUILTINS, BuiltinRow, uses};
use super::super::diagnostic::Diagnostic;
use super::super::glsl_names;
use super::super::library;
use super::super::source::Span;
use super::super::suggest;
use super::super::symbol::Symbol;
use super::super::value::{Value, Vector};
use super::foreign::ForeignCall;
use super::lowering::Lowering;
use crate::graph::NodeId;

#[derive(Clone, Copy)]
enum Callee {
    /// The index of a function of the scene.
    Scene(usize),
    Library(&'static Function),
    Builtin(&'static BuiltinRow),
}

/// A call with the arguments from `mark` on.
#[derive(Clone, Copy)]
pub(super) struct Call {
    pub name: Symbol,
    pub mark: usize,
    /// Index of the arguments' expressions in the tree's `extra`; `None` if they have no expressions.
    pub first: Option<u32>,
    pub span: Span,
}

impl Lowering<'_> {
    fn callee(&self, symbol: Symbol) -> Option<Callee> {
        let own = self.declared.globals.get(symbol.index()).map_or(0, |global| global.function);
        if own > 0 && self.reports.library_call.is_none() {
            return Some(Callee::Scene(own as usize - 1));
        }
        let shared = library::function(symbol).map(Callee::Library);
        shared.or_else(|| library::builtin(symbol).map(Callee::Builtin))
    }

    pub(super) fn call(&mut self, name: Symbol, first: u32, count: u32, span: Span) -> Value {
        let callee = self.callee(name);
        let fold = match callee {
            Some(Callee::Library(_) | Callee::Builtin(_)) => {
                self.library.folds.get(name.index()).copied().unwrap_or(0)
            }
            _ => 0,
        };
        let call = Call { name, mark: self.arguments.len(), first: Some(first), span };
        for index in 0..count {
            self.argument(ExprId(self.ast.extra(first + index)), fold > 0, name);
        }
        let is_foreign = !matches!(callee, Some(Callee::Scene(_)))
            && self.reports.library_call.is_none()
            && self.declared.foreign.is_function(name);
        let foreign = if is_foreign { ForeignCall { outer: self, call }.value() } else { None };
        let value = match (foreign, callee) {
            (Some(value), _) => value,
            (None, None) if is_foreign => ForeignCall { outer: self, call }.misfit(),
            (None, None) => self.unknown_function(name, span),
            (None, Some(callee)) if fold > 0 => {
                let has_loop = count as usize >= usize::from(fold);
                self.fold(callee, call, usize::from(fold) - 1, has_loop)
            }
            (None, Some(callee)) => self.apply(callee, call),
        };
        self.arguments.truncate(call.mark);
        value
    }

    /// Pushes an argument's value or, for a loop, the values of all iterations.
    fn argument(&mut self, id: ExprId, takes_loops: bool, name: Symbol) {
        let Expr::For(index) = self.ast.expr(id) else {
            let value = self.expr(id);
            self.arguments.push(value);
            return;
        };
        let span = self.ast.span(id);
        if !takes_loops {
            let message = format!("`{}` cannot take a loop as an argument", self.name(name));
            let hint = "loops are allowed in `union`, `intersect`, `subtract`, their `smooth_` forms, \
                        `chamfer_union`, `min`, `max`, `sum` and `product`";
            let value = self.reports.add(Diagnostic::unsupported(span, message).hint(hint));
            self.arguments.push(value);
            return;
        }
        let entry = |at: u32| self.ast.extra(index + at);
        let (variable, body) = (Symbol(entry(0)), ExprId(entry(3)));
        let (start, end) = (ExprId(entry(1)), ExprId(entry(2)));
        let (Some(start), Some(end)) = (self.loop_bound(start), self.loop_bound(end)) else {
            self.arguments.push(Value::Unknown);
            return;
        };
        let hint = match self.inputs.allowed {
            allowed if allowed & uses::POINT != 0 => "repeat space instead: `repeat(p, size)`",
            allowed if allowed & uses::INDEX != 0 => {
                "each point of a swarm has its own `index`: use it instead of a loop"
            }
            _ => "use fewer iterations",
        };
        if self.reports.loop_too_long(end - start, self.limits, hint, span) {
            self.arguments.push(Value::Unknown);
            return;
        }
        if !self.descend(span) {
            return;
        }
        let mark = self.scope.bindings.len();
        for number in start..end {
            if self.reports.stopped {
                break;
            }
            let value = Value::scalar(self.constant(number as f32));
            self.scope.bind(variable, value);
            self.argument(body, true, name);
            self.scope.unbind(mark);
        }
        self.budget.depth -= 1;
    }

    /// Evaluates a loop's bound, a constant whole number.
    pub(super) fn loop_bound(&mut self, id: ExprId) -> Option<i64> {
        let span = self.ast.span(id);
        let value = match self.expr(id) {
            Value::Unknown => return None,
            Value::Vector(vector) if vector.len() == 1 => self.known(vector.first()),
            _ => None,
        };
        let Some(value) = value else {
            let wrong = Diagnostic::unsupported(span, "a loop's bounds must be constants");
            let hint = "write whole numbers; to skip iterations use `if` in the loop";
            return self.reports.refuse(wrong.hint(hint));
        };
        self.reports.whole_bound(value, span)
    }

    /// Combines the arguments, two at a time from the left. Each call also gets the last `tail` arguments. `has_loop` is
    /// true if too few values come from a loop without iterations.
    fn fold(&mut self, callee: Callee, call: Call, tail: usize, has_loop: bool) -> Value {
        let Call { name, mark, span, .. } = call;
        let count = self.arguments.len() - mark;
        if self.arguments.iter().skip(mark).any(|value| *value == Value::Unknown) {
            return Value::Unknown;
        }
        if count <= tail && has_loop {
            return match self.name(name) {
                "sum" => Value::scalar(self.constant(0.0)),
                "product" => Value::scalar(self.constant(1.0)),
                other => self.reports.loop_without_values(other, span),
            };
        }
        if count <= tail {
            let text = self.name(name);
            let message = match tail {
                0 => format!("`{text}` needs at least one value"),
                _ => format!("`{text}` needs shapes followed by the radius of the blend"),
            };
            return self.reports.add(
                Diagnostic::new(span, message)
                    .hint(format!("it is declared as `{}`", self.signature(callee, name))),
            );
        }
        let values_end = mark + count - tail;
        let mut result = self.arguments.get(mark).copied().unwrap_or(Value::Unknown);
        for index in mark + 1..values_end {
            let Some(&value) = self.arguments.get(index) else { break };
            let pair = Call { mark: self.arguments.len(), first: None, ..call };
            self.arguments.extend([result, value]);
            self.arguments.extend_from_within(values_end..values_end + tail);
            result = self.apply(callee, pair);
            self.arguments.truncate(pair.mark);
            if self.reports.stopped {
                break;
            }
        }
        if count - tail == 1 && !matches!(result, Value::Vector(_)) {
            self.number(result, span, || format!("`{}`", self.names.name(name)));
            return Value::Unknown;
        }
        result
    }

    fn apply(&mut self, callee: Callee, call: Call) -> Value {
        let Call { name, mark, span, .. } = call;
        match callee {
            Callee::Builtin(row) => self.builtin(row, call),
            Callee::Library(function) => {
                if !self.arguments_fit(function, callee, call) {
                    return Value::Unknown;
                }
                self.put_in_library(function, mark, (name, span))
            }
            Callee::Scene(index) => {
                let Some(called) = self.declared.functions.get_mut(index) else { return Value::Unknown };
                let function = called.function;
                called.called = true;
                if called.open {
                    return self.reports.circle(name, span);
                }
                called.open = true;
                let mut value = Value::Unknown;
                if self.arguments_fit(function, callee, call) {
                    self.reports.calls.push((name, span));
                    value = self.put_in(function, mark);
                    self.reports.calls.pop();
                }
                if let Some(called) = self.declared.functions.get_mut(index) {
                    called.open = false;
                }
                value
            }
        }
    }

    /// Expands a function's body with the arguments from `mark` on. `self.ast` must be the tree of the body.
    pub(super) fn put_in(&mut self, function: &Function, mark: usize) -> Value {
        let outside = std::mem::replace(&mut self.scope.frame, self.scope.bindings.len());
        for (index, parameter) in function.parameters.iter().enumerate() {
            let value = self.arguments.get(mark + index).copied().unwrap_or(Value::Unknown);
            self.scope.bind(parameter.name.symbol, value);
        }
        self.scope.enters_body = matches!(self.ast.expr(function.body), Expr::Block(..));
        let value = self.expr(function.body);
        self.scope.unbind(self.scope.frame);
        self.scope.frame = outside;
        value
    }

    /// Calls a library function that computes the sky's colour from a direction.
    pub(super) fn library_color(&mut self, name: &str) -> Option<[NodeId; 3]> {
        let direction = self.names.get("direction")?;
        let color = self.within(uses::DIRECTION | uses::FRAME, "the sky", |this| {
            let argument = this.lookup(direction, Span::default());
            this.library_value(name, &[argument])
        })?;
        Some([color.part(0), color.part(1), color.part(2)])
    }

    pub(super) fn library_number(&mut self, name: &str, arguments: &[NodeId]) -> Option<NodeId> {
        let arguments: Vec<Value> = arguments.iter().map(|&argument| Value::scalar(argument)).collect();
        self.library_value(name, &arguments).map(Vector::first)
    }

    /// Expands a library function for a default or a field, not for a call in the scene's text.
    fn library_value(&mut self, name: &str, arguments: &[Value]) -> Option<Vector> {
        let symbol = self.names.get(name)?;
        let function = library::function(symbol)?;
        let mark = self.arguments.len();
        self.arguments.extend_from_slice(arguments);
        let value = self.put_in_library(function, mark, (symbol, Span::default()));
        self.arguments.truncate(mark);
        match value {
            Value::Vector(vector) => Some(vector),
            _ => None,
        }
    }

    /// Expands the body of a library function for this call.
    fn put_in_library(&mut self, function: &Function, mark: usize, call: (Symbol, Span)) -> Value {
        let outside = (self.ast, self.reports.library_call);
        (self.ast, self.reports.library_call) = (&self.library.ast, outside.1.or(Some(call)));
        let value = self.put_in(function, mark);
        (self.ast, self.reports.library_call) = outside;
        value
    }

    /// Reports arguments whose count or types do not fit. Widens a number where a vector is expected.
    fn arguments_fit(&mut self, function: &Function, callee: Callee, call: Call) -> bool {
        let count = self.arguments.len() - call.mark;
        let takes = function.parameters.len();
        if count != takes {
            let name = function.name.symbol;
            let hint = format!("it is declared as `{}`", self.signature(callee, name));
            self.reports.count_message(name, count, (takes, takes), hint, call.span);
            return false;
        }
        let mut fit = true;
        for (index, parameter) in function.parameters.iter().enumerate() {
            let Some(of) = parameter.of else { continue };
            let Some(value) = self.arguments.get_mut(call.mark + index) else { continue };
            let wide = match (of, *value) {
                (_, Value::Unknown) => continue,
                (Type::Vec2, Value::Vector(vector)) => vector.widened(2),
                (Type::Vec3, Value::Vector(vector)) => vector.widened(3),
                (Type::Vec4, Value::Vector(vector)) => vector.widened(4),
                _ => None,
            };
            if let Some(wide) = wide {
                *value = Value::Vector(wide);
                continue;
            }
            let value = *value;
            if self.scope.composites.type_of(value) != Some(of) {
                let (wanted, found) = (of.described(), value.described());
                let parameter = self.name(parameter.name.symbol);
                let message = format!(
                    "`{}` takes {wanted} as `{parameter}`, not {found}",
                    self.name(function.name.symbol)
                );
                let hint = format!("it is declared as `{}`", self.signature(callee, function.name.symbol));
                self.reports.add(Diagnostic::new(self.argument_span(call, index), message).hint(hint));
                fit = false;
            }
        }
        fit
    }

    /// Returns the location of an argument, or of the call if the argument has no location.
    pub(super) fn argument_span(&self, call: Call, index: usize) -> Span {
        let known = call.first.map(|first| self.ast.span(ExprId(self.ast.extra(first + index as u32))));
        known.filter(|span| *span != Span::default()).unwrap_or(call.span)
    }

    #[cold]
    fn signature(&self, callee: Callee, name: Symbol) -> String {
        let parameters = match callee {
            Callee::Scene(index) => {
                self.declared.functions.get(index).map(|called| self.parameters(&called.function.parameters))
            }
            Callee::Library(function) => Some(self.parameters(&function.parameters)),
            Callee::Builtin(row) => return row.signature().to_owned(),
        };
        format!("{}({})", self.name(name), parameters.unwrap_or_default())
    }

    #[cold]
    fn unknown_function(&mut self, symbol: Symbol, span: Span) -> Value {
        let is_broken = self.declared.globals.get(symbol.index()).is_some_and(|global| global.broken);
        if is_broken || self.declared.foreign.is_broken {
            return Value::Unknown;
        }
        let name = self.name(symbol);
        let short: String = name.chars().take(60).collect();
        let place = Span::new(span.start, span.start + name.len() as u32);
        let unknown = Diagnostic::new(place, format!("there is no function `{short}`"));
        if let Some(hint) = glsl_names::function(name) {
            return self.reports.add(unknown.hint(hint));
        }
        let renamed = glsl_names::without_prefix(name).and_then(|own| self.names.get(&own));
        if let Some((own, callee)) = renamed.and_then(|own| self.callee(own).map(|callee| (own, callee))) {
            let hint = format!("use `{}`", self.signature(callee, own));
            return self.reports.add(unknown.hint(hint));
        }
        let own = self.declared.functions.iter().map(|called| self.names.name(called.function.name.symbol));
        let shared = self.library.functions.iter().map(|function| self.names.name(function.name.symbol));
        let foreign: Vec<&str> = self.declared.foreign.names().map(|name| self.names.name(name)).collect();
        let own = own.chain(foreign.iter().copied());
        let near = suggest::nearest(name, own.chain(shared).chain(BUILTINS.iter().map(|row| row.name)));
        let unknown = match near {
            None if self.scope.local(symbol).is_some() || library::input(symbol).is_some() => {
                unknown.hint(format!("`{name}` is a value; to multiply write `{name} * (…)`"))
            }
            _ => unknown.did_you_mean(near),
        };
        self.reports.add(unknown)
    }
}
