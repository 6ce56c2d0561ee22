//! Errors of loading a scene. Mistakes in a scene's text are diagnostics of [`mariana_field::lang`].

use std::path::PathBuf;

use mariana_field::lang::{Diagnostic, Sources, render_all};
use mariana_field::world::{BlendError, WorldError};
use mariana_files::reading::TextError;

/// Mistakes, or warnings, together with the texts that contain them.
#[derive(Debug, Default)]
pub struct FoundMistakes {
    /// The diagnostics.
    pub diagnostics: Vec<Diagnostic>,
    /// The texts of all files.
    pub sources: Sources,
}

impl FoundMistakes {
    /// Returns all diagnostics as text, with terminal colours if `color` is set.
    pub fn render(&self, color: bool) -> String {
        render_all(&self.diagnostics, &self.sources, color)
    }
}

/// The error when a scene cannot be loaded. Each message names the problem, its position and a remedy.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// The word is not a scene's name.
    #[error(
        "there is no scene '{name}': give a file, a formula such as \"length(p) - 1\", or one of: {shipped}"
    )]
    Unknown {
        /// The word.
        name: String,
        /// The shipped scenes.
        shipped: String,
    },
    /// An earlier run died while it loaded the scene.
    #[error(
        "Mariana ended while it loaded this scene the last time; choose the scene again to try it once more"
    )]
    EndedTheProgram,
    /// The file is a shader.
    #[error("{} is a shader, not a scene: write a scene around it with `mariana import {}`", .0.display(), .0.display())]
    Shader(PathBuf),
    /// The file is not a readable text.
    #[error("the scene {} {problem}", .path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The reason.
        problem: TextError,
    },
    /// The text has mistakes.
    #[error("{name} has mistakes: correct what is underlined\n{}", .found.render(false).trim_end())]
    Mistakes {
        /// The scene.
        name: String,
        /// All diagnostics.
        found: Box<FoundMistakes>,
    },
    /// The scene is too large to be drawn.
    #[error(transparent)]
    World(#[from] WorldError),
    /// Two scenes are too large together.
    #[error(transparent)]
    Blend(#[from] BlendError),
}
