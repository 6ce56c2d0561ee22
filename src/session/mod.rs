//! The session prepares scenes, listens, composes frames, draws panels over them and carries out commands. It needs
//! no window, sound card or desktop: its owner passes a [`Screen`] with an OpenGL context and input.

mod browsing;
mod carrying_out;
pub mod controllers;
mod controlling;
mod cues;
pub mod desktop;
mod directing;
mod direction;
mod drawing;
mod drawing_pace;
mod dynamic_resolution;
mod editing;
mod error;
pub(crate) mod frame_senders;
mod heard_parts;
mod inspecting;
pub(crate) mod lay;
mod leaving;
mod listening;
mod loading;
mod master_output;
mod mastering;
mod music_lists;
mod opening;
pub mod pacing;
mod panels;
mod pictures;
mod preview;
mod recording;
mod reports;
mod running;
pub(crate) mod scene;
pub(crate) mod screen;
mod settings;
mod snapshots;
pub(crate) mod sound;
mod surprising;
mod times;
mod typing_times;
mod ui_state;
mod variations;
mod video_making;
mod video_words;
mod videos;
pub mod waker;

pub use error::SessionError;

use std::sync::Arc;
use std::time::{Duration, Instant};

use cues::Cues;
pub use lay::Lay;
pub use opening::{Opening, Prepared};
use preview::Preview;
pub use running::Run;
pub use screen::{Event, Paint, Screen};
use ui_state::UiState;
pub use waker::Waker;

use crate::clock;
use crate::commands::{Command, Files, Panel};
use crate::config::{Choices, Folders, PlaySettings};
use crate::export::print::print_message;
use crate::gpu::{Renderer, ShaderLibrary};
use crate::input::{Input, Key, Modifiers, NamedKey};
use crate::scenes::{Drafts, ImportedShader, ShaderError};
use crate::session::controllers::Controllers;
use crate::session::direction::Direction;
use crate::session::drawing_pace::DrawingPace;
use crate::session::frame_senders::FrameSenders;
use crate::session::listening::Listening;
use crate::session::master_output::MasterOutput;
use crate::session::pictures::picture_name;
use crate::session::recording::Recording;
use crate::session::reports::{Reports, live_title, title};
use crate::session::scene::{Performed, SceneSession};
use crate::session::typing_times::TypingTimes;
use crate::show::{Finish, LiveDirector, PreparedShow};
use crate::thumbnails::Thumbnails;
use crate::ui::open_panel::OpenPanel;
use crate::ui::overlay::{Acts, Overlay};
use crate::ui::pointer_rest::PointerRest;
use crate::ui::user_input::UserInput;
use mariana_player::{Moment, Player};
use mariana_work::Awaited;

/// Interval at which an idle session looks for changes.
const IDLE_INTERVAL: Duration = Duration::from_millis(250);
/// Interval while the session waits for sound that would change the frame.
const LISTEN_INTERVAL: Duration = Duration::from_millis(10);

pub(crate) struct Session {
    playback: Playback,
    interface: Interface,
    choices: Choices,
    /// True if the command line names the audio output of songs, or silence, and the user has not chosen another.
    names_output: bool,
    /// When the window appeared.
    waits_since: Instant,
    /// When text was last shown while no frame of a scene was ready, and the size of the window then.
    waited: Option<(Instant, (u32, u32))>,
    legacy: leaving::Legacy,
    snapshots: snapshots::Snapshots,
    surprises: variations::Surprises,
    videos: video_making::VideoMaking,
    pictures: pictures::Pictures,
    // The last field, because the fields above hold OpenGL objects and must be dropped first.
    screen: Box<dyn Screen>,
}

/// The sound, the scenes and their show, and the frames. Does not depend on the user interface.
pub(crate) struct Playback {
    listening: Listening,
    scene: SceneSession,
    direction: Direction,
    /// Chooses among the scenes of a show while an audio input plays.
    live: Option<(Arc<PreparedShow>, LiveDirector)>,
    cues: Cues,
    controllers: Controllers,
    renderer: Renderer,
    shaders: ShaderLibrary,
    pace: DrawingPace,
    master_output: MasterOutput,
    /// Seconds from the black window to the first frame; `None` once passed to the flash limiter.
    first_shown_after: Option<f64>,
    preview: Preview,
    frame_senders: FrameSenders,
    recording: Recording,
    pub(super) reports: Reports,
}

