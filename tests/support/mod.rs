//! What several tests share: shader folders, the tools that check shaders, a renderer without a window, the
//! comparison of pictures, a desktop and a sound server of the test's own.

#![allow(dead_code, reason = "every test program uses its own part of this")]
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test fails by panicking")]

pub mod compare;
#[cfg(target_os = "linux")]
pub mod desktop;
pub mod expression;
pub mod glsl;
pub mod oracle;
#[cfg(target_os = "linux")]
pub mod pings;
#[cfg(unix)]
pub mod process;
#[cfg(target_os = "linux")]
pub mod program;
#[cfg(unix)]
pub mod session_bus;
pub mod shader_folder;
#[cfg(unix)]
pub mod sound_server;
#[cfg(unix)]
pub mod sound_session;
pub mod studio;
pub mod wave;
