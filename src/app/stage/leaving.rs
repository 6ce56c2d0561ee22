//! What a show leaves to the next one when it ends: volume, window, scene, sliders, and where its tracks had got to.

use std::time::Instant;

use super::Stage;
use crate::config::{LastShow, PlaySettings};
use crate::scenes::SceneSource;

/// A track of which less is left than this is not gone on with, in seconds: the next one begins.
const LEFT_MIN: f64 = 5.0;

impl Stage {
    /// Remembers the show for the next one, unless the user wants nothing remembered.
    pub(in crate::app) fn leave_to_the_next(&mut self, settings: &PlaySettings) {
        if let Some(editor) = &mut self.desk.editor {
            editor.finish();
        }
        self.recording.finish(Instant::now());
        if !settings.remembered {
            return;
        }
        let before = self.listening.settings().last_show.clone().unwrap_or_default();
        let fullscreen = self.window.is_fullscreen();
        let mut show = LastShow {
            fullscreen,
            size: self.window.size().filter(|_| !fullscreen).or(before.size),
            place: self.window.place().or(before.place),
            scene: name_of(self.scene.source_to_leave()).or(before.scene),
            volume: before.volume,
            track: if self.choices.last_tracks { before.track } else { 0 },
            seconds: if self.choices.last_tracks { before.seconds } else { 0.0 },
            shuffled: before.shuffled,
            repeat: before.repeat,
        };
        if let Some((status, list)) = self.listening.with_song(|player| (player.status(), player.playlist()))
        {
            let remaining = status.track.duration.map(|duration| duration - status.position);
            let is_over = remaining.is_some_and(|remaining| remaining < LEFT_MIN);
            show.volume = Some(status.volume);
            if self.choices.last_tracks {
                show.track = status.track.entry;
                show.seconds = if is_over { 0.0 } else { status.position };
            }
            show.shuffled = status.shuffled;
            show.repeat = Some(status.repeat.name().to_owned());
            // A track inside the program has no file, and a part of one cannot be named in a list.
            let files = list.entries.iter().map(|track| track.file.clone().filter(|_| track.start.is_none()));
            let files = files.collect::<Option<Vec<_>>>().filter(|_| self.choices.last_tracks);
            self.listening.keep_tracks(files.as_deref());
        }
        let (scene, sliders) = (self.scene.name().unwrap_or_default(), self.scene.moved_sliders());
        self.listening.remember(move |settings| {
            settings.last_show = Some(show.clone());
            if sliders.is_empty() {
                settings.sliders.remove(&scene);
            } else {
                settings.sliders.insert(scene.clone(), sliders.clone());
            }
        });
    }
}

/// How the next show names a scene; a formula has no name.
fn name_of(source: &SceneSource) -> Option<String> {
    match source {
        SceneSource::Shipped(name) => Some(name.clone()),
        SceneSource::File(path) => std::path::absolute(path).ok()?.to_str().map(str::to_owned),
        SceneSource::Formula(_) => None,
        SceneSource::Blend(blend) => name_of(&blend.to.source),
    }
}
