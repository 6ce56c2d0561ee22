//! Captions at the lower edge of an image: a song's title and artist on the left, or a line of lyrics in the middle.
//! The CPU draws them.

use super::letters::{Letters, Line};

/// Size of the first line's letters relative to the image's smaller side. The next constant limits it, in pixels.
const LETTERS_FRACTION: f32 = 1.0 / 15.0;
const LETTERS: (f32, f32) = (9.0, 160.0);
/// Size of the second line's letters relative to the first line's.
const SECOND: f32 = 0.62;
/// Distance from the image's edges relative to its smaller side.
const MARGIN_FRACTION: f32 = 0.07;
/// In portrait images, of at most this ratio of width to height, apps cover these parts of the width on the right and of
/// the height below with their controls.
const PORTRAIT: f32 = 0.75;
const COVERED: (f32, f32) = (0.12, 0.15);
/// Fraction of the image's light that remains where a letter's shadow is darkest.
const SHADOW: f32 = 0.35;

/// Size of a lyric's letters relative to a title's.
const LYRIC: f32 = 0.8;
/// Size of the empty line between a title and the lower edge where lyrics are shown.
const LYRIC_ROOM: f32 = 1.2;

/// The area for texts, in pixels from the image's left and upper edges.
struct TextArea {
    left: usize,
    right: usize,
    bottom: usize,
}

impl TextArea {
    fn of(size: (u32, u32)) -> Self {
        let (width, height) = (size.0 as f32, size.1 as f32);
        let margin = width.min(height) * MARGIN_FRACTION;
        let covered = if width <= PORTRAIT * height { COVERED } else { (0.0, 0.0) };
        let [left, right, below] = [margin, margin.max(covered.0 * width), margin.max(covered.1 * height)]
            .map(|part| part.round() as usize);
        Self {
            left,
            right: (size.0 as usize).saturating_sub(right),
            bottom: (size.1 as usize).saturating_sub(below),
        }
    }
}

/// Positioned lines of letters.
pub struct Caption {
    size: (usize, usize),
    /// Each line with its left and upper edge.
    lines: Vec<((usize, usize), Line)>,
    /// Offset of the shadow to the right and downwards, in pixels.
    shadow: usize,
}

impl Caption {
    /// Lays out a title, with an artist below it, for images of `size` pixels. With `has_lyrics`, there is
    /// room for lyrics below. Text that is too wide becomes smaller. If it is still too wide, it is cut.
    pub fn of_title(title: &str, artist: Option<&str>, has_lyrics: bool, size: (u32, u32)) -> Self {
        let texts =
            [Some((title, 1.0)), artist.map(|text| (text, SECOND)), has_lyrics.then_some(("", LYRIC_ROOM))];
        Self::new(texts.into_iter().flatten(), size, |_, area| area.left)
    }

    /// Lays out a line of lyrics in the middle of the lower edge. Text that is too wide is treated as in a title.
    pub fn of_lyric(words: &str, size: (u32, u32)) -> Self {
        let middle = |width: usize| (size.0 as usize).saturating_sub(width) / 2;
        Self::new([(words, LYRIC)].into_iter(), size, |width, area| {
            middle(width).min(area.right.saturating_sub(width))
        })
    }

    /// Lays out texts, each with the size of its letters relative to a title's. `left` computes a line's left edge from
    /// the line's width.
    fn new<'a>(
        texts: impl DoubleEndedIterator<Item = (&'a str, f32)>,
        size: (u32, u32),
        left: impl Fn(usize, &TextArea) -> usize,
    ) -> Self {
        let area = TextArea::of(size);
        let room = area.right.saturating_sub(area.left);
        let side = size.0.min(size.1) as f32;
        let letters_size = (side * LETTERS_FRACTION).clamp(LETTERS.0, LETTERS.1).round();
        let mut letters = Letters::default();
        let mut bottom = area.bottom;
        let mut lines = Vec::new();
        // Start with the last line, because lines are placed from the bottom up.
        for (text, relative) in texts.rev() {
            let line = fitting(&mut letters, text, (letters_size * relative).round(), room);
            bottom = bottom.saturating_sub(line.size.1);
            lines.push(((left(line.size.0, &area), bottom), line));
        }
        Self {
            size: (size.0 as usize, size.1 as usize),
            lines,
            shadow: (letters_size / 18.0).ceil() as usize,
        }
    }

    /// Draws the caption over an image of premultiplied RGBA bytes, top row first. `strength` ranges from 0 (invisible)
    /// to 1.
    pub fn draw_over(&self, rgba: &mut [u8], strength: f32) {
        self.blend(rgba, self.shadow, 0.0, strength * (1.0 - SHADOW));
        self.blend(rgba, 0, 255.0, strength);
    }

