//! Fused operators: two operators become one if only the second reads the result of the first.
//!
//! Most distances consist of lengths, boxes and balls, in which squares, sums, differences and roots follow each
//! other. The time of an interpreter grows with the number of clauses, and fusing saves a third of a distance's
//! clauses. Only the interpreter's tapes contain fused operators. After pruning, compounds (`compound.rs`) combine
//! more operators. Fusing is bit-exact: a fused operator rounds after each of its two steps.

use super::Graph;
use super::node::{Node, NodeId};
use super::op::Op;

impl Graph {
    /// Returns a new graph with fused pairs of operators. The roots become nodes of the new graph.
    pub fn fused(&self, roots: &mut [NodeId]) -> Graph {
        let order = self.order(roots);
        let fusing = Fusing::new(self, &order, roots);
        // From the roots down, find the nodes that are still read after fusing, and the operator that each becomes.
        let mut tiles: Vec<Option<Node>> = vec![None; self.len()];
        let mut read = vec![false; self.len()];
        for root in roots.iter() {
            read[root.index()] = true;
        }
        for id in order.iter().rev().filter(|id| !is_input_of_point(self.node(**id))) {
            if !read[id.index()] {
                continue;
            }
            let tile = fusing.fused(*id).unwrap_or(self.node(*id));
            for operand in tile.operands() {
                read[operand.index()] = true;
            }
            tiles[id.index()] = Some(tile);
        }
        let mut fused = Graph { nodes_max: self.nodes_max, ..Graph::new() };
        fused.reserve(order.len());
        let mut moved = vec![NodeId::default(); self.len()];
        for id in order {
            let node = match tiles[id.index()] {
                Some(tile) => tile.with_operands(|id| moved[id.index()]),
                None if read[id.index()] => self.node(id),
                None => continue,
            };
            moved[id.index()] = fused.raw(node);
        }
        for root in roots {
            *root = moved[root.index()];
        }
        fused
    }
}

struct Fusing<'a> {
    graph: &'a Graph,
    /// How many nodes read each node: 0, 1, or 2 for two or more. A root has 2.
    readers: Vec<u8>,
}

impl<'a> Fusing<'a> {
    fn new(graph: &'a Graph, order: &[NodeId], roots: &[NodeId]) -> Self {
        let mut readers = vec![0u8; graph.len()];
        for root in roots {
            readers[root.index()] = 2;
        }
        for id in order {
            for operand in graph.node(*id).operands() {
                let count = &mut readers[operand.index()];
                *count = (*count + 1).min(2);
            }
        }
        Self { graph, readers }
    }

    /// Returns the node `id`, fused with its operands; `None` if that is not possible.
    fn fused(&self, id: NodeId) -> Option<Node> {
        let own = |id: NodeId| (self.readers[id.index()] == 1).then(|| self.graph.node(id));
        let own_square = |id: NodeId| match own(id) {
            Some(Node::Unary(Op::Square, a)) => Some(a),
            _ => None,
        };
        let own_outside = |id: NodeId| match own(id) {
            Some(Node::Binary(Op::Max, a, b)) if self.graph.as_constant(b) == Some(0.0) => Some((a, b)),
            Some(Node::Binary(Op::Max, a, b)) if self.graph.as_constant(a) == Some(0.0) => Some((b, a)),
            _ => None,
        };
        let square_and_rest = |a: NodeId, b: NodeId| {
            let second = own_square(b).map(|square| (square, a));
            second.or_else(|| own_square(a).map(|square| (square, b)))
        };
        Some(match self.graph.node(id) {
            Node::Unary(Op::Square, a) => match (own(a)?, own_outside(a)) {
                (Node::Binary(Op::Sub, a, b), _) => Node::Binary(Op::SquareDifference, a, b),
                (_, outside) => outside.map(|(outside, zero)| Node::Binary(Op::OutsideAdd, outside, zero))?,
            },
            Node::Unary(Op::Abs, a) => match own(a)? {
                Node::Binary(Op::Sub, a, b) => Node::Binary(Op::AbsDifference, a, b),
                _ => return None,
            },
            Node::Unary(Op::Sqrt, a) => match own(a)? {
                Node::Binary(Op::Add, a, b) => {
                    square_and_rest(a, b).map(|(square, rest)| Node::Binary(Op::Length, square, rest))?
                }
                _ => return None,
            },
            Node::Binary(Op::Add, a, b) => {
                let (square, rest) = square_and_rest(a, b)?;
                match own_outside(square) {
                    Some((outside, _)) => Node::Binary(Op::OutsideAdd, outside, rest),
                    None => Node::Binary(Op::SquareAdd, square, rest),
                }
            }
            Node::Binary(Op::Sub, a, b) => match own(a)? {
                Node::Unary(Op::Abs, a) => Node::Binary(Op::AbsSub, a, b),
                Node::Unary(Op::Sqrt, a) => Node::Binary(Op::SqrtSub, a, b),
                _ => return None,
            },
            _ => return None,
        })
    }
}

