//! The show: a song that plays, a window that shows it, keys that steer it.
//!
//! **A picture that would look the same is not drawn.** If no expression of a scene reads the time, nothing but the
//! sound moves it; while the features stay the same the show only listens.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};

use winit::event::{ElementState, KeyEvent, WindowEvent};
use winit::event_loop::EventLoop;

use super::announcer::next_repeat;
use super::error::AppError;
use super::keys::{self, Action};
use super::media_controls::Asked;
use super::opening::{Opening, renewed};
use super::pointer::Gesture;
use super::scene_regions::Shown;
use super::scene_stage::{Drawn, SceneLoader};
use super::stage::{IDLE_INTERVAL, Stage, show_sound};
use super::title::{live_title, title};
use super::window::{OpenWindow, WindowWishes};
use super::window_thread::{self, Message, Waker, inbox};
use crate::config::PlaySettings;
use crate::export::painter::SceneChoice;
use crate::export::print::{print_line, tell};
use crate::gpu::error::GpuError;
use crate::gpu::headless::Headless;
use crate::scenes::{Loader, ReadyScene, SceneSource, TextureCache};
use mariana_music::{self, TapTempo};
use mariana_player::PlayerStatus;
use mariana_player::playlist::Opened;

/// A context that is lost again this soon after it was made anew is not made again.
const RENEWED_AGAIN: Duration = Duration::from_secs(5);
/// How often the status (title, messages) is checked.
const STATUS_INTERVAL: Duration = Duration::from_millis(200);

/// Opens the window and plays `tracks` until the user quits, or until they end if they play once; without tracks it
/// listens to the input that the settings name.
///
/// # Errors
/// There is nothing to be played once, or the window cannot show it.
pub fn run(tracks: Option<Opened>, settings: PlaySettings, scene: SceneChoice) -> anyhow::Result<()> {
    let started = Instant::now();
    let unplayable = tracks.as_ref().filter(|tracks| !tracks.playable);
    if let (true, Some(trouble)) = (settings.once, unplayable.and_then(|tracks| tracks.troubles.last())) {
        return Err(AppError::SongLost(trouble.clone()).into());
    }
    let (waker, inbox) = inbox();
    let (loader, first) = load_first(&scene, &waker)?;
    let event_loop = match EventLoop::with_user_event().build() {
        Ok(event_loop) => event_loop,
        Err(_) if settings.gl_info => {
            let context = Headless::new(false)?;
            print_line(&format!("context              EGL without a window\n{}", context.gl().info()))?;
            return Ok(());
        }
        Err(error) => return Err(AppError::NoDisplay(reason(&error.to_string()).to_owned()).into()),
    };
    let name = tracks.as_ref().map_or("live", |tracks| tracks.first.info.name.as_str());
    let wishes = WindowWishes {
        title: format!("{name} - Mariana"),
        size: settings.size,
        visible: !settings.gl_info,
        log_debug: scene.verbose,
    };
    let of_show = waker.clone();
    let play = move |window: OpenWindow| {
        if settings.gl_info {
            return Ok(print_line(&window.bind()?.gl().info().to_string())?);
        }
        let opening = Opening { tracks, settings: &settings, scene: &scene, scene_at_start: (loader, first) };
        let stage = opening.stage(window, &of_show)?;
        let mut show = Show { dropped: Vec::new(), settings, started, stage, over: false };
        let mut renewed_at: Option<Instant> = None;
        loop {
            match show.go_on(&inbox) {
                Err(AppError::Gpu(GpuError::ContextLost { doing }))
                    if renewed_at.is_none_or(|at| at.elapsed() > RENEWED_AGAIN) =>
                {
                    tracing::warn!("the driver has lost its context while {doing}");
                    renewed_at = Some(Instant::now());
                    let stage = renewed(show.stage, &show.settings, &scene, &of_show)?;
                    show.stage = stage;
                }
                ended => {
                    tracing::info!("{}", show.stage.frame_times);
                    return ended;
                }
            }
        }
    };
    Ok(window_thread::run(event_loop, wishes, &waker, Box::new(play))?)
}

