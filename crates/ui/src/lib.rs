//! The words and panels over the picture: they take plain state and the input of users, and give shapes and commands.

pub mod clipboard;
pub mod clock;
pub mod controllers_panel;
pub mod corner_hands;
pub mod desk_picture;
pub mod editor;
pub mod file_browser;
pub mod limits;
pub mod monitor;
pub mod overlay;
pub mod pointer;
pub mod pointer_rest;
pub mod scene_browser;
pub mod settings_panel;
pub mod text_query;
pub mod user_input;

use mariana_render::gpu::error::GpuError;

/// The driver cannot draw the panels.
#[derive(Debug, thiserror::Error)]
pub enum UiError {
    /// The shaders or buffers of the panels are refused.
    #[error("the driver cannot draw text over the picture ({0}): update the graphics driver")]
    Painter(String),
    /// Anything else that the driver refuses.
    #[error(transparent)]
    Gpu(#[from] GpuError),
}
