//! Makes the show of the track that plays, on a thread of its own, and makes it again when its file changes.

use std::io;
use std::sync::{Arc, Mutex, PoisonError};

use crate::config::FollowChoice;
use crate::scenes::{Loader, SceneSource};
use crate::show::{PreparedShow, ShowError, ShowSource};
use mariana_music::SongStructure;

/// The number of the track that plays; none for an input.
pub(crate) type OfTrack = Option<u64>;

/// What there is to say of a show.
pub(crate) enum ShowNotice {
    /// This is the show now, or there is none.
    PreparedShow(Option<Arc<PreparedShow>>),
    /// Parts of a show file do not fit the song, or the file has mistakes: what was on goes on.
    Problem {
        /// What is wrong, in a line.
        heading: String,
        /// Where, and what to do.
        text: String,
    },
}

/// What a show is made for.
#[derive(Default)]
struct Asked {
    track: OfTrack,
    song: Arc<SongStructure>,
    scenes: Vec<SceneSource>,
}

/// A show that was made for a track; and what of it does not fit the song.
struct Made {
    track: OfTrack,
    show: Result<(PreparedShow, Option<String>), ShowError>,
}

/// The source of the sound.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) enum Playing {
    /// An input. Before the first song also nothing.
    #[default]
    Input,
    /// A song of the user.
    Song,
    /// The built-in demo track.
    Demo,
}

/// See the module.
pub(crate) struct Direction {
    loader: Loader<Made>,
    asked: Arc<Mutex<Asked>>,
    /// A show that the command line names.
    named: Option<ShowSource>,
    follow: FollowChoice,
    /// Whether the command line names a scene, which then stays.
    names_scene: bool,
    /// What was asked for last, and for which track.
    of: Option<(ShowSource, OfTrack)>,
}

impl Direction {
    /// Starts the thread, which calls `wake` for each show.
    ///
    /// # Errors
    /// What the system says about threads.
    pub(crate) fn start(
        named: Option<ShowSource>,
        follow: FollowChoice,
        names_scene: bool,
        wake: impl Fn() + Send + 'static,
    ) -> io::Result<Self> {
        let asked = Arc::new(Mutex::new(Asked::default()));
        let of_thread = asked.clone();
        let load = move |source: &SceneSource| {
            let (track, song, scenes) = {
                let asked = of_thread.lock().unwrap_or_else(PoisonError::into_inner);
                (asked.track, asked.song.clone(), asked.scenes.clone())
            };
            let (show, files) = match source {
                SceneSource::File(path) => (ShowSource::File(path.clone()), vec![path.clone()]),
                SceneSource::Shipped(_) => (ShowSource::Demo, Vec::new()),
                _ => (ShowSource::Auto, Vec::new()),
            };
            (Made { track, show: PreparedShow::of_song(&show, &song, &scenes) }, files)
        };
        let loader = Loader::start(load, wake)?;
        Ok(Self { loader, asked, named, follow, names_scene, of: None })
    }

    /// Lets the show follow the song as it is chosen from now on.
    pub(crate) fn set_follow(&mut self, follow: FollowChoice) {
        self.follow = follow;
        self.names_scene = false;
    }

    /// True if scenes follow this source.
    pub(crate) fn follows(&self, playing: Playing) -> bool {
        self.source(playing).is_some()
    }

    fn source(&self, playing: Playing) -> Option<ShowSource> {
        let auto = match self.follow {
            FollowChoice::Off => return None,
            FollowChoice::Songs => playing != Playing::Input && !self.names_scene,
            FollowChoice::On => true,
        };
        match &self.named {
            Some(named) => Some(named.clone()),
            None => auto.then_some(match playing {
                Playing::Demo => ShowSource::Demo,
                Playing::Song | Playing::Input => ShowSource::Auto,
            }),
        }
    }

    /// Takes note of what plays, and what is known of it. `scenes` are those among which the director chooses.
    pub(crate) fn update(
        &mut self,
        track: OfTrack,
        playing: Playing,
        song: Option<Arc<SongStructure>>,
        scenes: impl FnOnce() -> Vec<SceneSource>,
    ) -> Option<ShowNotice> {
        let wanted = self.source(playing).map(|source| (source, track));
        let is_the_same = self.of == wanted;
        match wanted {
            None if is_the_same => return None,
            None => {
                self.of = None;
                return Some(ShowNotice::PreparedShow(None));
            }
            Some((source, track)) if !is_the_same => {
                let key = match &source {
                    ShowSource::File(path) => SceneSource::File(path.clone()),
                    ShowSource::Demo => SceneSource::Shipped(String::new()),
                    ShowSource::Auto => SceneSource::Formula(String::new()),
                };
                if let Some(song) = song {
                    let asked = Asked { track, song, scenes: scenes() };
                    *self.asked.lock().unwrap_or_else(PoisonError::into_inner) = asked;
                    self.of = Some((source, track));
                    self.loader.request(key);
                } else if self.of.take().is_some() {
                    // The show of the last track is over; what is on stays until this one is known.
                    return Some(ShowNotice::PreparedShow(None));
                }
            }
            Some(_) => {}
        }
        let made = self.loader.poll()?.value;
        if self.of.as_ref().is_none_or(|(_, track)| *track != made.track) {
            return None;
        }
        match made.show {
            Ok((prepared_show, None)) => {
                // In a song without sections the director has no reason to change the scene.
                let is_live = made.track.is_none();
                let says_something = is_live || self.named.is_some() || prepared_show.clips().len() > 1;
                says_something.then(|| ShowNotice::PreparedShow(Some(Arc::new(prepared_show))))
            }
            Ok((prepared_show, Some(text))) => {
                tracing::warn!("parts of the show do not fit the song:\n{text}");
                Some(ShowNotice::PreparedShow(Some(Arc::new(prepared_show))))
            }
            // Each broken scene is reported where it is loaded.
            Err(ShowError::NoScenes) => Some(ShowNotice::PreparedShow(None)),
            Err(error) => {
                tracing::warn!("{error}");
                Some(ShowNotice::Problem {
                    heading: "the show has mistakes; what was on goes on".to_owned(),
                    text: error.to_string(),
                })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_single_song_had_no_show() {
        let of = |follow, names_scene| Direction::start(None, follow, names_scene, || {}).unwrap();
        let untouched = of(FollowChoice::default(), false);
        assert!(untouched.follows(Playing::Song) && untouched.follows(Playing::Demo));
        assert!(!untouched.follows(Playing::Input), "inputs are followed on request");
        let mut named = of(FollowChoice::default(), true);
        assert!(!named.follows(Playing::Song), "the scene that was named is kept");
        named.set_follow(FollowChoice::Songs);
        assert!(named.follows(Playing::Song), "A was pressed");
        assert!(!of(FollowChoice::Off, false).follows(Playing::Song));
        assert!(of(FollowChoice::On, true).follows(Playing::Input));
    }
}
