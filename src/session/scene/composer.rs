//! The composer of frames: draws the current and the outgoing scene, in as many steps as needed.

use std::rc::Rc;
use std::sync::Arc;
use std::time::Duration;

use image::RgbaImage;

use super::active_clips::ActiveClips;
use super::camera::SceneCamera;
use super::context_change::DrawingWays;
use super::fading::Fading;
use super::feedback::{self, FeedbackPace};
use super::parameters::Parameters;
use super::prepared_scene::{DrawingChoice, FirstTree, PreparedScene};
use super::prepared_scenes::{Place, PreparedScenes};
use super::regions::{DrawOptions, SceneRegions, Shown};
use super::scene_change::{Begun, SceneChange};
use super::scenery::{SeenPictures, scenery_of};
use super::show_follower::{Outgoing, ShowFollower};
use super::views::Views;
use crate::clock;
use crate::frame::Frame;
use crate::frame::orbit_controls::OrbitControls;
use crate::frame::projection::Projection;
use crate::gpu::renderer::Progress;
use crate::gpu::{EdgeSamples, GpuError, Mode, Program, Renderer};
use crate::moving_textures::LiveTextures;
use crate::scenes::camera_number;
use crate::song_shapes::{LiveSongShapes, SongTexts};
use crate::view::ViewChoice;
use crate::view::legend::LegendPicture;
use mariana_field::graph::Screen;
use mariana_music::Sound;
use mariana_player::Moment;

/// If a fade is entered after this fraction of its length, the last frame fades out instead of the outgoing scene.
const LATE_FRACTION: f32 = 0.35;

pub(crate) struct WantedPicture<'a> {
    pub moment: Moment,
    pub sound: Sound,
    /// Returns the sound of an earlier moment, in seconds of the song.
    pub earlier: &'a dyn Fn(f64) -> Sound,
    pub size: (u32, u32),
    /// Aspect ratio of the window: width divided by height.
    pub aspect: f64,
    /// The size of the picture in the window, and the pointer over it.
    pub screen: Screen,
    /// The shaders' `frame_quality`.
    pub quality: f32,
    pub edges: EdgeSamples,
    pub runs: bool,
}

#[derive(Debug, Clone, Copy)]
pub(crate) struct Drawn {
    pub shown: Shown,
    pub spent: Duration,
}

#[derive(Clone, Copy)]
pub(super) struct Ingredients<'a> {
    pub scenes: &'a PreparedScenes,
    pub show: &'a ShowFollower,
    pub parameters: &'a Parameters,
    pub choice: DrawingChoice,
}

/// A scene of a frame. `below` is set for the outgoing scene.
#[derive(Clone, Copy)]
struct Layer<'a> {
    scene: &'a PreparedScene,
    mode: Mode,
    below: Option<&'a Outgoing>,
}

struct Making {
    of: (u64, Mode, Option<ViewChoice>),
    /// The outgoing scene while it is drawn; `None` once only the current scene is left to draw.
    below: Option<Place>,
    program: Rc<Program>,
    legend: Option<Arc<LegendPicture>>,
    shown: Shown,
    /// Expected drawing time in seconds, once known.
    seconds: Option<f64>,
    spent: Duration,
}

pub(crate) struct SceneComposer {
    making: Option<Making>,
    /// True if the last frame was abandoned for a new version of its scene, as when keys are faster than frames.
    has_interrupted: bool,
    pub(crate) pictures: SeenPictures,
    pub(super) projection: Projection,
    textures: LiveTextures,
    song_shapes: LiveSongShapes,
    pub(crate) regions: SceneRegions,
    pub(crate) fading: Fading,
    pub(super) change: SceneChange,
    pub(crate) views: Views,
    pub(super) camera: SceneCamera,
    feedback: FeedbackPace,
    /// The pointer over the picture: fractions of the width from the left and of the height from below, and true while
    /// its button is held.
    pointer: ([f32; 2], bool),
    /// Counts the changes in the composer after which a frame of the same moment would look different.
    revision: u64,
}

