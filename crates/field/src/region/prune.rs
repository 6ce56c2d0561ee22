//! Shortens a program for each of 64 cells: decides minima, folds constants, and drops unneeded steps.
//!
//! Decisions are masks of 64 bits, one bit per cell: the cells that need a value, the cells where the value is a
//! number, and the cells where the value equals one of its operands. Cells with the same decisions share a program,
//! which is written once. Keeter, "Massively parallel rendering of complex closed-form implicit surfaces" (2020),
//! section 3, shortens one tape for one cell at a time.

use multiversion::multiversion;

use super::lanes::{Lanes, mask};
use super::program::{Arg, BOUND, ESTIMATE, Form, OBJECT, Program, Step, Structure, refill};
use crate::graph::{FrameInputs, Op};

/// A number of less than this fraction of another one is lost when they are added. The nearest other f32 differs by at
/// least 2⁻²⁴ of a number; half of that would be enough.
const LOST: f32 = 1.0 / (1 << 26) as f32;

#[derive(Debug, Clone, Copy, Default)]
struct Decided {
    live: u64,
    /// Cells in which the value is a constant.
    number: u64,
    left: u64,
    right: u64,
}

#[derive(Debug, Default)]
pub(super) struct ChoiceTrace {
    values: Vec<Decided>,
    inputs: usize,
    /// True to drop decisions that save little and differ between cells, because each decision costs a group of cells.
    /// Tried: dropping decisions that save less than 4, 6 or 8 % of the program. A scene of 11,000 clauses then runs a
    /// third more clauses.
    pub(super) coarse: bool,
    /// The steps that at least one cell needs, last first.
    needed: Vec<u32>,
    settled: Vec<u32>,
}

/// For each value of a program, its counterpart in the shorter program.
#[derive(Debug, Default)]
pub(super) struct Scratch(Vec<Arg>);

/// Returns the cells where all values of an argument are above the cell's number in `ends`.
#[inline(always)]
fn above(rows: &[Lanes], arg: Arg, ends: &[f32; 64]) -> u64 {
    match arg {
        Arg::Value(value) => {
            let lo = &rows[value as usize].lo;
            mask(|cell| lo[cell] > ends[cell])
        }
        Arg::Number(number) => mask(|cell| number > ends[cell]),
    }
}

#[inline(always)]
fn below(rows: &[Lanes], arg: Arg, ends: &[f32; 64]) -> u64 {
    match arg {
        Arg::Value(value) => {
            let hi = &rows[value as usize].hi;
            mask(|cell| hi[cell] < ends[cell])
        }
        Arg::Number(number) => mask(|cell| number < ends[cell]),
    }
}

/// Returns the cells where no value of `a` is above any value of `b`.
#[inline(always)]
fn not_above(rows: &[Lanes], a: Arg, b: Arg) -> u64 {
    match (a, b) {
        (Arg::Value(a), Arg::Value(b)) => {
            let (hi, lo) = (&rows[a as usize].hi, &rows[b as usize].lo);
            mask(|cell| hi[cell] <= lo[cell])
        }
        (Arg::Value(a), Arg::Number(b)) => {
            let hi = &rows[a as usize].hi;
            mask(|cell| hi[cell] <= b)
        }
        (Arg::Number(a), Arg::Value(b)) => {
            let lo = &rows[b as usize].lo;
            mask(|cell| a <= lo[cell])
        }
        (Arg::Number(_), Arg::Number(_)) => 0,
    }
}

#[inline(always)]
fn is_number(rows: &[Lanes], structure: &Structure, arg: Arg, number: f32) -> u64 {
    match arg {
        Arg::Value(value) if structure.may_settle[value as usize] => {
            let row = &rows[value as usize];
            mask(|cell| row.lo[cell] == number && row.hi[cell] == number)
        }
        _ => 0,
    }
}

/// Returns the cells where adding `small` to `large` gives exactly `large`. A sum of exponentials, as in a smooth
/// minimum by logarithms, thus loses the terms of distant shapes.
#[inline(always)]
fn is_lost(rows: &[Lanes], structure: &Structure, small: Arg, large: Arg) -> u64 {
    let Arg::Value(small) = small else { return 0 };
    if !structure.may_vanish[small as usize] {
        return 0;
    }
    let small = &rows[small as usize];
    let size = |cell: usize| small.hi[cell].max(-small.lo[cell]);
    match large {
        Arg::Value(large) => {
            let large = &rows[large as usize];
            mask(|cell| size(cell) < LOST * large.lo[cell].max(-large.hi[cell]))
        }
        Arg::Number(number) => mask(|cell| size(cell) < LOST * number.abs()),
    }
}

