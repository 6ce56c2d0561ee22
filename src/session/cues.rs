//! The cues of a show file, which start when a key is pressed, and the times of the key presses.

use std::sync::Arc;

use crate::scenes::SceneSource;
use crate::session::direction::OfTrack;
use crate::show::{Anchor, Entry, PreparedShow, moment};
use crate::ui::overlay::CueRow;
use mariana_music::SongStructure;
use mariana_player::Moment;

#[derive(Default)]
pub(super) struct Cues {
    track: OfTrack,
    /// The show before any key press, and the structure of its song.
    show: Option<(Arc<PreparedShow>, Arc<SongStructure>)>,
    /// Times of the key presses in seconds of the song, ascending.
    pressed: Vec<f64>,
    /// The segment and the lap of the last moment.
    heard: (u64, u32),
    /// All entries of the show, with the present key presses.
    pub(super) rows: Arc<Vec<CueRow>>,
}

/// The effect of a jump in the cue list.
#[derive(Debug)]
pub(super) enum Jump {
    /// The entry begins at this time, in seconds of the song.
    Seek(f64),
    /// The entry was waiting for the key, which now counts as pressed.
    Pressed(Arc<PreparedShow>),
    /// The list has no such entry, or the entry follows an entry that waits.
    Nowhere,
}

impl Cues {
    /// Sets the show of a track. Key presses stay valid if only the show's file has changed.
    pub(super) fn set_show(
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
        self.update_rows();
    }

    fn update_rows(&mut self) {
        let row = |(entry, start): (&Entry, Option<f64>)| {
            let camera = entry.camera.as_ref().map(|camera| format!(", {camera}")).unwrap_or_default();
            let (waits, scene) = (entry.when.anchor == Anchor::Cue, entry.scene.clone() + &camera);
            CueRow { moment: moment(entry), start, waits, scene }
        };
        let entries = self.show.iter().flat_map(|(show, song)| show.entries(song, &self.pressed));
        self.rows = Arc::new(entries.map(row).collect());
    }

    /// Forgets the key presses after this moment if the song was sought or began again. Returns the show without them.
    pub(super) fn follow(&mut self, at: &Moment) -> Jump {
        let heard = (at.segment, at.lap);
        let continues = std::mem::replace(&mut self.heard, heard) == heard;
        if continues || self.pressed.last().is_none_or(|last| *last <= at.song_time) {
            return Jump::Nowhere;
        }
        self.pressed.retain(|pressed| *pressed <= at.song_time);
        self.press_anew()
    }

    /// Returns the index of the entry that is shown at `time` seconds of the song.
    pub(super) fn current(&self, time: f64) -> Option<usize> {
        let begun = self.rows.iter().enumerate().filter_map(|(index, row)| Some((index, row.start?)));
        let last = begun.filter(|(_, start)| *start <= time).max_by(|a, b| a.1.total_cmp(&b.1));
        last.map(|(index, _)| index)
    }

    /// Goes to the entry with this index: the song seeks to its time, or the key counts as pressed as often as needed.
    pub(super) fn jump(&mut self, index: usize, time: f64) -> Jump {
        let Some(row) = self.rows.get(index) else { return Jump::Nowhere };
        match row.start {
            Some(start) if !row.waits => return Jump::Seek(start),
            None if !row.waits => return Jump::Nowhere,
            _ => {}
        }
        let number = self.rows.iter().take(index).filter(|row| row.waits).count();
        self.pressed.retain(|pressed| *pressed <= time);
        self.pressed.truncate(number);
        self.pressed.resize(number + 1, time);
        self.press_anew()
    }

    /// Goes back to the entry before the one at `time`: takes the last key press back, or seeks.
    pub(super) fn back(&mut self, time: f64) -> Jump {
        let Some(current) = self.current(time) else { return Jump::Nowhere };
        if self.rows.get(current).is_some_and(|row| row.waits) {
            self.pressed.retain(|pressed| *pressed <= time);
            self.pressed.pop();
            return self.press_anew();
        }
        let start = self.rows.get(current).and_then(|row| row.start);
        let earlier = self.rows.iter().filter_map(|row| row.start).filter(|at| Some(*at) < start);
        earlier.max_by(f64::total_cmp).map_or(Jump::Nowhere, Jump::Seek)
    }

    fn press_anew(&mut self) -> Jump {
        self.update_rows();
        self.prepared_show().map_or(Jump::Nowhere, Jump::Pressed)
    }

    /// The show with the present key presses.
    pub(super) fn prepared_show(&self) -> Option<Arc<PreparedShow>> {
        let (show, song) = self.show.as_ref()?;
        // Without presses, the loader's thread has resolved the show already.
        let is_pressed = !self.pressed.is_empty();
        Some(if is_pressed { Arc::new(show.with_cues(song, &self.pressed)) } else { show.clone() })
    }

