//! System fonts for letters that the program's own fonts lack, such as Japanese, Arabic and emoji.
//!
//! The search reads folders and files, so time-critical callers run it on another thread. The search skips damaged
//! files, and letters that a font would draw many times larger than usual.

use std::cmp::Reverse;
use std::collections::BTreeSet;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use epaint::text::{FontData, FontInsert, FontPriority, InsertFontFamily};
use fontdb::{Database, FaceInfo, ID, Source, Stretch, Style};
use skrifa::instance::{LocationRef, Size};
use skrifa::{FontRef, MetadataProvider};

use crate::limits;

/// Largest distance of a letter's outline from its origin, in font sizes.
const LETTER_REACH_MAX: f32 = 8.0;

/// A script with Han unification: the prefix of its locales, its fonts' language, and the suffix of the fonts' names.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Writing(&'static str, &'static str, &'static str);

const JAPANESE: Writing = Writing("ja", "Japanese", " JP");
const KOREAN: Writing = Writing("ko", "Korean", " KR");
const WRITINGS: [Writing; 5] = [
    JAPANESE,
    KOREAN,
    Writing("zh_TW", "Chinese", " TC"),
    Writing("zh_HK", "Chinese", " HK"),
    Writing("zh", "Chinese", " SC"),
];

/// The system's fonts, and a record of the fonts in use.
pub struct SystemFonts {
    /// The only folder to search; `None` searches the system's folders.
    folder: Option<PathBuf>,
    /// The list of fonts, which is read when it is first needed.
    database: Option<Database>,
    writing: Option<Writing>,
    taken: Vec<ID>,
    bytes_left: u64,
}

struct Candidate {
    id: ID,
    has: Vec<char>,
    rank: Rank,
}

/// Order of fonts that cover equally many letters: by script, upright, weight, width, proportional, sans-serif.
type Rank = (bool, bool, Reverse<u16>, Reverse<u16>, bool, bool);

impl SystemFonts {
    /// Prepares a search of the fonts in `folder` and its subfolders. Fonts are read at the first search.
    pub fn in_folder(folder: Option<PathBuf>) -> Self {
        Self {
            folder,
            database: None,
            writing: None,
            taken: Vec::new(),
            bytes_left: limits::SYSTEM_FONTS_BYTES_MAX,
        }
    }

    /// Chooses unused fonts that together cover as many of `letters` as possible. The font with most letters is first.
    /// Logs letters that no font has.
    pub fn with_letters(&mut self, letters: &BTreeSet<char>) -> Vec<FontInsert> {
        let folder = self.folder.as_deref();
        let database = self.database.get_or_insert_with(|| read_fonts(folder));
        let writing = writing_among(letters).or(self.writing);
        let faces = database.faces().filter(|face| !self.taken.contains(&face.id));
        let mut candidates: Vec<Candidate> = faces
            .filter_map(|face| {
                let has = letters_in(database, face.id, letters);
                (!has.is_empty()).then(|| Candidate { id: face.id, has, rank: rank(face, writing) })
            })
            .collect();
        let mut missing = letters.clone();
        let mut found = Vec::new();
        while !missing.is_empty() && self.taken.len() < limits::SYSTEM_FONTS_MAX {
            for candidate in &mut candidates {
                candidate.has.retain(|letter| missing.contains(letter));
            }
            candidates.retain(|candidate| !candidate.has.is_empty());
            let best =
                (0..candidates.len()).max_by_key(|&at| (candidates[at].has.len(), candidates[at].rank));
            let Some(best) = best.map(|at| candidates.swap_remove(at)) else { break };
            let Some(face) = database.face(best.id) else { continue };
            if let Some((font, bytes)) = insert(face, self.bytes_left) {
                tracing::info!("using the font {} for missing letters", font.name);
                self.taken.push(best.id);
                self.bytes_left -= bytes;
                missing.retain(|letter| !best.has.contains(letter));
                found.push(font);
            }
        }
        if !missing.is_empty() {
            let letters: Vec<String> =
                missing.iter().map(|letter| format!("{letter} (U+{:04X})", u32::from(*letter))).collect();
            tracing::warn!("no font of this system has {}: boxes are shown instead", letters.join(", "));
        }
        found
    }

