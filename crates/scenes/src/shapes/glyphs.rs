//! The work that a glyph asks for, counted before it is drawn: a font of a kilobyte can nest glyphs and subroutines so
//! that drawing one letter takes years.

use std::cell::Cell;

use skrifa::outline::{OutlineGlyphCollection, OutlineGlyphFormat};
use skrifa::raw::ps::cff::CffFontRef;
use skrifa::raw::ps::cff::blend::BlendState;
use skrifa::raw::ps::cff::dict::{self, Entry};
use skrifa::raw::ps::cff::index::Index;
use skrifa::raw::ps::cs::{self, CharstringContext, CharstringKind, CommandSink};
use skrifa::raw::ps::error::Error;
use skrifa::raw::tables::glyf::{Glyf, Glyph};
use skrifa::raw::tables::loca::Loca;
use skrifa::raw::types::Fixed;
use skrifa::raw::{ReadError, TableProvider as _};
use skrifa::{FontRef, GlyphId};

use crate::limits;

/// Formats of outlines that are read. Glyphs made of variable parts (`VARC`) are drawn by one of the others.
const FORMATS: [OutlineGlyphFormat; 3] =
    [OutlineGlyphFormat::Glyf, OutlineGlyphFormat::Cff2, OutlineGlyphFormat::Cff];

/// Returns the outlines of a font.
pub(super) fn outlines<'a>(face: &FontRef<'a>) -> Option<OutlineGlyphCollection<'a>> {
    FORMATS.into_iter().find_map(|format| OutlineGlyphCollection::with_format(face, format))
}

/// True if drawing the glyph takes little time.
pub(super) fn is_affordable(face: &FontRef<'_>, glyph: GlyphId) -> bool {
    let format = outlines(face).and_then(|outlines| outlines.format());
    match format {
        Some(OutlineGlyphFormat::Glyf) => {
            let (tables, mut left) = (face.loca(None).ok().zip(face.glyf().ok()), limits::GLYPH_PARTS_MAX);
            tables.is_some_and(|tables| has_few_parts(&tables, glyph, &mut left))
        }
        Some(OutlineGlyphFormat::Cff) => face.cff().is_ok_and(|cff| {
            let data = cff.offset_data().as_bytes();
            let top = cff.top_dicts().get(0).unwrap_or_default();
            CffFontRef::new_cff(data, 0, None).is_ok_and(|font| has_few_calls(&font, top, false, glyph))
        }),
        Some(OutlineGlyphFormat::Cff2) => face.cff2().is_ok_and(|cff| {
            let font = CffFontRef::new_cff2(cff.offset_data().as_bytes(), None);
            font.is_ok_and(|font| has_few_calls(&font, cff.top_dict_data(), true, glyph))
        }),
        Some(OutlineGlyphFormat::Varc) | None => false,
    }
}

/// Counts the glyphs of which a glyph is composed.
fn has_few_parts(tables: &(Loca<'_>, Glyf<'_>), glyph: GlyphId, left: &mut usize) -> bool {
    let Some(rest) = left.checked_sub(1) else { return false };
    *left = rest;
    match tables.0.get_glyf(glyph, &tables.1) {
        Ok(Some(Glyph::Composite(composite))) => {
            composite.component_glyphs_and_flags().all(|(part, _)| has_few_parts(tables, part.into(), left))
        }
        Ok(Some(Glyph::Simple(_)) | None) | Err(_) => true,
    }
}

/// Runs a glyph's program without drawing, and counts the bytes of the programs that it calls.
fn has_few_calls(font: &CffFontRef<'_>, top: &[u8], is_cff2: bool, glyph: GlyphId) -> bool {
    let Ok(program) = font.charstrings().get(glyph.to_u32() as usize) else { return false };
    let (local, variation) = font
        .subfont_index(glyph)
        .and_then(|part| private_dict(font, top, is_cff2, part))
        .unwrap_or((Index::Empty, 0));
    let calls = Calls {
        programs: (font.data(), font.charstrings(), font.global_subrs(), &local),
        left: Cell::new(limits::GLYPH_PROGRAM_BYTES_MAX.saturating_sub(program.len())),
    };
    // skrifa also refuses a program with an error.
    cs::evaluate(&calls, blend(font, variation), program, &mut Nothing).is_ok() && calls.left.get() > 0
}

fn blend<'a>(font: &CffFontRef<'a>, variation: u16) -> Option<BlendState<'a>> {
    BlendState::new(font.var_store()?.clone(), &[], variation).ok()
}

