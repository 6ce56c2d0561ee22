//! Errors of track lists. Each message is one sentence: what happened, where, and what to do.

use std::path::Path;

/// An error that prevents playback of a list or a part of one.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct PlaylistError(pub(super) String);

impl PlaylistError {
    pub(super) fn empty(name: &str) -> Self {
        Self(format!("{name} holds no tracks; choose files, or a folder or list with tracks"))
    }

    pub(super) fn too_many(what: &str, limit: usize) -> Self {
        Self(format!("there are more than {limit} {what}, so the rest was left out; open fewer at once"))
    }
}

pub(super) fn name_of(path: &Path) -> String {
    let name = path.file_name().unwrap_or(path.as_os_str());
    crate::one_line::one_line(&name.to_string_lossy())
}
