//! Builders of expressions. Helpers such as [`Graph::mix`] combine several operators.

use std::collections::HashMap;
use std::ops::{Add, Div, Mul, Sub};

use super::Graph;
use super::frame_inputs::SILENT;
use super::node::{Input, Node, NodeId};
use super::op::{Op, Properties};

/// Up to this magnitude, [`Graph::pow`] turns a constant integer exponent into a product.
pub const PRODUCT_EXPONENT_MAX: f32 = 64.0;

/// An operand of the builders: a node, a number, which becomes a constant, or operators on both.
pub trait Term {
    /// Returns the node, which may be new.
    fn node(self, graph: &mut Graph) -> NodeId;
}

impl Term for NodeId {
    #[inline]
    fn node(self, _: &mut Graph) -> NodeId {
        self
    }
}

impl Term for f32 {
    fn node(self, graph: &mut Graph) -> NodeId {
        graph.constant(self)
    }
}

/// Operators such as `(1.0 - a) * b`. Their nodes are added where they are used, operands first, from left to right.
#[derive(Debug, Clone, Copy)]
#[must_use]
pub struct Pending<A, B>(Op, A, B);

impl<A: Term, B: Term> Term for Pending<A, B> {
    #[inline]
    fn node(self, graph: &mut Graph) -> NodeId {
        let Self(op, a, b) = self;
        graph.binary(op, a, b)
    }
}

macro_rules! arithmetic {
    ($($op:ident $name:ident,)+) => {$(
        arithmetic!($op $name [B: Term] NodeId, B);
        arithmetic!($op $name [A: Term, B: Term, C: Term] Pending<A, B>, C);
        arithmetic!($op $name [] f32, NodeId);
        arithmetic!($op $name [A: Term, B: Term] f32, Pending<A, B>);
    )+};
    ($op:ident $name:ident [$($generics:tt)*] $a:ty, $b:ty) => {
        impl<$($generics)*> $op<$b> for $a {
            type Output = Pending<$a, $b>;

            fn $name(self, b: $b) -> Self::Output {
                Pending(Op::$op, self, b)
            }
        }
    };
}

arithmetic! { Add add, Sub sub, Mul mul, Div div, }

/// The second operand of an operator that has one operand.
#[derive(Debug, Clone, Copy)]
pub struct NoTerm;

impl Term for NoTerm {
    #[inline]
    fn node(self, _: &mut Graph) -> NodeId {
        NodeId::default()
    }
}

impl Op {
    /// This operator on one operand.
    pub fn of<A: Term>(self, a: A) -> Pending<A, NoTerm> {
        Pending(self, a, NoTerm)
    }

    /// This operator on two operands.
    pub fn pair<A: Term, B: Term>(self, a: A, b: B) -> Pending<A, B> {
        Pending(self, a, b)
    }
}

