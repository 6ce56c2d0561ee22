//! A small cache of programs that can draw more than one scene.

use std::rc::Rc;

use crate::gpu::program::Program;
use crate::limits::LIMITS;

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
        while self.programs.len() > LIMITS.programs_kept_max {
            self.programs.remove(0);
        }
    }

    pub(super) fn retain(&mut self, is_of_use: impl Fn(&K) -> bool) {
        self.programs.retain(|(of, _)| is_of_use(of));
    }
}
