//! Programs that serve more than one scene, kept for as long as they are useful.

use std::rc::Rc;

use crate::gpu::program::Program;
use crate::limits::LIMITS;

/// Programs by what they were made for; the least recently used one goes first. Each takes some 20 MiB of memory on a
/// software renderer.
pub(super) struct KeptPrograms<K> {
    /// The most recently used one is last.
    programs: Vec<(K, Rc<Program>)>,
}

impl<K> Default for KeptPrograms<K> {
    fn default() -> Self {
        Self { programs: Vec::new() }
    }
}

impl<K> KeptPrograms<K> {
    /// Whether there is one that `serves`.
    pub(super) fn has(&self, serves: impl Fn(&K) -> bool) -> bool {
        self.programs.iter().any(|(of, _)| serves(of))
    }

    /// The one that `serves`; of several, the most recently used.
    pub(super) fn find(&mut self, serves: impl Fn(&K) -> bool) -> Option<Rc<Program>> {
        let place = self.programs.iter().rposition(|(of, _)| serves(of))?;
        let found = self.programs.remove(place);
        let program = found.1.clone();
        self.programs.push(found);
        Some(program)
    }

    /// Keeps another one.
    pub(super) fn add(&mut self, of: K, program: Program) {
        self.programs.push((of, Rc::new(program)));
        while self.programs.len() > LIMITS.programs_kept_max {
            self.programs.remove(0);
        }
    }

    /// Forgets those that are no longer useful.
    pub(super) fn retain(&mut self, is_of_use: impl Fn(&K) -> bool) {
        self.programs.retain(|(of, _)| is_of_use(of));
    }
}
