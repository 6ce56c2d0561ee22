//! Views of the scene on the stage, and the user's hand at its camera: which view is shown, and the programs that
//! draw it. They are made in parallel with the picture when they are first asked for; until one is there the picture
//! goes on.

use std::rc::Rc;
use std::sync::Arc;

use super::kept::KeptPrograms;
use super::{Cast, SceneStage, Task};
use crate::frame::Frame;
use crate::frame::orbit_controls::OrbitControls;
use crate::gpu::error::GpuError;
use crate::gpu::program::Program;
use crate::gpu::renderer::{Counting, Renderer};
use crate::gpu::scene_program::{Interpreter, Mode, as_views, compiled_variant_of};
use crate::view::legend::{LegendPainter, LegendPicture};
use crate::view::setup::ViewSetup;
use crate::view::{View, ViewChoice};

/// What a program of views draws.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum ViewsOf {
    /// A scene, compiled.
    Compiled(u64),
    /// Every scene that this interpreter covers.
    Interpreted(Interpreter),
}

impl ViewsOf {
    fn covers(&self, wanted: &Self) -> bool {
        match (self, wanted) {
            (ViewsOf::Compiled(id), ViewsOf::Compiled(wanted)) => id == wanted,
            (ViewsOf::Interpreted(known), ViewsOf::Interpreted(wanted)) => known.covers(wanted),
            _ => false,
        }
    }
}

/// The view that is shown, and what there is to draw it.
#[derive(Default)]
pub(super) struct Views {
    choice: Option<ViewChoice>,
    programs: KeptPrograms<ViewsOf>,
    legends: Option<LegendPainter>,
    /// The number of the view that was drawn last.
    number: Option<f32>,
}

impl Views {
    /// Shows this view from the start.
    pub(super) fn starting_with(choice: Option<ViewChoice>) -> Self {
        Self { choice, ..Self::default() }
    }

    /// The chosen view of a scene, with a program that draws it and that program's mode: the given mode or, until its
    /// program is there, the other one, so that a view stays when the mode changes.
    pub(super) fn program(&mut self, cast: &Cast, mode: Mode) -> Option<(ViewChoice, Mode, Rc<Program>)> {
        let choice = self.choice?;
        let other = if mode == Mode::Compiled { Mode::Interpreted } else { Mode::Compiled };
        [mode, other].into_iter().find_map(|mode| {
            let wanted = cast.views(mode)?;
            self.programs.find(|known| known.covers(&wanted)).map(|program| (choice, mode, program))
        })
    }

    /// Forgets the programs of scenes that are gone.
    pub(super) fn keep(&mut self, is_kept: impl Fn(u64) -> bool) {
        self.programs.retain(|of| match of {
            ViewsOf::Compiled(id) => is_kept(*id),
            ViewsOf::Interpreted(_) => true,
        });
    }

    /// The view that was chosen.
    pub(super) fn choice(&self) -> Option<ViewChoice> {
        self.choice
    }

    /// Begins a view of a frame, and returns the legend that is to be put over it.
    pub(super) fn begin(
        &mut self,
        renderer: &mut Renderer,
        frame: &Frame,
        (cast, mode): (&Cast, Mode),
        choice: ViewChoice,
    ) -> Result<Option<Arc<LegendPicture>>, GpuError> {
        let scene = &cast.resources;
        let setup = ViewSetup::of(choice, frame, scene.world(), scene.drawn(mode));
        self.number = setup.number;
        let legend = self.legends.get_or_insert_default().picture(setup.legend, frame.size);
        renderer.begin_view(frame, scene, &setup.block)?;
        Ok(legend)
    }
}

impl Cast {
    /// What a program must draw to show views of this scene.
    fn views(&self, mode: Mode) -> Option<ViewsOf> {
        match mode {
            Mode::Compiled => Some(ViewsOf::Compiled(self.id)),
            Mode::Interpreted => self.interpreter.clone().map(ViewsOf::Interpreted),
        }
    }
}

