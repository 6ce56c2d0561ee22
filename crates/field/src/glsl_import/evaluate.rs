//! Expressions.

use naga::{DerivativeAxis, Expression, Handle, Literal, ScalarKind, Type, TypeInner};

use super::Result;
use super::calls::{Argument, Executor, Pointer};
use super::layout::{ExprId, Info, Part, member, size};
use crate::graph::{Input, NodeId, Op};
use crate::lang::Diagnostic;

impl Executor<'_, '_> {
    pub(super) fn info(&self, of: ExprId) -> Result<Info> {
        self.frame.infos.get(of.index()).copied().flatten().ok_or_else(|| {
            Diagnostic::unsupported(self.place(of), "this value has a type that a formula does not have")
                .hint("use floats, whole numbers, vectors, matrices, arrays of known size and structs")
        })
    }

    /// Evaluates an expression that no statement evaluates.
    fn ready(&mut self, of: ExprId) -> Result<()> {
        match self.frame.values.get(of.index()) {
            Some(Some(_)) => Ok(()),
            _ => self.evaluate(of),
        }
    }

    /// Returns the value of an expression, as an argument of a call.
    pub(super) fn argument(&mut self, of: ExprId) -> Result<Argument> {
        self.ready(of)?;
        let value = self.frame.values.get(of.index()).cloned().flatten();
        Ok(value.unwrap_or_else(|| Argument::Parts(Vec::new())))
    }

    /// Returns one part of an expression's value. Every part of a scalar is the scalar itself.
    pub(super) fn part(&mut self, of: ExprId, index: usize) -> Result<Part> {
        self.ready(of)?;
        let Some(Some(Argument::Parts(parts))) = self.frame.values.get(of.index()) else {
            return Err(Diagnostic::unsupported(self.place(of), "this is no value"));
        };
        let index = if self.info(of)?.len == 1 { 0 } else { index };
        Ok(parts.get(index).copied().unwrap_or(Part::Node(self.zero)))
    }

    pub(super) fn parts_of(&mut self, of: ExprId) -> Result<Vec<Part>> {
        let value = self.argument(of)?;
        self.info(of)?;
        match value {
            Argument::Parts(parts) => Ok(parts),
            Argument::Pointer(pointer) => self.at(self.place(of), |this| this.load(&pointer)),
        }
    }

    pub(super) fn nodes_of(&mut self, of: ExprId) -> Result<Vec<NodeId>> {
        let parts = self.parts_of(of)?.into_iter();
        self.at(self.place(of), |this| parts.map(|part| this.node(part)).collect())
    }

    /// Returns a part of an expression's value as a node of the graph.
    pub(super) fn node_of(&mut self, of: ExprId, index: usize) -> Result<NodeId> {
        let part = self.part(of, index)?;
        self.at(self.place(of), |this| this.node(part))
    }

    pub(super) fn pointer_of(&mut self, of: ExprId) -> Result<Pointer> {
        match self.argument(of)? {
            Argument::Pointer(pointer) => Ok(pointer),
            Argument::Parts(_) => Err(Diagnostic::unsupported(self.place(of), "this cannot be assigned to")),
        }
    }

    /// Records the value of an expression.
    pub(super) fn put(&mut self, of: ExprId, value: Argument) {
        if let Some(place) = self.frame.values.get_mut(of.index()) {
            *place = Some(value);
        }
    }

    /// Returns a part as a node of the graph.
    pub(super) fn node(&mut self, part: Part) -> Result<NodeId> {
        Ok(match part {
            Part::Node(node) => node,
            Part::Int(value) => self.graph.constant(value as f32),
            Part::Uint(value) => self.graph.constant(value as f32),
            Part::Unset(index) => return Err(self.unset(index)),
        })
    }

    fn unset(&self, index: u32) -> Diagnostic {
        let mut globals = self.file.module.global_variables.iter();
        let name = globals.nth(index as usize).and_then(|(_, global)| global.name.clone());
        let name = name.unwrap_or_default();
        let message = format!("`{name}` comes from outside of the GLSL, and has no value here");
        Diagnostic::unsupported(self.here, message).hint(format!(
            "declare `let {name} = …` or `param {name} = 1` in the scene, or give it a value in the GLSL"
        ))
    }