/// Starts the loader and waits for the scene at the start: without it there is no show.
fn load_first(
    scene: &SceneChoice,
    waker: &Waker,
) -> Result<(SceneLoader, (SceneSource, ReadyScene)), AppError> {
    let mut textures = TextureCache::default();
    let waker = waker.clone();
    let loader: SceneLoader =
        Loader::start(move |source| source.ready_with(&mut textures), move || waker.wake())
            .map_err(|error| AppError::Window { doing: "a thread", reason: error.to_string() })?;
    loader.request(scene.source.clone());
    let first = loop {
        match loader.poll() {
            Some(loaded) => break (loaded.source, loaded.value?),
            None => std::thread::sleep(Duration::from_millis(1)),
        }
    };
    Ok((loader, first))
}

/// What winit says, without the source location at its beginning.
fn reason(text: &str) -> &str {
    let reason = text.split_once(".rs:").and_then(|(_, rest)| rest.split_once(": "));
    reason.map_or(text, |(_, reason)| reason).trim_end_matches('.')
}

/// The show, on its thread.
struct Show {
    /// Files that were dropped onto the window and are not played yet.
    dropped: Vec<PathBuf>,
    settings: PlaySettings,
    started: Instant,
    /// Whether it is to end.
    over: bool,
    stage: Stage,
}

impl Show {
    /// Runs until somebody ends it.
    ///
    /// # Errors
    /// An error that the show cannot go on after.
    fn go_on(&mut self, inbox: &Receiver<Message>) -> Result<(), AppError> {
        loop {
            let until = self.look_around()?;
            if self.over {
                return Ok(());
            }
            let patience = until.saturating_duration_since(Instant::now());
            let first = match inbox.recv_timeout(patience) {
                Ok(message) => Some(message),
                Err(RecvTimeoutError::Timeout) => None,
                Err(RecvTimeoutError::Disconnected) => return Ok(()),
            };
            // However often a redraw was requested meanwhile, the window is drawn once.
            let mut redraws = false;
            for message in first.into_iter().chain(inbox.try_iter()) {
                match message {
                    Message::Window(WindowEvent::RedrawRequested) => redraws = true,
                    Message::Window(event) => self.take(&event),
                    Message::Wake => {}
                    Message::End => return Ok(()),
                }
            }
            if redraws || self.stage.scene.is_drawing() {
                self.draw()?;
            }
        }
    }

    fn draw(&mut self) -> Result<(), AppError> {
        let stage = &mut self.stage;
        let begun = Instant::now();
        // A picture whose regions have come was due before.
        if !stage.scene.has_regions() && !stage.scene.is_drawing() {
            stage.pacing.begun(begun);
        }
        stage.window_size = stage.window.size();
        let Some(size) = stage.window_size else { return Ok(()) };
        let Some(moment) = stage.moment() else { return Ok(()) };
        let level = stage.level(begun);
        let drawn = stage.drawn_size(level, size);
        if !stage.scene.is_ready() {
            return Ok(());
        }
        let wanted = Shown { moment, size: drawn, edges: level.edges, revision: stage.scene.revision() };
        let mut new = None;
        if stage.shown != Some(wanted) || stage.scene.is_drawing() {
            // The curves take longer than all other inputs of a frame, so they are only computed for scenes that read
            // them.
            let curves =
                if stage.scene.hears_curves() { stage.sound.heard().tables } else { Default::default() };
            let sound = mariana_music::Sound { features: moment.features, tables: curves };
            let aspect = f64::from(size.0) / f64::from(size.1.max(1));
            let drawn = stage.scene.draw(&mut stage.renderer, (moment, sound), (drawn, aspect, level));
            new = stage.without_room_smaller(drawn)?;
            if new.is_some() {
                stage.finish_picture(begun)?;
            } else {
                stage.weigh_picture(level, begun);
            }
        }
        let corner = stage.corner_line();
        let is_drawing = stage.scene.is_drawing();
        let mut content = stage.scene.overlay(corner.as_deref(), stage.sliders, stage.help);
        show_sound(&stage.sound, &stage.announcer, &mut content, begun);
        let Some(shown) = new.map(|new| new.shown).or(stage.shown) else { return Ok(()) };
        let handing_over = Instant::now();
        // Without a new picture there is something to show only if the overlay or the window changes.
        let waits = new.is_none() && (shown != wanted || is_drawing);
        if waits && stage.overlay.due(&content, begun).is_none_or(|due| due > begun) {
            return Ok(());
        }
        stage.renderer.show(size)?;
        let painted = stage.overlay.paint(stage.window.window(), size, content)?;
        let painting = handing_over.elapsed();
        stage.window.swap()?;
        let first = stage.shown.replace(shown).is_none();
        if let Some(Drawn { spent, .. }) = new {
            let showing = spent + handing_over.elapsed();
            stage.frame_times.note(showing);
            stage.note_cost(level, spent + painting, showing);
            stage.scene.note_frame_time(showing);
        }
        if painted.params_changed {
            stage.scene.note_moved();
        }
        if first {
            tracing::info!("first picture after {:.0} ms", self.started.elapsed().as_secs_f64() * 1000.0);
            stage.sound.set_paused(stage.paused);
        }
        Ok(())
    }

