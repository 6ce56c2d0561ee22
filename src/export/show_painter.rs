//! Draws a show without a window: at each moment a scene, a fade, or a blend of two scenes.

use std::collections::VecDeque;
use std::rc::Rc;
use std::sync::Arc;

use super::error::ExportError;
use super::painter::{HeadlessRenderer, Model, SceneChoice, held_of, require_inputs};
use crate::frame::held_inputs::{HeldInputs, Setting};
use crate::frame::orbit_controls::OrbitControls;
use crate::frame::{Frame, FrameOptions};
use crate::scenes::{ReadyScene, SceneBlend, SceneError, SceneSource, camera_number};
use crate::show::{Clip, Held, PreparedShow, ShowError, Timeline};
use mariana_field::graph::Graph;
use mariana_field::world::{BlendKind, World, blended_params};
use mariana_music::Sound;

/// Maximum number of scenes and blends on the GPU; the least recently drawn ones are removed first.
const MODELS_MAX: usize = 8;

/// The key of a model: a scene, or a blend of two scenes, each with its own camera.
#[derive(Debug, Clone, PartialEq)]
enum Drawn {
    Scene(String),
    Blend(SceneBlend),
}

struct Read {
    name: String,
    ready: ReadyScene,
    held: HeldInputs,
}

pub(super) struct ShowPainter {
    pub(super) headless_renderer: HeadlessRenderer,
    choice: SceneChoice,
    prepared_show: Arc<PreparedShow>,
    timeline: Arc<Timeline>,
    scenes: Vec<Read>,
    /// Scenes and blends on the GPU, the most recently drawn last.
    models: VecDeque<(Drawn, Rc<Model>)>,
    /// Blends that failed. A fade replaces each of them.
    refused: Vec<Drawn>,
    /// Moment and size of the last frame; `None` if that frame was not frozen.
    held: Option<(f64, (u32, u32))>,
}

/// A moment of a song, in seconds, and its sound.
pub(super) type Heard = (f64, Sound);

impl ShowPainter {
    /// Compiles all scenes of the show, to find mistakes at the start. `choice` has the options of the renderer.
    ///
    /// # Errors
    /// Fails if a scene or a setting is refused, the driver reports an error, or all entries of the show wait for a
    /// key.
    pub(super) fn open(
        choice: &SceneChoice,
        prepared_show: Arc<PreparedShow>,
        set: &[Setting],
    ) -> Result<Self, ExportError> {
        let timeline = Arc::new(prepared_show.timeline().ok_or(ShowError::WaitsForKeys)?.clone());
        let mut scenes = Vec::new();
        let mut names: Vec<&str> = Vec::new();
        for clip in timeline.clips() {
            if names.contains(&clip.scene.as_str()) {
                continue;
            }
            names.push(&clip.scene);
            let Some(source) = prepared_show.source(&clip.scene) else { continue };
            scenes.push((clip.scene.clone(), source.clone(), source.ready()?));
        }
        let known: Vec<_> = scenes.iter().map(|(_, _, ready)| &ready.world.scene).collect();
        require_inputs(&known, set)?;
        let mut headless_renderer = HeadlessRenderer::open(choice)?;
        if timeline.dims() {
            headless_renderer.renderer.add_dimming(&choice.shaders)?;
        }
        let read = |(name, source, ready): (String, SceneSource, ReadyScene)| {
            if choice.alpha {
                super::alpha::require_no_sky(&ready, &source.name())?;
            }
            let held = held_of(&ready.world.scene, set)?;
            Ok(Read { name, ready, held })
        };
        let scenes = scenes.into_iter().map(read).collect::<Result<_, ExportError>>()?;
        let (models, refused) = (VecDeque::new(), Vec::new());
        Ok(Self {
            headless_renderer,
            choice: choice.clone(),
            prepared_show,
            timeline,
            scenes,
            models,
            refused,
            held: None,
        })
    }

    /// The graphs of all scenes.
    pub(super) fn graphs(&self) -> impl Iterator<Item = &Graph> {
        self.scenes.iter().map(|read| &read.ready.world.scene.graph)
    }

    pub(super) fn held_at(&self, time: f64) -> Vec<Held> {
        self.timeline.held_at(time)
    }

    /// Draws the frame at `time`: the mean of its exposures.
    pub(super) fn draw(
        &mut self,
        time: f64,
        exposures: Vec<Heard>,
        held: Vec<(Held, Sound)>,
        size: (u32, u32),
    ) -> Result<(), ExportError> {
        // Draw a frozen frame only once, unless another frame is mixed with it.
        let alone = held.first().filter(|(held, _)| held.fraction >= 1.0).map(|(held, _)| (held.since, size));
        if alone.is_none() || self.held != alone {
            // A frozen frame does not move.
            let count = if alone.is_some() { 1 } else { exposures.len() };
            for (number, heard) in exposures.into_iter().take(count).enumerate() {
                self.headless_renderer.begin_exposure(number, count);
                self.draw_anew(heard, held.clone(), size)?;
                self.headless_renderer.expose(number, count)?;
            }
        }
        self.held = alone;
        Ok(self.headless_renderer.renderer.dim(self.timeline.picture_at(time).brightness)?)
    }

    /// Draws the oldest frozen frame, then mixes the later frozen frames and the frame of the moment over it.
    fn draw_anew(
        &mut self,
        heard: Heard,
        mut held: Vec<(Held, Sound)>,
        size: (u32, u32),
    ) -> Result<(), ExportError> {
        let (time, sound) = heard;
        let Some((Held { since, mut fraction }, then)) = held.pop() else {
            return self.draw_live(time, sound, size);
        };
        self.draw_live(since, then, size)?;
        while let Some((later, then)) = held.pop() {
            self.draw_over(later.since, then, fraction, size)?;
            fraction = later.fraction;
        }
        if fraction < 1.0 { self.draw_over(time, sound, fraction, size) } else { Ok(()) }
    }

