//! Tight bounds of smooth minima, such as `smooth_union` of the library, min(a, b) - q * max(k - |a - b|, 0)², or
//! mix(b, a, h) - k * h * (1 - h) with h = clamp(0.5 + 0.5 * (b - a) / k, 0, 1), which is the same function for
//! q = 0.25 / k (Quilez, Smooth minimum).
//!
//! Interval arithmetic takes the terms for independent, so each member of a chain of smooth minima would lower the
//! lower bound by up to k/4, and the members of a long chain would overlap everywhere. But a smooth minimum grows with
//! a and with b if 2·q·k <= 1. Therefore the bounds of a and b give the bounds of the result. With them, |a - b| more
//! often exceeds k everywhere in a cell. Then the rest is exactly 0, and the result is exactly one of the operands.

use super::lanes::{CELLS, Lanes};
use super::program::{Form, Program, Step};
use crate::graph::Op;

/// A value and the bounds at the ends are together rounded up to sixteen times, by 2⁻²⁴ of at most |a|, |b| or k.
const ROUNDING: f32 = 1.0 / (1 << 20) as f32;
/// For narrower blends, the square of the width may underflow.
const WIDTH_MIN: f32 = 1e-12;
/// The same width, after a few roundings.
const SAME: f64 = 1e-6;

/// A smooth minimum of two values. If `negated`, it is the negative of one. If `of_negatives`, it reads -a and -b: a
/// smooth maximum is `negated` and `of_negatives`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SmoothMin {
    a: u32,
    b: u32,
    /// The width k: beyond this difference there is no blend.
    width: f32,
    /// The factor q.
    factor: f32,
    negated: bool,
    of_negatives: bool,
}

impl SmoothMin {
    /// Returns the smooth minimum that ends with `step`.
    #[inline(always)]
    pub(super) fn of(program: &Program, step: &Step) -> Option<Self> {
        // Most sums are no smooth minima. This check rejects them quickly.
        let is_end = |value: u32| matches!(program.op(value), Some(Op::Min | Op::Max | Op::Add));
        let is_rest = |value: u32| matches!(program.op(value), Some(Op::Mul | Op::Square | Op::OutsideAdd));
        let may_be = matches!(step.op, Op::Sub | Op::Add)
            && (is_rest(step.b) && is_end(step.a) || is_rest(step.a) && is_end(step.b));
        if may_be { Self::found(program, step) } else { None }
    }

    #[inline(never)]
    fn found(program: &Program, step: &Step) -> Option<Self> {
        let of_negatives = match (step.op, step.form) {
            (Op::Sub, Form::Values) => false,
            (Op::Add, Form::Values) => true,
            _ => return None,
        };
        let found = [(step.a, step.b, of_negatives), (step.b, step.a, true)].into_iter().find_map(
            |(first, rest, negated)| {
                let ends = program.step(first).filter(|first| first.form == Form::Values)?;
                let (a, b, width, factor) = match ends.op {
                    Op::Min if !of_negatives => squared(program, ends, rest)?,
                    Op::Max if of_negatives => squared(program, ends, rest)?,
                    Op::Add => mixed(program, ends, rest, of_negatives)?,
                    _ => return None,
                };
                let (width, factor) = (width as f32, factor as f32);
                Some(Self { a, b, width, factor, negated, of_negatives })
            },
        )?;
        let grows =
            found.width >= WIDTH_MIN && found.factor >= 0.0 && 2.0 * found.factor * found.width <= 1.0;
        grows.then_some(found)
    }

    /// Narrows the bounds of the smooth minimum. `rows` are the bounds of the values before it.
    #[inline(always)]
    pub(super) fn narrow(&self, rows: &[Lanes], result: &mut Lanes) {
        let (a, b) = (&rows[self.a as usize], &rows[self.b as usize]);
        let flipped = |flips: bool, low: f32, high: f32| if flips { (-high, -low) } else { (low, high) };
        for cell in 0..CELLS {
            let (a_low, a_high) = flipped(self.of_negatives, a.lo[cell], a.hi[cell]);
            let (b_low, b_high) = flipped(self.of_negatives, b.lo[cell], b.hi[cell]);
            // A NaN or an infinity here does not change the bounds.
            let size = a_low.abs() + a_high.abs() + b_low.abs() + b_high.abs() + self.width;
            let low = self.value(a_low, b_low) - ROUNDING * size;
            let high = self.value(a_high, b_high) + ROUNDING * size;
            let (low, high) = flipped(self.negated, low, high);
            result.lo[cell] = if low > result.lo[cell] { low } else { result.lo[cell] };
            result.hi[cell] = if high < result.hi[cell] { high } else { result.hi[cell] };
        }
    }

