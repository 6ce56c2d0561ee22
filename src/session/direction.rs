//! Creates the show of the current track on a separate thread, and creates it again when the show's file changes.

use std::io;
use std::path::Path;
use std::sync::{Arc, Mutex};

use crate::config::FollowChoice;
use crate::scenes::{Loader, SceneSource};
use crate::show::{PreparedShow, ShowError, ShowSource, name_of};
use mariana_music::SongStructure;
use mariana_work::lock;

/// Id of the playing track; `None` for an input.
pub(crate) type OfTrack = Option<u64>;

/// Another show, or none, or the mistakes of the show file as a text.
pub(crate) type OtherShow = Result<Option<Arc<PreparedShow>>, String>;

#[derive(Clone, Default)]
struct Asked {
    source: ShowSource,
    track: OfTrack,
    song: Arc<SongStructure>,
    scenes: Vec<SceneSource>,
    /// Names of the scenes that earlier tracks have shown.
    recent: Vec<String>,
}

struct Made {
    track: OfTrack,
    show: Result<(PreparedShow, Option<String>), ShowError>,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) enum Playing {
    #[default]
    Input,
    Song,
    Demo,
}

/// How many scenes the director remembers.
const REMEMBERED: usize = 100;

pub(crate) struct Direction {
    loader: Loader<Made>,
    asked: Arc<Mutex<Asked>>,
    named: Option<ShowSource>,
    follow: FollowChoice,
    /// True if the command line names a scene, which then stays.
    names_scene: bool,
    of: Option<(ShowSource, OfTrack)>,
    /// The scenes of this run, at most [`REMEMBERED`], the current one at the end.
    seen: Vec<SceneSource>,
    /// The last track that has asked for a show, and the scenes before it.
    before: (OfTrack, Vec<String>),
}

impl Direction {
    pub(crate) fn start(
        named: Option<ShowSource>,
        follow: FollowChoice,
        names_scene: bool,
        wake: impl Fn() + Send + 'static,
    ) -> io::Result<Self> {
        let asked = Arc::new(Mutex::new(Asked::default()));
        let of_thread = asked.clone();
        let load = move |watched: &SceneSource| {
            let Asked { source, track, song, scenes, recent } = lock(&of_thread).clone();
            let show = match source {
                ShowSource::Auto => PreparedShow::directed(&song, &scenes, &recent).map(|show| (show, None)),
                named => PreparedShow::of_song(&named, &song, &scenes),
            };
            (Made { track, show }, watched.file().map(Path::to_owned).into_iter().collect())
        };
        let loader = Loader::start(load, wake)?;
        Ok(Self {
            loader,
            asked,
            named,
            follow,
            names_scene,
            of: None,
            seen: Vec::new(),
            before: (None, Vec::new()),
        })
    }

    pub(crate) fn set_follow(&mut self, follow: FollowChoice) {
        self.follow = follow;
        self.names_scene = false;
    }

    pub(crate) fn follows(&self, playing: Playing) -> bool {
        self.source(playing).is_some()
    }

    /// Returns the show of what plays, even if scenes do not follow it now.
    pub(crate) fn show_of(&self, playing: Playing) -> ShowSource {
        self.named.clone().unwrap_or(match playing {
            Playing::Demo => ShowSource::Demo,
            Playing::Song | Playing::Input => ShowSource::Auto,
        })
    }

    fn source(&self, playing: Playing) -> Option<ShowSource> {
        let auto = match self.follow {
            FollowChoice::Off => return None,
            FollowChoice::Songs => playing != Playing::Input && !self.names_scene,
            FollowChoice::On => true,
        };
        (self.named.is_some() || auto).then(|| self.show_of(playing))
    }

    /// Updates the track and its song structure. The director chooses among `scenes`, preferably scenes that were not
    /// shown lately. `current` is the scene now. Returns the show if it is another one.
    pub(crate) fn update(
        &mut self,
        track: OfTrack,
        playing: Playing,
        song: Option<Arc<SongStructure>>,
        current: &SceneSource,
        scenes: impl FnOnce() -> Vec<SceneSource>,
    ) -> Option<OtherShow> {
        if self.seen.last() != Some(current) {
            let surplus = (self.seen.len() + 1).saturating_sub(REMEMBERED);
            self.seen.drain(..surplus);
            self.seen.push(current.clone());
        }
        let wanted = self.source(playing).map(|source| (source, track));
        if self.of != wanted {
            let Some((source, track)) = wanted else {
                self.of = None;
                return Some(Ok(None));
            };
            if let Some(song) = song {
                // A track whose show is made once more gets the same show.
                if self.before.0 != track {
                    self.before = (track, self.seen.iter().map(name_of).collect());
                }
                let (recent, scenes) = (self.before.1.clone(), scenes());
                // The loader watches the file of a show.
                let watched = match &source {
                    ShowSource::File(path) => SceneSource::File(path.clone()),
                    ShowSource::Demo | ShowSource::Auto => SceneSource::Formula(String::new()),
                };
                *lock(&self.asked) = Asked { source: source.clone(), track, song, scenes, recent };
                self.of = Some((source, track));
                self.loader.request(watched);
            } else if self.of.take().is_some() {
                // End the previous track's show. The current scene stays until the new track is analysed.
                return Some(Ok(None));
            }
        }
        let made = self.loader.poll()?.value;
        if self.of.as_ref().is_none_or(|(_, track)| *track != made.track) {
            return None;
        }
        match made.show {
            Ok((prepared_show, left_out)) => {
                if let Some(text) = left_out {
                    tracing::warn!("parts of the show do not fit the song\n{}", text.trim_end());
                }
                // Ignore the first song's show if it has one clip: without sections in the song, the director has no
                // reason to change scenes.
                let is_first = self.before.1.len() < 2;
                let says_something = made.track.is_none()
                    || self.named.is_some()
                    || prepared_show.clips().len() > 1
                    || !is_first;
                says_something.then(|| Ok(Some(Arc::new(prepared_show))))
            }
            // No scene can be used. Report nothing here: the loader reports each broken scene.
            Err(ShowError::NoScenes) => Some(Ok(None)),
            Err(error) => {
                tracing::warn!("{error}");
                Some(Err(error.to_string()))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn songs_are_followed_by_default_and_inputs_on_request() {
        let of = |follow, names_scene| Direction::start(None, follow, names_scene, || {}).unwrap();
        let untouched = of(FollowChoice::default(), false);
        assert!(untouched.follows(Playing::Song) && untouched.follows(Playing::Demo));
        assert!(!untouched.follows(Playing::Input), "inputs are followed on request");
        let mut named = of(FollowChoice::default(), true);
        assert!(!named.follows(Playing::Song), "a scene named on the command line is kept");
        named.set_follow(FollowChoice::Songs);
        assert!(named.follows(Playing::Song), "A was pressed");
        assert!(!of(FollowChoice::Off, false).follows(Playing::Song));
        assert!(of(FollowChoice::On, true).follows(Playing::Input));
    }
}
