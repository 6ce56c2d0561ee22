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
    /// Maximum size of a drawing (SVG), in bytes, and of the text to which its entities expand.
    pub drawing_bytes_max: usize,
    /// Maximum number of elements in a drawing's text.
    pub drawing_elements_max: usize,
    /// Maximum nesting of elements and uses in a drawing.
    pub drawing_nesting_max: usize,
    /// Maximum number of elements that are visited after uses are expanded, and of bytes of their properties.
    pub drawing_visits_max: (usize, usize),
    /// Maximum number of painted shapes of a drawing, and of parts of all their paths.
    pub drawing_shapes_max: (usize, usize),
    /// How often shapes may cover a whole drawing, or letters a whole text.
    pub layers_max: usize,
    /// Largest number in a drawing's text. Numbers of paths must be smaller; others are clamped.
    pub drawing_number_max: f64,
    /// Largest coordinate of a shape, in units of the drawing. Farther places have too few digits to tell pixels apart.
    pub drawing_reach_max: f64,
    /// Maximum size of a font's file, in bytes.
    pub font_bytes_max: usize,
    /// Maximum number of glyphs of which a glyph is composed. Glyphs with more are left out.
    pub glyph_parts_max: usize,
    /// Maximum number of bytes of a glyph's program and of all subroutines that it calls.
    pub glyph_program_bytes_max: usize,
    /// Maximum number of parts of a text's outline.
    pub text_parts_max: usize,
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
    drawing_bytes_max: 1 << 22,
    drawing_elements_max: 100_000,
    drawing_nesting_max: 64,
    drawing_visits_max: (50_000, 1 << 24),
    drawing_shapes_max: (10_000, 1 << 19),
    layers_max: 64,
    drawing_number_max: 1e9,
    drawing_reach_max: 1e15,
    font_bytes_max: 1 << 26,
    glyph_parts_max: 1_000,
    glyph_program_bytes_max: 1 << 18,
    text_parts_max: 1 << 18,
    song_letters_max: 200,
    thumbnail_seconds_max: 60.0,
    thumbnails_kept_max: 2_000,
};
