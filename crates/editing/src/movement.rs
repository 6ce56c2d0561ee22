//! Cursor movement.

use crate::buffer::Buffer;
use crate::columns::{cells, column_of, offset_of};

/// A movement of the cursor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Move {
    /// To the previous letter.
    Left,
    /// To the next letter.
    Right,
    /// To the start of this or the previous word.
    WordLeft,
    /// To the end of this or the next word.
    WordRight,
    /// Up by a number of lines.
    Up(usize),
    /// Down by a number of lines.
    Down(usize),
    /// To the line's first letter that is not a blank. If the cursor is there already, to the line's start.
    LineStart,
    /// To the end of the line.
    LineEnd,
    /// To the start of the text.
    Start,
    /// To the end of the text.
    End,
}

pub(crate) fn before(buffer: &Buffer, offset: usize) -> usize {
    let line = buffer.line_of(offset);
    let range = buffer.line_range(line);
    if offset <= range.start {
        return if line == 0 { 0 } else { buffer.line_range(line - 1).end };
    }
    let inside = offset.min(range.end) - range.start;
    let last = cells(buffer.line(line)).take_while(|cell| cell.start < inside).last();
    let last = last.map_or(0, |cell| cell.start);
    if offset > range.end { range.end } else { range.start + last }
}

pub(crate) fn behind(buffer: &Buffer, offset: usize) -> usize {
    let line = buffer.line_of(offset);
    let range = buffer.line_range(line);
    if offset >= range.end {
        return if line + 1 < buffer.line_count() { buffer.line_start(line + 1) } else { buffer.len() };
    }
    let inside = offset - range.start;
    let next = cells(buffer.line(line)).find(|cell| cell.end > inside);
    next.map_or(range.end, |cell| range.start + cell.end)
}

fn in_word(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || byte == b'_' || byte >= 0x80
}

pub(crate) fn word_before(buffer: &Buffer, offset: usize) -> usize {
    let text = buffer.slice(0..offset).trim_ascii_end();
    let Some(is_word) = text.last().map(|last| in_word(*last)) else { return 0 };
    let ends = |byte: &u8| in_word(*byte) != is_word || byte.is_ascii_whitespace();
    text.iter().rposition(ends).map_or(0, |at| at + 1)
}

pub(crate) fn word_behind(buffer: &Buffer, offset: usize) -> usize {
    let text = buffer.slice(offset..buffer.len()).trim_ascii_start();
    let Some(is_word) = text.first().map(|first| in_word(*first)) else { return buffer.len() };
    let ends = |byte: &u8| in_word(*byte) != is_word || byte.is_ascii_whitespace();
    buffer.len() - text.len() + text.iter().position(ends).unwrap_or(text.len())
}

pub(crate) fn word_around(buffer: &Buffer, offset: usize) -> std::ops::Range<usize> {
    let range = buffer.line_range(buffer.line_of(offset));
    let line = buffer.slice(range.clone());
    let inside = offset.min(range.end) - range.start;
    let class = |byte: &u8| (in_word(*byte), byte.is_ascii_whitespace());
    let Some(here) = line.get(inside).or_else(|| line.get(inside.checked_sub(1)?)).map(class) else {
        return range.start..range.start;
    };
    let before = line.get(..inside).unwrap_or_default();
    let start = before.iter().rposition(|byte| class(byte) != here).map_or(0, |at| at + 1);
    let rest = line.get(inside..).unwrap_or_default();
    let end = rest.iter().position(|byte| class(byte) != here).map_or(line.len(), |at| inside + at);
    range.start + start..range.start + end
}

/// Returns the target of a move from `offset`, and the column that later moves up or down try to keep.
pub(crate) fn follow(
    buffer: &Buffer,
    offset: usize,
    way: Move,
    goal: Option<usize>,
) -> (usize, Option<usize>) {
    let line = buffer.line_of(offset);
    let range = buffer.line_range(line);
    let column = || goal.unwrap_or_else(|| column_of(buffer.line(line), offset - range.start));
    let in_line =
        |line: usize, column: usize| buffer.line_start(line) + offset_of(buffer.line(line), column as f32);
    let place = match way {
        Move::Left => before(buffer, offset),
        Move::Right => behind(buffer, offset),
        Move::WordLeft => word_before(buffer, offset),
        Move::WordRight => word_behind(buffer, offset),
        Move::Up(_) if line == 0 => return (0, Some(column())),
        Move::Up(count) => return (in_line(line.saturating_sub(count), column()), Some(column())),
        Move::Down(_) if line + 1 >= buffer.line_count() => return (buffer.len(), Some(column())),
        Move::Down(count) => {
            return (in_line((line + count).min(buffer.line_count() - 1), column()), Some(column()));
        }
        Move::LineStart => {
            let text = buffer.line(line);
            let indent = text.iter().position(|byte| !matches!(byte, b' ' | b'\t')).unwrap_or(text.len());
            if offset == range.start + indent { range.start } else { range.start + indent }
        }
        Move::LineEnd => range.end,
        Move::Start => 0,
        Move::End => buffer.len(),
    };
    (place, None)
}
