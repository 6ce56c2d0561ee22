//! The inputs of a scene session, and the state that survives the loss of its OpenGL context.

use super::decks::Decks;
use super::library::SceneLoader;
use super::parameters::Parameters;
use super::prepared_scene::{DrawingChoice, LoadedScene};
use super::show_follower::ShowFollower;
use crate::frame::projection::Projection;
use crate::scenes::SceneSource;
use crate::view::ViewChoice;

pub(crate) struct SceneLoaders {
    pub shown: SceneLoader,
    /// The loaders of the next and the previous scene, if they are prepared ahead.
    pub ahead: Option<[SceneLoader; 2]>,
}

#[derive(Debug, Clone, Copy)]
pub(crate) struct DrawingWays {
    pub choice: DrawingChoice,
    pub view: Option<ViewChoice>,
    pub projection: Projection,
    /// Duration of a fade between scenes in seconds.
    pub fade: f64,
}

/// What a session takes over from another one.
pub(crate) struct TakenOver {
    pub parameters: Parameters,
    /// The requested scene.
    pub wanted: SceneSource,
    pub show: ShowFollower,
    pub decks: Option<Decks>,
}

/// The state that survives the loss of the OpenGL context.
pub(crate) struct KeptScenes {
    pub loaders: SceneLoaders,
    pub shown: Option<LoadedScene>,
    pub ways: DrawingWays,
    pub taken_over: TakenOver,
}
