//! Checks the texels of the interpreter. `mariana_field::tape::interpreter` describes their format.

use mariana_field::tape::opcode;

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
