//! What is shown along a song: scenes at given moments, or a show.

use std::sync::Arc;

use super::error::ExportError;
use super::song_features::SongFeatures;
use crate::scenes::SceneSource;
use crate::show::{Programme, ShowSource};

/// See the module.
#[derive(Debug, Clone)]
pub enum Showing {
    /// Scenes, each from a moment on, in seconds of the song.
    Scenes(Vec<(f64, SceneSource)>),
    /// A show: where it comes from, and the scenes among which the director chooses.
    Show(ShowSource, Vec<SceneSource>),
}

impl Showing {
    /// What is on when along a song, from `start` seconds on. For a show all of the song is decoded. What of a show file
    /// does not fit the song is logged.
    ///
    /// # Errors
    /// The song or the show is refused, or no scene is on at the start.
    pub(super) fn programme(
        &self,
        song: &mut SongFeatures,
        start: f64,
    ) -> Result<Arc<Programme>, ExportError> {
        let programme = match self {
            Self::Scenes(scenes) => {
                let first = scenes.iter().map(|(from, _)| *from).fold(f64::INFINITY, f64::min);
                if first > start {
                    return Err(ExportError::NothingAtFirst { from: first, start });
                }
                Programme::of_cuts(scenes.iter().cloned())
            }
            Self::Show(source, scenes) => {
                let (programme, left_out) = Programme::of_song(source, song.structure(), scenes)?;
                if let Some(left_out) = left_out {
                    tracing::warn!("parts of the show do not fit the song:\n{left_out}");
                }
                if let cues @ 1.. = programme.cues().len() {
                    tracing::warn!(
                        "{cues} entries of the show wait for a key (`at cue`) and do not come: only a window has keys"
                    );
                }
                programme
            }
        };
        Ok(Arc::new(programme))
    }
}
