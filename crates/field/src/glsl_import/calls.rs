//! Sessions of one file in one graph, and calls of functions.

use std::collections::{BTreeSet, HashMap, HashSet};
use std::rc::Rc;

use naga::{Arena, Function, Handle, ScalarKind, Statement, Type};

use super::Result;
use super::execute::{Exits, ROUNDS_WITHOUT_COUNT};
use super::layout::{ExprId, Info, Memory, PARTS_MAX, Part, infos, size};
use super::outside::{self, Channel};
use super::parse::{GlslFile, GlslFunction, Special, range};
use super::samplers::SamplerRead;
use crate::graph::{Graph, NodeId, Op};
use crate::lang::{Diagnostic, Fault, Span};

/// Limits of execution, shared with the scene that calls GLSL.
#[derive(Debug, Clone, Copy)]
pub struct Budget {
    /// Steps that are left. Execution reduces it.
    pub steps: usize,
    /// Maximum number of rounds of one loop.
    pub rounds_max: usize,
    /// Maximum number of parts of all variables at a time.
    pub memory_max: usize,
}

pub(super) const HOW_TO_READ_IMAGES: &str = "name an image or the cover of the song in a scene that includes the \
     shader, as in `let iChannel0 = \"cover\"`";

/// Maximum nesting of calls. Every call needs a few kilobytes of the stack.
const CALLS_MAX: usize = 48;

/// State between the calls of a file's functions: the first values of its globals, as nodes of one graph.
#[derive(Debug, Default)]
pub struct GlslSession {
    /// True for the formulas of a picture, which know the pixel, the picture's size and the pointer.
    pub(super) in_picture: bool,
    /// The number of the texture that holds the last frame.
    pub last_frame: Option<u16>,
    /// Names of samplers whose pictures are read as black.
    pub(super) pictures: BTreeSet<String>,
    /// True if a loop was ended that does not count its rounds.
    pub(super) cuts_loops: bool,
    /// True if a sampler was read as a picture before a later read showed its kind.
    pub(super) learned: bool,
    /// The channels of samplers, by the number of their global variable.
    pub(super) channels: HashMap<i64, Channel>,
    /// Pseudo-random whole numbers, which replace the products in hashes.
    pub(super) scrambled: HashSet<NodeId>,
    globals: Option<Vec<Part>>,
    infos: HashMap<Handle<Function>, Rc<[Option<Info>]>>,
}

/// A place in memory, with indices that are computed.
#[derive(Debug, Clone, Default)]
pub(super) struct Pointer {
    pub start: u32,
    pub len: u32,
    /// For each computed index: its value, the number of elements, and the parts of each.
    pub indices: Vec<(NodeId, u32, u32)>,
}

/// The value of an expression, or a place in memory.
#[derive(Debug, Clone)]
pub(super) enum Argument {
    Parts(Vec<Part>),
    Pointer(Pointer),
}

/// A loop or a switch.
pub(super) struct Target {
    pub is_loop: bool,
    /// True if a constant condition decides whether the loop ends: it counts its rounds.
    pub is_counted: bool,
    pub breaks: Exits,
    pub continues: Exits,
}

impl Target {
    pub(super) fn new(is_loop: bool, mark: usize) -> Self {
        Self { is_loop, is_counted: false, breaks: Exits::new(mark), continues: Exits::new(mark) }
    }
}

/// The state of one call.
pub(super) struct CallFrame<'m> {
    pub function: &'m Function,
    pub infos: Rc<[Option<Info>]>,
    /// The values of the function's expressions that are evaluated.
    pub values: Vec<Option<Argument>>,
    pub arguments: Vec<Argument>,
    /// First slot in memory of the call's variables.
    pub base: usize,
    /// The condition under which the current loop was entered; loops start with a condition of 1.
    pub outer: NodeId,
    pub targets: Vec<Target>,
    pub returns: Exits,
    pub result: Vec<Part>,
    pub counts: Counts,
}

impl<'m> CallFrame<'m> {
    /// A call without arguments and values. `outer` is where it is live in its caller.
    fn new(function: &'m Function, outer: NodeId) -> Self {
        Self {
            function,
            infos: Rc::from([]),
            values: Vec::new(),
            arguments: Vec::new(),
            base: 0,
            outer,
            targets: Vec::new(),
            returns: Exits::new(0),
            result: Vec::new(),
            counts: Counts::default(),
        }
    }
}

