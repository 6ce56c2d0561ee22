//! The start of a session: creates everything that lives as long as the window, on the session's thread.
//!
//! **A lost context is replaced.** When the driver reports a lost context, `renewed` drops the context's objects while
//! the context is still current, and recreates them from the parsed scenes, which are plain values. The song is not
//! affected. If memory is missing for a frame, a smaller frame is drawn. `faults` lets tests cause both failures.

use std::sync::Arc;
use std::time::Instant;

use super::drawing::paint_waiting;
use super::loading::FirstScene;
use super::preview::Preview;
use super::ui_state::UiState;
use super::video_making::VideoMaking;
use super::{Interface, Playback, Run, Session};
use crate::clock;
use crate::config::{Choices, DEFAULT_DEVICE, Folders, Memory, PerformanceFiles, PlaySettings};
use crate::export::{SceneChoice, print_message};
use crate::gpu::{Counting, Gl, GpuError, Renderer, Sources};
use crate::scenes::Drafts;
use crate::sending::Sending;
use crate::session::SessionError;
use crate::session::controllers::Controllers;
use crate::session::desktop::DesktopControls;
use crate::session::direction::Direction;
use crate::session::drawing_pace::DrawingPace;
use crate::session::frame_senders::FrameSenders;
use crate::session::listening::Listening;
use crate::session::master_output::MasterOutput;
use crate::session::music_lists::MusicLists;
use crate::session::recording::Recording;
use crate::session::reports::Reports;
use crate::session::scene::{DrawingChoice, DrawingWays, LoadedScene, SceneLoaders, SceneSession};
use crate::session::screen::Screen;
use crate::session::sound::Sound;
use crate::session::waker::Waker;
use crate::song_structures::{SongReader, structure_cache};
use crate::ui::overlay::Assistance;
use crate::ui::overlay::{Acts, Overlay, OverlayContent};
use crate::ui::pointer_rest::PointerRest;
use crate::ui::user_input::UserInput;
use crate::videos::Videos;
use mariana_player::playlist::Opened;
use mariana_player::{Player, PlayerOptions, Position, Target};

/// Frame rate limit if the monitor reports no rate.
const FPS_DEFAULT: f64 = 60.0;
/// Threads that compile programs: one for the scene's own program, one for the interpreter.
const COMPILERS: usize = 2;

/// Everything that a session plays and shows.
pub struct Prepared {
    /// The tracks; `None` for an audio input only.
    pub tracks: Option<Opened>,
    /// The settings of playback and window.
    pub settings: PlaySettings,
    /// The choice of scenes, and how they are drawn.
    pub scene: SceneChoice,
    /// The saved settings and their folders.
    pub memory: Memory,
}

/// A session that begins when there is a window. Its senders and loaders run already.
pub struct Opening {
    pub(crate) prepared: Prepared,
    first: FirstScene,
    drafts: Drafts,
    sends: Vec<Sending>,
}

impl Opening {
    /// Starts the senders and the loaders, and waits a moment for the first scene.
    ///
    /// # Errors
    /// Fails if a sender or the scene fails, or the system has no thread left.
    pub fn start(prepared: Prepared, waker: &Waker) -> Result<Self, SessionError> {
        // Start the senders first, so that a failing sender ends the program before a window opens.
        let sends = FrameSenders::start(&prepared.settings)?;
        let drafts = Drafts::default();
        let first = FirstScene::request(&prepared, &drafts, waker)?;
        Ok(Self { prepared, first, drafts, sends })
    }

