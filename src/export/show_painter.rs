//! Draws a show without a window: at each moment a scene, a fade, or a blend of two scenes. A single scene is a show of
//! one clip.

use std::collections::VecDeque;
use std::rc::Rc;
use std::sync::Arc;

use super::error::ExportError;
use super::painter::{HeadlessRenderer, Model, SceneChoice, held_of, require_inputs};
use super::song_features::SongFeatures;
use crate::frame::held_inputs::{HeldInputs, Setting};
use crate::gpu::Mode;
use crate::scenes::{ReadyScene, SceneError, SceneSource};
use crate::show::{Held, Layer, PreparedShow, Recipe, ShowError, Timeline};
use mariana_field::graph::Graph;
use mariana_music::Sound;

/// Maximum number of scenes and blends on the GPU; the least recently drawn ones are removed first.
const MODELS_MAX: usize = 8;
/// Decoded sound stays available for this time, in seconds.
const KEPT: f64 = 1.0;

struct Read {
    source: SceneSource,
    ready: ReadyScene,
    held: HeldInputs,
}

/// A show on the GPU, with its own context. Draws frames of any size.
pub struct ShowPainter {
    pub(super) headless_renderer: HeadlessRenderer,
    choice: SceneChoice,
    prepared_show: Arc<PreparedShow>,
    scenes: Vec<Read>,
    /// Scenes and blends on the GPU, the most recently drawn last.
    models: VecDeque<(SceneSource, Rc<Model>)>,
    /// Blends that failed. A fade replaces each of them.
    refused: Vec<SceneSource>,
    /// Moment and size of the last frame; `None` if that frame was not frozen.
    held: Option<(f64, (u32, u32))>,
    /// The result of the last [`ShowPainter::held_at`].
    frozen: Vec<(Held, Sound)>,
}

