//! Plays a show: prepares the scenes of the next changes, and arranges the scenes of a moment.

use mariana_music::SongStructure;
use mariana_render::Gl;
use mariana_render::frame::held_inputs::HeldInputs;
use mariana_render::gpu::scene_program::Mode;
use mariana_render::gpu::shader_source::ShaderLibrary;
use mariana_scenes::{SceneSource, shipped_names};
use mariana_stage::{PreparedShow, Recipe, SceneCard, card_of};
use web_sys::console;

use super::shown::{Coming, Shown, ShownLayer};

pub(crate) struct ShowPlayer {
    show: PreparedShow,
    /// The scenes and blends of the present moment and of the next transition; `None` for a scene with mistakes, and
    /// for a scene that the browser cannot compile.
    scenes: Vec<(SceneSource, Option<Shown>)>,
    /// The next one of `scenes`, whose program the browser compiles.
    coming: Option<(SceneSource, Coming)>,
    /// Blends that were not ready when they began. Fades replace them until the next clip.
    late: Vec<SceneSource>,
    /// The start of the present clip, in seconds.
    clip: Option<f64>,
    held: HeldInputs,
}

impl ShowPlayer {
    pub(crate) fn new(show: PreparedShow) -> Self {
        let held = HeldInputs::default();
        Self { show, scenes: Vec::new(), coming: None, late: Vec::new(), clip: None, held }
    }

    /// Prepares a scene of the moment `time`, in seconds, or of the next change. Call it once a frame, because reading a
    /// scene takes a part of the page's time.
    pub(crate) fn prepare(&mut self, gl: &Gl, library: &ShaderLibrary, time: f64) {
        if let Some((source, coming)) = self.coming.take_if(|(_, coming)| coming.is_compiled()) {
            self.scenes.push((source, coming.finish().ok()));
            return;
        }
        if self.coming.is_some() {
            return;
        }
        let wanted = self.wanted(time);
        // An old scene stays in the picture until a new one is ready.
        let has_new = wanted.iter().any(|source| self.ready(source).is_some());
        self.scenes.retain(|(source, shown)| !has_new || shown.is_none() || wanted.contains(source));
        let is_new = |source: &SceneSource| self.scenes.iter().all(|(known, _)| known != source);
        if let Some(source) = wanted.into_iter().find(is_new) {
            let ready = source.ready().map_err(|error| error.to_string());
            match ready.and_then(|ready| Coming::begin(gl, library, ready, Mode::Compiled)) {
                Ok(coming) => self.coming = Some((source, coming)),
                Err(reason) => {
                    console::warn_1(&format!("{} cannot be shown: {reason}", source.title()).into());
                    self.scenes.push((source, None));
                }
            }
        }
    }

    /// True until [`Self::prepare`] has all scenes of `time` seconds and of the next change.
    pub(crate) fn is_preparing(&self, time: f64) -> bool {
        let is_known = |wanted: &SceneSource| self.scenes.iter().any(|(source, _)| source == wanted);
        !self.wanted(time).iter().all(is_known)
    }

    /// True once a scene of the show can be drawn.
    pub(crate) fn can_draw(&self) -> bool {
        self.scenes.iter().any(|(_, shown)| shown.is_some())
    }

    /// The scenes and blends at `time` and in the next transition, the most urgent first.
    fn wanted(&self, time: f64) -> Vec<SceneSource> {
        let clips = self.show.clips();
        let next = clips.iter().find(|clip| clip.start > time);
        let of_next = next
            .map(|clip| [clip.start + 0.5 * clip.transition.seconds, clip.start + clip.transition.seconds]);
        let mut wanted = Vec::new();
        for moment in std::iter::once(time).chain(of_next.into_iter().flatten()) {
            let recipe = self.show.recipe(moment, moment, |blend| !self.is_refused(blend));
            for layer in recipe.into_iter().flat_map(|recipe| recipe.layers) {
                // A fade may have to replace a blend, which needs both scenes.
                let leaving = layer.leaving.and_then(|(clip, _)| self.show.source(&clip.scene));
                let entering = self.show.source(&layer.clip.scene);
                let all = [Some(&layer.source), entering, leaving];
                wanted.extend(all.into_iter().flatten().cloned());
            }
        }
        wanted
    }

    fn is_refused(&self, source: &SceneSource) -> bool {
        self.late.contains(source)
            || self.scenes.iter().any(|(known, shown)| known == source && shown.is_none())
    }

    fn ready(&self, source: &SceneSource) -> Option<&Shown> {
        self.scenes.iter().find(|(known, _)| known == source)?.1.as_ref()
    }

    /// Replaces the blend at `time` seconds by a fade if it is not ready when it begins.
    pub(crate) fn replace_late_blends(&mut self, time: f64) {
        let clip = self.show.at(time).map(|moment| moment.clip.start);
        if std::mem::replace(&mut self.clip, clip) != clip {
            self.late.clear();
        }
        let recipe = self.show.recipe(time, time, |blend| !self.is_refused(blend));
        let mut sources = recipe.into_iter().flat_map(|recipe| recipe.layers).map(|layer| layer.source);
        let is_late =
            |source: &SceneSource| matches!(source, SceneSource::Blend(_)) && self.ready(source).is_none();
        self.late.extend(sources.find(is_late));
    }

    /// The ready scenes of the moment `time`, in seconds, for a picture of `size` pixels, and the brightness of the picture,
    /// 0..1. Until one of them is ready, an old scene stays.
    pub(crate) fn layers(&self, time: f64, size: (u32, u32)) -> (Vec<ShownLayer<'_>>, f32) {
        let mut layers: Vec<ShownLayer<'_>> = Vec::new();
        let Some(Recipe { layers: planned, brightness }) =
            self.show.recipe(time, time, |blend| !self.is_refused(blend))
        else {
            return (layers, 1.0);
        };
        for layer in planned {
            let Some(shown) = self.ready(&layer.source) else { continue };
            let (time, below) = (layer.time, layer.below.filter(|_| !layers.is_empty()));
            let frame_at = move |time, sound| layer.frame(shown.world(), time, sound, size, &self.held);
            layers.push(ShownLayer { shown, time, below, frame_at: Box::new(frame_at) });
        }
        if layers.is_empty() {
            let old = self.scenes.iter().rev().find_map(|(_, shown)| shown.as_ref());
            layers.extend(old.map(|shown| shown.layer(time, size)));
        }
        (layers, brightness)
    }

    /// The scene at `time` seconds; in a transition, the incoming one.
    pub(crate) fn scene_at(&self, time: f64) -> Option<&SceneSource> {
        self.show.source(&self.show.at(time)?.clip.scene)
    }
}

/// What the director knows about the shipped scenes, which are read one after the other.
#[derive(Default)]
pub(crate) struct Cards {
    read: Vec<(SceneCard, SceneSource)>,
    count: usize,
}

impl Cards {
    /// Reads the next scene. Returns false if none is left.
    pub(crate) fn read_next(&mut self) -> bool {
        let Some(name) = shipped_names().into_iter().nth(self.count) else { return false };
        self.count += 1;
        let source = SceneSource::Shipped(name);
        if let Ok(card) = card_of(&source) {
            self.read.push((card, source));
        }
        true
    }

    /// The director's show for a song; `None` without scenes.
    pub(crate) fn directed(&self, song: &SongStructure) -> Option<PreparedShow> {
        PreparedShow::directed_among(song, self.read.iter().cloned(), &[]).ok()
    }
}
