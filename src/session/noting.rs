//! Recording of a show, and the messages about it.

use std::time::Instant;

use super::{Playback, Session};
use crate::clock;
use crate::session::scene::Performed;
use crate::show::Finish;
use mariana_player::Moment;

impl Session {
    /// Takes the results of the threads that write shows and scenes.
    pub(super) fn report_written_files(&mut self) {
        self.playback.report_recording();
        self.snapshot_desk().update();
        self.update_surprises();
    }
}

impl Playback {
    pub(super) fn toggle_recording(&mut self) {
        let begins = self.recording.toggle(clock::now());
        if let Some(shown) = self.pace.shown.filter(|_| begins) {
            self.record(shown.moment, clock::now());
        }
        let words = match begins {
            true if self.listening.song_status().is_none() => {
                "recording starts with the next song: an audio input cannot be recorded"
            }
            true => "recording: press F9 to stop",
            false => "recording stopped",
        };
        self.reports.answer(words);
    }

    pub(super) fn record(&mut self, moment: Moment, begun: Instant) {
        if !self.recording.is_on {
            return;
        }
        let track = self.listening.track_of(moment);
        let picture = self.finish(begun);
        let Some(performed) = Performed::of(&self.scene, moment.song_time) else { return };
        let performed = Performed { picture, ..performed };
        // Record a still scene at the current time, because `moment` is the time at which the scene became still.
        let now = self.listening.now().filter(|_| !self.scene.moves_by_itself());
        let time = now.map_or(moment.song_time, |now| now.song_time);
        let title = self.reports.playing.title.as_str();
        if let Some(words) = self.recording.record(track, title, time, performed, clock::now()) {
            self.reports.answer(words);
        }
    }

    /// Records that the last frame is still shown: it is frozen, or only its brightness changes.
    pub(super) fn record_again(&mut self, begun: Instant) {
        if !self.recording.is_on {
            return;
        }
        let Some(now) = self.listening.now() else { return };
        let (track, is_held) = (self.listening.track_of(now), self.holds_picture());
        let picture = self.finish(begun);
        self.recording.record_picture(track, now.song_time, &picture, is_held);
    }

    pub(super) fn finish(&self, begun: Instant) -> Finish {
        let fraction = if self.holds_picture() { 1.0 } else { self.scene.composer.fading.fraction_held() };
        let is_shown = self.master_output.are_idle(begun)
            && (fraction == 0.0 || self.master_output.shown.held.is_some());
        Finish { numbers: [self.master_output.gain(begun), fraction], is_shown }
    }

    pub(super) fn report_recording(&mut self) {
        self.recording.update(clock::now());
        if let Some(news) = self.recording.news() {
            tracing::info!("{news}");
            self.reports.answer(news);
        }
    }
}