impl ChoiceTrace {
    pub(super) fn groups(&self, rows: &[Lanes], cells: &[u64], groups: &mut Vec<u64>) {
        groups.clear();
        groups.extend(cells.iter().copied().filter(|cells| *cells != 0));
        for index in self.settled.iter().rev() {
            let at = self.inputs + *index as usize;
            let Decided { number, left, right, .. } = self.values[at];
            for decided in [left, right] {
                if decided != 0 {
                    split(groups, decided);
                }
            }
            if number != 0 {
                split(groups, number);
                split_by_value(groups, number, &rows[at].lo);
            }
        }
    }

    pub(super) fn shortened(
        &self,
        program: &Program,
        rows: &[Lanes],
        group: u64,
        frame: &FrameInputs,
        Scratch(places): &mut Scratch,
        short: &mut Program,
    ) {
        let cell = (group.trailing_zeros() as usize).min(63);
        let bit = 1u64 << cell;
        (short.inputs, short.in_registers) = (program.inputs, program.in_registers);
        short.steps.clear();
        short.steps.reserve(self.needed.len());
        if places.len() < program.values() {
            places.resize(program.values(), Arg::Number(0.0));
        }
        for (input, moved) in places.iter_mut().enumerate().take(program.inputs) {
            *moved = Arg::Value(input as u32);
        }
        let moved = |args: &[Arg], arg: Arg| match arg {
            Arg::Value(value) => args[value as usize],
            number => number,
        };
        for index in self.needed.iter().rev() {
            let at = program.inputs + *index as usize;
            let Decided { live, number, left, right } = self.values[at];
            if live & bit == 0 {
                continue;
            }
            let step = &program.steps[*index as usize];
            places[at] = if (number | left | right) & bit == 0 {
                match (places[step.a as usize], places[step.b as usize]) {
                    // Most steps stay unchanged. Only a negation (0 - x) may turn into something else.
                    (Arg::Value(a), Arg::Value(b)) if step.op != Op::Sub || step.form != Form::NumberLeft => {
                        short.push_step(Step { a, b, ..*step })
                    }
                    _ => {
                        let (a, b) = (moved(places, step.first()), moved(places, step.second()));
                        short.push_shorter(step.op, a, b, frame)
                    }
                }
            } else if number & bit != 0 {
                Arg::Number(rows[at].lo[cell] + 0.0)
            } else if left & bit != 0 {
                moved(places, step.first())
            } else {
                moved(places, step.second())
            };
        }
        short.roots.clear();
        short.roots.extend(program.roots.iter().map(|root| moved(places, *root)));
    }
}

/// Returns the cells where the value `at` equals the step's operand a, and those where it equals operand b.
// Inlined into the variants of `decide` for wider vectors.
#[inline(always)]
fn chosen(step: &Step, structure: &Structure, rows: &[Lanes], at: usize) -> (u64, u64) {
    let (a, b) = (step.first(), step.second());
    let (mut left, mut right) = (0, 0);
    match step.op {
        Op::Min => {
            let least = &rows[structure.outermost[at] as usize].hi;
            left = not_above(rows, a, b) | above(rows, b, least);
            right = (not_above(rows, b, a) | above(rows, a, least)) & !left;
        }
        Op::Max => {
            let most = &rows[structure.outermost[at] as usize].lo;
            left = not_above(rows, b, a) | below(rows, b, most);
            right = (not_above(rows, a, b) | below(rows, a, most)) & !left;
        }
        Op::OutsideAdd => right = not_above(rows, a, Arg::Number(0.0)),
        Op::Abs => left = not_above(rows, Arg::Number(0.0), a),
        Op::Mask => {
            if let Arg::Value(a) = a {
                let row = &rows[a as usize];
                right = mask(|cell| row.lo[cell] > 0.0 || row.hi[cell] < 0.0);
            }
        }
        Op::Add => {
            left = is_number(rows, structure, b, 0.0);
            left |= is_lost(rows, structure, b, a);
            right = (is_number(rows, structure, a, 0.0) | is_lost(rows, structure, a, b)) & !left;
        }
        Op::Sub => left = is_number(rows, structure, b, 0.0) | is_lost(rows, structure, b, a),
        Op::Mul => {
            left = is_number(rows, structure, b, 1.0);
            right = is_number(rows, structure, a, 1.0) & !left;
        }
        Op::Div => left = is_number(rows, structure, b, 1.0),
        // In the first period, the remainder equals the operand.
        Op::Fract => left = below(rows, a, &[1.0; 64]) & not_above(rows, Arg::Number(0.0), a),
        Op::Mod => {
            // Exclude an infinite period, whose remainder is a NaN.
            if let Arg::Number(period) = b
                && period.is_finite()
            {
                left = below(rows, a, &[period; 64]) & not_above(rows, Arg::Number(0.0), a);
            }
        }
        _ => {}
    }
    (left, right)
}

