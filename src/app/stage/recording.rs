//! What is recorded of a show, and what is said of it.

use std::time::Instant;

use super::Stage;
use mariana_player::Moment;

impl Stage {
    /// Begins to record what hands do, or ends that.
    pub(in crate::app) fn toggle_recording(&mut self) {
        let words = match self.recording.toggle(Instant::now()) {
            true if self.listening.song_status().is_none() => {
                "what hands do is recorded as soon as a song plays: an input cannot be played again"
            }
            true => "what hands do is recorded: F9 ends it",
            false => "the recording has ended",
        };
        self.reports.answer(words.to_owned());
    }

    /// Whether it is recorded what hands do.
    pub(in crate::app) fn is_recording(&self) -> bool {
        self.recording.is_on()
    }

    /// Notes a picture that shows.
    pub(super) fn record(&mut self, moment: Moment) {
        if !self.recording.is_on() {
            return;
        }
        let track = self.listening.track_of(moment);
        let Some(performed) = self.scene.performed(moment.song_time) else { return };
        // A scene that stands still is drawn as of the moment at which it came to rest.
        let now = self.listening.now().filter(|_| !self.scene.moves_by_itself());
        let time = now.map_or(moment.song_time, |now| now.song_time);
        let of = (track, self.reports.playing().title.as_str());
        if let Some(words) = self.recording.note(of, time, performed, Instant::now()) {
            self.reports.answer(words.to_owned());
        }
    }

    /// Says what became of a recording.
    pub(super) fn tell_recording(&mut self) {
        if let Some(news) = self.recording.news() {
            tracing::info!("{news}");
            self.reports.answer(news);
        }
    }
}
