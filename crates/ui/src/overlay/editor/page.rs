//! The visible rows of a text: converts positions in the text to positions on the screen, and back.

use std::ops::Range;

use egui::{Pos2, Rect, Vec2, vec2};
use mariana_editing::{Buffer, column_of, offset_of};

use crate::editor::{RowPosition, Wrapping, row_of};

pub(super) struct Page {
    /// The area of the letters, without line numbers.
    pub rect: Rect,
    pub cell: Vec2,
    wrapping: Wrapping,
    top: RowPosition,
    /// The visible lines.
    pub seen: Range<usize>,
    lines: Vec<Rows>,
}

/// The rows of a visible line.
struct Rows {
    /// Rows from the upper edge of the page to the line; negative for a line that begins above the page.
    top: f32,
    /// The column at which each row begins.
    starts: Vec<usize>,
}

impl Page {
    pub(super) fn new(
        rect: Rect,
        cell: Vec2,
        wrapping: Wrapping,
        buffer: &Buffer,
        view: RowPosition,
    ) -> Self {
        // The text may have become shorter since the last scrolling.
        let top = wrapping.moved(buffer, view, 0.0);
        let first = top.0 as usize;
        let (mut lines, mut below) = (Vec::new(), -top.1);
        for line in first..buffer.line_count() {
            if below * cell.y > rect.height() {
                break;
            }
            let starts = wrapping.starts(buffer.line(line));
            let rows = starts.len() as f32;
            lines.push(Rows { top: below, starts });
            below += rows;
        }
        Self { rect, cell, wrapping, top, seen: first..first + lines.len(), lines }
    }

    fn rows(&self, line: usize) -> Option<&Rows> {
        self.lines.get(line.checked_sub(self.seen.start)?)
    }

    /// The columns at which the rows of a visible line begin.
    pub(super) fn starts(&self, line: usize) -> &[usize] {
        self.rows(line).map_or(&[0], |rows| &rows.starts)
    }

    /// Position of a row of a line. Lines outside the page are above or below it.
    fn row_at(&self, line: usize, row: usize) -> Pos2 {
        let outside = if line < self.seen.start { -1.0 } else { self.rect.height() / self.cell.y + 1.0 };
        let top = self.rows(line).map_or(outside, |rows| rows.top + row as f32);
        self.rect.min + vec2(0.0, top * self.cell.y)
    }

    pub(super) fn at(&self, line: usize, column: usize) -> Pos2 {
        let starts = self.starts(line);
        let row = row_of(starts, column);
        let inside = column - starts.get(row).copied().unwrap_or(0);
        self.row_at(line, row) + vec2(inside as f32 * self.cell.x, 0.0)
    }

    /// The area of all rows of a line, from `left` to the right edge of the page.
    pub(super) fn rect_of_line(&self, line: usize, left: f32) -> Rect {
        let from = self.row_at(line, 0);
        let height = self.starts(line).len() as f32 * self.cell.y;
        Rect::from_min_max(Pos2::new(left, from.y), Pos2::new(self.rect.right(), from.y + height))
    }

    /// The columns of a line that may be visible.
    pub(super) fn visible_columns(&self, line: usize) -> Range<usize> {
        let Some(Rows { top, starts }) = self.rows(line) else { return 0..0 };
        let first = (-top).max(0.0) as usize;
        let last = (self.rect.height() / self.cell.y - top).max(0.0).ceil() as usize;
        let at = |row: usize| starts.get(row).copied().unwrap_or(usize::MAX);
        at(first)..at(last + 1)
    }

    pub(super) fn offset(&self, buffer: &Buffer, at: Pos2) -> usize {
        let down = (at.y - self.rect.top()) / self.cell.y;
        let (line, row) = self.wrapping.moved(buffer, self.top, down);
        let (line, row) = (line as usize, row as usize);
        let starts = self.wrapping.starts(buffer.line(line));
        let start = starts.get(row).copied().unwrap_or(0);
        // Behind the end of a row, the last cell of the row is nearest.
        let last = starts.get(row + 1).map_or(f32::MAX, |next| *next as f32 - 0.6);
        let column = start as f32 + ((at.x - self.rect.left()) / self.cell.x).max(0.0);
        buffer.line_start(line) + offset_of(buffer.line(line), column.min(last))
    }

    /// The screen areas of a range within one line, one for each row.
    pub(super) fn rects_of(&self, buffer: &Buffer, range: &Range<usize>) -> Vec<Rect> {
        let line = buffer.line_of(range.start);
        let (start, text) = (buffer.line_start(line), buffer.line(line));
        let column = |offset: usize| column_of(text, offset.saturating_sub(start));
        let (from, to) = (column(range.start), column(range.end).max(column(range.start)));
        let starts = self.starts(line);
        let rows = row_of(starts, from)..=row_of(starts, to.saturating_sub(1).max(from));
        let rect = |row: usize| {
            let begins = starts.get(row).copied().unwrap_or(0);
            let ends = starts.get(row + 1).copied().unwrap_or(usize::MAX);
            let x = |column: usize| column.clamp(begins, ends).saturating_sub(begins) as f32 * self.cell.x;
            let at = self.row_at(line, row);
            Rect::from_min_max(at + vec2(x(from), 0.0), at + vec2(x(to), self.cell.y))
        };
        rows.map(rect).collect()
    }

    /// The screen area of the first row of a range within one line.
    pub(super) fn rect_of(&self, buffer: &Buffer, range: &Range<usize>) -> Rect {
        self.rects_of(buffer, range).first().copied().unwrap_or(Rect::NOTHING)
    }
}