impl SceneComposer {
    pub(super) fn new(
        mut regions: SceneRegions,
        textures: LiveTextures,
        song_shapes: LiveSongShapes,
        DrawingWays { view, projection, fade, .. }: DrawingWays,
    ) -> Self {
        regions.insists = view.is_some();
        Self {
            making: None,
            has_interrupted: false,
            pictures: SeenPictures::default(),
            projection,
            textures,
            song_shapes,
            regions,
            fading: Fading::of(fade),
            change: SceneChange::default(),
            views: Views::starting_with(view),
            camera: SceneCamera::default(),
            feedback: FeedbackPace::default(),
            pointer: ([0.5; 2], false),
            revision: 0,
        }
    }

    pub(super) fn fades_out(&self, of: Ingredients<'_>, moment: &Moment, place: Place) -> bool {
        self.outgoing(of, moment).is_some_and(|outgoing| outgoing.place == place)
    }

    /// Draws for about the time `go`, at the session's `revision`: continues the frame in progress, or begins one at a
    /// moment for which the regions are built. Returns `None` until the frame is finished.
    pub(super) fn resume(
        &mut self,
        of: Ingredients<'_>,
        renderer: &mut Renderer,
        picture: &WantedPicture<'_>,
        go: Duration,
        revision: u64,
    ) -> Result<Option<Drawn>, GpuError> {
        let Some((shown, mode)) = of.scenes.drawn(of.choice.sdf) else { return Ok(None) };
        let now = (shown.id, mode, self.views.choice);
        let drawn = loop {
            if self.making.is_none() {
                self.making = self.begin(of, renderer, now, picture, revision)?;
            }
            let Some(Making { below, program, .. }) = &self.making else { return Ok(None) };
            let below = *below;
            let scene = of.scenes.at(below.unwrap_or(Place::Shown));
            let Some(scene) = scene else { return Ok(None) };
            let progress = renderer.resume(&scene.resources, program, go)?;
            let Some(making) = &mut self.making else { return Ok(None) };
            match (progress, below) {
                (Progress::Finished { spent }, Some(_)) => {
                    renderer.keep_light()?;
                    self.change.begun.iter_mut().for_each(|begun| begun.lit = Some(spent));
                    self.making = None;
                }
                (Progress::Finished { spent }, None) => {
                    break Drawn { shown: making.shown, spent: making.spent + spent };
                }
                (Progress::Going { seconds }, below) => {
                    making.seconds = seconds.filter(|_| below.is_none());
                    return Ok(None);
                }
            }
        };
        self.change.begun = None;
        self.has_interrupted = false;
        if let Some(Making { legend, .. }) = self.making.take() {
            renderer.put_legend(legend.as_deref())?;
        }
        self.pictures.finish(shown.id, drawn.spent);
        if self.fading.goes_on_by_itself() || std::mem::take(&mut self.feedback.is_incomplete) {
            self.revision += 1;
        }
        Ok(Some(drawn))
    }

    /// Abandons a frame in progress that is not the wanted one. Returns `true` if no frame is in progress now.
    pub(super) fn give_up_another(&mut self, of: Ingredients<'_>, wanted: &WantedPicture<'_>) -> bool {
        let Some((shown, mode)) = of.scenes.drawn(of.choice.sdf) else { return false };
        let now = (shown.id, mode, self.views.choice);
        let is_of_use = |making: &Making| {
            (making.shown.size, making.shown.edges) == (wanted.size, wanted.edges) && making.of == now
        };
        if self.making.as_ref().is_some_and(is_of_use) {
            return false;
        }
        if self.making.take().is_some_and(|making| making.of.0 != shown.id) {
            self.has_interrupted = true;
        }
        true
    }