/// The roots of a distance: the cells `need` need the distance, and the cells `need_object` the object.
pub(super) fn of_distance(need: u64, need_object: u64) -> [(usize, u64); 3] {
    [(BOUND, need), (ESTIMATE, need), (OBJECT, need_object)]
}

/// Decides which steps are needed. Each of `roots` is needed in some cells. `rows` are the bounds of the program's values.
/// Decisions must hold in all cells of a mask in `together`. It is also compiled for CPUs with wider vectors.
///
/// An operand of a minimum is dropped in cells where it is above the upper end of the outermost minimum. There, the
/// operand is never the least, so the minimum keeps its bits.
#[multiversion(targets("x86_64+avx+avx2+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2"))]
pub(super) fn decide(
    decisions: &mut ChoiceTrace,
    program: &Program,
    structure: &Structure,
    rows: &[Lanes],
    roots: &[(usize, u64)],
    together: &[u64],
) {
    refill(&mut decisions.values, program.values(), Decided::default());
    decisions.inputs = program.inputs;
    decisions.needed.clear();
    decisions.settled.clear();
    let coarse = decisions.coarse;
    let values = &mut decisions.values[..];
    for &(root, cells) in roots {
        if let Arg::Value(value) = program.roots[root] {
            values[value as usize].live |= cells;
        }
    }
    for (index, step) in program.steps.iter().enumerate().rev() {
        let at = program.inputs + index;
        let live = values[at].live;
        if live == 0 {
            continue;
        }
        decisions.needed.push(index as u32);
        let number = if structure.may_settle[at] {
            let row = &rows[at];
            mask(|cell| row.lo[cell] == row.hi[cell]) & live
        } else {
            0
        };
        let number = number
            & !together
                .iter()
                .fold(0, |kept, cells| kept | if is_same(number, *cells, &rows[at].lo) { 0 } else { *cells });
        let live = live & !number;
        let (left, right) = chosen(step, structure, rows, at);
        let (mut left, mut right) = (left & live, right & live);
        if coarse {
            // A decision that is the same in all cells adds no group, so keep it even if it saves little.
            if left != live && structure.saves_little(step, step.second()) {
                left = 0;
            }
            if right != live && structure.saves_little(step, step.first()) {
                right = 0;
            }
        }
        for cells in together {
            if left & cells != live & cells {
                left &= !cells;
            }
            if right & cells != live & cells {
                right &= !cells;
            }
        }
        if number | left | right != 0 {
            decisions.settled.push(index as u32);
            values[at] = Decided { number, left, right, ..values[at] };
        }
        // If one argument is a number, the step stores the other argument twice.
        let (by_a, by_b) = match step.form {
            Form::Values => (live & !right, live & !left),
            Form::NumberRight => (live & !right, 0),
            Form::NumberLeft => (0, live & !left),
        };
        values[step.a as usize].live |= by_a;
        values[step.b as usize].live |= by_b;
    }
}

/// True if all of the given cells have the same number, or if none has a number.
fn is_same(number: u64, cells: u64, values: &[f32; 64]) -> bool {
    let some = number & cells;
    if some != cells {
        return some == 0;
    }
    let first = values[(cells.trailing_zeros() as usize).min(63)];
    mask(|cell| values[cell] == first) & cells == cells
}

fn split(groups: &mut Vec<u64>, mask: u64) {
    for index in 0..groups.len() {
        let group = groups[index];
        let inside = group & mask;
        if inside != 0 && inside != group {
            groups[index] = inside;
            groups.push(group & !mask);
        }
    }
}

fn split_by_value(groups: &mut Vec<u64>, inside: u64, values: &[f32; 64]) {
    let first = values[(inside.trailing_zeros() as usize).min(63)];
    if mask(|cell| values[cell] == first) & inside == inside {
        return;
    }
    let mut index = 0;
    while index < groups.len() {
        let group = groups[index];
        if group & inside != 0 {
            let first = values[(group.trailing_zeros() as usize).min(63)];
            let same = mask(|cell| values[cell] == first) & group;
            // Append the cells with other values as a new group, which this loop processes later.
            if same != group {
                groups[index] = same;
                groups.push(group & !same);
            }
        }
        index += 1;
    }
}
