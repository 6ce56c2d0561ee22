//! What a recording notes of each picture.

use crate::frame::orbit_controls::OrbitControls;
use crate::scenes::SceneSource;
use crate::show::{Entrance, Finish, Move, Turned};

/// The scene that shows at a moment, and how it is shown.
pub(crate) struct Performed<'a> {
    /// What it comes from.
    pub source: &'a SceneSource,
    /// One of its cameras.
    pub camera: Option<&'a str>,
    /// How it came and when that began, in seconds of the song, where a show says so.
    pub directed: Option<(Entrance, f64)>,
    /// How it came where no show says so, and when that began, in seconds of the song; none if it was cut.
    pub faded: Option<(f64, f64)>,
    /// Whether another scene fades away in it.
    pub fades: bool,
    /// Its parameters.
    pub params: Vec<Turned<'a>>,
    /// What a show does with them.
    pub moves: &'a [Move],
    /// How the camera is moved by hand.
    pub hand: OrbitControls,
    /// What is done to the whole picture.
    pub picture: Finish,
}
