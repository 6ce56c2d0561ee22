//! The cues of a show file, which start when a key is pressed, and the times of the key presses.

use std::sync::Arc;

use crate::scenes::SceneSource;
use crate::session::direction::OfTrack;
use crate::show::PreparedShow;
use mariana_music::SongStructure;

#[derive(Default)]
pub(super) struct Cues {
    track: OfTrack,
    /// The show before any key press, and the structure of its song.
    show: Option<(Arc<PreparedShow>, Arc<SongStructure>)>,
    /// Times of the key presses in seconds of the song, ascending.
    pressed: Vec<f64>,
}

#[derive(Debug)]
pub(super) enum Pressed {
    NoCues,
    NoneLeft,
    Cue {
        prepared_show: Arc<PreparedShow>,
        /// Number of the cue, from 1.
        number: usize,
        of: usize,
        scene: String,
    },
}

impl Cues {
    /// Sets the show of a track. Key presses stay valid if only the show's file has changed.
    pub(super) fn take(
        &mut self,
        track: OfTrack,
        show: Option<Arc<PreparedShow>>,
        song: Option<Arc<SongStructure>>,
    ) {
        if self.track != track || show.is_none() {
            self.pressed.clear();
        }
        self.track = track;
        self.show = show.map(|show| (show, song.unwrap_or_default()));
    }

    pub(super) fn prepared_show(&self) -> Option<Arc<PreparedShow>> {
        let (show, song) = self.show.as_ref().filter(|_| !self.pressed.is_empty())?;
        Some(Arc::new(show.with_cues(song, &self.pressed)))
    }

    /// Notes a key press at `time` seconds of the song. Forgets presses at later times, as after a seek back.
    pub(super) fn press(&mut self, time: f64) -> Pressed {
        let Some((show, song)) = &self.show else { return Pressed::NoCues };
        let cues = show.cues();
        if cues.is_empty() {
            return Pressed::NoCues;
        }
        self.pressed.retain(|pressed| *pressed <= time);
        let Some(scene) = cues.get(self.pressed.len()) else { return Pressed::NoneLeft };
        self.pressed.push(time);
        Pressed::Cue {
            prepared_show: Arc::new(show.with_cues(song, &self.pressed)),
            number: self.pressed.len(),
            of: cues.len(),
            scene: (*scene).to_owned(),
        }
    }

    pub(super) fn next(&self) -> Option<SceneSource> {
        let (show, _) = self.show.as_ref()?;
        show.source(show.cues().get(self.pressed.len())?).cloned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::show::ShowSource;

    #[test]
    fn a_press_takes_the_next_cue_and_after_a_seek_back_the_same_cue_again() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("my.show");
        std::fs::write(&path, "at start orb\nat cue city cut\nat 30 s gyroid\nat cue letters cut\n").unwrap();
        let song = SongStructure::default();
        let (show, _) = PreparedShow::of_song(&ShowSource::File(path), &song, &[]).unwrap();
        let mut cues = Cues::default();
        assert!(matches!(cues.press(1.0), Pressed::NoCues));
        cues.take(Some(7), Some(Arc::new(show.clone())), None);
        assert_eq!(cues.next(), Some(SceneSource::Shipped("city".to_owned())));
        let on = |pressed: Pressed, time: f64| match pressed {
            Pressed::Cue { prepared_show, number, of: 2, .. } => {
                (number, prepared_show.at(time).unwrap().clip.scene.clone())
            }
            other => panic!("{other:?}"),
        };
        assert_eq!(on(cues.press(10.0), 10.0), (1, "city".to_owned()));
        assert_eq!(on(cues.press(40.0), 40.0), (2, "letters".to_owned()));
        assert!(matches!(cues.press(50.0), Pressed::NoneLeft));
        // Key presses do not move the show's timed entries.
        assert_eq!(cues.prepared_show().unwrap().at(35.0).unwrap().clip.scene, "gyroid");
        assert_eq!(on(cues.press(20.0), 25.0), (2, "letters".to_owned()));
        assert_eq!(on(cues.press(5.0), 8.0), (1, "city".to_owned()));
        // Saving the file keeps the key presses. A change of the track drops them.
        cues.take(Some(7), Some(Arc::new(show.clone())), None);
        assert!(cues.prepared_show().is_some());
        cues.take(Some(8), Some(Arc::new(show)), None);
        assert!(cues.prepared_show().is_none());
    }
}
