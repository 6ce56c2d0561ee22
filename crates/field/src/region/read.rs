//! Reads a tree on the CPU in the same way as the shaders, for tests and for tracing without a GPU.

use super::encode::Texel;
use super::tree::{PENUMBRA_MAX, Regions};
use super::{BRICK_SIDE, DIVIDED, OBJECT_UNKNOWN, ROOT_GROWTH, ROOT_SIDE, gradient};
use crate::graph::{Compound, FrameInputs, Interval, Op};
use crate::tape::opcode;

/// A cell of the tree.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cell {
    /// A lower bound of the distance in the cell; 0 if the cell may contain a surface.
    pub bound: f32,
    /// First texel of the cell's tape.
    pub tape: u32,
    /// Number of the nearest object; `None` if several may be nearest.
    pub object: Option<u32>,
    /// Bounds of the gradient if the value is not a distance and the cell may contain a surface.
    pub slopes: [Interval; 3],
    /// Lower corner.
    pub low: [f32; 3],
    /// Upper corner.
    pub high: [f32; 3],
}

/// Returns the texels of the tape that begins at a texel; none if it does not end.
pub(super) fn tape_at(texels: &[Texel], first: u32) -> &[Texel] {
    let from = texels.get(first as usize..).unwrap_or(&[]);
    let end = from.iter().position(|texel| texel[2] & 255 == u32::from(opcode::END));
    end.map_or(&[], |end| &from[..=end])
}

/// Number of clauses of a tape. Its end is none, nor is an empty first clause of a texel.
pub(super) fn clauses(tape: &[Texel]) -> usize {
    let words = tape.as_flattened().iter().step_by(2);
    words.filter(|word| *word & 255 != u32::from(opcode::END)).count()
}

impl Regions {
    /// Returns the cell of a point; `None` outside of the tree.
    pub fn cell_at(&self, point: [f32; 3]) -> Option<Cell> {
        let middle: [f32; 3] = std::array::from_fn(|axis| self.low[axis] + 0.5 * self.size[axis]);
        let is_in = |half: [f32; 3]| (0..3).all(|axis| (point[axis] - middle[axis]).abs() < half[axis]);
        let halves = (0..self.roots)
            .map(|root| self.size.map(|size| 0.5 * size * ROOT_GROWTH.pow(root as u32) as f32));
        let (root, half) = halves.enumerate().find(|(_, half)| is_in(*half))?;
        let mut low: [f32; 3] = std::array::from_fn(|axis| middle[axis] - half[axis]);
        let mut side = half.map(|half| half / (ROOT_SIDE / 2) as f32);
        let (mut first, mut cells) = (root * ROOT_SIDE.pow(3), ROOT_SIDE);
        loop {
            let mut texel = 0;
            for axis in (0..3).rev() {
                let place = ((point[axis] - low[axis]) / side[axis]).floor();
                // Clamp, because rounding must not lead out of the cell that was found.
                let place = place.clamp(0.0, (cells - 1) as f32);
                low[axis] += place * side[axis];
                texel = texel * cells + place as usize;
            }
            let [bound, second, z, w] = *self.texels.get(first + texel)?;
            if bound != DIVIDED {
                let object = second >> 24;
                return Some(Cell {
                    bound: f32::from_bits(bound),
                    tape: second & 0xFF_FFFF,
                    object: (object != OBJECT_UNKNOWN).then_some(object),
                    slopes: gradient::unpack([z, w]),
                    low,
                    high: std::array::from_fn(|axis| low[axis] + side[axis]),
                });
            }
            first = second as usize;
            cells = BRICK_SIDE;
            side = side.map(|side| side / BRICK_SIDE as f32);
        }
    }

    /// Runs a tape at `point` with `penumbra`. Returns bound and estimate, or for an object's tape the object twice.
    pub fn run(&self, tape: u32, point: [f32; 3], penumbra: f32, frame: &FrameInputs) -> [f32; 2] {
        let mut registers = [0.0f32; 256];
        registers[..4].copy_from_slice(&[point[0], point[1], point[2], penumbra]);
        run_texels(self.texels.get(tape as usize..).unwrap_or(&[]), &mut registers, &[], frame)
    }

    /// Number of clauses of the tape that begins at a texel.
    pub fn clauses_of(&self, tape: u32) -> u64 {
        clauses(tape_at(&self.texels, tape)) as u64
    }

    /// Returns bound and estimate at `point`, computed by the tape of the point's cell.
    pub fn distance(&self, point: [f32; 3], penumbra: f32, frame: &FrameInputs) -> [f32; 2] {
        let tape = self.cell_at(point).map_or(self.whole_tape, |cell| cell.tape);
        self.run(tape, point, penumbra, frame)
    }

    /// Returns the number of the nearest object at a point.
    pub fn object(&self, point: [f32; 3], frame: &FrameInputs) -> u32 {
        let cell = self.cell_at(point);
        if let Some(object) = cell.and_then(|cell| cell.object) {
            return object;
        }
        let tape = cell.map_or(self.whole_tape, |cell| cell.tape) as usize;
        let object_tape =
            tape.checked_sub(1).and_then(|head| self.texels.get(head)).map_or(0, |head| head[0]);
        self.run(object_tape, point, 0.0, frame)[0] as u32
    }