    /// Mixes the frame of a moment over the last frame. If a scene is fading out at that moment, leaves it out.
    fn draw_over(
        &mut self,
        time: f64,
        sound: Sound,
        fraction: f32,
        size: (u32, u32),
    ) -> Result<(), ExportError> {
        let timeline = self.timeline.clone();
        let moment = timeline.at(time);
        let (over, frame) = self.frame(moment.clip, time, sound, size)?;
        self.headless_renderer.draw_over(&over, frame, fraction)
    }

    fn draw_live(&mut self, time: f64, sound: Sound, size: (u32, u32)) -> Result<(), ExportError> {
        let timeline = self.timeline.clone();
        let moment = timeline.at(time);
        let Some((leaving, fraction)) = moment.leaving else {
            let (model, frame) = self.frame(moment.clip, time, sound, size)?;
            return self.headless_renderer.draw(&model, frame);
        };
        if let Some(kind) = moment.clip.transition.kind.blend()
            && let Some(model) = self.blend(leaving, moment.clip, kind)?
        {
            let of =
                |clip: &Clip| self.read(clip).map(|read| (read, params_of(&read.ready.world, clip, time)));
            let (from, to) = (of(leaving)?, of(moment.clip)?);
            let scenes = (&from.0.ready.world.scene, &to.0.ready.world.scene);
            let params = blended_params(scenes.0, &from.1, scenes.1, &to.1, fraction);
            let held = from.0.held.followed_by(&to.0.held, scenes.0.params.len());
            let frame_options = FrameOptions { params: &params, held: &held, camera: None };
            let frame = Frame::staged(model.world(), time, sound, size, &frame_options);
            let frame = frame.by_hand(model.world(), OrbitControls::of_turns(moment.clip.turns_at(time)));
            return self.headless_renderer.draw(&model, frame);
        }
        let (under, under_frame) = self.frame(leaving, time, sound.clone(), size)?;
        let (over, over_frame) = self.frame(moment.clip, time, sound, size)?;
        // Views are not mixed.
        if self.headless_renderer.view.is_none() {
            self.headless_renderer.draw(&under, under_frame)?;
        }
        self.headless_renderer.draw_over(&over, over_frame, 1.0 - fraction)
    }

    fn frame(
        &mut self,
        clip: &Clip,
        time: f64,
        sound: Sound,
        size: (u32, u32),
    ) -> Result<(Rc<Model>, Frame), ExportError> {
        let read = self.read(clip)?;
        let (ready, held) = (read.ready.clone(), read.held.clone());
        let camera = camera_number(&ready.world, clip.camera.as_deref());
        let model = self.model(Drawn::Scene(clip.scene.clone()), |_| Ok(ready))?;
        let frame_at = |time: f64, sound: Sound| {
            let params = params_of(model.world(), clip, time);
            let frame_options = FrameOptions { params: &params, held: &held, camera };
            let frame = Frame::staged(model.world(), time, sound, size, &frame_options);
            frame.by_hand(model.world(), OrbitControls::of_turns(clip.turns_at(time)))
        };
        self.headless_renderer.feed_back(&model, time, &sound, size, &frame_at)?;
        let frame = frame_at(time, sound);
        Ok((model, frame))
    }

    fn blend(&mut self, from: &Clip, to: &Clip, kind: BlendKind) -> Result<Option<Rc<Model>>, ExportError> {
        let blend = self.prepared_show.blend(from, to, kind).ok_or_else(|| not_in_show(to))?;
        let drawn = Drawn::Blend(blend.clone());
        if self.refused.contains(&drawn) {
            return Ok(None);
        }
        let made = self.model(drawn.clone(), |this| {
            let ready = |clip: &Clip| this.read(clip).map(|read| read.ready.clone());
            Ok(blend.of(ready(from)?, ready(to)?)?)
        });
        match made {
            Ok(model) => Ok(Some(model)),
            Err(ExportError::Scene(SceneError::Blend(refusal))) => {
                tracing::info!("{refusal}");
                self.refused.push(drawn);
                Ok(None)
            }
            Err(error) => Err(error),
        }
    }

    fn model(
        &mut self,
        drawn: Drawn,
        make: impl FnOnce(&Self) -> Result<ReadyScene, ExportError>,
    ) -> Result<Rc<Model>, ExportError> {
        let known = self.models.iter().position(|(known, _)| *known == drawn);
        let model = match known.and_then(|at| self.models.remove(at)) {
            Some((_, model)) => model,
            None => Rc::new(self.headless_renderer.load(&self.choice, make(self)?)?),
        };
        if self.models.len() >= MODELS_MAX {
            self.models.pop_front();
        }
        self.models.push_back((drawn, model.clone()));
        Ok(model)
    }

    fn read(&self, clip: &Clip) -> Result<&Read, ExportError> {
        let read = self.scenes.iter().find(|read| read.name == clip.scene);
        read.ok_or_else(|| not_in_show(clip))
    }
}

fn not_in_show(clip: &Clip) -> ExportError {
    let scene = &clip.scene;
    ExportError::Refused(format!("the show has no scene {scene}: this is a bug in Mariana; report it"))
}

fn params_of(world: &World, clip: &Clip, time: f64) -> Vec<f32> {
    clip.numbers_at(&world.scene, time, |param| param.default)
}
