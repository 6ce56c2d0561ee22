//! Rematerialization (Briggs, Cooper and Torczon 1992) for programs that would need too many registers: a cheap value
//! is computed again if its next use is far from its last computation.
//!
//! Equal operations give equal bits, so no result changes.

use crate::graph::{Node, NodeId};

/// A value is computed again if more than this many nodes lie between its last computation and its next use.
const REACH: usize = 256;
/// A value that takes more operations than this is never computed again.
const COST_MAX: u32 = 8;

/// Nodes with their positions, operands first. Some nodes occur again at later positions.
pub(super) struct ShortLives {
    pub(super) nodes: Vec<(usize, Node)>,
    pub(super) positions: usize,
    /// For each old position, the newest position of its node, and how many nodes are before the newest position.
    newest: Vec<(usize, usize)>,
    /// For each old position, the node and its number of operations; 0 operations if the node takes no register.
    sources: Vec<(Node, u32)>,
}

impl ShortLives {
    pub(super) fn of(nodes: &[(usize, Node)], positions: usize) -> Self {
        let none = (Node::Constant(0.0), 0);
        let mut lives = Self {
            nodes: Vec::with_capacity(nodes.len()),
            positions,
            newest: (0..positions).map(|position| (position, 0)).collect(),
            sources: vec![none; positions],
        };
        for (position, node) in nodes {
            let cost = lives.cost(*node);
            lives.sources[*position] = (*node, cost);
            let node = node.with_operands(|id| lives.operand(id));
            lives.append(*position, *position, node);
        }
        lives
    }

    pub(super) fn position(&self, old: usize) -> usize {
        self.newest[old].0
    }

    /// Returns the number of operations of a node; 0 for numbers, including the frame's, and for inputs of the point.
    fn cost(&self, node: Node) -> u32 {
        let of = |id: NodeId| self.sources[id.index()].1;
        let is_point = |id: NodeId| match self.sources[id.index()] {
            (Node::Input(input), _) => input.of_point().is_some(),
            (_, cost) => cost > 0,
        };
        match node {
            Node::Constant(_) | Node::Input(_) | Node::Texture { .. } => 0,
            Node::Unary(_, a) if is_point(a) => 1 + of(a),
            Node::Binary(_, a, b) if is_point(a) || is_point(b) => (1 + of(a)).saturating_add(of(b)),
            Node::Unary(..) | Node::Binary(..) => 0,
        }
    }

    fn append(&mut self, old: usize, position: usize, node: Node) {
        self.newest[old] = (position, self.nodes.len());
        self.nodes.push((position, node));
    }

    /// Returns the newest computation of a value. If it is far away and cheap, the computation is repeated first.
    /// Recurses less than [`COST_MAX`] deep.
    fn operand(&mut self, id: NodeId) -> NodeId {
        let old = id.index();
        let ((position, at), (node, cost)) = (self.newest[old], self.sources[old]);
        if cost == 0 || cost > COST_MAX || self.nodes.len() - at <= REACH {
            return NodeId::at(position);
        }
        let node = node.with_operands(|id| self.operand(id));
        let position = self.positions;
        self.positions += 1;
        self.append(old, position, node);
        NodeId::at(position)
    }
}
