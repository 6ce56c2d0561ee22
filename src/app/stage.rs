//! What lives as long as the window: the sound, the scene, the pace of the drawing, the reports, and the overlay.

mod drawing;
mod leaving;
mod opening;

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use winit::event::WindowEvent;

pub(super) use opening::{Opening, renewed};

use super::announcer::TrackOrder;
use super::drawing_pace::DrawingPace;
use super::error::AppError;
use super::file_browser::{FileBrowser, Picked};
use super::frame_times::FrameTimes;
use super::keys::Action;
use super::listening::Listening;
use super::media_controls::Asked;
use super::overlay::{FileRequest, Overlay, Panel, PanelSwitches, Request, SceneRequest, TrackRequest};
use super::pointer_rest::PointerRest;
use super::reports::Reports;
use super::scene_browser::{Chosen, SceneBrowser};
use super::scene_stage::SceneStage;
use super::title::{live_title, title};
use super::user_input::{UserInput, Wish};
use super::window::GlWindowContext;
use super::window_thread::Waker;
use crate::config::PlaySettings;
use crate::gpu::renderer::Renderer;
use crate::scenes::{SceneSource, is_scene_file};
use crate::thumbnails::Thumbnails;
use mariana_player::Player;

/// How often a show that stands still looks for changes.
const IDLE_INTERVAL: Duration = Duration::from_millis(250);
/// How often it does so while it waits for a sound that it could show.
const LISTEN_INTERVAL: Duration = Duration::from_millis(10);

/// Everything that lives as long as the window.
pub(super) struct Stage {
    listening: Listening,
    renderer: Renderer,
    pub(super) scene: SceneStage,
    pace: DrawingPace,
    reports: Reports,
    input: UserInput,
    /// Whether nothing of the window can be seen.
    occluded: bool,
    pointer_rest: PointerRest,
    /// What the pointer asked for in the last picture.
    requests: Vec<Request>,
    /// The scene on the stage, with its place among the others in words.
    placed_scene: Option<(SceneSource, String)>,
    /// The list of scenes, while it is open, and what finds their pictures.
    browser: Option<SceneBrowser>,
    thumbnails: Option<Thumbnails>,
    /// The list of files, while it is open, and the folder in which something was last picked.
    files: Option<FileBrowser>,
    last_folder: Option<PathBuf>,
    waker: Waker,
    /// Whether nothing shows over the picture but what was asked for and what is wrong.
    clean: bool,
    /// When the words at the start came up.
    welcomed: Option<Instant>,
    overlay: Overlay,
    /// When the words of a window without a picture were last shown, and in which size.
    waited: Option<(Instant, (u32, u32))>,
    pub(super) panels: PanelSwitches,
    // Last: everything above that holds OpenGL objects is dropped first.
    pub(super) window: GlWindowContext,
}

impl Stage {
    /// Pauses the sound or lets it run.
    pub(super) fn set_paused(&mut self, paused: bool) {
        self.listening.want_paused(paused);
        if self.pace.shown().is_some() {
            self.listening.follow_wish();
        }
    }

    /// Pauses the sound if it runs, and lets it run if it is paused.
    pub(super) fn toggle_pause(&mut self) {
        self.set_paused(!self.listening.is_paused());
    }

    /// Does something with the song, if it is what is listened to.
    pub(super) fn with_song(&mut self, act: impl FnOnce(&mut Player)) {
        let _ = self.listening.with_song(act);
    }

    /// Changes the volume of the song or whether it is muted, and tells how loud it is then.
    pub(super) fn change_volume(&mut self, act: impl FnOnce(&mut Player)) {
        let after = self.listening.with_song(|player| {
            act(player);
            let status = player.status();
            (status.volume, status.muted)
        });
        match after {
            Some((_, true)) => self.reports.answer_share("muted".to_owned(), Some(0.0)),
            Some((volume, false)) => {
                self.reports.answer_share(format!("volume {:.0} %", 100.0 * volume), Some(volume));
            }
            None => {
                self.reports.answer("the volume is that of the song, and an input is listened to".to_owned())
            }
        }
    }

    /// Shows where in the track we are.
    pub(super) fn answer_position(&mut self) {
        // What was done a moment ago shows at once.
        self.note_playing();
        self.reports.answer_position();
    }

    /// Opens a panel instead of the one that is open, or closes it.
    pub(super) fn toggle_panel(&mut self, panel: Panel) {
        self.panels.toggle(panel);
        if self.panels.open() == Some(Panel::Sources) {
            self.listening.show_sources();
        }
        self.look_through_scenes(self.panels.open() == Some(Panel::Scenes));
        self.look_through_files(self.panels.open() == Some(Panel::Files));
    }

