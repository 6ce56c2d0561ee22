//! The show: a song that plays, a window that shows it, keys that steer it.

use std::path::PathBuf;
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

use winit::application::ApplicationHandler;
use winit::event::{ElementState, KeyEvent, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop, EventLoopProxy};
use winit::window::WindowId;

use super::announcer::{Announcer, next_repeat};
use super::error::AppError;
use super::frame_times::FrameTimes;
use super::governor::Governor;
use super::keys::{self, Action};
use super::media_controls::{Asked, MediaControls};
use super::overlay::Overlay;
use super::pacing::Pacing;
use super::pointer::{Gesture, Pointer};
use super::scene_regions::Shown;
use super::scene_stage::{SceneLoader, SceneStage};
use super::sound::{Sound, Start};
use super::stage::{IDLE_INTERVAL, Stage, show_sound};
use super::title::{live_title, title};
use super::window::GlWindowContext;
use crate::audio::playlist::Opened;
use crate::audio::{OutputChoice, Player, PlayerOptions, PlayerStatus};
use crate::config::PlaySettings;
use crate::dsp::{self, TapTempo};
use crate::export::painter::SceneChoice;
use crate::export::print::{print_line, tell};
use crate::gpu::headless::Headless;
use crate::gpu::renderer::{Counting, Renderer};
use crate::scenes::{Loader, ReadyScene, SceneSource, TextureCache};

/// Frame cap where the monitor tells no rate.
const FPS_DEFAULT: f64 = 60.0;
/// Threads that compile programs: one for the scene's own, one for the interpreter's.
const COMPILERS: usize = 2;
/// How often status (title, messages) is looked at.
const STATUS_INTERVAL: Duration = Duration::from_millis(200);

/// Opens the window and plays `tracks` until the user quits, or until they end if they play once; without tracks it
/// listens to what the settings tell.
///
/// # Errors
/// There is nothing to be played once, or the window cannot show it.
pub fn run(tracks: Option<Opened>, settings: PlaySettings, scene: SceneChoice) -> anyhow::Result<()> {
    let started = Instant::now();
    let unplayable = tracks.as_ref().filter(|tracks| !tracks.playable);
    if let (true, Some(trouble)) = (settings.once, unplayable.and_then(|tracks| tracks.troubles.last())) {
        return Err(AppError::SongLost(trouble.clone()).into());
    }
    let waker = Waker::default();
    let (loader, first) = load_first(&scene, &waker)?;
    let event_loop = match EventLoop::new() {
        Ok(event_loop) => event_loop,
        Err(_) if settings.gl_info => {
            let context = Headless::new(false)?;
            print_line(&format!("context              EGL without a window\n{}", context.gl().info()))?;
            return Ok(());
        }
        Err(error) => return Err(AppError::NoDisplay(reason(&error.to_string()).to_owned()).into()),
    };
    // There is one event loop, and it is set here alone.
    let _ = waker.0.set(event_loop.create_proxy());
    let mut show = Show {
        waker,
        loader: Some((loader, first)),
        tracks,
        dropped: Vec::new(),
        settings,
        scene,
        started,
        stage: None,
        error: None,
    };
    event_loop
        .run_app(&mut show)
        .map_err(|error| AppError::Window { doing: "to run", reason: error.to_string() })?;
    show.error.map_or(Ok(()), |error| Err(error.into()))
}

/// Wakes the event loop from other threads, once there is one.
#[derive(Clone, Default)]
struct Waker(Arc<OnceLock<EventLoopProxy<()>>>);

