//! Runs a show in a window: opens the window and starts the session on the show's thread.
//!
//! **Unchanged frames are not drawn.** If no expression of a scene reads the time, only the sound moves the scene.
//! While the features do not change, the show analyses the sound and draws nothing.

use std::time::Instant;

use winit::event::WindowEvent;
use winit::event_loop::EventLoop;

use crate::config::PlaySettings;
use crate::export::print::print_line;
use crate::gpu::headless::Headless;
use crate::session::SessionError;
use crate::session::desktop::DesktopControls;
use crate::session::{Opening, Prepared};
use crate::shell::media_controls::MediaControls;
use crate::shell::messages::{Message, Typing, WindowMessage, inbox};
use crate::shell::monitors::{self, around};
use crate::shell::output::Output;
use crate::shell::wallpaper::{FPS, Layers, Wall, Wallpaper, is_wayland, of_screen_saver};
use crate::shell::window::{Ground, OpenWindow, WindowOptions};
use crate::shell::window_screen::WindowScreen;
use crate::shell::window_thread;

/// Plays the tracks in a window, once or until the user quits. Without tracks, listens to the input in the settings.
///
/// # Errors
/// Fails if there is no track to play once, or the window cannot be opened or drawn.
pub fn run(prepared: Prepared) -> anyhow::Result<()> {
    let started = Instant::now();
    let (settings, ground) = on_ground(prepared.settings)?;
    let unplayable = prepared.tracks.as_ref().filter(|tracks| !tracks.playable);
    if let (true, Some(trouble)) = (settings.once, unplayable.and_then(|tracks| tracks.track_errors.last())) {
        return Err(SessionError::SongLost(trouble.clone()).into());
    }
    let (waker, messages, inbox) = inbox();
    let opening = Opening::start(Prepared { settings, ..prepared }, &waker)?;
    let Prepared { tracks, settings, scene, .. } = &opening.prepared;
    let event_loop = match EventLoop::with_user_event().build() {
        Ok(event_loop) => event_loop,
        Err(_) if settings.gl_info => {
            let context = Headless::new(false)?;
            print_line(&format!("context              {}\n{}", Headless::KIND, context.gl().info()))?;
            return Ok(());
        }
        Err(error) => return Err(SessionError::NoDisplay(reason(&error.to_string()).to_owned()).into()),
    };
    let layers = match ground {
        Some(Ground::Layers) => Some(Layers::start(&event_loop, &waker)?),
        _ => None,
    };
    let output_surfaces = layers.as_ref().map(Layers::output_surfaces);
    let name = tracks.as_ref().map_or("live", |tracks| tracks.first.info.name.as_str());
    let input_queue = WindowOptions {
        title: format!("{name} - Mariana"),
        size: settings.size,
        place: settings.place,
        visible: !settings.gl_info,
        log_debug: scene.verbose,
        ground,
    };
    let of_show = waker.clone();
    let (proxy, of_end) = (event_loop.create_proxy(), event_loop.create_proxy());
    // A wallpaper opens no files.
    let dropped = ground.is_none().then(|| messages.clone());
    let typing = Typing::default();
    let of_window = typing.clone();
    let play = move |window: OpenWindow| {
        let settings = &opening.prepared.settings;
        if settings.gl_info {
            return Ok(print_line(&window.bind()?.gl.info().to_string())?);
        }
        let output = Output::new(settings.choices.stage.output.clone(), proxy, &of_show);
        let wall = output_surfaces.clone().map(Wall::new);
        let wallpaper = settings.wallpaper.then(|| Wallpaper::start(output_surfaces, &of_show));
        let handle = window.handle();
        let screen = Box::new(WindowScreen::new(window, inbox, of_window, output, wallpaper, wall)?);
        #[cfg(windows)]
        crate::shell::console::close_if_own();
        let wake = of_show.waking();
        let desktop = move |position| -> Box<dyn DesktopControls> {
            let open = dropped
                .map(|show| move |file| drop(show.send(Message::Window(WindowEvent::DroppedFile(file)))));
            Box::new(MediaControls::start(position, Some(handle), wake, open))
        };
        // Without a window that listens, nothing waits for the message.
        let saved = || drop(of_end.send_event(WindowMessage::Saved));
        opening.run(screen, desktop, of_show, started)?.run(saved)
    };
    Ok(window_thread::run(event_loop, input_queue, messages, typing, layers, Box::new(play))?)
}

/// Adapts settings for a wallpaper or screen saver. Also returns its [`Ground`]; `None` for a normal window.
fn on_ground(mut settings: PlaySettings) -> anyhow::Result<(PlaySettings, Option<Ground>)> {
    let ground = if settings.wallpaper && is_wayland() {
        // XWayland windows cannot be the background of a Wayland desktop.
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
        // A wallpaper must not change the saved window.
        (settings.remembered, settings.fullscreen, settings.place) = (false, false, None);
    }
    Ok((settings, ground))
}

/// winit's message without the source location at its beginning.
fn reason(text: &str) -> &str {
    let reason = text.split_once(".rs:").and_then(|(_, rest)| rest.split_once(": "));
    reason.map_or(text, |(_, reason)| reason).trim_end_matches('.')
}
