//! Helpers of the integration tests: shader folders, shader checkers, a headless renderer, image comparison, and
//! private desktops, browsers and sessions.

#![allow(dead_code, unused_macros, unused_imports, reason = "every test program uses its own part of this")]
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test fails by panicking")]

pub(crate) mod apart;
#[cfg(target_os = "linux")]
pub(crate) mod browser;
pub(crate) mod compare;
#[cfg(target_os = "linux")]
pub(crate) mod desktop;
#[path = "../../crates/field/tests/field/expression.rs"]
pub(crate) mod expression;
pub(crate) mod glsl;
pub(crate) mod offscreen;
pub(crate) mod oracle;
pub(crate) mod osc;
#[cfg(target_os = "linux")]
pub(crate) mod pings;
#[cfg(target_os = "linux")]
pub(crate) mod program;
pub(crate) mod session;
pub(crate) mod shader_folder;
pub(crate) mod test_renderer;
pub(crate) mod video_stream;
pub(crate) mod walls;
#[cfg(target_os = "linux")]
pub(crate) mod wayland;
pub(crate) mod wood;
