//! The show: a song that plays, a window that shows it, keys that steer it.
//!
//! **A picture that would look the same is not drawn.** If no expression of a scene reads the time, nothing but the
//! sound moves it; while the features stay the same the show only listens.

use std::time::{Duration, Instant};

use winit::event_loop::EventLoop;

use crate::commands::{Command, Sender};
use crate::config::{Memory, PlaySettings};
use crate::export::painter::SceneChoice;
use crate::export::print::print_line;
use crate::gpu::error::GpuError;
use crate::gpu::headless::Headless;
use crate::scenes::{Drafts, Findings, Loader, NumberEdits, SceneSource, TextureCache};
use crate::session::SessionError;
use crate::session::feeds::Sends;
use crate::session::scene::{LoadedScene, SceneLoader, SceneLoaders};
use crate::session::screen::Event;
use crate::session::waker::Waker;
use crate::session::{Opening, Session, renewed};
use crate::shell::accessibility::ControlsTeller;
use crate::shell::media_controls::MediaControls;
use crate::shell::monitors;
use crate::shell::output::Output;
use crate::shell::wallpaper::{FPS, Layers, Wallpaper, around, is_wayland, of_screen_saver};
use crate::shell::window::{Ground, OpenWindow, WindowWishes};
use crate::shell::window_screen::{Lines, WindowScreen};
use crate::shell::window_thread::{self, Typing, inbox};
use mariana_player::playlist::Opened;

/// A context that is lost again this soon after it was made anew is not made again.
const RENEWED_AGAIN: Duration = Duration::from_secs(5);

/// Opens the window and plays `tracks` until the user quits, or until they end if they play once; without tracks it
/// listens to the input that the settings name.
///
/// # Errors
/// There is nothing to be played once, or the window cannot show it.
pub fn run(
    tracks: Option<Opened>,
    settings: PlaySettings,
    scene: SceneChoice,
    memory: Memory,
) -> anyhow::Result<()> {
    let started = Instant::now();
    let (settings, ground) = on_ground(settings)?;
    let unplayable = tracks.as_ref().filter(|tracks| !tracks.playable);
    if let (true, Some(trouble)) = (settings.once, unplayable.and_then(|tracks| tracks.troubles.last())) {
        return Err(SessionError::SongLost(trouble.clone()).into());
    }
    // A place that nothing can be sent to ends it before anything shows.
    let sends = Sends::start(&settings.sends, settings.send_size.unwrap_or(settings.size), settings.send_fps)
        .map_err(SessionError::from)?;
    let (waker, messages, inbox) = inbox();
    let drafts = Drafts::default();
    let (shown, first) = load_first(&scene, &waker, &drafts)?;
    let ahead = match settings.prepare_ahead {
        true => Some([start_loader(&waker, &drafts)?, start_loader(&waker, &drafts)?]),
        false => None,
    };
    let loaders = SceneLoaders { shown, ahead };
    let event_loop = match EventLoop::with_user_event().build() {
        Ok(event_loop) => event_loop,
        Err(_) if settings.gl_info => {
            let context = Headless::new(false)?;
            print_line(&format!("context              EGL without a window\n{}", context.gl().info()))?;
            return Ok(());
        }
        Err(error) => return Err(SessionError::NoDisplay(reason(&error.to_string()).to_owned()).into()),
    };
    let layers = match ground {
        Some(Ground::Layers) => Some(Layers::start(&event_loop, &waker)?),
        _ => None,
    };
    let sheets = layers.as_ref().map(Layers::sheets);
    let name = tracks.as_ref().map_or("live", |tracks| tracks.first.info.name.as_str());
    let wishes = WindowWishes {
        title: format!("{name} - Mariana"),
        size: settings.size,
        place: settings.place,
        visible: !settings.gl_info,
        log_debug: scene.verbose,
        ground,
    };
    let of_show = waker.clone();
    let (controls, proxy) = (ControlsTeller::new(&event_loop), event_loop.create_proxy());
    let typing = Typing::default();
    let of_window = typing.clone();
    let play = move |window: OpenWindow| {
        if settings.gl_info {
            return Ok(print_line(&window.bind()?.gl().info().to_string())?);
        }
        let output = Output::new(settings.choices.stage.output.clone(), proxy, &of_show);
        let wallpaper = settings.wallpaper.then(|| Wallpaper::start(sheets, &of_show));
        let lines = Lines { inbox, controls, typing: of_window };
        let screen = Box::new(WindowScreen::new(window, lines, output, wallpaper)?);
        let of_desktop = of_show.clone();
        let opening = Opening {
            tracks,
            settings: &settings,
            scene: &scene,
            memory,
            loaders,
            first,
            drafts,
            sends,
            screen,
            desktop: Box::new(move |position| {
                Box::new(MediaControls::start(position, move || of_desktop.wake()))
            }),
        };
        let stage = opening.stage(&of_show)?;
        let mut show = Show { settings, started, stage, over: false };
        let mut renewed_at: Option<Instant> = None;
        loop {
            match show.go_on() {
                Err(SessionError::Gpu(GpuError::ContextLost { doing }))
                    if renewed_at.is_none_or(|at| at.elapsed() > RENEWED_AGAIN) =>
                {
                    tracing::warn!("the driver has lost its context while {doing}");
                    renewed_at = Some(Instant::now());
                    let stage = renewed(show.stage, &show.settings, &scene, &of_show)?;
                    show.stage = stage;
                }
                ended => {
                    if ended.is_ok() {
                        show.stage.leave_to_the_next(&show.settings);
                    }
                    tracing::info!("{}", show.stage.frame_times());
                    tracing::info!("{}", show.stage.typing_times());
                    tracing::info!("from message to frame: {}", show.stage.message_times());
                    return ended;
                }
            }
        }
    };
    Ok(window_thread::run(event_loop, wishes, messages, typing, layers, Box::new(play))?)
}