    /// Begins a frame. In a fade, draws the outgoing scene first. Returns `None` while regions are being built.
    fn begin(
        &mut self,
        of: Ingredients<'_>,
        renderer: &mut Renderer,
        drawn: (u64, Mode, Option<ViewChoice>),
        picture: &WantedPicture<'_>,
        revision: u64,
    ) -> Result<Option<Making>, GpuError> {
        let WantedPicture { moment, size, edges, .. } = *picture;
        let wanted = Shown { moment, size, edges, revision };
        let (wanted, sound) = self.change.resume(wanted, picture.sound.clone());
        let time = wanted.moment.song_time;
        let outgoing = self.outgoing(of, &wanted.moment);
        let lit = self.change.begun.as_ref().and_then(|begun| begun.lit).filter(|_| outgoing.is_some());
        // The outgoing scene is drawn first.
        let below = outgoing.as_ref().filter(|_| lit.is_none());
        if below.is_some() {
            self.change.begun = Some(Begun { shown: wanted, sound: sound.clone(), lit: None });
            self.fading.announce();
        }
        let scene = of.scenes.at(below.map_or(Place::Shown, |below| below.place));
        let Some((scene, mode)) = scene.and_then(|scene| Some((scene, scene.mode(of.choice.sdf)?))) else {
            return Ok(None);
        };
        let layer = Layer { scene, mode, below };
        let ((params, camera), orbit) = self.numbers_and_orbit(of, layer, time);
        self.camera.shown = orbit;
        let (is_untried, cells) = (scene.tree == FirstTree::Untried, of.choice.cells);
        let draw_options =
            DrawOptions { params: &params, camera, orbit, cells, is_untried, fades_away: below.is_some() };
        let drawable = self.regions.drawable(scene.id, mode, &scene.resources, wanted, sound, draw_options);
        // A finished tree may be for an older moment, but both scenes of a fade must be drawn at the same moment.
        let Some((frame, shown)) = drawable.filter(|(_, shown)| outgoing.is_none() || *shown == wanted)
        else {
            return Ok(None);
        };
        let frame = self.in_window(frame, scene, picture);
        self.feed_back(of, renderer, layer, shown.moment.song_time, &frame, picture)?;
        let making = |program| Making {
            of: drawn,
            below: below.map(|below| below.place),
            program,
            legend: None,
            shown,
            seconds: None,
            spent: lit.unwrap_or_default(),
        };
        if below.is_some() {
            renderer.set_edge_samples(shown.edges);
            renderer.begin_light(&frame, &scene.resources)?;
            return Ok(scene.program(mode).cloned().map(making));
        }
        self.camera.own_pitch = frame.own_pitch();
        match &outgoing {
            Some(outgoing) if outgoing.clip.is_some() => renderer.set_fade(Some(outgoing.fraction)),
            _ => self.fading.begin_picture(renderer, &wanted.moment, picture.runs, outgoing.is_some()),
        }
        // Set the samples only now, because a new number of samples discards the kept light of the last frame.
        renderer.set_edge_samples(shown.edges);
        let begun = match self.views.program(scene, mode) {
            None => {
                renderer.begin(&frame, &scene.resources)?;
                scene.program(mode).cloned().map(making)
            }
            Some((view, mode, program)) => {
                let legend = self.views.begin(renderer, &frame, scene, mode, view)?;
                Some(Making { legend, ..making(program) })
            }
        };
        self.pictures.begin(scenery_of(scene, frame));
        Ok(begun)
    }

    /// Draws frames of feedback before the image `frame` of a scene at `now` seconds. Views show none.
    fn feed_back(
        &mut self,
        of: Ingredients<'_>,
        renderer: &mut Renderer,
        layer: Layer<'_>,
        now: f64,
        frame: &Frame,
        picture: &WantedPicture<'_>,
    ) -> Result<(), GpuError> {
        let scene = layer.scene;
        let Some(program) = scene.program(layer.mode).filter(|_| self.views.choice.is_none()) else {
            return Ok(());
        };
        let [width, height] = picture.screen.size.map(|side| side as u32);
        let shown = ((width, height), self.projection.stereo);
        let (resources, begun) = (&scene.resources, clock::now());
        for _ in 0..feedback::FRAMES_MAX {
            let request = renderer.feedback_before(resources, picture.moment.track, now, shown, true);
            let Some(request) = request else { break };
            let mut earlier = self.earlier_frame(of, layer, request.time, frame, picture);
            earlier.size = request.size;
            renderer.draw_feedback(&request, &earlier, resources, program)?;
            if clock::since(begun) > feedback::PATIENCE {
                break;
            }
        }
        self.feedback.record(scene.id, resources, now);
        renderer.show_feedback(resources, now)
    }

