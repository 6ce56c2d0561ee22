//! What a show begins with: everything that lives as long as the window, created on the show's thread.
//!
//! **A lost context is made anew.** When the driver reports that its context is lost, everything that belongs to it
//! is dropped while it is still current, and made again from the worlds, which are plain values
//! (`app::opening::renewed`); the song does not notice. A picture for which the driver has no memory is drawn
//! smaller. `faults` lets tests cause both.

use std::time::Instant;

use super::announcer::Announcer;
use super::dynamic_resolution::DynamicResolution;
use super::error::AppError;
use super::frame_times::FrameTimes;
use super::media_controls::MediaControls;
use super::overlay::Overlay;
use super::pacing::Pacing;
use super::pointer::Pointer;
use super::scene_stage::{SceneLoader, SceneStage};
use super::sound::{Sound, Start};
use super::stage::Stage;
use super::window::{GlWindowContext, OpenWindow};
use super::window_thread::Waker;
use crate::config::PlaySettings;
use crate::export::painter::SceneChoice;
use crate::export::print::tell;
use crate::gpu::error::GpuError;
use crate::gpu::renderer::{Counting, Renderer};
use crate::scenes::{ReadyScene, SceneSource};
use mariana_music::TapTempo;
use mariana_player::playlist::Opened;
use mariana_player::{OutputChoice, Player, PlayerOptions};

/// Frame cap where the monitor reports no rate.
const FPS_DEFAULT: f64 = 60.0;
/// Threads that compile programs: one for the scene's own, one for the interpreter's.
const COMPILERS: usize = 2;

/// What is known before the window opens.
pub(super) struct Opening<'a> {
    /// What is played; none if only an input is listened to.
    pub(super) tracks: Option<Opened>,
    /// How the window plays and shows it.
    pub(super) settings: &'a PlaySettings,
    /// How scenes are drawn.
    pub(super) scene: &'a SceneChoice,
    /// What loads scenes, and the first of them.
    pub(super) scene_at_start: (SceneLoader, (SceneSource, ReadyScene)),
}

impl Opening<'_> {
    /// Makes everything that the show needs in a window.
    ///
    /// # Errors
    /// What the driver or the system refuses.
    pub(super) fn stage(self, window: OpenWindow, waker: &Waker) -> Result<Stage, AppError> {
        let Self { tracks, settings, scene, scene_at_start: (loader, first) } = self;
        let window = window.bind()?;
        if settings.fullscreen {
            window.set_fullscreen(true);
        }
        let title = String::new();
        let renderer = renderer(&window, settings, scene)?;
        let of_scenes = waker.clone();
        let scene = SceneStage::new(
            window.gl(),
            window.worker_contexts(COMPILERS),
            &scene.shaders,
            (scene.sdf, scene.regions, scene.view),
            loader,
            first,
            move || of_scenes.wake(),
        )?;
        // The song starts with the first picture, so that none of it is missed.
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
        if let Some(tracks) = tracks {
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
        let of_controls = waker.clone();
        Ok(Stage {
            sound,
            taps: TapTempo::default(),
            paused: false,
            renderer,
            scene,
            pacing: Pacing::new(fps, now),
            shown: None,
            frame_times: FrameTimes::default(),
            dynamic_resolution: DynamicResolution::new(settings.quality, fps),
            window_size: None,
            moved: now,
            pictured: None,
            status_due: now,
            told_silent: None,
            announcer,
            controls: MediaControls::start(move || of_controls.wake()),
            title,
            pointer: Pointer::default(),
            shift: false,
            occluded: false,
            overlay: Overlay::new(window.gl(), window.window()),
            help: false,
            sliders: false,
            corner: false,
            window,
        })
    }
}

/// A renderer for a window.
fn renderer(
    window: &GlWindowContext,
    settings: &PlaySettings,
    scene: &SceneChoice,
) -> Result<Renderer, AppError> {
    let library = &scene.shaders;
    let mut renderer = Renderer::new(window.gl(), library, Counting::Off)?;
    renderer.prepare_for_window(library)?;
    if settings.limit_flashes {
        renderer.add_flash_limiter(library)?;
    }
    renderer.set_tone_map(scene.tone_map);
    Ok(renderer)
}

/// Makes everything anew that belonged to a lost context. The song and everything that was chosen go on meanwhile.
///
/// # Errors
/// The driver gives no other context.
pub(super) fn renewed(
    stage: Stage,
    settings: &PlaySettings,
    scene: &SceneChoice,
    waker: &Waker,
) -> Result<Stage, AppError> {
    let Stage { overlay, renderer: old_renderer, scene: old_scene, window, .. } = stage;
    // What was made in the context is dropped while it is current: in the next one its names mean something else.
    drop(overlay);
    drop(old_renderer);
    let kept = old_scene.let_go();
    let Some(shown) = kept.shown else {
        return Err(GpuError::ContextLost { doing: "preparing the first scene" }.into());
    };
    let window = window.let_go().bind()?;
    let of_scenes = waker.clone();
    let mut scenes = SceneStage::new(
        window.gl(),
        window.worker_contexts(COMPILERS),
        &scene.shaders,
        kept.ways,
        kept.loader,
        shown,
        move || of_scenes.wake(),
    )?;
    scenes.take_over(kept.moved, kept.wanted);
    let mut announcer = stage.announcer;
    announcer.answer("the driver lost the picture: it is being drawn again".to_owned());
    Ok(Stage {
        renderer: renderer(&window, settings, scene)?,
        scene: scenes,
        overlay: Overlay::new(window.gl(), window.window()),
        shown: None,
        pictured: None,
        announcer,
        window,
        sound: stage.sound,
        taps: stage.taps,
        paused: stage.paused,
        pacing: stage.pacing,
        frame_times: stage.frame_times,
        dynamic_resolution: stage.dynamic_resolution,
        window_size: stage.window_size,
        moved: Instant::now(),
        status_due: stage.status_due,
        told_silent: stage.told_silent,
        controls: stage.controls,
        title: stage.title,
        pointer: stage.pointer,
        shift: stage.shift,
        occluded: stage.occluded,
        help: stage.help,
        sliders: stage.sliders,
        corner: stage.corner,
    })
}
