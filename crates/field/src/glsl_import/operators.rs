//! Operators and conversions.

use std::collections::HashSet;

use naga::{BinaryOperator, RelationalFunction, ScalarKind, UnaryOperator};

use super::Result;
use super::calls::Executor;
use super::layout::{ExprId, Part};
use crate::graph::{Graph, Node, NodeId, Op, Term, matrices};
use crate::lang::{Diagnostic, Span};

impl Executor<'_, '_> {
    pub(super) fn unary(&mut self, op: UnaryOperator, kind: ScalarKind, part: Part) -> Result<Part> {
        Ok(match (op, part) {
            (UnaryOperator::Negate, Part::Int(value)) => Part::Int(value.wrapping_neg()),
            (UnaryOperator::Negate, Part::Uint(value)) => Part::Uint(value.wrapping_neg()),
            (UnaryOperator::BitwiseNot, Part::Int(value)) => Part::Int(!value),
            (UnaryOperator::BitwiseNot, Part::Uint(value)) => Part::Uint(!value),
            _ => {
                let node = self.node(part)?;
                Part::Node(match op {
                    UnaryOperator::Negate => self.graph.neg(node),
                    // ~a = -a - 1
                    UnaryOperator::BitwiseNot if matches!(kind, ScalarKind::Sint | ScalarKind::Uint) => {
                        self.graph.sub(Op::Neg.of(node), 1.0)
                    }
                    UnaryOperator::LogicalNot | UnaryOperator::BitwiseNot => self.graph.not(node),
                })
            }
        })
    }

    pub(super) fn binary(&mut self, op: BinaryOperator, left: ExprId, right: ExprId) -> Result<Vec<Part>> {
        let (a, b) = (self.info(left)?, self.info(right)?);
        if op == BinaryOperator::Multiply && (a.columns > 0 || b.columns > 0) && a.len > 1 && b.len > 1 {
            let (x, y) = (self.nodes_of(left)?, self.nodes_of(right)?);
            self.step(x.len() * y.len())?;
            let nodes = matrices::product(self.graph, &x, a.columns, &y, b.columns);
            return Ok(nodes.into_iter().map(Part::Node).collect());
        }
        let result = (0..a.len.max(b.len) as usize).map(|index| {
            let (x, y) = (self.part(left, index)?, self.part(right, index)?);
            if matches!(a.kind, ScalarKind::Sint | ScalarKind::Uint) {
                return self.whole_binary(op, x, y);
            }
            let (x, y) = (self.node(x)?, self.node(y)?);
            Ok(Part::Node(self.node_binary(op, x, y)))
        });
        result.collect()
    }

    pub(super) fn node_binary(&mut self, op: BinaryOperator, a: NodeId, b: NodeId) -> NodeId {
        let graph = &mut *self.graph;
        match op {
            BinaryOperator::And | BinaryOperator::LogicalAnd => self.and(a, b),
            BinaryOperator::InclusiveOr | BinaryOperator::LogicalOr => self.or(a, b),
            BinaryOperator::Subtract => difference(graph, a, b),
            BinaryOperator::Add => graph.add(a, b),
            BinaryOperator::Multiply => graph.mul(a, b),
            BinaryOperator::Divide => graph.div(a, b),
            BinaryOperator::Modulo => graph.binary(Op::Mod, a, b),
            BinaryOperator::Equal => graph.binary(Op::Equal, a, b),
            BinaryOperator::NotEqual | BinaryOperator::ExclusiveOr => graph.not(Op::Equal.pair(a, b)),
            BinaryOperator::Less => graph.binary(Op::Less, a, b),
            BinaryOperator::LessEqual => graph.binary(Op::LessEqual, a, b),
            BinaryOperator::Greater => graph.binary(Op::Less, b, a),
            BinaryOperator::GreaterEqual => graph.binary(Op::LessEqual, b, a),
            _ => a,
        }
    }

    pub(super) fn relational(&mut self, of: RelationalFunction, nodes: &[NodeId]) -> Result<Vec<Part>> {
        self.step(nodes.len())?;
        let holds = match of {
            RelationalFunction::All => nodes.iter().fold(self.one, |all, &node| self.and(all, node)),
            RelationalFunction::Any => nodes.iter().fold(self.zero, |any, &node| self.or(any, node)),
            // Operators of the graph return numbers for all numbers.
            RelationalFunction::IsNan | RelationalFunction::IsInf => {
                return Ok(vec![Part::Node(self.zero); nodes.len()]);
            }
        };
        Ok(vec![Part::Node(holds)])
    }

