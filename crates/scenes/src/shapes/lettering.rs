//! Texts as outlines: fonts, the places of letters, and their paths.
//!
//! Letters are placed by the font's own rules (HarfBuzz's algorithms): pairs are kerned, and Arabic letters are joined.
//! Words that are written from right to left are in the order in which they are read. A letter that the font lacks comes
//! from another font.

use std::borrow::Cow;
use std::collections::BTreeSet;

use harfrust::{ShapeOptions, ShaperData, UnicodeBuffer};
use kurbo::{Affine, BezPath, Rect, Shape};
use mariana_render::reading_order::as_seen;
use mariana_render::system_fonts::SystemFonts;
use skrifa::instance::{LocationRef, Size};
use skrifa::outline::{DrawSettings, OutlinePen};
use skrifa::{FontRef, GlyphId, MetadataProvider};

use super::glyphs::{is_affordable, outlines};
use crate::limits;

/// The program's own fonts. The first one draws texts without a font.
const OWN: [&[u8]; 2] = [epaint_default_fonts::UBUNTU_LIGHT, epaint_default_fonts::HACK_REGULAR];
/// The height of capital letters in font sizes, if a font does not tell it.
const CAPITALS: f32 = 0.7;
/// Largest distance of a letter's outline from its origin, in heights of capital letters.
const REACH_MAX: f64 = 12.0;
/// Distance between lines, in heights of capital letters.
pub(super) const LINE: f64 = 1.7;

/// A font's file.
#[derive(Debug, Clone)]
pub(super) struct Font {
    data: Cow<'static, [u8]>,
    index: u32,
}

impl Font {
    /// Returns a font of a file; `None` if the file is no font.
    pub(super) fn of(data: Vec<u8>, index: u32) -> Option<Self> {
        let font = Self { data: Cow::Owned(data), index };
        font.face().map(|_| ())?;
        Some(font)
    }

    pub(super) fn own() -> Self {
        let [data, ..] = OWN;
        Self { data: Cow::Borrowed(data), index: 0 }
    }

    fn face(&self) -> Option<FontRef<'_>> {
        let face = FontRef::from_index(&self.data, self.index).ok()?;
        outlines(&face).is_some().then_some(face)
    }

    fn has(&self, letter: char) -> bool {
        self.face().is_some_and(|face| face.charmap().map(letter).is_some_and(|glyph| glyph.to_u32() != 0))
    }
}

/// A text's outline in heights of capital letters: y points up, and the origin is on the line, at the left.
#[derive(Debug, Clone, Default)]
pub(super) struct Line {
    pub path: BezPath,
    pub width: f64,
    /// Letters that no font has, in their order.
    pub missing: Vec<char>,
}

/// The fonts of a text: the chosen one, and others for the letters that it lacks.
#[derive(Debug)]
pub(super) struct Fonts<'f> {
    first: &'f Font,
    others: Vec<Font>,
}

impl<'f> Fonts<'f> {
    /// Chooses fonts for a text: the given font, the program's own fonts, and fonts of the system.
    pub(super) fn for_text(first: &'f Font, text: &str, system: &mut SystemFonts) -> Self {
        let mut fonts = Self { first, others: Vec::new() };
        let lacking = |fonts: &Self| -> BTreeSet<char> {
            let is_lacking =
                |letter: &char| !letter.is_whitespace() && !fonts.all().any(|font| font.has(*letter));
            text.chars().filter(|letter| !is_invisible(*letter)).filter(is_lacking).collect()
        };
        for data in OWN {
            if lacking(&fonts).is_empty() {
                return fonts;
            }
            fonts.others.push(Font { data: Cow::Borrowed(data), index: 0 });
        }
        let letters = lacking(&fonts);
        if !letters.is_empty() {
            let found = system.with_letters(&letters).into_iter();
            let found = found.map(|font| ((*font.data.font).as_ref().to_vec(), font.data.index));
            fonts.others.extend(found.filter_map(|(data, index)| Font::of(data, index)));
        }
        fonts
    }

    fn all(&self) -> impl Iterator<Item = &Font> {
        std::iter::once(self.first).chain(&self.others)
    }