pub(crate) struct Interface {
    overlay: Overlay,
    ui_state: UiState,
    input: UserInput,
    pointer_rest: PointerRest,
    acts: Acts,
    /// Texts that are being edited, for the scene loaders.
    drafts: Drafts,
    shader_import: Awaited<Result<ImportedShader, ShaderError>>,
    probing: inspecting::Probing,
    pub(super) typing_times: TypingTimes,
    thumbnails: Option<Thumbnails>,
    lists: music_lists::MusicLists,
    folders: Folders,
    waker: Waker,
}

impl Session {
    /// Takes input. Returns the command of a key or the mouse if no panel consumes the input.
    pub(crate) fn handle_input(&mut self, input: &Input) -> Option<Command> {
        self.interface.pointer_rest.handle(input, clock::now());
        if self.interface.overlay.on_input(input) {
            return None;
        }
        if self.pass_to_help(input) || self.pass_to_editor(input) || self.pass_to_panels(input) {
            return None;
        }
        self.interface.input.handle(input, clock::now())
    }

    /// Passes a key to the table of keys, which is above all panels. Returns `true` if the table consumed it.
    fn pass_to_help(&mut self, input: &Input) -> bool {
        let is_command = |held: Modifiers| held.intersects(Modifiers::CONTROL | Modifiers::SUPER);
        self.interface.ui_state.panels.help
            && self.pass_key(input, |ui, key, held| ui.help.handle_key(key, is_command(held)))
    }

    /// Passes a key to the open panel, or closes the panel by the key that opens it. Returns `true` if the panel
    /// consumed the key.
    fn pass_to_panels(&mut self, input: &Input) -> bool {
        self.pass_key(input, |ui, key, held| {
            let open = ui.panels.open.map(Command::TogglePanel);
            let is_searching = ui.panel.as_ref().is_some_and(OpenPanel::is_searching);
            if open.is_some() && Command::of_key(key, held, false) == open && !is_searching {
                return open.map(|closes| vec![closes]);
            }
            let taken = ui.panel.as_mut().and_then(|panel| panel.handle_key(key, held));
            // Files can be dropped while no panel is open, so the former list comes back without one.
            let undoes = held.intersects(Modifiers::CONTROL | Modifiers::SUPER)
                && matches!(key, Key::Character(text) if text.eq_ignore_ascii_case("z"));
            taken.or_else(|| undoes.then(|| vec![Command::UndoTracks]))
        })
    }

    /// Passes a key to the controls, or otherwise to `panel`, and carries out the commands of the panel. Returns `true`
    /// if one of them consumed the key.
    fn pass_key(
        &mut self,
        input: &Input,
        panel: impl FnOnce(&mut UiState, &Key, Modifiers) -> Option<Vec<Command>>,
    ) -> bool {
        let Some((key, held)) = self.interface.input.typed(input) else { return false };
        if self.interface.pass_to_controls(&mut *self.screen, key, held) {
            return true;
        }
        let commands = panel(&mut self.interface.ui_state, key, held);
        let is_taken = commands.is_some();
        self.carry_out_all(commands.into_iter().flatten());
        is_taken
    }

