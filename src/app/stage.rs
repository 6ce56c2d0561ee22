//! What lives as long as the window: the sound, the scene, and the overlay.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use super::announcer::{Announcer, words_of};
use super::dynamic_resolution::{DynamicResolution, Level};
use super::frame_times::FrameTimes;
use super::media_controls::MediaControls;
use super::overlay::{Overlay, OverlayContent};
use super::pacing::Pacing;
use super::pointer::Pointer;
use super::scene_regions::Shown;
use super::scene_stage::{Drawn, SceneStage};
use super::sound::Sound;
use super::window::GlWindowContext;
use crate::gpu::error::GpuError;
use crate::gpu::renderer::Renderer;
use crate::limits::LIMITS;
use mariana_music::TapTempo;
use mariana_player::track::Repeat;
use mariana_player::{Moment, Player};

/// How often a show that stands still looks for changes.
pub(super) const IDLE_INTERVAL: Duration = Duration::from_millis(250);
/// How often it does so while it waits for a sound that it could show.
const LISTEN_INTERVAL: Duration = Duration::from_millis(10);

/// After standing still for this long, a show is drawn as well as possible.
const STANDS_STILL: Duration = Duration::from_millis(400);

/// Everything that lives as long as the window.
pub(super) struct Stage {
    pub(super) sound: Sound,
    /// The tempo tapped by hand.
    pub(super) taps: TapTempo,
    /// What the user wants; until the first picture the player waits in any case.
    pub(super) paused: bool,
    pub(super) renderer: Renderer,
    pub(super) scene: SceneStage,
    pub(super) pacing: Pacing,
    /// What the last frame showed. A show that stands still is not drawn again.
    pub(super) shown: Option<Shown>,
    pub(super) frame_times: FrameTimes,
    pub(super) dynamic_resolution: DynamicResolution,
    /// The window's size at the last drawing. (Asking a window that others have closed would end the program.)
    pub(super) window_size: Option<(u32, u32)>,
    /// When the show last moved.
    pub(super) moved: Instant,
    /// When the last new picture was begun.
    pub(super) pictured: Option<Instant>,
    pub(super) status_due: Instant,
    pub(super) told_silent: Option<String>,
    pub(super) announcer: Announcer,
    pub(super) controls: MediaControls,
    pub(super) title: String,
    pub(super) pointer: Pointer,
    /// Whether a shift key is held.
    pub(super) shift: bool,
    pub(super) occluded: bool,
    pub(super) overlay: Overlay,
    /// Whether the keys are shown.
    pub(super) help: bool,
    /// Whether the parameters' sliders are shown.
    pub(super) sliders: bool,
    /// Whether the line about the scene is shown.
    pub(super) corner: bool,
    // Last: everything above that holds OpenGL objects is dropped first.
    pub(super) window: GlWindowContext,
}

impl Stage {
    pub(super) fn set_paused(&mut self, paused: bool) {
        self.paused = paused;
        if self.shown.is_some() {
            self.sound.set_paused(paused);
        }
    }

    /// Changes the order of the tracks; does nothing while another source is listened to.
    pub(super) fn set_order(&mut self, change: impl FnOnce(Repeat, bool) -> (Repeat, bool)) {
        let Some(player) = self.sound.player() else { return };
        let status = player.status();
        let before = (status.repeat, status.shuffled);
        let (repeat, shuffled) = change(before.0, before.1);
        player.set_order(repeat, shuffled);
        self.announcer.answer(words_of(before, (repeat, shuffled)).to_owned());
    }

    /// Plays files that were dropped onto the window.
    pub(super) fn play_files(&mut self, files: Vec<PathBuf>) {
        match self.sound.player() {
            Some(player) => player.play_files(files),
            None => self
                .announcer
                .answer("files can be played only while the song is the source: press D".to_owned()),
        }
    }

    /// Takes this moment as a beat.
    pub(super) fn tap(&mut self) {
        let Some(Moment { song_time, .. }) = self.sound.now() else { return };
        self.taps.tap(song_time);
        self.announcer.answer(match self.taps.at(song_time) {
            Some((tempo, _)) => format!("{tempo:.0} beats per minute"),
            None => "tap again to set the tempo".to_owned(),
        });
    }

    /// Goes to the next track, or back. A tapped tempo belonged to the track before, so it is forgotten.
    pub(super) fn skip(&mut self, forward: bool) {
        self.taps = TapTempo::default();
        self.with_song(|player| player.skip(forward));
    }

    /// What the next picture shows: what is heard now, or what the last picture showed if it would look the same.
    pub(super) fn moment(&mut self) -> Option<Moment> {
        let mut now = self.sound.now()?;
        self.taps.apply(now.song_time, &mut now.features);
        let same = |shown: &Shown| shown.moment.features == now.features && !self.scene.moves_by_itself();
        Some(self.shown.filter(same).map_or(now, |shown| shown.moment))
    }

    /// How the next picture is drawn: as well as possible if it stands still, and also if it is a view, whose legend
    /// is read.
    pub(super) fn level(&self, now: Instant) -> Level {
        let still = now.saturating_duration_since(self.moved) >= STANDS_STILL;
        if still || self.scene.view().is_some() {
            self.dynamic_resolution.still_level()
        } else {
            self.dynamic_resolution.level()
        }
    }

