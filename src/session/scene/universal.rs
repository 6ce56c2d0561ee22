//! The interpreters that draw nearly every scene: one for distances, one for all other formulas. On a GPU they are there
//! before anyone edits, so that no edit waits for a compiler. A software renderer, which never skips a branch, has
//! interpreters of scenes' own only.
//!
//! ```text
//! universal interpreter ─ refused ─► interpreter of the scene's own ─ refused ─► compiled only
//! ```

use std::rc::Rc;

use super::{Cast, SceneStage, Task};
use crate::config::SdfChoice;
use crate::gpu::error::GpuError;
use crate::gpu::program::Program;
use crate::gpu::renderer::Counting;
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
        Self([false, true].map(|steep| UniversalInterpreter {
            variant: Interpreter::universal(steep),
            state: if are_wanted { State::Unasked } else { State::None },
        }))
    }

    /// The one for this kind of formula.
    fn of(&mut self, steep: bool) -> &mut UniversalInterpreter {
        let [of_distances, of_others] = &mut self.0;
        if steep { of_others } else { of_distances }
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

impl SceneStage {
    /// Requests the universal interpreter for this kind of formula, unless that was done. `cast` is what its first
    /// picture shows.
    pub(super) fn ask_for_universal(&mut self, steep: bool, id: u64) {
        let one = self.universal.of(steep);
        if !matches!(one.state, State::Unasked) {
            return;
        }
        let variant = one.variant.clone();
        let Some(cast) = self.cast(id) else { return };
        let mut job = self.job(cast, move || Ok(variant.variant(Counting::Off)));
        job.can_be_given_up = true;
        tracing::info!("the universal interpreter is requested{}", of_kind(steep));
        self.submit(job, Task::Universal { steep });
        self.universal.of(steep).state = State::Coming;
    }

    /// Requests what no scene has needed so far, once there is nothing else to do.
    pub(super) fn prepare_for_edits(&mut self) {
        let is_idle = self.tasks.is_empty() && self.pictured.is_some();
        if !is_idle || self.choice == SdfChoice::Compiled {
            return;
        }
        let Some(id) = self.on_stage.as_ref().map(|cast| cast.id) else { return };
        let unasked =
            [false, true].into_iter().find(|steep| matches!(self.universal.of(*steep).state, State::Unasked));
        if let Some(steep) = unasked {
            self.ask_for_universal(steep, id);
        }
    }

    /// Takes the requested interpreter, or the fact that the driver refuses it: then scenes get their own ones.
    pub(super) fn take_universal(&mut self, steep: bool, program: Result<Program, GpuError>) {
        let state = &mut self.universal.of(steep).state;
        let error = match program {
            Ok(program) => {
                *state = State::There(Rc::new(program));
                tracing::info!("the universal interpreter is ready{}", of_kind(steep));
                return;
            }
            Err(error) => error,
        };
        *state = State::None;
        let sentence = "this driver has no interpreter for all scenes: each scene gets its own";
        match &error {
            GpuError::GivenUp { .. } => tracing::warn!("{sentence}; {error}"),
            _ => {
                tracing::warn!("{sentence}");
                tracing::info!("{error}");
            }
        }
        self.quiet.note(sentence.to_owned(), None);
        let waits = |cast: &&Cast| {
            let steep_too = cast.interpreter.as_ref().is_some_and(|needed| needed.is_steep() == steep);
            steep_too && cast.interpreted.is_none()
        };
        let waiting = [&self.on_stage, &self.coming].into_iter().flatten().filter(waits);
        for id in waiting.map(|cast| cast.id).collect::<Vec<_>>() {
            self.ask_for_interpreter(id);
        }
    }
}

/// What the log adds for formulas that are no distances.
fn of_kind(steep: bool) -> &'static str {
    if steep { ", for formulas that are no distances" } else { "" }
}
