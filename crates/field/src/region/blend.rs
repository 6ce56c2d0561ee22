//! Tight bounds of smooth minima, such as `smooth_union` of the library:
//! min(a, b) - q * max(k - |a - b|, 0)².
//!
//! Interval arithmetic takes the minimum and the rest for independent, so each member of a chain of smooth minima would
//! lower the lower bound by up to k/4, and the members of a long chain would overlap everywhere. But a smooth minimum
//! grows with a and with b if 2·q·k <= 1. The bounds of a and b thus give those of the result. With them, |a - b| more
//! often exceeds k everywhere in a cell. Then the rest is exactly 0, and the result is exactly one of the operands.

use super::lanes::{CELLS, Lanes};
use super::program::{Form, Program, Step};
use crate::graph::Op;

/// The values and the bounds at the ends are rounded six times each, by 2⁻²⁴ of at most |a|, |b| or k.
const ROUNDING: f32 = 1.0 / (1 << 20) as f32;
/// For narrower blends, the square of the width may underflow.
const WIDTH_MIN: f32 = 1e-12;

/// A smooth minimum of two values, or its negative.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SmoothMin {
    a: u32,
    b: u32,
    /// The width k: beyond this difference there is no blend.
    width: f32,
    /// The factor q.
    factor: f32,
    negated: bool,
}

impl SmoothMin {
    /// Returns the smooth minimum that ends with `step`.
    #[inline]
    pub(super) fn of(program: &Program, step: &Step) -> Option<Self> {
        if (step.op, step.form) != (Op::Sub, Form::Values) {
            return None;
        }
        let is_min =
            |value: u32| program.step(value).filter(|step| (step.op, step.form) == (Op::Min, Form::Values));
        let (least, rest, negated) = match (is_min(step.a), is_min(step.b)) {
            (Some(least), _) => (least, step.b, false),
            (_, Some(least)) => (least, step.a, true),
            _ => return None,
        };
        let product =
            program.step(rest).filter(|step| (step.op, step.form) == (Op::Mul, Form::NumberRight))?;
        let inside = program.step(outside_square(program, product.a)?)?;
        let width = inside.number;
        if (inside.op, inside.form) != (Op::Sub, Form::NumberLeft) {
            return None;
        }
        let (a, b) = (least.a, least.b);
        if !is_difference(program, inside.b, (a, b)) {
            return None;
        }
        let factor = product.number;
        let grows = width >= WIDTH_MIN && factor >= 0.0 && 2.0 * factor * width <= 1.0;
        grows.then_some(Self { a, b, width, factor, negated })
    }

    /// Narrows the bounds of the smooth minimum. `rows` are the bounds of the values before it.
    #[inline(always)]
    pub(super) fn narrow(&self, rows: &[Lanes], result: &mut Lanes) {
        let (a, b) = (&rows[self.a as usize], &rows[self.b as usize]);
        for cell in 0..CELLS {
            let (low, high) = (self.value(a.lo[cell], b.lo[cell]), self.value(a.hi[cell], b.hi[cell]));
            // A NaN or an infinity here leaves the bounds as they are.
            let size = a.lo[cell].abs() + a.hi[cell].abs() + b.lo[cell].abs() + b.hi[cell].abs() + self.width;
            let (low, high) = (low - ROUNDING * size, high + ROUNDING * size);
            let (low, high) = if self.negated { (-high, -low) } else { (low, high) };
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

/// If a value is max(x, 0)², returns x.
fn outside_square(program: &Program, value: u32) -> Option<u32> {
    let is_outside = |step: &Step, op: Op| (step.op, step.form, step.number) == (op, Form::NumberRight, 0.0);
    let step = program.step(value)?;
    match step.op {
        Op::Square => Some(program.step(step.a).filter(|step| is_outside(step, Op::Max))?.a),
        _ => is_outside(&step, Op::OutsideAdd).then_some(step.a),
    }
}

/// True if a value is |a - b|, perhaps written as |(-b) - (-a)| or as |a + (-b)|.
fn is_difference(program: &Program, value: u32, (a, b): (u32, u32)) -> bool {
    let Some(step) = program.step(value) else { return false };
    let inner = if step.op == Op::Abs { program.step(step.a) } else { Some(step) };
    let Some(inner) = inner.filter(|inner| inner.form == Form::Values) else { return false };
    let is_pair = |a: u32, b: u32| (a, b) == (inner.a, inner.b) || (b, a) == (inner.a, inner.b);
    let minus = |value: u32| negative(program, value);
    match (step.op, inner.op) {
        (Op::Abs, Op::Sub) | (Op::AbsDifference, _) => {
            is_pair(a, b) || minus(a).zip(minus(b)).is_some_and(|(a, b)| is_pair(a, b))
        }
        (Op::Abs, Op::Add) => {
            minus(a).is_some_and(|a| is_pair(a, b)) || minus(b).is_some_and(|b| is_pair(a, b))
        }
        _ => false,
    }
}

/// If a value is -x, returns x.
fn negative(program: &Program, value: u32) -> Option<u32> {
    let step = program.step(value)?;
    let is_zero = step.form == Form::NumberLeft && step.number == 0.0;
    (step.op == Op::Neg || step.op == Op::Sub && is_zero).then_some(step.b)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::lanes::bound;
    use super::super::program::Arg;
    use super::super::tests::{assert_regions_are_right, inputs_of};
    use super::super::tree::{Block, bound_cells, cells_of, place_in};
    use super::super::{Numbers, RegionPlan};
    use super::*;
    use crate::graph::{FrameInputs, Interval, Point};
    use crate::world::World;
    use crate::world::testing::world_of;

    const KINDS: [&str; 8] = [
        "smooth_union(first(p), second(p), third(p), WIDTH)",
        "smooth_subtract(first(p), second(p), third(p), WIDTH)",
        "smooth_intersect(first(p), second(p), third(p), WIDTH)",
        "smooth_union(smooth_subtract(first(p), second(p), WIDTH), smooth_intersect(third(p), second(p), 0.3), WIDTH)",
        "smooth_union(repeat_limited(p, 1.1, vec3(2)).x, smooth_union(p.y, third(p), WIDTH), WIDTH)",
        // Other smooth minima that scenes use.
        "-log(exp(-first(p) / WIDTH) + exp(-second(p) / WIDTH) + exp(-third(p) / WIDTH)) * WIDTH",
        "-log2(exp2(-12 * third(p)) + exp2(-12 * second(p)) - 0.7 * exp2(-first(p) / WIDTH)) / 12",
        "0.2 - exp(-first(p)^2 / WIDTH) - exp(-second(p)^2 / WIDTH)",
    ];

    fn world(kind: &str, width: f32, size: f32) -> World {
        world_of(&format!(
            "fn first(p) = sphere(p - vec3(0.4, 0, 0), 0.9)\n\
             fn second(p) = box(rotate_y(p, 0.4) + vec3(0.7, 0.3, 0), vec3(0.5))\n\
             fn third(p) = torus(p - vec3(0, 0.6, 0.5), 0.7, 0.2)\n\
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
        for (kind, count) in KINDS.into_iter().zip([2, 2, 2, 3, 2, 0, 0, 0]) {
            let plan = RegionPlan::new(&world(kind, 0.5, 1.0));
            let inputs = FrameInputs::default();
            let program = plan.folded(&Numbers::Of(&inputs), &inputs);
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
            let program = RegionPlan::new(&world).folded(&Numbers::Of(&inputs), &inputs);
            let block = Block { low, cell: [side; 3] };
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
                    let whole = world.graph.evaluate(&world.roots.distance, &Point::at(x, y, z), &inputs).unwrap();
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
