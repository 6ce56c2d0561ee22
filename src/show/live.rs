//! The live director, with the sources of its scenes.

use super::prepared_show::PreparedShow;
use mariana_show::Hearing;

/// A [`mariana_show::LiveDirector`] that returns prepared shows.
#[derive(Debug, Clone)]
pub struct LiveDirector {
    prepared_show: PreparedShow,
    director: mariana_show::LiveDirector,
}

impl LiveDirector {
    /// Returns a director that chooses among the scenes of a prepared show.
    pub fn new(prepared_show: PreparedShow) -> Self {
        let director = mariana_show::LiveDirector::new(prepared_show.cards().to_vec());
        Self { prepared_show, director }
    }

    /// Passes features to the director. Returns a new show when the scene changes.
    pub fn process(&mut self, heard: Hearing) -> Option<PreparedShow> {
        let timeline = self.director.process(heard)?;
        Some(self.prepared_show.with_timeline(Some(timeline)))
    }
}
