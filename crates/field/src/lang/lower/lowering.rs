//! The state of lowering, and the lookup of names.

use super::super::ast::{Ast, ExprId, Name, Parameter};
use super::super::builtin::{InputValue, uses};
use super::super::changing::ChangingNumbers;
use super::super::diagnostic::{Diagnostic, Diagnostics};
use super::super::fields::Field;
use super::super::library::{self, Library};
use super::super::origins::Origins;
use super::super::source::Span;
use super::super::symbol::{Interner, Symbol};
use super::super::value::{Value, Vector};
use super::declared::{Declared, Global, GlobalValue};
use super::reports::Reports;
use super::scope::Scope;
use crate::graph::{FrameInputs, Graph, Input, NodeId, ShapeAtlas};
use crate::limits::Limits;

/// Lowers expressions to nodes of a graph. Its methods are here, in `expr.rs`, in `call.rs` and in `builtins.rs`.
pub(super) struct Lowering<'a> {
    pub graph: Graph,
    /// The tree of the current expression: the scene's or the library's.
    pub ast: &'a Ast,
    scene_ast: &'a Ast,
    pub library: &'static Library,
    pub names: &'a Interner,
    pub limits: &'a Limits,
    pub reports: Reports<'a>,
    pub declared: Declared<'a>,
    pub scope: Scope,
    pub inputs: Inputs,
    pub changing: ChangingNumbers,
    pub budget: Budget,
    /// A stack of operators and swizzles whose first operand is being lowered.
    pub spine: Vec<ExprId>,
    /// A stack of the arguments of all calls that are being lowered.
    pub arguments: Vec<Value>,
    pub origins: Origins,
}

/// The allowed inputs and the used inputs of the current section or let, as bits of [`uses`].
pub(super) struct Inputs {
    pub allowed: u16,
    pub place: &'static str,
    /// The field that is being lowered, and all fields of its section.
    pub field: Option<(&'static str, &'static [Field])>,
    pub used: u16,
}

impl Inputs {
    pub(super) fn declare(&mut self, kind: u16, symbol: Symbol, span: Span, reports: &mut Reports) {
        self.used |= kind;
        let missing = kind & !self.allowed;
        if missing != 0 {
            self.not_here(missing, symbol, span, reports);
        }
    }

    #[cold]
    fn not_here(&self, missing: u16, symbol: Symbol, span: Span, reports: &mut Reports) {
        let name = reports.names.name(symbol);
        let (field, fields) = self.field.unwrap_or_default();
        let others = fields.iter().filter(|other| missing & !other.uses == 0);
        let others: Vec<String> = others.map(|other| format!("`{}`", other.name)).collect();
        let here = if others.is_empty() { self.place.to_owned() } else { format!("`{field}`") };
        let of_swarm = fields.iter().any(|field| field.uses & uses::INDEX != 0);
        let (message, hint) = match missing {
            _ if missing & uses::POINT != 0 && of_swarm => (
                format!("the points of a swarm have numbers, so `{name}` has no value here"),
                "write a function of `index`, as in `10 * hash_3(vec3(index, 0, 0))`",
            ),
            _ if missing & uses::POINT != 0 => (
                format!("{here} is the same at all points, so `{name}` has no value here"),
                "positions are available in shapes and materials",
            ),
            _ if missing & uses::NORMAL != 0 => (
                format!("`{name}` depends on a surface's normal, which has no value in {here}"),
                "normals are available in materials and in functions that materials call",
            ),
            _ if missing & uses::DIRECTION != 0 => (
                format!("`{name}` depends on a ray's direction, which has no value in {here}"),
                "ray directions are available in the sky",
            ),
            _ if missing & uses::EYE != 0 => (
                format!("{here} cannot depend on the camera, so `{name}` has no value here"),
                "the camera's position is available in materials and the sky",
            ),
            _ if missing & uses::TEXTURE != 0 => {
                (format!("{here} cannot read images"), "images can be read in materials and the sky")
            }
            _ if missing & uses::PIXEL != 0 => (
                format!("{here} cannot depend on `{name}`, which is a place in the picture"),
                "pixels are available in the sky's colour and in `warp`; shapes and materials have the point `p`",
            ),
            _ if missing & uses::INDEX != 0 => (
                format!("{here} has no numbered points, so `{name}` has no value here"),
                "numbers of points are available in a `swarm`",
            ),
            _ if missing & uses::SCREEN != 0 => (
                format!(
                    "`{name}` depends on the picture's size or the pointer, which have no value in {here}"
                ),
                "both are available in the sky's colour and in `picture`",
            ),
            _ => (
                format!("{here} is fixed before the music plays, so `{name}` has no value here"),
                "write a number",
            ),
        };
        let hint = match others.split_last() {
            Some((last, rest)) if missing & uses::FRAME == 0 => match rest {
                [] => format!("in this block, only {last} can use it"),
                _ => format!("in this block, only {} and {last} can use it", rest.join(", ")),
            },
            _ => hint.to_owned(),
        };
        reports.add(Diagnostic::unsupported(span, message).hint(hint));
    }
}

