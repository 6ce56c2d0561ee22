//! The window: the only room that uses winit.

mod announcer;
pub mod error;
mod frame_times;
mod governor;
pub mod keys;
mod media_controls;
pub mod overlay;
pub mod pacing;
mod pointer;
mod region_builder;
mod scene_regions;
mod scene_stage;
mod show;
mod sound;
mod stage;
mod title;
mod window;

pub use error::AppError;
pub use show::run;
