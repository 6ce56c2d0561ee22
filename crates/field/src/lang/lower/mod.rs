//! The tree to a checked scene: names are looked up, sizes are checked, functions are expanded where they are called,
//! loops are unrolled, and everything is built into one graph.
//!
//! Recursion follows the nesting of the text and of calls and is bounded by `scene_depth_max`; chains of operators
//! are loops. Every visited node counts against `scene_expansion_max`.

mod builtins;
mod call;
mod declare;
mod expr;
mod lights;
mod objects;
mod sections;

pub use sections::section_fields;

use super::ast::{Ast, ExprId, Function, Parameter};
use super::builtin::{INPUTS, InputValue, uses};
use super::changing::ChangingNumbers;
use super::diagnostic::{Diagnostic, Diagnostics};
use super::library::{self, Library};
use super::load::Loaded;
use super::origins::{Origins, Stretch};
use super::scene::{Param, Scene, TextureRef};
use super::source::{Sources, Span};
use super::symbol::{Interner, Symbol};
use super::value::{Value, Vector};
use crate::graph::{Graph, Input, NodeId};
use crate::limits::Limits;

/// Makes a scene from a tree; `None` if the scene has no shape or has mistakes.
pub(super) fn lower(
    loaded: Loaded,
    changing: ChangingNumbers,
    limits: &Limits,
    sources: &Sources,
    diagnostics: &mut Diagnostics,
) -> Option<Scene> {
    let Loaded { ast, names, items, includes } = loaded;
    let mut graph = Graph::with_limits(limits);
    // One to two nodes for an expression where little is repeated.
    graph.reserve(2 * ast.len());
    let lowering = Lowering {
        graph,
        ast: &ast,
        scene_ast: &ast,
        library: library::library(),
        names: &names,
        limits,
        diagnostics,
        globals: vec![Global::default(); names.len()],
        lets: Vec::new(),
        functions: Vec::new(),
        params: Vec::new(),
        changing,
        textures: Vec::new(),
        scope: Vec::new(),
        innermost: vec![NO_BINDING; names.len()],
        frame: 0,
        calls: Vec::new(),
        library_call: None,
        depth: 0,
        steps: 0,
        stopped: false,
        allowed: uses::NOTHING,
        place: "",
        used: uses::NOTHING,
        spine: Vec::new(),
        arguments: Vec::new(),
        origins: Origins::default(),
    };
    lowering.scene(&items, includes, sources)
}

/// The meaning of a name at the top of the scene: values, functions and materials each have names of their own.
#[derive(Debug, Clone, Copy, Default)]
struct Global {
    value: GlobalValue,
    /// 1 + index of the function; 0 for none.
    function: u32,
    /// 1 + index of the material; 0 for none.
    material: u32,
    /// An item of this name was reported.
    broken: bool,
}

#[derive(Debug, Clone, Copy, Default)]
enum GlobalValue {
    #[default]
    None,
    Let(u32),
    Param(u32),
}

/// A `let` of the scene, lowered at its first use or in the order of the text.
struct GlobalLet {
    name: Symbol,
    span: Span,
    value: ExprId,
    /// The value and which inputs it uses.
    known: Option<(Value, u8)>,
    /// What took part in it.
    by: Stretch,
    open: bool,
}

struct GlobalFunction<'a> {
    function: &'a Function,
    called: bool,
    open: bool,
}

/// A name in a function or a block.
struct Binding {
    symbol: Symbol,
    /// The binding of the same name that it hides, or [`NO_BINDING`].
    hidden: u32,
    value: Value,
    /// What took part in it, if it is a `let`.
    by: Stretch,
}

const NO_BINDING: u32 = u32::MAX;

struct Lowering<'a> {
    graph: Graph,
    /// The tree that is being walked: the scene's or the library's.
    ast: &'a Ast,
    scene_ast: &'a Ast,
    library: &'static Library,
    names: &'a Interner,
    limits: &'a Limits,
    diagnostics: &'a mut Diagnostics,
    /// By symbol.
    globals: Vec<Global>,
    lets: Vec<GlobalLet>,
    functions: Vec<GlobalFunction<'a>>,
    params: Vec<Param>,
    /// Numbers of the scene's text that are read as inputs.
    changing: ChangingNumbers,
    textures: Vec<TextureRef>,
    scope: Vec<Binding>,
    /// By symbol: the innermost binding in `scope`.
    innermost: Vec<u32>,
    /// Where the bindings of the current function begin.
    frame: usize,
    /// Scene functions and lets that are being expanded: the name and its place.
    calls: Vec<(Symbol, Span)>,
    /// Where the scene calls the library: mistakes inside the library are reported at the call.
    library_call: Option<(Symbol, Span)>,
    depth: usize,
    steps: usize,
    /// A limit was reached: everything else is unknown.
    stopped: bool,
    /// Inputs that may be used here (see [`uses`]), and the name of this place.
    allowed: u8,
    place: &'static str,
    /// Inputs that were used since this was last cleared.
    used: u8,
    /// Operators on the way down to the first operand.
    spine: Vec<ExprId>,
    /// Arguments of the calls that are open.
    arguments: Vec<Value>,
    /// Where what is made comes from.
    origins: Origins,
}