/// The current depth and the number of steps so far. Both have limits.
#[derive(Default)]
pub(super) struct Budget {
    pub depth: usize,
    steps: usize,
}

impl Budget {
    /// Number of steps up to the limit.
    pub(super) fn left(&self, limits: &Limits) -> usize {
        limits.scene_expansion_max.saturating_sub(self.steps)
    }

    /// Counts steps that were made elsewhere.
    pub(super) fn spend(&mut self, count: usize) {
        self.steps += count;
    }
}

impl<'a> Lowering<'a> {
    pub(super) fn new(
        ast: &'a Ast,
        names: &'a Interner,
        changing: ChangingNumbers,
        limits: &'a Limits,
        diagnostics: &'a mut Diagnostics,
    ) -> Self {
        let mut graph = Graph::with_limits(limits);
        // Most expressions need one or two nodes.
        graph.reserve(2 * ast.len());
        Self {
            graph,
            ast,
            scene_ast: ast,
            library: library::library(),
            names,
            limits,
            reports: Reports { diagnostics, names, calls: Vec::new(), library_call: None, stopped: false },
            declared: Declared::new(names.len()),
            scope: Scope::new(names.len()),
            inputs: Inputs { allowed: uses::NOTHING, place: "", field: None, used: uses::NOTHING },
            changing,
            budget: Budget::default(),
            spine: Vec::new(),
            arguments: Vec::new(),
            origins: Origins::default(),
        }
    }

