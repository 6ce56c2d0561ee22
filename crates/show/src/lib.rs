//! A show defines the scene for each moment of a song. A cue list comes from a text or from the director. Resolving
//! the cue list for a song gives a timeline.
//!
//! ```text
//! song's structure ─► director ─► cue list ◄─ text of a show file
//!        │                          │
//!        └────► bar lines ────► timeline ─► at a moment: scene, camera, transition, parameters
//! ```
//!
//! All functions are pure: the same song and the same text give the same timeline in the window, in a video and on
//! every machine. A cue list names moments in musical terms (`section B`, `bar 17`, `drop 1`). A timeline has the
//! moments in seconds. A show knows scenes by name, and the caller supplies facts about the scenes:
//!
//! ```
//! use mariana_field::lang::About;
//! use mariana_music::SongStructure;
//! use mariana_show::{SceneCard, Show};
//!
//! // Without beats, bars take two seconds.
//! let song = SongStructure { seconds: 60.0, ..SongStructure::default() };
//! let text = "at start orb\n\
//!             at bar 9 city melt over 2 bars\n\
//!             set height = 1 -> 3 over 4 bars";
//! let find = |name: &str| {
//!     let (scene, params) = (name.to_owned(), vec!["height".to_owned()]);
//!     Ok(SceneCard { scene, about: About::default(), cameras: Vec::new(), params, rise: None })
//! };
//! let (show, left_out) = Show::of_text("my.show", text, &song, find)?;
//! assert_eq!(left_out, None);
//!
//! // Bar 9 begins at 16 s, and the melt takes four seconds.
//! let timeline = show.timeline().expect("no entry waits for a key");
//! let moment = timeline.at(18.0);
//! assert_eq!(moment.clip.scene, "city");
//! let (leaving, fraction) = moment.leaving.expect("a transition");
//! assert_eq!((leaving.scene.as_str(), fraction), ("orb", 0.5));
//! # Ok::<(), mariana_show::CueListError>(())
//! ```
//!
//! [`Show::directed`] chooses the scenes for a song by the song's structure. [`LiveDirector`] chooses scenes for live
//! input. [`Performance`] records a show as a cue list.

mod bar_lines;
mod cue_list;
mod director;
pub mod limits;
mod live;
mod parse;
mod performance;
mod picture;
mod resolve;
mod scene_card;
mod show;
mod snapshots;
mod substitutes;
mod text;
mod timeline;

pub use bar_lines::BarLines;
pub use cue_list::{
    Anchor, CAMERA_TURNS, CueList, Entry, FADER, Length, PICTURE_NUMBERS, PLAIN_PICTURE, Setting, Step,
    Transition, TransitionKind, UNTURNED, When,
};
pub use director::direct;
pub use live::{Hearing, LiveDirector};
pub use parse::{Parsed, parse};
pub use performance::{Finish, OnStage, OtherDeck, Performance, Turned};
pub use picture::{Held, ShownPicture};
pub use resolve::resolve;
pub use scene_card::{Refusal, Rise, SceneCard};
pub use show::{CueListError, Show, seed_of};
pub use snapshots::snapshot_cues;
pub use text::{moment, print};
pub use timeline::{Clip, Moment, Move, Moved, TimedTransition, Timeline};