    /// Whether keys are text at present.
    pub(super) fn takes_text(&self) -> bool {
        self.browser.is_some() || self.files.is_some()
    }

    /// Opens the list of files, or closes it.
    fn look_through_files(&mut self, open: bool) {
        self.files = None;
        if !open {
            return;
        }
        let waker = self.waker.clone();
        let folder = self.last_folder.clone().or_else(|| self.folder_of_track());
        match FileBrowser::start(folder, move || waker.wake()) {
            Ok(files) => self.files = Some(files),
            Err(error) => self.reports.answer(format!("folders cannot be read: {error}")),
        }
    }

    /// The folder of the track that plays, if it is a file.
    fn folder_of_track(&mut self) -> Option<PathBuf> {
        let entry = self.reports.playing().place.0;
        let tracks = self.listening.with_song(|player| player.playlist())?;
        let file = tracks.entries.get(entry)?.file.as_deref()?;
        std::path::absolute(file).ok()?.parent().map(Path::to_owned)
    }

    /// Does what was picked in the list of files.
    fn follow_pick(&mut self, picked: Picked) {
        match picked {
            Picked::Nothing => return,
            Picked::Close => {}
            Picked::Open { path, append } => {
                self.last_folder = path.parent().map(Path::to_owned);
                self.open_files(vec![path], append);
            }
        }
        if self.panels.open() == Some(Panel::Files) {
            self.toggle_panel(Panel::Files);
        }
    }

    /// Does what the pointer asked of the list of files.
    fn obey_in_files(&mut self, request: FileRequest) {
        let Some(files) = &mut self.files else { return };
        let picked = match request {
            FileRequest::Open { place, append } => files.open(place, append),
            FileRequest::OpenFolder { append } => files.open_folder(append),
            FileRequest::EnterPlace(place) => {
                files.enter_place(place);
                Picked::Nothing
            }
            FileRequest::Up => {
                files.go_up();
                Picked::Nothing
            }
            FileRequest::Close => Picked::Close,
        };
        self.follow_pick(picked);
    }

    /// Shows the last scene among these files, and plays the others or adds them to the tracks.
    fn open_files(&mut self, files: Vec<PathBuf>, append: bool) {
        let (scenes, music): (Vec<_>, Vec<_>) = files.into_iter().partition(|file| is_scene_file(file));
        if let Some(scene) = scenes.into_iter().next_back() {
            self.scene.show_source(SceneSource::File(scene));
        }
        if !music.is_empty() {
            let words = self.listening.play_files(music, append);
            self.answer(words);
        }
    }

    /// Opens the list of scenes, or closes it.
    fn look_through_scenes(&mut self, open: bool) {
        self.browser = None;
        if !open {
            return;
        }
        if self.thumbnails.is_none() {
            let waker = self.waker.clone();
            match Thumbnails::start(move || waker.wake()) {
                Ok(thumbnails) => self.thumbnails = Some(thumbnails),
                Err(error) => tracing::warn!("there are no pictures of scenes ({error})"),
            }
        }
        let scenes = self.scene.all_sources();
        let favourites = self.listening.settings().favourite_scenes.clone();
        let browser = SceneBrowser::new(scenes, self.scene.shown_source(), favourites);
        if let Some(thumbnails) = &mut self.thumbnails {
            browser.ask_for_comments(thumbnails);
        }
        self.browser = Some(browser);
    }

    /// Does what was chosen in the list of scenes.
    fn follow_choice(&mut self, chosen: Chosen) {
        match chosen {
            Chosen::Nothing => {}
            Chosen::Close => self.close_scenes(),
            Chosen::Show { source, close } => {
                self.scene.show_source(source);
                if close {
                    self.close_scenes();
                }
            }
            Chosen::Marked => {
                if let Some(favourites) = self.browser.as_ref().map(|browser| browser.favourites().clone()) {
                    self.listening.remember(move |settings| {
                        settings.favourite_scenes.clone_from(&favourites);
                    });
                }
            }
        }
    }

    fn close_scenes(&mut self) {
        if self.panels.open() == Some(Panel::Scenes) {
            self.toggle_panel(Panel::Scenes);
        }
    }

