//! The content of an export along the song: scenes with start times, or a show.

use std::sync::Arc;

use super::error::{ExportError, refuse};
use super::song_features::SongFeatures;
use crate::scenes::SceneSource;
use crate::show::{PreparedShow, ShowSource};

/// The scenes to export.
#[derive(Debug, Clone)]
pub enum Showing {
    /// Scenes with their start times, in seconds of the song.
    Scenes(Vec<(f64, SceneSource)>),
    /// A show: its source, and the scenes from which the director chooses.
    Show(ShowSource, Vec<SceneSource>),
}

impl Showing {
    /// Prepares the content from `start` seconds on. For a show, decodes the whole song and logs entries that do not
    /// fit the song.
    ///
    /// # Errors
    /// Fails if the song cannot be decoded, the show has mistakes, or no scene is shown at the start.
    pub(super) fn prepared_show(
        &self,
        song: &mut SongFeatures,
        start: f64,
    ) -> Result<Arc<PreparedShow>, ExportError> {
        let prepared_show = match self {
            Self::Scenes(scenes) => {
                let first = scenes.iter().map(|(from, _)| *from).fold(f64::INFINITY, f64::min);
                if first > start {
                    return refuse(format!(
                        "the video begins at {start} s, but its first scene begins at {first} s: give this scene an \
                         earlier time"
                    ));
                }
                PreparedShow::of_cuts(scenes.iter().cloned())
            }
            Self::Show(source, scenes) => {
                let (prepared_show, left_out) = PreparedShow::of_song(source, song.structure(), scenes)?;
                if let Some(left_out) = left_out {
                    tracing::warn!("parts of the show do not fit the song\n{}", left_out.trim_end());
                }
                if let cues @ 1.. = prepared_show.cues().len() {
                    tracing::warn!(
                        "the show waits {cues} times for a key (`at cue`); this is left out: only a window has keys"
                    );
                }
                prepared_show
            }
        };
        Ok(Arc::new(prepared_show))
    }
}
