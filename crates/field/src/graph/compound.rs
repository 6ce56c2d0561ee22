//! Compounds: several operators in one clause, because the interpreter's time grows with the number of clauses. A
//! clause has two registers and a number. Most operators use only two of these three; most compounds use all three.
//!
//! A compound's value, bounds and GLSL follow from its parts, each of which is rounded separately. Compounds are made
//! when a tape is written for the interpreter, after pruning and all other analysis. A compound may therefore contain
//! minima without hiding a choice from pruning.
//!
//! Compounds have the numbers 96..128, after the two-operand operators. They make the interpreter's code at most 7.3 %
//! longer on Vega GPUs and 5 % longer on Xe GPUs, without additional GPU registers.

use std::cell::RefCell;
use std::cmp::Reverse;
use std::fmt::Write as _;

use super::Graph;
use super::frame_inputs::FrameInputs;
use super::interval::Interval;
use super::node::{Node, NodeId};
use super::op::{Op, Properties};

const PARTS_MAX: usize = 6;
/// The lowest number of a compound.
pub const FIRST_COMPOUND: u8 = 96;

#[derive(Debug, Clone, Copy, PartialEq)]
enum Reads {
    A,
    B,
    /// The number that is stored in the clause.
    C,
    QuarterOverC,
    Always(f32),
    Part(usize),
}

/// One of a compound's operators. One-operand operators read only `a`.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Part {
    op: Op,
    a: Reads,
    b: Reads,
}

const fn two(op: Op, a: Reads, b: Reads) -> Part {
    Part { op, a, b }
}

const fn one(op: Op, a: Reads) -> Part {
    Part { op, a, b: a }
}

