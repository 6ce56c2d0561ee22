//! Calls of functions from included GLSL files.

use std::collections::HashMap;

use super::super::builtin::uses;
use super::super::diagnostic::{Diagnostic, Fault};
use super::super::foreign::ForeignFile;
use super::super::symbol::{Interner, Symbol};
use super::super::value::Value;
use super::call::Call;
use super::declared::GlobalValue;
use super::lowering::Lowering;
use super::reads::Read;
use crate::glsl_import::{Budget, GlslFunction, GlslSession, GlslType, image_sampler};
use crate::graph::{Input, NodeId};

/// The functions of all included GLSL files.
#[derive(Default)]
pub(super) struct Foreign<'a> {
    files: &'a [ForeignFile],
    /// For each file, the session of shapes and materials and the session of the picture.
    sessions: Vec<[GlslSession; 2]>,
    /// For each name, the index of the file and of the function.
    by_name: HashMap<Symbol, Vec<(usize, usize)>>,
    /// True if a file could not be read.
    pub is_broken: bool,
}

impl<'a> Foreign<'a> {
    pub(super) fn new(files: &'a [ForeignFile], names: &Interner, is_broken: bool) -> Self {
        let mut by_name: HashMap<Symbol, Vec<(usize, usize)>> = HashMap::new();
        for (file, foreign) in files.iter().enumerate() {
            for (index, function) in foreign.file.functions().iter().enumerate() {
                if let Some(symbol) = names.get(&function.name) {
                    by_name.entry(symbol).or_default().push((file, index));
                }
            }
        }
        let sessions = files.iter().map(|_| [GlslSession::default(), GlslSession::of_picture()]).collect();
        Self { files, sessions, by_name, is_broken }
    }

    pub(super) fn is_function(&self, name: Symbol) -> bool {
        self.by_name.contains_key(&name)
    }

    pub(super) fn names(&self) -> impl Iterator<Item = Symbol> + '_ {
        self.by_name.keys().copied()
    }

    /// The functions of a name, each with its file.
    fn all(&self, name: Symbol) -> impl Iterator<Item = (usize, &'a ForeignFile, &'a GlslFunction)> + '_ {
        let files = self.files;
        self.by_name.get(&name).into_iter().flatten().filter_map(move |&(file, index)| {
            let foreign = files.get(file)?;
            Some((file, foreign, foreign.file.functions().get(index)?))
        })
    }
}

/// A call of a GLSL function.
pub(super) struct ForeignCall<'l, 'a> {
    pub outer: &'l mut Lowering<'a>,
    pub call: Call,
}

impl ForeignCall<'_, '_> {
    /// Calls the GLSL function of this name whose parameters fit the arguments best. `None` if none fits.
    pub(super) fn value(&mut self) -> Option<Value> {
        let Call { name, mark, span, .. } = self.call;
        let arguments = self.outer.arguments.get(mark..).unwrap_or_default();
        if arguments.contains(&Value::Unknown) {
            return self.outer.declared.foreign.is_function(name).then_some(Value::Unknown);
        }
        let fitting = self.outer.declared.foreign.all(name);
        let fitting = fitting
            .filter_map(|(index, file, function)| Some((cost(function, arguments)?, index, file, function)));
        let mut fitting: Vec<_> = fitting.collect();
        fitting.sort_by_key(|(cost, ..)| *cost);
        let &(best, index, foreign, function) = fitting.first()?;
        if let Some(&(_, _, other, twin)) =
            fitting.iter().skip(1).find(|(cost, file, ..)| *cost == best && *file != index)
        {
            let name = self.outer.name(name);
            let message = format!("two GLSL files have a function `{name}` that fits this call");
            let wrong = Diagnostic::new(span, message)
                .note(foreign.span(function.place), "one is here")
                .note(other.span(twin.place), "the other one is here");
            return Some(self.outer.reports.add(wrong.hint("give one of them another name")));
        }
        Some(self.execute(index, foreign, function))
    }

