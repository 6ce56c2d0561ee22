//! A world as the interpreter's buffers: programs of clauses, and the table of their constants and inputs.
//!
//! | texel (four words) | holds |
//! |---|---|
//! | 0 | where the programs of the distance, the object, the sky and the ambient light begin |
//! | 1.. | where the material of each object begins, four objects a texel |
//! | a program | a header, then its clauses (see [`crate::tape`]) |
//!
//! A program's header is its first entry in the table, then the slots of its outputs, a byte each.

use std::collections::BTreeSet;

use super::{MATERIAL_OUTPUTS, World, WorldError};
use crate::graph::{FrameInputs, NodeId, Op};
use crate::tape::{TableEntry, Tape, TapeOptions};

/// Words of a texel.
const TEXEL: usize = 4;

/// What the interpreter shader reads.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TapeBuffers {
    /// Texels of four words.
    pub words: Vec<u32>,
    /// The table of all programs.
    pub table: Vec<TableEntry>,
    /// Registers that the largest program uses.
    pub slots: usize,
    /// Spilled values of the largest program.
    pub memory: usize,
    /// Clauses of the longest program.
    pub longest: usize,
    /// Operators of all programs.
    pub operators: BTreeSet<Op>,
    /// What it costs.
    pub cost: Cost,
}

/// Clauses of the programs.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize)]
pub struct Cost {
    /// Of the distance.
    pub distance: usize,
    /// Of all materials.
    pub materials: usize,
    /// Of everything.
    pub total: usize,
}

impl TapeBuffers {
    /// The table's numbers in a frame.
    pub fn table_values(&self, inputs: &FrameInputs) -> Vec<f32> {
        let value = |entry: &TableEntry| match *entry {
            TableEntry::Constant(value) => value,
            TableEntry::Input(input) => inputs.value(input),
        };
        self.table.iter().map(value).collect()
    }

    /// Appends a program and returns its first texel.
    fn add(&mut self, tape: &Tape) -> u32 {
        let texel = self.words.len() / TEXEL;
        let mut header = [0_u32; TEXEL];
        header[0] = self.table.len() as u32;
        for (place, &slot) in tape.outputs().iter().enumerate() {
            if let Some(word) = header.get_mut(1 + place / 4) {
                *word |= u32::from(slot) << (8 * (place % 4));
            }
        }
        self.words.extend(header);
        self.words.extend(tape.words());
        self.table.extend(tape.table());
        self.slots = self.slots.max(tape.slots());
        self.memory = self.memory.max(tape.memory());
        self.longest = self.longest.max(tape.clauses().len());
        self.operators.extend(tape.operators());
        self.cost.total += tape.clauses().len();
        texel as u32
    }
}

impl World {
    /// The programs of everything that the shader evaluates.
    ///
    /// # Errors
    /// A tape that takes more than the limits.
    pub fn tape_buffers(&self) -> Result<TapeBuffers, WorldError> {
        let tape = |roots: &[NodeId]| {
            Tape::build(&self.scene.graph, roots, &TapeOptions::default())
                .map_err(|source| WorldError::Tape { scene: self.name.clone(), source })
        };
        let mut buffers = TapeBuffers::default();
        let objects = self.scene.objects.len();
        buffers.words.resize(TEXEL + objects.div_ceil(TEXEL) * TEXEL, 0);
        let distance = tape(&self.roots.distance)?;
        buffers.cost.distance = distance.clauses().len();
        let mut directory = [0; TEXEL];
        directory[0] = buffers.add(&distance);
        directory[1] = buffers.add(&tape(&[self.roots.object])?);
        directory[2] = buffers.add(&tape(&self.roots.sky)?);
        directory[3] = buffers.add(&tape(&self.roots.ambient)?);
        let mut materials = Vec::with_capacity(self.roots.materials.len());
        for roots in &self.roots.materials {
            debug_assert_eq!(roots.len(), MATERIAL_OUTPUTS.len());
            let material = tape(roots)?;
            buffers.cost.materials += material.clauses().len();
            materials.push(buffers.add(&material));
        }
        let of_objects =
            self.scene.objects.iter().map(|object| materials.get(object.material).copied().unwrap_or(0));
        for (to, from) in buffers.words.iter_mut().zip(directory.into_iter().chain(of_objects)) {
            *to = from;
        }
        Ok(buffers)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lang::{compile, no_includes};

    #[test]
    fn every_program_begins_where_the_directory_says() {
        let text = "material a { color = p }\nmaterial b { color = n roughness = 0.25 }\n\
                    object first { shape = sphere(p, 1) material = a }\n\
                    object second { shape = box(p, 1) material = b }\n\
                    object third { shape = sphere(p, 2) material = a }";
        let scene = compile("test", text, &mut no_includes).scene.unwrap();
        let world = World::new("test", scene, Vec::new()).unwrap();
        let buffers = world.tape_buffers().unwrap();
        let words = &buffers.words;
        assert_eq!(words.len() % 4, 0);
        assert_eq!(words[4], words[6], "the first and the third object are of one material");
        assert_ne!(words[4], words[5]);
        for (program, roots) in [
            (words[0], &world.roots.distance[..]),
            (words[1], &[world.roots.object]),
            (words[4], &world.roots.materials[0]),
            (words[5], &world.roots.materials[1]),
        ] {
            let tape = Tape::build(&world.scene.graph, roots, &TapeOptions::default()).unwrap();
            let header = program as usize * 4;
            assert_eq!(words[header + 4..][..tape.words().len()], tape.words());
            let table = words[header] as usize;
            assert_eq!(buffers.table[table..][..tape.table().len()], *tape.table());
            for (place, &slot) in tape.outputs().iter().enumerate() {
                assert_eq!((words[header + 1 + place / 4] >> (8 * (place % 4))) as u8, slot);
            }
        }
    }
}
