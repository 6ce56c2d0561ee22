//! The program as its users meet it, without a window: sessions that draw into memory.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test fails by panicking")]

mod editor;
mod hands;
mod live;
mod panels;
mod playlist;
mod recording;
mod remote;
mod sends;
mod settings;
mod shows;
mod song;
mod songs;
mod stage;
mod walls;

#[path = "../support/mod.rs"]
mod support;
