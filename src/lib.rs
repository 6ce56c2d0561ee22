//! Mariana: a music visualizer whose worlds are formulas.
//!
//! The folders spell the pipeline: sound comes in through [`audio`], is analysed in [`dsp`], meets time and
//! camera in [`frame`], and is drawn by [`gpu`] for a window ([`app`]) or a file ([`export`]).
//! ARCHITECTURE.md says what lives where and what must never be.

pub mod app;
pub mod atomic_file;
pub mod audio;
pub mod cli;
pub mod config;
pub mod dsp;
pub mod ending;
pub mod export;
pub mod faults;
pub mod flash;
pub mod frame;
pub mod gpu;
pub mod graph;
pub mod lang;
pub mod limits;
pub mod region;
pub mod scenes;
pub mod tape;
pub mod view;
pub mod world;
