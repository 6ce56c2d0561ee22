//! Tests that the bounds of slopes hold every slope, operator by operator.

use proptest::prelude::*;

use super::testing::{SPECIALS, frame, number};
use super::*;

fn config() -> ProptestConfig {
    let cases = ProptestConfig::default().cases.max(4_000);
    ProptestConfig { cases, failure_persistence: None, ..ProptestConfig::default() }
}

fn check(op: Op, a: Interval, b: Interval, points: &[(f32, f32)]) -> Result<(), String> {
    check_in(&frame(), op, a, b, points)
}

fn check_in(
    frame: &FrameInputs,
    op: Op,
    a: Interval,
    b: Interval,
    points: &[(f32, f32)],
) -> Result<(), String> {
    let (by_a, by_b) = op.slope_bounds(a, b, op.bounds(a, b, frame), frame);
    for &(x, y) in points {
        let slopes = op.slopes(x, y, op.value(x, y, frame), frame);
        if !by_a.contains(slopes.0) || (op.arity() == 2 && !by_b.contains(slopes.1)) {
            let name = op.name();
            return Err(format!(
                "{name} at {x:?}, {y:?} of {a:?}, {b:?}: {slopes:?} not in {by_a:?}, {by_b:?}"
            ));
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn bounds_hold_every_slope(
        number_of_op in any::<u8>(), a in [number(), number()], b in [number(), number()],
        along in proptest::array::uniform8((0.0f32..=1.0, 0.0f32..=1.0)),
    ) {
        let op = Op::ALL[usize::from(number_of_op) % Op::ALL.len()];
        let interval = |[p, q]: [f32; 2]| Interval::new(p.min(q), p.max(q));
        let (a, b) = (interval(a), interval(b));
        if a.is_any() || b.is_any() {
            return Ok(());
        }
        let inside = |i: Interval, t: f32| {
            if t < 0.1 { i.lo } else if t > 0.9 { i.hi } else if i.contains(0.0) && t < 0.2 { 0.0 }
            else { (i.lo * (1.0 - t) + i.hi * t).clamp(i.lo, i.hi) }
        };
        let points = along.map(|(s, t)| (inside(a, s), inside(b, t)));
        let points: Vec<_> = points.into_iter().filter(|(x, y)| !x.is_nan() && !y.is_nan()).collect();
        prop_assert_eq!(check(op, a, b, &points), Ok(()));
    }
}

#[test]
fn bounds_hold_slopes_at_specials() {
    let pairs = |lo: f32| SPECIALS.into_iter().map(move |hi| Interval::new(lo, hi));
    let intervals: Vec<Interval> =
        SPECIALS.into_iter().flat_map(pairs).filter(|interval| !interval.is_any()).collect();
    for &op in Op::ALL {
        for (count, &a) in intervals.iter().enumerate() {
            // One-operand operators ignore b. For two operands, try every seventh b, with a different start each time.
            let step = if op.arity() == 1 { intervals.len() } else { 7 };
            for &b in intervals.iter().skip(count % 7).step_by(step) {
                let within = |i: Interval| SPECIALS.into_iter().filter(move |&v| i.contains(v));
                let points: Vec<_> = within(a).flat_map(|x| within(b).map(move |y| (x, y))).collect();
                check(op, a, b, &points).unwrap();
            }
        }
    }
}

#[test]
fn bounds_hold_slopes_at_operands_that_are_no_numbers() {
    let values = || SPECIALS.into_iter().chain([f32::NAN]);
    for &op in Op::ALL {
        for number in values() {
            let (any, number) = (Interval::ANY, Interval::point(number));
            let all: Vec<_> = values().flat_map(|x| values().map(move |y| (x, y))).collect();
            let along = |a: bool| values().map(move |v| if a { (v, number.lo) } else { (number.lo, v) });
            check(op, any, any, &all).unwrap();
            check(op, any, number, &along(true).collect::<Vec<_>>()).unwrap();
            check(op, number, any, &along(false).collect::<Vec<_>>()).unwrap();
        }
    }
}

/// Checks every second one-operand operator, from operator `first` on, in many short intervals.
fn sweep(first: usize) {
    let sweep: Vec<f32> = (0..=u32::MAX).step_by(8_191).map(f32::from_bits).filter(|v| !v.is_nan()).collect();
    let frame = frame();
    let mut points = Vec::with_capacity(3);
    for &op in Op::ALL.iter().filter(|op| op.arity() == 1).skip(first).step_by(2) {
        for three in sweep.windows(3) {
            let (lo, hi) = (three[0].min(three[2]), three[0].max(three[2]));
            points.clear();
            points.extend(three.iter().filter(|v| (lo..=hi).contains(*v)).map(|v| (*v, 0.0)));
            check_in(&frame, op, Interval::new(lo, hi), Interval::point(0.0), &points).unwrap();
        }
    }
}

// Two tests, so that they run in parallel: a single test would take longer than all other tests together.
#[test]
fn bounds_hold_slopes_densely_for_one_operand() {
    sweep(0);
}

#[test]
fn bounds_hold_slopes_densely_for_every_other_operator() {
    sweep(1);
}

#[test]
fn bounds_of_slopes_are_close() {
    let frame = frame();
    // Skip tables: their slope may be constant on one piece, or 0 beyond the ends.
    for &op in Op::ALL.iter().filter(|op| !op.properties().has(Properties::READS_FRAME)) {
        for (x, y) in [(0.3f32, 0.7f32), (0.61, 1.7), (0.23, 2.3), (-0.4, 0.6)] {
            let around = |v: f32| Interval::new(v - 1e-3, v + 1e-3);
            let (a, b) = (around(x), around(y));
            let bounds = op.slope_bounds(a, b, op.bounds(a, b, &frame), &frame);
            for bounds in [bounds.0, bounds.1] {
                assert!(bounds.hi - bounds.lo < 0.1, "{op:?} at {x}, {y}: {bounds:?}");
            }
        }
    }
}
