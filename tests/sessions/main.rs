//! Tests of whole sessions without a window: they draw into memory.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test fails by panicking")]

mod bindings;
mod changes;
mod controllers;
mod decks;
mod editor;
mod feedback;
mod lists;
mod live;
mod moving_textures;
mod panels;
mod playlist;
mod programs;
mod quality;
mod recording;
mod refinement;
mod remote;
mod scenes;
mod sends;
mod settings;
mod shaders;
mod shows;
mod snapshots;
mod song;
mod songs;
mod stage;
mod stems;
mod surprises;
mod videos;
mod views;
mod walls;

#[path = "../support/mod.rs"]
mod support;
