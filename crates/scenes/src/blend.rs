//! Loads blends of two scenes.

use std::path::PathBuf;
use std::sync::Arc;

use super::{DraftTexts, NumberEdits, ReadyScene, SceneError, SceneSource, TextureCache};
use mariana_field::graph::FrameInputs;
use mariana_field::world::{Alignment, BlendKind, World};

/// A scene and the camera that shows it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SeenScene {
    /// The scene.
    pub source: SceneSource,
    /// Name of a camera. `None` or an unknown name selects the scene's default camera.
    pub camera: Option<String>,
}

/// A transition from one scene to another.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SceneBlend {
    /// The outgoing scene.
    pub from: SeenScene,
    /// The incoming scene.
    pub to: SeenScene,
    /// The kind of the blend.
    pub kind: BlendKind,
    /// The time at which both cameras are aligned, in milliseconds of the song.
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
    /// Blends the two loaded scenes. The last parameter of the blended scene is the fraction of the second scene.
    ///
    /// # Errors
    /// Fails if the two scenes together exceed a limit.
    pub fn of(&self, from: ReadyScene, to: ReadyScene) -> Result<ReadyScene, SceneError> {
        let (from, to) = (self.from.seen(from)?, self.to.seen(to)?);
        // Use the cameras' values in silence, because values in music depend on where playback began.
        let camera = |scene: &ReadyScene| {
            let params = scene.world.scene.params.iter().map(|param| param.default).collect();
            let time = self.aligned_at as f32 / 1000.0;
            scene.world.frame_tape.values(&FrameInputs { time, params, ..FrameInputs::default() }).camera
        };
        let alignment = Alignment::of(&camera(&from), &camera(&to));
        Ok(from.blended(&to, self.kind, &alignment, 0.0)?)
    }

    /// Loads and blends both scenes. Also returns the files that the blend depends on.
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

/// Returns the index of the camera with that name in a world.
pub fn camera_number(world: &World, camera: Option<&str>) -> Option<usize> {
    let wanted = camera?;
    world.scene.cameras.iter().position(|(name, _)| name == wanted)
}