    /// Begins the session. `desktop` creates the desktop's media controls, which query the position in the song.
    /// `started` is the time of the program's start.
    ///
    /// # Errors
    /// Fails if the scene or the song cannot be shown, or a thread cannot be started.
    pub fn run(
        self,
        mut screen: Box<dyn Screen>,
        desktop: impl FnOnce(Option<Position>) -> Box<dyn DesktopControls>,
        waker: Waker,
        started: Instant,
    ) -> Result<Run, SessionError> {
        let Self { prepared, first, drafts, sends } = self;
        let Prepared { tracks, settings, scene: choice, memory } = prepared;
        let choices = settings.choices.clone();
        tracing::info!("choices of this run: {choices:?}");
        // Start the analysis first, so that the song is analysed before its first frame.
        let folders = memory.folders.clone();
        let songs = SongReader::start(structure_cache(&folders), waker.waking());
        songs.request(tracks.iter().map(|tracks| &tracks.first.info));
        if settings.fullscreen {
            screen.set_fullscreen(true);
        }
        // Request the scene first: the driver compiles its program while everything else is created.
        let (scene, title, message) = start_first(first, &mut *screen, &settings, &choice, &waker)?;
        let mut overlay = Overlay::new(screen.gl(), waker.waking());
        paint_waiting(&mut *screen, &mut overlay, &title, OverlayContent::default())?;
        let waits_since = clock::now();
        tracing::info!("the window shows the name of the scene being prepared");
        let renderer = renderer(screen.gl(), &choices, &choice)?;
        let troubles = tracks.iter().flat_map(|tracks| tracks.track_errors.clone());
        let troubles: Vec<String> = troubles.inspect(|trouble| print_message(trouble)).collect();
        let player = tracks.map(|tracks| start_player(tracks, &settings)).transpose()?;
        let position = player.as_ref().map(Player::position);
        let sound = Sound::start(player, output_of(&settings), memory, &settings)?;
        let mut reports = Reports::new(desktop(position), clock::now());
        message.into_iter().chain(troubles).for_each(|notice| reports.announce(notice));
        let fps = settings.fps_cap.or_else(|| screen.refresh_rate()).unwrap_or(FPS_DEFAULT);
        let now = clock::now();
        let (show, follow) = (settings.show.clone(), settings.choices.follow_song);
        let direction = Direction::start(show, follow, settings.names_scene, waker.waking())
            .map_err(|error| SessionError::NoThread(error.to_string()))?;
        let brightness = f32::from(choices.stage.brightness) / 100.0;
        let playback = Playback {
            listening: Listening::start(sound, songs, &folders, &waker),
            scene,
            direction,
            live: None,
            cues: Default::default(),
            controllers: Controllers::start(&settings.controllers, &folders, &waker),
            renderer,
            shaders: choice.shaders.clone(),
            pace: DrawingPace::new(choices.quality, fps, screen.gl().info().software, now),
            master_output: MasterOutput::new(brightness, choices.stage.blackout_fade),
            first_shown_after: None,
            preview: Preview::new(),
            frame_senders: FrameSenders::of(sends, &settings),
            recording: Recording::new(PerformanceFiles::among(&folders)),
            reports,
        };
        let videos = VideoMaking::start(Videos::start(&folders, waker.waking()));
        let interface = start_interface(overlay, drafts, folders, choices.hints, &waker);
        let session = Session {
            playback,
            interface,
            choices,
            names_output: settings.device.is_some() || settings.silent,
            waits_since,
            waited: None,
            legacy: Default::default(),
            snapshots: Default::default(),
            surprises: Default::default(),
            videos,
            pictures: Default::default(),
            screen,
        };
        Ok(Run { settings, scene: choice, waker, started, over: false, renewed_at: None, session })
    }
}

fn start_interface(
    overlay: Overlay,
    drafts: Drafts,
    folders: Folders,
    hints: bool,
    waker: &Waker,
) -> Interface {
    Interface {
        overlay,
        ui_state: UiState::new(!hints),
        input: UserInput::default(),
        pointer_rest: PointerRest::default(),
        acts: Acts::default(),
        drafts,
        probing: Default::default(),
        shader_import: Default::default(),
        typing_times: Default::default(),
        thumbnails: None,
        lists: MusicLists::start(&folders, waker),
        folders,
        waker: waker.clone(),
    }
}

/// Waits for the first scene and starts it. Until then, the window shows its name. Returns also the scene's title, and a
/// message if it is another scene than the last show's.
fn start_first(
    first: FirstScene,
    screen: &mut dyn Screen,
    settings: &PlaySettings,
    choice: &SceneChoice,
    waker: &Waker,
) -> Result<(SceneSession, String, Option<String>), SessionError> {
    if first.loaded.is_none() {
        let mut overlay = Overlay::new(screen.gl(), || ());
        paint_waiting(screen, &mut overlay, &first.requested.title(), OverlayContent::default())?;
    }
    let (loaders, first, message) = first.wait()?;
    let (title, is_chosen) = (first.source.title(), first.source == choice.source);
    let SceneChoice { sdf, cells, view, projection, .. } = *choice;
    let drawn = DrawingChoice { sdf, cells };
    let ways = DrawingWays { choice: drawn, view, projection, fade: settings.fade };
    let mut scene = start_scene(screen, settings, choice, ways, loaders, first, waker)?;
    if is_chosen {
        scene.parameters.remember(&title, &settings.moved);
    }
    Ok((scene, title, message))
}

