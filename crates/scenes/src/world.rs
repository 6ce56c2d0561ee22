//! From a source to a world that is ready to be drawn.

use std::path::PathBuf;
use std::sync::Arc;

use super::textures::TextureCache;
use super::{DraftTexts, FoundMistakes, NumberEdits, SceneError, SceneSource};
use mariana_field::lang::{Compiled, Diagnostic, Scene, render_all};
use mariana_field::region::RegionPlan;
use mariana_field::world::{Alignment, BlendError, BlendKind, TapeBuffers, World, WorldError};

/// A world with the programs of its tape.
#[derive(Debug, Clone)]
pub struct ReadyScene {
    /// The world.
    pub world: Arc<World>,
    /// Its programs.
    pub buffers: Arc<TapeBuffers>,
    /// What builds its regions.
    pub plan: Arc<RegionPlan>,
    /// Whether this is the text that is shown already, in which numbers are constants again after they were changed.
    pub settles: bool,
}

impl ReadyScene {
    /// What builds and draws a world.
    ///
    /// # Errors
    /// A world over the limits.
    fn of(world: World) -> Result<Self, WorldError> {
        let buffers = Arc::new(world.tape_buffers()?);
        let plan = Arc::new(RegionPlan::new(&world));
        Ok(Self { world: Arc::new(world), buffers, plan, settles: false })
    }

    /// A scene between this one and another, which stands where `alignment` puts it and of which a share is shown, 0..1,
    /// unless a frame says otherwise.
    ///
    /// # Errors
    /// Together they exceed a limit.
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
    /// A file that cannot be read, mistakes in the text (with all diagnostics), missing pictures, a scene over the
    /// limits.
    pub fn ready(&self) -> Result<ReadyScene, SceneError> {
        self.ready_with(&mut TextureCache::default(), &mut NumberEdits::default(), &DraftTexts::default()).0
    }

    /// The same as if `text` were its own.
    ///
    /// # Errors
    /// As [`SceneSource::ready`].
    pub fn ready_as(&self, text: &str) -> Result<ReadyScene, SceneError> {
        let compiled = self.compile_as(text, &mut NumberEdits::default(), &DraftTexts::default());
        self.prepare(compiled, &mut TextureCache::default())
    }

    /// The same with pictures from a cache, and the files that cause it to be repeated when they change, whether it
    /// worked or not. `edits` tells which numbers of its text are being changed, and `drafts` stand in the place of
    /// what files hold.
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
                (ready.map(|ready| ReadyScene { settles: edits.has_settled(), ..ready }), files)
            }
            Err(error) => (Err(error), self.files(None)),
        }
    }

    /// Reads and compiles it; a text with mistakes is an error.
    ///
    /// # Errors
    /// As [`SceneSource::ready`].
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
        let Some(scene) = compiled.scene.take() else {
            let diagnostics = std::mem::take(&mut compiled.diagnostics);
            return Err(self.mistakes(diagnostics, compiled));
        };
        let pictures = match textures.load(self, &scene) {
            Ok(pictures) => pictures,
            Err(wrong) => return Err(self.mistakes(wrong, compiled)),
        };
        Ok(ReadyScene::of(World::new(&self.name(), scene, pictures)?)?)
    }

    fn mistakes(&self, diagnostics: Vec<Diagnostic>, compiled: Compiled) -> SceneError {
        let render = |color| render_all(&diagnostics, &compiled.sources, color);
        let (plain, colored) = (render(false), render(true));
        let found = Box::new(FoundMistakes { diagnostics, sources: compiled.sources });
        SceneError::Mistakes { name: self.name(), plain, colored, found }
    }
}
