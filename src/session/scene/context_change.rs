//! What a session of scenes begins with, and what of it goes on when its context is lost and another one takes its place.

use std::time::Instant;

use super::library::SceneLoader;
use crate::config::SdfChoice;
use crate::gpu::cell_use::CellUse;
use crate::scenes::{ReadyScene, SceneSource};
use crate::view::ViewChoice;
use mariana_control::Model;

/// What loads scenes.
pub(crate) struct SceneLoaders {
    /// The one that was asked for.
    pub shown: SceneLoader,
    /// The next and the previous one, if they are prepared ahead.
    pub ahead: Option<[SceneLoader; 2]>,
}

/// A scene that was loaded, and where it comes from.
pub(crate) struct LoadedScene {
    /// Where it comes from.
    pub source: SceneSource,
    /// What can be drawn.
    pub scene: ReadyScene,
}

/// How scenes are drawn.
#[derive(Debug, Clone, Copy)]
pub(crate) struct DrawingWays {
    /// Interpreted, compiled or both.
    pub sdf: SdfChoice,
    /// Whether cells of regions are used where they can be.
    pub cells: CellUse,
    /// A view of how the picture is made, instead of the picture.
    pub view: Option<ViewChoice>,
    /// How long one scene fades into another, in seconds.
    pub fade: f64,
}

/// What outlives the context that scenes are drawn in.
pub(crate) struct KeptScenes {
    /// What loads scenes.
    pub loaders: SceneLoaders,
    /// The scene that was shown.
    pub shown: Option<LoadedScene>,
    /// The scene that was last asked for.
    pub wanted: SceneSource,
    /// What hands have turned, and the zero of its seconds.
    pub controllers: (Model, Instant),
    /// How scenes are drawn.
    pub ways: DrawingWays,
}
