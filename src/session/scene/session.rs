//! The entry point to everything about scenes: it passes the results of one part to the others.

use std::time::{Duration, Instant};

use super::ahead::PreparedAhead;
use super::composer::{Drawn, Ingredients, SceneComposer, WantedPicture};
use super::context_change::{DrawingWays, KeptScenes, SceneLoaders, TakenOver};
use super::decks::Decks;
use super::library::SceneLibrary;
use super::messages::Messages;
use super::on_decks::DeckChanges;
use super::parameters::{Parameters, ParametersInHand, TurnedParameters};
use super::preparation::ScenePreparation;
use super::prepared_scene::{LoadedScene, PreparedScene};
use super::prepared_scenes::{Place, PreparedScenes};
use super::preview::NextPicture;
use super::program_library::ProgramLibrary;
use super::refinement::Refinement;
use super::refusal::{Refusal, TREE_TOO_LONG};
use super::region_builder::{BuiltTree, RegionBuilder};
use super::regions::SceneRegions;
use super::show_follower::{Circumstances, ShowFollower, Step};
use crate::clock;
use crate::frame::orbit_controls::OrbitControls;
use crate::gpu::background::ProgramProduct;
use crate::gpu::{CellUse, Gl, GpuError, Mode, PictureReader, Renderer, Sketch, Sources, WorkerContext};
use crate::moving_textures::LiveTextures;
use crate::scenes::SceneSource;
use crate::song_shapes::LiveSongShapes;
use crate::ui::overlay::{OverlayContent, PanelSwitches};
use crate::view::ViewChoice;
use mariana_control::{Model, ParamChange};
use mariana_music::Sound;
use mariana_player::Moment;

mod refining;

pub(crate) struct SceneSession {
    pub(crate) scenes: PreparedScenes,
    pub(crate) show: ShowFollower,
    pub(crate) parameters: Parameters,
    pub(crate) messages: Messages,
    pub(crate) composer: SceneComposer,
    next_picture: NextPicture,
    refinement: Refinement,
    pub(super) decks: Option<Decks>,
    announced: Option<(u64, Mode)>,
    // The last field, because the compiler's threads draw with objects of the fields above.
    pub(crate) preparation: ScenePreparation,
}

impl SceneSession {
    /// Prepares the first scene, which a loader watches. `wake` is called when a thread has a result.
    pub(crate) fn new(
        gl: &Gl,
        contexts: Vec<WorkerContext>,
        sources: Sources,
        ways: DrawingWays,
        loaders: SceneLoaders,
        first: LoadedScene,
        wake: impl Fn() + Send + Sync + Clone + 'static,
    ) -> Result<Self, GpuError> {
        let no_worker = |error: std::io::Error| GpuError::NoWorker(error.to_string());
        let regions = SceneRegions::start(wake.clone()).map_err(no_worker)?;
        let next_picture = NextPicture::start(wake.clone()).map_err(no_worker)?;
        let LoadedScene { source, scene } = first;
        let library = SceneLibrary::new(loaders.shown, source.clone());
        let trials = RegionBuilder::start(wake.clone()).map_err(no_worker)?;
        let textures = LiveTextures::new(wake.clone());
        let song_shapes = LiveSongShapes::start(wake.clone()).map_err(no_worker)?;
        let programs = ProgramLibrary::start(gl, contexts, sources, ways.projection, wake);
        let preparation = ScenePreparation::new(gl, ways.choice, library, trials, programs);
        let mut session = Self {
            scenes: PreparedScenes::with(PreparedAhead::with(loaders.ahead)),
            show: ShowFollower::default(),
            parameters: Parameters::new(Model::default(), clock::now()),
            messages: Messages::default(),
            composer: SceneComposer::new(regions, textures, song_shapes, ways),
            next_picture,
            refinement: Refinement::default(),
            decks: None,
            announced: None,
            preparation,
        };
        session.preparation.prepare(source, scene, &mut session.scenes)?;
        session.show_what_is_ready();
        Ok(session)
    }

