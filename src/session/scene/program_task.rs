//! The purposes of programs that are being compiled.

use crate::gpu::scene_program::Interpreter;

pub(super) enum Task {
    Compiled {
        id: u64,
        has_cells: bool,
    },
    /// Draws every scene that this interpreter covers.
    Interpreter(Interpreter),
    Universal {
        /// True for formulas that are not distances.
        non_lipschitz: bool,
    },
    Views(ViewsOf),
}

#[derive(Debug, Clone, PartialEq)]
pub(super) enum ViewsOf {
    Compiled(u64),
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
