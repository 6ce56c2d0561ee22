//! Source texts and locations in them.
//!
//! All files of a scene share one sequence of byte offsets: a file begins one byte after the end of the previous file.
//! The two offsets of a [`Span`] therefore identify its file.

/// A range of source text: byte offsets over all files of a [`Sources`], `start <= end`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, PartialOrd, Ord)]
pub struct Span {
    /// Offset of the first byte.
    pub start: u32,
    /// Offset after the last byte.
    pub end: u32,
}

impl Span {
    /// Returns the span from `start` up to `end`, exclusive.
    pub fn new(start: u32, end: u32) -> Self {
        Self { start, end: end.max(start) }
    }

    /// True if the span has no bytes.
    pub fn is_empty(self) -> bool {
        self.start == self.end
    }

    /// Returns the span from the start of `self` to the end of `other`.
    pub fn to(self, other: Self) -> Self {
        Self::new(self.start, other.end.max(self.end))
    }
}

/// One text with its name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SourceFile {
    /// The name in diagnostics.
    pub name: String,
    /// The unchanged text.
    pub text: String,
    base: u32,
}

/// A location for readers: file, line and column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Place<'a> {
    /// The file.
    pub file: &'a SourceFile,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// The line's text without its line break.
    pub text: &'a str,
    /// Byte offset in `text`.
    pub byte: usize,
}

/// The texts of a scene: first the scene itself, then its includes.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Sources {
    files: Vec<SourceFile>,
}

/// A byte-order mark, which editors on Windows write.
pub(super) const BYTE_ORDER_MARK: char = '\u{feff}';

impl Sources {
    /// Adds a text and returns its first offset; `None` if offsets no longer fit into 32 bits.
    pub fn add(&mut self, name: &str, text: &str) -> Option<u32> {
        let base = self.end()?;
        u32::try_from(base as usize + text.len() + 1).ok()?;
        self.files.push(SourceFile { name: name.to_owned(), text: text.to_owned(), base });
        Some(base)
    }

    /// Returns the offset after all files. What begins there is shown at the end of the last file.
    pub(super) fn end(&self) -> Option<u32> {
        u32::try_from(self.files.last().map_or(0, |last| last.base as usize + last.text.len() + 1)).ok()
    }

    /// Returns the files in the order in which they were read.
    pub fn files(&self) -> &[SourceFile] {
        &self.files
    }

    /// Returns the text of `span`; empty for a span outside all files.
    pub fn text(&self, span: Span) -> &str {
        let Some((file, bytes)) = self.place_in_file(span) else { return "" };
        self.files.get(file).and_then(|file| file.text.get(bytes)).unwrap_or("")
    }

    /// Returns the location of `offset`; `None` for an offset outside all files.
    pub fn place(&self, offset: u32) -> Option<Place<'_>> {
        let (file, bytes) = self.place_in_file(Span::new(offset, offset))?;
        let (file, mut at) = (self.files.get(file)?, bytes.start);
        while !file.text.is_char_boundary(at) {
            at -= 1;
        }
        let before = file.text.get(..at)?;
        let start = before.rfind('\n').map_or(0, |newline| newline + 1);
        let line = 1 + before.bytes().filter(|&byte| byte == b'\n').count();
        let rest = file.text.get(start..)?;
        let text = rest.split('\n').next().unwrap_or("").trim_end_matches('\r');
        let marks = usize::from(text.starts_with(BYTE_ORDER_MARK));
        let byte = (at - start).min(text.len());
        let column = 1 + (text.get(..byte)?.chars().count()).saturating_sub(marks);
        Some(Place { file, line, column, text, byte })
    }

    /// Returns the index of a span's file, and the span's bytes in that file; `None` for a span outside all files.
    pub fn place_in_file(&self, span: Span) -> Option<(usize, std::ops::Range<usize>)> {
        let index = self.files.partition_point(|file| file.base <= span.start).checked_sub(1)?;
        let file = self.files.get(index)?;
        let within = |offset: u32| (offset.saturating_sub(file.base) as usize).min(file.text.len());
        Some((index, within(span.start)..within(span.end)))
    }

    /// Returns the offset of a byte in the file with this index; `None` for a missing file.
    pub fn offset(&self, file: usize, byte: usize) -> Option<u32> {
        let file = self.files.get(file)?;
        u32::try_from(file.base as usize + byte.min(file.text.len())).ok()
    }

    /// First offset and length of each file, in bytes.
    pub(super) fn extents(&self) -> impl Iterator<Item = (u32, u32)> {
        self.files.iter().map(|file| (file.base, file.text.len() as u32))
    }
}
