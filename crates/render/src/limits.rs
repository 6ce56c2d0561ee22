//! Every limit of the renderer.
//!
//! A limit is data: code that applies one reads it here, an error that reports one gives the number defined here, and
//! a test reaches it.

/// Limits on what comes from outside and on what the renderer allocates for it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Largest shader source after its includes were resolved, in bytes.
    pub shader_bytes_max: usize,
    /// Most texels of a frame's regions (4 Mi: 64 MiB); cells beyond that use the whole tape.
    pub region_texels_max: usize,
    /// Most fonts of the system that are taken for letters that the program's own fonts lack.
    pub system_fonts_max: usize,
    /// Most bytes that they have together (128 MiB: one of all Chinese letters has some 20 MiB).
    pub system_fonts_bytes_max: u64,
    /// Time in seconds after which it is told that a driver is still compiling.
    pub compile_seconds_reported: f64,
}

/// The limits in force.
pub const LIMITS: Limits = Limits {
    shader_bytes_max: 1 << 20,
    region_texels_max: 1 << 22,
    system_fonts_max: 12,
    system_fonts_bytes_max: 1 << 27,
    compile_seconds_reported: 20.0,
};
