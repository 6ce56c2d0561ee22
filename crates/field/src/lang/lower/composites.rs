//! Lowers matrices and records.

use super::super::ast::{BinaryOp, ExprId, Type};
use super::super::builtin::{BuiltinRow, MatrixFunction};
use super::super::diagnostic::Diagnostic;
use super::super::source::Span;
use super::super::symbol::Symbol;
use super::super::value::{Composites, Matrix, Value, Vector};
use super::lowering::Lowering;
use crate::graph::{Graph, NodeId, Op, matrices};

impl Lowering<'_> {
    /// Lowers `(name = value, …)`.
    pub(super) fn record(&mut self, first: u32, count: u32, span: Span) -> Value {
        let mut fields: Vec<(Symbol, Value)> = Vec::new();
        for index in 0..count {
            let name = Symbol(self.ast.extra(first + 2 * index));
            let value = self.expr_below(ExprId(self.ast.extra(first + 2 * index + 1)), span);
            if fields.iter().any(|(known, _)| *known == name) {
                let message = format!("the record has two values called `{}`", self.name(name));
                return self
                    .reports
                    .add(Diagnostic::new(span, message).hint("choose another name for one of them"));
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

    /// Calls a function that makes or takes a matrix, with the arguments from `mark` on.
    pub(super) fn matrix_function(
        &mut self,
        row: &BuiltinRow,
        function: MatrixFunction,
        mark: usize,
        span: Span,
    ) -> Value {
        let arguments: Vec<Value> = self.arguments.iter().skip(mark).copied().collect();
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
        let hint = format!("it is declared as `{}({})`", row.name, row.parameters);
        self.reports.add(Diagnostic::new(span, message).hint(hint))
    }
}

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
        if a.size() != b.size() {
            return None;
        }
        let parts = a.parts().iter().zip(b.parts()).map(|(a, b)| f(self.graph, *a, *b)).collect();
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
        let parts = self.composites.matrix(a)?.parts().iter().map(|part| f(self.graph, *part)).collect();
        self.add(parts)
    }

    /// The product of two matrices, or of a matrix and a vector.
    fn product(&mut self, left: Value, right: Value) -> Option<Value> {
        let (a, a_columns, a_rows) = operand(self.composites, &left)?;
        let (b, b_columns, b_rows) = operand(self.composites, &right)?;
        if a_rows != b_rows {
            return None;
        }
        let parts = matrices::product(self.graph, a, (a_columns, a_rows), b, (b_columns, b_rows));
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
        let (parts, size) = (matrix.parts(), usize::from(matrix.size()));
        let made = match function {
            MatrixFunction::Transpose => matrices::transposed(parts, size, size),
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
                    let columns = larger.parts().chunks(usize::from(larger.size())).take(size);
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
        Value::Matrix(index) => composites.matrix(*index).map(|one| (one.parts(), one.size(), one.size())),
        Value::Vector(vector) => Some((vector.parts(), 0, vector.len() as u8)),
        _ => None,
    }
}
