//! Prepares a scene for drawing: reads, compiles and checks it.

use std::path::PathBuf;
use std::sync::Arc;

use super::textures::TextureCache;
use super::{DraftTexts, FoundMistakes, NumberEdits, SceneError, SceneSource};
use mariana_field::lang::{Compiled, Diagnostic, Scene, render_all};
use mariana_field::region::RegionPlan;
use mariana_field::world::{Alignment, BlendError, BlendKind, TapeBuffers, World, WorldError};

/// A compiled scene with its tape programs.
#[derive(Debug, Clone)]
pub struct ReadyScene {
    /// The world.
    pub world: Arc<World>,
    /// The tape programs.
    pub buffers: Arc<TapeBuffers>,
    /// The plan for building region trees.
    pub plan: Arc<RegionPlan>,
    /// True if the text is already displayed, and edited numbers now are constants instead of inputs.
    pub settles: bool,
    /// The warnings about the text; empty for a blend.
    pub warnings: Arc<FoundMistakes>,
}

impl ReadyScene {
    /// Prepares a world.
    ///
    /// # Errors
    /// Fails if the world exceeds a limit.
    fn of(world: World) -> Result<Self, WorldError> {
        let buffers = Arc::new(world.tape_buffers()?);
        let plan = Arc::new(RegionPlan::new(&world));
        Ok(Self { world: Arc::new(world), buffers, plan, settles: false, warnings: Arc::default() })
    }

    /// Blends this scene with the scene `to`, which is moved to `alignment`. The default fraction of `to` is
    /// `fraction`, 0..1; each frame can override this.
    ///
    /// # Errors
    /// Fails if the two scenes together exceed a limit.
    pub fn blended(
        &self,
        to: &Self,
        kind: BlendKind,
        alignment: &Alignment,
        fraction: f32,
    ) -> Result<Self, BlendError> {
        Ok(Self::of(World::blend(&self.world, &to.world, kind, alignment, fraction)?)?)
    }
}

impl SceneSource {
    /// Reads, compiles and prepares a scene.
    ///
    /// # Errors
    /// Fails if a file or image cannot be read, if the text has mistakes (with all diagnostics), or if the scene
    /// exceeds a limit.
    pub fn ready(&self) -> Result<ReadyScene, SceneError> {
        self.ready_with(&mut TextureCache::default(), &mut NumberEdits::default(), &DraftTexts::default()).0
    }

    /// Prepares `text` as if it were the scene's text.
    ///
    /// # Errors
    /// Fails like [`SceneSource::ready`].
    pub fn ready_as(&self, text: &str) -> Result<ReadyScene, SceneError> {
        let compiled = self.compile_as(text, &mut NumberEdits::default(), &DraftTexts::default());
        self.prepare(compiled, &mut TextureCache::default())
    }

    /// Prepares a scene with cached textures. Numbers that `edits` finds changed become inputs, and `drafts` replace
    /// files. Also returns the files that the scene depends on, even after a failure.
    pub fn ready_with(
        &self,
        textures: &mut TextureCache,
        edits: &mut NumberEdits,
        drafts: &DraftTexts,
    ) -> (Result<ReadyScene, SceneError>, Vec<PathBuf>) {
        if let Self::Blend(blend) = self {
            return blend.ready_with(textures, drafts);
        }
        match self.compile_following(edits, drafts) {
            Ok(compiled) => {
                let files = self.files(Some(&compiled));
                let ready = self.prepare(compiled, textures);
                (ready.map(|ready| ReadyScene { settles: edits.settled, ..ready }), files)
            }
            Err(error) => (Err(error), self.files(None)),
        }
    }

    /// Reads and compiles a scene. Fails if the text has mistakes.
    ///
    /// # Errors
    /// Fails like [`SceneSource::ready`].
    pub fn checked(&self) -> Result<Scene, SceneError> {
        let mut compiled = self.compile()?;
        match compiled.scene.take() {
            Some(scene) => Ok(scene),
            None => {
                let diagnostics = std::mem::take(&mut compiled.diagnostics);
                Err(self.mistakes(diagnostics, compiled))
            }
        }
    }

    fn prepare(&self, mut compiled: Compiled, textures: &mut TextureCache) -> Result<ReadyScene, SceneError> {
        let Some(mut scene) = compiled.scene.take() else {
            let diagnostics = std::mem::take(&mut compiled.diagnostics);
            return Err(self.mistakes(diagnostics, compiled));
        };
        self.find_videos(&mut scene);
        let pictures = match textures.load(self, &scene) {
            Ok(pictures) => pictures,
            Err(wrong) => return Err(self.mistakes(wrong, compiled)),
        };
        if let Err(wrong) = textures.load_shapes(self, &mut scene) {
            return Err(self.mistakes(wrong, compiled));
        }
        let world = World::new(&self.name(), scene, pictures)?;
        let mut diagnostics = compiled.warnings;
        diagnostics.extend(world.warning().into_iter().chain(world.feedback_warning()));
        let warnings = Arc::new(FoundMistakes { diagnostics, sources: compiled.sources });
        Ok(ReadyScene { warnings, ..ReadyScene::of(world)? })
    }

    fn mistakes(&self, diagnostics: Vec<Diagnostic>, compiled: Compiled) -> SceneError {
        let render = |color| render_all(&diagnostics, &compiled.sources, color);
        let (plain, colored) = (render(false), render(true));
        let found = Box::new(FoundMistakes { diagnostics, sources: compiled.sources });
        SceneError::Mistakes { name: self.name(), plain, colored, found }
    }
}
