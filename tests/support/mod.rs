//! What several tests share: shader folders, the tools that check shaders, a renderer without a window, the
//! comparison of pictures, a desktop and a sound server of the test's own.

#![allow(dead_code, reason = "every test program uses its own part of this")]
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test fails by panicking")]

pub mod compare;
#[cfg(target_os = "linux")]
pub mod desktop;
#[path = "../../crates/field/tests/field/expression.rs"]
pub mod expression;
pub mod glsl;
pub mod oracle;
#[cfg(target_os = "linux")]
pub mod pings;
#[cfg(target_os = "linux")]
pub mod program;
pub mod shader_folder;
pub mod studio;
