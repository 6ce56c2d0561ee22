//! The line of lyrics that is sung at a moment, shown in a video.

use crate::view::caption::Caption;
use mariana_player::lyrics::Lyrics;

/// Duration of a line's fade in and out, in seconds.
const FADE: f64 = 0.2;

pub(super) struct LyricCaptions {
    lyrics: Lyrics,
    size: (u32, u32),
    /// The number of the line shown last, and its caption.
    shown: Option<(usize, Caption)>,
}

impl LyricCaptions {
    pub(super) fn new(lyrics: Lyrics, size: (u32, u32)) -> Self {
        Self { lyrics, size, shown: None }
    }

    /// Draws the line that is sung at this time in the song, in seconds.
    pub(super) fn draw_over(&mut self, rgba: &mut [u8], time: f64) {
        let Some((number, line)) = self.lyrics.at(time) else { return };
        let size = self.size;
        let kept = self.shown.take().filter(|(shown, _)| *shown == number);
        let (_, caption) =
            self.shown.insert(kept.unwrap_or_else(|| (number, Caption::of_lyric(&line.words, size))));
        let strength = ((time - line.start).min(line.end - time) / FADE).clamp(0.0, 1.0);
        caption.draw_over(rgba, strength as f32);
    }
}
