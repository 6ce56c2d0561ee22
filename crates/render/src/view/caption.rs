//! A caption in a picture's lower left corner: a song's title, and who made it. The processor draws it.

use super::letters::{Letters, Line};

/// Size of the first line's letters relative to the picture's smaller side, and their smallest and largest in pixels.
const LETTERS_FRACTION: f32 = 1.0 / 15.0;
const LETTERS: (f32, f32) = (9.0, 160.0);
/// Size of the second line's letters relative to the first line's.
const SECOND: f32 = 0.62;
/// Distance from the picture's edges relative to its smaller side.
const MARGIN_FRACTION: f32 = 0.07;
/// How much of the picture is seen where a letter's shadow is darkest.
const SHADOW: f32 = 0.35;

/// Lines of letters in their places.
pub struct Caption {
    /// Width and height of the picture, in pixels.
    size: (usize, usize),
    /// Each with its left and its upper edge.
    lines: Vec<((usize, usize), Line)>,
    /// How far the shadow lies to the right of the letters and below them, in pixels.
    shadow: usize,
}

impl Caption {
    /// The caption for pictures of `size` pixels. Text that is too wide is set smaller and then cut.
    pub fn new(first: &str, second: Option<&str>, size: (u32, u32)) -> Self {
        let (width, height) = (size.0 as usize, size.1 as usize);
        let side = size.0.min(size.1) as f32;
        let margin = (side * MARGIN_FRACTION).round() as usize;
        let room = width.saturating_sub(2 * margin);
        let letters_size = (side * LETTERS_FRACTION).clamp(LETTERS.0, LETTERS.1).round();
        let mut letters = Letters::new();
        let texts = [Some((first, letters_size)), second.map(|text| (text, (letters_size * SECOND).round()))];
        let mut bottom = height.saturating_sub(margin);
        let mut lines = Vec::new();
        // From below.
        for (text, wanted) in texts.into_iter().flatten().rev() {
            let line = fitting(&mut letters, text, wanted, room);
            bottom = bottom.saturating_sub(line.size.1);
            lines.push(((margin, bottom), line));
        }
        Self { size: (width, height), lines, shadow: (letters_size / 18.0).ceil() as usize }
    }

    /// Draws it over a picture of RGBA bytes, premultiplied, the top row first; `strength` is 0 for nothing to 1.
    pub fn draw_over(&self, rgba: &mut [u8], strength: f32) {
        self.blend(rgba, self.shadow, 0.0, strength * (1.0 - SHADOW));
        self.blend(rgba, 0, 255.0, strength);
    }

    /// Blends a grey into what the letters cover, moved to the right and down.
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

/// A line of letters of the wanted size, or smaller to be at most `room` pixels wide; where they would become too small,
/// the text's end is left out.
fn fitting(letters: &mut Letters, text: &str, wanted: f32, room: usize) -> Line {
    let line = letters.line(text, wanted);
    if line.size.0 <= room {
        return line;
    }
    let smaller = (wanted * room as f32 / line.size.0 as f32).floor().max(wanted * 0.5).max(LETTERS.0);
    let mut kept: Vec<char> = text.chars().collect();
    let mut line = letters.line(text, smaller);
    while line.size.0 > room && !kept.is_empty() {
        // As much as is too wide, and the last letters one by one.
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

    /// How many pixels of a grey picture a caption changes, and the rightmost of them.
    fn changed(first: &str, size: (u32, u32), strength: f32) -> (usize, usize) {
        let grey = vec![90; 4 * (size.0 * size.1) as usize];
        let mut seen = grey.clone();
        Caption::new(first, Some("Somebody"), size).draw_over(&mut seen, strength);
        let differs = |index: &usize| seen[4 * index..4 * index + 4] != grey[4 * index..4 * index + 4];
        let places: Vec<usize> = (0..(size.0 * size.1) as usize).filter(differs).collect();
        (places.len(), places.iter().map(|place| place % size.0 as usize).max().unwrap_or(0))
    }

    #[test]
    fn letters_are_seen_as_strongly_as_asked() {
        let (whole, _) = changed("A song", (640, 360), 1.0);
        assert!(whole > 300, "{whole} pixels");
        assert_eq!(changed("A song", (640, 360), 0.0).0, 0);
        // A picture of one pixel has no room for a letter, which is no mistake.
        changed("A song", (1, 1), 1.0);
    }

    #[test]
    fn a_long_title_stays_within_the_picture() {
        let (pixels, right) = changed(&"Sonata ".repeat(40), (640, 360), 1.0);
        assert!(pixels > 300 && right < 640 - 20, "{pixels} pixels, the last in column {right}");
    }
}