fn start_scene(
    screen: &dyn Screen,
    settings: &PlaySettings,
    choice: &SceneChoice,
    ways: DrawingWays,
    loaders: SceneLoaders,
    first: LoadedScene,
    waker: &Waker,
) -> Result<SceneSession, SessionError> {
    let library = choice.shaders.clone();
    let sources = match settings.program_cache.clone() {
        Some(cache) => Sources { library, cache },
        None => Sources { library, cache: Arc::new(()) },
    };
    let contexts = screen.worker_contexts(COMPILERS);
    Ok(SceneSession::new(screen.gl(), contexts, sources, ways, loaders, first, waker.waking())?)
}

/// Starts the player. It waits for the first frame, so that nothing of the song is missed.
fn start_player(tracks: Opened, settings: &PlaySettings) -> Result<Player, SessionError> {
    let options = PlayerOptions {
        output: output_of(settings),
        volume: settings.volume,
        paused: true,
        gain: settings.choices.gain,
        repeat: tracks.repeat,
        shuffled: tracks.shuffled,
    };
    let player = Player::start(tracks.first, Box::new(tracks.list), options)?;
    if settings.begin_at > 0.0 {
        player.seek_to(settings.begin_at);
    }
    Ok(player)
}

fn output_of(settings: &PlaySettings) -> Option<Target> {
    (!settings.silent).then(|| match (settings.device.as_deref(), &settings.choices.output) {
        // While an input plays, `device` names the input, not an output.
        (Some(DEFAULT_DEVICE), _) => Target::Default,
        (Some(name), _) if settings.listen.is_none() => Target::Named(name.to_owned()),
        (_, Some(id)) => Target::Preferred(id.clone()),
        (_, None) => Target::Default,
    })
}

fn renderer(gl: &Gl, choices: &Choices, scene: &SceneChoice) -> Result<Renderer, SessionError> {
    let library = &scene.shaders;
    let mut renderer = Renderer::new(gl, library, Counting::Off)?;
    renderer.prepare_for_window(library)?;
    if choices.flash_limiter {
        renderer.add_flash_limiter(library)?;
    }
    renderer.set_tone_map(choices.tone_map);
    Ok(renderer)
}

/// Recreates everything that belonged to a lost context. The song and all choices are kept.
///
/// # Errors
/// Fails if the driver provides no new context.
pub(super) fn renewed(
    mut session: Session,
    settings: &PlaySettings,
    scene: &SceneChoice,
    waker: &Waker,
) -> Result<Session, SessionError> {
    session.pictures.reading = None;
    let Session { playback, interface, screen, .. } = session;
    let Playback { renderer: old_renderer, scene: old_scene, mut frame_senders, mut reports, .. } = playback;
    let Interface { overlay, .. } = interface;
    // Drop the objects of the old context while it is current: in the new context, their names denote other objects.
    let assisted = overlay.assisted;
    drop(overlay);
    drop(old_renderer);
    frame_senders.let_go();
    drop(playback.preview);
    let kept = old_scene.let_go();
    let Some(shown) = kept.shown else {
        return Err(GpuError::ContextLost("preparing the first scene").into());
    };
    let screen = screen.renew()?;
    let mut scenes = start_scene(&*screen, settings, scene, kept.ways, kept.loaders, shown, waker)?;
    let mut overlay = Overlay::new(screen.gl(), waker.waking());
    if assisted {
        overlay.assist(Assistance::Begins);
    }
    scenes.adopt(kept.taken_over);
    reports.answer("the graphics driver lost its context: the frame is drawn again");
    let playback = Playback {
        renderer: renderer(screen.gl(), &session.choices, scene)?,
        scene: scenes,
        pace: playback.pace.renewed(clock::now()),
        preview: Preview::new(),
        frame_senders,
        reports,
        ..playback
    };
    let interface = Interface { overlay, ..interface };
    Ok(Session { playback, interface, screen, ..session })
}
