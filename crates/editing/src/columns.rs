//! Maps the characters of a line to fixed-width columns. A tab takes four columns, a wide character two, and a
//! combining mark takes no column. Bytes that are not UTF-8 are displayed as U+FFFD, but stay unchanged in the text.

use mariana_field::lang::columns;

/// Replacement character for bytes that are not UTF-8.
const NO_LETTER: char = '\u{fffd}';

/// A character with its combining marks, or a run of invalid bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cell {
    /// Byte offset of the cell's start in the line.
    pub start: usize,
    /// Byte offset of the cell's end in the line.
    pub end: usize,
    /// First column.
    pub column: usize,
    /// Width in columns.
    pub width: usize,
    /// True for valid UTF-8; false if the replacement character is displayed.
    pub is_text: bool,
}

/// Splits a line into cells.
pub fn cells(line: &[u8]) -> impl Iterator<Item = Cell> {
    let mut letters = letters(line).peekable();
    let mut column = 0;
    std::iter::from_fn(move || {
        let (start, mut end, letter) = letters.next()?;
        let is_text = letter.is_some();
        let mut width = columns(letter.unwrap_or(NO_LETTER));
        while let Some((_, next, _)) =
            letters.next_if(|(_, _, letter)| is_text && letter.is_some_and(|letter| columns(letter) == 0))
        {
            end = next;
        }
        // A combining mark without a base character gets a column, so that the user can delete it.
        width = width.max(usize::from(start > 0 || letter != Some('\u{feff}')));
        let cell = Cell { start, end, column, width, is_text };
        column += width;
        Some(cell)
    })
}

/// Splits `line` into pieces, each with its start, end and character. A run of invalid bytes has no character.
fn letters(line: &[u8]) -> impl Iterator<Item = (usize, usize, Option<char>)> {
    let mut at = 0;
    line.utf8_chunks().flat_map(move |chunk| {
        let (valid, invalid) = (chunk.valid(), chunk.invalid());
        let start = at;
        at += valid.len() + invalid.len();
        let of_text = valid
            .char_indices()
            .map(move |(index, letter)| (start + index, start + index + letter.len_utf8(), Some(letter)));
        let behind = start + valid.len();
        of_text.chain((!invalid.is_empty()).then_some((behind, behind + invalid.len(), None)))
    })
}

/// The width of a line in columns.
pub fn width(line: &[u8]) -> usize {
    column_of(line, line.len())
}

/// Returns the column of the cell that contains byte `offset` of `line`. At the line's end, the line's width.
pub fn column_of(line: &[u8], offset: usize) -> usize {
    if line.is_ascii() && !line.iter().any(|byte| *byte < b' ' || *byte == 0x7f) {
        return offset.min(line.len());
    }
    let mut behind = 0;
    for cell in cells(line) {
        if cell.end > offset {
            return cell.column;
        }
        behind = cell.column + cell.width;
    }
    behind
}

/// Returns the byte offset of the cell whose left edge is nearest to `column`; beyond all cells, `line`'s length.
pub fn offset_of(line: &[u8], column: f32) -> usize {
    for cell in cells(line) {
        if column < cell.column as f32 + 0.5 * cell.width as f32 {
            return cell.start;
        }
    }
    line.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tabs_wide_letters_accents_and_broken_bytes_have_their_columns() {
        let line = "\ta球e\u{301}".bytes().chain([0xff, b'x']).collect::<Vec<u8>>();
        let seen: Vec<_> =
            cells(&line).map(|cell| (cell.column, cell.width, cell.end - cell.start)).collect();
        assert_eq!(seen, [(0, 4, 1), (4, 1, 1), (5, 2, 3), (7, 1, 3), (8, 1, 1), (9, 1, 1)]);
        assert_eq!(cells(&line).filter(|cell| !cell.is_text).count(), 1);
        assert_eq!(width(&line), 10);
        assert_eq!([0, 1, 2, 3, 5, 8, 9, 99].map(|at| column_of(&line, at)), [0, 4, 5, 5, 7, 8, 9, 10]);
        assert_eq!(
            [0.0, 1.9, 2.1, 5.5, 6.1, 99.0].map(|column| offset_of(&line, column)),
            [0, 0, 1, 2, 5, 10]
        );
        assert_eq!((width(b""), offset_of(b"", 3.0)), (0, 0));
    }
}
