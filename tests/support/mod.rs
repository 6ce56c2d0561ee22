//! What several tests share: shader folders, the tools that check shaders, a renderer without a window, the
//! comparison of pictures, a desktop and a sound server of the test's own.

#![allow(dead_code, reason = "every test program uses its own part of this")]

pub mod compare;
#[cfg(target_os = "linux")]
pub mod desktop;
pub mod glsl;
#[cfg(unix)]
pub mod process;
pub mod shader_folder;
#[cfg(unix)]
pub mod sound_server;
pub mod studio;
pub mod wave;