    /// Returns the clauses of a cell's tape in the order in which they run. Slots 0 to 2 hold the point at the
    /// beginning.
    pub fn listing(&self, cell: &Cell, frame: &FrameInputs) -> Vec<ListedClause> {
        let mut registers = [Interval::point(0.0); 256];
        for (register, (low, high)) in registers.iter_mut().zip(cell.low.iter().zip(&cell.high)) {
            *register = Interval { lo: *low, hi: *high };
        }
        registers[3] = Interval { lo: 0.0, hi: PENUMBRA_MAX };
        let clauses = tape_at(&self.texels, cell.tape).as_flattened().as_chunks::<2>().0;
        let listed =
            |[word, immediate]: &[u32; 2]| list(*word, f32::from_bits(*immediate), &mut registers, frame);
        clauses.iter().filter_map(listed).collect()
    }
}

pub(super) enum Computes {
    Load,
    Texture,
    Operator(Op),
    Compound(Compound),
}

/// A word of a tape.
pub(super) struct Clause {
    pub(super) computes: Computes,
    pub(super) output: u8,
    /// The registers that are read; `None` for the immediate.
    reads: [Option<u8>; 2],
}

impl Clause {
    /// Returns the clause of a word; `None` for an end or an empty clause.
    pub(super) fn of(word: u32) -> Option<Self> {
        let [code, output, a, b] = word.to_le_bytes();
        let (a, b) = (Some(a), Some(b));
        let (computes, reads) = match (code, Compound::from_number(code)) {
            (opcode::LOAD, _) => (Computes::Load, [None; 2]),
            (opcode::TEXTURE, _) => (Computes::Texture, [None; 2]),
            (_, Some(compound)) => (Computes::Compound(compound), [a, b]),
            _ => {
                let (number, reads) = match code & 0xC0 {
                    0 => (code, [a, a]),
                    0x40 => (code, [a, b]),
                    0x80 => (code - opcode::REGISTER_IMMEDIATE, [a, None]),
                    _ => (code - opcode::IMMEDIATE_REGISTER, [None, b]),
                };
                (Computes::Operator(Op::from_number(number)?), reads)
            }
        };
        Some(Self { computes, output, reads })
    }
}

/// Runs a tape whose inputs are in the registers, with texture samples of four channels each. Returns the first two
/// results. The other results are in registers.
pub(crate) fn run_texels(
    texels: &[[u32; 4]],
    registers: &mut [f32; 256],
    samples: &[f32],
    frame: &FrameInputs,
) -> [f32; 2] {
    for texel in texels {
        for [word, bits] in texel.as_chunks::<2>().0 {
            let Some(Clause { computes, output, reads }) = Clause::of(*word) else { continue };
            let immediate = f32::from_bits(*bits);
            let [a, b] =
                reads.map(|read| read.map_or(immediate, |register| registers[usize::from(register)]));
            registers[usize::from(output)] = match computes {
                Computes::Load => immediate,
                Computes::Texture => samples.get(*bits as usize).copied().unwrap_or(0.0),
                Computes::Operator(op) => op.value(a, b, frame),
                Computes::Compound(compound) => compound.value(a, b, immediate, frame),
            };
        }
        if texel[2] & 255 == u32::from(opcode::END) {
            let [_, _, first, second] = texel[2].to_le_bytes();
            return [first, second].map(|register| registers[usize::from(register)] + 0.0);
        }
    }
    [0.0; 2]
}

// Lists the tape of a cell with the bounds of each clause's result. The listing shows why the tree could drop clauses:
// where the bounds of two shapes do not overlap, their minimum is one of them (Keeter 2020, section 3).

/// A clause of a cell's tape.
#[derive(Debug, Clone, PartialEq)]
pub struct ListedClause {
    /// The operator's name.
    pub operator: &'static str,
    /// The operands, such as `slot 3` or `0.5`.
    pub operands: Vec<String>,
    /// The register that takes the result.
    pub output: u8,
    /// Bounds of the result in the whole cell.
    pub bounds: Interval,
}

/// Lists one clause and notes its result; `None` for an end.
fn list(
    word: u32,
    immediate: f32,
    registers: &mut [Interval; 256],
    frame: &FrameInputs,
) -> Option<ListedClause> {
    let Clause { computes, output, reads } = Clause::of(word)?;
    let of = |read: Option<u8>| read.map(|register| registers[usize::from(register)]);
    let [a, b] = reads.map(|read| of(read).unwrap_or(Interval::point(immediate)));
    let (operator, operands, bounds) = match computes {
        Computes::Load => ("LOAD", 1, Interval::point(immediate)),
        Computes::Texture => ("TEXTURE", 0, Interval::ANY),
        Computes::Operator(op) => (op.name(), op.arity(), op.bounds(a, b, frame)),
        Computes::Compound(compound) => (compound.name(), 3, compound.bounds(a, b, immediate, frame)),
    };
    let shown =
        |read: Option<u8>| read.map_or_else(|| immediate.to_string(), |register| format!("slot {register}"));
    let operands = reads.into_iter().chain([None]).map(shown).take(operands).collect();
    registers[usize::from(output)] = bounds;
    Some(ListedClause { operator, operands, output, bounds })
}