    fn act(&mut self, action: Action) {
        let stage = &mut self.stage;
        match action {
            Action::TogglePause => stage.set_paused(!stage.paused),
            Action::Seek(seconds) => stage.with_song(|player| player.seek_by(seconds)),
            Action::ChangeVolume(delta) => stage.with_song(|player| player.change_volume(delta)),
            Action::ToggleMute => stage.with_song(|player| player.toggle_mute()),
            Action::Tap => stage.tap(),
            Action::SkipTrack { forward } => stage.skip(forward),
            Action::ToggleShuffle => stage.set_order(|repeat, shuffled| (repeat, !shuffled)),
            Action::ChangeRepeat => stage.set_order(|repeat, shuffled| (next_repeat(repeat), shuffled)),
            Action::Shift(steps) => {
                let words = stage.sound.shift(steps);
                stage.announcer.answer(words);
            }
            Action::ChangeSource => {
                stage.taps = TapTempo::default();
                stage.sound.next_source();
            }
            Action::ToggleMode => stage.scene.toggle_mode(),
            Action::ToggleRegions => stage.scene.toggle_regions(),
            Action::ChangeView { forward } => stage.go_view(forward),
            Action::ChangeNumber { larger } => stage.scene.step_view(larger),
            Action::GiveCameraBack => stage.scene.give_camera_back(),
            Action::ChangeScene { forward } => stage.scene.go(forward),
            Action::ToggleSliders => stage.sliders = !stage.sliders,
            Action::ToggleCorner => stage.corner = !stage.corner,
            Action::ToggleFullscreen => stage.window.set_fullscreen(!stage.window.is_fullscreen()),
            Action::LeaveFullscreen => stage.window.set_fullscreen(false),
            Action::ToggleHelp => {
                stage.help = !stage.help;
                if let Err(error) = print_line(&keys::help()) {
                    tell(&error.to_string());
                }
            }
            Action::Quit => self.over = true,
        }
        stage.status_due = Instant::now();
    }

    /// Does what media keys and the desktop ask for.
    fn obey_controls(&mut self) {
        let stage = &mut self.stage;
        while let Some(asked) = stage.controls.poll() {
            match asked {
                Asked::Play(play) => stage.set_paused(!play),
                Asked::TogglePause => stage.set_paused(!stage.paused),
                Asked::Skip { forward } => stage.skip(forward),
                Asked::SeekBy(seconds) => stage.with_song(|player| player.seek_by(seconds)),
                Asked::SeekTo(seconds) => stage.with_song(|player| player.seek_to(seconds)),
                Asked::Volume(volume) => stage.with_song(|player| player.set_volume(volume)),
                Asked::Repeat(repeat) => stage.set_order(|_, shuffled| (repeat, shuffled)),
                Asked::Shuffle(shuffled) => stage.set_order(|repeat, _| (repeat, shuffled)),
                Asked::Fullscreen(on) => stage.window.set_fullscreen(on),
                Asked::Raise => stage.window.window().focus_window(),
                Asked::Quit => self.over = true,
            }
            stage.status_due = Instant::now();
        }
    }

