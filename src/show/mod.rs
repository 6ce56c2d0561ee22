//! What is on when: the structure of a song and a text make a plan, and the director writes such texts.
//!
//! ```text
//! song's structure ─► director ─► script ◄─ text of a show file
//!        │                          │
//!        └────► bar lines ────► resolved: plan ─► at a moment: scene, camera, transition, parameters
//! ```
//!
//! Everything here is pure: the same song and the same text give the same plan in the window, in a video and on every
//! machine. A script names moments as musicians do (`section B`, `bar 17`, `drop 1`); a plan knows them in seconds.

mod bar_lines;
mod director;
mod live;
mod parse;
mod performance;
mod picture;
mod plan;
mod programme;
mod resolve;
mod scene_facts;
mod script;
mod substitutes;
mod text;

pub use bar_lines::BarLines;
pub use director::{SceneCard, direct};
pub use live::{Hearing, LiveDirector};
pub use parse::{Parsed, parse};
pub use performance::{Finish, OnStage, Performance, Turned};
pub use picture::{Held, Picture};
pub use plan::{Entrance, Moment, Move, Moved, Plan, Stay, blend_kind};
pub use programme::{Programme, ShowError, ShowSource, name_of, seed_of};
pub use resolve::resolve;
pub use script::{
    Anchor, CAMERA_TURNS, Entry, Length, PICTURE_NUMBERS, PLAIN_PICTURE, Script, Setting, Step, Transition,
    UNTURNED, When,
};
pub use text::print;