/// The settings of a run whose window is the desktop's ground, or in a screen saver's window; others as they are.
///
/// # Errors
/// There is nothing to draw on.
fn on_ground(mut settings: PlaySettings) -> anyhow::Result<(PlaySettings, Option<Ground>)> {
    let ground = if settings.wallpaper && is_wayland() {
        // A window of XWayland is no ground of a Wayland desktop.
        Some(Ground::Layers)
    } else if settings.wallpaper {
        let monitors =
            monitors::present().map_err(|reason| anyhow::anyhow!("{reason}: start Mariana there"))?;
        Some(Ground::Desktop(around(&monitors).ok_or(SessionError::NoMonitor)?))
    } else {
        of_screen_saver().map_err(anyhow::Error::msg)?.map(|(window, size)| Ground::Within(window, size))
    };
    if let Some(ground) = &ground {
        if let Ground::Desktop((_, size)) | Ground::Within(_, size) = ground {
            settings.size = *size;
        }
        settings.fps_cap = settings.fps_cap.or(Some(FPS));
        settings.choices.hints = false;
        settings.choices.stage.output = None;
        // It takes no window's place.
        (settings.remembered, settings.fullscreen, settings.place) = (false, false, None);
    }
    Ok((settings, ground))
}

/// Starts the loader and waits for the scene at the start: without it there is no show.
fn load_first(
    scene: &SceneChoice,
    waker: &Waker,
    drafts: &Drafts,
) -> Result<(SceneLoader, LoadedScene), SessionError> {
    let loader = start_loader(waker, drafts)?;
    loader.request(scene.source.clone());
    let first = loop {
        match loader.poll() {
            Some(loaded) => break LoadedScene { source: loaded.source, scene: loaded.value? },
            None => std::thread::sleep(Duration::from_millis(1)),
        }
    };
    Ok((loader, first))
}

/// Starts a loader that has nothing to load yet. It tells an editor what it found.
fn start_loader(waker: &Waker, drafts: &Drafts) -> Result<SceneLoader, SessionError> {
    let (mut textures, mut edits) = (TextureCache::default(), NumberEdits::default());
    let waker = waker.clone();
    let drafts = drafts.clone();
    let load = move |source: &SceneSource| {
        let texts = drafts.texts();
        let (result, files) = source.ready_with(&mut textures, &mut edits, &texts);
        drafts.tell(Findings::of(source, &texts, &result));
        (result, files)
    };
    Loader::start(load, move || waker.wake())
        .map_err(|error| SessionError::Window { doing: "a thread", reason: error.to_string() })
}

/// What winit says, without the source location at its beginning.
fn reason(text: &str) -> &str {
    let reason = text.split_once(".rs:").and_then(|(_, rest)| rest.split_once(": "));
    reason.map_or(text, |(_, reason)| reason).trim_end_matches('.')
}

/// The show, on its thread.
struct Show {
    settings: PlaySettings,
    started: Instant,
    /// Whether it is to end.
    over: bool,
    stage: Session,
}

impl Show {
    /// Runs until somebody ends it.
    ///
    /// # Errors
    /// An error that the show cannot go on after.
    fn go_on(&mut self) -> Result<(), SessionError> {
        loop {
            let until = self.look_around()?;
            if self.over {
                return Ok(());
            }
            let mut redraws = false;
            for event in self.stage.screen.wait(until) {
                match event {
                    Event::Input(input) => {
                        if let Some(command) = self.stage.take(&input) {
                            self.carry_out(command, Sender::Window);
                        }
                        let is_text = self.stage.takes_text();
                        self.stage.screen.set_keys_are_text(is_text);
                    }
                    Event::Assistance(assistance) => self.stage.assist(assistance),
                    Event::Redraw => redraws = true,
                    Event::End => return Ok(()),
                }
            }
            self.stage.follow_editor();
            if redraws || self.stage.scene.composer().is_drawing() {
                self.draw()?;
            }
        }
    }

    /// Takes in what has happened, and returns when to look again if nothing happens before.
    fn look_around(&mut self) -> Result<Instant, SessionError> {
        self.obey_desktop();
        self.obey_controllers();
        self.over |= self.stage.look_at_status(&self.settings)?;
        self.stage.remember_show(&self.settings, Instant::now());
        let until = self.stage.look_around()?;
        Ok(self.stage.hands_due().map_or(until, |due| until.min(due)))
    }

    fn draw(&mut self) -> Result<(), SessionError> {
        if self.stage.draw()? {
            tracing::info!("first picture after {:.0} ms", self.started.elapsed().as_secs_f64() * 1000.0);
        }
        for command in self.stage.take_ui_events() {
            self.carry_out(command, Sender::Window);
        }
        Ok(())
    }

    /// Carries out a command.
    fn carry_out(&mut self, command: Command, sender: Sender) {
        self.over |= command == Command::Quit;
        self.stage.carry_out(command, sender);
    }

    /// Carries out the commands of controllers.
    fn obey_controllers(&mut self) {
        for action in self.stage.take_wishes() {
            match Command::of_controller(&action) {
                Some(command) => self.carry_out(command, Sender::Controller),
                None => self.stage.hurry_reports(),
            }
        }
    }

    /// Carries out the commands of media keys and the desktop.
    fn obey_desktop(&mut self) {
        while let Some(command) = self.stage.command_of_desktop() {
            self.carry_out(command, Sender::Desktop);
        }
    }
}
