//! A small cache of programs that can draw more than one scene.

use std::rc::Rc;

use super::prepared_scene::PreparedScene;
use super::program_task::ProgramOf;
use crate::gpu::{Mode, Program};
use crate::limits;

/// Programs by their functions; the least recently used is dropped first. A program takes about 20 MiB with a software
/// renderer.
#[derive(Default)]
pub(super) struct KeptPrograms {
    /// In order of use, the most recently used last.
    programs: Vec<(ProgramOf, Rc<Program>)>,
}

impl KeptPrograms {
    pub(super) fn cover(&self, wanted: &ProgramOf) -> bool {
        self.programs.iter().any(|(known, _)| known.covers(wanted))
    }

    /// The program to request for a scene in a mode, if it is missing.
    pub(super) fn missing(&self, scene: &PreparedScene, mode: Mode) -> Option<ProgramOf> {
        scene.program_of(mode).filter(|wanted| !self.cover(wanted))
    }

    /// Returns the most recently used program that draws `wanted`.
    pub(super) fn covering(&mut self, wanted: &ProgramOf) -> Option<Rc<Program>> {
        let place = self.programs.iter().rposition(|(known, _)| known.covers(wanted))?;
        let found = self.programs.remove(place);
        let program = found.1.clone();
        self.programs.push(found);
        Some(program)
    }

    pub(super) fn add(&mut self, of: ProgramOf, program: Program) {
        self.programs.push((of, Rc::new(program)));
        while self.programs.len() > limits::PROGRAMS_KEPT_MAX {
            self.programs.remove(0);
        }
    }

    /// Keeps only programs that one of these scenes may need.
    pub(super) fn keep(&mut self, scenes: &[u64]) {
        self.programs.retain(|(of, _)| of.may_serve(scenes));
    }
}
