//! The state of the last show, for the next start. The track list is a separate M3U8 file next to the settings, which
//! other players can read.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::stored_file::{SETTINGS, StoredFileError};

/// The state of the last show. A missing field has its default value.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LastShow {
    /// The volume, 0..1.
    pub volume: Option<f32>,
    /// The window's width and height in pixels.
    pub size: Option<(u32, u32)>,
    /// The window's position on the desktop, frame included, in pixels to the right and down.
    pub place: Option<(i32, i32)>,
    /// True if the window was in full screen.
    pub fullscreen: bool,
    /// The scene: the name of a shipped scene, or the absolute path of a file.
    pub scene: Option<String>,
    /// The index of the track in the list, from 0.
    pub track: usize,
    /// The position in the track, in seconds.
    pub seconds: f64,
    /// True if the tracks played in random order.
    pub shuffled: bool,
    /// The repeat mode: all, one or off.
    pub repeat: Option<String>,
}

pub(super) fn tracks_file(settings: &Path) -> PathBuf {
    settings.with_file_name("last tracks.m3u8")
}

/// Writes the track list next to the settings file `settings`. Removes the old list if there are no `tracks`, or if a
/// path does not fit into M3U8 because the path contains a line break or is not valid UTF-8.
pub(super) fn keep_tracks(settings: &Path, tracks: Option<&[PathBuf]>) -> Result<(), StoredFileError> {
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
                Err(SETTINGS.refused(&file, "removed", &error))
            }
            _ => Ok(()),
        };
    };
    let text = format!("#EXTM3U\n{}\n", lines.join("\n"));
    SETTINGS.write(&file, &text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tracks_are_kept_as_a_list_or_the_list_is_removed() {
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