    /// Notes a key press at `time` seconds of the song. Forgets presses at later times, as after a seek back. Returns the
    /// show with the cue, and a message.
    ///
    /// # Errors
    /// Fails with a message if no cue is left.
    pub(super) fn press(&mut self, time: f64) -> Result<(Arc<PreparedShow>, String), &'static str> {
        const NO_CUES: &str = "this show has no cues: add `at cue SCENE` to the show file";
        let cues = self.show.as_ref().map(|(show, _)| show.cues()).unwrap_or_default();
        if cues.is_empty() {
            return Err(NO_CUES);
        }
        self.pressed.retain(|pressed| *pressed <= time);
        let scene = cues.get(self.pressed.len()).ok_or("that was the last cue of the show")?;
        self.pressed.push(time);
        let words = format!("cue {} of {}: {scene}", self.pressed.len(), cues.len());
        self.update_rows();
        Ok((self.prepared_show().ok_or(NO_CUES)?, words))
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
        let no_cues = "this show has no cues: add `at cue SCENE` to the show file";
        assert_eq!(cues.press(1.0).unwrap_err(), no_cues);
        cues.set_show(Some(7), Some(Arc::new(show.clone())), None);
        assert_eq!(cues.next(), Some(SceneSource::Shipped("city".to_owned())));
        let press = |cues: &mut Cues, at: f64, time: f64| {
            let (prepared_show, words) = cues.press(at).unwrap();
            (words, prepared_show.at(time).unwrap().clip.scene.clone())
        };
        let city = ("cue 1 of 2: city".to_owned(), "city".to_owned());
        let letters = ("cue 2 of 2: letters".to_owned(), "letters".to_owned());
        assert_eq!(press(&mut cues, 10.0, 10.0), city);
        assert_eq!(press(&mut cues, 40.0, 40.0), letters);
        assert_eq!(cues.press(50.0).unwrap_err(), "that was the last cue of the show");
        assert_eq!(cues.current(50.0), Some(3));
        // Key presses do not move the show's timed entries.
        assert_eq!(cues.prepared_show().unwrap().at(35.0).unwrap().clip.scene, "gyroid");
        assert_eq!(press(&mut cues, 20.0, 25.0), letters);
        assert_eq!(press(&mut cues, 5.0, 8.0), city);
        // Saving the file keeps the key presses. A change of the track drops them.
        cues.set_show(Some(7), Some(Arc::new(show.clone())), None);
        assert_eq!(cues.next(), Some(SceneSource::Shipped("letters".to_owned())));
        cues.set_show(Some(8), Some(Arc::new(show)), None);
        assert_eq!(cues.next(), Some(SceneSource::Shipped("city".to_owned())));
    }

    #[test]
    fn cues_wait_again_when_the_song_repeats_or_is_sought_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("my.show");
        std::fs::write(&path, "at start orb\nat cue city cut\nat cue letters cut\n").unwrap();
        let show = PreparedShow::of_song(&ShowSource::File(path), &SongStructure::default(), &[]).unwrap().0;
        let at = |segment, lap, song_time| Moment { segment, lap, song_time, ..Moment::default() };
        for (back, kept) in [(at(1, 1, 0.1), 0), (at(2, 0, 5.0), 0), (at(2, 0, 15.0), 1)] {
            let mut cues = Cues::default();
            cues.set_show(Some(7), Some(Arc::new(show.clone())), None);
            assert!(matches!(cues.follow(&at(1, 0, 9.0)), Jump::Nowhere));
            cues.press(10.0).unwrap();
            cues.press(20.0).unwrap();
            // The clock of a device may step back a little.
            assert!(matches!(cues.follow(&at(1, 0, 19.9)), Jump::Nowhere));
            let Jump::Pressed(show) = cues.follow(&back) else { panic!("{back:?}") };
            assert_eq!(show.at(30.0).unwrap().clip.scene, ["orb", "city"][kept]);
            assert_eq!(cues.press(31.0).unwrap().1, ["cue 1 of 2: city", "cue 2 of 2: letters"][kept]);
        }
    }

    #[test]
    fn a_jump_presses_the_key_as_often_as_needed_or_seeks() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("my.show");
        let text =
            "at start orb\nat cue city cut\nat cue heart cut\nat previous + 4 s gyroid\nat 30 s letters\n";
        std::fs::write(&path, text).unwrap();
        let show = PreparedShow::of_song(&ShowSource::File(path), &SongStructure::default(), &[]).unwrap().0;
        let mut cues = Cues::default();
        assert!(matches!(cues.jump(0, 1.0), Jump::Nowhere), "there is no show");
        cues.set_show(Some(7), Some(Arc::new(show)), None);
        assert!(matches!(cues.jump(3, 5.0), Jump::Nowhere), "it follows an entry that waits");
        assert!(matches!(cues.jump(4, 5.0), Jump::Seek(30.0)));
        let Jump::Pressed(pressed) = cues.jump(2, 10.0) else { panic!("not pressed") };
        assert_eq!(pressed.at(10.0).unwrap().clip.scene, "heart");
        assert_eq!((cues.current(10.0), cues.current(14.0), cues.current(31.0)), (Some(2), Some(3), Some(4)));
        assert!(matches!(cues.back(15.0), Jump::Seek(10.0)));
        let Jump::Pressed(back) = cues.back(12.0) else { panic!("not taken back") };
        assert_eq!(back.at(12.0).unwrap().clip.scene, "city");
        assert!(matches!(cues.jump(9, 12.0), Jump::Nowhere));
    }
}
