//! Mariana: a music visualizer whose worlds are formulas.
//!
//! The folders spell the pipeline: sound comes in through `mariana_player`, is analysed in `mariana_music`, meets
//! time and camera in [`frame`], and is drawn by [`gpu`] for a window ([`shell`]) or a file ([`export`]).
//! ARCHITECTURE.md says what is where, and which rules hold.

pub use mariana_render::{faults, flash, frame, gpu, placement, reading_order, srgb, system_fonts, view};

pub mod atomic_file;
pub mod cli;
pub mod clock;
pub mod commands;
pub mod config;
pub mod demo_track;
pub mod documents;
pub mod ending;
pub mod export;
pub mod input;
pub mod limits;
pub mod monitor;
pub mod probing;
pub mod program_cache;
pub mod scenes;
pub mod sending;
pub mod session;
pub mod shell;
pub mod show;
pub mod song_structures;
pub mod thumbnails;
pub mod ui;
pub mod y4m;
