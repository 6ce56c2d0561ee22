//! The bytes of a text, with an index of its lines.

use std::ops::Range;

/// Bytes with an index of line starts. A line ends at `\n`; a `\r` before the `\n` belongs to the line end.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Buffer {
    bytes: Vec<u8>,
    /// Byte offset of each line; the first is 0.
    starts: Vec<usize>,
}

impl Buffer {
    /// Indexes the lines of `bytes`.
    pub fn new(bytes: Vec<u8>) -> Self {
        let mut starts = vec![0];
        starts.extend(line_starts(&bytes, 0));
        Self { bytes, starts }
    }

    /// The whole text.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Length in bytes.
    pub fn len(&self) -> usize {
        self.bytes.len()
    }

    /// True if the text has no bytes.
    pub fn is_empty(&self) -> bool {
        self.bytes.is_empty()
    }

    /// The number of lines, at least 1.
    pub fn line_count(&self) -> usize {
        self.starts.len()
    }

    /// Returns the bytes of a range, after clipping the range to the text.
    pub fn slice(&self, range: Range<usize>) -> &[u8] {
        let end = range.end.min(self.len());
        self.bytes.get(range.start.min(end)..end).unwrap_or_default()
    }

    /// The byte range of a line without its line end. For a missing line, an empty range at the end of the text.
    pub fn line_range(&self, line: usize) -> Range<usize> {
        let start = self.line_start(line);
        let Some(next) = self.starts.get(line + 1) else { return start..self.len() };
        let mut end = next - 1;
        if end > start && self.bytes.get(end - 1) == Some(&b'\r') {
            end -= 1;
        }
        start..end
    }

    /// The bytes of a line without its line end.
    pub fn line(&self, line: usize) -> &[u8] {
        self.slice(self.line_range(line))
    }

    /// The byte offset of a line's start. For a missing line, the text's length.
    pub fn line_start(&self, line: usize) -> usize {
        self.starts.get(line).copied().unwrap_or(self.len())
    }

    /// The line that contains a byte offset. A line end belongs to the line that it ends.
    pub fn line_of(&self, offset: usize) -> usize {
        self.starts.partition_point(|start| *start <= offset).saturating_sub(1)
    }

    /// Returns the line end to insert: the line end of the first line, or `\n` if the text has only one line.
    pub fn line_end(&self) -> &'static [u8] {
        let first = self.starts.get(1).and_then(|next| self.bytes.get(next.checked_sub(2)?));
        if first == Some(&b'\r') { b"\r\n" } else { b"\n" }
    }

    /// Replaces `range` by `new` and returns the replaced bytes. Clips `range` to the text.
    pub fn replace(&mut self, range: Range<usize>, new: &[u8]) -> Vec<u8> {
        let end = range.end.min(self.len());
        let start = range.start.min(end);
        let first = self.line_of(start) + 1;
        let behind = self.starts.partition_point(|line| *line <= end);
        let added: Vec<usize> = line_starts(new, start).collect();
        let count = added.len();
        self.starts.splice(first..behind.max(first), added);
        for line in self.starts.iter_mut().skip(first + count) {
            *line = *line - (end - start) + new.len();
        }
        self.bytes.splice(start..end, new.iter().copied()).collect()
    }
}

fn line_starts(bytes: &[u8], base: usize) -> impl Iterator<Item = usize> {
    let ends = bytes.iter().enumerate().filter(|(_, byte)| **byte == b'\n');
    ends.map(move |(at, _)| base + at + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_have_any_end_and_no_byte_is_lost() {
        let bytes = b"a\r\n\xff\n\rb\n".to_vec();
        let buffer = Buffer::new(bytes.clone());
        let lines: Vec<&[u8]> = (0..buffer.line_count()).map(|line| buffer.line(line)).collect();
        assert_eq!(lines, [b"a".as_slice(), b"\xff", b"\rb", b""]);
        assert_eq!(buffer.bytes(), bytes);
        assert_eq!(buffer.line_end(), b"\r\n");
        assert_eq!([0, 1, 2, 3, 4, 8, 99].map(|at| buffer.line_of(at)), [0, 0, 0, 1, 1, 3, 3]);
        assert_eq!((buffer.line(9), buffer.line_start(9)), (b"".as_slice(), buffer.len()));
        assert_eq!((Buffer::new(vec![]).line_count(), Buffer::new(vec![]).line_end()), (1, b"\n".as_slice()));
    }
}
