//! Breaks the lines of a text into rows that fit into the editor. Only the lines near the visible part are examined.

use mariana_editing::{Buffer, cells};

/// Minimum number of columns of a row.
const COLUMNS_MIN: usize = 8;

/// A position in the rows of a text: a line, and rows below the line's first row.
pub(crate) type RowPosition = (f32, f32);

/// Rows of a number of columns.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Wrapping {
    columns: usize,
}

impl Wrapping {
    pub(crate) fn new(columns: usize) -> Self {
        Self { columns: columns.max(COLUMNS_MIN) }
    }

    /// Returns the column at which each row of a line begins. Rows end between words, if the words fit into a row.
    pub(crate) fn starts(self, text: &[u8]) -> Vec<usize> {
        let (mut starts, mut start, mut behind_space) = (vec![0], 0, 0);
        for cell in cells(text) {
            let is_space = matches!(text.get(cell.start), Some(b' ' | b'\t'));
            let end = cell.column + cell.width;
            // One space behind the last word of a row stays in this row.
            if end - start > self.columns + usize::from(is_space) && cell.column > start {
                start = if behind_space > start && !is_space { behind_space } else { cell.column };
                starts.push(start);
            }
            if is_space {
                behind_space = end;
            }
        }
        starts
    }

    pub(crate) fn rows_of(self, buffer: &Buffer, line: usize) -> usize {
        self.starts(buffer.line(line)).len()
    }

    /// Returns the position `by` rows below `from`, or above if `by` is negative, within the text.
    pub(crate) fn moved(self, buffer: &Buffer, from: RowPosition, by: f32) -> RowPosition {
        let last = buffer.line_count().saturating_sub(1);
        let mut line = (from.0.max(0.0) as usize).min(last);
        let mut row = from.1 + by;
        while row < 0.0 && line > 0 {
            line -= 1;
            row += self.rows_of(buffer, line) as f32;
        }
        loop {
            let rows = self.rows_of(buffer, line) as f32;
            if row < rows {
                return (line as f32, row.max(0.0));
            }
            if line == last {
                return (line as f32, rows - 1.0);
            }
            (line, row) = (line + 1, row - rows);
        }
    }

    /// Returns the number of rows of the first lines, until there are more than `most`.
    pub(crate) fn rows_up_to(self, buffer: &Buffer, most: usize) -> usize {
        let mut rows = 0;
        for line in 0..buffer.line_count() {
            rows += self.rows_of(buffer, line);
            if rows > most {
                break;
            }
        }
        rows
    }
}

/// Returns the row of a line that contains a column.
pub(crate) fn row_of(starts: &[usize], column: usize) -> usize {
    starts.partition_point(|start| *start <= column).saturating_sub(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_end_between_words_and_long_words_are_cut() {
        let starts = |text: &str| Wrapping::new(10).starts(text.as_bytes());
        assert_eq!(starts(""), [0]);
        assert_eq!(starts("0123456789"), [0]);
        assert_eq!(starts("let a = smooth(b)"), [0, 8]);
        assert_eq!(starts("01234567890123456789x"), [0, 10, 20]);
        assert_eq!(starts("word      "), [0]);
        assert_eq!(starts("0123456789 a"), [0, 11], "a space does not begin a row");
        assert_eq!(starts("0123456789    a"), [0, 11]);
        assert_eq!(starts("球球球球球球"), [0, 10], "wide letters are not cut");
        assert_eq!([0, 9, 10, 25].map(|column| row_of(&[0, 10, 20], column)), [0, 0, 1, 2]);
    }

    #[test]
    fn positions_move_by_rows_and_stop_at_the_ends() {
        let text = format!("{}\nshort\n{}", "x".repeat(25), "y".repeat(15));
        let buffer = Buffer::new(text.into_bytes());
        let wrapping = Wrapping::new(10);
        let moved = |from, by| wrapping.moved(&buffer, from, by);
        assert_eq!(moved((0.0, 0.0), 2.5), (0.0, 2.5));
        assert_eq!(moved((0.0, 0.0), 3.0), (1.0, 0.0));
        assert_eq!(moved((2.0, 0.0), -2.0), (0.0, 2.0));
        assert_eq!(moved((1.0, 0.0), -99.0), (0.0, 0.0));
        assert_eq!(moved((0.0, 0.0), 99.0), (2.0, 1.0));
        assert_eq!(moved((77.0, 0.0), 0.0), (2.0, 0.0), "a position behind the text");
        assert_eq!((wrapping.rows_up_to(&buffer, 99), wrapping.rows_up_to(&buffer, 2)), (6, 3));
    }

    #[test]
    fn a_very_long_line_has_rows_in_order() {
        let text = "a(b) + ".repeat(1_500);
        let starts = Wrapping::new(60).starts(text.as_bytes());
        assert!(starts.len() > 150 && starts.windows(2).all(|pair| pair[0] < pair[1]));
        assert!(starts.windows(2).all(|pair| pair[1] - pair[0] <= 61));
    }
}
