//! What several tests share: shader folders, the tools that check shaders, a renderer without a window, and the
//! comparison of pictures.

#![allow(dead_code, reason = "every test program uses its own part of this")]

pub mod compare;
pub mod glsl;
pub mod shader_folder;
pub mod studio;
