//! The live director, with the sources of its scenes.

use super::prepared_show::PreparedShow;
use mariana_show::Hearing;

/// See [`mariana_show::LiveDirector`].
#[derive(Debug, Clone)]
pub struct LiveDirector {
    prepared_show: PreparedShow,
    director: mariana_show::LiveDirector,
}

impl LiveDirector {
    /// Among the scenes that a programme knows.
    pub fn new(prepared_show: PreparedShow) -> Self {
        let director = mariana_show::LiveDirector::new(prepared_show.cards().to_vec());
        Self { prepared_show, director }
    }

    /// Takes in what is heard, and returns another programme if another scene comes.
    pub fn hear(&mut self, heard: Hearing) -> Option<PreparedShow> {
        let timeline = self.director.hear(heard)?;
        Some(self.prepared_show.with_timeline(Some(timeline)))
    }
}