/// Most calls that a diagnostic lists on the way to its place.
const CALLS_SHOWN: usize = 3;

impl<'a> Lowering<'a> {
    fn name(&self, symbol: Symbol) -> &'a str {
        self.names.name(symbol)
    }

    /// Reports a mistake; a mistake in the library is placed where the scene called it.
    #[cold]
    fn report(&mut self, mut diagnostic: Diagnostic) -> Value {
        if let Some((_, span)) = self.library_call {
            diagnostic.span = span;
            diagnostic.notes.clear();
        }
        for (symbol, span) in self.calls.iter().rev().take(CALLS_SHOWN) {
            diagnostic.notes.push((*span, format!("`{}` is used here", self.names.name(*symbol))));
        }
        self.diagnostics.push(diagnostic);
        self.stopped |= self.diagnostics.full();
        Value::Unknown
    }

    /// Reports that a limit is reached and ends the work.
    #[cold]
    fn stop(&mut self, span: Span, message: String, hint: &str) -> Value {
        let value = self.report(Diagnostic::over_limit(span, message).hint(hint));
        self.stopped = true;
        value
    }

    /// Counts a step and says whether work goes on.
    #[inline]
    fn step(&mut self, span: Span) -> bool {
        self.steps += 1;
        if self.steps > self.limits.scene_expansion_max && !self.stopped {
            let max = self.limits.scene_expansion_max;
            let message = format!("the scene expands to more than {max} operations");
            self.stop(span, message, "call fewer functions in functions, or shorten the loops");
        }
        !self.stopped
    }

    /// A number of the text.
    fn written_number(&mut self, value: f32, id: ExprId) -> Value {
        // Only where a frame's inputs are known, and not in the library's texts, whose places are others.
        let may_change = self.allowed & uses::FRAME != 0 && std::ptr::eq(self.ast, self.scene_ast);
        if self.library_call.is_none() {
            self.origins.begins(self.ast.span(id));
        }
        let (offset, declared) = (self.ast.span(id).start, self.params.len());
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

    /// The value of an expression that does not depend on anything, if it does not.
    fn known(&self, value: NodeId) -> Option<f32> {
        self.changing.known(&self.graph, value)
    }

    /// The same vector with what is known written as numbers.
    fn with_known(&mut self, vector: Vector) -> Vector {
        vector.map(|part| match self.known(part) {
            Some(value) => self.graph.constant(value),
            None => part,
        })
    }

    fn constant(&mut self, value: f32) -> NodeId {
        self.graph.constant(value)
    }

    fn vector(&mut self, values: [f32; 3]) -> [NodeId; 3] {
        values.map(|value| self.graph.constant(value))
    }

    /// Binds a name until [`Lowering::unbind`].
    fn bind(&mut self, symbol: Symbol, value: Value) {
        self.bind_made(symbol, value, Stretch::default());
    }

    /// The same of a value in which something took part.
    fn bind_made(&mut self, symbol: Symbol, value: Value, by: Stretch) {
        let Some(innermost) = self.innermost.get_mut(symbol.index()) else { return };
        let hidden = std::mem::replace(innermost, self.scope.len() as u32);
        self.scope.push(Binding { symbol, hidden, value, by });
    }

    /// Forgets all bindings from `mark` on.
    fn unbind(&mut self, mark: usize) {
        while self.scope.len() > mark {
            if let Some(binding) = self.scope.pop()
                && let Some(innermost) = self.innermost.get_mut(binding.symbol.index())
            {
                *innermost = binding.hidden;
            }
        }
    }

    fn local(&self, symbol: Symbol) -> Option<(Value, Stretch)> {
        let index = *self.innermost.get(symbol.index())? as usize;
        if index < self.frame {
            None
        } else {
            self.scope.get(index).map(|binding| (binding.value, binding.by))
        }
    }

    /// The value of a name.
    #[inline]
    fn lookup(&mut self, symbol: Symbol, span: Span) -> Value {
        let is_noted = self.library_call.is_none();
        if is_noted {
            self.origins.begins(span);
        }
        if let Some((value, by)) = self.local(symbol) {
            if is_noted {
                self.origins.uses(by);
            }
            return value;
        }
        if self.library_call.is_none() {
            match self.globals.get(symbol.index()).copied().unwrap_or_default() {
                Global { value: GlobalValue::Param(index), .. } => {
                    if let Some(param) = self.params.get(index as usize) {
                        self.origins.begins(param.span);
                    }
                    self.take_input(uses::FRAME, symbol, span);
                    return Value::scalar(self.graph.input(Input::Param(index as u16)));
                }
                Global { value: GlobalValue::Let(index), .. } => {
                    return self.global_let(index as usize, span);
                }
                Global { broken: true, .. } => return Value::Unknown,
                _ => {}
            }
        }
        match library::input_index(symbol).and_then(|index| INPUTS.get(index)) {
            Some(row) => {
                self.take_input(row.uses, symbol, span);
                match row.value {
                    InputValue::One(input) => Value::scalar(self.graph.input(input)),
                    InputValue::Constant(value) => Value::scalar(self.graph.constant(value)),
                    InputValue::Many(inputs) => {
                        let mut parts = inputs.iter().map(|&input| self.graph.input(input));
                        let first = parts.next();
                        let parts: [Option<NodeId>; 3] = [first, parts.next(), parts.next()];
                        match parts {
                            [Some(a), Some(b), Some(c)] => {
                                Vector::of([a, b, c]).map_or(Value::Unknown, Value::Vector)
                            }
                            [Some(a), Some(b), None] => {
                                Vector::of([a, b]).map_or(Value::Unknown, Value::Vector)
                            }
                            _ => Value::Unknown,
                        }
                    }
                }
            }
            None => self.unknown_name(symbol, span),
        }
    }

    /// Notes that an input is used; reports it if it has no value here.
    fn take_input(&mut self, kind: u8, symbol: Symbol, span: Span) {
        self.used |= kind;
        let missing = kind & !self.allowed;
        if missing != 0 {
            self.input_not_here(missing, self.names.name(symbol), span);
        }
    }

    #[cold]
    fn input_not_here(&mut self, missing: u8, name: &str, span: Span) {
        let here = self.place;
        let (message, hint) = match missing {
            _ if missing & uses::POINT != 0 => (
                format!("{here} is the same at all points, so `{name}` has no value here"),
                "points are known in shapes and materials",
            ),
            _ if missing & uses::NORMAL != 0 => (
                format!("`{name}` is a surface's normal and has no value in {here}"),
                "normals are known in materials, and in functions that are called there",
            ),
            _ if missing & uses::DIRECTION != 0 => (
                format!("`{name}` is the direction of a ray and has no value in {here}"),
                "it is known in the sky",
            ),
            _ if missing & uses::EYE != 0 => (
                format!("{here} does not depend on who looks, so `{name}` has no value here"),
                "the eye's place is known in materials and the sky",
            ),
            _ if missing & uses::TEXTURE != 0 => {
                (format!("{here} cannot read pictures"), "materials and the sky can")
            }
            _ => (
                format!("{here} is fixed before the music plays, so `{name}` has no value here"),
                "write a number",
            ),
        };
        let diagnostic = Diagnostic::unsupported(span, message).hint(hint);
        self.report(diagnostic);
    }

    fn global_let(&mut self, index: usize, span: Span) -> Value {
        let Some(global) = self.lets.get_mut(index) else { return Value::Unknown };
        let name = global.name;
        if let Some((value, used)) = global.known {
            let by = global.by;
            self.origins.uses(by);
            self.take_input(used, name, span);
            return value;
        }
        if std::mem::replace(&mut global.open, true) {
            return self.circle(name, span);
        }
        let (expr, global_span) = (global.value, global.span);
        let outside = (self.used, self.allowed, self.frame, self.ast, self.library_call);
        (self.used, self.allowed, self.frame) = (uses::NOTHING, u8::MAX, self.scope.len());
        (self.ast, self.library_call) = (self.scene_ast, None);
        self.calls.push((name, span));
        let from = self.origins.mark();
        self.origins.begins(global_span);
        let value = self.expr(expr);
        let by = self.origins.since(from);
        self.calls.pop();
        let used = self.used;
        (self.used, self.allowed, self.frame, self.ast, self.library_call) = outside;
        if let Some(global) = self.lets.get_mut(index) {
            global.known = Some((value, used));
            global.by = by;
            global.open = false;
        }
        self.take_input(used, name, span);
        value
    }

    /// Reports that a name is defined by itself, with the names in between.
    #[cold]
    fn circle(&mut self, symbol: Symbol, span: Span) -> Value {
        let first = self.calls.iter().position(|call| call.0 == symbol).unwrap_or(0);
        let way = self.calls.iter().skip(first).map(|call| call.0).chain([symbol]);
        let way: Vec<String> = way.map(|symbol| format!("`{}`", self.names.name(symbol))).collect();
        let message = if way.len() <= 2 {
            format!("{} uses itself", way.first().map_or("this", String::as_str))
        } else {
            format!("these use each other in a circle: {}", way.join(" → "))
        };
        let hint = "functions are expanded where they are called, so none can call itself: repeat with `for`";
        // The calls on the way would only repeat the message.
        let calls = std::mem::take(&mut self.calls);
        let value = self.report(Diagnostic::unsupported(span, message).hint(hint));
        self.calls = calls;
        value
    }

    fn parameters(&self, parameters: &[Parameter]) -> String {
        let shown = |one: &Parameter| match one.of {
            Some(of) => format!("{}: {}", self.names.name(one.name.symbol), of.name()),
            None => self.names.name(one.name.symbol).to_owned(),
        };
        parameters.iter().map(shown).collect::<Vec<_>>().join(", ")
    }
}
