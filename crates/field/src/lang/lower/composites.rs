//! Lowers matrices and records.

use super::super::ast::{BinaryOp, ExprId, Type};
use super::super::builtin::{BuiltinRow, MatrixFunction};
use super::super::diagnostic::Diagnostic;
use super::super::source::Span;
use super::super::symbol::Symbol;
use super::super::value::{Composites, Matrix, Value, Vector};
use super::lowering::Lowering;
use crate::graph::{Graph, NodeId, Op};

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

    fn add(&mut self, columns: Option<Vec<Vector>>) -> Option<Value> {
        Some(self.composites.add_matrix(Matrix::of_columns(&columns?)?))
    }

    /// Combines the elements of two matrices.
    pub(super) fn pair(
        &mut self,
        a: u32,
        b: u32,
        mut f: impl FnMut(&mut Graph, NodeId, NodeId) -> NodeId,
    ) -> Option<Value> {
        let (a, b) = (self.composites.matrix(a)?, self.composites.matrix(b)?);
        if a.len() != b.len() {
            return None;
        }
        let graph = &mut *self.graph;
        let columns = a.columns().iter().zip(b.columns()).map(|(a, b)| a.zip(*b, |a, b| f(graph, a, b)));
        let columns = columns.collect();
        self.add(columns)
    }

    fn binary(&mut self, op: BinaryOp, left: Value, right: Value) -> Option<Value> {
        let operator = match op {
            BinaryOp::Add => Op::Add,
            BinaryOp::Subtract => Op::Sub,
            BinaryOp::Multiply => Op::Mul,
            BinaryOp::Divide => Op::Div,
            _ => return None,
        };
        match (operator, left, right) {
            (Op::Mul, Value::Matrix(a), Value::Matrix(b)) => self.product(a, b),
            (Op::Mul, Value::Matrix(a), Value::Vector(b)) if b.len() > 1 => {
                let a = self.composites.matrix(a)?;
                times(self.graph, &a, b).map(Value::Vector)
            }
            (Op::Mul, Value::Vector(a), Value::Matrix(b)) if a.len() > 1 => {
                let b = transposed(&self.composites.matrix(b)?)?;
                times(self.graph, &b, a).map(Value::Vector)
            }
            (_, Value::Matrix(a), Value::Matrix(b)) => {
                self.pair(a, b, |graph, a, b| graph.binary(operator, a, b))
            }
            (_, Value::Matrix(a), Value::Vector(b)) if b.len() == 1 => {
                self.each_element(a, |graph, part| graph.binary(operator, part, b.first()))
            }
            (_, Value::Vector(a), Value::Matrix(b)) if a.len() == 1 => {
                self.each_element(b, |graph, part| graph.binary(operator, a.first(), part))
            }
            _ => None,
        }
    }

    fn each_element(&mut self, a: u32, mut f: impl FnMut(&mut Graph, NodeId) -> NodeId) -> Option<Value> {
        let matrix = self.composites.matrix(a)?;
        let columns = matrix.columns().iter().map(|column| column.map(|part| f(self.graph, part)));
        let columns = columns.collect();
        self.add(Some(columns))
    }

    fn product(&mut self, a: u32, b: u32) -> Option<Value> {
        let (a, b) = (self.composites.matrix(a)?, self.composites.matrix(b)?);
        let columns = b.columns().iter().map(|column| times(self.graph, &a, *column)).collect();
        self.add(columns)
    }

    fn function(&mut self, function: MatrixFunction, arguments: &[Value]) -> Option<Value> {
        if let MatrixFunction::Construct(size) = function {
            return self.construct(usize::from(size), arguments);
        }
        let [Value::Matrix(index)] = arguments else { return None };
        let matrix = self.composites.matrix(*index)?;
        let made = match function {
            MatrixFunction::Transpose => transposed(&matrix)?,
            MatrixFunction::Inverse => inverse(self.graph, &matrix)?,
            _ => return Some(Value::scalar(determinant(self.graph, &matrix))),
        };
        Some(self.composites.add_matrix(made))
    }

    /// Builds a matrix from one number for the diagonal, from a larger matrix, or from its elements by columns.
    fn construct(&mut self, size: usize, arguments: &[Value]) -> Option<Value> {
        if let [Value::Matrix(index)] = arguments {
            let larger = self.composites.matrix(*index)?;
            let columns = larger.columns().get(..size)?.iter();
            let columns = columns.map(|column| column.parts().get(..size).and_then(Vector::from_slice));
            let columns = columns.collect();
            return self.add(columns);
        }
        let mut parts = Vec::new();
        for argument in arguments {
            let Value::Vector(vector) = argument else { return None };
            parts.extend_from_slice(vector.parts());
        }
        if let [diagonal] = parts[..] {
            let zero = self.graph.constant(0.0);
            parts = (0..size * size).map(|at| if at % (size + 1) == 0 { diagonal } else { zero }).collect();
        }
        if parts.len() != size * size {
            return None;
        }
        let columns = parts.chunks(size).map(Vector::from_slice).collect();
        self.add(columns)
    }
}