    /// Updates the title and the messages. Returns `true` when a song that plays once has ended.
    ///
    /// # Errors
    /// Fails if the only song can no longer be played.
    pub(super) fn update_status(&mut self, settings: &PlaySettings) -> Result<bool, SessionError> {
        if !self.playback.reports.is_due(clock::now()) {
            return Ok(false);
        }
        let moves = !self.playback.listening.paused && self.screen.is_seen();
        self.screen.keep_awake(self.choices.stay_awake && (moves || self.screen.has_output()));
        for complaint in self.playback.listening.sound.drain_reported_problems() {
            self.playback.reports.announce(complaint);
        }
        let mut notes = scene::report::notes(&self.playback.scene);
        notes.extend(self.videos.title_note());
        if let Some(live) = self.playback.listening.sound.live_status() {
            let paused = self.playback.listening.paused;
            self.playback.reports.report_input(&live, paused);
            self.playback.reports.set_title(&mut *self.screen, live_title(&live, notes, paused));
            return Ok(false);
        }
        let Some(status) = self.playback.listening.song_status() else { return Ok(false) };
        let silence_asked = settings.silent && self.names_output;
        self.playback.reports.report_silence(&status, silence_asked);
        if let (true, true, 1, Some(error)) =
            (status.ended, settings.once, status.track.count, &status.track_errors.last)
        {
            return Err(SessionError::SongLost(error.clone()));
        }
        let started = self.playback.listening.started;
        self.playback.reports.report_song(&status, started, self.screen.is_fullscreen());
        self.playback.reports.set_title(&mut *self.screen, title(notes, &status, silence_asked));
        Ok(status.ended && settings.once)
    }

    fn open_dropped(&mut self) {
        let dropped = std::mem::take(&mut self.interface.input.dropped);
        if !dropped.is_empty() {
            let append = self.interface.input.held.contains(Modifiers::SHIFT)
                || self.interface.ui_state.panels.open == Some(Panel::Tracks);
            self.interface.open_files(&mut self.playback, Files { files: dropped, append });
        }
    }

    /// Takes the results of the threads that write shows and scenes.
    pub(super) fn report_written_files(&mut self) {
        self.playback.recording.update(clock::now());
        if let Some(news) = self.playback.recording.news() {
            tracing::info!("{news}");
            self.playback.reports.answer(news);
        }
        self.interface.ui_state.snapshots = self.snapshots.update(&mut self.playback);
        self.update_surprises();
    }

    /// Takes a wanted picture of the finished frame. `time` is the frame's time in the song, and `whole` the size of
    /// the window.
    pub(super) fn save_picture(&mut self, time: f64, whole: (u32, u32)) {
        let folder = &self.interface.folders.pictures;
        let title = &self.playback.reports.playing.title;
        let file = || Some(folder.as_ref()?.join(picture_name(title, time)));
        let renderer = &mut self.playback.renderer;
        if let Err(words) = self.pictures.save(self.screen.gl(), renderer, whole, file) {
            self.playback.reports.answer(words);
        }
    }

    /// Follows the pictures and videos that are being made. Returns when to call again.
    pub(super) fn update_made(&mut self, now: Instant) -> Option<Instant> {
        let (due, messages) = self.pictures.update(now, &self.interface.waker);
        for words in messages {
            tracing::info!("{words}");
            self.playback.reports.answer(words);
        }
        due.into_iter().chain(self.video_desk().update(now)).min()
    }

