//! The purposes of programs that are being compiled.

use crate::gpu::scene_program::Interpreter;

pub(super) enum Task {
    Compiled {
        id: u64,
        has_cells: bool,
    },
    /// Draws every scene that this interpreter covers.
    Interpreter(Interpreter),
    Views(ProgramOf),
    /// Draws by paths of light.
    Paths(ProgramOf),
}

impl Task {
    /// True if a program for views or paths also serves the task `wanted`.
    pub(super) fn covers(&self, wanted: &Self) -> bool {
        match (self, wanted) {
            (Self::Views(known), Self::Views(wanted)) | (Self::Paths(known), Self::Paths(wanted)) => {
                known.covers(wanted)
            }
            _ => false,
        }
    }
}

/// The functions of a program for views or paths: a scene's own functions, or an interpreter.
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
