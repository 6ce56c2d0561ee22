//! What the last show leaves to the next: how it looked and sounded, and where its tracks had got to.
//!
//! The list of tracks is a file of its own beside the settings, in a format that every player reads.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::settings::{SettingsError, refused};
use mariana_files::atomic_file::AtomicFile;

/// See the module. Everything is optional: what is absent is as if there had been no show.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LastShow {
    /// Volume, 0..1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub volume: Option<f32>,
    /// Width and height of the window in pixels.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub size: Option<(u32, u32)>,
    /// Where on the desktop the window was, in pixels to the right and down, its frame included.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub place: Option<(i32, i32)>,
    /// Whether it filled the screen.
    pub fullscreen: bool,
    /// The scene: the name of a shipped one, or a file with its whole path.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scene: Option<String>,
    /// The place of the track in the list, from 0.
    pub track: usize,
    /// Where in the track the show ended, in seconds.
    pub seconds: f64,
    /// Whether the order of tracks was random.
    pub shuffled: bool,
    /// Which tracks were repeated: all, one or off.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub repeat: Option<String>,
}

/// The file with the tracks, beside the settings in `settings`.
pub(super) fn tracks_file(settings: &Path) -> PathBuf {
    settings.with_file_name("last tracks.m3u8")
}

/// Keeps a list of tracks beside the settings in `settings`; without tracks, or with one whose name cannot stand in a
/// list, the next show has none to go on with.
///
/// # Errors
/// The file cannot be written or removed.
pub(super) fn keep_tracks(settings: &Path, tracks: Option<&[PathBuf]>) -> Result<(), SettingsError> {
    let file = tracks_file(settings);
    let lines = tracks.filter(|tracks| !tracks.is_empty()).and_then(|tracks| {
        let line = |path: &PathBuf| {
            let line = std::path::absolute(path).ok()?.to_str()?.to_owned();
            (!line.contains(['\n', '\r'])).then_some(line)
        };
        tracks.iter().map(line).collect::<Option<Vec<_>>>()
    });
    let Some(lines) = lines else {
        return match std::fs::remove_file(&file) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
                Err(refused(&file, "removed", &error))
            }
            _ => Ok(()),
        };
    };
    let text = format!("#EXTM3U\n{}\n", lines.join("\n"));
    if let Some(folder) = file.parent() {
        std::fs::create_dir_all(folder).map_err(|error| refused(&file, "written", &error))?;
    }
    let written = AtomicFile::create(&file).and_then(|out| out.write(text.as_bytes()));
    written.map_err(|error| refused(&file, "written", &error.reason))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tracks_are_kept_as_a_list_and_let_go_where_they_cannot_be() {
        let folder = tempfile::tempdir().unwrap();
        let settings = folder.path().join("mariana/settings.toml");
        let kept = || std::fs::read_to_string(tracks_file(&settings)).ok();
        keep_tracks(&settings, Some(&["/music/a b.mp3".into(), "/music/ü.ogg".into()])).unwrap();
        assert_eq!(kept().as_deref(), Some("#EXTM3U\n/music/a b.mp3\n/music/ü.ogg\n"));
        for gone in [Some(&["/music/new\nline.mp3".into()][..]), None, None, Some(&[][..])] {
            keep_tracks(&settings, gone).unwrap();
            assert_eq!(kept(), None, "{gone:?}");
        }
    }
}
