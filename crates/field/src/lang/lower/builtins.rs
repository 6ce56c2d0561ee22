//! Calls of built-in functions, which become operators and inputs of the graph.

use super::super::ast::{BinaryOp, ExprId, Type};
use super::super::builtin::{Builtin, BuiltinRow, MatrixFunction, uses};
use super::super::diagnostic::Diagnostic;
use super::super::source::Span;
use super::super::symbol::Symbol;
use super::super::value::{Composites, Matrix, Value, Vector};
use super::call::Call;
use super::expr::zip;
use super::lowering::Lowering;
use super::motions::MotionCall;
use super::reads::Read;
use crate::graph::{Graph, Input, LevelList, NodeId, Op, matrices};

/// The index with which a scene reads a level of a list.
pub(super) enum Number {
    Known(usize),
    Computed(NodeId),
}

impl Lowering<'_> {
    pub(super) fn builtin(&mut self, row: &'static BuiltinRow, call: Call) -> Value {
        let Call { name, mark, span, .. } = call;
        let count = self.arguments.len() - mark;
        let (least, most) = row.arguments;
        if count < least || count > most {
            let hint = format!("it is declared as `{}`", row.signature());
            self.reports.count_message(name, count, row.arguments, hint, span);
            return Value::Unknown;
        }
        match (row.builtin, self.arguments.get(mark).copied()) {
            (Builtin::Texture | Builtin::Previous | Builtin::Shape(_), _) => {
                let mut read = Read { outer: self, name: row.name, call };
                let value = match row.builtin {
                    Builtin::Texture => read.texture(),
                    Builtin::Shape(call) => read.shape(call),
                    _ => read.last_frame(),
                };
                return value.unwrap_or(Value::Unknown);
            }
            (Builtin::Motion(kind), _) => return MotionCall { outer: self, row, kind, call }.value(),
            (Builtin::Matrix(function), _) => return self.matrix_function(row, function, call),
            (Builtin::Float, Some(Value::Bool(part))) => return Value::scalar(part),
            _ => {}
        }
        let mut vectors = [None; 4];
        for (index, slot) in vectors.iter_mut().enumerate().take(count) {
            let value = self.arguments.get(mark + index).copied().unwrap_or(Value::Unknown);
            let place = self.argument_span(call, index);
            let Some(vector) = self.number(value, place, || format!("`{}`", row.name)) else {
                return Value::Unknown;
            };
            *slot = Some(vector);
        }
        if matches!(row.builtin, Builtin::Table(_)) {
            self.used(uses::FRAME, row.name, span);
        }
        match (row.builtin, vectors) {
            (Builtin::Each(op) | Builtin::OneOrTwo(op, _) | Builtin::Table(op), [Some(a), None, ..]) => {
                Value::Vector(a.map(|part| self.graph.unary(op, part)))
            }
            (Builtin::Float, [Some(a), ..]) if a.len() == 1 => Value::Vector(a),
            (Builtin::Pair(op) | Builtin::OneOrTwo(_, op) | Builtin::Table(op), [Some(a), Some(b), ..]) => {
                self.pair(op, a, b, row.name, span)
            }
            (Builtin::Pow, [Some(a), Some(b), ..]) if sizes_fit(&[a, b]) => {
                let b = self.with_known(b);
                zip(&mut self.graph, a, b, |graph, a, b| graph.pow(a, b))
            }
            (Builtin::Mix | Builtin::Clamp | Builtin::Smoothstep, [Some(a), Some(b), Some(c), _])
                if sizes_fit(&[a, b, c]) =>
            {
                triple(&mut self.graph, row.builtin, a, b, c)
            }
            (Builtin::Length, [Some(a), ..]) => Value::scalar(self.graph.length(a.parts())),
            (Builtin::Dot, [Some(a), Some(b), ..]) if a.len() == b.len() => {
                Value::scalar(self.graph.dot(a.parts(), b.parts()))
            }
            (Builtin::Construct(len), _) => self.construct(row.name, len, &vectors, span),
            (Builtin::Levels(list), [Some(a), ..]) => self.level(list, a, span),
            _ => {
                let arguments = vectors.iter().flatten();
                let types: Vec<&str> = arguments.map(|&vector| Value::Vector(vector).described()).collect();
                let message =
                    format!("`{}` needs vectors of the same size, not {}", row.name, types.join(" and "));
                let hint = format!("it is declared as `{}`", row.signature());
                self.reports.add(Diagnostic::new(span, message).hint(hint))
            }
        }
    }

    /// Notes that a function of the language uses these inputs.
    pub(super) fn used(&mut self, kind: u16, name: &str, span: Span) {
        if let Some(symbol) = self.names.get(name) {
            self.inputs.declare(kind, symbol, span, &mut self.reports);
        }
    }

    fn pair(&mut self, op: Op, a: Vector, b: Vector, name: &str, span: Span) -> Value {
        if !sizes_fit(&[a, b]) {
            return self.reports.sizes_differ(&format!("`{name}`"), Value::Vector(a), Value::Vector(b), span);
        }
        zip(&mut self.graph, a, b, |graph, a, b| graph.binary(op, a, b))
    }

    /// Builds a vector of `len` components: from one number, from the first components of a longer vector, or from
    /// parts that have `len` components in total.
    fn construct(&mut self, name: &str, len: u8, vectors: &[Option<Vector>; 4], span: Span) -> Value {
        let len = usize::from(len);
        let Some(first) = vectors[0] else { return Value::Unknown };
        let (mut parts, mut count) = ([first.first(); 4], 0);
        for &part in vectors.iter().flatten().flat_map(Vector::parts) {
            if let Some(slot) = parts.get_mut(count) {
                *slot = part;
            }
            count += 1;
        }
        let single = vectors[1].is_none();
        let fit = count == len || (single && (count == 1 || count > len));
        match parts.get(..len).and_then(Vector::from_slice) {
            Some(vector) if fit => Value::Vector(vector),
            _ => {
                let message = format!("`{name}` needs {len} numbers, but gets {count}");
                let hint =
                    format!("write one number for all components, or parts with {len} components in total");
                self.reports.add(Diagnostic::new(span, message).hint(hint))
            }
        }
    }

    fn level(&mut self, list: LevelList, index: Vector, span: Span) -> Value {
        match self.level_number(list, index, span) {
            Some(Number::Known(number)) => match list.level(number) {
                Some(level) => Value::scalar(self.graph.input(Input::Level(level))),
                None => Value::Unknown,
            },
            Some(Number::Computed(part)) => Value::scalar(self.graph.unary(Op::of_levels(list), part)),
            None => Value::Unknown,
        }
    }

    /// Returns the number of a level of a list. A number out of range is reported and gives `None`. The reader clamps a
    /// computed number to the list and rounds it down.
    pub(super) fn level_number(&mut self, list: LevelList, index: Vector, span: Span) -> Option<Number> {
        let name = list.name();
        self.used(uses::FRAME, name, span);
        if index.len() != 1 {
            let message = format!("`{name}` takes a number, not {}", Value::Vector(index).described());
            return self.reports.refuse(Diagnostic::new(span, message));
        }
        let part = index.first();
        let Some(number) = self.known(part) else { return Some(Number::Computed(part)) };
        if number < 0.0 || number >= list.count() as f32 || number.fract() != 0.0 {
            let message = format!("there is no {} {number}", list.what());
            return self.reports.refuse(Diagnostic::new(span, message).hint(list.numbers()));
        }
        Some(Number::Known(number as usize))
    }

    /// Lowers `(name = value, …)`.
    pub(super) fn record(&mut self, first: u32, count: u32, span: Span) -> Value {
        let mut fields: Vec<(Symbol, Value)> = Vec::new();
        for index in 0..count {
            let name = Symbol(self.ast.extra(first + 2 * index));
            let value = self.expr_below(ExprId(self.ast.extra(first + 2 * index + 1)), span);
            if fields.iter().any(|(known, _)| *known == name) {
                let message = format!("the record has two values called `{}`", self.name(name));
                let hint = "choose another name for one of them";
                return self.reports.add(Diagnostic::new(span, message).hint(hint));
            }
            fields.push((name, value));
        }
        self.scope.composites.add_record(fields)
    }

    pub(super) fn record_field(&mut self, record: u32, name: Symbol, span: Span) -> Value {
        let found = self.scope.composites.record(record).iter().find(|(known, _)| *known == name);
        if let Some((_, value)) = found {
            return *value;
        }
        let message = format!("the record has no value `{}`", self.name(name));
        let hint = self.scope.composites.fields_in_words(record, self.names);
        self.reports.add(Diagnostic::new(span, message).hint(hint))
    }

    /// Lowers an operator with a matrix on at least one side.
    #[cold]
    pub(super) fn matrix_binary(&mut self, op: BinaryOp, left: Value, right: Value, span: Span) -> Value {
        if let Some(value) = Matrices::of(self).binary(op, left, right) {
            return value;
        }
        let types = &self.scope.composites;
        let described = |value| types.type_of(value).map_or("a record", Type::described);
        let (a, b) = (described(left), described(right));
        let message = format!("`{}` cannot combine {a} and {b}", op.sign());
        let hint = "a mat2 multiplies a vec2, and a mat3 a vec3";
        self.reports.add(Diagnostic::new(span, message).hint(hint))
    }

    /// Calls a function that makes or takes a matrix.
    fn matrix_function(&mut self, row: &BuiltinRow, function: MatrixFunction, call: Call) -> Value {
        let arguments: Vec<Value> = self.arguments.iter().skip(call.mark).copied().collect();
        if arguments.contains(&Value::Unknown) {
            return Value::Unknown;
        }
        if let Some(value) = Matrices::of(self).function(function, &arguments) {
            return value;
        }
        let types: Vec<&str> = arguments.iter().map(|value| value.described()).collect();
        let message = match function {
            MatrixFunction::Construct(size) => format!(
                "`{}` needs {size} columns, or {} numbers in the order of the columns",
                row.name,
                size * size
            ),
            _ => format!("`{}` takes a matrix, not {}", row.name, types.join(" and ")),
        };
        let hint = format!("it is declared as `{}`", row.signature());
        self.reports.add(Diagnostic::new(call.span, message).hint(hint))
    }
}