    /// Does what the pointer asked of the list of scenes.
    fn obey_in_scenes(&mut self, request: SceneRequest) {
        let Some(browser) = &mut self.browser else { return };
        let chosen = match request {
            SceneRequest::Show { place, close } => browser.show(place, close),
            SceneRequest::Mark(place) => browser.mark(place),
            SceneRequest::Close => Chosen::Close,
            SceneRequest::Drawn { places, columns } => {
                if let Some(thumbnails) = &mut self.thumbnails {
                    browser.note_drawn(places, columns, thumbnails);
                }
                Chosen::Nothing
            }
        };
        self.follow_choice(chosen);
    }

    /// Closes what is open, or leaves full screen.
    pub(super) fn leave(&mut self) {
        if !self.panels.close() {
            self.window.set_fullscreen(false);
        }
        self.look_through_scenes(false);
        self.look_through_files(false);
    }

    /// What the pointer asked for since the last call.
    pub(super) fn take_requests(&mut self) -> Vec<Request> {
        std::mem::take(&mut self.requests)
    }

    /// Does what the pointer asked for in a panel.
    pub(super) fn obey(&mut self, request: Request) {
        match request {
            // What keys do, too, is the show's.
            Request::Act(_) => {}
            Request::SeekTo(seconds) => self.with_song(|player| player.seek_to(seconds)),
            Request::SetVolume(volume) => self.with_song(|player| {
                player.set_volume(volume);
                if player.status().muted {
                    player.toggle_mute();
                }
            }),
            Request::Tracks(TrackRequest::Play(entry)) => self.with_song(|player| player.play_entry(entry)),
            Request::Tracks(TrackRequest::Remove(entry)) => {
                self.with_song(|player| player.remove_entry(entry));
            }
            Request::Tracks(TrackRequest::Move { from, to }) => {
                self.with_song(|player| player.move_entry(from, to));
            }
            Request::Listen(place) => self.listening.choose_source(place),
            Request::Scenes(request) => return self.obey_in_scenes(request),
            Request::Files(request) => self.obey_in_files(request),
        }
        self.hurry_reports();
    }

    /// Changes the order of the tracks; does nothing while another source is listened to.
    pub(super) fn set_order(&mut self, change: impl FnOnce(TrackOrder) -> TrackOrder) {
        let words = self.listening.set_order(change);
        self.answer(words);
    }

    /// Takes this moment as a beat.
    pub(super) fn tap(&mut self) {
        let words = self.listening.tap();
        self.answer(words);
    }

    /// Goes to the next track, or back.
    pub(super) fn skip(&mut self, forward: bool) {
        self.listening.skip(forward);
    }

    /// Listens to the next source.
    pub(super) fn next_source(&mut self) {
        self.listening.next_source();
    }

    /// Shows the picture later by this many steps.
    pub(super) fn shift(&mut self, steps: f64) {
        let words = self.listening.shift(steps);
        self.answer(Some(words));
    }

    fn answer(&mut self, words: Option<String>) {
        if let Some(words) = words {
            self.reports.answer(words);
        }
    }

    /// Shows the next view or the one before. Its colours stand for numbers, so the change must not be dimmed as a
    /// flash. The key does not repeat: only single presses by hand escape the limiter.
    pub(super) fn go_view(&mut self, forward: bool) {
        self.scene.go_view(forward);
        self.renderer.forget_flashes();
    }

    /// Enters full screen or leaves it.
    pub(super) fn toggle_fullscreen(&mut self) {
        let full = !self.window.is_fullscreen();
        self.window.set_fullscreen(full);
        if full {
            self.pointer_rest.sleep();
        }
    }

    /// Handles an event of the window. Returns what a key or the mouse asks for.
    pub(super) fn take(&mut self, event: &WindowEvent) -> Option<Action> {
        self.pointer_rest.take(event, Instant::now());
        if self.overlay.on_event(self.window.window(), event) {
            return None;
        }
        if let (Some(browser), Some((key, held))) = (&mut self.browser, self.input.typed(event)) {
            let chosen = browser.take_key(key, held.control_key() || held.super_key());
            self.follow_choice(chosen);
            return None;
        }
        if let (Some(files), Some((key, held))) = (&mut self.files, self.input.typed(event)) {
            let picked = files.take_key(key, held.shift_key(), held.control_key() || held.super_key());
            self.follow_pick(picked);
            return None;
        }
        match event {
            WindowEvent::Resized(size) => {
                self.window.resize((*size).into());
                self.window.window().request_redraw();
            }
            WindowEvent::Occluded(occluded) => self.occluded = *occluded,
            _ => match self.input.take(event, Instant::now())? {
                Wish::Act(action) => return Some(action),
                Wish::TurnCamera(way) => {
                    let height = f64::from(self.window.size().map_or(1, |(_, height)| height));
                    self.scene.move_camera(|hand, own| hand.drag((way.0 / height, way.1 / height), own));
                }
                Wish::ZoomCamera(notches) => self.scene.move_camera(|hand, _| hand.zoom(notches)),
            },
        }
        None
    }