    /// Title and messages, and the end of a song that plays once.
    fn look_at_status(&mut self) -> Result<(), AppError> {
        let stage = &mut self.stage;
        let now = Instant::now();
        if now < stage.status_due {
            return Ok(());
        }
        stage.status_due = now + STATUS_INTERVAL;
        if let Some(live) = stage.sound.live_status() {
            stage.set_title(live_title(&live, stage.scene.notes(), stage.paused));
            return Ok(());
        }
        let Some(status) = stage.sound.song_status() else { return Ok(()) };
        let status = PlayerStatus { paused: stage.paused, ..status };
        if status.silent != stage.told_silent {
            if let Some(reason) = status.silent.as_ref().filter(|_| !self.settings.silent) {
                tell(&format!("the song plays without sound: {reason}"));
            }
            stage.told_silent.clone_from(&status.silent);
        }
        if let (true, true, 1, Some(error)) =
            (status.ended, self.settings.once, status.track.count, &status.troubles.last)
        {
            return Err(AppError::SongLost(error.clone()));
        }
        stage.announcer.look(&status);
        stage.controls.show(&status, stage.window.is_fullscreen());
        let title = title(stage.scene.notes(), &status, self.settings.silent);
        stage.set_title(title);
        if status.ended && self.settings.once {
            self.over = true;
        }
        Ok(())
    }

    /// Handles an event of the window.
    fn take(&mut self, event: &WindowEvent) {
        let stage = &mut self.stage;
        if stage.overlay.on_event(stage.window.window(), event) {
            return;
        }
        match event {
            WindowEvent::Resized(size) => {
                stage.window.resize((*size).into());
                stage.window.window().request_redraw();
            }
            WindowEvent::DroppedFile(path) => self.dropped.push(path.clone()),
            WindowEvent::Occluded(occluded) => stage.occluded = *occluded,
            WindowEvent::ModifiersChanged(modifiers) => stage.shift = modifiers.state().shift_key(),
            WindowEvent::CursorMoved { .. }
            | WindowEvent::MouseInput { .. }
            | WindowEvent::MouseWheel { .. }
            | WindowEvent::Focused(_) => match stage.pointer.take(event, Instant::now()) {
                Some(Gesture::DoubleClick) => self.act(Action::ToggleFullscreen),
                Some(Gesture::Drag(way)) => {
                    let height = f64::from(stage.window.size().map_or(1, |(_, height)| height));
                    stage.scene.move_camera(|hand, own| hand.drag((way.0 / height, way.1 / height), own));
                }
                Some(Gesture::Zoom(notches)) => stage.scene.move_camera(|hand, _| hand.zoom(notches)),
                None => {}
            },
            WindowEvent::KeyboardInput {
                event: KeyEvent { logical_key, state: ElementState::Pressed, repeat, .. },
                is_synthetic: false,
                ..
            } => {
                if let Some(action) = keys::action_of(logical_key, *repeat, stage.shift) {
                    self.act(action);
                }
            }
            _ => {}
        }
    }

    /// Takes in what other threads have finished, requests a picture if one is due, and returns when to look again if
    /// nothing happens before.
    fn look_around(&mut self) -> Result<Instant, AppError> {
        self.obey_controls();
        self.look_at_status()?;
        let stage = &mut self.stage;
        if !self.dropped.is_empty() {
            stage.play_files(std::mem::take(&mut self.dropped));
        }
        stage.scene.update()?;
        let now = Instant::now();
        stage.announcer.update(now);
        if stage.scene.is_drawing() {
            return Ok(now);
        }
        let corner = stage.corner_line();
        let mut content = stage.scene.overlay(corner.as_deref(), stage.sliders, stage.help);
        show_sound(&stage.sound, &stage.announcer, &mut content, now);
        let overlay_due = stage.overlay.due(&content, now);
        let revision = stage.scene.revision();
        let moment = stage.moment();
        if stage.shown.is_none_or(|shown| moment != Some(shown.moment) || shown.revision != revision) {
            stage.moved = now;
        }
        let moving =
            stage.moved == now || stage.could_be_better(now) || overlay_due.is_some_and(|due| due <= now);
        // The first picture starts the song, seen or not.
        let seen = !stage.occluded || stage.shown.is_none();
        if !moving || !seen {
            // Paused, ended or covered: there is nothing to draw until something happens. In silence it may happen at
            // any time.
            let idle = now + stage.idle_interval(seen);
            let wake = overlay_due.filter(|_| seen).map_or(idle, |due| due.min(idle));
            Ok(wake)
        } else if now >= stage.pacing.due() || stage.scene.has_regions() {
            stage.window.window().request_redraw();
            Ok(now + IDLE_INTERVAL)
        } else {
            Ok(stage.pacing.due())
        }
    }
}
