//! Tests that bounds of gradients contain the gradients and limit the change between points.

use proptest::prelude::*;

use super::testing::GradientIntervals;
use super::*;
use crate::graph::testing::{Step, build, frame, number, same, steps};
use crate::graph::{GradientInterval, Interval, Op};

fn config(cases: u32) -> ProptestConfig {
    let cases = ProptestConfig::default().cases.max(cases);
    ProptestConfig { cases, failure_persistence: None, ..ProptestConfig::default() }
}

const CONTINUOUS: [Op; 22] = [
    Op::Neg,
    Op::Abs,
    Op::Square,
    Op::Square,
    Op::Sqrt,
    Op::Sqrt,
    Op::Exp,
    Op::Exp2,
    Op::Log,
    Op::Sin,
    Op::Cos,
    Op::Asin,
    Op::Acos,
    Op::Atan,
    Op::Tanh,
    Op::Add,
    Op::Add,
    Op::Sub,
    Op::Mul,
    Op::Min,
    Op::Max,
    Op::Spectrum,
];

fn continuous_steps(size: usize) -> impl Strategy<Value = Vec<Step>> {
    let number = |op: Op| Op::ALL.iter().position(|other| *other == op).unwrap_or(0) as u8;
    let step = prop_oneof![
        2 => (-3.0f32..3.0).prop_map(Step::Constant),
        4 => any::<u8>().prop_map(Step::Input),
        12 => (proptest::sample::select(&CONTINUOUS[..]), 0u16..6, 0u16..6)
            .prop_map(move |(op, a, b)| Step::Operator(number(op), a, b)),
    ];
    proptest::collection::vec(step, 1..size)
}

type Places = ([(f32, f32); 3], Vec<[f32; 3]>);

fn places() -> impl Strategy<Value = Places> {
    let side = || (-3.0f32..3.0, prop_oneof![Just(0.0f32), 0.0f32..0.1, 0.0f32..4.0]);
    let whole = || (-3i8..3, 0i8..3).prop_map(|(low, size)| (f32::from(low), f32::from(size)));
    let sides = proptest::array::uniform3(prop_oneof![4 => side(), 1 => whole()]);
    (sides, proptest::collection::vec(proptest::array::uniform3(0.0f32..=1.0), 8))
}

impl GradientInterval {
    fn change(&self, way: [f64; 3]) -> (f64, f64) {
        let mut change = (0.0, 0.0);
        for (slope, way) in self.gradient.iter().zip(way) {
            let (a, b) = (f64::from(slope.lo) * way, f64::from(slope.hi) * way);
            if way != 0.0 {
                change = (change.0 + a.min(b), change.1 + a.max(b));
            }
        }
        change
    }
}

fn bounds_over(tape: &Tape, frame: &FrameInputs, sides: [(f32, f32); 3]) -> GradientInterval {
    let box_of = sides.map(|(low, size)| Interval::new(low, low + size));
    GradientIntervals::new(tape, frame).over(box_of, [Interval::point(0.0); 3])[0]
}

fn tape_of(steps: &[Step]) -> Tape {
    let mut graph = Graph::new();
    let root = *build(&mut graph, steps, true).last().unwrap();
    Tape::new(&graph, &[root])
}

fn precise(tape: &Tape, frame: &FrameInputs, at: [f64; 3]) -> f64 {
    let table = tape.table_values(frame);
    let value = |registers: &[f64], operand| match operand {
        Operand::Register(register) => registers[register as usize],
        Operand::Immediate(entry) => f64::from(table[entry as usize]),
    };
    let mut registers = vec![0.0f64; tape.registers];
    for Clause { instruction, output, operands } in &tape.clauses {
        let [a, b] = operands.map(|operand| value(&registers, operand));
        registers[*output as usize] = match *instruction {
            Instruction::Input(place) => at.get(usize::from(place)).copied().unwrap_or(0.0),
            Instruction::Texture { .. } => continue,
            Instruction::Operator(op) => match op {
                Op::Neg => -a,
                Op::Abs => a.abs(),
                Op::Square => a * a,
                Op::Sqrt => a.max(0.0).sqrt(),
                Op::Exp => a.exp(),
                Op::Exp2 => a.exp2(),
                Op::Log => a.max(f64::from(f32::MIN_POSITIVE)).ln(),
                Op::Sin => a.sin(),
                Op::Cos => a.cos(),
                Op::Asin => a.clamp(-1.0, 1.0).asin(),
                Op::Acos => a.clamp(-1.0, 1.0).acos(),
                Op::Atan => a.atan(),
                Op::Tanh => a.tanh(),
                Op::Add => a + b,
                Op::Sub => a - b,
                Op::Mul => a * b,
                Op::Min => a.min(b),
                Op::Max => a.max(b),
                other => f64::from(other.value(a as f32, b as f32, frame)),
            },
        };
    }
    value(&registers, tape.outputs[0])
}