    /// Takes the results of other threads and requests a frame if one is due. Returns when to call again.
    pub(super) fn update(&mut self) -> Result<Instant, SessionError> {
        self.open_dropped();
        self.interface.update_marks(&mut self.playback);
        self.playback.scene.update()?;
        self.update_editor();
        self.interface.update_probing(&mut self.playback);
        self.interface.update_shader_import(&mut self.playback);
        self.interface.update_thumbnails(&mut self.playback);
        self.interface.update_music_lists(&mut self.playback);
        self.update_settings();
        self.interface.update_controllers(&mut self.playback);
        self.report_written_files();
        let now = clock::now();
        self.playback.reports.update(now, !self.interface.ui_state.hidden.is_bare());
        self.screen.update().into_iter().for_each(|sentence| self.playback.reports.announce(sentence));
        let to_send = self.playback.send(&mut *self.screen, now)?;
        let to_send = to_send.into_iter().chain(self.update_made(now)).min();
        let awaits_edit = self.playback.scene.awaits_edit(now);
        let is_drawing = self.playback.scene.composer.is_drawing();
        if is_drawing && awaits_edit.is_none() {
            return Ok(now);
        }
        let overlay_due = self.interface.overlay_due(&mut self.playback, &mut *self.screen, now);
        if let Some(until) = awaits_edit
            && overlay_due.is_none_or(|due| due > now)
        {
            return Ok(until);
        }
        if is_drawing {
            return Ok(now);
        }
        let overlay_due = overlay_due.filter(|_| self.screen.shows_words());
        self.playback.scene.rehearse(&mut self.playback.renderer);
        let moment = self.playback.moment();
        self.playback.direct(moment);
        self.playback.follow_recorded_track();
        self.playback.follow_parts();
        self.playback.follow_textures();
        let moves = self.playback.pace.record_wanted(moment, self.playback.scene.revision(), now);
        if self.playback.holds_picture() {
            self.playback.record_again(now);
        }
        if !self.playback.listening.paused {
            self.playback.scene.refine_only(None);
        }
        // A frozen frame does not change.
        let could_be_better = self.playback.could_be_better(&*self.screen, now) || self.playback.refines(now);
        let changes = (moves || could_be_better) && !self.playback.holds_picture();
        let moving = changes
            || self.playback.is_dimming(now)
            || self.screen.is_stale()
            || overlay_due.is_some_and(|due| due <= now);
        // Draw the first frame even in a hidden window, because it starts the song.
        let seen = self.screen.is_seen()
            || self.playback.pace.shown.is_none()
            || self.playback.frame_senders.are_any();
        let due = self.playback.pace.pacing.due(self.playback.controllers.unseen.is_some());
        if !moving || !seen {
            // While paused, ended or covered, the show waits for an event. In silence, sound may start at any time.
            if seen {
                self.update_preview(now, None)?;
            }
            let listens = seen && !self.playback.listening.paused;
            let idle = now + if listens { LISTEN_INTERVAL } else { IDLE_INTERVAL };
            Ok(overlay_due.filter(|_| seen).into_iter().chain(to_send).fold(idle, Instant::min))
        } else if now >= due || self.playback.scene.composer.regions.have_come() {
            self.update_preview(now, Some(Duration::ZERO))?;
            self.screen.request_redraw();
            Ok(to_send.map_or(now + IDLE_INTERVAL, |due| due.min(now + IDLE_INTERVAL)))
        } else {
            self.update_preview(now, Some(due.saturating_duration_since(now)))?;
            Ok(to_send.map_or(due, |sends| sends.min(due)))
        }
    }
}

impl Playback {
    pub(crate) fn set_paused(&mut self, paused: bool) {
        self.listening.paused = paused;
        if self.pace.shown.is_some() {
            self.listening.follow_request();
        }
    }

    pub(crate) fn with_song(&mut self, act: impl FnOnce(&mut Player)) {
        let _ = self.listening.with_song(act);
    }

    pub(super) fn change_volume(&mut self, act: impl FnOnce(&mut Player)) {
        let after = self.listening.with_song(|player| {
            act(player);
            let status = player.status();
            (status.volume, status.muted)
        });
        match after {
            Some((_, true)) => self.reports.answer_fraction("muted".to_owned(), Some(0.0)),
            Some((volume, false)) => {
                self.reports.answer_fraction(format!("volume {:.0} %", 100.0 * volume), Some(volume));
            }
            None => self.reports.answer("no song is playing: an audio input has no volume here"),
        }
    }

    pub(crate) fn answer_position(&mut self, screen: &dyn Screen) {
        // Update first, so that a change made just now is included.
        if let Some(live) = self.listening.sound.live_status() {
            self.reports.report_input(&live, self.listening.paused);
        } else if let Some(status) = self.listening.song_status() {
            self.reports.report_song(&status, self.listening.started, screen.is_fullscreen());
        }
        self.reports.answer_position();
    }

    /// Shows the next or the previous view. Resets the flash limiter, because limiting would distort the numbers that a
    /// view's colours encode. The key does not repeat, so that only single key presses bypass the limiter.
    pub(super) fn switch_view(&mut self, forward: bool) {
        self.scene.switch_view(forward);
        self.renderer.forget_flashes();
    }

