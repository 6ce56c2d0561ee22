//! Positions of the protocol: lines, and columns in units of UTF-16, which every client supports.

use std::ops::Range;

use mariana_editing::Buffer;
use serde::{Deserialize, Serialize};

/// Returns the number of units of UTF-16 in a text.
pub(crate) fn units(text: &[u8]) -> usize {
    if text.is_ascii() {
        return text.len();
    }
    String::from_utf8_lossy(text).chars().map(char::len_utf16).sum()
}

/// Returns the position of a byte offset.
pub(crate) fn position(buffer: &Buffer, offset: usize) -> Position {
    let line = buffer.line_of(offset);
    let range = buffer.line_range(line);
    let before = buffer.slice(range.start..offset.min(range.end));
    Position { line: whole(line), character: whole(units(before)) }
}

/// Returns the range of byte offsets.
pub(crate) fn range(buffer: &Buffer, range: Range<usize>) -> Span {
    Span { start: position(buffer, range.start), end: position(buffer, range.end) }
}

/// Returns the byte offset of a position. Positions behind the end of a line or of the text are moved to it.
pub(crate) fn offset(buffer: &Buffer, position: Position) -> usize {
    let line = buffer.line_range(position.line as usize);
    let text = String::from_utf8_lossy(buffer.slice(line.clone()));
    let mut left = position.character as usize;
    let mut bytes = 0;
    for letter in text.chars() {
        if left < letter.len_utf16() {
            break;
        }
        left -= letter.len_utf16();
        bytes += letter.len_utf8();
    }
    line.start + bytes.min(line.len())
}

fn whole(number: usize) -> u32 {
    u32::try_from(number).unwrap_or(u32::MAX)
}

/// A position in a document.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Serialize, Deserialize)]
pub(crate) struct Position {
    /// The line, from 0.
    pub line: u32,
    /// Units before the position in its line.
    pub character: u32,
}

/// A range of positions; `end` is exclusive.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub(crate) struct Span {
    pub start: Position,
    pub end: Position,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn offsets_become_positions_and_back() {
        let text = "a\u{e4}\u{1f600}b\r\n\u{feff}x\n";
        let buffer = Buffer::new(text.as_bytes().to_vec());
        for (at, _) in text.char_indices().filter(|(_, letter)| *letter != '\n') {
            assert_eq!(offset(&buffer, position(&buffer, at)), at);
        }
        assert_eq!(position(&buffer, text.find('b').unwrap()).character, 4);
        assert_eq!(offset(&buffer, Position { line: 9, character: 9 }), text.len());
        let behind = Position { line: 0, character: 99 };
        assert_eq!(offset(&buffer, behind), text.find('\r').unwrap());
        // The middle of a letter is its start.
        assert_eq!(offset(&buffer, Position { line: 0, character: 3 }), 3);
    }
}
