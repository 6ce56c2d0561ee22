//! Draws the window: the scene's frame if it must change, and the overlay over it.

use std::time::{Duration, Instant};

use super::ui_state::Seen;
use super::{Interface, Playback, Session};
use crate::clock;
use crate::commands::Panel;
use crate::gpu::error::GpuError;
use crate::scenes::SceneSource;
use crate::session::SessionError;
use crate::session::drawing_pace::Verdict;
use crate::session::dynamic_resolution::Level;
use crate::session::lay::Lay;
use crate::session::listening::Listening;
use crate::session::scene::{Drawn, SceneSession, Shown, WantedPicture, report};
use crate::session::screen::Screen;
use crate::ui::open_panel::OpenPanel;
use crate::ui::overlay::{Overlay, OverlayContent, Painted, PanelSwitches};
use mariana_player::Moment;

/// Interval at which a window without a frame is repainted. Its bars follow the sound.
const WAITING_AGAIN: Duration = Duration::from_millis(33);
/// The longest that the song waits for the first frame.
const SONG_WAIT: Duration = Duration::from_millis(500);

impl Session {
    /// Draws the window, or a part of a slow frame. Returns `true` for the first frame, which starts the song.
    pub(super) fn draw(&mut self) -> Result<bool, SessionError> {
        if let Some(seconds) = self.playback.first_shown_after.take() {
            // Compile the limiter's programs only after the first frame, which is never dimmed.
            self.playback.renderer.limit_flashes(seconds)?;
        }
        let begun = clock::now();
        // A frame that waited for its regions has already been counted.
        if !self.playback.scene.composer.regions.have_come() && !self.playback.scene.composer.is_drawing() {
            self.playback.pace.pacing.begun(begun, self.playback.controllers.unseen.is_some());
        }
        let size = self.screen.size();
        let placement = self.choices.stage.placement();
        let screen = self.screen.picture_size().map(|screen| (screen, placement.picture_size(screen)));
        self.playback.pace.window_size = screen.map(|(_, whole)| whole);
        let Some((screen, whole)) = screen else { return Ok(false) };
        let Some((size, moment)) = size.and_then(|size| Some((size, self.playback.moment()?))) else {
            return Ok(false);
        };
        if let Some(pointer) = self.interface.pointer_over_picture(size) {
            let is_followed = self.playback.scene.scenes.follow_pointer();
            self.playback.scene.composer.point(pointer, is_followed);
        }
        // Note this during slow frames too: the show must not look idle, because an idle show restarts its frame.
        self.playback.pace.record_wanted(Some(moment), self.playback.scene.revision(), begun);
        let side_max = self.playback.side_max(&*self.screen);
        let (level, drawn) = self.pictures.level(self.playback.level(begun), whole, side_max);
        if self.playback.scene.scenes.shown.is_none() {
            return self.show_waiting(size).map(|()| false);
        }
        let wanted =
            Shown { moment, size: drawn, edges: level.edges, revision: self.playback.scene.revision() };
        // While the output is frozen, the shown frame is the wanted frame.
        let held = self.playback.holds_picture();
        let wanted = self.playback.pace.shown.filter(|_| held).unwrap_or(wanted);
        let new = self.playback.draw_picture(wanted, level, whole, begun)?;
        let Some(dims) = self.playback.finish_picture(new.as_ref(), begun)? else { return Ok(false) };
        // A slow frame of a moving scene shows an earlier moment than the wanted one.
        let is_alike = |shown: &Shown| {
            let Shown { moment, revision, .. } = *shown;
            *shown == Shown { moment, revision, ..wanted }
        };
        let drawn = new.as_ref().map(|new| new.shown).filter(is_alike);
        let stands = self.playback.pace.shown.filter(|shown| *shown == wanted);
        if let Some(shown) = drawn.or(stands).filter(|_| !self.playback.scene.composer.is_drawing()) {
            self.save_picture(shown.moment.song_time, whole);
        }
        let lay = Lay { placement, screen, is_held: held };
        self.present(Picture { wanted, new, dims, level, begun }, &lay, size)
    }

