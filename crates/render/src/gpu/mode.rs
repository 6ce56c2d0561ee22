//! The two modes of drawing a scene: interpreted and compiled.

use mariana_field::world::{TapeBuffers, World};

/// The way in which a scene's expressions are executed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Mode {
    /// Interpreted from the tape in a texture buffer.
    Interpreted,
    /// Compiled as GLSL generated for the scene.
    Compiled,
}

impl std::fmt::Display for Mode {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Mode::Interpreted => "interpreted",
            Mode::Compiled => "compiled",
        })
    }
}

// The choice between drawing with and without the cells of a region tree.

/// When to divide space into cells. The choice does not change the image.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum CellUse {
    /// Where cells make a frame cheaper: in interpreted scenes, and in compiled scenes with long distance formulas.
    #[default]
    WhereTheyPay,
    /// Wherever possible.
    Always,
    /// Only where the formula is not a distance.
    Never,
}

/// Compiled distances with fewer clauses than this are faster without cells, and need no tree. Cells neither help nor
/// hurt at 1,900 clauses on the software renderer, and at about 600 on AMD (by instruction counts).
const CELLS_PAY_FROM: usize = 1_000;

impl CellUse {
    /// True if space is divided into cells in this mode. Formulas that are not distances always need cells.
    pub fn divides(self, world: &World, buffers: &TapeBuffers, mode: Mode) -> bool {
        world.non_lipschitz
            || match self {
                CellUse::Always => true,
                CellUse::Never => false,
                CellUse::WhereTheyPay => mode == Mode::Interpreted || buffers.cost.distance >= CELLS_PAY_FROM,
            }
    }
}