/// True if all vectors have the same size or are scalars, which fit every size.
pub(super) fn sizes_fit(vectors: &[Vector]) -> bool {
    let most = vectors.iter().map(|vector| vector.len()).max().unwrap_or(1);
    vectors.iter().all(|vector| vector.len() == 1 || vector.len() == most)
}

/// Applies a function of three numbers to each component. The sizes must fit.
fn triple(graph: &mut Graph, builtin: Builtin, a: Vector, b: Vector, c: Vector) -> Value {
    let len = a.len().max(b.len()).max(c.len());
    let mut parts = [a.first(); 4];
    for (index, part) in parts.iter_mut().enumerate().take(len) {
        let (a, b, c) = (a.part(index), b.part(index), c.part(index));
        *part = match builtin {
            Builtin::Mix => graph.mix(a, b, c),
            Builtin::Clamp => graph.clamp(a, b, c),
            _ => graph.smoothstep(a, b, c),
        };
    }
    Value::of(parts.get(..len).unwrap_or(&parts))
}

// Lowers matrices and records.

/// Computes with the matrices of a scene. The methods return `None` for operands that do not fit.
pub(super) struct Matrices<'l> {
    graph: &'l mut Graph,
    composites: &'l mut Composites,
}

impl<'l> Matrices<'l> {
    pub(super) fn of(lowering: &'l mut Lowering<'_>) -> Self {
        Self { graph: &mut lowering.graph, composites: &mut lowering.scope.composites }
    }

