//! Regions: a tree over space, built for each frame. Each cell holds a lower bound of the distance to the surfaces and
//! a tape that computes the distance and is shortened for the cell.
//!
//! Keeter, "Massively parallel rendering of complex closed-form implicit surfaces" (2020) shortens tapes by interval
//! arithmetic for tiles of the screen. Here the cells divide the world, so that shadow, occlusion and reflection rays
//! can use the tapes as well.
//!
//! ```text
//! World → RegionPlan; with a frame's inputs: numbers folded in → 64 cells at once: bounds → decisions → groups of
//!         equal decisions → shorter programs → cells again, or tapes
//! ```
//!
//! # Texels
//! The shaders read [`Regions::texels`], RGBA32UI:
//!
//! | texel | holds |
//! |---|---|
//! | 4096 of a root | 16x16x16 cells, `x + 16 * (y + 16 * z)`; the first root begins at 0 |
//! | 64 of a brick | the children of a divided cell, `x + 4 * (y + 4 * z)` |
//! | a tape | a texel with the address of the object's tape; then the clauses (`encode`) |
//!
//! A cell is `[bound, tape | object << 24, slopes, slopes]`:
//!
//! - The bound is a lower bound of the distance everywhere in the cell, as a float's bits. It is 0 if the cell may
//!   contain a surface. The bound [`DIVIDED`] marks a divided cell; its second word is the first texel of its brick.
//! - The second word holds the first texel of the cell's tape and the number of the nearest object, or
//!   [`OBJECT_UNKNOWN`].
//! - The slopes are bounds of the gradient ([`gradient`]) if the value is not a distance ([`World::non_lipschitz`])
//!   and the cell may contain a surface, else 0.
//!
//! # Construction
//! A frame's numbers are folded into the distance's program. Interval arithmetic then bounds the program's values in 64
//! cells at once, and masks of 64 bits record the decisions about each value (`prune.rs`). Cells with equal masks share
//! a program, which is written once; programs with equal steps share a tape.
//!
//! The root has 16 cells along each axis. A cell with a surface and more than 16 clauses has 64 children; a child with
//! more than 96 clauses also has 64 children, up to two limits (`part.rs`). Only penumbras and occlusion read tapes away
//! from surfaces, so each 2x2x2 cells there share their decisions. Several threads can build blocks of the root: this module
//! makes the [`Part`]s, `gpu::scene_resources` runs the threads.
//!
//! # Rounding
//! On the CPU a shortened tape equals the whole tape bit for bit in its cell. Shaders round differently: bounds are
//! reduced by 1e-5 of the scene's size, and cells overlap by 4e-6 of that size (`tree.rs`). Rays look up their cell a
//! hundred-thousandth of a root cell ahead, so that no ray gets stuck at a face.

mod blend;
mod encode;
pub(crate) mod every_frame;
mod formula;
pub mod gradient;
mod lanes;
mod medium;
mod part;
mod program;
mod prune;
mod read;
mod reuse;
mod short_lives;
pub(crate) mod surface;
mod tree;

pub use encode::{Encoder, REGISTERS_MAX, Texel};
pub use formula::{Formula, FrameTape, RegionKey};
pub(crate) use formula::{Needs, compounds_that_pay};
pub use medium::{MEDIUM_SIDE, MediumGrid, MediumPlan};
pub use part::Part;
#[cfg(test)]
pub(crate) use read::run_texels;
pub use read::{Cell, ListedClause};
pub use surface::Surfaces;
pub use tree::{RegionOptions, RegionStats, Regions};

use std::collections::BTreeSet;

use crate::bounds::Bounds;
use crate::graph::{Compounds, FrameInputs, Graph, NodeId, Op};
use crate::tape::interpreter::rounded_registers;
use crate::world::World;
use program::{BOUND, ESTIMATE, OBJECT};

