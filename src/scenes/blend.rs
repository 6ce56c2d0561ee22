//! Scenes on the way into other scenes.

use std::path::PathBuf;
use std::sync::Arc;

use super::{NumberEdits, ReadyScene, SceneError, SceneSource, TextureCache};
use mariana_field::world::{BlendKind, World};

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
        Ok(self.from.seen(from)?.blended(&self.to.seen(to)?, self.kind, 0.0)?)
    }

    /// Reads both scenes and blends them, and tells on which files the blend depends.
    pub(super) fn ready_with(
        &self,
        textures: &mut TextureCache,
    ) -> (Result<ReadyScene, SceneError>, Vec<PathBuf>) {
        let mut read = |seen: &SeenScene| seen.source.ready_with(textures, &mut NumberEdits::default());
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