    fn execute(&mut self, index: usize, foreign: &ForeignFile, function: &GlslFunction) -> Value {
        let mut arguments: Vec<Vec<NodeId>> = Vec::new();
        for (offset, parameter) in function.parameters.iter().enumerate() {
            arguments.push(
                match (parameter.of, self.outer.arguments.get(self.call.mark + offset).copied()) {
                    (Some(GlslType::Vector(size)), Some(Value::Vector(vector))) => {
                        (0..usize::from(size)).map(|index| vector.part(index)).collect()
                    }
                    (_, Some(Value::Vector(vector))) => vec![self.outer.with_known(vector).first()],
                    (_, Some(Value::Bool(node))) => vec![node],
                    _ => Vec::new(),
                },
            );
        }
        let (call, in_picture) = (self.call, self.is_in_picture(function));
        let kept = |this: &mut Self, session: GlslSession| {
            let sessions = this.outer.declared.foreign.sessions.get_mut(index)?;
            Some(std::mem::replace(&mut sessions[usize::from(in_picture)], session))
        };
        let Some(mut session) = kept(self, GlslSession::default()) else { return Value::Unknown };
        if in_picture && session.last_frame.is_none() && foreign.file.reads_last_frame() {
            session.last_frame = Read { outer: self.outer, name: "previous", call }.last_frame_number();
        }
        let mut budget = Budget {
            steps: self.outer.budget.left(self.outer.limits),
            rounds_max: self.outer.limits.scene_loop_max,
            memory_max: self.outer.limits.scene_expansion_max.min(1 << 18),
        };
        let given = self.given(foreign, in_picture);
        let steps = budget.steps;
        let result =
            session.call(&foreign.file, function, &arguments, &mut self.outer.graph, &mut budget, &given);
        self.outer.budget.spend(steps - budget.steps);
        for left_out in session.left_out() {
            let message = format!("`{}` leaves out {}", function.name, left_out.message);
            let warning = Diagnostic { hint: left_out.hint, ..Diagnostic::warning(call.span, message) };
            self.outer.reports.diagnostics.warn(warning);
        }
        kept(self, session);
        let nodes = match result {
            Ok(nodes) => nodes,
            Err(problem) => return self.problem(foreign, &problem),
        };
        if nodes.iter().any(|&node| self.outer.known(node).is_none()) && foreign.file.reads_frame() {
            self.outer.inputs.declare(uses::FRAME, call.name, call.span, &mut self.outer.reports);
        }
        if in_picture {
            self.use_picture(foreign, &nodes);
        }
        match function.result {
            Some(GlslType::Bool) => nodes.first().map_or(Value::Unknown, |&node| Value::Bool(node)),
            _ => Value::of(&nodes),
        }
    }

    /// True if the call is part of a picture's formula: `resolution` is the picture's size there. The same function
    /// sees a fixed size in a shape.
    fn is_in_picture(&self, function: &GlslFunction) -> bool {
        let inputs = &self.outer.inputs;
        // The `let` of a scene may be part of anything.
        let is_of_picture = inputs.allowed & uses::POINT == 0 || inputs.used & uses::PIXEL != 0;
        function.is_picture || (inputs.allowed & uses::PIXEL != 0 && is_of_picture)
    }

    /// Notes the inputs of the picture that the result of a call depends on.
    fn use_picture(&mut self, foreign: &ForeignFile, nodes: &[NodeId]) {
        let (mut kind, reads) = (uses::NOTHING, self.outer.graph.inputs_used(nodes).inputs);
        if reads.iter().any(|input| matches!(input, Input::Screen(_))) {
            kind |= uses::SCREEN;
        }
        if foreign.file.reads_pixel() && (reads.contains(&Input::X) || reads.contains(&Input::Y)) {
            kind |= uses::PIXEL;
        }
        self.outer.inputs.declare(kind, self.call.name, self.call.span, &mut self.outer.reports);
    }

