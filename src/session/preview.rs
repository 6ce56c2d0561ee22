//! A small preview of the next scene in the window. It is shown while an output shows the frames, or if the settings
//! ask for it.
//!
//! **The preview takes no time from the show.** It is drawn a few times a second, and only if the time until the next
//! frame is longer than the last previews took. It is read back without waiting. The first preview of a scene is drawn
//! in any case: every scene must be drawn once before it is shown.

use std::sync::Arc;
use std::time::{Duration, Instant};

use image::RgbaImage;

use super::{Playback, Session};
use crate::clock;
use crate::gpu::{GpuError, PictureReader, Sketch};
use crate::session::screen::Screen;
use crate::ui::overlay::NextScene;
use mariana_music::Sound;

const SIZE: (u32, u32) = (160, 90);
/// Minimum interval between two previews, and between two updates of the displayed level and beat.
const EVERY: Duration = Duration::from_millis(200);
/// Assumed drawing time before the first measurement.
const ASSUMED: Duration = Duration::from_millis(6);
/// Maximum drawing time of a preview while the show is idle.
const AT_REST: Duration = Duration::from_millis(100);
/// The available time must exceed the last drawing time by this factor.
const RESERVE: f64 = 1.5;

pub(super) struct Preview {
    sketch: Sketch,
    reader: Option<PictureReader>,
    due: Instant,
    took: Duration,
    drawn: Option<Drawn>,
    pub(super) next: Option<NextScene>,
}

/// A drawn preview: its scene's title, and the moment of the song.
type Drawn = (String, f64);

impl Preview {
    pub(super) fn new() -> Self {
        let (sketch, reader, drawn, next) = (Sketch::default(), None, None, None);
        Self { sketch, reader, due: clock::now(), took: ASSUMED, drawn, next }
    }
}

impl Session {
    /// Updates the preview if there is time. `rest` is the time until the next frame; `None` while the show is idle.
    pub(super) fn update_preview(&mut self, now: Instant, rest: Option<Duration>) -> Result<(), GpuError> {
        let hidden = self.interface.ui_state.hidden;
        let is_wanted = self.choices.next_scene || (self.screen.has_output() && !hidden.by_setting);
        let title = self.playback.scene.scenes.next_title().filter(|_| is_wanted && !hidden.is_bare());
        let Some(title) = title else {
            if self.playback.preview.next.take().is_some() {
                self.screen.request_redraw();
            }
            return Ok(());
        };
        self.playback.receive_preview(&mut *self.screen, &title);
        if now < self.playback.preview.due {
            return Ok(());
        }
        let rest = rest.map_or(AT_REST, |rest| rest.min(AT_REST));
        let Some(moment) = self.playback.pace.shown.map(|shown| shown.moment) else { return Ok(()) };
        self.playback.preview.due = now + EVERY;
        let (level, beat) = (self.playback.listening.level, moment.features.beat.clamp(0.0, 1.0));
        if let Some(next) = &mut self.playback.preview.next {
            (next.level, next.beat) = (level, beat);
        }
        let preview = &mut self.playback.preview;
        let has_one = preview.drawn.as_ref().is_some_and(|(drawn, _)| *drawn == title);
        if has_one && preview.took.mul_f64(RESERVE) > rest {
            // Lower the last drawing time, so that a preview that was slow once is tried again.
            preview.took = preview.took.mul_f64(0.9);
            return Ok(());
        }
        let wanted = (title, moment.song_time);
        if preview.drawn.as_ref() == Some(&wanted) {
            return Ok(());
        }
        let reader = match &mut preview.reader {
            Some(reader) => reader,
            none => none.insert(PictureReader::new(self.screen.gl(), SIZE)?),
        };
        let begun = clock::now();
        let parts = self.playback.listening.parts(moment);
        let sound = Sound { features: moment.features, song: moment.song, parts, ..Sound::default() };
        let heard = (moment.song_time, sound);
        let renderer = &mut self.playback.renderer;
        let drawn = self.playback.scene.preview(renderer, &mut preview.sketch, reader, heard)?;
        if drawn.is_some() {
            preview.took = clock::since(begun);
            tracing::debug!("the next scene in {:?} of {rest:?}", preview.took);
            preview.drawn = drawn.map(|title| (title, wanted.1));
        }
        Ok(())
    }
}

impl Playback {
    fn receive_preview(&mut self, screen: &mut dyn Screen, title: &str) {
        let Preview { reader, drawn, next, .. } = &mut self.preview;
        let picture = reader
            .as_mut()
            .and_then(PictureReader::drain)
            .filter(|_| drawn.as_ref().is_some_and(|(drawn, _)| drawn == title));
        let picture = picture.and_then(|bytes| RgbaImage::from_raw(SIZE.0, SIZE.1, bytes)).map(Arc::new);
        let is_known = next.as_ref().is_some_and(|next| next.title == title);
        if is_known && picture.is_none() {
            return;
        }
        let (level, beat) = next.as_ref().map_or((0.0, 0.0), |next| (next.level, next.beat));
        *next = Some(NextScene { title: title.to_owned(), picture, level, beat });
        screen.request_redraw();
    }
}
