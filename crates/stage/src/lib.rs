//! Shows with the sources of their scenes. [`mariana_show`] knows only names; [`PreparedShow`] adds the sources, and its
//! [`Recipe`] says what a moment shows.

mod prepared_show;
mod recipe;

pub use mariana_show::{
    Anchor, BarLines, Clip, Entry, Finish, Hearing, Held, LiveDirector, Moment, Move, OnStage, OtherDeck,
    Performance, SceneCard, ShownPicture, TimedTransition, Timeline, TransitionKind, Turned, moment, print,
    snapshot_cues,
};
pub use prepared_show::{PreparedShow, ShowError, ShowSource, card_of, name_of, source_of};
pub use recipe::{Layer, Recipe};
