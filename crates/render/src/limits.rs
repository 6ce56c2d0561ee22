//! The renderer's limits. Code, error messages and tests all read them from [`LIMITS`].

/// Limits on input from outside and on the memory that the renderer allocates for it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Largest shader source in bytes, with all includes resolved.
    pub shader_bytes_max: usize,
    /// Maximum number of texels of a frame's regions (4 Mi texels take 64 MiB). Cells beyond them use the whole tape.
    pub region_texels_max: usize,
    /// Maximum number of system fonts that are loaded for letters missing in the program's own fonts.
    pub system_fonts_max: usize,
    /// Maximum total size of these fonts in bytes (128 MiB; a font with all Chinese letters takes about 20 MiB).
    pub system_fonts_bytes_max: u64,
    /// Time in seconds after which a compilation is reported as slow.
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