macro_rules! compounds {
    ($( $(#[doc = $doc:literal])+ $id:ident = $number:literal $name:literal [$($part:expr),+]; )+) => {
        /// Several operators on two registers a and b and a number c.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
        #[repr(u8)]
        pub enum Compound { $( $(#[doc = $doc])+ $id = $number, )+ }

        impl Compound {
            /// Every compound, in the order of their numbers.
            pub const ALL: &'static [Compound] = &[$( Compound::$id, )+];

            /// Returns the name, such as `MUL_ADD`.
            pub const fn name(self) -> &'static str {
                match self { $( Compound::$id => $name, )+ }
            }

            /// Returns the compound with this number.
            pub const fn from_number(number: u8) -> Option<Compound> {
                match number { $( $number => Some(Compound::$id), )+ _ => None }
            }

            const fn parts(self) -> &'static [Part] {
                use Reads::{A, Always, B, C, Part as Earlier, QuarterOverC};
                // Avoids a warning if no row uses one of these imports.
                const _: [Reads; 6] = [A, B, C, QuarterOverC, Always(0.0), Earlier(0)];
                match self { $( Compound::$id => const { &[$($part),+] }, )+ }
            }
        }
    };
}

compounds! {
    /// a * c + b; also b - a * c, if the clause stores -c instead of c.
    MulAdd = 96 "MUL_ADD" [two(Op::Mul, A, C), two(Op::Add, Earlier(0), B)];
    /// a * c - b.
    MulSub = 97 "MUL_SUB" [two(Op::Mul, A, C), two(Op::Sub, Earlier(0), B)];
    /// a * c * b.
    MulMul = 98 "MUL_MUL" [two(Op::Mul, A, C), two(Op::Mul, Earlier(0), B)];
    /// (a + c) * b.
    AddMul = 99 "ADD_MUL" [two(Op::Add, A, C), two(Op::Mul, Earlier(0), B)];
    /// a + b + c.
    AddAdd = 100 "ADD_ADD" [two(Op::Add, A, B), two(Op::Add, Earlier(0), C)];
    /// min(a + c, b).
    AddMin = 101 "ADD_MIN" [two(Op::Add, A, C), two(Op::Min, Earlier(0), B)];
    /// max(a + c, b).
    AddMax = 102 "ADD_MAX" [two(Op::Add, A, C), two(Op::Max, Earlier(0), B)];
    /// max(|a| - c, b): one axis of the distance to a box.
    AbsSubMax = 103 "ABS_SUB_MAX" [two(Op::AbsSub, A, C), two(Op::Max, Earlier(0), B)];
    /// a^2 + b^2.
    Squares = 104 "SQUARES" [one(Op::Square, B), two(Op::SquareAdd, A, Earlier(0))];
    /// (a + c)^2 + b.
    ShiftedSquareAdd = 105 "SHIFTED_SQUARE_ADD" [two(Op::Add, A, C), two(Op::SquareAdd, Earlier(0), B)];
    /// The length of (a, b).
    Hypotenuse = 106 "HYPOTENUSE" [one(Op::Square, B), two(Op::Length, A, Earlier(0))];
    /// The square root of a^2 + b, minus c: the last step of the distance to a ball.
    LengthSub = 107 "LENGTH_SUB" [two(Op::SquareAdd, A, B), two(Op::SqrtSub, Earlier(0), C)];
    /// The length of (a, b), minus c: the distance to a cylinder, or the last step of the distance to a ring.
    HypotenuseSub = 108 "HYPOTENUSE_SUB" [
        one(Op::Square, B), two(Op::SquareAdd, A, Earlier(0)), two(Op::SqrtSub, Earlier(1), C)
    ];
    /// The smooth minimum of a and b with the blend radius c, as in `smooth_union`.
    SmoothMin = 109 "SMOOTH_MIN" [
        two(Op::AbsDifference, A, B), two(Op::Sub, C, Earlier(0)), two(Op::OutsideAdd, Earlier(1), Always(0.0)),
        two(Op::Mul, Earlier(2), QuarterOverC), two(Op::Min, A, B), two(Op::Sub, Earlier(4), Earlier(3))
    ];
    /// min(max(a, 0), 1).
    Saturate = 110 "SATURATE" [two(Op::Max, A, Always(0.0)), two(Op::Min, Earlier(0), Always(1.0))];
    /// a^2 * (3 - 2 * a): a smooth step between 0 and 1.
    Smooth = 111 "SMOOTH" [
        one(Op::Square, A), two(Op::Mul, A, Always(2.0)), two(Op::Sub, Always(3.0), Earlier(1)),
        two(Op::Mul, Earlier(0), Earlier(2))
    ];
    /// |a * c - b|.
    MulAbsDifference = 112 "MUL_ABS_DIFFERENCE" [two(Op::Mul, A, C), two(Op::AbsDifference, Earlier(0), B)];
    /// (a * c - b)^2.
    MulSquareDifference = 113 "MUL_SQUARE_DIFFERENCE" [
        two(Op::Mul, A, C), two(Op::SquareDifference, Earlier(0), B)
    ];
}

impl Compound {
    /// Returns the compound's number.
    pub const fn number(self) -> u8 {
        self as u8
    }

    /// Returns the number of operators that the compound replaces.
    pub const fn operators(self) -> usize {
        self.parts().len()
    }

    const fn bit(self) -> u32 {
        1 << (self.number() - FIRST_COMPOUND)
    }

    /// Returns the value for the operands `a`, `b` and `c`, bit for bit as the separate operators compute it.
    pub fn value(self, a: f32, b: f32, c: f32, frame: &FrameInputs) -> f32 {
        self.by_parts([a, b, c, 0.25 / c], |number| number, |op, a, b| op.value(a, b, frame))
    }

    /// Returns bounds of the value for operands within `a` and `b`, and the number `c`.
    pub fn bounds(self, a: Interval, b: Interval, c: f32, frame: &FrameInputs) -> Interval {
        let [c, quarter] = [c, 0.25 / c].map(Interval::point);
        self.by_parts([a, b, c, quarter], Interval::point, |op, a, b| op.bounds(a, b, frame))
    }

    /// Applies the operators one after the other. The operands are a, b, c and a quarter over c.
    fn by_parts<T: Clone>(
        self,
        [a, b, c, quarter]: [T; 4],
        number: impl Fn(f32) -> T,
        mut apply: impl FnMut(Op, T, T) -> T,
    ) -> T {
        let mut values: [T; PARTS_MAX] = std::array::from_fn(|_| a.clone());
        let mut last = 0;
        for (place, part) in self.parts().iter().enumerate() {
            let [first, second] = [part.a, part.b].map(|reads| match reads {
                Reads::A => a.clone(),
                Reads::B => b.clone(),
                Reads::C => c.clone(),
                Reads::QuarterOverC => quarter.clone(),
                Reads::Always(constant) => number(constant),
                Reads::Part(earlier) => values[earlier].clone(),
            });
            values[place] = apply(part.op, first, second);
            last = place;
        }
        values[last].clone()
    }

    /// Adds the compound's operators to `graph` and returns the last node.
    pub fn nodes(self, graph: &mut Graph, a: NodeId, b: NodeId, c: f32) -> NodeId {
        let [c, quarter] = [c, 0.25 / c].map(|number| graph.constant(number));
        let graph = RefCell::new(graph);
        let constant = |number| graph.borrow_mut().constant(number);
        self.by_parts([a, b, c, quarter], constant, |op, a, b| {
            let node = if op.arity() == 1 { Node::Unary(op, a) } else { Node::Binary(op, a, b) };
            graph.borrow_mut().raw(node)
        })
    }

    /// Returns GLSL: declarations of the intermediate values, and the result as an expression of `a`, `b` and `c`.
    pub(crate) fn glsl(
        self,
        fill: impl Fn(&mut String, &str, &str, &str),
        literal: impl Fn(f32) -> String,
    ) -> (String, String) {
        let (mut before, mut expression, mut place) = (String::new(), String::new(), 0);
        let name = |part: usize| format!("{}_{part}", self.name().to_lowercase());
        self.by_parts(["a", "b", "c", "(0.25 / c)"].map(str::to_owned), literal, |op, a, b| {
            if place > 0 {
                // Writing to a String cannot fail.
                let _ = writeln!(before, "    float {} = {expression};", name(place - 1));
            }
            expression.clear();
            fill(&mut expression, op.glsl(), &a, &b);
            place += 1;
            name(place - 1)
        });
        (before, expression)
    }
}

/// A set of compounds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default)]
pub struct Compounds(u32);

impl Compounds {
    /// No compound.
    pub const NONE: Self = Self(0);
    /// All compounds.
    pub const ALL: Self = {
        let (mut all, mut place) = (0, 0);
        while place < Compound::ALL.len() {
            all |= Compound::ALL[place].bit();
            place += 1;
        }
        Self(all)
    };

    /// True if this set contains `other`.
    pub const fn covers(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// Returns the members, in the order of their numbers.
    pub fn iter(self) -> impl Iterator<Item = Compound> {
        Compound::ALL.iter().copied().filter(move |compound| self.0 & compound.bit() != 0)
    }

    /// Adds a compound.
    pub fn insert(&mut self, compound: Compound) {
        self.0 |= compound.bit();
    }

    /// Returns the compounds that save at least one clause in forty. Other compounds cost more than they save: a
    /// renderer that does not skip branches computes all operators of the shader for every clause.
    pub(crate) fn that_pay(count: impl Fn(Self) -> Uses) -> Self {
        let mut kept = Self::ALL;
        // Count twice: the operators of a compound that was removed may match another compound.
        for _ in 0..2 {
            let uses = count(kept);
            let mut paying = Self::NONE;
            for compound in kept.iter() {
                let saved = uses.of(compound) * (compound.operators() - 1);
                if saved > 0 && saved * CLAUSES_PER_SAVED >= uses.operators {
                    paying.insert(compound);
                }
            }
            kept = paying;
        }
        kept
    }
}

const CLAUSES_PER_SAVED: usize = 40;

#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Uses {
    counts: [usize; 32],
    pub(crate) operators: usize,
}

impl Uses {
    pub(crate) fn add(&mut self, compound: Option<Compound>) {
        self.operators += compound.map_or(1, Compound::operators);
        if let Some(compound) = compound {
            self.counts[usize::from(compound.number() - FIRST_COMPOUND) & 31] += 1;
        }
    }

    fn of(&self, compound: Compound) -> usize {
        self.counts[usize::from(compound.number() - FIRST_COMPOUND) & 31]
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Arg {
    Value(u32),
    Number(f32),
}

/// An operator with its operands. A one-operand operator has its operand twice.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Operation {
    pub(crate) op: Op,
    pub(crate) a: Arg,
    pub(crate) b: Arg,
}

#[derive(Debug, Clone, Copy)]
pub(crate) struct Found {
    pub(crate) compound: Compound,
    /// The values that the compound reads from registers. If it reads only one register, both values are the same.
    pub(crate) registers: [u32; 2],
    pub(crate) number: f32,
}

/// The operands found so far while a compound is matched with a tape.
#[derive(Debug, Clone, Copy, Default)]
struct Bound {
    a: Option<u32>,
    b: Option<u32>,
    c: Option<f32>,
    quarter: Option<f32>,
}

/// For each operator number, the compounds that may end with that operator, and those in which it may be the first part
/// among the operands of the last part. Every compound has a part there.
const LAST_AND_BEFORE: [[u32; 128]; 2] = {
    let [mut last, mut before] = [[0; 128]; 2];
    let mut place = 0;
    while place < Compound::ALL.len() {
        let parts = Compound::ALL[place].parts();
        let Part { op, a, b } = parts[parts.len() - 1];
        insert(&mut last, op, Compound::ALL[place]);
        if let (Reads::Part(earlier), _) | (_, Reads::Part(earlier)) = (a, b) {
            insert(&mut before, parts[earlier].op, Compound::ALL[place]);
        }
        place += 1;
    }
    [last, before]
};

const fn insert(table: &mut [u32; 128], op: Op, compound: Compound) {
    table[op.number() as usize] |= compound.bit();
    // A tape may store a sum as a difference, with the opposite sign of the number or product, and vice versa.
    if matches!(op, Op::Add | Op::Sub) {
        table[Op::Add.number() as usize] |= compound.bit();
        table[Op::Sub.number() as usize] |= compound.bit();
    }
}

impl Compounds {
    /// Returns the compound of this set that matches the operations up to `last` and has the most parts. `own` returns
    /// the operation of a value that is read exactly once.
    #[inline]
    pub(crate) fn find(self, own: impl Fn(u32) -> Option<Operation>, last: Operation) -> Option<Found> {
        let [rooted, before_last] = &LAST_AND_BEFORE;
        let by_op = |table: &[u32; 128], op: Op| table.get(usize::from(op.number())).copied().unwrap_or(0);
        let rooted = self.0 & by_op(rooted, last.op);
        if rooted == 0 {
            return None;
        }
        let before = |operand: Arg| match operand {
            Arg::Value(value) => own(value).map_or(0, |operation| by_op(before_last, operation.op)),
            Arg::Number(_) => 0,
        };
        let candidates = rooted & (before(last.a) | before(last.b));
        if candidates == 0 { None } else { Self(candidates).find_among(&own, last) }
    }

    fn find_among(self, own: &impl Fn(u32) -> Option<Operation>, last: Operation) -> Option<Found> {
        let found = self.iter().filter_map(|compound| {
            let (parts, mut bound) = (compound.parts(), Bound::default());
            let fits = fit(own, parts, parts.len() - 1, last, false, &mut bound);
            let number = bound.c.unwrap_or(0.0);
            let fits = fits && bound.quarter.is_none_or(|quarter| quarter == 0.25 / number);
            let a = bound.a.filter(|_| fits)?;
            Some(Found { compound, registers: [a, bound.b.unwrap_or(a)], number })
        });
        // The first one of the longest.
        found.min_by_key(|found| Reverse(found.compound.operators()))
    }
}

/// Matches a part with an operation, and adds the operands that the part reads to `bound`. Returns false if they do not
/// match; `bound` is then meaningless. If `negated` is set, the operation's number must have the opposite sign.
fn fit(
    own: &impl Fn(u32) -> Option<Operation>,
    parts: &[Part],
    place: usize,
    Operation { op, a, b }: Operation,
    negated: bool,
    bound: &mut Bound,
) -> bool {
    let Some(&part) = parts.get(place) else { return false };
    let both = |for_a: Arg, for_b: Arg, bound: &mut Bound| {
        fit_operand(own, parts, part.a, for_a, negated, bound)
            && fit_operand(own, parts, part.b, for_b, negated, bound)
    };
    if part.op == op {
        let before = *bound;
        if both(a, b, bound) {
            return true;
        }
        *bound = before;
        return op.properties().has(Properties::COMMUTATIVE) && both(b, a, bound);
    }
    match (part.op, op, a, b) {
        (Op::Add, Op::Sub, _, Arg::Number(number)) | (Op::Sub, Op::Add, _, Arg::Number(number)) => {
            both(a, Arg::Number(-number), bound)
        }
        // b - a * c is b + a * -c.
        (Op::Add, Op::Sub, Arg::Value(_), Arg::Value(product)) => {
            let times_number = two(Op::Mul, Reads::A, Reads::C);
            matches!(part.a, Reads::Part(earlier) if parts.get(earlier) == Some(&times_number))
                && fit_operand(own, parts, part.b, a, negated, bound)
                && fit_operand(own, parts, part.a, Arg::Value(product), true, bound)
        }
        _ => false,
    }
}

/// As [`fit`], for one operand.
fn fit_operand(
    own: &impl Fn(u32) -> Option<Operation>,
    parts: &[Part],
    reads: Reads,
    arg: Arg,
    negated: bool,
    bound: &mut Bound,
) -> bool {
    match (reads, arg) {
        (Reads::A, Arg::Value(value)) => *bound.a.get_or_insert(value) == value,
        (Reads::B, Arg::Value(value)) => *bound.b.get_or_insert(value) == value,
        (Reads::C, Arg::Number(number)) => {
            let number = if negated { -number } else { number };
            bound.c.get_or_insert(number).to_bits() == number.to_bits()
        }
        (Reads::QuarterOverC, Arg::Number(number)) => {
            bound.quarter = Some(number);
            true
        }
        (Reads::Always(always), Arg::Number(number)) => always == number,
        (Reads::Part(earlier), Arg::Value(value)) => {
            own(value).is_some_and(|operation| fit(own, parts, earlier, operation, negated, bound))
        }
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Input, Point};
    use super::*;
    use crate::region::{Encoder, Formula, REGISTERS_MAX};

    fn only(compound: Compound) -> Compounds {
        let mut one = Compounds::NONE;
        one.insert(compound);
        one
    }

    fn opcodes(graph: &Graph, root: NodeId, compounds: Compounds) -> Vec<u8> {
        let formula = Formula::new(graph, &[root], Input::OF_POINT.len(), 0);
        let mut encoder = Encoder::new(compounds, REGISTERS_MAX);
        let mut texels = Vec::new();
        formula.tape(&mut encoder).append(&FrameInputs::default(), &mut texels);
        let words = texels.iter().flat_map(|texel| [texel[0], texel[2]]);
        words.map(|word| word as u8).filter(|opcode| *opcode != crate::tape::opcode::END).collect()
    }

    #[test]
    fn every_compound_is_found_and_gives_the_bits_of_its_operators() {
        for &compound in Compound::ALL {
            for c in [0.7, -1.3, 3.0] {
                let mut graph = Graph::new();
                let (x, y) = (graph.input(Input::X), graph.input(Input::Y));
                let root = compound.nodes(&mut graph, x, y, c);
                assert!(Compounds::ALL.covers(only(compound)));
                assert_eq!(opcodes(&graph, root, only(compound)), [compound.number()], "{compound:?}");
                assert_eq!(opcodes(&graph, root, Compounds::ALL), [compound.number()], "{compound:?}");
                assert!(opcodes(&graph, root, Compounds::NONE).len() == compound.operators());
                let frame = FrameInputs::default();
                for [a, b] in [[0.3, -0.8], [-2.5, 0.1], [0.0, 0.0], [1e20, -1e30], [f32::INFINITY, 1.0]] {
                    let wanted = graph.evaluate(&[root], &Point::at(a, b, 0.0), &frame)[0];
                    let found = compound.value(a, b, c, &frame) + 0.0;
                    let same = wanted.to_bits() == found.to_bits() || wanted.is_nan() && found.is_nan();
                    assert!(same, "{compound:?}({a}, {b}, {c}): {found} {wanted}");
                }
            }
        }
    }

    #[test]
    fn a_product_may_be_subtracted_and_a_number_added_either_way() {
        let mut graph = Graph::new();
        let (x, y) = (graph.input(Input::X), graph.input(Input::Y));
        let number = graph.constant(0.75);
        let product = graph.raw(Node::Binary(Op::Mul, x, number));
        let difference = graph.raw(Node::Binary(Op::Sub, y, product));
        assert_eq!(opcodes(&graph, difference, Compounds::ALL), [Compound::MulAdd.number()]);
        let less = graph.raw(Node::Binary(Op::Sub, x, number));
        let least = graph.raw(Node::Binary(Op::Min, y, less));
        assert_eq!(opcodes(&graph, least, Compounds::ALL), [Compound::AddMin.number()]);
    }

    #[test]
    fn shared_values_and_other_numbers_are_not_merged() {
        let mut graph = Graph::new();
        let (x, y) = (graph.input(Input::X), graph.input(Input::Y));
        let number = graph.constant(0.75);
        let product = graph.raw(Node::Binary(Op::Mul, x, number));
        let sum = graph.raw(Node::Binary(Op::Add, product, y));
        let both = graph.raw(Node::Binary(Op::Min, sum, product));
        assert_eq!(opcodes(&graph, both, Compounds::ALL).len(), 3);
        let low = graph.raw(Node::Binary(Op::Max, x, number));
        let one = graph.constant(1.0);
        let clamped = graph.raw(Node::Binary(Op::Min, low, one));
        assert_eq!(opcodes(&graph, clamped, Compounds::ALL).len(), 2);
    }

    #[test]
    fn a_compound_must_save_one_clause_in_forty() {
        let count = |operators: usize| {
            Compounds::that_pay(|compounds| {
                let mut uses = Uses::default();
                for _ in 0..operators - 2 {
                    uses.add(None);
                }
                uses.add(compounds.iter().find(|compound| *compound == Compound::MulAdd));
                uses
            })
        };
        assert_eq!((count(40), count(41)), (only(Compound::MulAdd), Compounds::NONE));
    }
}