/// How many statements of a kind have been executed.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Counts {
    pub returns: usize,
    pub continues: usize,
    pub breaks: usize,
}

/// Executes the statements of a file's functions.
pub(super) struct Executor<'m, 'g> {
    pub file: &'m GlslFile,
    pub graph: &'g mut Graph,
    pub memory: Memory,
    /// The condition under which the current statement runs, within the current loop or function.
    pub live: NodeId,
    pub zero: NodeId,
    pub one: NodeId,
    pub frame: CallFrame<'m>,
    pub budget: &'g mut Budget,
    /// The place in the user's text of the statement or expression that is being executed.
    pub here: Span,
    pub session: &'g mut GlslSession,
    /// The condition under which the pixel is not drawn.
    pub discarded: NodeId,
    /// The functions that are being executed, each with the conditions under which it was called.
    pub open: Vec<(Handle<Function>, [NodeId; 2])>,
}

impl GlslSession {
    /// Returns a session for formulas of the picture. [`Input::X`](crate::graph::Input::X) and `Y` are the pixel there.
    pub fn of_picture() -> Self {
        Self { in_picture: true, ..Self::default() }
    }

    /// Returns what the calls since the last one left out, each with a way to get it.
    pub fn left_out(&mut self) -> Vec<Diagnostic> {
        let mut left_out = Vec::new();
        let names: Vec<String> = std::mem::take(&mut self.pictures).into_iter().collect();
        if !names.is_empty() {
            let names = names.join("`, `");
            let message = format!("the pictures of `{names}`: black or a noise is drawn instead");
            left_out.push(Diagnostic::unsupported(Span::default(), message).hint(HOW_TO_READ_IMAGES));
        }
        if std::mem::take(&mut self.cuts_loops) {
            let message =
                format!("rounds of a loop after the first {ROUNDS_WITHOUT_COUNT}: nothing counts them");
            let hint = "count its rounds, as in `for (int i = 0; i < 64; i++)`";
            left_out.push(Diagnostic::unsupported(Span::default(), message).hint(hint));
        }
        left_out
    }

    /// Executes a function for arguments of the types of its parameters, each as the nodes of its components. Returns
    /// the components of the result. `given` are the scene's values for uniforms, which
    /// must be the same in all calls of a session.
    ///
    /// # Errors
    /// A construct that a graph cannot express, or a limit.
    pub fn call(
        &mut self,
        file: &GlslFile,
        function: &GlslFunction,
        arguments: &[Vec<NodeId>],
        graph: &mut Graph,
        budget: &mut Budget,
        given: &[(String, Vec<NodeId>)],
    ) -> Result<Vec<NodeId>> {
        let place = function.place;
        let wrong = || Diagnostic::new(place, "this function does not fit its call");
        let called = file.module.functions.try_get(function.handle).map_err(|_| wrong())?;
        let known = self.globals.take();
        let (zero, one) = (graph.constant(0.0), graph.constant(1.0));
        let mut executor = Executor {
            file,
            graph: &mut *graph,
            memory: Memory::default(),
            live: one,
            zero,
            one,
            frame: CallFrame::new(called, one),
            budget: &mut *budget,
            here: place,
            session: &mut *self,
            discarded: zero,
            open: Vec::new(),
        };
        match known {
            Some(globals) => executor.memory.parts = globals,
            None => executor.start(given)?,
        }
        executor.here = place;
        let globals = executor.memory.parts.clone();
        let mut passed = Vec::with_capacity(arguments.len());
        for (parts, argument) in arguments.iter().zip(&called.arguments) {
            let kind = file.module.types.get_handle(argument.ty).ok().and_then(|of| of.inner.scalar_kind());
            let kind = kind.unwrap_or(ScalarKind::Float);
            let from = if kind == ScalarKind::Bool { kind } else { ScalarKind::Float };
            let parts = parts.iter().map(|&node| executor.convert(from, kind, Part::Node(node)));
            passed.push(Argument::Parts(parts.collect::<Result<_>>()?));
        }
        let result = executor.call(function.handle, passed);
        let result = result.and_then(|parts| {
            let nodes = parts.into_iter().map(|part| {
                let node = executor.node(part)?;
                Ok(executor.graph.select(executor.discarded, executor.zero, node))
            });
            nodes.collect()
        });
        self.globals = Some(globals);
        if std::mem::take(&mut self.learned) && result.is_ok() {
            return self.call(file, function, arguments, graph, budget, given);
        }
        result
    }
}