    /// The size in which a level draws the window. A size beyond the driver's textures, or with more pixels than a
    /// picture may have, is reduced too.
    pub(super) fn drawn_size(&self, level: Level, window: (u32, u32)) -> (u32, u32) {
        let limit = self.window.gl().info().texture_side_max;
        level.size_in(within_pixels((window.0.min(limit), window.1.min(limit)), LIMITS.picture_pixels_max))
    }

    /// Whether a show that stands still could be drawn better than it is.
    pub(super) fn could_be_better(&self, now: Instant) -> bool {
        let Some((shown, window)) = self.shown.zip(self.window_size) else { return false };
        let level = self.level(now);
        (shown.size, shown.edges) != (self.drawn_size(level, window), level.edges)
    }

    /// The line about the scene and how it is drawn, if it is wanted.
    pub(super) fn corner_line(&self) -> Option<String> {
        let scene = self.scene.corner().filter(|_| self.corner)?;
        let size =
            self.shown.map(|shown| format!(" · {}x{}", shown.size.0, shown.size.1)).unwrap_or_default();
        Some(format!("{scene}{size}, {}", self.dynamic_resolution))
    }

    /// Finishes a picture that was begun at `begun`: dims what flashes too often.
    ///
    /// # Errors
    /// What the driver refuses.
    pub(super) fn finish_picture(&mut self, begun: Instant) -> Result<(), GpuError> {
        let last = self.pictured.replace(begun).unwrap_or(begun);
        self.renderer.limit_flashes(begun.saturating_duration_since(last).as_secs_f64())
    }

    /// Checks whether the picture that is being drawn takes too long: then it is drawn with fewer pixels or, if that
    /// would not be enough, not at all. For a picture that stands still there is time.
    pub(super) fn weigh_picture(&mut self, level: Level, now: Instant) {
        let moves = level == self.dynamic_resolution.level();
        let Some(seconds) = self.scene.seconds_of_picture().filter(|_| moves) else { return };
        if self.dynamic_resolution.expects(now, seconds) {
            self.scene.give_picture_up();
        } else if seconds > LIMITS.picture_seconds_max {
            self.scene.take_back(seconds);
        }
    }

    /// What was drawn. If the driver has no memory for a picture, the next one is drawn smaller and this one is left
    /// out.
    pub(super) fn without_room_smaller(
        &mut self,
        drawn: Result<Option<Drawn>, GpuError>,
    ) -> Result<Option<Drawn>, GpuError> {
        match drawn {
            Err(GpuError::Object { what, reason })
                if self.shown.is_some() && self.dynamic_resolution.make_smaller() =>
            {
                tracing::warn!("the driver could not make {what}: {reason}");
                self.announcer.answer(
                    "the driver has no memory for a picture of this size: a smaller one is drawn".to_owned(),
                );
                self.scene.give_picture_up();
                Ok(None)
            }
            drawn => drawn,
        }
    }

    /// Shows the next view or the one before. Its colours stand for numbers, so the change must not be dimmed as a
    /// flash. The key does not repeat: only single presses by hand escape the limiter.
    pub(super) fn go_view(&mut self, forward: bool) {
        self.scene.go_view(forward);
        self.renderer.forget_flashes();
    }

    /// Tells the controller of the resolution what a picture cost that took `drawing` until it was handed over and
    /// `showing` in all. Handing over waits for a monitor, but on a software renderer it is what draws.
    pub(super) fn note_cost(&mut self, drawn: Level, drawing: Duration, showing: Duration) {
        let cost = match (self.window.gl().info().software, self.renderer.gpu_time()) {
            (true, _) => showing,
            (false, gpu) => drawing.max(gpu.unwrap_or_default()),
        };
        if drawn == self.dynamic_resolution.level() {
            self.dynamic_resolution.note(Instant::now(), cost);
        }
    }

    /// How long a show that stands still sleeps: in silence it listens.
    pub(super) fn idle_interval(&self, seen: bool) -> Duration {
        if seen && !self.paused { LISTEN_INTERVAL } else { IDLE_INTERVAL }
    }

    /// Does something with the song, if it is what is listened to.
    pub(super) fn with_song(&mut self, act: impl FnOnce(&mut Player)) {
        if let Some(player) = self.sound.player() {
            act(player);
        }
    }

    pub(super) fn set_title(&mut self, title: String) {
        if title != self.title {
            self.window.window().set_title(&title);
            self.title = title;
        }
    }
}

/// A size of at most `max` pixels and of the same shape, as far as whole pixels allow.
fn within_pixels(size: (u32, u32), max: u64) -> (u32, u32) {
    let pixels = f64::from(size.0) * f64::from(size.1);
    let scale = (max as f64 / pixels.max(1.0)).sqrt().min(1.0);
    let side = |side: u32| ((f64::from(side) * scale) as u32).max(1);
    (side(size.0), side(size.1))
}

/// Adds what there is to report of the sound and the tracks.
pub(super) fn show_sound<'a>(
    sound: &'a Sound,
    announcer: &'a Announcer,
    content: &mut OverlayContent<'a>,
    now: Instant,
) {
    content.add(announcer.notice());
    content.hint = sound.hint();
    content.sources = sound.list(now);
}
