//! The state saved for the next run: volume, window, scene, sliders, tracks and position. It is written soon after each
//! change, because a blocking driver can prevent a normal end of the program.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use super::{Playback, Session};
use crate::clock;
use crate::config::{Choice, LastShow, PlaySettings, Snapshot};
use crate::scenes::SceneSource;
use mariana_player::ListedTracks;

/// If a track has fewer seconds left than this, the next run starts it from the beginning.
const LEFT_MIN: f64 = 5.0;

const LOOK_PERIOD: Duration = Duration::from_secs(1);

/// Interval at which the position in the song is written without other changes.
const PLACE_PERIOD: Duration = Duration::from_secs(10);

#[derive(Default)]
pub(super) struct Legacy {
    looked: Option<Instant>,
    written: Option<(Left, Instant)>,
    /// The revision of the saved track list; `Some(None)` once the list was removed.
    tracks: Option<Option<u64>>,
}

#[derive(Clone, PartialEq)]
struct Left {
    show: LastShow,
    scene: String,
    moved: Snapshot,
}

impl Legacy {
    fn is_due(&mut self, now: Instant) -> bool {
        let is_due = self.looked.is_none_or(|looked| now.saturating_duration_since(looked) >= LOOK_PERIOD);
        if is_due {
            self.looked = Some(now);
        }
        is_due
    }

    /// Returns `true` if `left` must be written at `now`.
    fn takes(&mut self, left: &Left, now: Instant) -> bool {
        let is_new = self.written.as_ref().is_none_or(|(written, at)| {
            let mut known = written.clone();
            if now.saturating_duration_since(*at) < PLACE_PERIOD {
                known.show.seconds = left.show.seconds;
            }
            known != *left
        });
        if is_new {
            self.written = Some((left.clone(), now));
        }
        is_new
    }

    /// Returns `true` if the saved list must be changed to this `revision`; with `None`, if it must be removed.
    fn takes_tracks(&mut self, revision: Option<u64>) -> bool {
        self.tracks.replace(revision) != Some(revision)
    }
}

impl Session {
    pub(super) fn leave_to_the_next(&mut self, settings: &PlaySettings) {
        if let Some(editor) = &mut self.interface.ui_state.editor {
            editor.finish();
        }
        self.playback.recording.finish(clock::now());
        self.pictures.finish(&self.interface.waker);
        if settings.remembered {
            self.remember_tracks();
            let left = self.left();
            self.playback.write_left(left);
        }
    }

    pub(super) fn remember_show(&mut self, settings: &PlaySettings, now: Instant) {
        if !settings.remembered || !self.playback.listening.started || !self.legacy.is_due(now) {
            return;
        }
        self.remember_tracks();
        let left = self.left();
        if self.legacy.takes(&left, now) {
            self.playback.write_left(left);
        }
    }

    fn left(&mut self) -> Left {
        let mut show = self.playback.listening.sound.kept.settings().last_show.clone().unwrap_or_default();
        show.fullscreen = self.screen.is_fullscreen();
        show.size = self.screen.size().filter(|_| !show.fullscreen).or(show.size);
        show.place = self.screen.place().or(show.place);
        show.scene = name_of(self.surprises.lasting(self.playback.scene.present_source())).or(show.scene);
        if !self.choices.last_tracks {
            (show.track, show.seconds) = (0, 0.0);
        }
        if let Some(status) = self.playback.listening.with_song(|player| player.status()) {
            let remaining = status.track.duration.map(|duration| duration - status.position);
            let is_over = remaining.is_some_and(|remaining| remaining < LEFT_MIN);
            show.volume = Some(status.volume);
            if self.choices.last_tracks {
                show.track = status.track.entry;
                show.seconds = if is_over { 0.0 } else { status.position };
            }
            show.shuffled = status.shuffled;
            show.repeat = Some(status.repeat.name().to_owned());
        }
        Left {
            show,
            scene: self.playback.scene.scenes.name().unwrap_or_default(),
            moved: self.playback.scene.parameters_in_hand().moved(),
        }
    }

    fn remember_tracks(&mut self) {
        let Some(list) = self.playback.listening.with_song(|player| player.playlist()) else { return };
        let list = Some(list).filter(|_| self.choices.last_tracks);
        if self.legacy.takes_tracks(list.as_ref().map(|list| list.revision)) {
            self.playback.listening.sound.kept.keep_tracks(list.and_then(|list| files_of(&list)));
        }
    }
}

impl Playback {
    fn write_left(&mut self, Left { show, scene, moved }: Left) {
        self.listening.sound.kept.change(move |settings| {
            settings.last_show = Some(show.clone());
            settings.sliders.insert(scene.clone(), moved.sliders.clone());
            settings.sliders.retain(|_, sliders| !sliders.is_empty());
            settings.bindings.insert(scene.clone(), moved.bindings.clone());
            settings.bindings.retain(|_, bindings| !bindings.is_empty());
        });
    }
}

/// Returns the files of a list; `None` if an entry is built in or only part of a file: a saved list names whole files.
fn files_of(list: &ListedTracks) -> Option<Vec<PathBuf>> {
    list.entries.iter().map(|track| track.file.clone().filter(|_| track.start.is_none())).collect()
}

/// The saved name of a scene; `None` for a formula.
fn name_of(source: &SceneSource) -> Option<String> {
    match source {
        SceneSource::Shipped(name) => Some(name.clone()),
        SceneSource::File(path) => std::path::absolute(path).ok()?.to_str().map(str::to_owned),
        SceneSource::Formula(_) => None,
        SceneSource::Blend(blend) => name_of(&blend.to.source),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_state_is_written_after_each_change_and_the_position_periodically() {
        let start = Instant::now();
        let at = |seconds: u64| start + Duration::from_secs(seconds);
        let left = |seconds: f64, volume: f32| Left {
            show: LastShow { seconds, volume: Some(volume), ..LastShow::default() },
            scene: "orb".to_owned(),
            moved: Snapshot::default(),
        };
        let mut legacy = Legacy::default();
        let mut takes = |now, wanted: Left| legacy.takes(&wanted, at(now));
        assert!(takes(0, left(90.0, 1.0)), "the state at the start");
        assert!(!takes(5, left(95.0, 1.0)));
        assert!(takes(6, left(96.0, 0.5)), "the volume");
        assert!(!takes(15, left(105.0, 0.5)));
        assert!(takes(16, left(106.0, 0.5)), "the position");
        assert!(!takes(60, left(106.0, 0.5)), "the song is paused");
        let taken = [None, None, Some(1), Some(1), Some(2), None].map(|list| legacy.takes_tracks(list));
        assert_eq!(taken, [true, false, true, false, true, true]);
    }
}