    /// Returns the outline of one line.
    pub(super) fn line(&self, text: &str) -> Line {
        let mut line = Line::default();
        for word in as_seen(text).split_inclusive(' ') {
            let mut rest = word;
            while let Some(first) = rest.chars().next() {
                let font = self.of_letter(first);
                // Marks belong to the letter before.
                let same =
                    |letter: char| is_invisible(letter) || letter == ' ' || self.of_letter(letter) == font;
                let end = rest.char_indices().skip(1).find(|(_, letter)| !same(*letter));
                let (run, after) = rest.split_at(end.map_or(rest.len(), |(end, _)| end));
                rest = after;
                if let Some(font) = self.all().nth(font.unwrap_or(0)) {
                    line.add(font, run);
                }
                if font.is_none() {
                    line.missing.extend(run.chars().filter(|letter| !letter.is_whitespace()));
                }
            }
        }
        line
    }

    fn of_letter(&self, letter: char) -> Option<usize> {
        if letter.is_whitespace() || is_invisible(letter) {
            return Some(0);
        }
        self.all().position(|font| font.has(letter))
    }
}

fn is_invisible(letter: char) -> bool {
    letter.is_control()
        || matches!(letter, '\u{200B}'..='\u{200F}' | '\u{2060}'..='\u{206F}' | '\u{FE00}'..='\u{FE0F}')
}

impl Line {
    fn add(&mut self, font: &Font, run: &str) {
        let Some(face) = font.face() else { return };
        let unscaled = Size::unscaled();
        let metrics = face.metrics(unscaled, LocationRef::default());
        let per_em = f32::from(metrics.units_per_em).max(1.0);
        let capitals = metrics.cap_height.filter(|height| *height > 0.0).unwrap_or(CAPITALS * per_em);
        let scale = 1.0 / f64::from(capitals);
        let mut buffer = UnicodeBuffer::new();
        buffer.push_str(run);
        buffer.guess_segment_properties();
        let data = ShaperData::new(&face);
        let shaped = data.shaper(&face).build().shape(buffer, ShapeOptions::default());
        let Some(outlines) = outlines(&face) else { return };
        for (info, place) in shaped.glyph_infos().iter().zip(shaped.glyph_positions()) {
            let mut pen = Pen(BezPath::new());
            let glyph = Some(GlyphId::new(info.glyph_id)).filter(|glyph| is_affordable(&face, *glyph));
            let glyph = glyph.and_then(|glyph| outlines.get(glyph));
            let drawn = glyph.is_some_and(|glyph| {
                glyph.draw(DrawSettings::unhinted(unscaled, LocationRef::default()), &mut pen).is_ok()
            });
            let at = (self.width + f64::from(place.x_offset) * scale, f64::from(place.y_offset) * scale);
            let reach = |rect: Rect| {
                [rect.x0, rect.y0, rect.x1, rect.y1].into_iter().all(|end| (end * scale).abs() <= REACH_MAX)
            };
            let room = self.path.elements().len() + pen.0.elements().len() <= limits::TEXT_PARTS_MAX;
            if drawn && room && (pen.0.is_empty() || reach(pen.0.control_box())) {
                self.path.extend(Affine::translate(at) * (Affine::scale(scale) * pen.0));
            }
            self.width += (f64::from(place.x_advance) * scale).clamp(-REACH_MAX, REACH_MAX);
        }
        self.width = self.width.max(0.0);
    }

    /// The smallest box around the outline; `None` without one.
    pub(super) fn bounds(&self) -> Option<Rect> {
        (!self.path.is_empty()).then(|| self.path.bounding_box()).filter(|bounds| bounds.is_finite())
    }
}

struct Pen(BezPath);

impl OutlinePen for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        self.0.move_to((x, y));
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.0.line_to((x, y));
    }

    fn quad_to(&mut self, cx0: f32, cy0: f32, x: f32, y: f32) {
        self.0.quad_to((cx0, cy0), (x, y));
    }

    fn curve_to(&mut self, cx0: f32, cy0: f32, cx1: f32, cy1: f32, x: f32, y: f32) {
        self.0.curve_to((cx0, cy0), (cx1, cy1), (x, y));
    }

    fn close(&mut self) {
        self.0.close_path();
    }
}