    /// Sends due frames. Returns when to call again, if no event comes first.
    pub(super) fn send(
        &mut self,
        screen: &mut dyn Screen,
        now: Instant,
    ) -> Result<Option<Instant>, SessionError> {
        for sentence in self.frame_senders.news() {
            print_message(&sentence);
            self.reports.announce(sentence);
        }
        if self.pace.shown.is_none() {
            return Ok(None);
        }
        Ok(self.frame_senders.send_due(screen.gl(), &mut self.renderer, now)?)
    }

    pub(super) fn toggle_recording(&mut self) {
        let begins = self.recording.toggle(clock::now());
        if let Some(shown) = self.pace.shown.filter(|_| begins) {
            self.record(shown.moment, clock::now());
        }
        let words = match begins {
            true if self.listening.song_status().is_none() => {
                "recording starts with the next song: an audio input cannot be recorded"
            }
            true => "recording: press F9 to stop",
            false => "recording stopped",
        };
        self.reports.answer(words);
    }

    pub(super) fn record(&mut self, moment: Moment, begun: Instant) {
        if !self.recording.is_on {
            return;
        }
        let picture = self.finish(begun);
        let Some(performed) = Performed::of(&self.scene, moment.song_time) else { return };
        let performed = Performed { picture, ..performed };
        // Record a still scene at the current time, because `moment` is the time at which the scene became still.
        let now = self.listening.now().filter(|_| !self.scene.moves_by_itself());
        let at = now.unwrap_or(moment);
        let (track, title) = (self.listening.track_of(at), self.reports.playing.title.as_str());
        if let Some(words) = self.recording.record(track, title, &at, performed, clock::now()) {
            self.reports.answer(words);
        }
    }

    /// Stops recording at the end of the track.
    fn follow_recorded_track(&mut self) {
        if self.recording.is_on
            && let Some(now) = self.listening.now()
        {
            let has_ended = self.listening.with_song(|player| player.status().ended).unwrap_or_default();
            self.recording.follow(self.listening.track_of(now), &now, has_ended, clock::now());
        }
    }

    /// Records that the last frame is still shown: it is frozen, or only its brightness changes.
    pub(super) fn record_again(&mut self, begun: Instant) {
        if !self.recording.is_on {
            return;
        }
        let Some(now) = self.listening.now() else { return };
        let (track, is_held) = (self.listening.track_of(now), self.holds_picture());
        let picture = self.finish(begun);
        self.recording.record_picture(track, &now, &picture, is_held, clock::now());
    }

    pub(super) fn finish(&self, begun: Instant) -> Finish {
        let fraction = if self.holds_picture() { 1.0 } else { self.scene.composer.fading.fraction_held() };
        let is_shown = self.master_output.are_idle(begun)
            && (fraction == 0.0 || self.master_output.shown.held.is_some());
        Finish { numbers: [self.master_output.gain(begun), fraction], is_shown }
    }
}

impl Interface {
    pub(super) fn toggle_fullscreen(&mut self, screen: &mut dyn Screen) {
        let full = !screen.is_fullscreen();
        screen.set_fullscreen(full);
        if full {
            self.pointer_rest.sleep();
        }
    }

    /// Passes a key to the controls if they have the focus or get it. Returns `true` if they used the key.
    fn pass_to_controls(&mut self, screen: &mut dyn Screen, key: &Key, held: Modifiers) -> bool {
        let begins = *key == Key::Named(NamedKey::Tab)
            && (held.contains(Modifiers::SHIFT) || self.overlay.assisted)
            && self.ui_state.panels.open != Some(Panel::Corners);
        let others = Modifiers::CONTROL | Modifiers::ALT | Modifiers::SUPER;
        if !(begins || self.overlay.has_key_focus()) || held.intersects(others) {
            return false;
        }
        let taken = self.overlay.handle_key(key, held.contains(Modifiers::SHIFT));
        if taken {
            // Show the bar, which stays while it has the focus.
            self.pointer_rest.wake(clock::now());
            screen.request_redraw();
        }
        taken
    }
}
