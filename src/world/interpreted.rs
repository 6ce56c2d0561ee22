//! A world as the interpreter's buffers: programs of clauses, and the table of their constants and inputs.
//!
//! | texel (four words) | holds |
//! |---|---|
//! | 0 | where the programs of the sky and the ambient light begin |
//! | 1.. | where the material of each object begins, four objects a texel |
//! | a program | a header, then its clauses |
//!
//! The words of a program are those of [`crate::tape::interpreter`]. Distances and objects come from regions.

use super::{MATERIAL_OUTPUTS, World, WorldError};
use crate::graph::{FrameInputs, NodeId};
use crate::tape::interpreter::Variant;
use crate::tape::{TableEntry, Tape, TapeOptions};

/// Words of a texel, and entries of one of the table.
const TEXEL: usize = 4;

/// Programs before those of the materials: sky and ambient light.
const PROGRAMS_OF_LIGHT: usize = 2;

/// Entries of a table's page.
const PAGE: usize = 256;

/// What the interpreter shader reads.
#[derive(Debug, Clone, PartialEq)]
pub struct TapeBuffers {
    /// Texels of four words.
    pub words: Vec<u32>,
    /// The tables of all programs, each filled up to texels of four entries.
    pub table: Vec<TableEntry>,
    /// The interpreter that runs all programs, on a GPU.
    pub variant: Variant,
    /// The same for a renderer that never skips a branch.
    pub software_variant: Variant,
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
}

/// Programs while they are put together.
#[derive(Default)]
struct Programs {
    words: Vec<u32>,
    table: Vec<TableEntry>,
    tapes: Vec<Tape>,
}

impl Programs {
    /// Appends a program and returns its first texel.
    fn add(&mut self, tape: Tape) -> u32 {
        let texel = self.words.len() / TEXEL;
        tape.append_program((self.table.len() / TEXEL) as u32, &mut self.words);
        self.table.extend(tape.table());
        let texels = self.table.len().div_ceil(TEXEL) * TEXEL;
        self.table.resize(texels, TableEntry::Constant(0.0));
        self.tapes.push(tape);
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
            Tape::build(&self.graph, roots, &TapeOptions::default())
                .map_err(|source| WorldError::Tape { scene: self.name.clone(), source })
        };
        let mut programs = Programs::default();
        let objects = self.scene.objects.len();
        programs.words.resize(TEXEL + objects.div_ceil(TEXEL) * TEXEL, 0);
        let directory =
            [programs.add(tape(&self.roots.sky)?), programs.add(tape(&self.roots.ambient)?), 0, 0];
        let mut materials = Vec::with_capacity(self.roots.materials.len());
        for roots in &self.roots.materials {
            debug_assert_eq!(roots.len(), MATERIAL_OUTPUTS.len());
            materials.push(programs.add(tape(roots)?));
        }
        let of_objects =
            self.scene.objects.iter().map(|object| materials.get(object.material).copied().unwrap_or(0));
        for (to, from) in programs.words.iter_mut().zip(directory.into_iter().chain(of_objects)) {
            *to = from;
        }
        // Interpreters that keep a table beside their slots read whole pages of it.
        let end = programs.table.len() + PAGE;
        programs.table.resize(end, TableEntry::Constant(0.0));
        let clauses = |tapes: &[Tape]| tapes.iter().map(|tape| tape.clauses().len()).sum();
        let (_, of_materials) = programs.tapes.split_at(PROGRAMS_OF_LIGHT);
        let traced = [tape(&self.roots.distance)?, tape(&[self.roots.object])?];
        let cost = Cost {
            distance: clauses(&traced[..1]),
            materials: clauses(of_materials),
            total: clauses(&programs.tapes) + clauses(&traced),
        };
        Ok(TapeBuffers {
            variant: Variant::of(&programs.tapes, false),
            software_variant: Variant::of(&programs.tapes, true),
            words: programs.words,
            table: programs.table,
            cost,
        })
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
            (words[0], &world.roots.sky[..]),
            (words[1], &world.roots.ambient),
            (words[4], &world.roots.materials[0]),
            (words[5], &world.roots.materials[1]),
        ] {
            let tape = Tape::build(&world.graph, roots, &TapeOptions::default()).unwrap();
            let header = program as usize * 4;
            let table = (words[header] & 0xFF_FFFF) as usize * 4;
            assert_eq!(buffers.table[table..][..tape.table().len()], *tape.table());
            let mut alone = Vec::new();
            tape.append_program(table as u32 / 4, &mut alone);
            assert_eq!(words[header..][..alone.len()], alone);
        }
    }
}
