//! The two interfaces of OpenGL that Mariana draws with, and contexts for them.
//!
//! OpenGL ES 3.0 is for devices whose drivers have no OpenGL 3.3, such as the Raspberry Pi. It differs in the header of
//! the shaders ([`super::shader_source`]) and in the lists that shaders read ([`super::texel_list`]). It has no timers
//! that Mariana uses, and reads fewer formats back ([`super::target`]).

#[cfg(not(target_family = "wasm"))]
mod contexts;

use serde::Serialize;

/// An interface of OpenGL.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Api {
    /// OpenGL 3.3 core or newer.
    Desktop,
    /// OpenGL ES 3.0 or newer.
    Embedded,
}

impl std::fmt::Display for Api {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Desktop => "OpenGL",
            Self::Embedded => "OpenGL ES",
        })
    }
}
