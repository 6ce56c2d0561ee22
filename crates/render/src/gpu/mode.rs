//! The two modes of drawing a scene: interpreted and compiled.

/// The way in which a scene's expressions are executed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Mode {
    /// Interpreted from the tape in a texture buffer.
    Interpreted,
    /// Compiled as GLSL generated for the scene.
    Compiled,
}

impl std::fmt::Display for Mode {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Mode::Interpreted => "interpreted",
            Mode::Compiled => "compiled",
        })
    }
}