    /// Returns the parameters, the number of the camera and the camera's motion of a scene at `time` seconds.
    fn numbers_and_orbit(
        &self,
        of: Ingredients<'_>,
        layer: Layer<'_>,
        time: f64,
    ) -> ((Vec<f32>, Option<usize>), OrbitControls) {
        let scene = layer.scene;
        match layer.below {
            Some(below) => (
                self.change.numbers(scene, below, time, of.parameters),
                self.change.camera(below, time, self.camera.orbit),
            ),
            None => {
                let clips = of.show.clips(&scene.source, time);
                (numbers_of(of.parameters, scene, &clips, time), self.camera.at(&clips, time))
            }
        }
    }

    /// Returns the frame at an earlier `time` of the scene of `frame`, with the pictures and texts of `frame`.
    fn earlier_frame(
        &self,
        of: Ingredients<'_>,
        layer: Layer<'_>,
        time: f64,
        frame: &Frame,
        picture: &WantedPicture<'_>,
    ) -> Frame {
        let ((params, camera), orbit) = self.numbers_and_orbit(of, layer, time);
        let world = layer.scene.resources.world();
        let sound = (picture.earlier)(time);
        let mut earlier = Frame::with_params(world, time, sound, picture.size, &params);
        earlier.seen_by(world, camera);
        earlier.pictures.clone_from(&frame.pictures);
        earlier.inputs.shapes = frame.inputs.shapes.clone();
        let earlier = earlier.by_hand(world, orbit).in_window(world, picture.aspect, 1.0);
        earlier.projected(world, self.projection).on_screen(world, picture.screen)
    }

    /// Adapts a frame to the window, and adds the moving pictures of its moment.
    fn in_window(&mut self, frame: Frame, scene: &PreparedScene, picture: &WantedPicture<'_>) -> Frame {
        let world = scene.resources.world();
        let frame = frame.in_window(world, picture.aspect, picture.quality).projected(world, self.projection);
        let frame = frame.on_screen(world, picture.screen);
        self.song_shapes.in_frame(self.textures.in_frame(frame, world), world)
    }

    fn outgoing(&self, of: Ingredients<'_>, moment: &Moment) -> Option<Outgoing> {
        if self.views.choice.is_some() {
            return None;
        }
        if self.fading.goes_on() {
            let (left, fraction) = self.change.left.as_ref().zip(self.fading.fraction_of_scene(moment))?;
            let place = of.scenes.place_of(&left.source, of.choice.sdf)?;
            return Some(Outgoing { place, clip: None, fraction });
        }
        of.show.outgoing(moment.song_time, of.scenes, of.choice.sdf)
    }

    fn fades_with_both(&self, of: Ingredients<'_>) -> bool {
        if self.views.choice.is_some() || self.fading.goes_on() {
            return false;
        }
        let outgoing =
            of.show.course.last_time.and_then(|time| of.show.outgoing(time, of.scenes, of.choice.sdf));
        outgoing
            .is_some_and(|outgoing| outgoing.fraction > 1.0 - LATE_FRACTION || of.show.course.stands_still)
    }

    /// Starts a fade from the outgoing to the incoming scene. Cuts during a view, whose colours encode numbers.
    pub(super) fn fade_if_it_can(&mut self, of: Ingredients<'_>) {
        if self.fades_with_both(of) {
            self.fading.cut();
        } else if self.views.choice.is_none() {
            self.fading.request();
        }
    }

    /// Fades the frozen frame out within `seconds`. Cuts if a view is shown, or if a show's fade draws both scenes.
    pub(super) fn fade_from_held(&mut self, seconds: f64, of: Ingredients<'_>) {
        if self.views.choice.is_some() || self.fades_with_both(of) {
            self.fading.cut();
        } else {
            self.fading.release(seconds);
        }
        self.revision += 1;
    }

    /// Mixes a `fraction` of the frame that a show holds into the next frames. `None` ends the mixing.
    pub(crate) fn mix_held(&mut self, fraction: Option<f32>) {
        if self.views.choice.is_none() {
            self.fading.mix_held(fraction);
        }
        self.revision += 1;
    }