    pub(super) fn evaluate(&mut self, of: ExprId) -> Result<()> {
        self.at(self.place(of), |this| this.evaluate_here(of))
    }

    fn evaluate_here(&mut self, of: ExprId) -> Result<()> {
        let function = self.frame.function;
        let Ok(expression) = function.expressions.try_get(of) else { return Ok(()) };
        let value = match expression {
            Expression::LocalVariable(variable) => {
                let (locals, start) = (&function.local_variables, self.frame.base as u32);
                Argument::Pointer(self.pointer_to(locals, *variable, start, |local| local.ty))
            }
            Expression::GlobalVariable(variable) => {
                let globals = &self.file.module.global_variables;
                Argument::Pointer(self.pointer_to(globals, *variable, 0, |global| global.ty))
            }
            Expression::FunctionArgument(index) => {
                let argument = self.frame.arguments.get(*index as usize).cloned();
                argument.ok_or_else(|| Diagnostic::new(self.here, "an argument is missing"))?
            }
            Expression::AccessIndex { base, index } => self.access(*base, *index)?,
            Expression::Access { base, index } => {
                let part = self.part(*index, 0)?;
                match self.whole(part) {
                    Some(index) => self.access(*base, u32::try_from(index).unwrap_or(0))?,
                    None => {
                        let index = self.node_of(*index, 0)?;
                        self.access_computed(*base, index)?
                    }
                }
            }
            Expression::CallResult(_) => {
                return Err(Diagnostic::unsupported(self.here, "this call has no result"));
            }
            _ => {
                let parts = self.value(expression)?;
                self.step(parts.len())?;
                Argument::Parts(parts)
            }
        };
        self.put(of, value);
        Ok(())
    }

    fn value(&mut self, expression: &Expression) -> Result<Vec<Part>> {
        if let Some(parts) = self.composed(expression, Self::parts_of)? {
            return Ok(parts);
        }
        let here = self.here;
        let unsupported = |message: &str| Diagnostic::unsupported(here, message);
        Ok(match expression {
            Expression::Swizzle { size, vector, pattern } => {
                let components = pattern.iter().take(*size as usize);
                let parts = components.map(|component| self.part(*vector, *component as usize));
                parts.collect::<Result<_>>()?
            }
            Expression::Load { pointer } => {
                let pointer = self.pointer_of(*pointer)?;
                self.load(&pointer)?
            }
            Expression::Unary { op, expr } => {
                let kind = self.info(*expr)?.kind;
                let parts = self.parts_of(*expr)?;
                parts.into_iter().map(|part| self.unary(*op, kind, part)).collect::<Result<_>>()?
            }
            Expression::Binary { op, left, right } => self.binary(*op, *left, *right)?,
            Expression::Select { condition, accept, reject } => self.choice(*condition, *accept, *reject)?,
            Expression::Relational { fun, argument } => {
                let nodes = self.nodes_of(*argument)?;
                self.relational(*fun, &nodes)?
            }
            Expression::Math { fun, arg, arg1, arg2, arg3 } => {
                self.math(*fun, *arg, [*arg1, *arg2, *arg3])?
            }
            Expression::As { expr, kind, convert } => self.converted(*expr, *kind, convert.is_some())?,
            Expression::ArrayLength(_) => return Err(unsupported("an array needs a known size")),
            Expression::Derivative { axis, expr, .. } if self.session.in_picture => {
                let nodes = self.nodes_of(*expr)?;
                self.derivative(*axis, &nodes)?
            }
            Expression::Derivative { .. } => {
                let message = "`dFdx`, `dFdy` and `fwidth` compare pixels, which a formula does not know";
                let hint = "use it in the sky's colour, or pass the size of the detail as a parameter";
                return Err(unsupported(message).hint(hint));
            }
            _ => return Err(unsupported("this expression has no meaning in a formula")),
        })
    }

