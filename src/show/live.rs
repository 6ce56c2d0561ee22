//! The live director, with the sources of its scenes.

use super::programme::Programme;
use mariana_show::Hearing;

/// See [`mariana_show::LiveDirector`].
#[derive(Debug, Clone)]
pub struct LiveDirector {
    programme: Programme,
    director: mariana_show::LiveDirector,
}

impl LiveDirector {
    /// Among the scenes that a programme knows.
    pub fn new(programme: Programme) -> Self {
        let director = mariana_show::LiveDirector::new(programme.cards().to_vec());
        Self { programme, director }
    }

    /// Takes in what is heard, and returns another programme if another scene comes.
    pub fn hear(&mut self, heard: Hearing) -> Option<Programme> {
        let plan = self.director.hear(heard)?;
        Some(self.programme.with_plan(Some(plan)))
    }
}