    fn blend(&self, rgba: &mut [u8], shift: usize, grey: f32, strength: f32) {
        for ((left, top), line) in &self.lines {
            for (index, cover) in line.cover.iter().enumerate().filter(|(_, cover)| **cover > 0) {
                let (x, y) = (left + index % line.size.0 + shift, top + index / line.size.0 + shift);
                if x >= self.size.0 || y >= self.size.1 {
                    continue;
                }
                let at = 4 * (y * self.size.0 + x);
                let fraction = strength * f32::from(*cover) / 255.0;
                let pixel = rgba.get_mut(at..at + 4).into_iter().flatten();
                for (byte, wanted) in pixel.zip([grey, grey, grey, 255.0]) {
                    *byte = (f32::from(*byte) * (1.0 - fraction) + wanted * fraction).round() as u8;
                }
            }
        }
    }
}

/// Lays out a line at the wanted size, or smaller, so that it is at most `room` pixels wide. Cuts text that gets too
/// small.
fn fitting(letters: &mut Letters, text: &str, wanted: f32, room: usize) -> Line {
    let line = letters.line(text, wanted);
    if line.size.0 <= room {
        return line;
    }
    let smaller = (wanted * room as f32 / line.size.0 as f32).floor().max(wanted * 0.5).max(LETTERS.0);
    let mut kept: Vec<char> = text.chars().collect();
    let mut line = letters.line(text, smaller);
    while line.size.0 > room && !kept.is_empty() {
        // Cut the estimated excess first, then single letters.
        let fraction = room as f32 / line.size.0 as f32;
        kept.truncate(((kept.len() as f32 * fraction) as usize).min(kept.len() - 1));
        let cut: String = kept.iter().collect();
        line = letters.line(&format!("{}…", cut.trim_end()), smaller);
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    fn changed(first: &str, size: (u32, u32), strength: f32) -> (usize, usize) {
        let grey = vec![90; 4 * (size.0 * size.1) as usize];
        let mut seen = grey.clone();
        Caption::of_title(first, Some("Somebody"), false, size).draw_over(&mut seen, strength);
        let differs = |index: &usize| seen[4 * index..4 * index + 4] != grey[4 * index..4 * index + 4];
        let places: Vec<usize> = (0..(size.0 * size.1) as usize).filter(differs).collect();
        (places.len(), places.iter().map(|place| place % size.0 as usize).max().unwrap_or(0))
    }

    #[test]
    fn the_strength_sets_the_opacity_of_letters() {
        let (whole, _) = changed("A song", (640, 360), 1.0);
        assert!(whole > 300, "{whole} pixels");
        assert_eq!(changed("A song", (640, 360), 0.0).0, 0);
        changed("A song", (1, 1), 1.0);
    }

    #[test]
    fn a_lyric_is_in_the_middle_of_the_lower_edge() {
        let size = (640, 360);
        let mut seen = vec![90; 4 * 640 * 360];
        Caption::of_lyric("All of us", size).draw_over(&mut seen, 1.0);
        let changed = |index: &usize| seen[4 * index] != 90;
        let places: Vec<usize> = (0..640 * 360).filter(changed).collect();
        let columns = || places.iter().map(|place| place % 640);
        let (left, right) = (columns().min().unwrap(), columns().max().unwrap());
        assert!(left.abs_diff(640 - right) < 12, "columns {left} to {right}");
        assert!(places.iter().all(|place| place / 640 > 270), "above the lower quarter");
    }

    #[test]
    fn apps_covered_the_texts_of_portrait_videos() {
        let size @ (width, height) = (270_u32, 480_u32);
        let long = "Sonata ".repeat(40);
        let title = |has_lyrics| Caption::of_title(&long, Some(&long), has_lyrics, size);
        for caption in
            [title(false), title(true), Caption::of_lyric(&long, size), Caption::of_lyric("Oh", size)]
        {
            let mut seen = vec![90; 4 * (width * height) as usize];
            caption.draw_over(&mut seen, 1.0);
            let places: Vec<usize> = (0..seen.len() / 4).filter(|index| seen[4 * index] != 90).collect();
            assert!(!places.is_empty());
            let side = width as usize;
            let is_free = |place: &usize| {
                let (x, y) = ((place % side) as f32 / width as f32, (place / side) as f32 / height as f32);
                x > 0.05 && x < 0.89 && y > 0.08 && y < 0.85
            };
            assert!(places.iter().all(is_free));
        }
    }

    #[test]
    fn a_long_title_stays_within_the_image() {
        let (pixels, right) = changed(&"Sonata ".repeat(40), (640, 360), 1.0);
        assert!(pixels > 300 && right < 640 - 20, "{pixels} pixels, the last in column {right}");
    }
}
