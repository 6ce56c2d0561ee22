//! Minimal fonts for tests. Each of the few letters is a square of a different size.

use tempfile::TempDir;

/// The content of a font.
pub struct TinyFont<'a> {
    /// Name of the font family.
    pub name: &'a str,
    /// Language of the name, as a Windows language id.
    pub language: u16,
    /// The letters of the font.
    pub letters: &'a str,
    /// Side of the first letter's square in units of 1/1000 em. The square of each further letter is 200 units
    /// smaller.
    pub side: i16,
    /// Number of copies of the next letter of which each letter but the last one is composed; 0 for squares alone.
    pub parts: u16,
}

impl<'a> TinyFont<'a> {
    /// A font with an English name.
    pub fn new(name: &'a str, letters: &'a str) -> Self {
        Self { name, language: 0x409, letters, side: 800, parts: 0 }
    }

    /// Returns a TrueType file, according to <https://learn.microsoft.com/typography/opentype/spec/>.
    pub fn bytes(&self) -> Vec<u8> {
        let mut letters: Vec<char> = self.letters.chars().collect();
        letters.sort_unstable();
        let count = letters.len() as u16 + 1;
        // Glyph 0 is the box for missing glyphs.
        let mut outlines = Vec::new();
        let mut places = Vec::new();
        for place in 0..count as i16 {
            places.extend((outlines.len() as u32).to_be_bytes());
            let is_composed = self.parts > 0 && (1..count as i16 - 1).contains(&place);
            outlines.extend(match place {
                place if is_composed => composed(place.cast_unsigned() + 1, self.parts),
                0 => square(300),
                place => square(self.side.wrapping_sub(place.wrapping_sub(1).wrapping_mul(200))),
            });
        }
        places.extend((outlines.len() as u32).to_be_bytes());
        let widths: Vec<u8> = (0..count).flat_map(|_| words(&[1_000, 0])).collect();
        let head =
            [words(&[1, 0, 1, 0, 0, 0, 0x5F0F, 0x3CF5, 0, 1_000]), vec![0; 16], words(&[0, 0, 900, 900])];
        let head = [head.concat(), words(&[0, 8, 2, 1, 0])].concat();
        let hhea = [words(&[1, 0, 800, (-200_i16).cast_unsigned(), 0, 1_000]), vec![0; 22], words(&[count])];
        let maxp = [words(&[1, 0, count, 4, 1, 0, 0, 1]), vec![0; 16]];
        assemble(&[
            (b"cmap", code_map(&letters)),
            (b"glyf", outlines),
            (b"head", head),
            (b"hhea", hhea.concat()),
            (b"hmtx", widths),
            (b"loca", places),
            (b"maxp", maxp.concat()),
            (b"name", names(self.name, self.language)),
        ])
    }
}

/// Creates a folder with these files.
pub fn folder_of(files: &[(&str, Vec<u8>)]) -> TempDir {
    let folder = tempfile::tempdir().expect("the temporary folder can be created");
    for (name, bytes) in files {
        std::fs::write(folder.path().join(name), bytes).expect("the file can be written");
    }
    folder
}

fn words(values: &[u16]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_be_bytes()).collect()
}

/// Returns the outline of a square: one contour with four points.
fn square(side: i16) -> Vec<u8> {
    let (side, back) = (side.cast_unsigned(), (-side).cast_unsigned());
    let mut bytes = words(&[1, 0, 0, side, side, 3, 0]);
    bytes.extend([1; 4]);
    bytes.extend(words(&[0, side, 0, back]));
    bytes.extend(words(&[0, 0, side, 0]));
    bytes
}

/// Returns a glyph that consists of copies of another one.
fn composed(of: u16, parts: u16) -> Vec<u8> {
    let mut bytes = words(&[0xFFFF, 0, 0, 900, 900]);
    for part in 0..parts {
        // Two bytes are the place; another part follows.
        let flags = if part + 1 < parts { 0x22 } else { 0x02 };
        bytes.extend(words(&[flags, of, 0]));
    }
    bytes
}

/// A `cmap` subtable of format 12, with one group for each letter.
fn code_map(letters: &[char]) -> Vec<u8> {
    let groups = letters.len() as u32;
    let mut bytes = words(&[0, 1, 3, 10, 0, 12, 12, 0]);
    for value in [16 + 12 * groups, 0, groups] {
        bytes.extend(value.to_be_bytes());
    }
    for (at, letter) in letters.iter().enumerate() {
        let code = u32::from(*letter);
        for value in [code, code, at as u32 + 1] {
            bytes.extend(value.to_be_bytes());
        }
    }
    bytes
}

/// The family name, and the PostScript name, which has no spaces.
fn names(name: &str, language: u16) -> Vec<u8> {
    let texts =
        [name.to_owned(), name.replace(' ', "")].map(|text| words(&text.encode_utf16().collect::<Vec<_>>()));
    let lengths = texts.each_ref().map(|text| text.len() as u16);
    let mut bytes = words(&[0, 2, 30]);
    bytes.extend(words(&[3, 1, language, 1, lengths[0], 0]));
    bytes.extend(words(&[3, 1, language, 6, lengths[1], lengths[0]]));
    bytes.extend(texts.concat());
    bytes
}

fn assemble(tables: &[(&[u8; 4], Vec<u8>)]) -> Vec<u8> {
    let count = tables.len() as u16;
    let mut bytes = words(&[1, 0, count, 0, 0, 0]);
    let mut body = Vec::new();
    for (tag, table) in tables {
        bytes.extend(*tag);
        let start = 12 + 16 * u32::from(count) + body.len() as u32;
        for value in [0, start, table.len() as u32] {
            bytes.extend(value.to_be_bytes());
        }
        body.extend(table);
        body.resize(body.len().next_multiple_of(4), 0);
    }
    bytes.extend(body);
    bytes
}