    /// Reads the system font with this name: a family such as `DejaVu Sans`, a family with a style such as `DejaVu Sans
    /// Bold`, or a full name. Spaces, hyphens and case do not matter. Returns the file and the number of the font in it.
    /// `None` if there is no such font, or if it is unreadable or larger than the limit.
    pub fn named(&mut self, name: &str) -> Option<(Vec<u8>, u32)> {
        let folder = self.folder.as_deref();
        let database = self.database.get_or_insert_with(|| read_fonts(folder));
        let wanted = plain(name);
        let of_family = |face: &&FaceInfo| {
            face.families.iter().any(|(family, _)| {
                let family = plain(family);
                let bold = format!("{family}bold");
                let is_bold = face.weight.0 >= 600 && face.style == Style::Normal;
                family == wanted || (is_bold && bold == wanted)
            })
        };
        let full = database.faces().find(|face| plain(&face.post_script_name) == wanted);
        let face = full.or_else(|| database.faces().filter(of_family).max_by_key(|face| rank(face, None)))?;
        let index = face.index;
        let (font, _) = insert(face, limits::SYSTEM_FONTS_BYTES_MAX)?;
        Some(((*font.data.font).as_ref().to_vec(), index))
    }

    /// The names of the system's font families.
    pub fn families(&mut self) -> BTreeSet<String> {
        let folder = self.folder.as_deref();
        let database = self.database.get_or_insert_with(|| read_fonts(folder));
        database.faces().flat_map(|face| &face.families).map(|(name, _)| name.clone()).collect()
    }
}

/// A font's name without spaces, hyphens and case.
fn plain(name: &str) -> String {
    name.chars().filter(|letter| !matches!(letter, ' ' | '-' | '_')).flat_map(char::to_lowercase).collect()
}

impl Default for SystemFonts {
    /// Prepares a search of the system's fonts, for the user's language. Fonts are read at the first search.
    fn default() -> Self {
        let variables = ["LC_ALL", "LC_CTYPE", "LANG"].map(|name| std::env::var(name).unwrap_or_default());
        let locale = variables.iter().find(|value| !value.is_empty());
        Self { writing: locale.and_then(|locale| writing_of(locale)), ..Self::in_folder(None) }
    }
}

fn read_fonts(folder: Option<&Path>) -> Database {
    let mut database = Database::new();
    match folder {
        Some(folder) => database.load_fonts_dir(folder),
        None => database.load_system_fonts(),
    }
    tracing::debug!("the system has {} fonts", database.len());
    database
}

fn writing_of(locale: &str) -> Option<Writing> {
    WRITINGS.into_iter().find(|writing| locale.starts_with(writing.0))
}

/// The script that letters identify: kana occur only in Japanese, and Korean syllables only in Korean.
fn writing_among(letters: &BTreeSet<char>) -> Option<Writing> {
    let any = |first: char, last: char| letters.range(first..=last).next().is_some();
    if any('\u{3041}', '\u{30FF}') { Some(JAPANESE) } else { any('\u{AC00}', '\u{D7A3}').then_some(KOREAN) }
}

fn rank(face: &FaceInfo, writing: Option<Writing>) -> Rank {
    let is_of = |Writing(_, language, end): Writing| {
        face.families.iter().any(|(name, of)| name.ends_with(end) || of.primary_language() == language)
    };
    let stretch = face.stretch.to_number().abs_diff(Stretch::Normal.to_number());
    let serifs = face.families.iter().any(|(name, _)| name.contains("Serif") || name.contains("Mincho"));
    (
        writing.is_some_and(is_of),
        face.style == Style::Normal,
        Reverse(face.weight.0.abs_diff(400)),
        Reverse(stretch),
        !face.monospaced,
        !serifs,
    )
}

fn letters_in(database: &Database, id: ID, letters: &BTreeSet<char>) -> Vec<char> {
    let drawn = database.with_face_data(id, |data, index| {
        let Ok(font) = FontRef::from_index(data, index) else { return Vec::new() };
        letters.iter().copied().filter(|letter| can_draw(&font, *letter)).collect()
    });
    drawn.unwrap_or_default()
}

/// True if `font` has a bitmap, a colour glyph or an outline of normal size for `letter`.
fn can_draw(font: &FontRef<'_>, letter: char) -> bool {
    let Some(glyph) = font.charmap().map(letter).filter(|glyph| glyph.to_u32() != 0) else { return false };
    let has_bitmap = font.bitmap_strikes().glyph_for_size(Size::new(64.0), glyph).is_some();
    if has_bitmap || font.color_glyphs().get(glyph).is_some() {
        return true;
    }
    // Size 1 gives metrics in font sizes.
    let metrics = font.glyph_metrics(Size::new(1.0), LocationRef::default());
    let fits = metrics.bounds(glyph).is_some_and(|bounds| {
        [bounds.x_min, bounds.y_min, bounds.x_max, bounds.y_max]
            .into_iter()
            .all(|edge| edge.abs() <= LETTER_REACH_MAX)
    });
    fits && font.outline_glyphs().get(glyph).is_some()
}

