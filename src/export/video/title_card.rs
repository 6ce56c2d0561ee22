//! The song's title and artist, shown during the first seconds of a video.

use crate::export::error::ExportError;
use crate::view::caption::Caption;
use mariana_player::song::{Song, display_name, one_line};

/// Duration of the title card, and of fading it in and out, in seconds.
const SEEN: f64 = 5.0;
const FADE: f64 = 0.6;

pub(super) struct TitleCard(Caption);

impl TitleCard {
    /// Returns the card of a song: title and artist, or the file's name if title or artist is missing.
    pub(super) fn of(song: &Song, size: (u32, u32)) -> Result<Self, ExportError> {
        let decoder = song.open()?;
        let info = decoder.info();
        Ok(Self(match (&info.title, &info.artist) {
            (Some(title), Some(artist)) => Caption::of_title(&one_line(title), Some(&one_line(artist)), size),
            _ => Caption::of_title(&display_name(&decoder), None, size),
        }))
    }

    /// Draws the card at this time in the video, in seconds. Returns false if the card is over.
    pub(super) fn draw_over(&self, rgba: &mut [u8], seconds: f64) -> bool {
        let strength = (seconds.min(SEEN - seconds) / FADE).clamp(0.0, 1.0);
        if strength > 0.0 {
            self.0.draw_over(rgba, strength as f32);
        }
        seconds < SEEN
    }
}