    fn add(&mut self, parts: Vec<NodeId>) -> Option<Value> {
        Some(self.composites.add_matrix(Matrix::of_parts(parts)?))
    }

    /// Combines the elements of two matrices.
    pub(super) fn pair(
        &mut self,
        a: u32,
        b: u32,
        mut f: impl FnMut(&mut Graph, NodeId, NodeId) -> NodeId,
    ) -> Option<Value> {
        let (a, b) = (self.composites.matrix(a)?, self.composites.matrix(b)?);
        if a.size != b.size {
            return None;
        }
        let parts = a.parts.iter().zip(&b.parts).map(|(a, b)| f(self.graph, *a, *b)).collect();
        self.add(parts)
    }

    fn binary(&mut self, op: BinaryOp, left: Value, right: Value) -> Option<Value> {
        let operator = match op {
            BinaryOp::Add => Op::Add,
            BinaryOp::Subtract => Op::Sub,
            BinaryOp::Multiply => Op::Mul,
            BinaryOp::Divide => Op::Div,
            _ => return None,
        };
        match (left, right) {
            (Value::Matrix(a), Value::Vector(b)) if b.len() == 1 => {
                self.each_element(a, |graph, part| graph.binary(operator, part, b.first()))
            }
            (Value::Vector(a), Value::Matrix(b)) if a.len() == 1 => {
                self.each_element(b, |graph, part| graph.binary(operator, a.first(), part))
            }
            _ if operator == Op::Mul => self.product(left, right),
            (Value::Matrix(a), Value::Matrix(b)) => {
                self.pair(a, b, |graph, a, b| graph.binary(operator, a, b))
            }
            _ => None,
        }
    }