    pub(super) fn show_view(&mut self, choice: Option<ViewChoice>) {
        self.views.choose(choice);
        if choice.is_some() {
            self.fading.cut();
        }
        self.regions.insists = choice.is_some();
    }

    pub(super) fn record_frame_time(&mut self, time: Duration, of: Ingredients<'_>) {
        let Some((scene, mode)) = of.scenes.drawn(of.choice.sdf) else { return };
        // Ignore the times of views, which use other programs, and of fades, which draw two scenes.
        if self.views.choice.is_some() || of.scenes.fading_out.is_some() {
            return;
        }
        let Some(built) = scene.resources.regions() else { return };
        if self.regions.record_frame_time((scene.id, mode), &built, time, of.choice.cells) {
            self.revision += 1;
        }
    }

    pub(crate) fn is_drawing(&self) -> bool {
        self.making.is_some()
    }

    /// True if the frame of this scene is finished and does not change by itself.
    pub(super) fn rests_on(&self, scene: u64) -> bool {
        self.pictures.scene == Some(scene)
            && self.making.is_none()
            && self.views.choice.is_none()
            && !self.fading.goes_on()
    }

    /// True if the frame in progress must be finished: an edit may cancel a frame, but never two in a row.
    pub(super) fn must_finish(&self) -> bool {
        self.making.is_some() && self.has_interrupted
    }

    pub(crate) fn seconds_of_picture(&self) -> Option<f64> {
        self.making.as_ref()?.seconds
    }

    pub(crate) fn give_picture_up(&mut self) {
        self.making = None;
    }

    /// Notes the pointer over the picture. Requests a new frame if a scene follows it.
    pub(crate) fn point(&mut self, pointer: ([f32; 2], bool), is_followed: bool) {
        if std::mem::replace(&mut self.pointer, pointer) != pointer && is_followed {
            self.revision += 1;
        }
    }

    /// The picture in a window of this size, with the pointer.
    pub(crate) fn screen(&self, size: (u32, u32)) -> Screen {
        let (at, pressed) = self.pointer;
        Screen { pointer: at, pressed, ..Screen::of_size(size) }
    }

    /// Requests a new frame: something has changed that neither the sound's features nor the parameters show.
    pub(crate) fn redraw(&mut self) {
        self.revision += 1;
    }

    /// Passes the song's cover to the scenes that show it; `None` if there are none. Requests a new frame if a picture
    /// has come that the last frame lacks. Returns sentences about videos and cameras.
    pub(crate) fn follow_textures(&mut self, cover: Option<Arc<RgbaImage>>) -> Vec<String> {
        let is_another = cover.is_some() && self.textures.set_cover(cover);
        if self.textures.has_new_pictures() || is_another {
            self.redraw();
        }
        self.textures.drain_messages()
    }

    /// Passes the texts of the song to the scenes that show them; `None` if there are none. Requests a new frame if a
    /// text has been baked that the last frame lacks.
    pub(crate) fn follow_song_texts(&mut self, texts: Option<SongTexts>) {
        let are_others = texts.is_some_and(|texts| self.song_shapes.set_texts(texts));
        if self.song_shapes.has_new_texts() || are_others {
            self.redraw();
        }
    }

    pub(super) fn revision(&self) -> u64 {
        self.revision + self.views.revision + self.camera.revision
    }
}

/// The parameters of a scene at `time` seconds of the song, and the number of its camera. A parameter has the show's
/// value, unless a controller changed it later.
fn numbers_of(
    parameters: &Parameters,
    scene: &PreparedScene,
    clips: &ActiveClips<'_>,
    time: f64,
) -> (Vec<f32>, Option<usize>) {
    let mut numbers = parameters.numbers(scene, clips, time);
    if let Some((fraction, number)) = clips.fraction.zip(numbers.last_mut()) {
        *number = fraction;
    }
    let camera = clips.first.filter(|_| clips.fraction.is_none());
    (numbers, camera.and_then(|clip| camera_number(scene.resources.world(), clip.camera.as_deref())))
}
