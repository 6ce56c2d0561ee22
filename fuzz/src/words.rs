//! A CPU version of the interpreter shader. `mariana_field::tape::interpreter` describes the format of the texels.

use mariana_field::graph::{Compound, FrameInputs, Point};
use mariana_field::tape::{Instruction, Operand, opcode};

/// Runs the tape that begins at a texel. Returns all registers at the end of the tape, and the two registers that END
/// names.
///
/// # Panics
/// Panics if the texels end before the tape, or contain an invalid word.
pub(crate) fn run(
    texels: &[[u32; 4]],
    start: usize,
    point: &Point,
    frame: &FrameInputs,
) -> ([f32; 256], [usize; 2]) {
    let mut registers = [0.0f32; 256];
    let mut memory = vec![0.0f32; 1 << 16];
    let inputs = point.inputs();
    registers[..6].copy_from_slice(&inputs);
    for texel in &texels[start..] {
        for (place, [word, immediate]) in texel.as_chunks::<2>().0.iter().enumerate() {
            let number = f32::from_bits(*immediate);
            let value = |registers: &[f32; 256], operand| match operand {
                Operand::Register(register) => registers[usize::from(register)],
                Operand::Immediate(_) => number,
            };
            let [code, output, a, b] = word.to_le_bytes();
            if let Some(compound) = Compound::from_number(code) {
                let [a, b] = [a, b].map(|register| registers[usize::from(register)]);
                registers[usize::from(output)] = compound.value(a, b, number, frame);
                continue;
            }
            if code == opcode::END && place == 1 {
                return (registers, [usize::from(a), usize::from(b)]);
            }
            // Word 0 as the first clause does nothing.
            if *word == 0 {
                continue;
            }
            let (output, value) = match Instruction::from_word(*word).expect("the word is valid") {
                Instruction::Load { output, .. } => (output, number),
                Instruction::Store { register, memory: to } => {
                    memory[usize::from(to)] = registers[usize::from(register)];
                    continue;
                }
                Instruction::Reload { output, memory: from } => (output, memory[usize::from(from)]),
                Instruction::Texture { output, u, v, .. } => {
                    let (texture, channel) = (immediate / 4, immediate % 4);
                    let (u, v) = (registers[usize::from(u)], registers[usize::from(v)]);
                    (output, frame.texture(texture as u16, channel as u8, u, v))
                }
                Instruction::Input { output, place } => (output, inputs[usize::from(place)]),
                Instruction::Unary { op, output, a } => {
                    (output, op.value(registers[usize::from(a)], 0.0, frame))
                }
                Instruction::Binary { op, output, a, b } => {
                    (output, op.value(value(&registers, a), value(&registers, b), frame))
                }
            };
            registers[usize::from(output)] = value;
        }
    }
    panic!("the texels end before the tape");
}

/// Returns the texel indices where the programs of a grid's cells start.
fn cells_of(texels: &[[u32; 4]], grid: u32) -> &[u32] {
    let side = texels[grid as usize][3] as usize + 1;
    &texels[grid as usize + 2..].as_flattened()[..side.pow(3)]
}

/// Checks that every program in the directory of a world's texels ends, and that every tape of texture coordinates
/// ends.
pub(crate) fn check_directory(texels: &[[u32; 4]], objects: usize) {
    let ends = |start: u32| {
        let tape = texels.get(start as usize..).unwrap_or(&[]);
        let end = tape.iter().position(|texel| texel[2] & 255 == u32::from(opcode::END));
        assert!(end.is_some(), "the tape at texel {start} does not end");
    };
    let words = texels.as_flattened();
    let heads = words[..3].iter().chain(&words[4..4 + objects]);
    for &program in heads.flat_map(|grid| cells_of(texels, *grid)) {
        let head = texels[program as usize];
        let textures = head[3];
        for texture in 0..textures {
            ends(texels[(program + 1 + texture) as usize][1]);
        }
        ends(program + 1 + textures);
    }
}
