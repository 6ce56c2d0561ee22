//! Shows with the sources of their scenes. [`mariana_show`], which knows scenes by name only, makes the plans.

mod live;
mod programme;
mod scene_facts;

pub use live::LiveDirector;
pub use mariana_show::{
    Entrance, Finish, Hearing, Held, Moment, Move, Moved, OnStage, Performance, Picture, Plan, Stay,
    TransitionKind, Turned, print,
};
pub use programme::{Programme, ShowError, ShowSource, name_of};
