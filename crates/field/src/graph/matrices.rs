//! Matrices as lists of nodes, column by column.

use super::{Graph, NodeId};

/// The product of two matrices, or of a matrix and a vector, which has 0 columns.
pub(crate) fn product(
    graph: &mut Graph,
    a: &[NodeId],
    a_columns: u8,
    b: &[NodeId],
    b_columns: u8,
) -> Vec<NodeId> {
    // A vector on the left is a row, one on the right a column.
    let rows = if a_columns == 0 { 1 } else { a.len() / usize::from(a_columns) };
    let inner = b.len() / usize::from(b_columns.max(1));
    let mut result = Vec::new();
    for right in b.chunks(inner.max(1)) {
        for row in 0..rows {
            let left: Vec<NodeId> = a.iter().skip(row).step_by(rows).copied().collect();
            result.push(graph.dot(&left, right));
        }
    }
    result
}

/// The matrix of `rows` rows with rows and columns exchanged.
pub(crate) fn transposed(a: &[NodeId], rows: usize) -> Vec<NodeId> {
    (0..rows).flat_map(|row| a.iter().skip(row).step_by(rows)).copied().collect()
}

/// The determinant of a square matrix, by its first row.
pub(crate) fn determinant(graph: &mut Graph, a: &[NodeId], size: usize) -> NodeId {
    if size == 1 {
        return a.first().copied().unwrap_or_else(|| graph.constant(0.0));
    }
    let zero = graph.constant(0.0);
    let mut sum = zero;
    for column in 0..size {
        let minor = minor(graph, a, size, column, 0);
        let entry = a.get(column * size).copied().unwrap_or(zero);
        let term = graph.mul(entry, minor);
        sum = if column % 2 == 0 { graph.add(sum, term) } else { graph.sub(sum, term) };
    }
    sum
}

/// The determinant of a matrix without a column and a row.
fn minor(graph: &mut Graph, a: &[NodeId], size: usize, without_column: usize, without_row: usize) -> NodeId {
    let mut rest = Vec::new();
    for column in (0..size).filter(|&column| column != without_column) {
        for row in (0..size).filter(|&row| row != without_row) {
            rest.extend(a.get(column * size + row).copied());
        }
    }
    determinant(graph, &rest, size - 1)
}

/// The inverse of a square matrix; 0 where its determinant is 0.
pub(crate) fn inverse(graph: &mut Graph, a: &[NodeId], size: usize) -> Vec<NodeId> {
    let determinant = determinant(graph, a, size);
    let mut result = Vec::new();
    for column in 0..size {
        for row in 0..size {
            let minor = minor(graph, a, size, row, column);
            let signed = if (row + column) % 2 == 0 { minor } else { graph.neg(minor) };
            result.push(graph.div(signed, determinant));
        }
    }
    result
}
