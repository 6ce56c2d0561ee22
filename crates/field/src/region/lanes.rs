//! Interval arithmetic for 64 cells at once.

use multiversion::multiversion;

use super::blend::SmoothMin;
use super::program::{Arg, Form, Program};
use crate::graph::{self, FrameInputs, Interval};

/// Number of cells that are processed at once: all children of one cell.
pub(super) const CELLS: usize = 64;

/// An interval for each cell, stored as two arrays so that the CPU can process several cells at once.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
pub(super) struct Lanes {
    pub(super) lo: [f32; CELLS],
    pub(super) hi: [f32; CELLS],
}

impl Lanes {
    pub(super) const fn splat(interval: Interval) -> Self {
        Self { lo: [interval.lo; CELLS], hi: [interval.hi; CELLS] }
    }

    #[inline(always)]
    pub(super) fn at(&self, cell: usize) -> Interval {
        Interval { lo: self.lo[cell], hi: self.hi[cell] }
    }
}

/// Returns a mask of the cells that meet a condition, computed so that the CPU can process eight at once.
#[inline(always)]
pub(crate) fn mask(holds: impl Fn(usize) -> bool) -> u64 {
    let mut flags = [0u8; CELLS];
    for (cell, flag) in flags.iter_mut().enumerate() {
        *flag = u8::from(holds(cell));
    }
    let mut bits = 0;
    for (byte, eight) in flags.as_chunks::<8>().0.iter().enumerate() {
        // Eight bytes of 0 or 1 become eight bits: bit 8i is moved to bit 56 + i.
        let gathered = u64::from_le_bytes(*eight).wrapping_mul(0x0102_0408_1020_4080) >> 56;
        bits |= gathered << (8 * byte);
    }
    bits
}

trait Operand: Copy {
    fn at(&self, cell: usize) -> Interval;
}

impl Operand for &Lanes {
    #[inline(always)]
    fn at(&self, cell: usize) -> Interval {
        Lanes::at(self, cell)
    }
}

impl Operand for Interval {
    #[inline(always)]
    fn at(&self, _: usize) -> Interval {
        *self
    }
}

struct Kernel<'a, A, B> {
    a: A,
    b: B,
    result: &'a mut Lanes,
    frame: &'a FrameInputs,
}

impl<A: Operand, B: Operand> graph::Kernel<Interval> for Kernel<'_, A, B> {
    #[inline(always)]
    fn run(&mut self, rule: impl Fn(Interval, Interval, &FrameInputs) -> Interval + Copy) {
        let result = &mut *self.result;
        for cell in 0..CELLS {
            let interval = rule(self.a.at(cell), self.b.at(cell), self.frame);
            result.lo[cell] = interval.lo;
            result.hi[cell] = interval.hi;
        }
    }
}

/// Computes the bounds of all values of a program in 64 cells. `rows` begins with the bounds of the inputs.
pub(super) fn bound(program: &Program, rows: &mut Vec<Lanes>, frame: &FrameInputs) {
    if rows.len() < program.values() {
        rows.resize(program.values(), Lanes::splat(Interval::point(0.0)));
    }
    bound_rows(program, rows, frame);
}

/// Implements [`bound`]. It is also compiled for CPUs with wider vectors, with equal results.
#[multiversion(targets("x86_64+avx+avx2+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2"))]
fn bound_rows(program: &Program, rows: &mut [Lanes], frame: &FrameInputs) {
    for (index, step) in program.steps.iter().enumerate() {
        let (before, from) = rows.split_at_mut(program.inputs + index);
        let Some(result) = from.first_mut() else { return };
        let (a, b) = (&before[step.a as usize], &before[step.b as usize]);
        let number = Interval::point(step.number);
        match step.form {
            Form::Values => step.op.with_bounds(&mut Kernel { a, b, result, frame }),
            Form::NumberRight => step.op.with_bounds(&mut Kernel { a, b: number, result, frame }),
            Form::NumberLeft => step.op.with_bounds(&mut Kernel { a: number, b, result, frame }),
        }
        if let Some(blend) = SmoothMin::of(program, step) {
            blend.narrow(before, result);
        }
    }
}

/// Returns the bounds of a program's root in each cell. `rows` are the bounds of the program's values.
pub(super) fn bounds_of(program: &Program, root: usize, rows: &[Lanes]) -> Lanes {
    match program.roots[root] {
        Arg::Value(value) => rows[value as usize],
        Arg::Number(number) => Lanes::splat(Interval::point(number)),
    }
}

/// The cells of a mask, in ascending order.
pub(crate) fn cells_of(mut mask: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let cell = (mask != 0).then(|| mask.trailing_zeros() as usize)?;
        mask &= mask - 1;
        Some(cell)
    })
}
