//! Shows with the sources of their scenes: [`mariana_show`] knows only names; [`prepared_show`] adds the sources.

mod prepared_show;

pub use mariana_show::{
    BarLines, Clip, Cue, Finish, Hearing, Held, LiveDirector, Moment, Move, Moved, OnStage, OtherDeck,
    Performance, ShownPicture, TimedTransition, Timeline, TransitionKind, Turned, print, snapshot_cues,
};
pub use prepared_show::{PreparedShow, ShowError, ShowSource, name_of};
