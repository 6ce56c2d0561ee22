//! Simplification while nodes are built: constant folding, and algebra that is exact in floating point.
//!
//! A rule is exact if both sides have the same value or are both NaN, for all operands including infinities and NaNs.
//! (The sign of a zero is not part of a value, see [`super::Op`].) Identities that hold for real numbers but not
//! for rounded ones, such as reassociation, x - x = 0 or sqrt(x²) = |x|, are not applied. Each rule is stated in a
//! comment.

use super::Graph;
use super::frame_inputs::SILENT;
use super::node::{Input, Node, NodeId};
use super::op::{Op, Properties};

impl Graph {
    fn has(&self, id: NodeId, properties: Properties) -> bool {
        match self.node(id) {
            Node::Unary(op, _) | Node::Binary(op, _, _) => op.properties().has(properties),
            Node::Constant(value) => {
                (properties == Properties::WHOLE && value == value.floor())
                    || (properties == Properties::NEVER_NEGATIVE && value >= 0.0)
                    || (properties == Properties::TRUTH && (value == 0.0 || value == 1.0))
            }
            _ => false,
        }
    }

    fn negated(&self, id: NodeId) -> Option<NodeId> {
        match self.node(id) {
            Node::Unary(Op::Neg, a) => Some(a),
            _ => None,
        }
    }

    pub(super) fn simplified_unary(&mut self, op: Op, a: NodeId) -> NodeId {
        let node = self.node(a);
        if let Node::Constant(value) = node {
            if let Some(list) = op.level_list() {
                // A level with a constant number, such as band(3), is an input.
                return self.input(Input::Level(list.nearest(value)));
            }
            if let Some(folded) = fold(op, value, 0.0) {
                return self.constant(folded);
            }
        }
        match (op, node) {
            // -(-x) = x
            (Op::Neg, Node::Unary(Op::Neg, x)) => return x,
            // -(x - y) = y - x
            (Op::Neg, Node::Binary(Op::Sub, x, y)) => return self.simplified_binary(Op::Sub, y, x),
            // |x| = x where x >= 0
            (Op::Abs, _) if self.has(a, Properties::NEVER_NEGATIVE) => return a,
            // |-x| = |x|; (-x)² = x²
            (Op::Abs | Op::Square, Node::Unary(Op::Neg, x)) => return self.simplified_unary(op, x),
            // |x|² = x²
            (Op::Square, Node::Unary(Op::Abs, x)) => return self.simplified_unary(Op::Square, x),
            // floor, ceil and trunc of a whole number are that number. (ROUND is not: it rounds x + 0.5 above 2^23.)
            (Op::Floor | Op::Ceil | Op::Trunc, _) if self.has(a, Properties::WHOLE) => return a,
            // sign(sign x) = sign x
            (Op::Sign, Node::Unary(Op::Sign, _)) => return a,
            // not(not c) = c where c is 0 or 1
            (Op::Not, Node::Unary(Op::Not, c)) if self.has(c, Properties::TRUTH) => return c,
            _ => {}
        }
        self.intern(Node::Unary(op, a))
    }

    pub(super) fn simplified_binary(&mut self, op: Op, mut a: NodeId, mut b: NodeId) -> NodeId {
        let (mut first, mut second) = (self.as_constant(a), self.as_constant(b));
        if let (Some(x), Some(y)) = (first, second)
            && let Some(folded) = fold(op, x, y)
        {
            return self.constant(folded);
        }
        // Put the operands in a canonical order: constants last, older nodes before newer ones.
        if op.properties().has(Properties::COMMUTATIVE) && (first.is_some() || (second.is_none() && b < a)) {
            std::mem::swap(&mut a, &mut b);
            std::mem::swap(&mut first, &mut second);
        }
        let simpler = match op {
            Op::Add => self.sum(a, b, second),
            Op::Sub => self.difference(a, b, first, second),
            Op::Mul => self.product(a, b, second),
            Op::Div => self.quotient(a, second),
            Op::Min | Op::Max => self.extreme(op, a, b, second),
            Op::Mask => self.masked(a, b, first, second),
            // mod(x, 0) = x
            Op::Mod if second == Some(0.0) => Some(a),
            // x < x is false, even for a NaN
            Op::Less if a == b => Some(self.constant(0.0)),
            // step(x, x) = 1, even for a NaN
            Op::Step if a == b => Some(self.constant(1.0)),
            _ => None,
        };
        simpler.unwrap_or_else(|| self.intern(Node::Binary(op, a, b)))
    }

