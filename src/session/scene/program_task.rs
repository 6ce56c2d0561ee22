//! The purposes of programs that are being made.

use crate::gpu::scene_program::Interpreter;

/// The purpose of a program that is being made.
pub(super) enum Task {
    /// It draws one scene.
    Compiled {
        /// The scene.
        id: u64,
        /// Whether it is to look up the cells of a tree.
        has_cells: bool,
    },
    /// It draws every scene that this interpreter covers.
    Interpreter(Interpreter),
    /// It draws nearly every scene.
    Universal {
        /// Whether it is for formulas that are no distances.
        non_lipschitz: bool,
    },
    /// It draws views.
    Views(ViewsOf),
}

/// What a program of views draws.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum ViewsOf {
    /// A scene, compiled.
    Compiled(u64),
    /// Every scene that this interpreter covers.
    Interpreted(Interpreter),
}

impl ViewsOf {
    /// Whether a program for this draws what is wanted.
    pub(super) fn covers(&self, wanted: &Self) -> bool {
        match (self, wanted) {
            (ViewsOf::Compiled(id), ViewsOf::Compiled(wanted)) => id == wanted,
            (ViewsOf::Interpreted(known), ViewsOf::Interpreted(wanted)) => known.covers(wanted),
            _ => false,
        }
    }
}