proptest! {
    #![proptest_config(config(2_000))]

    #[test]
    fn gradients_at_many_points_are_those_at_each_bit_for_bit(
        steps in steps(30),
        places in proptest::collection::vec(proptest::array::uniform3(number()), 1..20),
    ) {
        let (tape, frame) = (tape_of(&steps), frame());
        let mut found = Vec::new();
        GradientBatch::new(&tape, &frame).run(&places, &mut found);
        prop_assert_eq!(found.len(), places.len());
        let mut each = GradientBatch::new(&tape, &frame);
        for (place, found) in places.into_iter().zip(found) {
            let wanted = each.at(place);
            prop_assert!(same(wanted.value, found.value), "{wanted:?} {found:?}");
            for (wanted, found) in wanted.gradient.into_iter().zip(found.gradient) {
                prop_assert!(same(wanted + 0.0, found + 0.0), "{wanted:?} {found:?}\n{tape}");
            }
        }
    }

    #[test]
    fn bounds_hold_the_gradient(steps in steps(30), (sides, along) in places()) {
        let (tape, frame) = (tape_of(&steps), frame());
        let bounds = bounds_over(&tape, &frame, sides);
        let mut gradients = GradientBatch::new(&tape, &frame);
        for along in along {
            let at = [0, 1, 2].map(|axis| (sides[axis].0 + along[axis] * sides[axis].1).min(sides[axis].0 + sides[axis].1));
            let found = gradients.at(at);
            prop_assert!(bounds.value.contains(found.value));
            for (bounds, slope) in bounds.gradient.iter().zip(found.gradient) {
                prop_assert!(bounds.contains(slope), "{slope:?} not in {bounds:?} at {at:?} of {sides:?}\n{tape}");
            }
        }
    }

    #[test]
    fn a_value_without_jumps_changes_no_more_than_its_bounds_allow(
        steps in continuous_steps(25), (sides, along) in places(),
    ) {
        let (tape, frame) = (tape_of(&steps), frame());
        let bounds = bounds_over(&tape, &frame, sides);
        let at = |along: [f32; 3]| [0, 1, 2].map(|axis| f64::from(sides[axis].0) + f64::from(along[axis]) * f64::from(sides[axis].1));
        for two in along.windows(2) {
            let (from, to) = (at(two[0]), at(two[1]));
            let (before, after) = (precise(&tape, &frame, from), precise(&tape, &frame, to));
            let (least, most) = bounds.change([0, 1, 2].map(|axis| to[axis] - from[axis]));
            // Allow for rounding: the table holds 32-bit numbers.
            let slack = 1e-5 * (1.0 + before.abs() + after.abs());
            let change = after - before;
            // Bounds are 32-bit numbers, so values beyond their range are not checked.
            let is_held = [before, after, change].iter().all(|value| (*value as f32).is_finite());
            prop_assert!(
                !is_held || least.is_nan() || most.is_nan() || (least - slack <= change && change <= most + slack),
                "{before} {after} is not within {least} {most}: {bounds:?} from {from:?} to {to:?} of {sides:?}\n{tape}"
            );
        }
    }
}

fn shape(make: impl Fn(&mut Graph, [NodeId; 3]) -> NodeId) -> Tape {
    let mut graph = Graph::new();
    let p = [Input::X, Input::Y, Input::Z].map(|input| graph.input(input));
    let root = make(&mut graph, p);
    Tape::new(&graph, &[root])
}

fn assert_within(tape: &Tape, sides: [(f32, f32); 3], low: [f32; 3], high: [f32; 3]) {
    let bounds = bounds_over(tape, &FrameInputs::default(), sides);
    for axis in 0..3 {
        let found = bounds.gradient[axis];
        assert!(found.lo >= low[axis] && found.hi <= high[axis], "{:?}", bounds.gradient);
    }
}

#[test]
fn lengths_have_bounds_through_their_centre() {
    let ball = shape(|g, p| g.length(&p));
    let one = 1.001;
    assert_within(&ball, [(-1.0, 2.0); 3], [-one; 3], [one; 3]);
    assert_within(&ball, [(0.0, 0.0); 3], [-one; 3], [one; 3]);
    // In a small box far from the centre, the gradient hardly varies.
    assert_within(&ball, [(10.0, 0.1), (0.0, 0.1), (0.0, 0.1)], [0.98, -0.02, -0.02], [1.02, 0.02, 0.02]);
    let rounded = shape(|g, p| {
        let (half, zero, small) = (g.constant(0.5), g.constant(0.0), g.constant(0.01));
        let corner = p.map(|v| {
            let (size, outside) = (g.unary(Op::Abs, v), g.constant(0.0));
            let beyond = g.sub(size, half);
            g.max(beyond, outside)
        });
        let sum = g.dot(&corner, &corner);
        let (twice, sum) = (g.add(sum, small), g.max(sum, zero));
        let sum = g.min(sum, twice);
        g.unary(Op::Sqrt, sum)
    });
    assert_within(&rounded, [(-2.0, 4.0); 3], [-one; 3], [one; 3]);
    // The factor 0.25 under the root halves the slope.
    let squeezed = shape(|g, p| {
        let (factor, square) = (g.constant(0.25), g.unary(Op::Square, p[0]));
        let product = g.mul(factor, square);
        g.unary(Op::Sqrt, product)
    });
    assert_within(&squeezed, [(-1.0, 2.0); 3], [-0.501, 0.0, 0.0], [0.501, 0.0, 0.0]);
}

/// The gradient of an undecided minimum is the hull of both operands' gradients, not their sum.
#[test]
fn a_minimum_has_the_slopes_of_one_operand() {
    let two = shape(|g, [x, y, _]| {
        let (a, b) = (g.add(x, y), g.sub(x, y));
        g.min(a, b)
    });
    assert_within(&two, [(0.0, 1.0), (1.0, 1.0), (0.0, 1.0)], [1.0, -1.0, 0.0], [1.0, -1.0, 0.0]);
    assert_within(&two, [(0.0, 1.0), (-1.0, 2.0), (0.0, 1.0)], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0]);
}
