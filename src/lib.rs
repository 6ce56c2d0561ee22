//! Mariana: a music visualizer whose worlds are formulas.
//!
//! The folders spell the pipeline: sound comes in through `mariana_player`, is analysed in `mariana_music`, meets
//! time and camera in [`frame`], and is drawn by [`gpu`] for a window ([`shell`]) or a file ([`export`]).
//! ARCHITECTURE.md says what is where, and which rules hold.

pub use mariana_commands::{self as commands, input};
pub use mariana_files::{atomic_file, documents, ending};
pub use mariana_render::{faults, flash, frame, gpu, placement, reading_order, srgb, system_fonts, view};
pub use mariana_scenes::{self as scenes, probing, thumbnails};
pub use mariana_ui::{self as ui, clock, monitor};

pub mod cli;
pub mod config;
pub mod demo_track;
pub mod export;
pub mod limits;
pub mod program_cache;
pub mod sending;
pub mod session;
pub mod shell;
pub mod show;
pub mod song_structures;
pub mod y4m;
