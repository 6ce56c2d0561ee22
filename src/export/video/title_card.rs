//! The song's title and artist, shown during the first seconds of a video.

use std::path::Path;

use super::request::VideoRequest;
use crate::export::error::ExportError;
use crate::view::caption::Caption;
use mariana_player::song::{display_name, one_line};

/// Duration of the title card, and of fading it in and out, in seconds.
const SEEN: f64 = 5.0;
const FADE: f64 = 0.6;
/// The longest title card and fade in a short video, relative to the video and to the card.
const SEEN_FRACTION: f64 = 0.6;
const FADE_FRACTION: f64 = 0.25;

pub(super) struct TitleCard {
    caption: Caption,
    /// Duration in seconds.
    seen: f64,
}

fn without_ending(name: &str) -> String {
    let stem = Path::new(name).file_stem().unwrap_or_default();
    one_line(&stem.to_string_lossy())
}

impl TitleCard {
    /// Returns the card of a video of `seconds`: the song's title and artist, the title alone, or the file's name
    /// without its ending.
    pub(super) fn of(request: &VideoRequest, seconds: Option<f64>) -> Result<Self, ExportError> {
        let decoder = request.song.open()?;
        let info = decoder.info();
        let (title, artist) = match (&info.title, &info.artist) {
            (Some(title), Some(artist)) => (one_line(title), Some(one_line(artist))),
            (None, _) => (without_ending(&info.name), None),
            _ => (display_name(&decoder), None),
        };
        let caption = Caption::of_title(&title, artist.as_deref(), request.lyrics.is_some(), request.size);
        Ok(Self { caption, seen: seconds.map_or(SEEN, |seconds| SEEN.min(SEEN_FRACTION * seconds)) })
    }

    /// Draws the card at this time in the video, in seconds.
    pub(super) fn draw_over(&self, rgba: &mut [u8], seconds: f64) {
        let fade = FADE.min(FADE_FRACTION * self.seen);
        let strength = (seconds.min(self.seen - seconds) / fade).clamp(0.0, 1.0);
        if strength > 0.0 {
            self.caption.draw_over(rgba, strength as f32);
        }
    }
}