    fn sum(&mut self, a: NodeId, b: NodeId, constant: Option<f32>) -> Option<NodeId> {
        // x + 0 = x
        if constant == Some(0.0) {
            return Some(a);
        }
        // x + (-y) = x - y
        if let Some(y) = self.negated(b) {
            return Some(self.simplified_binary(Op::Sub, a, y));
        }
        // (-x) + y = y - x
        self.negated(a).map(|x| self.simplified_binary(Op::Sub, b, x))
    }

    fn difference(
        &mut self,
        a: NodeId,
        b: NodeId,
        first: Option<f32>,
        second: Option<f32>,
    ) -> Option<NodeId> {
        // x - 0 = x
        if second == Some(0.0) {
            return Some(a);
        }
        // 0 - x = -x
        if first == Some(0.0) {
            return Some(self.simplified_unary(Op::Neg, b));
        }
        // x - (-y) = x + y
        self.negated(b).map(|y| self.simplified_binary(Op::Add, a, y))
    }

    fn product(&mut self, a: NodeId, b: NodeId, constant: Option<f32>) -> Option<NodeId> {
        match constant {
            // x * 1 = x
            Some(1.0) => return Some(a),
            // x * -1 = -x
            Some(-1.0) => return Some(self.simplified_unary(Op::Neg, a)),
            // (-x) * c = x * (-c)
            Some(c) => {
                let x = self.negated(a)?;
                let negative = self.constant(-c);
                return Some(self.simplified_binary(Op::Mul, x, negative));
            }
            None => {}
        }
        // x * x = x²
        if a == b {
            return Some(self.simplified_unary(Op::Square, a));
        }
        // (-x) * (-y) = x * y
        let (x, y) = (self.negated(a)?, self.negated(b)?);
        Some(self.simplified_binary(Op::Mul, x, y))
    }

    fn quotient(&mut self, a: NodeId, divisor: Option<f32>) -> Option<NodeId> {
        match divisor? {
            // x / 0 = 0, as DIV defines it
            0.0 => Some(self.constant(0.0)),
            // x / 1 = x
            1.0 => Some(a),
            // x / -1 = -x
            -1.0 => Some(self.simplified_unary(Op::Neg, a)),
            // x / 2^k = x * 2^-k, where both are normal numbers
            c if c.is_normal() && c.to_bits() & 0x007F_FFFF == 0 && c.recip().is_normal() => {
                let factor = self.constant(c.recip());
                Some(self.simplified_binary(Op::Mul, a, factor))
            }
            _ => None,
        }
    }

    fn extreme(&mut self, op: Op, a: NodeId, b: NodeId, constant: Option<f32>) -> Option<NodeId> {
        // min(x, x) = x
        if a == b {
            return Some(a);
        }
        // min(x, NaN) = x
        if constant.is_some_and(f32::is_nan) {
            return Some(a);
        }
        for (whole, part) in [(a, b), (b, a)] {
            if let Node::Binary(inner, x, y) = self.node(whole)
                && inner == op
            {
                // min(min(x, y), y) = min(x, y)
                if x == part || y == part {
                    return Some(whole);
                }
                // min(min(x, c), d) = min(x, min(c, d))
                if let (Some(c), Some(d)) = (self.as_constant(y), self.as_constant(part)) {
                    let constant = if op == Op::Min { c.min(d) } else { c.max(d) };
                    let constant = self.constant(constant);
                    return Some(self.simplified_binary(op, x, constant));
                }
            }
        }
        None
    }

    fn masked(&mut self, c: NodeId, a: NodeId, condition: Option<f32>, value: Option<f32>) -> Option<NodeId> {
        match condition {
            // mask(0, x) = 0
            Some(0.0) => return Some(self.constant(0.0)),
            // mask(c, x) = x for a constant c that is not 0
            Some(_) => return Some(a),
            None => {}
        }
        match value {
            // mask(c, 0) = 0
            Some(0.0) => Some(a),
            // mask(c, 1) = c where c is 0 or 1
            Some(1.0) if self.has(c, Properties::TRUTH) => Some(c),
            _ => None,
        }
    }
}

fn fold(op: Op, a: f32, b: f32) -> Option<f32> {
    if op.properties().has(Properties::READS_FRAME) {
        return None;
    }
    Some(op.value(a, b, &SILENT))
}
