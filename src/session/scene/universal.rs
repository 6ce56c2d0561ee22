//! The interpreters that draw nearly every scene: one for distances, one for all other formulas. On a GPU they are there
//! before anyone edits, so that no edit waits for a compiler. A software renderer, which never skips a branch, has
//! interpreters of scenes' own only.

use std::rc::Rc;

use crate::gpu::program::Program;
use crate::gpu::scene_program::Interpreter;

/// Both of them.
pub(super) struct UniversalInterpreters([UniversalInterpreter; 2]);

struct UniversalInterpreter {
    variant: Interpreter,
    state: State,
}

enum State {
    /// Nobody has asked for it.
    Unasked,
    /// It is being made.
    Coming,
    /// It is there.
    There(Rc<Program>),
    /// There is none on this renderer, or the driver refused it.
    None,
}

impl UniversalInterpreters {
    /// None of them has been asked for; without `are_wanted` none ever is.
    pub(super) fn new(are_wanted: bool) -> Self {
        Self([false, true].map(|non_lipschitz| UniversalInterpreter {
            variant: Interpreter::universal(non_lipschitz),
            state: if are_wanted { State::Unasked } else { State::None },
        }))
    }

    /// The one for this kind of formula.
    fn of(&mut self, non_lipschitz: bool) -> &mut UniversalInterpreter {
        let [of_distances, of_others] = &mut self.0;
        if non_lipschitz { of_others } else { of_distances }
    }

    /// Marks the one for this kind of formula as requested and returns its variant, unless that was done.
    pub(super) fn ask(&mut self, non_lipschitz: bool) -> Option<Interpreter> {
        let one = self.of(non_lipschitz);
        matches!(one.state, State::Unasked).then(|| {
            one.state = State::Coming;
            one.variant.clone()
        })
    }

    /// The kind of formula whose interpreter nobody has asked for, true for those that are no distances; none if both
    /// were.
    pub(super) fn unasked(&self) -> Option<bool> {
        let [of_distances, of_others] = &self.0;
        let is_unasked = |one: &UniversalInterpreter| matches!(one.state, State::Unasked);
        [(false, of_distances), (true, of_others)]
            .into_iter()
            .find(|(_, one)| is_unasked(one))
            .map(|(non_lipschitz, _)| non_lipschitz)
    }

    /// Takes the one for this kind of formula.
    pub(super) fn put(&mut self, non_lipschitz: bool, program: Program) {
        self.of(non_lipschitz).state = State::There(Rc::new(program));
    }

    /// There is none for this kind of formula.
    pub(super) fn give_up(&mut self, non_lipschitz: bool) {
        self.of(non_lipschitz).state = State::None;
    }

    /// Whether one of them draws what needs this interpreter, now or once it has come.
    pub(super) fn serve(&self, needed: &Interpreter) -> bool {
        self.0.iter().any(|one| !matches!(one.state, State::None) && one.variant.covers(needed))
    }

    /// Whether the one that draws what needs this interpreter is being made.
    pub(super) fn are_coming(&self, needed: &Interpreter) -> bool {
        self.0.iter().any(|one| matches!(one.state, State::Coming) && one.variant.covers(needed))
    }

    /// The program that draws what needs this interpreter, if it is there.
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
    fn each_kind_is_asked_for_once_and_serves_until_the_driver_refuses_it() {
        let mut universal = UniversalInterpreters::new(true);
        let needed = Interpreter::universal(true);
        assert!(universal.serve(&needed) && !universal.are_coming(&needed));
        assert_eq!(universal.unasked(), Some(false), "distances first");
        assert!(universal.ask(true).is_some() && universal.ask(true).is_none());
        assert!(universal.are_coming(&needed));
        assert!(universal.ask(false).is_some());
        assert_eq!(universal.unasked(), None);
        universal.give_up(true);
        assert!(!universal.serve(&needed) && universal.find(&needed).is_none());
        assert_eq!(UniversalInterpreters::new(false).unasked(), None, "a software renderer has none");
    }
}
