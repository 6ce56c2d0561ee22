//! What the tests of several packages share: programs that end with the test, a sound server and a session bus of a test's
//! own, files of sound, what the thesis prints. No crate of the project stands below this one, so that no change of theirs builds it again.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test fails by panicking")]

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
