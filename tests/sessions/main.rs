//! The program as its users meet it, without a window: sessions that draw into memory.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test fails by panicking")]

mod stage;
mod walls;

#[path = "../support/mod.rs"]
mod support;