    fn each_element(&mut self, a: u32, mut f: impl FnMut(&mut Graph, NodeId) -> NodeId) -> Option<Value> {
        let parts = self.composites.matrix(a)?.parts.iter().map(|part| f(self.graph, *part)).collect();
        self.add(parts)
    }

    /// The product of two matrices, or of a matrix and a vector.
    fn product(&mut self, left: Value, right: Value) -> Option<Value> {
        let (a, a_columns, a_rows) = operand(self.composites, &left)?;
        let (b, b_columns, b_rows) = operand(self.composites, &right)?;
        if a_rows != b_rows {
            return None;
        }
        let parts = matrices::product(self.graph, a, a_columns, b, b_columns);
        match Vector::from_slice(&parts) {
            Some(vector) if a_columns == 0 || b_columns == 0 => Some(Value::Vector(vector)),
            _ => self.add(parts),
        }
    }

    fn function(&mut self, function: MatrixFunction, arguments: &[Value]) -> Option<Value> {
        if let MatrixFunction::Construct(size) = function {
            return self.construct(usize::from(size), arguments);
        }
        let [Value::Matrix(index)] = arguments else { return None };
        let matrix = self.composites.matrix(*index)?;
        let (parts, size) = (&matrix.parts, usize::from(matrix.size));
        let made = match function {
            MatrixFunction::Transpose => matrices::transposed(parts, size),
            MatrixFunction::Inverse => matrices::inverse(self.graph, parts, size),
            _ => return Some(Value::scalar(matrices::determinant(self.graph, parts, size))),
        };
        self.add(made)
    }

    /// Builds a matrix from one number for the diagonal, from a larger matrix, or from its elements by columns.
    fn construct(&mut self, size: usize, arguments: &[Value]) -> Option<Value> {
        let mut parts = Vec::new();
        for argument in arguments {
            match argument {
                Value::Vector(vector) => parts.extend_from_slice(vector.parts()),
                Value::Matrix(index) if arguments.len() == 1 => {
                    let larger = self.composites.matrix(*index)?;
                    let columns = larger.parts.chunks(usize::from(larger.size)).take(size);
                    parts.extend(columns.flat_map(|column| column.iter().take(size)));
                }
                _ => return None,
            }
        }
        if let [diagonal] = parts[..] {
            let zero = self.graph.constant(0.0);
            parts = (0..size * size).map(|at| if at % (size + 1) == 0 { diagonal } else { zero }).collect();
        }
        if parts.len() == size * size { self.add(parts) } else { None }
    }
}

/// The elements of a matrix or vector, the number of its columns (0 for a vector), and the number of its rows.
fn operand<'v>(composites: &'v Composites, value: &'v Value) -> Option<(&'v [NodeId], u8, u8)> {
    match value {
        Value::Matrix(index) => {
            composites.matrix(*index).map(|one| (one.parts.as_slice(), one.size, one.size))
        }
        Value::Vector(vector) => Some((vector.parts(), 0, vector.len() as u8)),
        _ => None,
    }
}
