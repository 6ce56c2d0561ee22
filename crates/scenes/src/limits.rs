//! Every limit on scenes as files.
//!
//! Code, error messages and tests all read the limits from here.

/// Limits on what comes from outside and on what is kept for it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Most bytes of a texture's file.
    pub texture_bytes_max: usize,
    /// Largest width and height of a texture, in texels.
    pub texture_side_max: u32,
    /// Most texels of a texture (16 Mi: 64 MiB, and a third more with its mip levels).
    pub texture_pixels_max: u64,
    /// Longest time in seconds that drawing a small picture of a scene for the list may take.
    pub thumbnail_seconds_max: f64,
    /// Most small pictures that are kept from run to run (some 60 KiB each); the oldest go first.
    pub thumbnails_kept_max: usize,
}

/// The limits in force.
pub const LIMITS: Limits = Limits {
    texture_bytes_max: 1 << 25,
    texture_side_max: 8_192,
    texture_pixels_max: 1 << 24,
    thumbnail_seconds_max: 60.0,
    thumbnails_kept_max: 2_000,
};
