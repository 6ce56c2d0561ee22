//! Interpreted or compiled.

/// How a scene's expressions are run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Mode {
    /// From the tape in a texture buffer.
    Interpreted,
    /// As GLSL generated for the scene.
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