/// Returns the subroutines of a part of a font, and the index of its variations.
fn private_dict<'a>(font: &CffFontRef<'a>, top: &[u8], is_cff2: bool, part: u16) -> Option<(Index<'a>, u16)> {
    let data = font.data();
    let private = |dict: &[u8]| {
        dict::entries(dict, None).flatten().find_map(|entry| match entry {
            Entry::PrivateDictRange(range) => Some(range),
            _ => None,
        })
    };
    let parts = dict::entries(top, None).flatten().find_map(|entry| match entry {
        Entry::FdArrayOffset(offset) => Some(offset),
        _ => None,
    });
    let range = match parts {
        Some(offset) => private(Index::new(data.get(offset..)?, is_cff2).ok()?.get(part.into()).ok()?)?,
        None => private(top)?,
    };
    let (mut local, mut variation) = (Index::Empty, 0);
    for entry in dict::entries(data.get(range.clone())?, blend(font, 0)).flatten() {
        match entry {
            Entry::SubrsOffset(offset) => {
                local = Index::new(data.get(range.start.checked_add(offset)?..)?, is_cff2).ok()?;
            }
            Entry::VariationStoreIndex(index) => variation = index,
            _ => {}
        }
    }
    Some((local, variation))
}

struct Calls<'c> {
    /// All data, the glyphs' programs, and the global and the local subroutines.
    programs: (&'c [u8], &'c Index<'c>, &'c Index<'c>, &'c Index<'c>),
    /// Bytes of programs that may still be called; 0 if there were too many.
    left: Cell<usize>,
}

impl Calls<'_> {
    fn count<'p>(&self, program: &'p [u8]) -> Result<&'p [u8], Error> {
        self.left.set(self.left.get().saturating_sub(program.len() + 1));
        if self.left.get() == 0 { Err(ReadError::OutOfBounds.into()) } else { Ok(program) }
    }
}

impl CharstringContext for Calls<'_> {
    fn kind(&self) -> CharstringKind {
        CharstringKind::Type2
    }

    fn seac_components(&self, base: i32, accent: i32) -> Result<[&[u8]; 2], Error> {
        let [base, accent] = self.programs.seac_components(base, accent)?;
        Ok([self.count(base)?, self.count(accent)?])
    }

    fn global_subr(&self, index: i32) -> Result<&[u8], Error> {
        self.count(self.programs.global_subr(index)?)
    }

    fn subr(&self, index: i32) -> Result<&[u8], Error> {
        self.count(self.programs.subr(index)?)
    }
}

struct Nothing;

impl CommandSink for Nothing {
    fn move_to(&mut self, _: Fixed, _: Fixed) {}
    fn line_to(&mut self, _: Fixed, _: Fixed) {}
    fn curve_to(&mut self, _: Fixed, _: Fixed, _: Fixed, _: Fixed, _: Fixed, _: Fixed) {}
    fn close(&mut self) {}
}

#[cfg(test)]
mod tests {
    use mariana_testing::tiny_font::TinyFont;

    use super::*;

    #[test]
    fn a_font_of_two_kilobytes_took_years_to_draw_a_letter() {
        let letters: String = ('a'..='z').collect();
        for (parts, affordable) in [(1, true), (20, false)] {
            let bytes = TinyFont { parts, ..TinyFont::new("Nested", &letters) }.bytes();
            let face = FontRef::new(&bytes).unwrap();
            assert_eq!(is_affordable(&face, GlyphId::new(1)), affordable, "{parts} parts");
            assert!(is_affordable(&face, GlyphId::new(26)), "the last letter is a square");
        }
    }

    /// Programs, each behind its offset.
    fn index(programs: &[Vec<u8>]) -> Vec<u8> {
        let mut bytes = [&(programs.len() as u16).to_be_bytes()[..], &[2]].concat();
        let mut end = 1_u16;
        bytes.extend(end.to_be_bytes());
        for program in programs {
            end += program.len() as u16;
            bytes.extend(end.to_be_bytes());
        }
        bytes.extend(programs.concat());
        bytes
    }

    #[test]
    fn subroutines_that_call_each_other_are_counted() {
        for (calls, affordable) in [(1, true), (100, false)] {
            // Each subroutine calls the next one; 32 is the number of the first one, as a program writes it.
            let subroutine = |at: u8| [[at + 33, 29].repeat(calls), vec![11]].concat();
            let subroutines: Vec<Vec<u8>> = (0..8).map(subroutine).chain([vec![11]]).collect();
            let mut font = [vec![1, 0, 4, 1], index(&[b"a".to_vec()])].concat();
            let rest = [vec![0, 0], index(&subroutines)].concat();
            let top = |at: usize| [&[29][..], &(at as u32).to_be_bytes(), &[17]].concat();
            let programs_at = font.len() + index(&[top(0)]).len() + rest.len();
            font.extend(index(&[top(programs_at)]));
            font.extend(rest);
            font.extend(index(&[vec![32, 29, 14]]));
            let font = CffFontRef::new_cff(&font, 0, None).unwrap();
            assert_eq!(has_few_calls(&font, &[], false, GlyphId::new(0)), affordable, "{calls} calls");
        }
    }
}