impl<'m> Executor<'m, '_> {
    /// Gives the globals their values.
    fn start(&mut self, given: &[(String, Vec<NodeId>)]) -> Result<()> {
        let file = self.file;
        let mut kept = Vec::new();
        for (handle, global) in file.module.global_variables.iter() {
            self.here = file.written.source_range(range(file.module.global_variables.get_span(handle)));
            let start = self.memory.parts.len();
            let name = global.name.as_deref().unwrap_or("");
            let Some(len) = size(&file.module, global.ty) else {
                // An image: its reads never reach memory.
                self.memory.parts.push(Part::Unset(handle.index() as u32));
                continue;
            };
            let len = len as usize;
            let origin = file.globals.outside.get(name);
            let own =
                given.iter().find(|(known, nodes)| known == name && (nodes.len() == len || nodes.len() == 1));
            let parts = match (own.filter(|_| origin.is_some()), origin, global.init) {
                (Some((_, nodes)), ..) => {
                    let kind =
                        file.module.types.get_handle(global.ty).ok().and_then(|of| of.inner.scalar_kind());
                    let is_float = kind == Some(ScalarKind::Float);
                    let round =
                        |&node: &NodeId| if is_float { node } else { self.graph.unary(Op::Round, node) };
                    let nodes: Vec<NodeId> = nodes.iter().map(round).collect();
                    let parts: Vec<Part> = nodes.into_iter().cycle().take(len).map(Part::Node).collect();
                    kept.push((start, parts.clone()));
                    parts
                }
                (None, Some(_), _) if file.globals.samplers.contains_key(name) => {
                    vec![Part::Int(handle.index() as i32); len]
                }
                (None, Some(origin), _) => {
                    let known = outside::known(self.graph, name, len, *origin, self.session.in_picture);
                    let unset = || vec![Part::Unset(handle.index() as u32); len];
                    known.map_or_else(unset, |nodes| nodes.into_iter().map(Part::Node).collect())
                }
                (None, None, Some(init)) => self.global_value(init)?,
                (None, None, None) => {
                    let parts = self.zeros(global.ty)?;
                    self.step(parts.len())?;
                    parts
                }
            };
            self.memory.parts.extend(parts);
            self.memory.parts.resize(start + len, Part::Node(self.zero));
            if self.memory.parts.len() > self.budget.memory_max {
                return Err(self.too_large());
            }
        }
        for &start in &file.starts {
            // A global whose value cannot be computed is only a mistake if a function reads it.
            let before = self.memory.parts.clone();
            self.here = file.written.source_range(range(file.module.functions.get_span(start)));
            if let Err(problem) = self.call(start, Vec::new()) {
                if problem.fault == Fault::OverLimit {
                    return Err(problem);
                }
                self.memory.parts = before;
            }
            self.memory.forget_changes();
        }
        for (start, parts) in kept {
            for (place, part) in self.memory.parts.iter_mut().skip(start).zip(parts) {
                *place = part;
            }
        }
        Ok(())
    }

    /// Returns the place of a variable in memory. The variables lie there in order, from part `start` on.
    pub(super) fn pointer_to<T>(
        &self,
        variables: &Arena<T>,
        wanted: Handle<T>,
        start: u32,
        type_of: impl Fn(&T) -> Handle<Type>,
    ) -> Pointer {
        let size = |variable| size(&self.file.module, type_of(variable)).unwrap_or(1);
        let before = variables.iter().take_while(|(handle, _)| *handle != wanted);
        let start = start + before.map(|(_, variable)| size(variable)).sum::<u32>();
        let len = variables.try_get(wanted).map_or(0, size);
        Pointer { start, len, indices: Vec::new() }
    }

    /// Counts `count` operations.
    pub(super) fn step(&mut self, count: usize) -> Result<()> {
        match self.budget.steps.checked_sub(count.max(1)) {
            Some(left) => {
                self.budget.steps = left;
                Ok(())
            }
            None => {
                self.budget.steps = 0;
                Err(Diagnostic::over_limit(self.here, "this GLSL expands to too many operations")
                    .hint("shorten its loops, or call fewer functions in them"))
            }
        }
    }

    /// The place in the user's text of an expression of the current function.
    pub(super) fn place(&self, of: ExprId) -> Span {
        self.file.written.source_range(range(self.frame.function.expressions.get_span(of)))
    }

    /// Runs a part of the execution that has this place.
    pub(super) fn at<T>(&mut self, place: Span, run: impl FnOnce(&mut Self) -> Result<T>) -> Result<T> {
        let outside = std::mem::replace(&mut self.here, place);
        let result = run(self);
        self.here = outside;
        result
    }

    /// Calls a function. Returns the parts of its result.
    pub(super) fn call(&mut self, handle: Handle<Function>, arguments: Vec<Argument>) -> Result<Vec<Part>> {
        let file = self.file;
        let Ok(function) = file.module.functions.try_get(handle) else { return Ok(Vec::new()) };
        let name = function.name.as_deref().unwrap_or("");
        match file.special.get(&handle) {
            Some(Special::Broken(index)) => {
                let missing = || Diagnostic::new(self.here, "this function has a mistake");
                return Err(file.problems.get(*index).cloned().unwrap_or_else(missing));
            }
            Some(special) => return SamplerRead { of: self }.colour(*special, &arguments),
            None => {}
        }
        if self.open.iter().any(|(open, _)| *open == handle) {
            let message = format!("`{name}` calls itself");
            return Err(
                Diagnostic::unsupported(self.here, message).hint("write a loop instead of the recursion")
            );
        }
        if self.open.len() >= CALLS_MAX {
            let message = format!("functions call each other more than {CALLS_MAX} deep");
            return Err(Diagnostic::over_limit(self.here, message).hint("merge some of them"));
        }
        let is_defined =
            function.body.iter().any(|statement| !matches!(statement, Statement::Return { value: None }));
        if !is_defined && function.result.is_some() {
            let message = format!("`{name}` is declared, but has no body");
            return Err(Diagnostic::new(self.here, message).hint("add the function to this file"));
        }
        self.step(1)?;
        let known = self.session.infos.entry(handle);
        let infos = known.or_insert_with(|| Rc::from(infos(&file.module, function))).clone();
        let mark = self.memory.mark();
        let frame = CallFrame {
            infos,
            arguments,
            values: vec![None; function.expressions.len()],
            base: self.memory.parts.len(),
            returns: Exits::new(mark),
            ..CallFrame::new(function, self.one)
        };
        let outside = (std::mem::replace(&mut self.frame, frame), self.live);
        self.live = self.one;
        self.open.push((handle, [outside.0.outer, outside.1]));
        let done = self.run(function);
        self.open.pop();
        let frame = std::mem::replace(&mut self.frame, outside.0);
        self.live = outside.1;
        self.memory.undo(mark);
        self.memory.parts.truncate(frame.base);
        for (slot, part) in frame.returns.changed {
            self.memory.store_part(slot, part);
        }
        done?;
        Ok(frame.result)
    }

    /// Runs the body of the current frame's function.
    fn run(&mut self, function: &'m Function) -> Result<()> {
        for (_, local) in function.local_variables.iter() {
            let parts = match local.init {
                Some(init) => self.parts_of(init)?,
                None => self.zeros(local.ty)?,
            };
            self.step(parts.len())?;
            self.memory.parts.extend(parts);
            if self.memory.parts.len() > self.budget.memory_max {
                return Err(self.too_large());
            }
        }
        self.block(&function.body)?;
        if self.live != self.zero {
            self.leave_function(Vec::new())?;
        }
        Ok(())
    }

    fn too_large(&self) -> Diagnostic {
        let message = format!("the variables of this GLSL have more than {PARTS_MAX} numbers");
        Diagnostic::over_limit(self.here, message).hint("make its arrays smaller")
    }
}
