//! The purposes of programs that are being compiled.

use crate::gpu::scene_program::Interpreter;

pub(super) enum Task {
    Compiled {
        id: u64,
        /// True if the program looks up the cells of a tree.
        has_cells: bool,
    },
    /// Draws every scene that this interpreter covers.
    Interpreter(Interpreter),
    /// Draws nearly every scene.
    Universal {
        /// True for formulas that are not distances.
        non_lipschitz: bool,
    },
    Views(ViewsOf),
}

/// The scope of a view program.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum ViewsOf {
    /// One compiled scene.
    Compiled(u64),
    /// Every scene that this interpreter covers.
    Interpreted(Interpreter),
}

impl ViewsOf {
    /// True if a program for `self` also draws `wanted`.
    pub(super) fn covers(&self, wanted: &Self) -> bool {
        match (self, wanted) {
            (ViewsOf::Compiled(id), ViewsOf::Compiled(wanted)) => id == wanted,
            (ViewsOf::Interpreted(known), ViewsOf::Interpreted(wanted)) => known.covers(wanted),
            _ => false,
        }
    }
}
