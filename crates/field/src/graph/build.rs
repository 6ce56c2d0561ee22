//! Builders of expressions. Helpers such as [`Graph::mix`] combine several operators.

use super::{Graph, Input, Node, NodeId, Op};

/// Up to this magnitude, [`Graph::pow`] turns a constant integer exponent into a product.
pub const PRODUCT_EXPONENT_MAX: f32 = 64.0;

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
    pub fn unary(&mut self, op: Op, a: NodeId) -> NodeId {
        if op.arity() == 2 { self.simplified_binary(op, a, a) } else { self.simplified_unary(op, a) }
    }

    /// Applies the two-operand operator `op` to `a` and `b`, and simplifies. A one-operand operator ignores `b`.
    #[inline]
    pub fn binary(&mut self, op: Op, a: NodeId, b: NodeId) -> NodeId {
        if op.arity() == 2 { self.simplified_binary(op, a, b) } else { self.simplified_unary(op, a) }
    }

    /// Adds `node` without simplification, for tests of the simplification rules.
    pub fn raw(&mut self, node: Node) -> NodeId {
        self.intern(node)
    }

    /// Reads a channel of a texture at (u, v): 0 red, 1 green, 2 blue, 3 alpha. `channel` is taken modulo 4.
    pub fn texture(&mut self, texture: u16, channel: u8, u: NodeId, v: NodeId) -> NodeId {
        self.intern(Node::Texture { texture, channel: channel & 3, u, v })
    }

    /// a + b.
    #[inline]
    pub fn add(&mut self, a: NodeId, b: NodeId) -> NodeId {
        self.simplified_binary(Op::Add, a, b)
    }

    /// a - b.
    #[inline]
    pub fn sub(&mut self, a: NodeId, b: NodeId) -> NodeId {
        self.simplified_binary(Op::Sub, a, b)
    }

    /// a * b.
    #[inline]
    pub fn mul(&mut self, a: NodeId, b: NodeId) -> NodeId {
        self.simplified_binary(Op::Mul, a, b)
    }

    /// a / b; 0 where b is 0.
    #[inline]
    pub fn div(&mut self, a: NodeId, b: NodeId) -> NodeId {
        self.simplified_binary(Op::Div, a, b)
    }

    /// min(a, b).
    #[inline]
    pub fn min(&mut self, a: NodeId, b: NodeId) -> NodeId {
        self.simplified_binary(Op::Min, a, b)
    }

    /// max(a, b).
    #[inline]
    pub fn max(&mut self, a: NodeId, b: NodeId) -> NodeId {
        self.simplified_binary(Op::Max, a, b)
    }

    /// -a.
    #[inline]
    pub fn neg(&mut self, a: NodeId) -> NodeId {
        self.simplified_unary(Op::Neg, a)
    }

    /// |a|.
    #[inline]
    pub fn abs(&mut self, a: NodeId) -> NodeId {
        self.simplified_unary(Op::Abs, a)
    }

    /// Returns the square root, 0 for negative a.
    #[inline]
    pub fn sqrt(&mut self, a: NodeId) -> NodeId {
        self.simplified_unary(Op::Sqrt, a)
    }

    /// a * a.
    #[inline]
    pub fn square(&mut self, a: NodeId) -> NodeId {
        self.simplified_unary(Op::Square, a)
    }

    /// a to the power of b. A constant integer exponent up to ±[`PRODUCT_EXPONENT_MAX`] becomes a product, for any
    /// base: `x^2` is x * x, and `x^-2` is 1 / (x * x), or 0 for x = 0. Other exponents use [`Op::Pow`], which is 0 for
    /// a negative base.
    pub fn pow(&mut self, a: NodeId, b: NodeId) -> NodeId {
        match self.as_constant(b) {
            Some(n) if n.fract() == 0.0 && n.abs() <= PRODUCT_EXPONENT_MAX => {
                let product = self.whole_power(a, n.abs() as u32);
                if n < 0.0 {
                    let one = self.constant(1.0);
                    self.div(one, product)
                } else {
                    product
                }
            }
            _ => self.simplified_binary(Op::Pow, a, b),
        }
    }

    fn whole_power(&mut self, a: NodeId, mut n: u32) -> NodeId {
        let mut power = a;
        let mut product = None;
        while n > 0 {
            if n & 1 == 1 {
                product = Some(match product {
                    None => power,
                    Some(so_far) => self.mul(so_far, power),
                });
            }
            n >>= 1;
            if n > 0 {
                power = self.square(power);
            }
        }
        match product {
            Some(product) => product,
            None => self.constant(1.0),
        }
    }

    /// 1 where c is 0, else 0.
    pub fn not(&mut self, c: NodeId) -> NodeId {
        self.simplified_unary(Op::Not, c)
    }

    /// a where c is not 0, else b. The sum MASK(c, a) + MASK(NOT c, b) is exact, because the unselected term is +0 even
    /// if its operand is a NaN.
    pub fn select(&mut self, c: NodeId, a: NodeId, b: NodeId) -> NodeId {
        if a == b {
            return a;
        }
        let not_c = self.not(c);
        let when_true = self.simplified_binary(Op::Mask, c, a);
        let when_false = self.simplified_binary(Op::Mask, not_c, b);
        self.add(when_true, when_false)
    }

    /// min(max(a, low), high).
    pub fn clamp(&mut self, a: NodeId, low: NodeId, high: NodeId) -> NodeId {
        let above = self.max(a, low);
        self.min(above, high)
    }

    /// a * (1 - t) + b * t, as GLSL defines mix.
    pub fn mix(&mut self, a: NodeId, b: NodeId, t: NodeId) -> NodeId {
        let one = self.constant(1.0);
        let rest = self.sub(one, t);
        let left = self.mul(a, rest);
        let right = self.mul(b, t);
        self.add(left, right)
    }

    /// GLSL's smoothstep: with t = clamp((x - low) / (high - low), 0, 1), t * t * (3 - 2 * t).
    pub fn smoothstep(&mut self, low: NodeId, high: NodeId, x: NodeId) -> NodeId {
        let (zero, one) = (self.constant(0.0), self.constant(1.0));
        let (two, three) = (self.constant(2.0), self.constant(3.0));
        let along = self.sub(x, low);
        let width = self.sub(high, low);
        let ratio = self.div(along, width);
        let t = self.clamp(ratio, zero, one);
        let squared = self.square(t);
        let twice = self.mul(t, two);
        let rest = self.sub(three, twice);
        self.mul(squared, rest)
    }

    /// The scalar product, summed from the first component; 0 for empty slices. Unpaired components are ignored.
    pub fn dot(&mut self, a: &[NodeId], b: &[NodeId]) -> NodeId {
        let mut sum = None;
        for (&a, &b) in a.iter().zip(b) {
            let product = self.mul(a, b);
            sum = Some(match sum {
                None => product,
                Some(sum) => self.add(sum, product),
            });
        }
        match sum {
            Some(sum) => sum,
            None => self.constant(0.0),
        }
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
}