    /// The difference of each value between this pixel and the next one.
    fn derivative(&mut self, axis: DerivativeAxis, nodes: &[NodeId]) -> Result<Vec<Part>> {
        let inputs = match axis {
            DerivativeAxis::X => &[Input::X][..],
            DerivativeAxis::Y => &[Input::Y],
            DerivativeAxis::Width => &[Input::X, Input::Y],
        };
        let mut sums = vec![self.zero; nodes.len()];
        for &input in inputs {
            self.step(self.graph.order(nodes).len())?;
            let pixel = self.graph.input(input);
            let beside =
                self.graph.with_inputs(nodes, |graph, own| (own == input).then(|| graph.add(pixel, 1.0)));
            for ((sum, &here), there) in sums.iter_mut().zip(nodes).zip(beside) {
                let mut change = self.graph.sub(there, here);
                if axis == DerivativeAxis::Width {
                    change = self.graph.abs(change);
                }
                *sum = self.graph.add(*sum, change);
            }
        }
        Ok(sums.into_iter().map(Part::Node).collect())
    }

    fn choice(&mut self, condition: ExprId, accept: ExprId, reject: ExprId) -> Result<Vec<Part>> {
        let len = self.info(accept)?.len.max(self.info(reject)?.len) as usize;
        let choose = |index| {
            let condition = self.node_of(condition, index)?;
            let (then, otherwise) = (self.part(accept, index)?, self.part(reject, index)?);
            self.select(condition, then, otherwise)
        };
        (0..len).map(choose).collect()
    }

    fn converted(&mut self, of: ExprId, kind: ScalarKind, converts: bool) -> Result<Vec<Part>> {
        let from = self.info(of)?.kind;
        let parts = self.parts_of(of)?.into_iter();
        let converted = parts.map(|part| match converts {
            true => self.convert(from, kind, part),
            false => self.reinterpret(from, kind, part),
        });
        converted.collect()
    }

    /// Selects an element with a known index.
    fn access(&mut self, base: ExprId, index: u32) -> Result<Argument> {
        self.ready(base)?;
        let info = self.info(base)?;
        let (offset, len) = if info.count > 0 {
            if index >= info.count {
                let message =
                    format!("the index {index} is outside of this value, which has {} parts", info.count);
                return Err(Diagnostic::new(self.here, message).hint("count from 0"));
            }
            (index * info.stride, info.stride)
        } else {
            let found = info.of.and_then(|of| member(&self.file.module, of, index));
            let Some(found) = found else {
                return Err(Diagnostic::new(self.here, "this value has no parts"));
            };
            found
        };
        Ok(match self.argument(base)? {
            Argument::Pointer(Pointer { start, indices, .. }) => {
                Argument::Pointer(Pointer { start: start + offset, len, indices })
            }
            Argument::Parts(parts) => {
                let (offset, len) = (offset as usize, len as usize);
                self.step(1)?;
                Argument::Parts(parts.get(offset..offset + len).unwrap_or_default().to_vec())
            }
        })
    }

    /// Selects an element with a computed index.
    fn access_computed(&mut self, base: ExprId, index: NodeId) -> Result<Argument> {
        self.ready(base)?;
        let info = self.info(base)?;
        if info.count == 0 {
            return Err(Diagnostic::new(self.here, "this value has no elements"));
        }
        let parts = match self.argument(base)? {
            Argument::Pointer(mut pointer) => {
                pointer.len = info.stride;
                pointer.indices.push((index, info.count, info.stride));
                return Ok(Argument::Pointer(pointer));
            }
            Argument::Parts(parts) => parts,
        };
        self.step(parts.len())?;
        let mut elements = parts.chunks(info.stride.max(1) as usize);
        let chosen =
            self.chosen(index, info.count, |_, _| Ok(elements.next().unwrap_or_default().to_vec()))?;
        Ok(Argument::Parts(chosen))
    }

    /// Returns the element with a computed index, or the first one if there is no such element. `element` returns the
    /// parts of each element in turn.
    pub(super) fn chosen(
        &mut self,
        index: NodeId,
        count: u32,
        mut element: impl FnMut(&mut Self, u32) -> Result<Vec<Part>>,
    ) -> Result<Vec<Part>> {
        let mut result = element(self, 0)?;
        for number in 1..count {
            let parts = element(self, number)?;
            let number = self.graph.constant(number as f32);
            let chosen = self.graph.binary(Op::Equal, index, number);
            for (before, part) in result.iter_mut().zip(parts) {
                *before = self.select(chosen, part, *before)?;
            }
        }
        Ok(result)
    }