/// A moment of a song, in seconds, and its sound.
pub type Heard = (f64, Sound);

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
        let sources = prepared_show.sources().into_iter();
        let scenes = sources
            .map(|source| Ok((source.clone(), source.ready()?)))
            .collect::<Result<_, ExportError>>()?;
        Self::of_ready(choice, prepared_show, scenes, set)
    }

    /// Prepares to draw a single scene, which is compiled already.
    ///
    /// # Errors
    /// Fails if a setting is refused, the driver reports an error, or a scene that should be transparent has its own
    /// sky.
    pub fn of_scene(choice: &SceneChoice, ready: ReadyScene, set: &[Setting]) -> Result<Self, ExportError> {
        let prepared_show = PreparedShow::of_cuts([(0.0, choice.source.clone())]);
        Self::of_ready(choice, Arc::new(prepared_show), vec![(choice.source.clone(), ready)], set)
    }

    fn of_ready(
        choice: &SceneChoice,
        prepared_show: Arc<PreparedShow>,
        scenes: Vec<(SceneSource, ReadyScene)>,
        set: &[Setting],
    ) -> Result<Self, ExportError> {
        let dims = prepared_show.timeline().ok_or(ShowError::WaitsForKeys)?.dims();
        let known: Vec<_> = scenes.iter().map(|(_, ready)| &ready.world.scene).collect();
        require_inputs(&known, set)?;
        let mut headless_renderer = HeadlessRenderer::open(choice)?;
        if dims {
            headless_renderer.renderer.add_dimming(&choice.shaders)?;
        }
        let read = |(source, ready): (SceneSource, ReadyScene)| {
            if choice.alpha {
                super::alpha::require_no_sky(&ready, &source.name())?;
            }
            let held = held_of(&ready.world.scene, set)?;
            Ok(Read { source, ready, held })
        };
        let scenes = scenes.into_iter().map(read).collect::<Result<_, ExportError>>()?;
        let (models, refused) = (VecDeque::new(), Vec::new());
        Ok(Self {
            headless_renderer,
            choice: choice.clone(),
            prepared_show,
            scenes,
            models,
            refused,
            held: None,
            frozen: Vec::new(),
        })
    }

    /// The graphs of all scenes.
    pub(super) fn graphs(&self) -> impl Iterator<Item = &Graph> {
        self.scenes.iter().map(|read| &read.ready.world.scene.graph)
    }

    /// Returns the frozen frames at `time`, in seconds, and their sounds. `song` was opened for times from `opened` on.
    /// Times must not decrease.
    pub(super) fn held_at(
        &mut self,
        song: &mut SongFeatures,
        opened: f64,
        time: f64,
    ) -> Result<Vec<(Held, Sound)>, ExportError> {
        let mut all = Vec::new();
        for held in self.prepared_show.timeline().map(|timeline| timeline.held_at(time)).unwrap_or_default() {
            let known = self.frozen.iter().find(|(known, _)| known.since == held.since);
            let sound = match known {
                Some((_, sound)) => sound.clone(),
                // Recent sound is still available. For earlier sound, open the song again.
                None if held.since >= opened && time - held.since <= KEPT => song.require(held.since)?,
                None => song.beside(held.since)?.require(held.since)?,
            };
            all.push((held, sound));
        }
        self.frozen.clone_from(&all);
        Ok(all)
    }

    /// Draws the frame at `time`: the mean of its exposures. `held` has the frozen frames of this moment, and their
    /// sounds.
    ///
    /// # Errors
    /// Fails if the driver reports an error.
    pub fn draw(
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
                self.draw_exposure(time, heard, &held, size)?;
                self.headless_renderer.expose(number, count)?;
            }
        }
        self.held = alone;
        let brightness = |timeline: &Timeline| timeline.picture_at(time).brightness;
        let brightness = self.prepared_show.timeline().map_or(1.0, brightness);
        Ok(self.headless_renderer.renderer.dim(brightness)?)
    }

    /// Returns the last frame as RGBA bytes, top row first; premultiplied if it is transparent.
    pub fn read(&self) -> Vec<u8> {
        self.headless_renderer.read()
    }

    /// Returns the mode of the scene that was drawn last; `None` before the first frame.
    pub fn mode(&self) -> Option<Mode> {
        self.models.back().map(|(_, model)| model.mode)
    }

    /// Draws an exposure of the frame at `time`: the layers of its recipe. `held` has the sounds of frozen frames.
    fn draw_exposure(
        &mut self,
        time: f64,
        heard: Heard,
        held: &[(Held, Sound)],
        size: (u32, u32),
    ) -> Result<(), ExportError> {
        let prepared_show = self.prepared_show.clone();
        let (exposed, sound) = heard;
        let (layers, models) = loop {
            let can_blend = |blend: &SceneSource| !self.refused.contains(blend);
            let recipe = prepared_show.recipe(time, exposed, can_blend).ok_or_else(not_in_show)?;
            if let Some(models) = self.models_of(&recipe)? {
                break (recipe.layers, models);
            }
        };
        // Views are not mixed.
        let only = if self.headless_renderer.view.is_some() { layers.len() - 1 } else { 0 };
        for (layer, model) in layers.iter().zip(models).skip(only) {
            let sound = match held.iter().find(|(held, _)| held.since == layer.time) {
                Some((_, sound)) => sound.clone(),
                None => sound.clone(),
            };
            self.draw_layer(layer, &model, sound, size)?;
        }
        Ok(())
    }

    fn draw_layer(
        &mut self,
        layer: &Layer<'_>,
        model: &Model,
        sound: Sound,
        size: (u32, u32),
    ) -> Result<(), ExportError> {
        let held = match &layer.source {
            SceneSource::Blend(blend) => {
                let [from, to] = [self.read_scene(&blend.from.source)?, self.read_scene(&blend.to.source)?];
                from.held.followed_by(&to.held, from.ready.world.scene.params.len())
            }
            source => self.read_scene(source)?.held.clone(),
        };
        let frame_at = |time, sound| layer.frame(model.world(), time, sound, size, &held);
        self.headless_renderer.feed_back(model, layer.time, &sound, size, &frame_at)?;
        let frame = frame_at(layer.time, sound);
        match layer.below {
            None => self.headless_renderer.draw(model, frame),
            Some(fraction) => self.headless_renderer.draw_over(model, frame, fraction),
        }
    }

    /// Returns the models of the layers; `None` if a blend has turned out to be impossible.
    fn models_of(&mut self, recipe: &Recipe<'_>) -> Result<Option<Vec<Rc<Model>>>, ExportError> {
        let mut models = Vec::new();
        for layer in &recipe.layers {
            match self.model(&layer.source) {
                Err(ExportError::Scene(SceneError::Blend(refusal))) => {
                    tracing::info!("{refusal}");
                    self.refused.push(layer.source.clone());
                    return Ok(None);
                }
                model => models.push(model?),
            }
        }
        Ok(Some(models))
    }

    fn model(&mut self, source: &SceneSource) -> Result<Rc<Model>, ExportError> {
        let known = self.models.iter().position(|(known, _)| known == source);
        let model = match known.and_then(|at| self.models.remove(at)) {
            Some((_, model)) => model,
            None => {
                let ready = |source| Ok::<_, ExportError>(self.read_scene(source)?.ready.clone());
                let ready = match source {
                    SceneSource::Blend(blend) => {
                        blend.of(ready(&blend.from.source)?, ready(&blend.to.source)?)?
                    }
                    source => ready(source)?,
                };
                Rc::new(self.headless_renderer.load(&self.choice, ready)?)
            }
        };
        if self.models.len() >= MODELS_MAX {
            self.models.pop_front();
        }
        self.models.push_back((source.clone(), model.clone()));
        Ok(model)
    }

    fn read_scene(&self, source: &SceneSource) -> Result<&Read, ExportError> {
        self.scenes.iter().find(|read| read.source == *source).ok_or_else(not_in_show)
    }
}

fn not_in_show() -> ExportError {
    ExportError::Refused("the show lacks one of its scenes: this is a bug in Mariana; report it".to_owned())
}
