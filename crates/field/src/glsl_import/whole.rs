//! Whole numbers: constant ones have 32 bits, others are floats without a fraction.

use std::ops::Range;

use naga::{BinaryOperator, UnaryOperator};

use super::calls::Executor;
use super::layout::Part;
use super::problem::Problem;
use crate::graph::{Graph, NodeId, Op};

/// The error of an operation on the bits of a number that is not constant.
pub(super) fn bits(place: &Range<u32>) -> Problem {
    let message = "this works on the bits of a whole number that is not constant";
    Problem::unsupported(place.clone(), message)
        .hint("compute the hash with `fract(sin(…))`, or declare it in the scene with `cell_hash`")
}

impl Executor<'_, '_> {
    /// The value of a constant whole number.
    pub(super) fn whole(&self, part: Part) -> Option<i64> {
        match part {
            Part::Int(value) => Some(i64::from(value)),
            Part::Uint(value) => Some(i64::from(value)),
            Part::Node(node) => self.graph.as_constant(node).map(|value| value as i64),
            Part::Unset(_) => None,
        }
    }

    pub(super) fn whole_unary(
        &mut self,
        op: UnaryOperator,
        part: Part,
        place: &Range<u32>,
    ) -> Result<Part, Problem> {
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
    ) -> Result<Part, Problem> {
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

    pub(super) fn equal_whole(&mut self, a: Part, b: Part, place: &Range<u32>) -> Result<NodeId, Problem> {
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

/// The value of an operation on two constants.
fn constant(graph: &mut Graph, op: BinaryOperator, a: Part, b: Part) -> Option<Part> {
    match (a, b) {
        (Part::Int(a), Part::Int(b)) => {
            if let Some(value) = folded(op, a, b, i32::wrapping_add, i32::wrapping_sub, i32::wrapping_mul) {
                return Some(Part::Int(value));
            }
            let value = match op {
                BinaryOperator::Divide => a.checked_div(b).unwrap_or(0),
                BinaryOperator::Modulo => a.checked_rem(b).unwrap_or(0),
                BinaryOperator::ShiftLeft => a.wrapping_shl(b as u32),
                BinaryOperator::ShiftRight => a.wrapping_shr(b as u32),
                _ => return Some(truth(graph, compared(op, &a, &b))),
            };
            return Some(Part::Int(value));
        }
        (Part::Int(a), Part::Uint(b))
            if matches!(op, BinaryOperator::ShiftLeft | BinaryOperator::ShiftRight) =>
        {
            let left = op == BinaryOperator::ShiftLeft;
            return Some(Part::Int(if left { a.wrapping_shl(b) } else { a.wrapping_shr(b) }));
        }
        (Part::Uint(a), Part::Uint(b)) => {
            if let Some(value) = folded(op, a, b, u32::wrapping_add, u32::wrapping_sub, u32::wrapping_mul) {
                return Some(Part::Uint(value));
            }
            let value = match op {
                BinaryOperator::Divide => a.checked_div(b).unwrap_or(0),
                BinaryOperator::Modulo => a.checked_rem(b).unwrap_or(0),
                BinaryOperator::ShiftLeft => a.wrapping_shl(b),
                BinaryOperator::ShiftRight => a.wrapping_shr(b),
                _ => return Some(truth(graph, compared(op, &a, &b))),
            };
            return Some(Part::Uint(value));
        }
        _ => {}
    }
    None
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
fn masked_bits(graph: &mut Graph, a: NodeId, mask: i64, place: &Range<u32>) -> Result<NodeId, Problem> {
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

fn folded<T: std::ops::BitAnd<Output = T> + std::ops::BitOr<Output = T> + std::ops::BitXor<Output = T>>(
    op: BinaryOperator,
    a: T,
    b: T,
    add: impl Fn(T, T) -> T,
    sub: impl Fn(T, T) -> T,
    mul: impl Fn(T, T) -> T,
) -> Option<T> {
    Some(match op {
        BinaryOperator::Add => add(a, b),
        BinaryOperator::Subtract => sub(a, b),
        BinaryOperator::Multiply => mul(a, b),
        BinaryOperator::And => a & b,
        BinaryOperator::InclusiveOr => a | b,
        BinaryOperator::ExclusiveOr => a ^ b,
        _ => return None,
    })
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
