//! The limits on scene files. Code, error messages and tests read them from here.

/// Maximum size of a texture file, in bytes.
pub const TEXTURE_BYTES_MAX: usize = 1 << 25;
/// Maximum width and height of a texture, in texels.
pub const TEXTURE_SIDE_MAX: u32 = 8_192;
/// Maximum number of texels in a texture. 16 Mi texels need 64 MiB, and a third more with mip levels.
pub const TEXTURE_PIXELS_MAX: u64 = 1 << 24;
/// Maximum size of a drawing (SVG), in bytes, and of the text to which its entities expand.
pub const DRAWING_BYTES_MAX: usize = 1 << 22;
/// Maximum number of elements in a drawing's text.
pub const DRAWING_ELEMENTS_MAX: usize = 100_000;
/// Maximum nesting of elements and uses in a drawing.
pub const DRAWING_NESTING_MAX: usize = 64;
/// Maximum number of attributes of an element of a drawing, and of namespaces.
pub const DRAWING_ATTRIBUTES_MAX: usize = 1_000;
/// Maximum number of elements that are visited after uses are expanded, and of bytes of style sheets and properties for
/// all of them. An element's own properties count 64 times.
pub const DRAWING_VISITS_MAX: (usize, usize) = (50_000, 1 << 28);
/// Maximum number of painted shapes of a drawing, and of parts of all their paths.
pub const DRAWING_SHAPES_MAX: (usize, usize) = (10_000, 1 << 19);
/// How often shapes may cover a whole drawing, or letters a whole text.
pub const LAYERS_MAX: usize = 64;
/// Maximum number of digits before the point of a number in a drawing's text.
pub const DRAWING_NUMBER_DIGITS_MAX: usize = 9;
/// Largest coordinate of a shape, in units of the drawing. Farther places have too few digits to tell pixels apart.
pub const DRAWING_REACH_MAX: f64 = 1e15;
/// Maximum size of a font's file, in bytes.
pub const FONT_BYTES_MAX: usize = 1 << 26;
/// Maximum number of glyphs of which a glyph is composed. Glyphs with more are left out.
pub const GLYPH_PARTS_MAX: usize = 1_000;
/// Maximum number of bytes of a glyph's program and of all subroutines that it calls.
pub const GLYPH_PROGRAM_BYTES_MAX: usize = 1 << 18;
/// Maximum number of parts of a text's outline.
pub const TEXT_PARTS_MAX: usize = 1 << 18;
/// Maximum number of letters that a text of the song shows.
pub const SONG_LETTERS_MAX: usize = 200;
/// Maximum time for drawing a thumbnail, in seconds.
pub const THUMBNAIL_SECONDS_MAX: f64 = 60.0;
/// Maximum number of thumbnails in the cache, of about 60 KiB each. The oldest thumbnails are deleted first.
pub const THUMBNAILS_KEPT_MAX: usize = 2_000;
