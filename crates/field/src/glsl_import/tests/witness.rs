//! A second interpreter of naga's IR, over plain numbers. It shares nothing with the symbolic one but the parsed file:
//! values are trees, and statements are executed, not merged.

use naga::{
    BinaryOperator, Block, Expression, Function, Handle, Literal, MathFunction, Module, RelationalFunction,
    ScalarKind, Statement, SwitchValue, SwizzleComponent, Type, TypeInner, UnaryOperator,
};

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value {
    Float(f32),
    Int(i32),
    Uint(u32),
    Bool(bool),
    List(Vec<Value>),
    /// A variable, by its index in the memory, and the indices of the element.
    Pointer(usize, Vec<usize>),
}

impl Value {
    fn list(&self) -> &[Value] {
        match self {
            Value::List(list) => list,
            other => panic!("no list: {other:?}"),
        }
    }

    pub(super) fn float(&self) -> f32 {
        match *self {
            Value::Float(value) => value,
            Value::Int(value) => value as f32,
            Value::Uint(value) => value as f32,
            Value::Bool(value) => f32::from(u8::from(value)),
            ref other => panic!("no number: {other:?}"),
        }
    }

    fn truth(&self) -> bool {
        match self {
            Value::Bool(value) => *value,
            other => panic!("no condition: {other:?}"),
        }
    }

    fn index(&self) -> usize {
        match *self {
            Value::Int(value) => value as usize,
            Value::Uint(value) => value as usize,
            ref other => panic!("no index: {other:?}"),
        }
    }

    pub(super) fn numbers(&self, out: &mut Vec<f32>) {
        match self {
            Value::List(list) => list.iter().for_each(|part| part.numbers(out)),
            other => out.push(other.float()),
        }
    }

    fn at_mut(&mut self, path: &[usize]) -> &mut Value {
        path.iter().fold(self, |value, &index| match value {
            Value::List(list) => &mut list[index],
            other => panic!("no element in {other:?}"),
        })
    }

    fn map(&self, f: &mut impl FnMut(&Value) -> Value) -> Value {
        match self {
            Value::List(list) => Value::List(list.iter().map(|part| part.map(f)).collect()),
            one => f(one),
        }
    }

    /// Combines two values of the same shape; a scalar combines with every part.
    fn zip(&self, other: &Value, f: &mut impl FnMut(&Value, &Value) -> Value) -> Value {
        match (self, other) {
            (Value::List(a), Value::List(b)) => {
                Value::List(a.iter().zip(b).map(|(a, b)| a.zip(b, f)).collect())
            }
            (Value::List(a), b) => Value::List(a.iter().map(|a| a.zip(b, f)).collect()),
            (a, Value::List(b)) => Value::List(b.iter().map(|b| a.zip(b, f)).collect()),
            (a, b) => f(a, b),
        }
    }
}

enum Flow {
    Next,
    Break,
    Continue,
    Return(Option<Value>),
}

pub(super) struct Witness<'m> {
    module: &'m Module,
    memory: Vec<Value>,
}

struct Call<'m> {
    function: &'m Function,
    values: Vec<Option<Value>>,
    arguments: Vec<Value>,
    /// Index in memory of the first local variable.
    base: usize,
}

impl<'m> Witness<'m> {
    /// Sets all globals, then runs the functions `starts` in order.
    pub(super) fn new(module: &'m Module, starts: &[Handle<Function>]) -> Self {
        let mut this = Self { module, memory: Vec::new() };
        for (_, global) in module.global_variables.iter() {
            let value = match global.init {
                Some(init) => this.constant(init),
                None => this.zero(global.ty),
            };
            this.memory.push(value);
        }
        for start in starts {
            this.call(*start, Vec::new());
        }
        this
    }

    fn zero(&self, of: Handle<Type>) -> Value {
        let scalar = |kind| match kind {
            ScalarKind::Sint => Value::Int(0),
            ScalarKind::Uint => Value::Uint(0),
            ScalarKind::Bool => Value::Bool(false),
            _ => Value::Float(0.0),
        };
        match &self.module.types[of].inner {
            TypeInner::Scalar(one) => scalar(one.kind),
            TypeInner::Vector { size, scalar: one } => Value::List(vec![scalar(one.kind); *size as usize]),
            TypeInner::Matrix { columns, rows, scalar: one } => {
                Value::List(vec![Value::List(vec![scalar(one.kind); *rows as usize]); *columns as usize])
            }
            TypeInner::Array { base, size: naga::ArraySize::Constant(count), .. } => {
                Value::List(vec![self.zero(*base); count.get() as usize])
            }
            TypeInner::Struct { members, .. } => {
                Value::List(members.iter().map(|member| self.zero(member.ty)).collect())
            }
            _ => Value::Float(0.0),
        }
    }

