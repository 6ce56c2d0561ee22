//! What is shown along a song: scenes at given moments, or a show.

use std::sync::Arc;

use super::error::ExportError;
use super::show_painter::ShowPainter;
use super::song_features::SongFeatures;
use crate::scenes::SceneSource;
use crate::show::{Held, PreparedShow, ShowSource};
use mariana_music::{Gain, Sound};

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
    pub(super) fn prepared_show(
        &self,
        song: &mut SongFeatures,
        start: f64,
    ) -> Result<Arc<PreparedShow>, ExportError> {
        let prepared_show = match self {
            Self::Scenes(scenes) => {
                let first = scenes.iter().map(|(from, _)| *from).fold(f64::INFINITY, f64::min);
                if first > start {
                    return Err(ExportError::NothingAtFirst { from: first, start });
                }
                PreparedShow::of_cuts(scenes.iter().cloned())
            }
            Self::Show(source, scenes) => {
                let (prepared_show, left_out) = PreparedShow::of_song(source, song.structure(), scenes)?;
                if let Some(left_out) = left_out {
                    tracing::warn!("parts of the show do not fit the song:\n{left_out}");
                }
                if let cues @ 1.. = prepared_show.cues().len() {
                    tracing::warn!(
                        "{cues} entries of the show wait for a key (`at cue`) and do not come: only a window has keys"
                    );
                }
                prepared_show
            }
        };
        Ok(Arc::new(prepared_show))
    }
}

/// How far back a song that is decoded can be asked, in seconds.
const KEPT: f64 = 1.0;

/// What the picture sounded like that a show holds.
pub(super) struct Holding {
    /// Whether quiet and loud sound move the picture alike.
    gain: Gain,
    /// The moment from which on the song was opened, in seconds.
    opened: f64,
    last: Vec<(Held, Sound)>,
}

impl Holding {
    /// Nothing was held so far of a song that was opened for times from `opened` seconds on.
    pub(super) fn new(gain: Gain, opened: f64) -> Self {
        Self { gain, opened, last: Vec::new() }
    }

    /// What `painter` holds at `time` seconds, as [`ShowPainter::held_at`] has it, and what that sounded like. Times must
    /// not step back.
    ///
    /// # Errors
    /// The song is refused.
    pub(super) fn at(
        &mut self,
        painter: &ShowPainter,
        song: &mut SongFeatures,
        time: f64,
    ) -> Result<Vec<(Held, Sound)>, ExportError> {
        let mut all = Vec::new();
        for held in painter.held_at(time) {
            let known = self.last.iter().find(|(known, _)| known.since == held.since);
            let sound = match known {
                Some((_, sound)) => sound.clone(),
                // What was analysed lately is still there.
                None if held.since >= self.opened && time - held.since <= KEPT => song.require(held.since)?,
                None => song.beside(held.since, self.gain)?.require(held.since)?,
            };
            all.push((held, sound));
        }
        self.last.clone_from(&all);
        Ok(all)
    }
}