/// The product of a matrix and a column vector. `None` if the sizes differ.
fn times(graph: &mut Graph, a: &Matrix, v: Vector) -> Option<Vector> {
    if a.len() != v.len() {
        return None;
    }
    let rows: Vec<NodeId> = (0..a.len())
        .map(|row| {
            let parts: Vec<NodeId> = (0..a.len()).map(|column| a.part(column, row)).collect();
            graph.dot(&parts, v.parts())
        })
        .collect();
    Vector::from_slice(&rows)
}

fn transposed(a: &Matrix) -> Option<Matrix> {
    let rows: Option<Vec<Vector>> = (0..a.len())
        .map(|row| {
            let parts: Vec<NodeId> = (0..a.len()).map(|column| a.part(column, row)).collect();
            Vector::from_slice(&parts)
        })
        .collect();
    Matrix::of_columns(&rows?)
}

/// a * b - c * d.
fn difference(graph: &mut Graph, a: NodeId, b: NodeId, c: NodeId, d: NodeId) -> NodeId {
    let (first, second) = (graph.mul(a, b), graph.mul(c, d));
    graph.sub(first, second)
}

/// The determinant of the matrix without this column and row, with the sign of its place.
fn cofactor(graph: &mut Graph, a: &Matrix, column: usize, row: usize) -> NodeId {
    let next = |index: usize, step: usize| (index + step) % 3;
    // Taking the other rows and columns in cyclic order gives the sign.
    let (c1, c2, r1, r2) = (next(column, 1), next(column, 2), next(row, 1), next(row, 2));
    difference(graph, a.part(c1, r1), a.part(c2, r2), a.part(c2, r1), a.part(c1, r2))
}

fn determinant(graph: &mut Graph, a: &Matrix) -> NodeId {
    if a.len() == 2 {
        return difference(graph, a.part(0, 0), a.part(1, 1), a.part(1, 0), a.part(0, 1));
    }
    let cofactors = [0, 1, 2].map(|column| cofactor(graph, a, column, 0));
    let first_row = [0, 1, 2].map(|column| a.part(column, 0));
    graph.dot(&first_row, &cofactors)
}

/// The adjugate divided by the determinant (Cramer's rule); zeros if the determinant is 0.
fn inverse(graph: &mut Graph, a: &Matrix) -> Option<Matrix> {
    let determinant = determinant(graph, a);
    let size = a.len();
    let mut columns = Vec::with_capacity(size);
    for column in 0..size {
        let mut parts = Vec::with_capacity(size);
        for row in 0..size {
            // The element of the adjugate is the cofactor of the transposed place.
            let part = match (size, column, row) {
                (2, 0, 0) => a.part(1, 1),
                (2, 1, 1) => a.part(0, 0),
                (2, _, _) => graph.neg(a.part(column, row)),
                _ => cofactor(graph, a, row, column),
            };
            parts.push(graph.div(part, determinant));
        }
        columns.push(Vector::from_slice(&parts)?);
    }
    Matrix::of_columns(&columns)
}