    fn constant(&self, of: Handle<Expression>) -> Value {
        match &self.module.global_expressions[of] {
            Expression::Literal(literal) => number(*literal),
            Expression::Constant(constant) => self.constant(self.module.constants[*constant].init),
            Expression::ZeroValue(of) => self.zero(*of),
            Expression::Compose { ty, components } => {
                self.compose(*ty, components.iter().map(|part| self.constant(*part)).collect())
            }
            Expression::Splat { size, value } => Value::List(vec![self.constant(*value); *size as usize]),
            other => panic!("no constant: {other:?}"),
        }
    }

    fn compose(&self, of: Handle<Type>, parts: Vec<Value>) -> Value {
        match self.module.types[of].inner {
            // A vector may be made of vectors.
            TypeInner::Vector { .. } => Value::List(
                parts
                    .into_iter()
                    .flat_map(|part| match part {
                        Value::List(list) => list,
                        one => vec![one],
                    })
                    .collect(),
            ),
            _ => Value::List(parts),
        }
    }

    pub(super) fn call(&mut self, handle: Handle<Function>, arguments: Vec<Value>) -> Option<Value> {
        let function = &self.module.functions[handle];
        let base = self.memory.len();
        let mut call = Call { function, values: vec![None; function.expressions.len()], arguments, base };
        for (_, local) in function.local_variables.iter() {
            let value = self.zero(local.ty);
            self.memory.push(value);
        }
        for (index, (_, local)) in function.local_variables.iter().enumerate() {
            if let Some(init) = local.init {
                self.memory[base + index] = self.value(&mut call, init);
            }
        }
        let flow = self.block(&mut call, &function.body);
        self.memory.truncate(base);
        match flow {
            Flow::Return(value) => value,
            _ => None,
        }
    }

    fn block(&mut self, call: &mut Call<'m>, block: &'m Block) -> Flow {
        for statement in block.iter() {
            match self.statement(call, statement) {
                Flow::Next => {}
                flow => return flow,
            }
        }
        Flow::Next
    }

    fn statement(&mut self, call: &mut Call<'m>, statement: &'m Statement) -> Flow {
        match statement {
            Statement::Emit(range) => {
                for handle in range.clone() {
                    let value = self.evaluate(call, handle);
                    call.values[handle.index()] = Some(value);
                }
                Flow::Next
            }
            Statement::Block(block) => self.block(call, block),
            Statement::If { condition, accept, reject } => {
                let holds = self.value(call, *condition).truth();
                self.block(call, if holds { accept } else { reject })
            }
            Statement::Switch { selector, cases } => {
                let selector = self.value(call, *selector);
                let found = cases.iter().position(|case| match case.value {
                    SwitchValue::I32(value) => selector == Value::Int(value),
                    SwitchValue::U32(value) => selector == Value::Uint(value),
                    SwitchValue::Default => false,
                });
                let default = cases.iter().position(|case| case.value == SwitchValue::Default);
                for case in cases.iter().skip(found.or(default).unwrap_or(cases.len())) {
                    match self.block(call, &case.body) {
                        Flow::Next if case.fall_through => {}
                        Flow::Next | Flow::Break => break,
                        flow => return flow,
                    }
                }
                Flow::Next
            }
            Statement::Loop { body, continuing, .. } => loop {
                match self.block(call, body) {
                    Flow::Break => return Flow::Next,
                    flow @ Flow::Return(_) => return flow,
                    _ => {}
                }
                self.block(call, continuing);
            },
            Statement::Break => Flow::Break,
            Statement::Continue => Flow::Continue,
            Statement::Return { value } => Flow::Return(value.map(|value| self.value(call, value))),
            Statement::Store { pointer, value } => {
                let value = self.value(call, *value);
                match self.value(call, *pointer) {
                    Value::Pointer(variable, path) => *self.memory[variable].at_mut(&path) = value,
                    other => panic!("no pointer: {other:?}"),
                }
                Flow::Next
            }
            Statement::Call { function, arguments, result } => {
                let arguments = arguments.iter().map(|argument| self.value(call, *argument)).collect();
                let value = self.call(*function, arguments);
                if let Some(result) = result {
                    call.values[result.index()] = value;
                }
                Flow::Next
            }
            other => panic!("unexpected {other:?}"),
        }
    }

    fn value(&mut self, call: &mut Call<'m>, of: Handle<Expression>) -> Value {
        match &call.values[of.index()] {
            Some(value) => value.clone(),
            None => self.evaluate(call, of),
        }
    }

