//! What there is to turn and how it stands, for those who ask from other threads.

use std::sync::{Arc, Mutex, PoisonError};

use serde::Serialize;

use super::Slider;

/// The show at a moment.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Present {
    /// The title of the scene on the stage.
    pub scene: String,
    /// The titles of all scenes, in the order of their numbers.
    pub scenes: Vec<String>,
    /// The parameters of the scene on the stage.
    pub params: Vec<Slider>,
    /// Switches by the names of their actions, and whether they are on.
    pub switches: Vec<(&'static str, bool)>,
    /// Levels by the names of their actions, 0..1; one that there is not at present is left out.
    pub levels: Vec<(&'static str, f32)>,
    /// Beats per minute; 0 while unknown.
    pub tempo: f32,
    /// The name of the track; empty while an input is listened to.
    pub track: String,
    /// Its length in seconds; 0 while unknown.
    pub length: f64,
}

/// Where the show puts up how it stands; copies are the same board.
#[derive(Debug, Clone, Default)]
pub struct Board(Arc<Mutex<Arc<Present>>>);

impl Board {
    /// Puts up how it stands now.
    pub fn put(&self, present: Present) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Arc::new(present);
    }

    /// What stands on the board. Whoever reads it long holds nobody who puts up.
    pub fn newest(&self) -> Arc<Present> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Reads the board.
    pub fn read<T>(&self, read: impl FnOnce(&Present) -> T) -> T {
        read(&self.newest())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_put_up_is_read_by_everyone() {
        let board = Board::default();
        let other = board.clone();
        board.put(Present { tempo: 120.0, ..Present::default() });
        assert_eq!(other.read(|present| present.tempo), 120.0);
    }
}