    /// What the desktop asks for next, if anything.
    pub(super) fn asked(&self) -> Option<Asked> {
        self.reports.asked()
    }

    /// Looks at the state of the sound at once, because something was changed.
    pub(super) fn hurry_reports(&mut self) {
        self.reports.hurry();
    }

    /// Title and messages. Returns whether a song that plays once is over.
    ///
    /// # Errors
    /// The only song cannot be played on.
    pub(super) fn look_at_status(&mut self, settings: &PlaySettings) -> Result<bool, AppError> {
        if !self.reports.is_due(Instant::now()) {
            return Ok(false);
        }
        if let Some(live) = self.listening.live_status() {
            let paused = self.listening.is_paused();
            self.reports.look_at_input(&live, paused);
            self.set_title(live_title(&live, self.scene.notes(), paused));
            return Ok(false);
        }
        let Some(status) = self.listening.song_status() else { return Ok(false) };
        self.reports.tell_silence(&status, settings.silent);
        if let (true, true, 1, Some(error)) =
            (status.ended, settings.once, status.track.count, &status.troubles.last)
        {
            return Err(AppError::SongLost(error.clone()));
        }
        self.reports.look(&status, self.window.is_fullscreen());
        self.set_title(title(self.scene.notes(), &status, settings.silent));
        Ok(status.ended && settings.once)
    }

    /// Notes what plays at this moment.
    fn note_playing(&mut self) {
        let fullscreen = self.window.is_fullscreen();
        if let Some(live) = self.listening.live_status() {
            self.reports.look_at_input(&live, self.listening.is_paused());
        } else if let Some(status) = self.listening.song_status() {
            self.reports.look(&status, fullscreen);
        }
    }

    fn set_title(&mut self, title: String) {
        if let Some(title) = self.reports.changed_title(title) {
            self.window.window().set_title(title);
        }
    }

    /// Takes in what other threads have finished, requests a picture if one is due, and returns when to look again if
    /// nothing happens before.
    ///
    /// # Errors
    /// What the driver refuses.
    pub(super) fn look_around(&mut self) -> Result<Instant, AppError> {
        let dropped = self.input.take_dropped();
        if !dropped.is_empty() {
            let append = self.input.shift_held() || self.panels.open() == Some(Panel::Tracks);
            self.open_files(dropped, append);
        }
        self.scene.update()?;
        if let (Some(browser), Some(thumbnails)) = (&mut self.browser, &mut self.thumbnails) {
            browser.set_present(self.scene.shown_source());
            browser.take(thumbnails);
        }
        if let Some(files) = &mut self.files {
            files.update();
        }
        let now = Instant::now();
        self.reports.update(now);
        if self.scene.is_drawing() {
            return Ok(now);
        }
        self.scene.rehearse(&mut self.renderer);
        let overlay_due = self.overlay_due(now);
        let moment = self.moment();
        let moves = self.pace.note_wanted(moment, self.scene.revision(), now);
        let moving = moves || self.could_be_better(now) || overlay_due.is_some_and(|due| due <= now);
        // The first picture starts the song, seen or not.
        let seen = !self.occluded || self.pace.shown().is_none();
        if !moving || !seen {
            // Paused, ended or covered: there is nothing to draw until something happens. In silence it may happen at
            // any time.
            let idle = now + self.idle_interval(seen);
            let wake = overlay_due.filter(|_| seen).map_or(idle, |due| due.min(idle));
            Ok(wake)
        } else if now >= self.pace.due() || self.scene.has_regions() {
            self.window.window().request_redraw();
            Ok(now + IDLE_INTERVAL)
        } else {
            Ok(self.pace.due())
        }
    }

    /// How long a show that stands still sleeps: in silence it listens.
    fn idle_interval(&self, seen: bool) -> Duration {
        if seen && !self.listening.is_paused() { LISTEN_INTERVAL } else { IDLE_INTERVAL }
    }

    /// How long frames took, for the log.
    pub(super) fn frame_times(&self) -> &FrameTimes {
        self.pace.times()
    }
}