    /// Returns `true` once an idle show is drawn in its best quality. A frozen frame is always at rest.
    pub(super) fn is_at_rest(&self, now: Instant) -> bool {
        let playback = &self.playback;
        let is_drawn = !playback.scene.composer.is_drawing() && !playback.could_be_better(&*self.screen, now);
        playback.holds_picture() || playback.pace.stands_still(now) && is_drawn && !playback.refines(now)
    }

    /// Shows the frame and the overlay, if either has changed. Returns `true` for the first frame.
    fn present(&mut self, picture: Picture, lay: &Lay, size: (u32, u32)) -> Result<bool, SessionError> {
        let Picture { wanted, new, dims, level, begun } = picture;
        let is_drawing = self.playback.scene.composer.is_drawing();
        let area = self.interface.update_area(&mut *self.screen, lay, size);
        let map = lay.map(&self.playback.renderer, area);
        self.interface.update_map(&mut self.playback, map, size);
        if let Some(OpenPanel::Corners(handles)) = &mut self.interface.ui_state.panel {
            handles.area = area;
        }
        self.interface.update_scene(&mut self.playback);
        let seen = self.interface.update_ui_state(&mut self.playback, &mut *self.screen, begun);
        let Playback { ref scene, ref controllers, ref listening, ref reports, .. } = self.playback;
        let mut content =
            self.interface.ui_state.content(&seen, scene, controllers, listening, reports, begun);
        content.next =
            self.playback.preview.next.as_ref().filter(|_| !self.interface.ui_state.hidden.is_bare());
        content.ray = self.interface.probing.ray_view();
        let Some(shown) = new.as_ref().map(|new| new.shown).or(self.playback.pace.shown) else {
            return self.show_waiting(size).map(|()| false);
        };
        let handing_over = clock::now();
        // While a new frame is in progress, paint only if the overlay or the window has changed.
        let waits = new.is_none() && !dims && (shown != wanted || is_drawing);
        let has_words = self.interface.overlay.due(&content, begun).is_some_and(|due| due <= begun)
            && self.screen.shows_words();
        if waits && !self.screen.is_stale() && !has_words {
            return Ok(false);
        }
        let (scale, is_new) = (self.screen.scale(), new.is_some() || dims);
        let (mut painted, mut laid_out, mut content) = (Painted::default(), Duration::ZERO, Some(content));
        let (overlay, small) = (&mut self.interface.overlay, self.interface.ui_state.picture);
        let painting =
            self.screen.show(&mut self.playback.renderer, lay, small, is_new || has_words, &mut |size| {
                let laying_out = clock::now();
                if let Some(content) = content.take() {
                    painted = overlay.paint(scale, size, content, laying_out)?;
                }
                laid_out = clock::since(laying_out);
                Ok(())
            })?;
        self.screen.show_on_output(&mut self.playback.renderer, lay, is_new)?;
        // The cost of a refinement does not tell the cost of a frame.
        let is_refined = self.playback.pace.shown == Some(shown);
        let first = self.playback.pace.show(shown);
        let id = self.playback.scene.scenes.shown_id();
        self.interface.typing_times.record_shown(id, new.is_some(), laid_out, clock::now());
        if let Some(Drawn { spent, .. }) = new.filter(|_| !is_refined) {
            let showing = spent + clock::since(handing_over);
            let cost = self.playback.cost(&mut *self.screen, spent + painting, showing);
            self.playback.pace.record_times(level, showing, cost);
            self.playback.scene.record_frame_time(showing);
            self.playback.controllers.record_shown(shown.revision);
        }
        self.interface.apply_painted(&mut *self.screen, painted);
        if first {
            self.interface.ui_state.welcomed.get_or_insert_with(Instant::now);
            self.playback.listening.follow_request();
        }
        Ok(first)
    }

    /// While the window has no frame, shows the name of the scene being prepared, and the sound.
    fn show_waiting(&mut self, size: (u32, u32)) -> Result<(), SessionError> {
        let now = clock::now();
        let is_stale = |(at, shown): (Instant, _)| now - at >= WAITING_AGAIN || shown != size;
        if self.waited.is_none_or(is_stale) {
            let is_first = self.waited.replace((now, size)).is_none();
            let mut waiting = WaitingWindow {
                since: self.waits_since,
                screen: &mut *self.screen,
                overlay: &mut self.interface.overlay,
            };
            let painted = waiting.paint(&self.playback.scene, &mut self.playback.listening)?;
            if is_first {
                self.playback.warm_up(&mut waiting)?;
            }
            self.interface.apply_painted(&mut *self.screen, painted);
        }
        Ok(())
    }
}

