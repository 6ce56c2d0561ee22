//! The state of the show for other threads: scene, parameters, switches and levels.

use std::sync::{Arc, Mutex};

use mariana_work::lock;
use serde::Serialize;

use super::Slider;

/// The state of the show at a moment.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Present {
    /// The title of the current scene.
    pub scene: String,
    /// The titles of all scenes, in order of their numbers.
    pub scenes: Vec<String>,
    /// The parameters of the current scene.
    pub params: Vec<Slider>,
    /// The switches by action name, with their states.
    pub switches: Vec<(&'static str, bool)>,
    /// The levels by action name, 0..1. Unavailable levels are left out.
    pub levels: Vec<(&'static str, f32)>,
    /// Beats per minute; 0 while unknown.
    pub tempo: f32,
    /// The track's title; empty while an input is the source.
    pub track: String,
    /// The track's length in seconds; 0 while unknown.
    pub length: f64,
}

/// A shared board where the show publishes its state. Clones share the contents.
#[derive(Debug, Clone, Default)]
pub struct Board(Arc<Mutex<Arc<Present>>>);

impl Board {
    /// Publishes a new state.
    pub fn put(&self, present: Present) {
        *lock(&self.0) = Arc::new(present);
    }

    /// Returns the latest state. Keeping the result does not block the show.
    pub fn newest(&self) -> Arc<Present> {
        lock(&self.0).clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clones_read_the_published_state() {
        let board = Board::default();
        let other = board.clone();
        board.put(Present { tempo: 120.0, ..Present::default() });
        assert_eq!(other.newest().tempo, 120.0);
    }
}