impl Waker {
    fn wake(&self) {
        if let Some(proxy) = self.0.get() {
            // After the end there is nobody to wake.
            let _ = proxy.send_event(());
        }
    }
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

/// What winit says, without the place in its source that it begins with.
fn reason(text: &str) -> &str {
    let reason = text.split_once(".rs:").and_then(|(_, rest)| rest.split_once(": "));
    reason.map_or(text, |(_, reason)| reason).trim_end_matches('.')
}

/// Everything that lives as long as the event loop.
struct Show {
    /// Taken by the player when the window stands.
    tracks: Option<Opened>,
    /// Files that were dropped onto the window and are not played yet.
    dropped: Vec<PathBuf>,
    settings: PlaySettings,
    scene: SceneChoice,
    /// Taken by the stage when the window stands, with the first scene.
    loader: Option<(SceneLoader, (SceneSource, ReadyScene))>,
    waker: Waker,
    started: Instant,
    stage: Option<Stage>,
    error: Option<AppError>,
}

impl Show {
    fn open(&mut self, event_loop: &ActiveEventLoop) -> Result<(), AppError> {
        let settings = &self.settings;
        let name = self.tracks.as_ref().map_or("live", |tracks| tracks.first.info.name.as_str());
        let title = format!("{name} - Mariana");
        let window =
            GlWindowContext::open(event_loop, &title, settings.size, !settings.gl_info, self.scene.verbose)?;
        if settings.gl_info {
            event_loop.exit();
            return Ok(print_line(&window.gl().info().to_string())?);
        }
        if settings.fullscreen {
            window.set_fullscreen(true);
        }
        let library = &self.scene.shaders;
        let mut renderer = Renderer::new(window.gl(), library, Counting::Off)?;
        renderer.prepare_for_window(library)?;
        if settings.limit_flashes {
            renderer.add_flash_limiter(library)?;
        }
        renderer.set_tone_map(self.scene.tone_map);
        let Some((loader, first)) = self.loader.take() else { return Ok(()) };
        let contexts = window.worker_contexts(COMPILERS);
        let waker = self.waker.clone();
        let wake = move || waker.wake();
        let scene = SceneStage::new(
            window.gl(),
            contexts,
            library,
            (self.scene.sdf, self.scene.regions, self.scene.view),
            loader,
            first,
            wake,
        )?;
        // The song starts with the first picture, so that nothing of it is missed.
        let options = PlayerOptions {
            device: settings.device.clone(),
            volume: settings.volume,
            paused: true,
            output: if settings.silent { OutputChoice::Silent } else { OutputChoice::Auto },
            gain: settings.gain,
            ..PlayerOptions::default()
        };
        let mut announcer = Announcer::default();
        let mut player = None;
        if let Some(tracks) = self.tracks.take() {
            for trouble in tracks.troubles {
                tell(&trouble);
                announcer.say(trouble);
            }
            let (repeat, shuffled) = (tracks.repeat, tracks.shuffled);
            let options = PlayerOptions { repeat, shuffled, ..options };
            player = Some(Player::start(tracks.first, Box::new(tracks.list), options)?);
        }
        let sound = Sound::start(Start {
            player,
            listen: settings.listen,
            device: settings.device.clone(),
            latency: settings.latency,
            gain: settings.gain,
        })?;
        let fps = settings.fps_cap.or_else(|| window.refresh_rate()).unwrap_or(FPS_DEFAULT);
        let now = Instant::now();
        self.stage = Some(Stage {
            sound,
            taps: TapTempo::default(),
            paused: false,
            renderer,
            scene,
            pacing: Pacing::new(fps, now),
            shown: None,
            frame_times: FrameTimes::default(),
            governor: Governor::new(settings.quality, fps),
            window_size: None,
            moved: now,
            pictured: None,
            status_due: now,
            told_silent: None,
            announcer,
            controls: {
                let waker = self.waker.clone();
                MediaControls::start(move || waker.wake())
            },
            title,
            pointer: Pointer::default(),
            shift: false,
            occluded: false,
            overlay: Overlay::new(window.gl(), window.window()),
            help: false,
            sliders: false,
            corner: false,
            window,
        });
        Ok(())
    }