    /// Converts a number to another kind of number.
    pub(super) fn convert(&mut self, from: ScalarKind, to: ScalarKind, part: Part) -> Result<Part> {
        let is_whole = matches!(from, ScalarKind::Sint | ScalarKind::Uint | ScalarKind::Bool);
        Ok(match (to, part) {
            (ScalarKind::Bool, _) if from == ScalarKind::Bool => part,
            (ScalarKind::Bool, _) => {
                let node = self.node(part)?;
                Part::Node(self.graph.not(Op::Not.of(node)))
            }
            (ScalarKind::Sint, Part::Uint(value)) => Part::Int(value as i32),
            (ScalarKind::Uint, Part::Int(value)) => Part::Uint(value as u32),
            (ScalarKind::Sint | ScalarKind::Uint, Part::Node(node)) => match self.graph.as_constant(node) {
                Some(value) if to == ScalarKind::Sint => Part::Int(value as i32),
                Some(value) => Part::Uint(if value < 0.0 { value as i32 as u32 } else { value as u32 }),
                None if is_whole => part,
                None => Part::Node(self.graph.unary(Op::Trunc, node)),
            },
            (ScalarKind::Float, _) => Part::Node(self.node(part)?),
            _ => part,
        })
    }

    /// Reads the bits of a number as another kind of number.
    pub(super) fn reinterpret(&mut self, from: ScalarKind, to: ScalarKind, part: Part) -> Result<Part> {
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
            (None, ScalarKind::Sint | ScalarKind::Uint) if from != ScalarKind::Float => part,
            // Only hashes read the bits of an unknown number.
            (None, _) => {
                let node = self.node(part)?;
                let many = self.graph.constant(65_536.0);
                let scaled = if from == ScalarKind::Float { self.graph.mul(node, many) } else { node };
                let random = scrambled(self.graph, &mut self.session.scrambled, scaled, many);
                if to != ScalarKind::Float {
                    return Ok(random);
                }
                // Hashes set the exponent of a number in 1..2.
                let random = self.node(random)?;
                Part::Node(self.graph.add(random * RANDOM.recip(), 1.0))
            }
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

    pub(super) fn whole_binary(&mut self, op: BinaryOperator, a: Part, b: Part) -> Result<Part> {
        if let Some(part) = constant(self.graph, op, a, b) {
            return Ok(part);
        }
        let (known_a, known_b) = (self.whole(a), self.whole(b));
        let (x, y) = (self.node(a)?, self.node(b)?);
        if matches!(op, BinaryOperator::And | BinaryOperator::InclusiveOr | BinaryOperator::ExclusiveOr) {
            self.step(8 * BITS)?;
        }
        let is_random = [x, y].iter().any(|node| self.session.scrambled.contains(node));
        let power = |value: Option<i64>| {
            let value = value.filter(|shift| (0..32).contains(shift))?;
            Some((1_u64 << value) as f32)
        };
        let overflows = [known_a, known_b].iter().flatten().any(|value| scrambles(value.unsigned_abs()));
        let node = match op {
            BinaryOperator::Divide => self.graph.unary(Op::Trunc, x / y),
            BinaryOperator::Modulo => self.graph.sub(x, Op::Trunc.of(x / y) * y),
            BinaryOperator::Multiply if is_random || overflows => {
                return Ok(scrambled(self.graph, &mut self.session.scrambled, x, y));
            }
            BinaryOperator::ExclusiveOr | BinaryOperator::InclusiveOr
                if is_random && known_a != Some(0) && known_b != Some(0) =>
            {
                return Ok(scrambled(self.graph, &mut self.session.scrambled, x, y));
            }
            BinaryOperator::ShiftLeft | BinaryOperator::ShiftRight => {
                let factor = match power(known_b) {
                    Some(factor) => self.graph.constant(factor),
                    None => self.graph.unary(Op::Exp2, y),
                };
                match op {
                    BinaryOperator::ShiftLeft => self.graph.mul(x, factor),
                    _ => self.graph.unary(Op::Floor, x / factor),
                }
            }
            BinaryOperator::And => match (known_a.and_then(stretch), known_b.and_then(stretch)) {
                (Some(bits), _) => masked(self.graph, y, bits),
                (_, Some(bits)) => masked(self.graph, x, bits),
                _ => common_bits(self.graph, x, y),
            },
            BinaryOperator::ExclusiveOr | BinaryOperator::InclusiveOr => {
                let common = common_bits(self.graph, x, y);
                let either = self.graph.sub(x + y, common);
                if op == BinaryOperator::InclusiveOr { either } else { self.graph.sub(either, common) }
            }
            _ => self.node_binary(op, x, y),
        };
        let wraps = matches!(op, BinaryOperator::Add | BinaryOperator::Subtract | BinaryOperator::ShiftLeft);
        if !is_random || !(wraps || matches!(op, BinaryOperator::ShiftRight)) {
            return Ok(Part::Node(node));
        }
        let node = if wraps { self.graph.binary(Op::Mod, node, RANDOM) } else { node };
        self.session.scrambled.insert(node);
        Ok(Part::Node(node))
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

// Whole numbers: constant ones have 32 bits, others are floats without a fraction.

/// The error of a function of the bits of a number that is not constant.
pub(super) fn bits(place: Span) -> Diagnostic {
    let message = "this works on the bits of a whole number that is not constant";
    Diagnostic::unsupported(place, message)
        .hint("compute the bits with `floor`, `mod` and `exp2` of floats, and a hash with `fract(sin(…))`")
}

/// The value of an operation on two constants of one type of whole numbers, or the condition of a comparison.
fn constant(graph: &mut Graph, op: BinaryOperator, a: Part, b: Part) -> Option<Part> {
    let shifts = matches!(op, BinaryOperator::ShiftLeft | BinaryOperator::ShiftRight);
    let (a, b, is_signed) = match (a, b) {
        (Part::Int(a), Part::Int(b)) => (i64::from(a), i64::from(b), true),
        (Part::Int(a), Part::Uint(b)) if shifts => (i64::from(a), i64::from(b), true),
        (Part::Uint(a), Part::Uint(b)) => (i64::from(a), i64::from(b), false),
        _ => return None,
    };
    let value = match op {
        BinaryOperator::Add => a.wrapping_add(b),
        BinaryOperator::Subtract => a.wrapping_sub(b),
        BinaryOperator::Multiply => a.wrapping_mul(b),
        BinaryOperator::Divide => a.checked_div(b).unwrap_or(0),
        BinaryOperator::Modulo => a.checked_rem(b).unwrap_or(0),
        BinaryOperator::And => a & b,
        BinaryOperator::InclusiveOr => a | b,
        BinaryOperator::ExclusiveOr => a ^ b,
        BinaryOperator::ShiftLeft => a << (b & 31),
        BinaryOperator::ShiftRight => a >> (b & 31),
        _ => return Some(Part::Node(graph.constant(if compared(op, a, b) { 1.0 } else { 0.0 }))),
    };
    // An operation on 32 bits gives the same lowest 32 bits.
    Some(if is_signed { Part::Int(value as i32) } else { Part::Uint(value as u32) })
}

/// Number of different values of 32 bits.
const RANDOM: f32 = 4_294_967_296.0;
/// Bits that operations on two unknown numbers see.
const BITS: usize = 16;

/// Returns a pseudo-random whole number of 32 bits, for a product that overflows or for mixed bits. A shader uses such
/// numbers as random ones, and floats cannot hold their 32 bits.
fn scrambled(graph: &mut Graph, known: &mut HashSet<NodeId>, a: NodeId, b: NodeId) -> Part {
    let [a, b] = [a, b].map(|node| match known.contains(&node) {
        true => graph.div(node, 256.0),
        false => graph.binary(Op::Mod, node, RANDOM / 2.0),
    });
    let random = graph.mul(Op::Hash.pair(a, b), RANDOM);
    known.insert(random);
    Part::Node(random)
}

/// The bits that two numbers have in common, of the lowest [`BITS`] bits and the sign.
fn common_bits(graph: &mut Graph, a: NodeId, b: NodeId) -> NodeId {
    let mut sum = graph.constant(0.0);
    for bit in 0..=BITS {
        let weight = (1_u32 << bit) as f32;
        let [x, y] = [a, b].map(|node| match bit {
            BITS => graph.binary(Op::Less, node, 0.0),
            _ => graph.binary(Op::Mod, Op::Floor.of(node / weight), 2.0),
        });
        let both = match (graph.as_constant(x), graph.as_constant(y)) {
            (Some(0.0), _) | (_, Some(0.0)) => continue,
            _ => graph.min(x, y),
        };
        sum = graph.add(sum, both * if bit == BITS { -weight } else { weight });
    }
    sum
}

/// True for the factor of a hash, whose products overflow. Other large factors, such as 10,000 or 44,100, are even.
fn scrambles(factor: u64) -> bool {
    factor >= 10_000 && factor % 2 == 1
}

/// First bit and the bit after the last one of a mask whose bits are neighbours.
fn stretch(mask: i64) -> Option<[u32; 2]> {
    let mask = mask as u32;
    let low = mask.checked_shr(mask.trailing_zeros()).unwrap_or(0);
    (low & low.wrapping_add(1) == 0).then(|| [mask.trailing_zeros().min(32), 32 - mask.leading_zeros()])
}

/// The bits of `a` between two places.
fn masked(graph: &mut Graph, a: NodeId, [low, high]: [u32; 2]) -> NodeId {
    let below = |bit: u32| Op::Mod.pair(a, (1_u64 << bit) as f32);
    match (low, high) {
        (0, 32) => a,
        (0, high) => below(high).node(graph),
        (low, high) if low >= high => graph.constant(0.0),
        (low, 32) => graph.sub(a, below(low)),
        (low, high) => graph.sub(below(high), below(low)),
    }
}

fn compared(op: BinaryOperator, a: i64, b: i64) -> bool {
    match op {
        BinaryOperator::Equal => a == b,
        BinaryOperator::NotEqual => a != b,
        BinaryOperator::Less => a < b,
        BinaryOperator::LessEqual => a <= b,
        BinaryOperator::Greater => a > b,
        _ => a >= b,
    }
}
