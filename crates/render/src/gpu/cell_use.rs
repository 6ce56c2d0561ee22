//! When rays look up the cells of a tree of regions.

use super::mode::Mode;
use mariana_field::world::{TapeBuffers, World};

/// When space is divided into cells. The picture is the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum CellUse {
    /// Where a frame costs less with them: interpreted, and compiled if the distance is long.
    #[default]
    WhereTheyPay,
    /// Wherever it is possible.
    Always,
    /// Only where the formula is not a distance.
    Never,
}

/// A compiled distance of fewer clauses is evaluated as soon as its cells are looked up, and their tree need not be
/// built. On the software renderer the two kinds of frames cost the same at 1,900 clauses, on AMD, by instructions, at
/// about 600 (`docs/performance.md`).
const CELLS_PAY_FROM: usize = 1_000;

impl CellUse {
    /// Whether a world is divided into cells for a mode. A formula that is not a distance cannot do without them.
    pub fn divides(self, world: &World, buffers: &TapeBuffers, mode: Mode) -> bool {
        world.non_lipschitz
            || match self {
                CellUse::Always => true,
                CellUse::Never => false,
                CellUse::WhereTheyPay => mode == Mode::Interpreted || buffers.cost.distance >= CELLS_PAY_FROM,
            }
    }
}
