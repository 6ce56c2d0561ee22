//! Errors of exports: stills, videos, analyses and measurements.

use crate::atomic_file::Unwritable;
use crate::gpu::error::GpuError;
use crate::scenes::SceneError;
use crate::show::ShowError;
use mariana_field::world::{BlendError, MeshError};
use mariana_player::decode::DecodeError;

/// An error of an export.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The song cannot be decoded.
    #[error(transparent)]
    Decode(#[from] DecodeError),
    /// The frame cannot be drawn.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The scene cannot be read or has mistakes.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// Two scenes cannot be blended.
    #[error(transparent)]
    Blend(#[from] BlendError),
    /// The scene has no mesh.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The image encoder reported an error.
    #[error("the image could not be encoded: {0}")]
    Encode(#[from] image::ImageError),
    /// The show cannot be prepared.
    #[error(transparent)]
    Show(#[from] ShowError),
    /// Standard output is closed or full.
    #[error("the results cannot be printed ({0}): send them to another file or program")]
    Print(std::io::Error),
    /// Another obstacle, with the remedy.
    #[error("{0}")]
    Refused(String),
}

/// Refuses an export, for this reason.
pub(super) fn refuse<T>(reason: impl Into<String>) -> Result<T, ExportError> {
    Err(ExportError::Refused(reason.into()))
}

impl From<Unwritable> for ExportError {
    fn from(Unwritable { path, reason, .. }: Unwritable) -> Self {
        let path = path.display();
        Self::Refused(format!(
            "{path} cannot be written ({reason}): choose another path with -o; no file was changed"
        ))
    }
}