    /// Drops everything that belongs to the OpenGL context, and returns the state for another session.
    pub(crate) fn let_go(self) -> KeptScenes {
        let PreparedScenes { shown, coming, ahead, .. } = self.scenes;
        let (choice, view) = (self.preparation.choice, self.composer.views.choice);
        let (projection, fade) = (self.composer.projection, self.composer.fading.seconds());
        let SceneLibrary { loader, wanted, .. } = self.preparation.library;
        KeptScenes {
            loaders: SceneLoaders { shown: loader, ahead: ahead.into_loaders() },
            shown: shown.or(coming).map(PreparedScene::into_loaded),
            ways: DrawingWays { choice, view, projection, fade },
            taken_over: TakenOver { parameters: self.parameters, wanted, show: self.show, decks: self.decks },
        }
    }

    /// Continues where another session ended: with its parameter values, its requested scene, its show and its decks.
    pub(crate) fn adopt(&mut self, from: TakenOver) {
        let TakenOver { parameters, wanted, show, decks } = from;
        (self.parameters, self.show, self.decks) = (parameters, show, decks);
        self.preparation.library.adopt(wanted);
    }

    /// The parameters of the scene in hand: the shown scene, or the scene on the deck in hand.
    pub(crate) fn parameters_in_hand(&self) -> ParametersInHand<'_> {
        let scene = self.scenes.in_hand(self.decks.as_ref().map(Decks::scene_in_hand));
        ParametersInHand { scene, show: &self.show, parameters: &self.parameters }
    }

    pub(crate) fn parameters_in_hand_mut(&mut self) -> Option<TurnedParameters<'_>> {
        let scene = self.scenes.in_hand_mut(self.decks.as_ref().map(Decks::scene_in_hand))?;
        Some(TurnedParameters::of(scene, &self.show, &mut self.parameters))
    }

    /// Applies `change` to a parameter of the scene in hand. Returns `false` if there is none of this name.
    pub(crate) fn turn(&mut self, change: &ParamChange) -> bool {
        self.parameters_in_hand_mut().is_some_and(|mut turned| turned.turn(change))
    }

    /// The decks and the time of their clock, in seconds; `None` while there is one scene.
    pub(crate) fn decks(&self) -> Option<(&Decks, f64)> {
        Some((self.decks.as_ref()?, self.parameters.clock()))
    }

    pub(crate) fn deck_changes(&mut self) -> DeckChanges<'_> {
        DeckChanges(self)
    }

    pub(crate) fn toggle_decks(&mut self) {
        if self.decks.is_none() && !self.scenes.ahead.is_on() {
            let words = "two decks need scenes that are prepared in advance: allow this in the settings (G)";
            return self.messages.answer(words);
        }
        if self.decks.is_none() {
            return self.deck_changes().begin();
        }
        if let Some(stays) =
            self.deck_changes().end().filter(|stays| stays != &self.preparation.library.wanted)
        {
            self.composer.fading.next = None;
            self.request_scene(stays);
        }
    }

    /// Takes the results of the loader and the compilers.
    ///
    /// # Errors
    /// Fails if the driver rejects a scene, and no other scene can be shown.
    pub(crate) fn update(&mut self) -> Result<(), GpuError> {
        while let Some(loaded) = self.preparation.library.poll() {
            if loaded.value.is_ok() {
                self.messages.problem = None;
            }
            match self.preparation.receive_loaded(loaded.value, &mut self.scenes)? {
                None => self.show_what_is_ready(),
                Some(refusal) => self.refuse(refusal),
            }
        }
        self.preparation.forget_obsolete(&self.scenes);
        while let Some((task, program)) = self.preparation.programs.poll() {
            if task.product != ProgramProduct::Frames {
                self.receive_special(task, program);
                continue;
            }
            let (scenes, messages) = (&mut self.scenes, &mut self.messages);
            let refused = self.preparation.receive_program(&task, program, scenes, messages)?;
            refused.into_iter().for_each(|refusal| self.refuse(refusal));
        }
        while let Some(BuiltTree { tag, regions, .. }) = self.preparation.trials.poll() {
            match self.preparation.receive_tree(tag, regions, &mut self.scenes) {
                Ok(None) => {}
                Ok(Some(id)) => self.composer.regions.late_for = Some((id, Mode::Compiled)),
                Err(refusal) => self.refuse(refusal),
            }
        }
        self.preparation.settle_numbers(&mut self.scenes);
        self.show_what_is_ready();
        self.preparation.prepare_for_edits(&self.scenes);
        self.preparation.receive_loaded_ahead(&mut self.scenes);
        if self.is_complete() {
            let wanted = self.show.wanted_ahead(&self.preparation.library.wanted);
            self.preparation.prepare_ahead(wanted, &mut self.scenes);
        }
        // Scenes may have gone since.
        self.preparation.forget_obsolete(&self.scenes);
        self.preparation.report_slow_programs(&self.scenes, &mut self.messages);
        Ok(())
    }

    /// Handles a scene that cannot be drawn: shows a message, or silently another scene if the director chose it.
    fn refuse(&mut self, refusal: Refusal) {
        self.messages.hint = None;
        let Refusal { source, heading, text } = refusal;
        let is_edit = self.scenes.shown_source() == Some(&source);
        if is_edit || self.preparation.library.is_written || !self.show.is_own_choice() {
            self.messages.set_problem(heading, text);
        } else {
            self.show.refuse(source);
        }
    }

    fn show_what_is_ready(&mut self) {
        self.preparation.give_interpreters(&mut self.scenes);
        let is_version = |scene: &PreparedScene| self.scenes.is_version_of_shown(scene);
        let must_wait = self.composer.must_finish() && self.scenes.coming.as_ref().is_some_and(is_version);
        if self.preparation.can_show_coming(&self.scenes) && !must_wait {
            self.show_coming();
        }
        self.composer.views.programs.keep(&self.scenes.ids());
        self.request_view();
        self.request_paths();
        self.preparation.request_cells(&self.scenes);
        self.announce();
    }

    fn show_coming(&mut self) {
        let replaced = std::mem::replace(&mut self.scenes.shown, self.scenes.coming.take());
        let Some(shown) = &self.scenes.shown else { return };
        let is_another = replaced.as_ref().is_some_and(|replaced| replaced.title() != shown.title());
        if let Some(left) = replaced.as_ref().filter(|_| is_another) {
            let (took, orbit) = (self.composer.pictures.took(), self.composer.camera.orbit);
            self.composer.change.save_outgoing(left, took, orbit, &self.show, &self.parameters);
        }
        // Do not keep a scene that was never drawn.
        if self.composer.pictures.scene == replaced.as_ref().map(|scene| scene.id) {
            self.scenes.before = replaced;
        }
        // Controllers may have changed the scene's parameters since the request.
        self.update_sliders();
        self.messages.hint = None;
        if is_another {
            let (composer, of) = self.composing();
            composer.fade_if_it_can(of);
            if !self.show.asks_for(&self.preparation.library.wanted) {
                let words =
                    self.scenes.shown_source().map(|source| self.preparation.library.placed_name(source));
                self.messages.answer(words.unwrap_or_default());
            }
            self.composer.camera.orbit = OrbitControls::OFF;
        }
        let warning = self.scenes.shown.as_mut().and_then(|shown| shown.warning.take());
        warning.into_iter().for_each(|warning| self.messages.answer(warning));
    }

    fn announce(&mut self) {
        let now = self.drawn().map(|(scene, mode)| (scene.id, mode));
        let before = self.announced;
        if now == before {
            return;
        }
        self.announced = now;
        self.composer.redraw();
        let Some((name, (id, mode))) = self.scenes.name().zip(now) else { return };
        tracing::info!("{name} is shown, {mode}");
        let has_come = before.is_some_and(|(known, _)| known == id)
            && self.preparation.asked_mode.take_if(|asked| *asked == mode).is_some();
        if has_come {
            self.messages.answer(mode.to_string());
        }
    }

    fn composing(&mut self) -> (&mut SceneComposer, Ingredients<'_>) {
        let (scenes, show, parameters) = (&self.scenes, &self.show, &self.parameters);
        let choice = self.preparation.choice;
        (&mut self.composer, Ingredients { scenes, show, parameters, choice })
    }

    /// Draws the shown scene or continues the frame in progress ([`SceneComposer::resume`]). Requests missing resources.
    /// Keeps scenes that are neither shown nor fading out only as neighbours.
    pub(crate) fn draw(
        &mut self,
        renderer: &mut Renderer,
        picture: WantedPicture<'_>,
    ) -> Result<Option<Drawn>, GpuError> {
        let (go, revision) = (self.preparation.library.length_of_go(), self.revision());
        let (composer, of) = self.composing();
        if composer.give_up_another(of, &picture)
            && of.scenes.fading_out.is_some()
            && !composer.fades_out(of, &picture.moment, Place::FadingOut)
        {
            self.scenes.end_fade();
        }
        let (composer, of) = self.composing();
        let drawn = composer.resume(of, renderer, &picture, go, revision)?;
        if let Some(drawn) = drawn.as_ref().filter(|_| of.scenes.before.is_some()) {
            // The previous scene is kept for its fade, or as a neighbour.
            let fades_out = composer.fades_out(of, &drawn.shown.moment, Place::Before);
            match self.scenes.before.take() {
                Some(before) if fades_out => self.scenes.fade_out(before),
                Some(before) => self.scenes.ahead.keep(before),
                None => {}
            }
        }
        if drawn.is_some() {
            self.preparation.programs.has_shown = true;
        } else if self.composer.regions.given_up.take_if(|id| self.scenes.shown_id() == Some(*id)).is_some() {
            self.withdraw(TREE_TOO_LONG);
        }
        Ok(drawn)
    }

    /// Removes a scene whose first frame is too slow ([`ScenePreparation::withdraw`]); returns to the previous scene.
    pub(crate) fn withdraw(&mut self, why: &str) {
        let Some((mode, before)) = self.mode().zip(self.scenes.before.take()) else { return };
        let Some(expensive) = self.scenes.shown.replace(before) else { return };
        self.composer.give_picture_up();
        self.composer.fading.cut();
        self.composer.redraw();
        let refusal = self.preparation.withdraw(expensive, mode, why, &mut self.scenes);
        self.show_what_is_ready();
        if let Some(refusal) = refusal {
            self.refuse(refusal);
        }
    }

    pub(crate) fn rehearse(&mut self, renderer: &mut Renderer) {
        if self.is_complete() {
            self.scenes.ahead.rehearse(self.preparation.choice.sdf, renderer);
        }
    }

    /// Draws a hidden frame of the next scene for `reader`. Returns the scene's title if a frame was drawn.
    pub(crate) fn preview(
        &mut self,
        renderer: &mut Renderer,
        sketch: &mut Sketch,
        reader: &mut PictureReader,
        heard: (f64, Sound),
    ) -> Result<Option<String>, GpuError> {
        if !self.is_complete() {
            return Ok(None);
        }
        let (scenes, show, parameters) = (&self.scenes, &self.show, &self.parameters);
        let of = Ingredients { scenes, show, parameters, choice: self.preparation.choice };
        self.next_picture.draw(of, renderer, sketch, reader, heard.0, heard.1)
    }

    pub(super) fn is_complete(&self) -> bool {
        let PreparedScenes { shown: Some(shown), coming: None, before: None, .. } = &self.scenes else {
            return false;
        };
        shown.source == self.preparation.library.wanted
            && self.composer.rests_on(shown.id)
            && self.preparation.programs.is_idle()
    }

    pub(crate) fn step_scene(&mut self, forward: bool) {
        let of_deck = self.deck_changes().neighbour(forward);
        self.show_source(of_deck.unwrap_or_else(|| {
            self.preparation.library.next_after(&self.preparation.library.wanted, forward)
        }));
    }

    /// Shows a scene. With decks, loads it into the deck that is less visible.
    pub(crate) fn show_source(&mut self, source: SceneSource) {
        let Some(source) = self.deck_changes().load_cued(source) else { return };
        self.show.overrule();
        self.composer.fading.next = None;
        self.request_scene(source);
    }

    /// Replaces the scene `replaced` by `source`, on the same deck. Returns `false` if `source` is on the other deck.
    pub(crate) fn replace_scene(&mut self, replaced: &SceneSource, source: SceneSource) -> bool {
        let mut decks = self.decks.iter().flat_map(Decks::scenes);
        match decks.position(|scene| scene == replaced) {
            Some(deck) => self.deck_changes().load(deck, source),
            None => {
                self.show_source(source);
                true
            }
        }
    }

    /// Requests a scene, and shows a hint if the user has to wait for it.
    fn request_scene(&mut self, source: SceneSource) {
        let is_prepared = self.preparation.request_scene(source, &mut self.scenes);
        let wanted = &self.preparation.library.wanted;
        let waits = self.scenes.shown_source() != Some(wanted) && !self.show.asks_for(wanted);
        let hint = waits.then(|| format!("{} is being prepared", wanted.title()));
        self.messages.hint = hint;
        if is_prepared {
            self.messages.problem = None;
            self.show_what_is_ready();
        }
    }

    pub(crate) fn follow(&mut self, time: f64) {
        let now = Circumstances {
            wanted: &self.preparation.library.wanted,
            is_written: self.preparation.library.is_written,
            is_awaited: self.messages.hint.is_some(),
            sdf: self.preparation.choice.sdf,
        };
        if let Some(decks) = &self.decks {
            let now = self.parameters.clock();
            self.show.set_fader(decks.fader(now));
            if decks.moves(now) {
                self.parameters.revision += 1;
            }
        }
        let step = self.show.follow(time, &mut self.scenes, &now);
        let Some(Step { source, seconds }) = step else { return };
        let duration = |seconds| Duration::try_from_secs_f64(seconds).unwrap_or_default();
        self.composer.fading.next = seconds.map(duration);
        self.request_scene(source);
    }

    pub(crate) fn follow_controllers(&mut self, moment: &Moment) {
        if self.composer.change.begun.is_some() {
            return;
        }
        self.parameters.seek(moment);
        self.update_sliders();
        if self.parameters_in_hand().are_turning() {
            self.parameters.revision += 1;
        }
    }

    fn update_sliders(&mut self) {
        if let Some(shown) = &mut self.scenes.shown {
            TurnedParameters::of(shown, &self.show, &mut self.parameters).update_sliders();
        }
        if self.decks.is_some() {
            self.parameters_in_hand_mut().into_iter().for_each(|mut turned| turned.update_sliders());
        }
    }

    pub(crate) fn toggle_mode(&mut self) {
        let Some(mode) = self.mode() else { return };
        let wanted = self.preparation.toggle_mode(mode, &mut self.scenes);
        self.show_what_is_ready();
        let now = self.mode();
        let has_interpreter = |scene: &PreparedScene| scene.programs.interpreter.is_some();
        let possible = wanted == Mode::Compiled || self.scenes.shown.as_ref().is_some_and(has_interpreter);
        self.preparation.asked_mode = Some(wanted).filter(|_| possible && now != Some(wanted));
        self.messages.answer(match now {
            Some(now) if now == wanted => now.to_string(),
            _ if possible => format!("{wanted}: the driver is preparing it"),
            _ => "the tape exceeds this driver's limits: the scene stays compiled".to_owned(),
        });
        self.composer.redraw();
    }

    pub(crate) fn toggle_regions(&mut self) {
        let drawn = self.scenes.drawn(self.preparation.choice.sdf);
        let cells = self.composer.regions.toggle(drawn, self.preparation.choice.cells);
        self.preparation.choice.cells = cells;
        let words = if cells == CellUse::Never { "no regions" } else { "regions" };
        self.messages.answer(words);
        self.composer.redraw();
    }

    pub(crate) fn switch_view(&mut self, forward: bool) {
        self.show_view(self.composer.views.beside(forward));
    }

    pub(crate) fn step_view(&mut self, larger: bool) {
        match self.composer.views.stepped(larger) {
            Ok(choice) => self.show_view(Some(choice)),
            Err(words) => self.messages.answer(words),
        }
    }

    fn show_view(&mut self, choice: Option<ViewChoice>) {
        self.composer.show_view(choice);
        self.request_view();
        let drawn = self.scenes.drawn(self.preparation.choice.sdf);
        let ready = drawn.and_then(|(scene, mode)| self.composer.views.program(scene, mode));
        self.messages.answer(match choice {
            None => "views are off".to_owned(),
            Some(choice) if ready.is_some() => format!("view: {choice}"),
            Some(choice) => format!("view: {choice}; the driver is preparing it"),
        });
    }

    pub(crate) fn move_camera(&mut self, change: impl FnOnce(&mut OrbitControls, f64)) {
        if let Some(words) = self.composer.camera.move_by(change) {
            self.messages.answer(words);
        }
    }

    pub(crate) fn give_camera_back(&mut self) {
        self.messages.answer(self.composer.camera.give_back());
    }

    pub(crate) fn fade_from_held(&mut self, seconds: f64) {
        let (composer, of) = self.composing();
        composer.fade_from_held(seconds, of);
    }

    /// Returns the time until which drawing waits for a changed text; `None` if it need not wait, or if the frame in
    /// progress must be finished.
    pub(crate) fn awaits_edit(&self, now: Instant) -> Option<Instant> {
        self.preparation.library.edit.until(now).filter(|_| !self.composer.must_finish())
    }

    pub(crate) fn record_frame_time(&mut self, time: Duration) {
        let (composer, of) = self.composing();
        composer.record_frame_time(time, of);
    }

    pub(crate) fn revision(&self) -> u64 {
        self.composer.revision() + self.parameters.revision + self.show.revision
    }

    pub(crate) fn moves_by_itself(&self) -> bool {
        let shown = self.scenes.shown.as_ref();
        self.show.has_prepared_show()
            || self.composer.fading.follows_song()
            || shown.is_none_or(|scene| scene.moves || scene.is_blend())
            || self.parameters_in_hand().follow_sound()
    }

    /// The shown scene, or the requested one before a scene is shown.
    pub(crate) fn present_source(&self) -> &SceneSource {
        self.scenes.shown_source().unwrap_or(&self.preparation.library.wanted)
    }

    /// The requested scene, the second scene of a transition, or the scene on the more visible deck.
    pub(crate) fn foremost(&self) -> &SceneSource {
        match (&self.decks, &self.preparation.library.wanted) {
            (Some(decks), _) => decks.foremost(self.parameters.clock()),
            (None, SceneSource::Blend(blend)) => &blend.to.source,
            (None, source) => source,
        }
    }

    /// The scenes on the decks, or the shown scene.
    pub(crate) fn played(&self) -> &[SceneSource] {
        let shown = || self.scenes.shown_source().map(std::slice::from_ref).unwrap_or_default();
        self.decks.as_ref().map_or_else(shown, |decks| decks.scenes())
    }

    /// The shown scene, and the mode in which it is drawn now.
    pub(super) fn drawn(&self) -> Option<(&PreparedScene, Mode)> {
        self.scenes.drawn(self.preparation.choice.sdf)
    }

    pub(super) fn mode(&self) -> Option<Mode> {
        Some(self.drawn()?.1)
    }

    /// What the overlay shows of the scene, with the status line `corner`.
    pub(crate) fn content<'a>(
        &'a self,
        corner: Option<&'a str>,
        panels: PanelSwitches,
    ) -> OverlayContent<'a> {
        let sliders = self.parameters_in_hand().sliders();
        let params = Some(sliders).filter(|sliders| panels.sliders && !sliders.is_empty());
        let is_ready = |source: &SceneSource| self.scenes.has_ready(source, self.preparation.choice.sdf);
        let decks = self.decks().map(|(decks, now)| decks.strip(now, is_ready));
        OverlayContent { corner, params, decks, ..self.messages.content() }
    }
}
