//! Operators and conversions.

use std::ops::Range;

use naga::{BinaryOperator, Expression, Handle, RelationalFunction, ScalarKind, UnaryOperator};

use super::calls::Executor;
use super::layout::Part;
use super::problem::Problem;
use crate::graph::{Graph, Node, NodeId, Op, matrices};

impl Executor<'_, '_> {
    pub(super) fn unary(
        &mut self,
        op: UnaryOperator,
        kind: ScalarKind,
        part: Part,
        place: &Range<u32>,
    ) -> Result<Part, Problem> {
        if matches!(kind, ScalarKind::Sint | ScalarKind::Uint) {
            return self.whole_unary(op, part, place);
        }
        let node = self.node(part, place)?;
        Ok(Part::Node(match op {
            UnaryOperator::Negate => self.graph.neg(node),
            UnaryOperator::LogicalNot | UnaryOperator::BitwiseNot => self.graph.not(node),
        }))
    }

    pub(super) fn binary(
        &mut self,
        op: BinaryOperator,
        left: Handle<Expression>,
        right: Handle<Expression>,
        place: &Range<u32>,
    ) -> Result<Vec<Part>, Problem> {
        let (a, b) = (self.info(left)?, self.info(right)?);
        if op == BinaryOperator::Multiply && (a.columns > 0 || b.columns > 0) && a.len > 1 && b.len > 1 {
            let (x, y) = (self.nodes_of(left)?, self.nodes_of(right)?);
            self.step(x.len() * y.len(), || place.clone())?;
            let nodes = matrices::product(self.graph, &x, (a.columns, a.rows), &y, (b.columns, b.rows));
            return Ok(nodes.into_iter().map(Part::Node).collect());
        }
        let mut result = Vec::with_capacity(a.len.max(b.len) as usize);
        for index in 0..a.len.max(b.len) as usize {
            let (x, y) = (self.part(left, index)?, self.part(right, index)?);
            result.push(match a.kind {
                ScalarKind::Sint | ScalarKind::Uint => self.whole_binary(op, x, y, place)?,
                _ => {
                    let (x, y) = (self.node(x, place)?, self.node(y, place)?);
                    Part::Node(self.node_binary(op, x, y))
                }
            });
        }
        Ok(result)
    }

    pub(super) fn node_binary(&mut self, op: BinaryOperator, a: NodeId, b: NodeId) -> NodeId {
        match op {
            BinaryOperator::And | BinaryOperator::LogicalAnd => return self.and(a, b),
            BinaryOperator::InclusiveOr | BinaryOperator::LogicalOr => return self.or(a, b),
            BinaryOperator::Subtract => return difference(self.graph, a, b),
            _ => {}
        }
        let graph = &mut *self.graph;
        match op {
            BinaryOperator::Add => graph.add(a, b),
            BinaryOperator::Multiply => graph.mul(a, b),
            BinaryOperator::Divide => graph.div(a, b),
            BinaryOperator::Modulo => graph.binary(Op::Mod, a, b),
            BinaryOperator::Equal => graph.binary(Op::Equal, a, b),
            BinaryOperator::NotEqual | BinaryOperator::ExclusiveOr => {
                let equal = graph.binary(Op::Equal, a, b);
                graph.not(equal)
            }
            BinaryOperator::Less => graph.binary(Op::Less, a, b),
            BinaryOperator::LessEqual => graph.binary(Op::LessEqual, a, b),
            BinaryOperator::Greater => graph.binary(Op::Less, b, a),
            BinaryOperator::GreaterEqual => graph.binary(Op::LessEqual, b, a),
            _ => a,
        }
    }

    pub(super) fn relational(
        &mut self,
        of: RelationalFunction,
        nodes: &[NodeId],
        place: &Range<u32>,
    ) -> Result<Vec<Part>, Problem> {
        self.step(nodes.len(), || place.clone())?;
        let parts = match of {
            RelationalFunction::All => {
                let all = nodes.iter().copied().reduce(|a, b| self.and(a, b));
                vec![Part::Node(all.unwrap_or(self.one))]
            }
            RelationalFunction::Any => {
                let any = nodes.iter().copied().reduce(|a, b| self.or(a, b));
                vec![Part::Node(any.unwrap_or(self.zero))]
            }
            // Operators of the graph return numbers for all numbers.
            RelationalFunction::IsNan | RelationalFunction::IsInf => vec![Part::Node(self.zero); nodes.len()],
        };
        Ok(parts)
    }

    /// Converts a number to another kind of number.
    pub(super) fn convert(
        &mut self,
        from: ScalarKind,
        to: ScalarKind,
        part: Part,
        place: &Range<u32>,
    ) -> Result<Part, Problem> {
        let is_whole = matches!(from, ScalarKind::Sint | ScalarKind::Uint | ScalarKind::Bool);
        Ok(match (to, part) {
            (ScalarKind::Bool, _) if from == ScalarKind::Bool => part,
            (ScalarKind::Bool, _) => {
                let node = self.node(part, place)?;
                let zero = self.graph.not(node);
                Part::Node(self.graph.not(zero))
            }
            (ScalarKind::Sint, Part::Uint(value)) => Part::Int(value as i32),
            (ScalarKind::Uint, Part::Int(value)) => Part::Uint(value as u32),
            (ScalarKind::Sint | ScalarKind::Uint, Part::Node(node)) => match self.graph.as_constant(node) {
                Some(value) if to == ScalarKind::Sint => Part::Int(value as i32),
                Some(value) => Part::Uint(if value < 0.0 { value as i32 as u32 } else { value as u32 }),
                None if is_whole => part,
                None => Part::Node(self.graph.unary(Op::Trunc, node)),
            },
            (ScalarKind::Float, _) => Part::Node(self.node(part, place)?),
            _ => part,
        })
    }

    /// Reads the bits of a number as another kind of number.
    pub(super) fn reinterpret(
        &mut self,
        to: ScalarKind,
        part: Part,
        place: &Range<u32>,
    ) -> Result<Part, Problem> {
        let bits = match part {
            Part::Int(value) => Some(value as u32),
            Part::Uint(value) => Some(value),
            Part::Node(node) => self.graph.as_constant(node).map(f32::to_bits),
            Part::Unset(_) => None,
        };
        Ok(match (bits, to) {
            (Some(bits), ScalarKind::Sint) => Part::Int(bits as i32),
            (Some(bits), ScalarKind::Uint) => Part::Uint(bits),
            (Some(bits), _) => Part::Node(self.graph.constant(f32::from_bits(bits))),
            // A signed number as an unsigned one.
            (None, ScalarKind::Sint | ScalarKind::Uint) if is_whole_node(self.graph, part) => part,
            _ => return Err(super::whole::bits(place)),
        })
    }
}

/// a - b. naga writes `mod` and `fract` out as differences; the operators of the graph have tighter bounds.
fn difference(graph: &mut Graph, a: NodeId, b: NodeId) -> NodeId {
    match graph.node(b) {
        Node::Unary(Op::Floor, inner) if inner == a => return graph.unary(Op::Fract, a),
        Node::Binary(Op::Mul, x, y) => {
            for (floor, divisor) in [(x, y), (y, x)] {
                let Node::Unary(Op::Floor, quotient) = graph.node(floor) else { continue };
                if graph.div(a, divisor) == quotient {
                    return graph.binary(Op::Mod, a, divisor);
                }
            }
        }
        _ => {}
    }
    graph.sub(a, b)
}

fn is_whole_node(graph: &Graph, part: Part) -> bool {
    matches!(part, Part::Node(node)
        if matches!(graph.node(node), Node::Unary(Op::Trunc | Op::Floor, _)))
}
