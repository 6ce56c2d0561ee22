//! Scenes: the current scene, its program, and the scenes that come next.
//!
//! ```text
//! SceneLibrary (requested scene) ───► ScenePreparation ─► PreparedScenes ─► SceneComposer ─► frame
//!                  ▲                   programs, trees      shown, coming,    fades, views,
//!             ShowFollower                                  fading out, next  camera
//!             the user                                          ▲
//!                                                           Parameters
//! ```
//!
//! [`SceneSession`] is the entry point: it owns the parts and passes results between them. Each
//! part owns its state and receives the state of others as arguments.

mod active_clips;
mod ahead;
mod awaited_edit;
mod beat_count;
mod camera;
mod composer;
mod context_change;
pub(crate) mod decks;
mod fading;
mod feedback;
mod kept;
mod knobs;
mod library;
mod messages;
mod on_decks;
mod parameters;
mod performed;
mod preparation;
mod prepared_scene;
mod prepared_scenes;
mod preview;
mod program_library;
mod program_task;
mod refinement;
mod refusal;
mod region_builder;
mod regions;
pub(crate) mod report;
mod scene_change;
mod scenery;
mod session;
mod show_follower;
#[cfg(test)]
mod testing;
#[cfg(test)]
mod tests;
mod versions;
mod views;

pub(crate) use composer::{Drawn, WantedPicture};
pub(crate) use context_change::{DrawingWays, SceneLoaders};
pub(crate) use library::SceneLoader;
pub(crate) use performed::{Performed, named};
pub(crate) use prepared_scene::{DrawingChoice, LoadedScene};
pub(crate) use regions::Shown;
pub(crate) use session::SceneSession;
