//! Views of the shown scene: the chosen one, and its programs, which are compiled while the normal frame is shown.

use std::rc::Rc;
use std::sync::Arc;

use super::kept::KeptPrograms;
use super::prepared_scene::PreparedScene;
use super::program_task::ProgramOf;
use crate::frame::Frame;
use crate::gpu::{GpuError, Mode, Program, Renderer};
use crate::view::legend::{LegendPainter, LegendPicture};
use crate::view::setup::ViewSetup;
use crate::view::{View, ViewChoice};

#[derive(Default)]
pub(crate) struct Views {
    pub(crate) choice: Option<ViewChoice>,
    pub(super) programs: KeptPrograms,
    legends: Option<LegendPainter>,
    number: Option<f32>,
    pub(super) revision: u64,
}

impl Views {
    pub(super) fn starting_with(choice: Option<ViewChoice>) -> Self {
        Self { choice, ..Self::default() }
    }

    /// The chosen view of a scene, with a program and the program's mode. Prefers the given mode. Until the program of
    /// that mode is ready, uses the other mode, so that a view stays when the mode changes.
    pub(super) fn program(
        &mut self,
        scene: &PreparedScene,
        mode: Mode,
    ) -> Option<(ViewChoice, Mode, Rc<Program>)> {
        let choice = self.choice?;
        let other = if mode == Mode::Compiled { Mode::Interpreted } else { Mode::Compiled };
        [mode, other].into_iter().find_map(|mode| {
            let wanted = scene.program_of(mode)?;
            self.programs.covering(&wanted).map(|program| (choice, mode, program))
        })
    }

    /// Begins a view of a frame. Returns the legend to draw over it.
    pub(super) fn begin(
        &mut self,
        renderer: &mut Renderer,
        frame: &Frame,
        prepared: &PreparedScene,
        mode: Mode,
        choice: ViewChoice,
    ) -> Result<Option<Arc<LegendPicture>>, GpuError> {
        let scene = &prepared.resources;
        let setup = ViewSetup::of(choice, frame, scene.world(), scene.drawn(mode));
        self.number = setup.number;
        let legend = self.legends.get_or_insert_default().picture(setup.legend, frame.size);
        renderer.begin_view(frame, scene, &setup.block)?;
        Ok(legend)
    }

    /// The next or the previous view; `None` for the normal frame, which comes between the last and the first view.
    pub(super) fn beside(&self, forward: bool) -> Option<ViewChoice> {
        View::beside(self.choice.map(|choice| choice.view), forward).map(ViewChoice::from)
    }

    /// The same view with a larger or smaller number.
    ///
    /// # Errors
    /// Returns a message if no view is chosen or the view has no number.
    pub(super) fn stepped(&self, larger: bool) -> Result<ViewChoice, String> {
        let Some(choice) = self.choice else {
            return Err("only views have a number: press V for a view".to_owned());
        };
        if choice.view.row().number.is_none() {
            return Err(format!("the view {choice} has no number"));
        }
        Ok(choice.stepped(choice.number.or(self.number), larger))
    }

    pub(super) fn choose(&mut self, choice: Option<ViewChoice>) {
        self.choice = choice;
        if choice.is_some_and(|choice| choice.number.is_none()) {
            self.number = None;
        }
        self.revision += 1;
    }

    /// The program to request for the chosen view in a mode, if it is missing.
    pub(super) fn missing(&self, scene: &PreparedScene, mode: Mode) -> Option<ProgramOf> {
        self.choice?;
        self.programs.missing(scene, mode)
    }

    /// Takes a requested view program.
    pub(super) fn add(&mut self, of: ProgramOf, program: Program) {
        tracing::info!("views are ready");
        self.programs.add(of, program);
        self.revision += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_normal_frame_comes_between_the_last_and_the_first_view() {
        let mut views = Views::default();
        assert!(views.stepped(true).is_err());
        let mut count = 0;
        while let Some(next) = views.beside(true) {
            views.choose(Some(next));
            count += 1;
        }
        assert!(count > 1 && views.revision == count);
        views.choose(None);
        let last = views.beside(false);
        views.choose(last);
        assert!(last.is_some() && views.beside(true).is_none());
    }
}