    #[inline(always)]
    fn value(&self, a: f32, b: f32) -> f32 {
        let inside = (self.width - (a - b).abs()).max(0.0);
        a.min(b) - inside * inside * self.factor
    }
}

/// If `rest` is q * max(k - |a - b|, 0)² for the operands a and b of `ends`, returns a, b, k and q.
fn squared(program: &Program, ends: Step, rest: u32) -> Option<(u32, u32, f64, f64)> {
    let is_outside = |step: &Step, op: Op| (step.op, step.form, step.number) == (op, Form::NumberRight, 0.0);
    let (square, factor) = scaled(program, rest);
    let step = program.step(square)?;
    let (outside, scale) = match step.op {
        Op::Square => {
            let (outside, scale) = scaled(program, step.a);
            (program.step(outside).filter(|step| is_outside(step, Op::Max))?, scale)
        }
        _ => (Some(step).filter(|step| is_outside(step, Op::OutsideAdd))?, 1.0),
    };
    let inside =
        program.step(outside.a).filter(|step| (step.op, step.form) == (Op::Sub, Form::NumberLeft))?;
    let distance = program.step(inside.b)?;
    let (a, b) = (ends.a, ends.b);
    let between = match distance.op {
        Op::Abs => program.step(distance.a)?,
        Op::AbsDifference => Step { op: Op::Sub, ..distance },
        _ => return None,
    };
    difference(program, between, a, b)?;
    Some((a, b, f64::from(inside.number), factor * scale * scale))
}

/// If `sum` is mix(b, a, h) and `rest` is k * h * (1 - h) for the h of a smooth minimum or maximum, returns a, b, k and
/// q.
fn mixed(program: &Program, sum: Step, rest: u32, is_max: bool) -> Option<(u32, u32, f64, f64)> {
    let product = |value: u32| {
        program
            .step(value)
            .filter(|step| (step.op, step.form) == (Op::Mul, Form::Values))
            .map(|step| [step.a, step.b])
    };
    let number = |value: u32, op: Op, form: Form, number: f32| {
        program.step(value).filter(|step| (step.op, step.form, step.number) == (op, form, number))
    };
    let (product_rest, mut width) = scaled(program, rest);
    let [first, second] = product(product_rest)?.map(|value| scaled(program, value));
    width *= first.1 * second.1;
    let is_complement =
        |value: u32, of: u32| number(value, Op::Sub, Form::NumberLeft, 1.0).is_some_and(|step| step.b == of);
    let (fraction, complement) = match (first.0, second.0) {
        (h, c) if is_complement(c, h) => (h, c),
        (c, h) if is_complement(c, h) => (h, c),
        _ => return None,
    };
    let (one, two) = (product(sum.a)?, product(sum.b)?);
    let other = |[a, b]: [u32; 2], known: u32| if a == known { Some(b) } else { (b == known).then_some(a) };
    let pair = |a: [u32; 2], b: [u32; 2]| other(a, fraction).zip(other(b, complement));
    let (a, b) = pair(one, two).or_else(|| pair(two, one))?;
    let above = number(fraction, Op::Min, Form::NumberRight, 1.0)?.a;
    let fraction = number(above, Op::Max, Form::NumberRight, 0.0)?.a;
    let (slope, sign) = match number(fraction, Op::Add, Form::NumberRight, 0.5) {
        Some(step) => (step.a, 1.0),
        None => (number(fraction, Op::Sub, Form::NumberLeft, 0.5)?.b, -1.0),
    };
    let (away, slope) = scaled(program, slope);
    let grows = sign * slope * difference(program, program.step(away)?, b, a)?;
    let wanted = if is_max { -0.5 } else { 0.5 };
    ((grows * width - wanted).abs() < SAME).then_some((a, b, width, 0.25 / width))
}