/// The font for egui, with lowest priority, and its size in bytes. `None` if the font is unreadable or larger than
/// `bytes_max`.
fn insert(face: &FaceInfo, bytes_max: u64) -> Option<(FontInsert, u64)> {
    let (Source::File(path) | Source::SharedFile(path, _)) = &face.source else { return None };
    let mut data = Vec::new();
    File::open(path).ok()?.take(bytes_max.saturating_add(1)).read_to_end(&mut data).ok()?;
    let bytes = data.len() as u64;
    if bytes > bytes_max || FontRef::from_index(&data, face.index).is_err() {
        tracing::debug!("skipping {}: the font is damaged or too large", path.display());
        return None;
    }
    let behind = |family| InsertFontFamily { family, priority: FontPriority::Lowest };
    let font = FontInsert {
        name: format!("{} ({})", face.post_script_name, path.display()),
        data: FontData { index: face.index, ..FontData::from_owned(data) },
        families: vec![behind(epaint::FontFamily::Proportional), behind(epaint::FontFamily::Monospace)],
    };
    Some((font, bytes))
}

#[cfg(test)]
mod tests {
    use super::*;
    use mariana_testing::tiny_font::{TinyFont, folder_of};

    fn found(fonts: &mut SystemFonts, letters: &str) -> Vec<String> {
        let found = fonts.with_letters(&letters.chars().collect());
        found.into_iter().map(|font| font.name.split(' ').next().unwrap_or_default().to_owned()).collect()
    }

    #[test]
    fn few_fonts_cover_all_letters_and_each_is_returned_once() {
        let folder = folder_of(&[
            ("a.ttf", TinyFont::new("Few", "日").bytes()),
            ("b.ttf", TinyFont::new("Most", "日本語").bytes()),
            ("c.otf", TinyFont::new("Hangul", "한日").bytes()),
        ]);
        let mut fonts = SystemFonts::in_folder(Some(folder.path().to_owned()));
        assert_eq!(found(&mut fonts, "日本語한ب"), ["Most", "Hangul"]);
        assert_eq!(found(&mut fonts, "日"), ["Few"], "the remaining fonts are in use already");
        assert_eq!(found(&mut fonts, "ب"), [""; 0]);
    }

    #[test]
    fn one_code_looks_different_in_different_languages() {
        let folder = folder_of(&[
            ("c.ttf", TinyFont::new("Some CJK SC", "骨あ한").bytes()),
            ("j.ttf", TinyFont::new("Some CJK JP", "骨あ한").bytes()),
            ("k.ttf", TinyFont { language: 0x412, ..TinyFont::new("Myeongjo", "骨あ한") }.bytes()),
        ]);
        let first = |letters: &str, locale: &str| {
            let mut fonts = SystemFonts::in_folder(Some(folder.path().to_owned()));
            fonts.writing = writing_of(locale);
            found(&mut fonts, letters)
        };
        assert_eq!(first("骨", "zh_CN.UTF-8"), ["SomeCJKSC"]);
        assert_eq!(first("骨", "ja_JP.UTF-8"), ["SomeCJKJP"]);
        assert_eq!(first("骨", "ko_KR.UTF-8"), ["Myeongjo"]);
        assert_eq!(first("骨あ", "zh_CN.UTF-8"), ["SomeCJKJP"], "kana identify the title as Japanese");
        assert_eq!(first("骨한", "C"), ["Myeongjo"]);
    }

    #[test]
    fn damaged_fonts_are_skipped() {
        let whole = TinyFont::new("Whole", "日").bytes();
        let cut = |bytes: usize| whole[..bytes].to_vec();
        let mut damaged: Vec<(String, Vec<u8>)> =
            (0..whole.len()).step_by(7).map(|bytes| (format!("{bytes}.ttf"), cut(bytes))).collect();
        for at in (0..whole.len()).step_by(3) {
            let mut bytes = whole.clone();
            bytes[at] = !bytes[at];
            // Damage inside the font's name would change the expected result.
            damaged.push((format!("x{at}.ttf"), bytes));
        }
        damaged.push(("huge.ttf".into(), TinyFont { side: 9_000, ..TinyFont::new("Huge", "語") }.bytes()));
        let files: Vec<(&str, Vec<u8>)> =
            damaged.iter().map(|(name, bytes)| (name.as_str(), bytes.clone())).collect();
        let folder = folder_of(&files);
        let mut fonts = SystemFonts::in_folder(Some(folder.path().to_owned()));
        assert_eq!(found(&mut fonts, "語"), [""; 0], "a letter of nine sizes");
        // Some damage is harmless, but the font must have the letter.
        assert!(found(&mut fonts, "日").len() <= 1);
        let mut nothing = SystemFonts::in_folder(Some(folder.path().join("nothing")));
        assert_eq!(found(&mut nothing, "日"), [""; 0]);
    }
}
