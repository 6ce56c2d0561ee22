//! Shows with the scenes that they name: where those come from, and what is wrong with any of them. What is on when is
//! decided by [`mariana_show`], which knows names of scenes only.

mod live;
mod programme;
mod scene_facts;

pub use live::LiveDirector;
pub use mariana_show::{
    Entrance, Finish, Hearing, Held, Moment, Move, Moved, OnStage, Performance, Picture, Plan, Stay, Turned,
    blend_kind, print,
};
pub use programme::{Programme, ShowError, ShowSource, name_of};
