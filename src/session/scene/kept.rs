//! A small cache of programs that can draw more than one scene.

use std::rc::Rc;

use super::prepared_scene::PreparedScene;
use super::program_task::ProgramOf;
use crate::gpu::{Mode, Program};
use crate::limits;

/// Programs by key; the least recently used is dropped first. A program takes about 20 MiB with a software renderer.
pub(super) struct KeptPrograms<K> {
    /// In order of use, the most recently used last.
    programs: Vec<(K, Rc<Program>)>,
}

impl<K> Default for KeptPrograms<K> {
    fn default() -> Self {
        Self { programs: Vec::new() }
    }
}

impl<K> KeptPrograms<K> {
    pub(super) fn has(&self, serves: impl Fn(&K) -> bool) -> bool {
        self.programs.iter().any(|(of, _)| serves(of))
    }

    /// Returns the most recently used program whose key `serves` accepts.
    pub(super) fn find(&mut self, serves: impl Fn(&K) -> bool) -> Option<Rc<Program>> {
        let place = self.programs.iter().rposition(|(of, _)| serves(of))?;
        let found = self.programs.remove(place);
        let program = found.1.clone();
        self.programs.push(found);
        Some(program)
    }

    pub(super) fn add(&mut self, of: K, program: Program) {
        self.programs.push((of, Rc::new(program)));
        while self.programs.len() > limits::PROGRAMS_KEPT_MAX {
            self.programs.remove(0);
        }
    }

    pub(super) fn retain(&mut self, is_of_use: impl Fn(&K) -> bool) {
        self.programs.retain(|(of, _)| is_of_use(of));
    }
}

impl KeptPrograms<ProgramOf> {
    pub(super) fn cover(&self, wanted: &ProgramOf) -> bool {
        self.has(|known| known.covers(wanted))
    }

    /// The program to request for a scene in a mode, if it is missing.
    pub(super) fn missing(&self, scene: &PreparedScene, mode: Mode) -> Option<ProgramOf> {
        scene.program_of(mode).filter(|wanted| !self.cover(wanted))
    }

    pub(super) fn covering(&mut self, wanted: &ProgramOf) -> Option<Rc<Program>> {
        self.find(|known| known.covers(wanted))
    }

    /// Keeps only programs that one of these scenes may need.
    pub(super) fn keep(&mut self, scenes: &[u64]) {
        self.retain(|of| of.may_serve(scenes));
    }
}