struct Picture {
    wanted: Shown,
    new: Option<Drawn>,
    dims: bool,
    level: Level,
    begun: Instant,
}

impl Playback {
    /// Draws the wanted frame or a part of it; `whole` is the full size in pixels. Returns the finished frame.
    fn draw_picture(
        &mut self,
        wanted: Shown,
        level: Level,
        whole: (u32, u32),
        begun: Instant,
    ) -> Result<Option<Drawn>, SessionError> {
        let waits_for_text = self.scene.awaits_edit(begun).is_some();
        let is_there = self.pace.shown == Some(wanted) && !self.scene.composer.is_drawing();
        self.scene.refine_only(Some(wanted));
        if is_there && self.refines(begun) {
            return Ok(self.scene.refine(&mut self.renderer, wanted)?);
        }
        if is_there || waits_for_text {
            return Ok(None);
        }
        // Curves and the last seconds cost more than all other inputs, so they are computed only for scenes that read them.
        let Shown { moment, size, .. } = wanted;
        let curves = self.scene.scenes.read_curves().then(|| self.listening.sound.heard_at(moment.song_time));
        let remembers = self.scene.scenes.remember();
        let recent = remembers.then(|| self.listening.recent(&moment, moment.song_time));
        let sound = mariana_music::Sound {
            features: moment.features,
            tables: curves.map(|heard| heard.tables).unwrap_or_default(),
            song: moment.song,
            parts: self.listening.parts(moment),
            recent: recent.unwrap_or_default(),
        };
        let aspect = f64::from(whole.0) / f64::from(whole.1.max(1));
        let Level { quality, edges, .. } = level;
        let runs = self.scene.composer.fading.is_to_begin() && self.listening.runs();
        let screen = self.scene.composer.screen(whole);
        let listening = &self.listening;
        let earlier = |time| listening.earlier(&moment, time, remembers);
        let earlier: &dyn Fn(f64) -> mariana_music::Sound = &earlier;
        let picture = WantedPicture { moment, sound, earlier, size, aspect, screen, quality, edges, runs };
        let drawn = self.scene.draw(&mut self.renderer, picture);
        let new = self.without_room_smaller(drawn)?.flatten();
        if new.is_none() {
            self.weigh_picture(level, begun);
        }
        Ok(new)
    }

    /// Dims the frame for the master output and the flash limiter. Returns `true` if the brightness of the last frame
    /// changes, and `None` if the driver lacks memory.
    fn finish_picture(&mut self, new: Option<&Drawn>, begun: Instant) -> Result<Option<bool>, SessionError> {
        let gain = self.master_output.gain(begun);
        let dims = self.pace.shown.is_some() && gain != self.renderer.gain();
        if new.is_some() || dims {
            self.renderer.dim(gain)?;
            let since_last = self.pace.record_picture(begun);
            if self.pace.shown.is_some() {
                let limited = self.renderer.limit_flashes(since_last);
                if self.without_room_smaller(limited)?.is_none() {
                    return Ok(None);
                }
            } else {
                self.first_shown_after = Some(since_last);
            }
            self.frame_senders.record_picture();
        }
        match new {
            Some(Drawn { shown, .. }) => self.record(shown.moment, begun),
            None if dims => self.record_again(begun),
            None => {}
        }
        Ok(Some(dims))
    }

    /// Compiles the programs shared by all scenes while the first scene's program is compiled.
    fn warm_up(&mut self, waiting: &mut WaitingWindow<'_>) -> Result<(), SessionError> {
        let Some(picture) = self.scene.scenes.coming_picture() else { return Ok(()) };
        let (scene, listening) = (&mut self.scene, &mut self.listening);
        let mut updated = Ok(());
        let mut is_wanted = || {
            updated = scene.update().map_err(SessionError::from);
            let is_wanted = updated.is_ok() && scene.scenes.shown.is_none();
            if is_wanted {
                updated = waiting.paint(scene, listening).map(|_| ());
            }
            is_wanted && updated.is_ok()
        };
        if let Err(error) = self.renderer.warm_up(&picture, &mut is_wanted) {
            tracing::debug!("warming up: {error}");
        }
        updated
    }