    /// The scene's parameters and lets that have the names of uniforms. A text names the image of a sampler.
    fn given(&mut self, foreign: &ForeignFile, in_picture: bool) -> Vec<(String, Vec<NodeId>)> {
        let mut given = Vec::new();
        for uniform in foreign.file.uniforms() {
            let Some(symbol) = self.outer.names.get(uniform) else { continue };
            let value = match self.outer.declared.global(symbol).value {
                GlobalValue::Param(index) => {
                    self.outer.inputs.declare(uses::FRAME, symbol, self.call.span, &mut self.outer.reports);
                    Value::scalar(self.outer.graph.input(Input::Param(index as u16)))
                }
                GlobalValue::Let(index) => self.outer.global_let(index as usize, self.call.span),
                GlobalValue::None => continue,
            };
            let nodes = match value {
                // The value of a sampler is a number that only a name of an image gives.
                Value::Vector(vector) if !foreign.file.is_sampler(uniform) => vector.parts().to_vec(),
                Value::Text(file) if in_picture => {
                    let mut read = Read { outer: self.outer, name: "texture", call: self.call };
                    let image = read.number(file, self.call.span);
                    image.map(|image| self.outer.constant(image_sampler(image))).into_iter().collect()
                }
                _ => continue,
            };
            given.push((uniform.to_owned(), nodes));
        }
        given
    }

    #[cold]
    fn problem(&mut self, foreign: &ForeignFile, problem: &Diagnostic) -> Value {
        let Call { name, span, .. } = self.call;
        let mut diagnostic = foreign.diagnostic(problem, span);
        let is_limit = problem.fault == Fault::OverLimit;
        if diagnostic.span != span {
            diagnostic = diagnostic.note(span, format!("`{}` is called here", self.outer.name(name)));
        }
        let value = self.outer.reports.add(diagnostic);
        // Another call would only spend the same time again.
        self.outer.reports.stopped |= is_limit;
        value
    }

    /// Reports a call that no GLSL function of the name fits.
    #[cold]
    pub(super) fn misfit(&mut self) -> Value {
        let Call { name, mark, span, .. } = self.call;
        let given = self.outer.arguments.get(mark..).unwrap_or_default();
        let given: Vec<&str> = given.iter().map(|value| value.described()).collect();
        let text = self.outer.name(name);
        let mut diagnostic = match given.as_slice() {
            [] => Diagnostic::new(span, format!("`{text}` cannot be called without arguments")),
            _ => Diagnostic::new(span, format!("`{text}` cannot be called with {}", given.join(" and "))),
        };
        let mut is_callable = false;
        let mut signatures = Vec::new();
        for (_, _, function) in self.outer.declared.foreign.all(name) {
            is_callable |= function.is_callable();
            signatures.push(function.to_string());
        }
        if !is_callable {
            diagnostic.fault = Fault::Unsupported;
            diagnostic.message = format!(
                "`{text}` can be called only from GLSL: scenes have no values of its parameters or result"
            );
        }
        let hint = format!("it is declared as `{}`", signatures.join("` and `"));
        self.outer.reports.add(diagnostic.hint(hint))
    }
}

/// How far the arguments are from a function's parameters: the number of numbers that become vectors. `None` if they
/// do not fit.
fn cost(function: &GlslFunction, arguments: &[Value]) -> Option<usize> {
    if function.parameters.len() != arguments.len() || !function.is_callable() {
        return None;
    }
    let mut cost = 0;
    for (parameter, argument) in function.parameters.iter().zip(arguments) {
        match (parameter.of?, argument) {
            (GlslType::Float, Value::Vector(vector)) if vector.len() == 1 => {}
            (GlslType::Whole, Value::Vector(vector)) if vector.len() == 1 => cost += 1,
            (GlslType::Bool, Value::Bool(_)) => {}
            (GlslType::Vector(size), Value::Vector(vector)) if vector.len() == usize::from(size) => {}
            (GlslType::Vector(_), Value::Vector(vector)) if vector.len() == 1 => cost += 4,
            _ => return None,
        }
    }
    Some(cost)
}