    pub(super) fn name(&self, symbol: Symbol) -> &'a str {
        self.names.name(symbol)
    }

    /// Counts a step. Returns false once a limit is reached; then the caller must stop.
    #[inline]
    pub(super) fn step(&mut self, span: Span) -> bool {
        self.budget.steps += 1;
        if self.budget.steps > self.limits.scene_expansion_max && !self.reports.stopped {
            let max = self.limits.scene_expansion_max;
            let message = format!("the scene expands to more than {max} operations");
            self.reports.stop(span, message, "nest fewer function calls, or shorten the loops");
        }
        !self.reports.stopped
    }

    pub(super) fn written_number(&mut self, value: f32, id: ExprId) -> Value {
        // A number becomes an input only where inputs of a frame are allowed, and only in the scene's text: offsets in
        // the library's texts may equal the offset of an edited number.
        let may_change = self.inputs.allowed & uses::FRAME != 0 && std::ptr::eq(self.ast, self.scene_ast);
        if self.reports.library_call.is_none() {
            self.origins.begins(self.ast.span(id));
        }
        let (offset, declared) = (self.ast.span(id).start, self.declared.params.len());
        let input = if may_change {
            self.changing.input(offset, value, declared, self.limits.scene_params_max)
        } else {
            None
        };
        Value::scalar(match input {
            Some(input) => self.graph.input(input),
            None => self.graph.constant(value),
        })
    }

    /// The value of a constant expression; `None` for other expressions. Edited numbers count as constant.
    pub(super) fn known(&self, value: NodeId) -> Option<f32> {
        self.changing.known(&self.graph, value)
    }

    pub(super) fn with_known(&mut self, vector: Vector) -> Vector {
        vector.map(|part| match self.known(part) {
            Some(value) => self.graph.constant(value),
            None => part,
        })
    }

    pub(super) fn constant(&mut self, value: f32) -> NodeId {
        self.graph.constant(value)
    }

    pub(super) fn vector(&mut self, values: [f32; 3]) -> [NodeId; 3] {
        values.map(|value| self.graph.constant(value))
    }

    /// Returns the inputs of all frames.
    pub(super) fn any_frame(&self) -> FrameInputs {
        let ranges = self.declared.params.iter().map(|param| (param.min, param.max));
        FrameInputs::any(self.graph.ranges(ranges), &ShapeAtlas::NONE)
    }

    /// Returns the value of a name: a local name, else a parameter or let of the scene, else an input.
    #[inline]
    pub(super) fn lookup(&mut self, symbol: Symbol, span: Span) -> Value {
        let is_noted = self.reports.library_call.is_none();
        if is_noted {
            self.origins.begins(span);
        }
        if let Some((value, by)) = self.scope.local(symbol) {
            if is_noted {
                self.origins.uses(by);
            }
            return value;
        }
        if self.reports.library_call.is_none() {
            match self.declared.global(symbol) {
                Global { value: GlobalValue::Param(index), .. } => {
                    if let Some(param) = self.declared.params.get(index as usize) {
                        self.origins.begins(param.span);
                    }
                    self.inputs.declare(uses::FRAME, symbol, span, &mut self.reports);
                    return Value::scalar(self.graph.input(Input::Param(index as u16)));
                }
                Global { value: GlobalValue::Let(index), .. } => {
                    return self.global_let(index as usize, span);
                }
                Global { broken: true, .. } => return Value::Unknown,
                _ => {}
            }
        }
        match library::input(symbol) {
            Some(row) => {
                self.inputs.declare(row.uses, symbol, span, &mut self.reports);
                match row.value {
                    InputValue::One(input) => Value::scalar(self.graph.input(input)),
                    InputValue::Constant(value) => Value::scalar(self.graph.constant(value)),
                    InputValue::Many(inputs) => {
                        let mut parts = [NodeId::default(); 3];
                        for (part, &input) in parts.iter_mut().zip(inputs) {
                            *part = self.graph.input(input);
                        }
                        Value::of(parts.get(..inputs.len()).unwrap_or_default())
                    }
                }
            }
            None => self.unknown_name(symbol, span),
        }
    }

    pub(super) fn global_let(&mut self, index: usize, span: Span) -> Value {
        let Some(global) = self.declared.lets.get_mut(index) else { return Value::Unknown };
        let Name { symbol: name, span: global_span } = global.name;
        if let Some((value, used, by)) = global.known {
            self.origins.uses(by);
            self.inputs.declare(used, name, span, &mut self.reports);
            return value;
        }
        if std::mem::replace(&mut global.open, true) {
            return self.reports.circle(name, span);
        }
        let expr = global.value;
        let outside =
            (self.inputs.used, self.inputs.allowed, self.scope.frame, self.ast, self.reports.library_call);
        (self.inputs.used, self.inputs.allowed, self.scope.frame) =
            (uses::NOTHING, u16::MAX, self.scope.bindings.len());
        (self.ast, self.reports.library_call) = (self.scene_ast, None);
        self.reports.calls.push((name, span));
        let from = self.origins.mark();
        self.origins.begins(global_span);
        let value = self.expr(expr);
        let by = self.origins.since(from);
        self.reports.calls.pop();
        let used = self.inputs.used;
        (self.inputs.used, self.inputs.allowed, self.scope.frame, self.ast, self.reports.library_call) =
            outside;
        if let Some(global) = self.declared.lets.get_mut(index) {
            global.known = Some((value, used, by));
            global.open = false;
        }
        self.inputs.declare(used, name, span, &mut self.reports);
        value
    }

    pub(super) fn parameters(&self, parameters: &[Parameter]) -> String {
        let shown = |one: &Parameter| match one.of {
            Some(of) => format!("{}: {}", self.names.name(one.name.symbol), of.name()),
            None => self.names.name(one.name.symbol).to_owned(),
        };
        parameters.iter().map(shown).collect::<Vec<_>>().join(", ")
    }

    /// Runs `lower` with this set of allowed inputs; `place` names the section in messages.
    pub(super) fn within<T>(
        &mut self,
        allowed: u16,
        place: &'static str,
        lower: impl FnOnce(&mut Self) -> T,
    ) -> T {
        let outside = (self.inputs.allowed, self.inputs.place);
        (self.inputs.allowed, self.inputs.place) = (allowed, place);
        let result = lower(self);
        (self.inputs.allowed, self.inputs.place) = outside;
        result
    }

    /// Returns the only part of a value. `hint` is the advice for vectors.
    pub(super) fn one_number(&mut self, value: Value, what: &str, hint: &str, span: Span) -> Option<NodeId> {
        match value {
            Value::Unknown => None,
            Value::Vector(vector) if vector.len() == 1 => Some(vector.first()),
            other => {
                let message = format!("{what} must be a number, but this is {}", other.described());
                let wrong = Diagnostic::new(span, message);
                self.reports.refuse(match other {
                    Value::Vector(_) => wrong.hint(hint),
                    Value::Bool(_) => wrong.hint("a condition becomes a number with `if a then 1 else 0`"),
                    _ => wrong.hint("write a number or a formula"),
                })
            }
        }
    }
}

/// The advice if a vector is given for a distance.
pub(super) const A_DISTANCE: &str = "get a distance with `length(…)` or a shape such as `sphere(p, 1)`";
/// The advice if a vector is given for another number.
pub(super) const A_NUMBER: &str = "write one number, or take one part of the vector with `.x`";
