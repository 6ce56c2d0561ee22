//! Lowers matrices and records.

use super::super::ast::{BinaryOp, ExprId};
use super::super::builtin::{BuiltinRow, MatrixFunction};
use super::super::diagnostic::Diagnostic;
use super::super::source::Span;
use super::super::symbol::Symbol;
use super::super::value::{Matrix, Value, Vector};
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
        let hint = self.fields_of(record);
        self.reports.add(Diagnostic::new(span, message).hint(hint))
    }

    pub(super) fn fields_of(&self, record: u32) -> String {
        let fields = self.scope.composites.record(record);
        let fields: Vec<String> = fields.iter().map(|(name, _)| format!("`.{}`", self.name(*name))).collect();
        format!("a record is read by the names of its values: {}", fields.join(", "))
    }

    /// Chooses between two records with the same names.
    pub(super) fn either_record(
        &mut self,
        condition: NodeId,
        (yes, no): (u32, u32),
        what: &str,
        span: Span,
    ) -> Value {
        let names = |index: u32| self.scope.composites.record(index).iter().map(|(name, _)| *name);
        if !names(yes).eq(names(no)) {
            let message = format!("{what} must have the same names in the same order");
            return self.reports.add(Diagnostic::new(span, message));
        }
        let pairs: Vec<((Symbol, Value), Value)> = {
            let (yes, no) = (self.scope.composites.record(yes), self.scope.composites.record(no));
            yes.iter().copied().zip(no.iter().map(|(_, value)| *value)).collect()
        };
        let mut fields = Vec::with_capacity(pairs.len());
        for ((name, yes), no) in pairs {
            fields.push((name, self.either(condition, yes, no, what, span)));
        }
        self.scope.composites.add_record(fields)
    }

    /// Combines the elements of two matrices. `None` if their sizes differ.
    pub(super) fn matrix_pair(
        &mut self,
        a: u32,
        b: u32,
        mut f: impl FnMut(&mut Graph, NodeId, NodeId) -> NodeId,
    ) -> Option<Value> {
        let (a, b) = (self.scope.composites.matrix(a)?, self.scope.composites.matrix(b)?);
        if a.len() != b.len() {
            return None;
        }
        let graph = &mut self.graph;
        let columns: Option<Vec<Vector>> =
            a.columns().iter().zip(b.columns()).map(|(a, b)| a.zip(*b, |a, b| f(graph, a, b))).collect();
        Some(self.scope.composites.add_matrix(Matrix::of_columns(&columns?)?))
    }

    /// Lowers an operator with a matrix on at least one side.
    #[cold]
    pub(super) fn matrix_binary(&mut self, op: BinaryOp, left: Value, right: Value, span: Span) -> Value {
        let operator = match op {
            BinaryOp::Add => Some(Op::Add),
            BinaryOp::Subtract => Some(Op::Sub),
            BinaryOp::Multiply => Some(Op::Mul),
            BinaryOp::Divide => Some(Op::Div),
            _ => None,
        };
        let found = match (operator, left, right) {
            (Some(Op::Mul), Value::Matrix(a), Value::Matrix(b)) => self.matrix_product(a, b),
            (Some(Op::Mul), Value::Matrix(a), Value::Vector(b)) if b.len() > 1 => {
                self.scope.composites.matrix(a).and_then(|a| times(&mut self.graph, &a, b)).map(Value::Vector)
            }
            (Some(Op::Mul), Value::Vector(a), Value::Matrix(b)) if a.len() > 1 => {
                let b = self.scope.composites.matrix(b).and_then(|b| transposed(&b));
                b.and_then(|b| times(&mut self.graph, &b, a)).map(Value::Vector)
            }
            (Some(operator), Value::Matrix(a), Value::Matrix(b)) => {
                self.matrix_pair(a, b, |graph, a, b| graph.binary(operator, a, b))
            }
            (Some(operator), Value::Matrix(a), Value::Vector(b)) if b.len() == 1 => {
                self.each_element(a, |graph, part| graph.binary(operator, part, b.first()))
            }
            (Some(operator), Value::Vector(a), Value::Matrix(b)) if a.len() == 1 => {
                self.each_element(b, |graph, part| graph.binary(operator, a.first(), part))
            }
            _ => None,
        };
        found.unwrap_or_else(|| {
            let types = &self.scope.composites;
            let described =
                |value| types.type_of(value).map_or("a record", super::super::ast::Type::described);
            let (a, b) = (described(left), described(right));
            let message = format!("`{}` cannot combine {a} and {b}", op.sign());
            let hint = "a mat2 multiplies a vec2, and a mat3 a vec3";
            self.reports.add(Diagnostic::new(span, message).hint(hint))
        })
    }

    fn each_element(&mut self, a: u32, mut f: impl FnMut(&mut Graph, NodeId) -> NodeId) -> Option<Value> {
        let matrix = self.scope.composites.matrix(a)?;
        let graph = &mut self.graph;
        let columns: Vec<Vector> =
            matrix.columns().iter().map(|column| column.map(|part| f(graph, part))).collect();
        Some(self.scope.composites.add_matrix(Matrix::of_columns(&columns)?))
    }

    fn matrix_product(&mut self, a: u32, b: u32) -> Option<Value> {
        let (a, b) = (self.scope.composites.matrix(a)?, self.scope.composites.matrix(b)?);
        let columns: Option<Vec<Vector>> =
            b.columns().iter().map(|column| times(&mut self.graph, &a, *column)).collect();
        Some(self.scope.composites.add_matrix(Matrix::of_columns(&columns?)?))
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
        let made = match (function, &arguments[..]) {
            (MatrixFunction::Construct(size), _) => self.construct_matrix(usize::from(size), &arguments),
            (_, [Value::Matrix(index)]) => {
                self.scope.composites.matrix(*index).and_then(|matrix| match function {
                    MatrixFunction::Transpose => {
                        transposed(&matrix).map(|matrix| self.scope.composites.add_matrix(matrix))
                    }
                    MatrixFunction::Inverse => inverse(&mut self.graph, &matrix)
                        .map(|matrix| self.scope.composites.add_matrix(matrix)),
                    _ => Some(Value::scalar(determinant(&mut self.graph, &matrix))),
                })
            }
            _ => None,
        };
        made.unwrap_or_else(|| {
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
        })
    }

    /// Builds a matrix from one number for the diagonal, from a larger matrix, or from its elements by columns.
    fn construct_matrix(&mut self, size: usize, arguments: &[Value]) -> Option<Value> {
        if let [Value::Matrix(index)] = arguments {
            let larger = self.scope.composites.matrix(*index)?;
            let columns = larger.columns().get(..size)?.iter();
            let columns: Option<Vec<Vector>> =
                columns.map(|column| column.parts().get(..size).and_then(Vector::from_slice)).collect();
            return Some(self.scope.composites.add_matrix(Matrix::of_columns(&columns?)?));
        }
        let mut parts = Vec::new();
        for argument in arguments {
            let Value::Vector(vector) = argument else { return None };
            parts.extend_from_slice(vector.parts());
        }
        if let [diagonal] = parts[..] {
            let zero = self.constant(0.0);
            parts = (0..size * size).map(|at| if at % (size + 1) == 0 { diagonal } else { zero }).collect();
        }
        if parts.len() != size * size {
            return None;
        }
        let columns: Option<Vec<Vector>> = parts.chunks(size).map(Vector::from_slice).collect();
        Some(self.scope.composites.add_matrix(Matrix::of_columns(&columns?)?))
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