/// Cells of the root along each axis.
pub const ROOT_SIDE: usize = crate::rays::ROOT_SIDE as usize;
/// Extent of a root, as a multiple of the extent of the next smaller root, which is its inner 4x4x4 cells.
pub const ROOT_GROWTH: usize = 4;
const _: () = assert!(ROOT_SIDE == 16 && ROOT_GROWTH == 4, "`shaders/regions.glsl` has these numbers");
/// Cells of a brick along each axis.
pub const BRICK_SIDE: usize = 4;
/// The whole tapes need this number of texels in addition to those of their clauses.
const WHOLE_BESIDE: usize = 8;
/// The bound of a divided cell.
pub const DIVIDED: u32 = u32::MAX;
/// The object of a cell where several objects may be the nearest.
pub const OBJECT_UNKNOWN: u32 = 255;

/// The features that an interpreter needs to run the regions' tapes.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Default)]
pub struct RegionVariant {
    /// The operators that occur.
    pub operators: BTreeSet<Op>,
    /// The compounds that may occur.
    pub compounds: Compounds,
    /// Number of registers, up to 256, rounded by [`rounded_registers`]. GPUs round this number up to a power of two.
    pub registers: usize,
    /// True if rays need the cells' bounds of the gradient.
    pub non_lipschitz: bool,
}

impl RegionVariant {
    /// Returns a variant with all operators, and with the registers of the largest shipped scene. With 32 registers
    /// instead of 16, Vega's compiler (ACO) uses no more registers of the GPU. `non_lipschitz` adds support for values
    /// that are not distances.
    pub fn universal(non_lipschitz: bool) -> Self {
        Self {
            operators: Op::ALL.iter().copied().collect(),
            compounds: Compounds::ALL,
            registers: 32,
            non_lipschitz,
        }
    }
}

/// The parts of a world's regions that all frames share.
#[derive(Debug, Clone)]
pub struct RegionPlan {
    formula: Formula,
    /// The features that an interpreter needs to run all trees of this plan.
    pub variant: RegionVariant,
    bounds: Option<Bounds>,
    has_rest: bool,
    steepest: Option<f32>,
    /// True if there are enough registers for the whole tape. Otherwise there are no tapes and no cells.
    pub runs: bool,
    /// An upper bound of the texels of the whole tapes. Drivers with smaller buffers cannot use regions.
    pub whole_texels: usize,
}

impl RegionPlan {
    /// Creates the plan of a world.
    pub fn new(world: &World) -> Self {
        let [bound, estimate] = world.roots.distance;
        let roots = [bound, estimate, world.roots.object];
        let steepest = world.non_lipschitz.then_some(world.slopes.steepest);
        Self::of(&world.graph, roots, world.bounds, world.has_rest, steepest)
    }

    /// `steepest` is [`Slopes::steepest`](crate::world::Slopes::steepest) if the bound is not a distance.
    fn of(
        graph: &Graph,
        mut roots: [NodeId; 3],
        bounds: Option<Bounds>,
        has_rest: bool,
        steepest: Option<f32>,
    ) -> Self {
        let graph = graph.fused(&mut roots);
        let mut formula = Formula::new(&graph, &roots, program::INPUTS, 0);
        formula.tapes = vec![vec![BOUND, ESTIMATE], vec![OBJECT, OBJECT]];
        let Needs { operators, registers, steps, .. } = formula.needs();
        let compounds = compounds_that_pay([&formula]);
        let (runs, whole_texels) = (registers.is_some(), steps + WHOLE_BESIDE);
        let registers = rounded_registers(registers.unwrap_or(REGISTERS_MAX));
        let variant = RegionVariant { operators, compounds, registers, non_lipschitz: steepest.is_some() };
        Self { formula, variant, bounds, has_rest, steepest, runs, whole_texels }
    }

    /// Returns the inputs that determine a frame's tree.
    pub fn key(&self, inputs: &FrameInputs) -> RegionKey {
        self.formula.key(inputs)
    }

    /// Builds the tree of a frame.
    pub fn build(&self, inputs: &FrameInputs, options: &RegionOptions) -> Regions {
        self.build_in_parts(None, inputs, options, 1, |parts| parts.iter_mut().for_each(Part::build))
    }
}

#[cfg(test)]
mod reuse_tests;
#[cfg(test)]
mod tests;