    fn evaluate(&mut self, call: &mut Call<'m>, of: Handle<Expression>) -> Value {
        match &call.function.expressions[of] {
            Expression::Literal(literal) => number(*literal),
            Expression::Constant(constant) => self.constant(self.module.constants[*constant].init),
            Expression::ZeroValue(of) => self.zero(*of),
            Expression::Compose { ty, components } => {
                let parts = components.iter().map(|part| self.value(call, *part)).collect();
                self.compose(*ty, parts)
            }
            Expression::FunctionArgument(index) => call.arguments[*index as usize].clone(),
            Expression::GlobalVariable(global) => Value::Pointer(global.index(), Vec::new()),
            Expression::LocalVariable(local) => Value::Pointer(call.base + local.index(), Vec::new()),
            Expression::Load { pointer } => match self.value(call, *pointer) {
                Value::Pointer(variable, path) => self.memory[variable].at_mut(&path).clone(),
                other => panic!("no pointer: {other:?}"),
            },
            Expression::AccessIndex { base, index } => {
                let base = self.value(call, *base);
                element(base, *index as usize)
            }
            Expression::Access { base, index } => {
                let index = self.value(call, *index).index();
                let base = self.value(call, *base);
                element(base, index)
            }
            Expression::Splat { size, value } => Value::List(vec![self.value(call, *value); *size as usize]),
            Expression::Swizzle { size, vector, pattern } => {
                let vector = self.value(call, *vector);
                let part = |component: &SwizzleComponent| vector.list()[*component as usize].clone();
                Value::List(pattern.iter().take(*size as usize).map(part).collect())
            }
            Expression::Unary { op, expr } => self.value(call, *expr).map(&mut |part| match (op, part) {
                (UnaryOperator::Negate, Value::Float(value)) => Value::Float(-value),
                (UnaryOperator::Negate, Value::Int(value)) => Value::Int(value.wrapping_neg()),
                (UnaryOperator::BitwiseNot, Value::Int(value)) => Value::Int(!value),
                (UnaryOperator::BitwiseNot, Value::Uint(value)) => Value::Uint(!value),
                (UnaryOperator::LogicalNot, Value::Bool(value)) => Value::Bool(!value),
                other => panic!("unexpected {other:?}"),
            }),
            Expression::Binary { op, left, right } => {
                let (left, right) = (self.value(call, *left), self.value(call, *right));
                binary(*op, &left, &right)
            }
            Expression::Select { condition, accept, reject } => {
                let condition = self.value(call, *condition);
                let (then, otherwise) = (self.value(call, *accept), self.value(call, *reject));
                selected(&condition, then, otherwise)
            }
            Expression::Relational { fun, argument } => {
                let argument = self.value(call, *argument);
                match fun {
                    RelationalFunction::All => Value::Bool(argument.list().iter().all(Value::truth)),
                    RelationalFunction::Any => Value::Bool(argument.list().iter().any(Value::truth)),
                    _ => argument.map(&mut |_| Value::Bool(false)),
                }
            }
            Expression::As { expr, kind, .. } => {
                self.value(call, *expr).map(&mut |part| converted(*kind, part))
            }
            Expression::Math { fun, arg, arg1, arg2, .. } => {
                let a = self.value(call, *arg);
                let b = arg1.map(|arg| self.value(call, arg));
                let c = arg2.map(|arg| self.value(call, arg));
                super::witness_math::math(*fun, &a, b.as_ref(), c.as_ref())
            }
            other => panic!("unexpected {other:?}"),
        }
    }
}

fn selected(condition: &Value, then: Value, otherwise: Value) -> Value {
    match condition {
        Value::Bool(true) => then,
        Value::Bool(false) => otherwise,
        Value::List(list) => {
            let part = |(at, holds): (usize, &Value)| {
                let from = if holds.truth() { &then } else { &otherwise };
                from.list()[at].clone()
            };
            Value::List(list.iter().enumerate().map(part).collect())
        }
        other => panic!("no condition: {other:?}"),
    }
}

fn converted(kind: ScalarKind, part: &Value) -> Value {
    match (kind, part) {
        (ScalarKind::Sint, Value::Float(value)) => Value::Int(*value as i32),
        (ScalarKind::Uint, Value::Float(value)) => Value::Uint(*value as u32),
        (ScalarKind::Sint, Value::Uint(value)) => Value::Int(*value as i32),
        (ScalarKind::Uint, Value::Int(value)) => Value::Uint(*value as u32),
        (ScalarKind::Bool, Value::Bool(value)) => Value::Bool(*value),
        (ScalarKind::Bool, part) => Value::Bool(part.float() != 0.0),
        (ScalarKind::Float, part) => Value::Float(part.float()),
        (_, part) => part.clone(),
    }
}

fn number(literal: Literal) -> Value {
    match literal {
        Literal::F32(value) => Value::Float(value),
        Literal::I32(value) => Value::Int(value),
        Literal::U32(value) => Value::Uint(value),
        Literal::Bool(value) => Value::Bool(value),
        other => panic!("unexpected {other:?}"),
    }
}