/// Declares methods that apply one operator, and simplify.
macro_rules! operators {
    ($($(#[doc = $doc:literal])+ $name:ident = $simplified:ident $op:ident($($operand:ident),+);)+) => {
        impl Graph {
            $(
                $(#[doc = $doc])+
                #[inline]
                pub fn $name(&mut self, $($operand: impl Term),+) -> NodeId {
                    $(let $operand = $operand.node(self);)+
                    self.$simplified(Op::$op, $($operand),+)
                }
            )+
        }
    };
}

operators! {
    /// a + b.
    add = simplified_binary Add(a, b);
    /// a - b.
    sub = simplified_binary Sub(a, b);
    /// a * b.
    mul = simplified_binary Mul(a, b);
    /// a / b; 0 where b is 0.
    div = simplified_binary Div(a, b);
    /// min(a, b).
    min = simplified_binary Min(a, b);
    /// max(a, b).
    max = simplified_binary Max(a, b);
    /// -a.
    neg = simplified_unary Neg(a);
    /// |a|.
    abs = simplified_unary Abs(a);
    /// Returns the square root, 0 for negative a.
    sqrt = simplified_unary Sqrt(a);
    /// a * a.
    square = simplified_unary Square(a);
}

impl Graph {
    /// Adds a constant. Both zeros become one node, and so do all NaNs.
    #[inline]
    pub fn constant(&mut self, value: f32) -> NodeId {
        let value = if value.is_nan() { f32::NAN } else { value + 0.0 };
        self.intern(Node::Constant(value))
    }

    /// Adds an input.
    #[inline]
    pub fn input(&mut self, input: Input) -> NodeId {
        self.intern(Node::Input(input))
    }

    /// Applies the one-operand operator `op` to `a`, and simplifies. A two-operand operator gets `a` twice.
    #[inline]
    pub fn unary(&mut self, op: Op, a: impl Term) -> NodeId {
        let a = a.node(self);
        if op.arity() == 2 { self.simplified_binary(op, a, a) } else { self.simplified_unary(op, a) }
    }

    /// Applies the two-operand operator `op` to `a` and `b`, and simplifies. A one-operand operator ignores `b`.
    #[inline]
    pub fn binary(&mut self, op: Op, a: impl Term, b: impl Term) -> NodeId {
        let (a, b) = (a.node(self), b.node(self));
        if op.arity() == 2 { self.simplified_binary(op, a, b) } else { self.simplified_unary(op, a) }
    }

    /// Adds `node` without simplification, such as a node of another graph whose operands have been copied.
    pub fn raw(&mut self, node: Node) -> NodeId {
        self.intern(node)
    }

    /// Reads a channel of a texture at (u, v): 0 red, 1 green, 2 blue, 3 alpha. `channel` is taken modulo 4.
    pub fn texture(&mut self, texture: u16, channel: u8, u: NodeId, v: NodeId) -> NodeId {
        self.intern(Node::Texture { texture, channel: channel & 3, u, v })
    }

    /// Copies the nodes of `order` with other nodes for the inputs for which `other` returns one. Returns the copies of
    /// `roots`.
    pub(crate) fn with_inputs(
        &mut self,
        roots: &[NodeId],
        other: impl Fn(&mut Self, Input) -> Option<NodeId>,
    ) -> Vec<NodeId> {
        let order = self.order(roots);
        let mut copies: HashMap<NodeId, NodeId> = HashMap::with_capacity(order.len());
        for id in order {
            let at = |id: NodeId| copies.get(&id).copied().unwrap_or(id);
            let copy = match self.node(id) {
                Node::Constant(_) => id,
                Node::Input(input) => other(self, input).unwrap_or(id),
                Node::Unary(op, a) => self.unary(op, at(a)),
                Node::Binary(op, a, b) => self.binary(op, at(a), at(b)),
                Node::Texture { texture, channel, u, v } => self.texture(texture, channel, at(u), at(v)),
            };
            copies.insert(id, copy);
        }
        roots.iter().map(|id| copies.get(id).copied().unwrap_or(*id)).collect()
    }

    /// a to the power of b. A constant integer exponent up to ±[`PRODUCT_EXPONENT_MAX`] becomes a product, for any
    /// base: `x^2` is x * x, and `x^-2` is 1 / (x * x), or 0 for x = 0. Other exponents use [`Op::Pow`], which is 0 for
    /// a negative base.
    pub fn pow(&mut self, a: impl Term, b: impl Term) -> NodeId {
        let (a, b) = (a.node(self), b.node(self));
        match self.as_constant(b) {
            Some(n) if n.fract() == 0.0 && n.abs() <= PRODUCT_EXPONENT_MAX => {
                let product = self.whole_power(a, n.abs() as u32);
                if n < 0.0 { self.div(1.0, product) } else { product }
            }
            _ => self.simplified_binary(Op::Pow, a, b),
        }
    }

    fn whole_power(&mut self, a: NodeId, mut n: u32) -> NodeId {
        let mut power = a;
        let mut product = None;
        while n > 0 {
            if n & 1 == 1 {
                product = Some(product.map_or(power, |so_far| self.mul(so_far, power)));
            }
            n >>= 1;
            if n > 0 {
                power = self.square(power);
            }
        }
        product.unwrap_or_else(|| self.constant(1.0))
    }

    /// 1 where c is 0, else 0.
    pub fn not(&mut self, c: impl Term) -> NodeId {
        self.unary(Op::Not, c)
    }

    /// a where c is not 0, else b. The sum MASK(c, a) + MASK(NOT c, b) is exact, because the unselected term is +0 even
    /// if its operand is a NaN.
    pub fn select(&mut self, c: impl Term, a: impl Term, b: impl Term) -> NodeId {
        let (c, a, b) = (c.node(self), a.node(self), b.node(self));
        if a == b {
            return a;
        }
        let not_c = self.not(c);
        let when_true = self.simplified_binary(Op::Mask, c, a);
        let when_false = self.simplified_binary(Op::Mask, not_c, b);
        self.add(when_true, when_false)
    }

    /// min(max(a, low), high).
    pub fn clamp(&mut self, a: impl Term, low: impl Term, high: impl Term) -> NodeId {
        let above = self.max(a, low);
        self.min(above, high)
    }

    /// a * (1 - t) + b * t, as GLSL defines mix.
    pub fn mix(&mut self, a: impl Term, b: impl Term, t: impl Term) -> NodeId {
        let (a, b, t) = (a.node(self), b.node(self), t.node(self));
        self.add(a * (1.0 - t), b * t)
    }

    /// GLSL's smoothstep: with t = clamp((x - low) / (high - low), 0, 1), t * t * (3 - 2 * t).
    pub fn smoothstep(&mut self, low: impl Term, high: impl Term, x: impl Term) -> NodeId {
        let (low, high, x) = (low.node(self), high.node(self), x.node(self));
        let t = self.clamp((x - low) / (high - low), 0.0, 1.0);
        let squared = self.square(t);
        self.mul(squared, 3.0 - t * 2.0)
    }

    /// The scalar product, summed from the first component; 0 for empty slices. Unpaired components are ignored.
    pub fn dot(&mut self, a: &[NodeId], b: &[NodeId]) -> NodeId {
        let mut sum = None;
        for (&a, &b) in a.iter().zip(b) {
            let product = self.mul(a, b);
            sum = Some(sum.map_or(product, |sum| self.add(sum, product)));
        }
        sum.unwrap_or_else(|| self.constant(0.0))
    }

    /// Returns the length of a vector; the magnitude of a scalar.
    pub fn length(&mut self, v: &[NodeId]) -> NodeId {
        match v {
            [a] => self.abs(*a),
            _ => {
                let squares = self.dot(v, v);
                self.sqrt(squares)
            }
        }
    }

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
        match (first, second) {
            // x - 0 = x
            (_, Some(0.0)) => Some(a),
            // 0 - x = -x
            (Some(0.0), _) => Some(self.simplified_unary(Op::Neg, b)),
            // x - (-y) = x + y
            _ => self.negated(b).map(|y| self.simplified_binary(Op::Add, a, y)),
        }
    }

    fn product(&mut self, a: NodeId, b: NodeId, constant: Option<f32>) -> Option<NodeId> {
        match constant {
            // x * 1 = x
            Some(1.0) => Some(a),
            // x * -1 = -x
            Some(-1.0) => Some(self.simplified_unary(Op::Neg, a)),
            // (-x) * c = x * (-c)
            Some(c) => {
                let (x, negative) = (self.negated(a)?, self.constant(-c));
                Some(self.simplified_binary(Op::Mul, x, negative))
            }
            // x * x = x²
            None if a == b => Some(self.simplified_unary(Op::Square, a)),
            // (-x) * (-y) = x * y
            None => {
                let (x, y) = (self.negated(a)?, self.negated(b)?);
                Some(self.simplified_binary(Op::Mul, x, y))
            }
        }
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
        // min(x, x) = x; min(x, NaN) = x
        if a == b || constant.is_some_and(f32::is_nan) {
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
        match (condition, value) {
            // mask(0, x) = 0
            (Some(0.0), _) => Some(self.constant(0.0)),
            // mask(c, x) = x for a constant c that is not 0; mask(c, 0) = 0
            (Some(_), _) | (_, Some(0.0)) => Some(a),
            // mask(c, 1) = c where c is 0 or 1
            (_, Some(1.0)) if self.has(c, Properties::TRUTH) => Some(c),
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
