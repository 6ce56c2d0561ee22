//! Linear forms of the coordinates: a·x + b·y + c·z + d.
//!
//! A rotation about any axis reads each coordinate several times. Interval arithmetic then takes the reads for
//! independent, and the bounds of the rotated coordinates are several times too wide. The linear form reads each
//! coordinate once. Its coefficients are intervals that cover the roundings of the original operations and of the form
//! itself: after n operations on terms with the sum s of absolute values, the error is at most about n·2⁻²⁴·s
//! (Higham, "Accuracy and Stability of Numerical Algorithms", section 3.1).

use crate::graph::{Graph, Input, Interval, Node, NodeId, Op};

/// Larger coefficients might overflow at the largest coordinates that are searched.
const COEFFICIENT_MAX: f64 = 1e20;
/// Operations of the form itself, with a margin.
const OPERATIONS_BESIDE: u32 = 16;
/// Rounding error of an operation, relative to the result.
const ROUNDING: f64 = 1.0 / (1 << 24) as f64;
/// Covers underflow.
const TINY: f64 = 1e-30;

/// A linear form, with the coefficients of x, y and z, then the constant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Linear {
    coefficients: [f64; 4],
    /// For each coefficient, the sum of the absolute values of its terms.
    absolute: [f64; 4],
    operations: u32,
    /// How often each coordinate is read.
    reads: [u32; 3],
}

impl Linear {
    fn constant(value: f32) -> Self {
        Self::term(3, f64::from(value), [0; 3])
    }

    fn coordinate(axis: usize) -> Self {
        Self::term(axis, 1.0, std::array::from_fn(|other| u32::from(other == axis)))
    }

    fn term(place: usize, coefficient: f64, reads: [u32; 3]) -> Self {
        let mut coefficients = [0.0; 4];
        coefficients[place] = coefficient;
        Self { coefficients, absolute: coefficients.map(f64::abs), operations: 0, reads }
    }

    fn sum(&self, other: &Self, sign: f64) -> Self {
        Self {
            coefficients: std::array::from_fn(|at| self.coefficients[at] + sign * other.coefficients[at]),
            absolute: std::array::from_fn(|at| self.absolute[at] + other.absolute[at]),
            operations: self.operations.max(other.operations) + 1,
            reads: std::array::from_fn(|axis| self.reads[axis].saturating_add(other.reads[axis])),
        }
    }

    fn scaled(&self, factor: f64) -> Self {
        Self {
            coefficients: self.coefficients.map(|coefficient| factor * coefficient),
            absolute: self.absolute.map(|absolute| factor.abs() * absolute),
            operations: self.operations + 1,
            reads: self.reads,
        }
    }

    /// Returns the form of a node, given the forms of its operands.
    fn of(graph: &Graph, node: Node, forms: &[Option<Self>]) -> Option<Self> {
        let at = |id: NodeId| forms[id.index()];
        let form = match node {
            Node::Constant(value) => Self::constant(value),
            Node::Input(Input::X) => Self::coordinate(0),
            Node::Input(Input::Y) => Self::coordinate(1),
            Node::Input(Input::Z) => Self::coordinate(2),
            Node::Unary(Op::Neg, a) => at(a)?.scaled(-1.0),
            Node::Binary(Op::Add, a, b) => at(a)?.sum(&at(b)?, 1.0),
            Node::Binary(Op::Sub, a, b) => at(a)?.sum(&at(b)?, -1.0),
            Node::Binary(Op::Mul, a, b) => match (graph.node(a), graph.node(b)) {
                (_, Node::Constant(b)) => at(a)?.scaled(f64::from(b)),
                (Node::Constant(a), _) => at(b)?.scaled(f64::from(a)),
                _ => return None,
            },
            Node::Binary(Op::Div, a, b) => at(a)?.scaled(1.0 / f64::from(graph.node(b).as_constant()?)),
            _ => return None,
        };
        form.absolute.iter().all(|absolute| *absolute < COEFFICIENT_MAX).then_some(form)
    }

    /// Returns the forms of those nodes that read a coordinate several times and that are operands of other operators,
    /// or the root.
    pub(super) fn all(graph: &Graph, nodes: &[NodeId], root: NodeId) -> Vec<Option<Self>> {
        let mut forms: Vec<Option<Self>> = vec![None; graph.len()];
        let mut read = vec![false; graph.len()];
        read[root.index()] = true;
        for id in nodes {
            let node = graph.node(*id);
            forms[id.index()] = Self::of(graph, node, &forms);
            if forms[id.index()].is_none() {
                node.operands().for_each(|operand| read[operand.index()] = true);
            }
        }
        let repeats = |form: &Self| form.reads.iter().any(|reads| *reads > 1);
        forms.iter().zip(read).map(|(form, read)| form.filter(|form| read && repeats(form))).collect()
    }

    /// Returns the coefficients of x, y and z, then the constant.
    pub(super) fn intervals(&self) -> [Interval; 4] {
        let error = f64::from(2 * self.operations + OPERATIONS_BESIDE) * ROUNDING;
        std::array::from_fn(|at| {
            let error = self.absolute[at] * error + TINY;
            let (lo, hi) = (self.coefficients[at] - error, self.coefficients[at] + error);
            Interval::new(lo as f32, hi as f32)
        })
    }
}
