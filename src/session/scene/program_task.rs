//! The purposes of programs that are being compiled.

use crate::gpu::background::ProgramProduct;
use crate::gpu::scene_program::Interpreter;

pub(super) struct Task {
    pub product: ProgramProduct,
    pub of: ProgramOf,
    /// True if a scene's own functions look up the cells of a tree.
    pub has_cells: bool,
}

/// The functions of a program: a scene's own functions, or an interpreter, which draws every scene that it covers.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum ProgramOf {
    Compiled(u64),
    Interpreted(Interpreter),
}

impl ProgramOf {
    /// True if one of these scenes may need the program.
    pub(super) fn may_serve(&self, scenes: &[u64]) -> bool {
        match self {
            ProgramOf::Compiled(id) => scenes.contains(id),
            ProgramOf::Interpreted(_) => true,
        }
    }

    /// True if a program for `self` also draws `wanted`.
    pub(super) fn covers(&self, wanted: &Self) -> bool {
        match (self, wanted) {
            (ProgramOf::Compiled(id), ProgramOf::Compiled(wanted)) => id == wanted,
            (ProgramOf::Interpreted(known), ProgramOf::Interpreted(wanted)) => known.covers(wanted),
            _ => false,
        }
    }
}
