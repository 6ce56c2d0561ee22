//! The limits on scene files. Code, error messages and tests read them from here.

/// Limits on files that scenes use, and on thumbnails.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Maximum size of a texture file, in bytes.
    pub texture_bytes_max: usize,
    /// Maximum width and height of a texture, in texels.
    pub texture_side_max: u32,
    /// Maximum number of texels in a texture. 16 Mi texels need 64 MiB, and a third more with mip levels.
    pub texture_pixels_max: u64,
    /// Maximum size of a font's file, in bytes.
    pub font_bytes_max: usize,
    /// Maximum number of letters that a text of the song shows.
    pub song_letters_max: usize,
    /// Maximum time for drawing a thumbnail, in seconds.
    pub thumbnail_seconds_max: f64,
    /// Maximum number of thumbnails in the cache, of about 60 KiB each. The oldest thumbnails are deleted first.
    pub thumbnails_kept_max: usize,
}

/// The limits in force.
pub const LIMITS: Limits = Limits {
    texture_bytes_max: 1 << 25,
    texture_side_max: 8_192,
    texture_pixels_max: 1 << 24,
    font_bytes_max: 1 << 26,
    song_letters_max: 200,
    thumbnail_seconds_max: 60.0,
    thumbnails_kept_max: 2_000,
};