    /// Reads the parts of the song while scenes need them.
    pub(super) fn follow_parts(&mut self) {
        self.listening.parts.wanted = self.scene.scenes.all().any(|scene| scene.hears_parts);
        if self.listening.parts_arrive() {
            // While paused, a frame is drawn only if the last one is outdated.
            self.scene.composer.redraw();
        }
    }

    /// Takes the pictures of moving textures that have come.
    pub(super) fn follow_textures(&mut self) {
        let shows_cover = self.scene.scenes.all().any(|scene| scene.shows_cover);
        let cover = shows_cover.then(|| self.listening.cover_or_painted());
        for message in self.scene.composer.follow_textures(cover) {
            self.reports.announce(message);
        }
        let has_texts = self.scene.scenes.all().any(|scene| scene.has_song_texts);
        let texts = has_texts.then(|| self.listening.song_texts());
        self.scene.composer.follow_song_texts(texts);
    }

    pub(super) fn moment(&mut self) -> Option<Moment> {
        let now = self.listening.now()?;
        Some(self.pace.moment(now, self.scene.moves_by_itself()))
    }

    pub(super) fn could_be_better(&self, screen: &dyn Screen, now: Instant) -> bool {
        self.pace.could_be_better(now, self.scene.composer.views.choice.is_some(), self.side_max(screen))
    }

    /// True if the show is idle, and its frame is being refined.
    pub(super) fn refines(&self, now: Instant) -> bool {
        self.pace.stands_still(now) && !self.holds_picture() && self.scene.can_refine()
    }

    pub(super) fn level(&self, now: Instant) -> Level {
        self.pace.level(now, self.scene.composer.views.choice.is_some())
    }

    fn side_max(&self, screen: &dyn Screen) -> u32 {
        screen.gl().info().texture_side_max
    }

    /// If the frame in progress is too slow, draws it with fewer pixels. If that does not help, removes the scene.
    fn weigh_picture(&mut self, level: Level, now: Instant) {
        let Some(seconds) = self.scene.composer.seconds_of_picture() else { return };
        match self.pace.weigh(level, seconds, now) {
            Verdict::GoOn => {}
            Verdict::DrawSmaller => self.scene.composer.give_picture_up(),
            Verdict::TakeBack => {
                self.scene.withdraw(&format!("a frame of this window would take about {seconds:.0} s"));
            }
        }
    }

    /// Returns the value in `made`. If the driver has no memory for a frame, skips the frame and reduces the next.
    fn without_room_smaller<T>(&mut self, made: Result<T, GpuError>) -> Result<Option<T>, GpuError> {
        match made {
            Err(GpuError::Object { what, reason }) if self.pace.make_smaller() => {
                tracing::warn!("the driver could not make {what}: {reason}");
                self.reports.answer(
                    "the driver has no memory for a frame of this size: frames get smaller now".to_owned(),
                );
                self.scene.composer.give_picture_up();
                Ok(None)
            }
            made => made.map(Some),
        }
    }

    /// Returns the cost of a frame. `drawing` is the time until the frame is handed over to the window system,
    /// `showing` includes the hand-over: usually a wait for the monitor, but with a software renderer still drawing.
    pub(super) fn cost(&mut self, screen: &mut dyn Screen, drawing: Duration, showing: Duration) -> Duration {
        match (screen.gl().info().software, self.renderer.gpu_time()) {
            (true, _) => showing,
            (false, gpu) => drawing.max(gpu.unwrap_or_default()),
        }
    }
}

impl Interface {
    fn apply_painted(&mut self, screen: &mut dyn Screen, painted: Painted) {
        self.acts.on_panels.extend(painted.acts.on_panels);
        self.acts.commands.extend(painted.acts.commands);
        if let Some(controls) = painted.controls {
            screen.show_controls(controls);
        }
        if let Some(cursor) = painted.cursor {
            screen.set_cursor(cursor);
        }
        if let Some(place) = painted.typed_at {
            screen.set_place_of_letters(place);
        }
    }

