//! The renderer's limits. Code, error messages and tests all read them from here.

/// Largest shader source in bytes, with all includes resolved.
pub const SHADER_BYTES_MAX: usize = 1 << 20;
/// Maximum number of texels of a frame's regions (4 Mi texels take 64 MiB). Cells beyond them use the whole tape.
pub const REGION_TEXELS_MAX: usize = 1 << 22;
/// Maximum number of system fonts that are loaded for letters missing in the program's own fonts.
pub const SYSTEM_FONTS_MAX: usize = 12;
/// Maximum total size of these fonts in bytes (128 MiB; a font with all Chinese letters takes about 20 MiB).
pub const SYSTEM_FONTS_BYTES_MAX: u64 = 1 << 27;
/// Time in seconds after which a compilation is reported as slow.
pub const COMPILE_SECONDS_REPORTED: f64 = 20.0;