fn element(base: Value, index: usize) -> Value {
    match base {
        Value::Pointer(variable, mut path) => {
            path.push(index);
            Value::Pointer(variable, path)
        }
        Value::List(list) => list[index].clone(),
        other => panic!("no elements: {other:?}"),
    }
}

fn is_matrix(value: &Value) -> bool {
    matches!(value, Value::List(list) if matches!(list.first(), Some(Value::List(_))))
}

fn binary(op: BinaryOperator, a: &Value, b: &Value) -> Value {
    if op == BinaryOperator::Multiply && (is_matrix(a) || is_matrix(b)) {
        match (a, b) {
            (Value::List(columns), Value::List(list)) if is_matrix(a) && !is_matrix(b) => {
                let rows = columns[0].list().len();
                let entry = |row: usize| {
                    columns.iter().zip(list).map(|(column, x)| column.list()[row].float() * x.float()).sum()
                };
                return Value::List((0..rows).map(|row| Value::Float(entry(row))).collect());
            }
            (Value::List(list), Value::List(columns)) if !is_matrix(a) => {
                let entry =
                    |column: &Value| column.list().iter().zip(list).map(|(x, y)| x.float() * y.float()).sum();
                return Value::List(columns.iter().map(|column| Value::Float(entry(column))).collect());
            }
            (Value::List(_), Value::List(columns)) => {
                return Value::List(columns.iter().map(|column| binary(op, a, column)).collect());
            }
            _ => {}
        }
    }
    a.zip(b, &mut |a, b| scalar(op, a, b))
}

fn scalar(op: BinaryOperator, a: &Value, b: &Value) -> Value {
    use BinaryOperator as Op;
    let compared = |order: Option<std::cmp::Ordering>| {
        Value::Bool(match op {
            Op::Equal => order == Some(std::cmp::Ordering::Equal),
            Op::NotEqual => order != Some(std::cmp::Ordering::Equal),
            Op::Less => order.is_some_and(std::cmp::Ordering::is_lt),
            Op::LessEqual => order.is_some_and(std::cmp::Ordering::is_le),
            Op::Greater => order.is_some_and(std::cmp::Ordering::is_gt),
            Op::GreaterEqual => order.is_some_and(std::cmp::Ordering::is_ge),
            other => panic!("unexpected {other:?}"),
        })
    };
    match (a, b) {
        (Value::Float(a), Value::Float(b)) => Value::Float(match op {
            Op::Add => a + b,
            Op::Subtract => a - b,
            Op::Multiply => a * b,
            Op::Divide => a / b,
            Op::Modulo => a % b,
            _ => return compared(a.partial_cmp(b)),
        }),
        (Value::Int(a), Value::Int(b)) => Value::Int(match op {
            Op::Add => a.wrapping_add(*b),
            Op::Subtract => a.wrapping_sub(*b),
            Op::Multiply => a.wrapping_mul(*b),
            Op::Divide => a / b,
            Op::Modulo => a % b,
            Op::And => a & b,
            Op::InclusiveOr => a | b,
            Op::ExclusiveOr => a ^ b,
            _ => return compared(a.partial_cmp(b)),
        }),
        (Value::Int(a), Value::Uint(b)) => {
            Value::Int(if op == Op::ShiftLeft { a.wrapping_shl(*b) } else { a.wrapping_shr(*b) })
        }
        (Value::Uint(a), Value::Uint(b)) => Value::Uint(match op {
            Op::Add => a.wrapping_add(*b),
            Op::Subtract => a.wrapping_sub(*b),
            Op::Multiply => a.wrapping_mul(*b),
            Op::Divide => a / b,
            Op::Modulo => a % b,
            Op::And => a & b,
            Op::InclusiveOr => a | b,
            Op::ExclusiveOr => a ^ b,
            Op::ShiftLeft => a.wrapping_shl(*b),
            Op::ShiftRight => a.wrapping_shr(*b),
            _ => return compared(a.partial_cmp(b)),
        }),
        (Value::Bool(a), Value::Bool(b)) => Value::Bool(match op {
            Op::And | Op::LogicalAnd => *a && *b,
            Op::InclusiveOr | Op::LogicalOr => *a || *b,
            _ => return compared(a.partial_cmp(b)),
        }),
        other => panic!("unexpected {op:?} of {other:?}"),
    }
}

/// The parts of a vector or the scalar itself.
pub(super) fn floats(value: &Value) -> Vec<f32> {
    let mut out = Vec::new();
    value.numbers(&mut out);
    out
}

pub(super) fn each(of: MathFunction, a: &Value, f: impl Fn(f32) -> f32) -> Value {
    let _ = of;
    a.map(&mut |part| Value::Float(f(part.float())))
}
