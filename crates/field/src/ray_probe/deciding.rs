//! Finds the part of a shape that decides its value at a point: the nearest operand of a union or smooth union, then
//! the nearest operand within that operand, and so on.

use crate::graph::{FrameInputs, Graph, Node, NodeId, Op, Point};

/// A shape with its evaluation order, for finding deciding parts.
#[derive(Debug, Clone)]
pub struct Deciding<'a> {
    graph: &'a Graph,
    root: NodeId,
    order: Vec<NodeId>,
    of_point: Vec<bool>,
}

impl<'a> Deciding<'a> {
    /// Prepares a node of a graph.
    pub fn new(graph: &'a Graph, root: NodeId) -> Self {
        let order = graph.order(&[root]);
        let mut of_point = vec![false; root.index() + 1];
        for id in &order {
            of_point[id.index()] = match graph.node(*id) {
                Node::Input(input) => input.of_point().is_some(),
                Node::Texture { .. } => true,
                node => node.operands().any(|operand| of_point[operand.index()]),
            };
        }
        Self { graph, root, order, of_point }
    }

    /// Number of the shape's clauses. Inputs and numbers do not count.
    pub fn clauses(&self) -> usize {
        self.order.iter().filter(|id| self.graph.is_clause(**id)).count()
    }

    /// Returns the path from the shape to the part that decides its value at a point. The path passes through minima,
    /// maxima, and operations that only shift, scale or negate a value.
    pub fn path(&self, position: [f32; 3], frame: &FrameInputs) -> Vec<NodeId> {
        if self.next(self.root, |_| 0.0).is_none() {
            return vec![self.root];
        }
        let point = Point { position, normal: [0.0; 3] };
        let values = self.graph.evaluate_in(&self.order, &self.order, &point, frame);
        let mut by_node = vec![0.0; self.of_point.len()];
        for (id, value) in self.order.iter().zip(values) {
            by_node[id.index()] = value;
        }
        let mut path = vec![self.root];
        let mut at = self.root;
        while let Some(inner) = self.next(at, |id| by_node[id.index()]) {
            path.push(inner);
            at = inner;
        }
        path
    }

    fn next(&self, id: NodeId, value: impl Fn(NodeId) -> f32) -> Option<NodeId> {
        let of_point = |id: NodeId| self.of_point[id.index()];
        match self.graph.node(id) {
            Node::Unary(Op::Neg, a) => Some(a),
            Node::Binary(Op::Min, a, b) => Some(if value(a) <= value(b) { a } else { b }),
            Node::Binary(Op::Max, a, b) => Some(if value(a) >= value(b) { a } else { b }),
            Node::Binary(op @ (Op::Add | Op::Sub | Op::Mul | Op::Div), a, b) => {
                match (of_point(a), of_point(b)) {
                    (true, false) => Some(a),
                    (false, true) => Some(b),
                    // A smooth union is the minimum of its parts plus or minus a blend term: follow the minimum.
                    (true, true) if matches!(op, Op::Add | Op::Sub) => {
                        match (self.is_choice(a), self.is_choice(b)) {
                            (true, false) => Some(a),
                            (false, true) => Some(b),
                            _ => None,
                        }
                    }
                    _ => None,
                }
            }
            _ => None,
        }
    }

    /// True if a value is a minimum or maximum of two values that both depend on the point.
    fn is_choice(&self, id: NodeId) -> bool {
        let of_point = |id: NodeId| self.of_point[id.index()];
        matches!(self.graph.node(id), Node::Binary(Op::Min | Op::Max, a, b) if of_point(a) && of_point(b))
    }
}