/// Returns a value without the numbers by which it is multiplied or divided, and their product.
fn scaled(program: &Program, mut value: u32) -> (u32, f64) {
    let mut factor = 1.0;
    while let Some(step) = program.step(value).filter(|step| step.form == Form::NumberRight) {
        match step.op {
            Op::Mul => factor *= f64::from(step.number),
            Op::Div => factor /= f64::from(step.number),
            _ => break,
        }
        value = step.a;
    }
    (value, factor)
}

/// Returns 1 if a step is a - b, and -1 if it is b - a. Either may be written with negatives, such as a + (-b).
fn difference(program: &Program, step: Step, a: u32, b: u32) -> Option<f64> {
    let opposite = |x: u32, y: u32| is_negative(program, x, y) || is_negative(program, y, x);
    let (u, v) = (step.a, step.b);
    let is = |a: u32, b: u32| match step.op {
        Op::Sub => (u, v) == (a, b) || opposite(u, b) && opposite(v, a),
        Op::Add => u == a && opposite(v, b) || v == a && opposite(u, b),
        _ => false,
    };
    match step.form {
        Form::Values if is(a, b) => Some(1.0),
        Form::Values if is(b, a) => Some(-1.0),
        _ => None,
    }
}

/// True if x is written as the negative of y.
fn is_negative(program: &Program, x: u32, y: u32) -> bool {
    let Some(step) = program.step(x) else { return false };
    let swapped = |of: Step| match (step.form, of.form) {
        (Form::Values, Form::Values) => (step.a, step.b) == (of.b, of.a),
        (Form::NumberLeft, Form::NumberRight) => (step.b, step.number) == (of.a, of.number),
        _ => false,
    };
    match (step.op, step.form) {
        (Op::Neg, _) => step.a == y,
        (Op::Sub, Form::NumberLeft) if step.number == 0.0 && step.b == y => true,
        (Op::Sub, _) => program.step(y).is_some_and(|of| of.op == Op::Sub && swapped(of)),
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::RegionPlan;
    use super::super::lanes::{bound, cells_of};
    use super::super::program::Arg;
    use super::super::tests::{assert_regions_are_right, inputs_of};
    use super::super::tree::{Brick, bound_cells, place_in};
    use super::*;
    use crate::graph::{FrameInputs, Interval, Point};
    use crate::world::World;
    use crate::world::testing::world_of;

    const KINDS: [&str; 12] = [
        "smooth_union(first(p), second(p), third(p), WIDTH)",
        "smooth_subtract(first(p), second(p), third(p), WIDTH)",
        "smooth_intersect(first(p), second(p), third(p), WIDTH)",
        "smooth_union(smooth_subtract(first(p), second(p), WIDTH), smooth_intersect(third(p), second(p), 0.3), WIDTH)",
        "smooth_union(repeat_limited(p, 1.1, vec3(2)).x, smooth_union(p.y, third(p), WIDTH), WIDTH)",
        // The formulas of the source, as they are pasted.
        "mixed(mixed(first(p), second(p), WIDTH), third(p), WIDTH)",
        "carved(carved(first(p), second(p), WIDTH), third(p), WIDTH)",
        "shared(shared(first(p), second(p), WIDTH), third(p), WIDTH)",
        "divided(divided(first(p), second(p), WIDTH), third(p), 4 * WIDTH)",
        // Other smooth minima that scenes use.
        "-log(exp(-first(p) / WIDTH) + exp(-second(p) / WIDTH) + exp(-third(p) / WIDTH)) * WIDTH",
        "-log2(exp2(-12 * third(p)) + exp2(-12 * second(p)) - 0.7 * exp2(-first(p) / WIDTH)) / 12",
        "0.2 - exp(-first(p)^2 / WIDTH) - exp(-second(p)^2 / WIDTH)",
    ];

    const PASTED: &str = "
        fn mixed(a, b, k) {
          let h = clamp(0.5 + 0.5 * (b - a) / k, 0, 1)
          mix(b, a, h) - k * h * (1 - h)
        }
        fn carved(a, b, k) {
          let h = clamp(0.5 - 0.5 * (a + b) / k, 0, 1)
          mix(a, -b, h) + k * h * (1 - h)
        }
        fn shared(a, b, k) {
          let h = clamp(0.5 - 0.5 * (b - a) / k, 0, 1)
          mix(b, a, h) + k * h * (1 - h)
        }
        fn divided(a, b, k) {
          let h = max(k - abs(a - b), 0) / k
          max(a, b) + h * h * k * (1 / 4)
        }";

    fn world(kind: &str, width: f32, size: f32) -> World {
        world_of(&format!(
            "fn first(p) = sphere(p - vec3(0.4, 0, 0), 0.9)\n\
             fn second(p) = box(rotate_y(p, 0.4) + vec3(0.7, 0.3, 0), vec3(0.5))\n\
             fn third(p) = torus(p - vec3(0, 0.6, 0.5), 0.7, 0.2)\n\
             {PASTED}
             fn scene(p) = {}\n\
             object all {{ shape = max(scene(p / {size:?}) * {size:?}, length(p) - {:?}) }}",
            kind.replace("WIDTH", &format!("{width:?}")),
            3.0 * size,
        ))
    }

    fn blends(program: &Program) -> Vec<SmoothMin> {
        program.steps.iter().filter_map(|step| SmoothMin::of(program, step)).collect()
    }

    #[test]
    fn the_blends_of_the_library_are_recognized() {
        for (kind, count) in KINDS.into_iter().zip([2, 2, 2, 3, 2, 2, 2, 2, 2, 0, 0, 0]) {
            let plan = RegionPlan::new(&world(kind, 0.5, 1.0));
            let inputs = FrameInputs::default();
            let program = plan.formula.folded(Some(&inputs));
            assert_eq!(blends(&program).len(), count, "{kind}");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(96))]
        #[test]
        fn bounds_of_blends_contain_their_values(
            kind in prop::sample::select(&KINDS[..]),
            width in (-9.0f32..3.0).prop_map(f32::exp),
            low in prop::array::uniform3(-3.0f32..3.0),
            side in (-12.0f32..1.0).prop_map(f32::exp),
        ) {
            let world = world(kind, width, 1.0);
            let inputs = inputs_of(&world, 1.0, 0.5);
            let program = RegionPlan::new(&world).formula.folded(Some(&inputs));
            let block = Brick { low, cell: [side; 3] };
            let mut rows = Vec::new();
            bound_cells(&program, block, 0.0, &mut rows, &inputs);
            let mut exact = rows.clone();
            for cell in cells_of(u64::MAX).step_by(5) {
                for along in [[0.0, 0.0, 1.0], [0.3, 0.9, 0.5], [1.0, 1.0, 0.0]] {
                    for axis in 0..3 {
                        let at = low[axis] + side * (place_in(cell)[axis] as f32 + along[axis]);
                        let Interval { lo, hi } = rows[axis].at(cell);
                        exact[axis] = Lanes::splat(Interval::point(at.clamp(lo, hi)));
                    }

                    let [x, y, z] = [0, 1, 2].map(|axis: usize| exact[axis].lo[0]);
                    bound(&program, &mut exact, &inputs);
                    let whole = world.graph.evaluate(&world.roots.distance, &Point::at(x, y, z), &inputs);
                    let Arg::Value(root) = program.roots[0] else { continue };
                    prop_assert!(exact[root as usize].at(0).contains(whole[0]), "{whole:?} at {x} {y} {z}");
                    for value in program.inputs..program.values() {
                        let (wide, point) = (rows[value].at(cell), exact[value].at(0));
                        prop_assert!(wide.lo <= point.hi && point.lo <= wide.hi, "{wide:?} {point:?} {value}");
                    }
                }
            }
        }

        #[test]
        fn blends_of_any_width_are_the_same_in_every_cell(
            kind in prop::sample::select(&KINDS[..]),
            width in (-9.0f32..3.0).prop_map(f32::exp),
            size in (-3.0f32..3.0).prop_map(f32::exp),
        ) {
            let world = world(kind, width, size);
            assert_regions_are_right(&world, &inputs_of(&world, 1.0, 0.5), 2_000);
        }
    }
}
