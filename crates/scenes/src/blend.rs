//! Scenes on the way into other scenes.

use std::path::PathBuf;
use std::sync::Arc;

use super::{DraftTexts, NumberEdits, ReadyScene, SceneError, SceneSource, TextureCache};
use mariana_field::graph::FrameInputs;
use mariana_field::world::{Alignment, BlendKind, World};

/// A scene as one of its cameras sees it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SeenScene {
    /// The scene.
    pub source: SceneSource,
    /// One of its cameras; none, or one that it does not have, is its own.
    pub camera: Option<String>,
}

/// One scene on its way into another.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SceneBlend {
    /// The scene that goes.
    pub from: SeenScene,
    /// The scene that comes.
    pub to: SeenScene,
    /// How.
    pub kind: BlendKind,
    /// The moment at which both cameras see from one place, in milliseconds of the song.
    pub aligned_at: u64,
}

impl SeenScene {
    fn seen(&self, ready: ReadyScene) -> Result<ReadyScene, SceneError> {
        Ok(match camera_number(&ready.world, self.camera.as_deref()) {
            Some(camera) => ReadyScene { world: Arc::new(ready.world.seen_by(camera)?), ..ready },
            None => ready,
        })
    }
}

impl SceneBlend {
    /// The blend of the two scenes as they were read. Its last parameter is the share of the second one.
    ///
    /// # Errors
    /// Together they exceed a limit.
    pub fn of(&self, from: ReadyScene, to: ReadyScene) -> Result<ReadyScene, SceneError> {
        let (from, to) = (self.from.seen(from)?, self.to.seen(to)?);
        // As they are in silence, so that the same show has the same worlds wherever one enters it.
        let camera = |scene: &ReadyScene| {
            let params = scene.world.scene.params.iter().map(|param| param.default).collect();
            let time = self.aligned_at as f32 / 1000.0;
            scene.world.frame_tape.values(&FrameInputs { time, params, ..FrameInputs::default() }).camera
        };
        let alignment = Alignment::of(&camera(&from), &camera(&to));
        Ok(from.blended(&to, self.kind, &alignment, 0.0)?)
    }

    /// Reads both scenes and blends them, and tells on which files the blend depends.
    pub(super) fn ready_with(
        &self,
        textures: &mut TextureCache,
        drafts: &DraftTexts,
    ) -> (Result<ReadyScene, SceneError>, Vec<PathBuf>) {
        let mut read =
            |seen: &SeenScene| seen.source.ready_with(textures, &mut NumberEdits::default(), drafts);
        let ((from, mut files), (to, others)) = (read(&self.from), read(&self.to));
        files.extend(others);
        (from.and_then(|from| self.of(from, to?)), files)
    }
}

/// The number of the camera of that name among those of a world.
pub fn camera_number(world: &World, camera: Option<&str>) -> Option<usize> {
    let wanted = camera?;
    world.scene.cameras.iter().position(|(name, _)| name == wanted)
}
