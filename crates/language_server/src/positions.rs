//! Positions of the protocol: lines, and columns in the units that client and server agreed on.

use std::ops::Range;

use mariana_editing::Buffer;
use serde::{Deserialize, Serialize};

/// The unit of [`Position::character`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum Unit {
    /// Bytes.
    Utf8,
    /// Units of UTF-16, which every client supports.
    #[default]
    Utf16,
    /// Characters.
    Utf32,
}

impl Unit {
    /// Returns the best of the units that a client offers. `offered` holds their names in the protocol.
    pub(crate) fn among(offered: &[String]) -> Self {
        let offers = |name: &str| offered.iter().any(|offer| offer == name);
        match () {
            () if offers("utf-8") => Self::Utf8,
            () if offers("utf-32") && !offers("utf-16") => Self::Utf32,
            () => Self::Utf16,
        }
    }

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Utf8 => "utf-8",
            Self::Utf16 => "utf-16",
            Self::Utf32 => "utf-32",
        }
    }

    fn length(self, letter: char) -> usize {
        match self {
            Self::Utf8 => letter.len_utf8(),
            Self::Utf16 => letter.len_utf16(),
            Self::Utf32 => 1,
        }
    }

    /// Returns the length of a text in this unit.
    pub(crate) fn length_of(self, text: &[u8]) -> usize {
        if self == Self::Utf8 || text.is_ascii() {
            return text.len();
        }
        String::from_utf8_lossy(text).chars().map(|letter| self.length(letter)).sum()
    }

    /// Returns the position of a byte offset.
    pub(crate) fn position(self, buffer: &Buffer, offset: usize) -> Position {
        let line = buffer.line_of(offset);
        let range = buffer.line_range(line);
        let before = buffer.slice(range.start..offset.min(range.end));
        Position { line: whole(line), character: whole(self.length_of(before)) }
    }

    /// Returns the range of byte offsets.
    pub(crate) fn range(self, buffer: &Buffer, range: Range<usize>) -> Span {
        Span { start: self.position(buffer, range.start), end: self.position(buffer, range.end) }
    }

    /// Returns the byte offset of a position. Positions behind the end of a line or of the text are moved to it.
    pub(crate) fn offset(self, buffer: &Buffer, position: Position) -> usize {
        let line = buffer.line_range(position.line as usize);
        let text = String::from_utf8_lossy(buffer.slice(line.clone()));
        let mut left = position.character as usize;
        let mut bytes = 0;
        for letter in text.chars() {
            let length = self.length(letter);
            if left < length {
                break;
            }
            left -= length;
            bytes += letter.len_utf8();
        }
        line.start + bytes.min(line.len())
    }
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
    fn offsets_become_positions_and_back_in_every_unit() {
        let text = "a\u{e4}\u{1f600}b\r\n\u{feff}x\n";
        let buffer = Buffer::new(text.as_bytes().to_vec());
        for unit in [Unit::Utf8, Unit::Utf16, Unit::Utf32] {
            for (offset, _) in text.char_indices().filter(|(_, letter)| *letter != '\n') {
                let position = unit.position(&buffer, offset);
                assert_eq!(unit.offset(&buffer, position), offset, "{unit:?} {offset}");
            }
        }
        let at = |unit: Unit| unit.position(&buffer, text.find('b').unwrap()).character;
        assert_eq!([Unit::Utf8, Unit::Utf16, Unit::Utf32].map(at), [7, 4, 3]);
        let end = Position { line: 9, character: 9 };
        assert_eq!(Unit::Utf16.offset(&buffer, end), text.len());
        let behind = Position { line: 0, character: 99 };
        assert_eq!(Unit::Utf16.offset(&buffer, behind), text.find('\r').unwrap());
        // The middle of a letter is its start.
        assert_eq!(Unit::Utf16.offset(&buffer, Position { line: 0, character: 3 }), 3);
    }

    #[test]
    fn the_shortest_offered_unit_is_taken() {
        let among =
            |names: &[&str]| Unit::among(&names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>());
        assert_eq!(among(&[]), Unit::Utf16);
        assert_eq!(among(&["utf-16", "utf-8"]), Unit::Utf8);
        assert_eq!(among(&["utf-32"]), Unit::Utf32);
        assert_eq!(among(&["utf-32", "utf-16"]), Unit::Utf16);
    }
}
