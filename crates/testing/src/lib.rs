//! Helpers for tests of several packages: child processes, a sound server, a session bus, WAVE files, shaders and
//! data from the thesis. This crate does not depend on the project's other crates, so it is rarely rebuilt.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test fails by panicking")]

pub mod probe;
#[cfg(unix)]
pub mod process;
#[cfg(unix)]
pub mod screen_reader;
#[cfg(unix)]
pub mod session_bus;
#[cfg(unix)]
pub mod sound_server;
#[cfg(unix)]
pub mod sound_session;
pub mod thesis;
pub mod tiny_font;
pub mod wave;