    fn draw(&mut self) -> Result<(), AppError> {
        let Some(stage) = &mut self.stage else { return Ok(()) };
        let begun = Instant::now();
        // A picture whose regions have come is one that was due before.
        if !stage.scene.has_regions() {
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
        if stage.shown != Some(wanted) {
            // Its curves take longer than all the rest of a frame's inputs: only for scenes that read them.
            let curves =
                if stage.scene.hears_curves() { stage.sound.heard().tables } else { Default::default() };
            let sound = dsp::Sound { features: moment.features, tables: curves };
            let aspect = f64::from(size.0) / f64::from(size.1.max(1));
            new = stage.scene.draw(&mut stage.renderer, (moment, sound), (drawn, aspect, level))?;
            if new.is_some() {
                stage.finish_picture(begun)?;
            }
        }
        let corner = stage.corner_line();
        let mut content = stage.scene.overlay(corner.as_deref(), stage.sliders, stage.help);
        show_sound(&stage.sound, &stage.announcer, &mut content, begun);
        let Some(shown) = new.or(stage.shown) else { return Ok(()) };
        // Without a new picture there is something to show only if what stands over it changes, or the window.
        let waits = new.is_none() && shown != wanted && shown.size == drawn;
        if waits && stage.overlay.due(&content, begun).is_none_or(|due| due > begun) {
            return Ok(());
        }
        stage.renderer.show(size)?;
        let painted = stage.overlay.paint(stage.window.window(), size, content)?;
        let drawing = begun.elapsed();
        stage.window.swap()?;
        let first = stage.shown.replace(shown).is_none();
        if new.is_some() {
            stage.frame_times.note(begun.elapsed());
            stage.note_cost(level, drawing, begun.elapsed());
            stage.scene.note_frame_time(begun.elapsed());
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

    fn act(&mut self, action: Action, event_loop: &ActiveEventLoop) {
        let Some(stage) = &mut self.stage else { return };
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
            Action::Quit => event_loop.exit(),
        }
        stage.status_due = Instant::now();
    }

    /// Does what media keys and the desktop ask for.
    fn obey_controls(&mut self, event_loop: &ActiveEventLoop) {
        while let Some(asked) = self.stage.as_ref().and_then(|stage| stage.controls.poll()) {
            let Some(stage) = &mut self.stage else { return };
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
                Asked::Quit => event_loop.exit(),
            }
            stage.status_due = Instant::now();
        }
    }

    /// Title and messages, and the end of a song that plays once.
    fn look_at_status(&mut self, event_loop: &ActiveEventLoop) {
        let Some(stage) = &mut self.stage else { return };
        let now = Instant::now();
        if now < stage.status_due {
            return;
        }
        stage.status_due = now + STATUS_INTERVAL;
        if let Some(live) = stage.sound.live_status() {
            return stage.set_title(live_title(&live, stage.scene.notes(), stage.paused));
        }
        let Some(status) = stage.sound.song_status() else { return };
        let status = PlayerStatus { paused: stage.paused, ..status };
        if status.silent != stage.told_silent {
            if let Some(reason) = status.silent.as_ref().filter(|_| !self.settings.silent) {
                tell(&format!("the song runs without sound: {reason}"));
            }
            stage.told_silent.clone_from(&status.silent);
        }
        if let (true, true, 1, Some(error)) =
            (status.ended, self.settings.once, status.track.count, &status.troubles.last)
        {
            return self.fail(AppError::SongLost(error.clone()), event_loop);
        }
        stage.announcer.look(&status);
        stage.controls.show(&status, stage.window.is_fullscreen());
        let title = title(stage.scene.notes(), &status, self.settings.silent);
        stage.set_title(title);
        if status.ended && self.settings.once {
            event_loop.exit();
        }
    }

    fn fail(&mut self, error: AppError, event_loop: &ActiveEventLoop) {
        self.error.get_or_insert(error);
        event_loop.exit();
    }
}

impl ApplicationHandler for Show {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        if self.stage.is_none()
            && self.error.is_none()
            && let Err(error) = self.open(event_loop)
        {
            self.fail(error, event_loop);
        }
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _window: WindowId, event: WindowEvent) {
        let Some(stage) = &mut self.stage else { return };
        if stage.overlay.on_event(stage.window.window(), &event) {
            return;
        }
        match event {
            // Destroyed: closed by others without asking.
            WindowEvent::CloseRequested | WindowEvent::Destroyed => event_loop.exit(),
            WindowEvent::Resized(_) => {
                stage.window.resize();
                stage.window.window().request_redraw();
            }
            WindowEvent::DroppedFile(path) => self.dropped.push(path),
            WindowEvent::Occluded(occluded) => stage.occluded = occluded,
            WindowEvent::ModifiersChanged(modifiers) => stage.shift = modifiers.state().shift_key(),
            WindowEvent::CursorMoved { .. }
            | WindowEvent::MouseInput { .. }
            | WindowEvent::MouseWheel { .. }
            | WindowEvent::Focused(_) => match stage.pointer.take(&event, Instant::now()) {
                Some(Gesture::DoubleClick) => self.act(Action::ToggleFullscreen, event_loop),
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
                if let Some(action) = keys::action_of(&logical_key, repeat, stage.shift) {
                    self.act(action, event_loop);
                }
            }
            WindowEvent::RedrawRequested if !event_loop.exiting() => {
                if let Err(error) = self.draw() {
                    self.fail(error, event_loop);
                }
            }
            _ => {}
        }
    }

    fn about_to_wait(&mut self, event_loop: &ActiveEventLoop) {
        self.obey_controls(event_loop);
        self.look_at_status(event_loop);
        let Some(stage) = &mut self.stage else { return };
        if !self.dropped.is_empty() {
            stage.play_files(std::mem::take(&mut self.dropped));
        }
        if let Err(error) = stage.scene.update() {
            return self.fail(error.into(), event_loop);
        }
        let now = Instant::now();
        let corner = stage.corner_line();
        stage.announcer.update(now);
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
            // Paused, ended or covered: nothing to draw until something happens. In silence it may happen at any time.
            let idle = now + stage.idle_interval(seen);
            let wake = overlay_due.filter(|_| seen).map_or(idle, |due| due.min(idle));
            event_loop.set_control_flow(ControlFlow::WaitUntil(wake));
        } else if now >= stage.pacing.due() || stage.scene.has_regions() {
            stage.window.window().request_redraw();
            event_loop.set_control_flow(ControlFlow::WaitUntil(now + IDLE_INTERVAL));
        } else {
            event_loop.set_control_flow(ControlFlow::WaitUntil(stage.pacing.due()));
        }
    }

    fn exiting(&mut self, _event_loop: &ActiveEventLoop) {
        if let Some(stage) = &self.stage {
            tracing::info!("{}", stage.frame_times);
            // What still waits for a driver does so unseen.
            stage.window.window().set_visible(false);
        }
        // While the event loop's display still lives.
        self.stage = None;
    }
}