fn is_input_of_point(node: Node) -> bool {
    matches!(node, Node::Input(input) if input.of_point().is_some())
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::{Input, Point, testing};
    use super::*;

    fn operators(graph: &Graph, root: NodeId) -> Vec<Op> {
        let nodes = graph.order(&[root]).into_iter().map(|id| graph.node(id));
        nodes
            .filter_map(|node| match node {
                Node::Unary(op, _) | Node::Binary(op, ..) => Some(op),
                _ => None,
            })
            .collect()
    }

    proptest! {
        #[test]
        fn fused_values_are_the_same_bit_for_bit(
            steps in testing::steps(40), at in proptest::array::uniform3(testing::number()),
        ) {
            let mut graph = Graph::new();
            let built = testing::build(&mut graph, &steps, true);
            let mut roots: Vec<NodeId> = built.iter().rev().take(2).copied().collect();
            let before = roots.clone();
            let fused = graph.fused(&mut roots);
            let frame = testing::frame();
            let point = Point { position: at, normal: [0.6, -0.8, 0.0] };
            let whole = graph.evaluate(&before, &point, &frame);
            let short = fused.evaluate(&roots, &point, &frame);
            for (whole, short) in whole.iter().zip(&short) {
                prop_assert!(testing::same(*whole, *short), "{whole:?} {short:?}");
            }
        }
    }

    #[test]
    fn a_ball_and_a_corner_have_fewer_operators() {
        let mut g = Graph::new();
        let [x, y, z] = [Input::X, Input::Y, Input::Z].map(|input| g.input(input));
        let one = g.constant(1.0);
        let zero = g.constant(0.0);
        let away = g.sub(x, one);
        let squares = [away, y, z].map(|side| g.square(side));
        let sum = g.add(squares[0], squares[1]);
        let sum = g.add(sum, squares[2]);
        let length = g.sqrt(sum);
        let mut ball = [g.sub(length, one)];
        let fused = g.fused(&mut ball);
        assert_eq!(
            operators(&fused, ball[0]),
            [Op::SquareDifference, Op::SquareAdd, Op::SquareAdd, Op::SqrtSub]
        );
        let sides = [x, y].map(|side| {
            let size = g.abs(side);
            let beyond = g.sub(size, one);
            g.max(beyond, zero)
        });
        let squares = sides.map(|side| g.square(side));
        let mut corner = [g.add(squares[0], squares[1])];
        let fused = g.fused(&mut corner);
        let mut found = operators(&fused, corner[0]);
        found.sort();
        assert_eq!(found, [Op::OutsideAdd, Op::OutsideAdd, Op::AbsSub, Op::AbsSub]);
    }

    #[test]
    fn shared_values_are_not_fused() {
        let mut g = Graph::new();
        let x = g.input(Input::X);
        let one = g.constant(1.0);
        let away = g.sub(x, one);
        let square = g.square(away);
        let mut roots = [g.add(square, away)];
        let fused = g.fused(&mut roots);
        assert_eq!(operators(&fused, roots[0]), [Op::Sub, Op::SquareAdd]);
    }
}