    pub(super) fn overlay_due(
        &mut self,
        playback: &mut Playback,
        screen: &mut dyn Screen,
        now: Instant,
    ) -> Option<Instant> {
        let seen = self.update_ui_state(playback, screen, now);
        let Playback { scene, controllers, listening, reports, preview, .. } = playback;
        let mut content = self.ui_state.content(&seen, scene, controllers, listening, reports, now);
        content.next = preview.next.as_ref().filter(|_| !self.ui_state.hidden.is_bare());
        content.ray = self.probing.ray_view();
        let due = self.overlay.due(&content, now);
        // The bar disappears when the pointer has not moved for a while.
        let goes = self.pointer_rest.falls_asleep().filter(|_| seen.awake);
        due.into_iter().chain(goes).min()
    }

    fn update_ui_state(&mut self, playback: &mut Playback, screen: &mut dyn Screen, now: Instant) -> Seen {
        self.ui_state.hidden.by_blackout = playback.master_output.is_black && !screen.has_output();
        let busy = self.overlay.has_pointer() || self.overlay.has_key_focus();
        // The panel of videos needs the seek bar with its marks.
        let needs_bar = self.ui_state.panels.open == Some(Panel::Video);
        let awake = self.pointer_rest.is_awake(busy, now) || needs_bar;
        let shows_bar = awake && !self.ui_state.is_quiet();
        // Measure the loudness of the track only if the bar, which shows it, is visible.
        let shape = if shows_bar { playback.listening.shape() } else { None };
        let cover = playback.listening.cover();
        let song = playback.listening.present_structure().filter(|_| shows_bar);
        let (assisted, follows) = (self.overlay.assisted, playback.follows());
        let fullscreen = screen.is_fullscreen();
        let cues = (self.ui_state.panels.open == Some(Panel::Cues)).then(|| playback.cue_sheet());
        let pace = &playback.pace;
        let corner = || report::line(&playback.scene, &pace.about_pictures(now), &pace.resolution);
        let corner = self.ui_state.panels.corner.then(corner).flatten();
        Seen { corner, awake, assisted, fullscreen, cues, cover, shape, follows, song }
    }

    fn update_scene(&mut self, playback: &mut Playback) {
        let Some(source) = playback.scene.scenes.shown_source() else { return };
        if self.ui_state.placed_scene.as_ref().is_none_or(|(known, _)| known != source) {
            let words = match source {
                SceneSource::Blend(blend) => {
                    format!("{} and {}", blend.from.source.title(), blend.to.source.title())
                }
                source => playback.scene.preparation.library.placed_name(source),
            };
            self.ui_state.placed_scene = Some((source.clone(), words));
        }
    }
}

/// A window without a frame.
struct WaitingWindow<'a> {
    since: Instant,
    screen: &'a mut dyn Screen,
    overlay: &'a mut Overlay,
}

impl WaitingWindow<'_> {
    /// Paints the name of the scene being prepared and the bands of the sound. Starts the song if the first frame is
    /// late.
    fn paint(&mut self, scene: &SceneSession, listening: &mut Listening) -> Result<Painted, SessionError> {
        let is_late = clock::since(self.since) >= SONG_WAIT;
        if is_late && self.screen.is_awaited() && !listening.started {
            tracing::info!("the song starts before the first frame");
            listening.follow_request();
        }
        let bands = listening.now().filter(|_| listening.started).map(|now| now.features.bands);
        let title = scene.preparation.library.wanted.title();
        let bands = bands.as_ref().map_or(&[][..], |bands| bands);
        let content = OverlayContent { bands, ..scene.content(None, PanelSwitches::default()) };
        paint_waiting(self.screen, self.overlay, &title, content)
    }
}

/// Paints a calm window with the name of the scene being prepared, because an empty window looks broken.
pub(super) fn paint_waiting(
    screen: &mut dyn Screen,
    overlay: &mut Overlay,
    title: &str,
    content: OverlayContent<'_>,
) -> Result<Painted, SessionError> {
    let words = format!("Mariana is preparing {title}");
    let (scale, mut painted) = (screen.scale(), Painted::default());
    let mut content = Some(OverlayContent { hint: Some(&words), calm: true, ..content });
    screen.show_waiting(&mut |size| {
        if let Some(content) = content.take() {
            painted = overlay.paint(scale, size, content, clock::now())?;
        }
        Ok(())
    })?;
    Ok(painted)
}
