//! Draws letters on the CPU, in the overlay's font.

use std::collections::BTreeSet;
use std::sync::Arc;

use epaint::text::{FontDefinitions, Fonts, TextOptions};
use epaint::{Color32, ColorImage, FontId};

use crate::reading_order::as_seen;
use crate::system_fonts::SystemFonts;

pub(crate) struct Letters {
    fonts: Fonts,
    system: SystemFonts,
    /// Letters that have been searched for in the system's fonts.
    looked_for: BTreeSet<char>,
}

/// A line of text: the coverage of each pixel by its letters.
pub(crate) struct Line {
    /// Width and height in pixels.
    pub size: (usize, usize),
    /// Coverage, 0..255, row by row from the top.
    pub cover: Vec<u8>,
}

impl Default for Letters {
    fn default() -> Self {
        Self::with_fonts(SystemFonts::default())
    }
}

impl Letters {
    fn with_fonts(system: SystemFonts) -> Self {
        let fonts = Fonts::new(TextOptions::default(), FontDefinitions::default());
        Self { fonts, system, looked_for: BTreeSet::new() }
    }

    fn complete(&mut self, text: &str) {
        let mut fonts = self.fonts.with_pixels_per_point(1.0);
        let font = FontId::proportional(1.0);
        let lacks = |letter: &char| !letter.is_control() && !fonts.has_glyph(&font, *letter);
        let missing: BTreeSet<char> = text.chars().filter(lacks).collect();
        let missing: BTreeSet<char> = missing.difference(&self.looked_for).copied().collect();
        if missing.is_empty() {
            return;
        }
        let mut definitions = self.fonts.definitions().clone();
        for font in self.system.with_letters(&missing) {
            for behind in font.families {
                definitions.families.entry(behind.family).or_default().push(font.name.clone());
            }
            definitions.font_data.insert(font.name, Arc::new(font.data));
        }
        self.looked_for.extend(missing);
        self.fonts = Fonts::new(TextOptions::default(), definitions);
    }

    pub(crate) fn line(&mut self, text: &str, size: f32) -> Line {
        self.complete(text);
        let mut fonts = self.fonts.with_pixels_per_point(1.0);
        let galley =
            fonts.layout_no_wrap(as_seen(text).into_owned(), FontId::proportional(size), Color32::WHITE);
        let atlas: ColorImage = fonts.image();
        let extent = galley.size();
        let (width, height) = (extent.x.ceil() as usize + 1, extent.y.ceil() as usize + 1);
        let mut cover = vec![0_u8; width * height];
        for row in &galley.rows {
            for glyph in &row.row.glyphs {
                let letter = glyph.uv_rect;
                let corner = row.pos.to_vec2() + glyph.pos.to_vec2() + letter.offset;
                for y in letter.min[1]..letter.max[1] {
                    for x in letter.min[0]..letter.max[0] {
                        let column =
                            corner.x.round() as isize + isize::from((x - letter.min[0]).cast_signed());
                        let line = corner.y.round() as isize + isize::from((y - letter.min[1]).cast_signed());
                        let place = usize::try_from(column).ok().zip(usize::try_from(line).ok());
                        let Some((column, line)) = place.filter(|(column, _)| *column < width) else {
                            continue;
                        };
                        let from = usize::from(y) * atlas.size[0] + usize::from(x);
                        let (to, from) = (cover.get_mut(line * width + column), atlas.pixels.get(from));
                        if let (Some(to), Some(from)) = (to, from) {
                            // The three channels are equal except in coloured letters. Coloured letters become grey.
                            let [red, green, blue, _] = from.to_array().map(u16::from);
                            *to = (*to).max(((red + green + blue) / 3) as u8);
                        }
                    }
                }
            }
        }
        Line { size: (width, height), cover }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mariana_testing::tiny_font::{TinyFont, folder_of};

    #[test]
    fn captions_have_the_letters_of_the_system_in_reading_order() {
        let folder = folder_of(&[("tiny.ttf", TinyFont::new("Tiny", "日本שלום").bytes())]);
        let letters =
            |folder: &std::path::Path| Letters::with_fonts(SystemFonts::in_folder(Some(folder.to_owned())));
        let (mut found, mut missing) = (letters(folder.path()), letters(&folder.path().join("none")));
        for text in ["日本", "שלום"] {
            let (seen, boxes) = (found.line(text, 30.0), missing.line(text, 30.0));
            assert!(seen.cover.iter().any(|cover| *cover > 0), "{text}");
            assert_ne!(seen.cover, boxes.cover, "{text} is drawn as boxes");
        }
        // The letters differ in width, so the reversed text looks different.
        let backwards: String = "שלום".chars().rev().collect();
        assert_ne!(found.line("שלום", 30.0).cover, found.line(&backwards, 30.0).cover);
    }
}
