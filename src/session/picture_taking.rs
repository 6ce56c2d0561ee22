//! Takes pictures of a session's frames, and follows what the session makes: pictures and videos.

use std::path::PathBuf;
use std::time::Instant;

use super::Session;
use crate::file_names::plain_name;

impl Session {
    /// Takes a wanted picture of the finished frame. `time` is the frame's time in the song, and `whole` the size of
    /// the window.
    pub(super) fn save_picture(&mut self, time: f64, whole: (u32, u32)) {
        let folder = &self.interface.folders.pictures;
        let title = &self.playback.reports.playing.title;
        let file = || Some(folder.as_ref()?.join(picture_name(title, time)));
        let renderer = &mut self.playback.renderer;
        if let Err(words) = self.pictures.save(self.screen.gl(), renderer, whole, file) {
            self.playback.reports.answer(words);
        }
    }

    /// Follows the pictures and videos that are being made. Returns when to call again.
    pub(super) fn update_made(&mut self, now: Instant) -> Option<Instant> {
        let (due, messages) = self.pictures.update(now, &self.interface.waker);
        for words in messages {
            tracing::info!("{words}");
            self.playback.reports.answer(words);
        }
        due.into_iter().chain(self.video_desk().update(now)).min()
    }
}

/// A name such as "Song 1.23.png" for a picture at `time` seconds.
fn picture_name(title: &str, time: f64) -> PathBuf {
    let seconds = time.max(0.0) as u64;
    let name = plain_name(&format!("{title} {}.{:02}", seconds / 60, seconds % 60), "picture");
    PathBuf::from(name + ".png")
}
