//! The universal interpreters, which draw nearly every scene: one interpreter for distances and one for other formulas.
//! A GPU compiles them before the first edit, so that no edit waits for a compiler. A software renderer evaluates every
//! branch, so it only uses interpreters made for particular scenes.

use std::rc::Rc;

use crate::gpu::{Interpreter, Program};

/// The interpreters for distances and for other formulas.
pub(super) struct UniversalInterpreters([UniversalInterpreter; 2]);

struct UniversalInterpreter {
    variant: Interpreter,
    state: State,
}

enum State {
    Unasked,
    Coming,
    There(Rc<Program>),
    /// Not used with this renderer, or rejected by the driver.
    None,
}

impl UniversalInterpreters {
    /// Starts without programs. `are_wanted` = false disables both interpreters.
    pub(super) fn new(are_wanted: bool) -> Self {
        Self([false, true].map(|non_lipschitz| UniversalInterpreter {
            variant: Interpreter::universal(non_lipschitz),
            state: if are_wanted { State::Unasked } else { State::None },
        }))
    }

    fn of(&mut self, non_lipschitz: bool) -> &mut UniversalInterpreter {
        &mut self.0[usize::from(non_lipschitz)]
    }

    /// Marks the interpreter for this kind of formula as requested. Returns its variant, or `None` if already marked.
    pub(super) fn request(&mut self, non_lipschitz: bool) -> Option<Interpreter> {
        let one = self.of(non_lipschitz);
        matches!(one.state, State::Unasked).then(|| {
            one.state = State::Coming;
            one.variant.clone()
        })
    }

    /// The `non_lipschitz` flag of an interpreter that was never requested; `None` if both were requested.
    pub(super) fn unasked(&self) -> Option<bool> {
        let is_unasked =
            |non_lipschitz: &bool| matches!(self.0[usize::from(*non_lipschitz)].state, State::Unasked);
        [false, true].into_iter().find(is_unasked)
    }

    pub(super) fn put(&mut self, non_lipschitz: bool, program: Program) {
        self.of(non_lipschitz).state = State::There(Rc::new(program));
    }

    pub(super) fn give_up(&mut self, non_lipschitz: bool) {
        self.of(non_lipschitz).state = State::None;
    }

    /// True if an interpreter that is not disabled covers `needed`.
    pub(super) fn serve(&self, needed: &Interpreter) -> bool {
        self.0.iter().any(|one| !matches!(one.state, State::None) && one.variant.covers(needed))
    }

    /// True if an interpreter that covers `needed` is being compiled.
    pub(super) fn are_coming(&self, needed: &Interpreter) -> bool {
        self.0.iter().any(|one| matches!(one.state, State::Coming) && one.variant.covers(needed))
    }

    pub(super) fn find(&self, needed: &Interpreter) -> Option<Rc<Program>> {
        self.0.iter().find_map(|one| match &one.state {
            State::There(program) if one.variant.covers(needed) => Some(program.clone()),
            _ => None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_kind_is_requested_once_and_serves_until_the_driver_rejects_it() {
        let mut universal = UniversalInterpreters::new(true);
        let needed = Interpreter::universal(true);
        assert!(universal.serve(&needed) && !universal.are_coming(&needed));
        assert_eq!(universal.unasked(), Some(false), "distances first");
        assert!(universal.request(true).is_some() && universal.request(true).is_none());
        assert!(universal.are_coming(&needed));
        assert!(universal.request(false).is_some());
        assert_eq!(universal.unasked(), None);
        universal.give_up(true);
        assert!(!universal.serve(&needed) && universal.find(&needed).is_none());
        assert_eq!(UniversalInterpreters::new(false).unasked(), None, "a software renderer has none");
    }
}
