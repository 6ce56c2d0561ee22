//! Mariana: a music visualizer whose worlds are formulas.
//!
//! The folders spell the pipeline: sound comes in through `mariana_player`, is analysed in `mariana_music`, meets
//! time and camera in [`frame`], and is drawn by [`gpu`] for a window ([`app`]) or a file ([`export`]).
//! ARCHITECTURE.md says what is where, and which rules hold.

pub mod app;
pub mod atomic_file;
pub mod cli;
pub mod config;
pub mod demo_track;
pub mod documents;
pub mod ending;
pub mod export;
pub mod faults;
pub mod flash;
pub mod frame;
pub mod gpu;
pub mod limits;
pub mod placement;
pub mod program_cache;
pub mod reading_order;
pub mod scenes;
pub mod sending;
pub mod session;
pub mod show;
pub mod song_structures;
pub mod srgb;
pub mod system_fonts;
pub mod thumbnails;
pub mod view;
pub mod y4m;