    pub(super) fn literal(&mut self, literal: Literal) -> Result<Part> {
        let value = match literal {
            Literal::F32(value) => f64::from(value),
            Literal::F64(value) | Literal::AbstractFloat(value) => value,
            Literal::I32(value) => return Ok(Part::Int(value)),
            Literal::U32(value) => return Ok(Part::Uint(value)),
            Literal::I64(value) | Literal::AbstractInt(value) => return Ok(Part::Int(value as i32)),
            Literal::U64(value) => return Ok(Part::Uint(value as u32)),
            Literal::Bool(value) => return Ok(Part::Node(if value { self.one } else { self.zero })),
            _ => {
                return Err(Diagnostic::unsupported(
                    self.here,
                    "this number has a type that a formula does not have",
                ));
            }
        };
        if !(value as f32).is_finite() {
            return Err(
                Diagnostic::new(self.here, "this number is not finite").hint("write a number below 1e38")
            );
        }
        Ok(Part::Node(self.graph.constant(value as f32)))
    }

    /// Returns the value 0 of a type.
    pub(super) fn zeros(&self, of: Handle<Type>) -> Result<Vec<Part>> {
        let module = &self.file.module;
        let wrong = || {
            Diagnostic::unsupported(self.here, "this variable has a type that a formula does not have")
                .hint("use floats, whole numbers, vectors, matrices, arrays of known size and structs")
        };
        let Some(len) = size(module, of) else { return Err(wrong()) };
        let zero = |kind| match kind {
            ScalarKind::Sint => Part::Int(0),
            ScalarKind::Uint => Part::Uint(0),
            _ => Part::Node(self.zero),
        };
        Ok(match &module.types.get_handle(of).map_err(|_| wrong())?.inner {
            TypeInner::Scalar(scalar)
            | TypeInner::Vector { scalar, .. }
            | TypeInner::Matrix { scalar, .. } => vec![zero(scalar.kind); len as usize],
            TypeInner::Array { base, size: naga::ArraySize::Constant(count), .. } => {
                self.zeros(*base)?.repeat(count.get() as usize)
            }
            TypeInner::Struct { members, .. } => {
                let members = members.iter().map(|member| self.zeros(member.ty));
                members.collect::<Result<Vec<_>>>()?.concat()
            }
            _ => return Err(wrong()),
        })
    }

    /// Returns a constant value of the module.
    pub(super) fn global_value(&mut self, of: ExprId) -> Result<Vec<Part>> {
        self.step(1)?;
        let module = &self.file.module;
        let Ok(expression) = module.global_expressions.try_get(of) else { return Ok(Vec::new()) };
        self.composed(expression, Self::global_value)?.ok_or_else(|| {
            Diagnostic::unsupported(self.here, "this constant is computed in an unsupported way")
        })
    }

    /// Returns the value of an expression that is a constant, or is composed of others, which `parts_of` returns; `None`
    /// for another expression.
    fn composed(
        &mut self,
        expression: &Expression,
        mut parts_of: impl FnMut(&mut Self, ExprId) -> Result<Vec<Part>>,
    ) -> Result<Option<Vec<Part>>> {
        Ok(Some(match expression {
            Expression::Literal(literal) => vec![self.literal(*literal)?],
            Expression::Constant(constant) => match self.file.module.constants.try_get(*constant) {
                Ok(constant) => self.global_value(constant.init)?,
                Err(_) => Vec::new(),
            },
            Expression::ZeroValue(of) => self.zeros(*of)?,
            Expression::Compose { ty, components } => {
                let parts = components.iter().map(|component| parts_of(self, *component));
                let mut parts = parts.collect::<Result<Vec<_>>>()?.concat();
                // naga takes the vector of `mat2(vec4)` for each column.
                parts.truncate(size(&self.file.module, *ty).map_or(usize::MAX, |size| size as usize));
                parts
            }
            Expression::Splat { size, value } => parts_of(self, *value)?.repeat(*size as usize),
            _ => return Ok(None),
        }))
    }
}
