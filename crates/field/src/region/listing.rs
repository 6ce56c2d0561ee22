//! Lists the tape of a cell with the bounds of each clause's result. The listing shows why the tree could drop clauses:
//! where the bounds of two shapes do not overlap, their minimum is one of them (Keeter 2020, section 3).

use super::read::Cell;
use super::tree::{PENUMBRA_MAX, Regions};
use crate::graph::{Compound, FrameInputs, Interval};
use crate::tape::{Clause, Instruction, Operand, opcode};

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

impl Regions {
    /// Returns the clauses of a cell's tape in the order in which they run. Slots 0 to 2 hold the point at the
    /// beginning.
    pub fn listing(&self, cell: &Cell, frame: &FrameInputs) -> Vec<ListedClause> {
        let mut registers = [Interval::point(0.0); 256];
        for (register, (low, high)) in registers.iter_mut().zip(cell.low.iter().zip(&cell.high)) {
            *register = Interval { lo: *low, hi: *high };
        }
        registers[3] = Interval { lo: 0.0, hi: PENUMBRA_MAX };
        let mut listed = Vec::new();
        for texel in self.texels.get(cell.tape as usize..).unwrap_or(&[]) {
            for [word, immediate] in texel.as_chunks::<2>().0 {
                listed.extend(list(*word, f32::from_bits(*immediate), &mut registers, frame));
            }
            if texel[2] & 255 == u32::from(opcode::END) {
                break;
            }
        }
        listed
    }
}

/// Lists one clause and notes its result; `None` for an end.
fn list(
    word: u32,
    immediate: f32,
    registers: &mut [Interval; 256],
    frame: &FrameInputs,
) -> Option<ListedClause> {
    let slot = |register: u8| format!("slot {register}");
    let [number, output, a, b] = word.to_le_bytes();
    let at = |registers: &[Interval; 256], register: u8| registers[usize::from(register)];
    let (operator, operands, output, bounds) = if let Some(compound) = Compound::from_number(number) {
        let bounds = compound.bounds(at(registers, a), at(registers, b), immediate, frame);
        (compound.name(), vec![slot(a), slot(b), immediate.to_string()], output, bounds)
    } else {
        let of = |operand: Operand| match operand {
            Operand::Register(register) => (slot(register), at(registers, register)),
            Operand::Immediate(_) => (immediate.to_string(), Interval::point(immediate)),
        };
        match Clause::from_word(word).decode()? {
            Instruction::Unary { op, output, a } => {
                let bounds = op.bounds(at(registers, a), Interval::point(0.0), frame);
                (op.name(), vec![slot(a)], output, bounds)
            }
            Instruction::Binary { op, output, a, b } => {
                let ((a, of_a), (b, of_b)) = (of(a), of(b));
                (op.name(), vec![a, b], output, op.bounds(of_a, of_b, frame))
            }
            Instruction::Load { output, .. } => {
                ("LOAD", vec![immediate.to_string()], output, Interval::point(immediate))
            }
            Instruction::Input { output, place } => ("INPUT", vec![place.to_string()], output, Interval::ANY),
            Instruction::Texture { output, .. } => ("TEXTURE", Vec::new(), output, Interval::ANY),
            _ => return None,
        }
    };
    registers[usize::from(output)] = bounds;
    Some(ListedClause { operator, operands, output, bounds })
}