impl SceneStage {
    /// The view that was chosen.
    pub(crate) fn view(&self) -> Option<ViewChoice> {
        self.views.choice
    }

    /// Shows the next view, or the one before; the plain picture is between the last and the first.
    pub(crate) fn go_view(&mut self, forward: bool) {
        let next = View::beside(self.views.choice.map(|choice| choice.view), forward);
        self.show_view(next.map(ViewChoice::from));
    }

    /// Shows the same view with a larger or smaller number.
    pub(crate) fn step_view(&mut self, larger: bool) {
        let Some(choice) = self.views.choice else {
            return self.tell("only views have a number: press V for a view".to_owned());
        };
        if choice.view.row().number.is_none() {
            return self.tell(format!("the view {choice} has no number"));
        }
        self.show_view(Some(choice.stepped(choice.number.or(self.views.number), larger)));
    }

    fn show_view(&mut self, choice: Option<ViewChoice>) {
        self.views.choice = choice;
        if choice.is_some() {
            self.fading.cut();
        }
        if choice.is_some_and(|choice| choice.number.is_none()) {
            self.views.number = None;
        }
        self.revision += 1;
        self.regions.insist(choice.is_some());
        self.ask_for_view();
        let ready =
            self.on_stage.as_ref().zip(self.mode()).and_then(|(cast, mode)| self.views.program(cast, mode));
        self.tell(match choice {
            None => "the picture".to_owned(),
            Some(choice) if ready.is_some() => format!("view: {choice}"),
            Some(choice) => format!("view: {choice}; the driver is preparing it"),
        });
    }

    /// Requests the program of the view that is shown, if it is neither there nor being made.
    pub(super) fn ask_for_view(&mut self) {
        if self.views.choice.is_none() {
            return;
        }
        let Some((cast, mode)) = self.on_stage.as_ref().zip(self.mode()) else { return };
        let Some(wanted) = cast.views(mode) else { return };
        let mut asked = self.tasks.values().filter_map(|task| match task {
            Task::Views(asked) => Some(asked),
            _ => None,
        });
        if self.views.programs.has(|known| known.covers(&wanted)) || asked.any(|asked| asked.covers(&wanted))
        {
            return;
        }
        let mut job = match wanted.clone() {
            ViewsOf::Compiled(_) => {
                let world = cast.resources.world().clone();
                self.job(cast, move || compiled_variant_of(&world, Counting::On).map(as_views))
            }
            ViewsOf::Interpreted(variant) => {
                self.job(cast, move || Ok(as_views(variant.variant(Counting::On))))
            }
        };
        job.draws_views = true;
        tracing::info!("views of {} are requested, {mode}", cast.source.title());
        self.submit(job, Task::Views(wanted));
    }

    /// Takes the requested program of views.
    pub(super) fn take_views(&mut self, of: ViewsOf, program: Result<Program, GpuError>) {
        self.revision += 1;
        match program {
            Ok(program) => {
                tracing::info!("views are ready");
                self.views.programs.add(of, program);
            }
            Err(error) => {
                tracing::warn!("{error}");
                self.views.choice = None;
                self.regions.insist(false);
                self.problem = Some(("this driver cannot show views".to_owned(), error.to_string()));
            }
        }
    }

    /// Moves the camera by hand; the first move also tells the user how to return.
    pub(crate) fn move_camera(&mut self, change: impl FnOnce(&mut OrbitControls, f64)) {
        let was_off = self.hand == OrbitControls::OFF;
        if was_off {
            // From where a show has it.
            self.hand = self.shown_hand;
        }
        change(&mut self.hand, self.own_pitch);
        if was_off && self.hand != OrbitControls::OFF {
            self.tell("you are moving the camera: press Home to return to the scene's own".to_owned());
        }
        self.revision += 1;
    }

    /// Gives the camera back to the scene.
    pub(crate) fn give_camera_back(&mut self) {
        self.hand = OrbitControls::OFF;
        self.tell("the scene's own camera".to_owned());
        self.revision += 1;
    }
}
