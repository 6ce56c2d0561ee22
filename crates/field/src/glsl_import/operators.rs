//! Operators and conversions.

use std::ops::Range;

use naga::{BinaryOperator, Expression, Handle, RelationalFunction, ScalarKind, UnaryOperator};

use super::calls::Executor;
use super::layout::Part;
use super::problem::{Problem, Result};
use crate::graph::{Graph, Node, NodeId, Op, matrices};

impl Executor<'_, '_> {
    pub(super) fn unary(
        &mut self,
        op: UnaryOperator,
        kind: ScalarKind,
        part: Part,
        place: &Range<u32>,
    ) -> Result<Part> {
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
    ) -> Result<Vec<Part>> {
        let (a, b) = (self.info(left)?, self.info(right)?);
        if op == BinaryOperator::Multiply && (a.columns > 0 || b.columns > 0) && a.len > 1 && b.len > 1 {
            let (x, y) = (self.nodes_of(left)?, self.nodes_of(right)?);
            self.step(x.len() * y.len(), || place.clone())?;
            let nodes = matrices::product(self.graph, &x, a.columns, &y, b.columns);
            return Ok(nodes.into_iter().map(Part::Node).collect());
        }
        let result = (0..a.len.max(b.len) as usize).map(|index| {
            let (x, y) = (self.part(left, index)?, self.part(right, index)?);
            if matches!(a.kind, ScalarKind::Sint | ScalarKind::Uint) {
                return self.whole_binary(op, x, y, place);
            }
            let (x, y) = (self.node(x, place)?, self.node(y, place)?);
            Ok(Part::Node(self.node_binary(op, x, y)))
        });
        result.collect()
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
    ) -> Result<Vec<Part>> {
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
    ) -> Result<Part> {
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
    pub(super) fn reinterpret(&mut self, to: ScalarKind, part: Part, place: &Range<u32>) -> Result<Part> {
        let known = match part {
            Part::Int(value) => Some(value as u32),
            Part::Uint(value) => Some(value),
            Part::Node(node) => self.graph.as_constant(node).map(f32::to_bits),
            Part::Unset(_) => None,
        };
        Ok(match (known, to) {
            (Some(bits), ScalarKind::Sint) => Part::Int(bits as i32),
            (Some(bits), ScalarKind::Uint) => Part::Uint(bits),
            (Some(bits), _) => Part::Node(self.graph.constant(f32::from_bits(bits))),
            // A signed number as an unsigned one.
            (None, ScalarKind::Sint | ScalarKind::Uint) if is_whole_node(self.graph, part) => part,
            _ => return Err(bits(place)),
        })
    }

    /// The value of a constant whole number.
    pub(super) fn whole(&self, part: Part) -> Option<i64> {
        match part {
            Part::Int(value) => Some(i64::from(value)),
            Part::Uint(value) => Some(i64::from(value)),
            Part::Node(node) => self.graph.as_constant(node).map(|value| value as i64),
            Part::Unset(_) => None,
        }
    }

    pub(super) fn whole_unary(&mut self, op: UnaryOperator, part: Part, place: &Range<u32>) -> Result<Part> {
        Ok(match (op, part) {
            (UnaryOperator::Negate, Part::Int(value)) => Part::Int(value.wrapping_neg()),
            (UnaryOperator::Negate, Part::Uint(value)) => Part::Uint(value.wrapping_neg()),
            (UnaryOperator::BitwiseNot, Part::Int(value)) => Part::Int(!value),
            (UnaryOperator::BitwiseNot, Part::Uint(value)) => Part::Uint(!value),
            _ => {
                let node = self.node(part, place)?;
                let negated = self.graph.neg(node);
                Part::Node(match op {
                    UnaryOperator::Negate => negated,
                    // ~a = -a - 1
                    UnaryOperator::BitwiseNot => self.graph.sub(negated, self.one),
                    UnaryOperator::LogicalNot => self.graph.not(node),
                })
            }
        })
    }

    pub(super) fn whole_binary(
        &mut self,
        op: BinaryOperator,
        a: Part,
        b: Part,
        place: &Range<u32>,
    ) -> Result<Part> {
        if let Some(part) = constant(self.graph, op, a, b) {
            return Ok(part);
        }
        let (known_a, known_b) = (self.whole(a), self.whole(b));
        let (x, y) = (self.node(a, place)?, self.node(b, place)?);
        let power = |value: Option<i64>| {
            let value = value.filter(|shift| (0..24).contains(shift))?;
            Some((1_u32 << value) as f32)
        };
        Ok(Part::Node(match op {
            BinaryOperator::Divide => {
                let quotient = self.graph.div(x, y);
                self.graph.unary(Op::Trunc, quotient)
            }
            BinaryOperator::Modulo => {
                let quotient = self.graph.div(x, y);
                let whole = self.graph.unary(Op::Trunc, quotient);
                let multiple = self.graph.mul(whole, y);
                self.graph.sub(x, multiple)
            }
            BinaryOperator::ShiftLeft => {
                let factor = self.graph.constant(power(known_b).ok_or_else(|| bits(place))?);
                self.graph.mul(x, factor)
            }
            BinaryOperator::ShiftRight => {
                shifted_right(self.graph, x, power(known_b).ok_or_else(|| bits(place))?)
            }
            BinaryOperator::And => match (known_a, known_b) {
                (Some(mask), _) => masked_bits(self.graph, y, mask, place)?,
                (_, Some(mask)) => masked_bits(self.graph, x, mask, place)?,
                _ => return Err(bits(place)),
            },
            BinaryOperator::ExclusiveOr | BinaryOperator::InclusiveOr => match (known_a, known_b) {
                (Some(0), _) => y,
                (_, Some(0)) => x,
                _ => return Err(bits(place)),
            },
            _ => self.node_binary(op, x, y),
        }))
    }

    pub(super) fn equal_whole(&mut self, a: Part, b: Part, place: &Range<u32>) -> Result<NodeId> {
        let part = match (a, b) {
            (Part::Int(a), Part::Int(b)) => truth(self.graph, a == b),
            (Part::Uint(a), Part::Uint(b)) => truth(self.graph, a == b),
            _ => {
                let (a, b) = (self.node(a, place)?, self.node(b, place)?);
                Part::Node(self.graph.binary(Op::Equal, a, b))
            }
        };
        self.node(part, place)
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

// Whole numbers: constant ones have 32 bits, others are floats without a fraction.

/// The error of an operation on the bits of a number that is not constant.
pub(super) fn bits(place: &Range<u32>) -> Problem {
    let message = "this works on the bits of a whole number that is not constant";
    Problem::unsupported(place.clone(), message)
        .hint("compute the hash with `fract(sin(…))`, or declare it in the scene with `cell_hash`")
}

/// Computes an operation on two constants of one type of whole numbers, or compares them.
macro_rules! folded {
    ($graph:expr, $op:expr, $a:expr, $b:expr, $part:path) => {
        $part(match $op {
            BinaryOperator::Add => $a.wrapping_add($b),
            BinaryOperator::Subtract => $a.wrapping_sub($b),
            BinaryOperator::Multiply => $a.wrapping_mul($b),
            BinaryOperator::Divide => $a.checked_div($b).unwrap_or(0),
            BinaryOperator::Modulo => $a.checked_rem($b).unwrap_or(0),
            BinaryOperator::And => $a & $b,
            BinaryOperator::InclusiveOr => $a | $b,
            BinaryOperator::ExclusiveOr => $a ^ $b,
            BinaryOperator::ShiftLeft => $a.wrapping_shl($b as u32),
            BinaryOperator::ShiftRight => $a.wrapping_shr($b as u32),
            _ => return Some(truth($graph, compared($op, &$a, &$b))),
        })
    };
}

/// The value of an operation on two constants.
fn constant(graph: &mut Graph, op: BinaryOperator, a: Part, b: Part) -> Option<Part> {
    let shifts = matches!(op, BinaryOperator::ShiftLeft | BinaryOperator::ShiftRight);
    Some(match (a, b) {
        (Part::Int(a), Part::Int(b)) => folded!(graph, op, a, b, Part::Int),
        (Part::Int(a), Part::Uint(b)) if shifts => folded!(graph, op, a, b as i32, Part::Int),
        (Part::Uint(a), Part::Uint(b)) => folded!(graph, op, a, b, Part::Uint),
        _ => return None,
    })
}

/// A constant condition.
fn truth(graph: &mut Graph, holds: bool) -> Part {
    Part::Node(graph.constant(if holds { 1.0 } else { 0.0 }))
}

fn shifted_right(graph: &mut Graph, a: NodeId, divisor: f32) -> NodeId {
    let divisor = graph.constant(divisor);
    let quotient = graph.div(a, divisor);
    graph.unary(Op::Floor, quotient)
}

/// The bits of `a` that a constant selects: the lowest ones, or a single one.
fn masked_bits(graph: &mut Graph, a: NodeId, mask: i64, place: &Range<u32>) -> Result<NodeId> {
    let mask = mask as u32;
    if mask == u32::MAX {
        return Ok(a);
    }
    if mask >= 1 << 24 {
        return Err(bits(place));
    }
    if mask & (mask + 1) == 0 {
        let count = graph.constant((mask + 1) as f32);
        return Ok(graph.binary(Op::Mod, a, count));
    }
    if mask.is_power_of_two() {
        let shifted = shifted_right(graph, a, mask as f32);
        let (two, factor) = (graph.constant(2.0), graph.constant(mask as f32));
        let bit = graph.binary(Op::Mod, shifted, two);
        return Ok(graph.mul(bit, factor));
    }
    Err(bits(place))
}

fn compared<T: PartialOrd>(op: BinaryOperator, a: &T, b: &T) -> bool {
    match op {
        BinaryOperator::Equal => a == b,
        BinaryOperator::NotEqual => a != b,
        BinaryOperator::Less => a < b,
        BinaryOperator::LessEqual => a <= b,
        BinaryOperator::Greater => a > b,
        _ => a >= b,
    }
}
