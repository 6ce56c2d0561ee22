//! A text with a cursor, a selection, and undo.

use std::ops::Range;

use mariana_field::lang::formatted;

use crate::buffer::Buffer;
use crate::history::{Change, Followed, History, Joins, Step};
use crate::limits;
use crate::movement::{self, Move};

const INDENT: &[u8] = b"  ";
const COMMENT: &[u8] = b"# ";

/// An edited text. All positions are byte offsets.
#[derive(Debug, Clone)]
pub struct Editing {
    buffer: Buffer,
    cursor: usize,
    /// The fixed end of the selection. It equals the cursor if the selection is empty.
    anchor: usize,
    /// The column that the cursor tries to keep when it moves up or down.
    goal: Option<usize>,
    history: History,
    followed: Followed,
    version: u64,
    /// The first byte that has changed since the last call of [`Editing::changed_line`].
    changed_from: Option<usize>,
}

/// The error for an edit that would make the text longer than a scene may be.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("these {bytes} bytes do not fit: a scene may have at most {max} bytes. Nothing was inserted")]
pub struct Refused {
    /// Bytes to insert.
    pub bytes: usize,
    /// Maximum number of bytes of a text.
    pub max: usize,
}

impl Editing {
    /// Starts editing `bytes`, with the cursor at the start.
    pub fn new(bytes: Vec<u8>) -> Self {
        Self {
            buffer: Buffer::new(bytes),
            cursor: 0,
            anchor: 0,
            goal: None,
            history: History::default(),
            followed: Followed::default(),
            version: 0,
            changed_from: None,
        }
    }

    /// The text.
    pub fn buffer(&self) -> &Buffer {
        &self.buffer
    }

    /// The cursor's byte offset.
    pub fn cursor(&self) -> usize {
        self.cursor
    }

    /// The selected range, or an empty range at the cursor if nothing is selected.
    pub fn selection(&self) -> Range<usize> {
        self.cursor.min(self.anchor)..self.cursor.max(self.anchor)
    }

    /// The selected bytes.
    pub fn selected(&self) -> &[u8] {
        self.buffer.slice(self.selection())
    }

    /// A number that grows with every change.
    pub fn version(&self) -> u64 {
        self.version
    }

    /// Returns the first line that has changed since the last call; `None` if no line has changed.
    pub fn changed_line(&mut self) -> Option<usize> {
        self.changed_from.take().map(|at| self.buffer.line_of(at))
    }

    /// Maps `range` of an earlier `version` to the present text. `None` if `range` was edited or `version` is too old.
    pub fn place(&self, version: u64, range: Range<usize>) -> Option<Range<usize>> {
        self.followed.place(version, self.version, range)
    }

    /// Moves the cursor to an offset. With `select`, extends the selection to the offset.
    pub fn move_to(&mut self, offset: usize, select: bool) {
        self.cursor = offset.min(self.buffer.len());
        self.goal = None;
        if !select {
            self.anchor = self.cursor;
        }
        self.history.close();
    }

    /// Selects a range, with the cursor at its end.
    pub fn select(&mut self, range: Range<usize>) {
        self.move_to(range.start, false);
        self.move_to(range.end, true);
    }

    /// Selects the word around an offset.
    pub fn select_word(&mut self, offset: usize) {
        self.select(movement::word_around(&self.buffer, offset));
    }

    /// Selects a line with its line end.
    pub fn select_line(&mut self, line: usize) {
        self.select(self.buffer.line_start(line)..self.buffer.line_start(line + 1));
    }

    /// Moves the cursor. With `select`, extends the selection.
    pub fn move_cursor(&mut self, way: Move, select: bool) {
        let selection = self.selection();
        // Left and Right collapse a selection to its start or end.
        let (cursor, goal) = match way {
            Move::Left if !select && !selection.is_empty() => (selection.start, None),
            Move::Right if !select && !selection.is_empty() => (selection.end, None),
            _ => movement::follow(&self.buffer, self.cursor, way, self.goal),
        };
        self.move_to(cursor, select);
        self.goal = goal;
    }

    /// Replaces the selection with `text`. Converts the line ends of `text` to those of the edited text.
    ///
    /// # Errors
    /// [`Refused`] if the result would be too long. The text then stays unchanged.
    pub fn insert(&mut self, text: &[u8]) -> Result<(), Refused> {
        let typed = text.len() <= 4 && !text.contains(&b'\n') && self.selection().is_empty();
        let joins = if typed { Joins::Typing } else { Joins::Nothing };
        let text = self.with_own_line_ends(text);
        self.replace(&[(self.selection(), text.as_slice())], joins)?;
        // White space ends an undo step, so that words are undone one by one.
        if text.iter().all(u8::is_ascii_whitespace) {
            self.history.close();
        }
        Ok(())
    }

    /// Starts a new line with the indentation of the present line. After `{`, indents one step deeper.
    ///
    /// # Errors
    /// [`Refused`] if the result would be too long.
    pub fn insert_line(&mut self) -> Result<(), Refused> {
        let start = self.selection().start;
        let line = self.buffer.slice(self.buffer.line_start(self.buffer.line_of(start))..start);
        let blanks = line.iter().take_while(|byte| matches!(byte, b' ' | b'\t')).count();
        let mut text = self.buffer.line_end().to_vec();
        text.extend_from_slice(line.get(..blanks).unwrap_or_default());
        if line.iter().rev().find(|byte| !byte.is_ascii_whitespace()) == Some(&b'{') {
            text.extend_from_slice(INDENT);
        }
        self.replace(&[(self.selection(), text.as_slice())], Joins::Nothing)
    }

    /// Deletes the selection. Without a selection, deletes the text from the cursor to the target of the move `way`.
    pub fn delete(&mut self, way: Move) {
        let mut range = self.selection();
        if range.is_empty() {
            let (to, _) = movement::follow(&self.buffer, self.cursor, way, None);
            range = to.min(self.cursor)..to.max(self.cursor);
        }
        if !range.is_empty() {
            // A deletion cannot exceed the limit.
            let _ = self.replace(&[(range, b"".as_slice())], Joins::Deleting);
        }
    }

    /// Replaces `range` by `new` and puts the cursor after `new`.
    ///
    /// # Errors
    /// [`Refused`] if the result would be too long.
    pub fn replace_part(&mut self, range: Range<usize>, new: &[u8]) -> Result<(), Refused> {
        self.replace(&[(range, new)], Joins::Nothing)
    }

    /// Replaces several ranges, given in descending order, as one undo step. Puts the cursor after the first range.
    ///
    /// # Errors
    /// [`Refused`] if the result would be too long. The text then stays unchanged.
    pub fn replace_parts(&mut self, parts: &[(Range<usize>, &[u8])]) -> Result<(), Refused> {
        self.replace(parts, Joins::Nothing)
    }

    /// Like [`Editing::replace_part`], for a turned number. All turns until [`Editing::settle`] form one undo step.
    ///
    /// # Errors
    /// [`Refused`] if the result would be too long.
    pub fn turn(&mut self, range: Range<usize>, new: &[u8]) -> Result<(), Refused> {
        self.replace(&[(range, new)], Joins::Turning)
    }

    /// Selects a turned number without ending the undo step of the turn.
    pub fn select_turned(&mut self, range: Range<usize>) {
        let end = range.end.min(self.buffer.len());
        (self.anchor, self.cursor, self.goal) = (range.start.min(end), end, None);
    }

    /// Ends the undo step: the next change is undone separately.
    pub fn settle(&mut self) {
        self.history.close();
    }

    /// Replaces the whole text as one undo step.
    ///
    /// # Errors
    /// [`Refused`] if the result would be too long.
    pub fn replace_all(&mut self, text: &[u8]) -> Result<(), Refused> {
        let cursor = self.cursor;
        self.replace(&[(0..self.buffer.len(), text)], Joins::Nothing)?;
        self.move_to(cursor, false);
        Ok(())
    }

    /// Formats the text as one undo step. The cursor stays at its word. Returns false and
    /// changes nothing if the text has mistakes in its grammar or is not UTF-8.
    ///
    /// # Errors
    /// [`Refused`] if the result would be too long.
    pub fn format(&mut self) -> Result<bool, Refused> {
        let Some(text) = std::str::from_utf8(self.buffer.bytes()).ok().and_then(formatted) else {
            return Ok(false);
        };
        if text.as_bytes() == self.buffer.bytes() {
            return Ok(true);
        }
        // Only blanks change, so the cursor stays before the same letter or, at a blank, behind it.
        let is_letter = |byte: &u8| !byte.is_ascii_whitespace();
        let before = self.buffer.slice(0..self.cursor).iter().filter(|byte| is_letter(byte)).count();
        let mut letters = text.bytes().enumerate().filter(|(_, byte)| is_letter(byte)).map(|(at, _)| at);
        let cursor = match self.buffer.slice(self.cursor..self.cursor + 1).first() {
            Some(byte) if is_letter(byte) => letters.nth(before).unwrap_or(text.len()),
            _ => before.checked_sub(1).and_then(|last| letters.nth(last)).map_or(0, |last| last + 1),
        };
        self.replace_all(text.as_bytes())?;
        self.move_to(cursor, false);
        Ok(true)
    }

    /// Indents the selected lines by one step if `deeper`, otherwise unindents them by one step.
    pub fn indent(&mut self, deeper: bool) {
        self.edit_lines(|line| match deeper {
            true if line.is_empty() => None,
            true => Some((0, INDENT.to_vec())),
            false => {
                let blanks = line.iter().take(INDENT.len()).take_while(|byte| **byte == b' ').count();
                let count = if line.first() == Some(&b'\t') { 1 } else { blanks };
                (count > 0).then(|| (count, Vec::new()))
            }
        });
    }

    /// Comments the selected lines out, or uncomments them if all of them are comments.
    pub fn toggle_comment(&mut self) {
        let is_blank = |line: &[u8]| line.iter().all(u8::is_ascii_whitespace);
        let lines = self.selected_lines();
        let mut texts = lines.map(|line| self.buffer.line(line)).filter(|line| !is_blank(line));
        let all = texts.all(|line| line.trim_ascii_start().starts_with(b"#"));
        self.edit_lines(|line| {
            if is_blank(line) {
                return None;
            }
            if !all {
                return Some((0, COMMENT.to_vec()));
            }
            let indent = line.len() - line.trim_ascii_start().len();
            let sign = if line.get(indent + 1) == Some(&b' ') { 2 } else { 1 };
            Some((indent + sign, line.get(..indent).unwrap_or_default().to_vec()))
        });
    }

    fn selected_lines(&self) -> Range<usize> {
        let selection = self.selection();
        let (first, mut last) = (self.buffer.line_of(selection.start), self.buffer.line_of(selection.end));
        // Exclude the last line if the selection ends at the line's start.
        if last > first && selection.end == self.buffer.line_start(last) {
            last -= 1;
        }
        first..last + 1
    }

    /// Replaces the first bytes of each selected line. `edit` returns the number of these bytes and their replacement.
    fn edit_lines(&mut self, edit: impl Fn(&[u8]) -> Option<(usize, Vec<u8>)>) {
        let lines = self.selected_lines();
        let before = (self.anchor, self.cursor);
        let mut changes = Vec::new();
        let (mut anchor, mut cursor) = before;
        for line in lines {
            let Some((count, new)) = edit(self.buffer.line(line)) else { continue };
            let start = self.buffer.line_start(line);
            if self.buffer.len() + new.len() > limits::TEXT_BYTES_MAX + count {
                break;
            }
            for place in [&mut anchor, &mut cursor] {
                if *place >= start {
                    *place = (*place).max(start + count) - count + new.len();
                }
            }
            changes.push(self.apply(start..start + count, &new));
        }
        if changes.is_empty() {
            return;
        }
        (self.anchor, self.cursor, self.goal) = (anchor, cursor, None);
        self.history.record(Step { changes, before, after: (anchor, cursor), joins: Joins::Nothing });
    }

    /// Undoes the last step. Returns false if there is no step.
    pub fn undo(&mut self) -> bool {
        let Some(step) = self.history.undo() else { return false };
        for change in step.changes.iter().rev() {
            self.apply(change.at..change.at + change.inserted.len(), &change.removed);
        }
        ((self.anchor, self.cursor), self.goal) = (step.before, None);
        true
    }

    /// Redoes the last undone step. Returns false if there is no step.
    pub fn redo(&mut self) -> bool {
        let Some(step) = self.history.redo() else { return false };
        for change in &step.changes {
            self.apply(change.at..change.at + change.removed.len(), &change.inserted);
        }
        ((self.anchor, self.cursor), self.goal) = (step.after, None);
        true
    }

    fn replace(&mut self, parts: &[(Range<usize>, &[u8])], joins: Joins) -> Result<(), Refused> {
        let (length, max) = (self.buffer.len(), limits::TEXT_BYTES_MAX);
        let inside = |range: &Range<usize>| range.start.min(range.end).min(length)..range.end.min(length);
        let bytes: usize = parts.iter().map(|(_, new)| new.len()).sum();
        let removed: usize = parts.iter().map(|(range, _)| inside(range).len()).sum();
        if length - removed + bytes > max && bytes > removed {
            return Err(Refused { bytes, max });
        }
        let before = (self.anchor, self.cursor);
        let (mut at, mut changes) = (self.cursor, Vec::new());
        for (range, new) in parts {
            let range = inside(range);
            at = range.start + new.len();
            changes.push(self.apply(range, new));
        }
        (self.anchor, self.cursor, self.goal) = (at, at, None);
        self.history.record(Step { changes, before, after: (at, at), joins });
        Ok(())
    }

    fn apply(&mut self, range: Range<usize>, new: &[u8]) -> Change {
        let at = range.start;
        let change = Change { at, removed: self.buffer.replace(range, new), inserted: new.to_vec() };
        self.version += 1;
        self.changed_from = Some(self.changed_from.map_or(at, |from| from.min(at)));
        self.followed.record(self.version, &change);
        change
    }

    fn with_own_line_ends(&self, text: &[u8]) -> Vec<u8> {
        let lines = text.split_inclusive(|byte| *byte == b'\n');
        let lines = lines.map(|line| match line.strip_suffix(b"\n") {
            Some(line) => [line.strip_suffix(b"\r").unwrap_or(line), self.buffer.line_end()].concat(),
            None => line.to_vec(),
        });
        lines.flatten().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with_cursor(text: &str) -> Editing {
        let at = text.find('|').unwrap();
        let mut editing = Editing::new(text.replacen('|', "", 1).into_bytes());
        editing.move_to(at, false);
        editing
    }

    fn shown(editing: &Editing) -> String {
        let mut bytes = editing.buffer().bytes().to_vec();
        bytes.insert(editing.cursor(), b'|');
        String::from_utf8(bytes).unwrap()
    }

    #[test]
    fn words_are_undone_one_by_one_and_letters_of_a_word_together() {
        let mut editing = with_cursor("|");
        for letter in "ab cd".chars() {
            editing.insert(letter.to_string().as_bytes()).unwrap();
        }
        assert!(editing.undo());
        assert_eq!(shown(&editing), "ab |");
        assert!(editing.undo() && !editing.undo());
        assert_eq!(shown(&editing), "|");
        assert!(editing.redo() && editing.redo() && !editing.redo());
        assert_eq!(shown(&editing), "ab cd|");
        editing.move_cursor(Move::Left, false);
        editing.delete(Move::Left);
        editing.delete(Move::Left);
        assert_eq!(shown(&editing), "ab|d");
        assert!(editing.undo());
        assert_eq!(shown(&editing), "ab c|d");
    }

    #[test]
    fn all_values_of_one_turn_are_undone_together() {
        let mut editing = Editing::new(b"a 0.5 b".to_vec());
        for (end, new) in [(5, "0.75"), (6, "1"), (3, "12.5")] {
            editing.turn(2..end, new.as_bytes()).unwrap();
        }
        assert_eq!(editing.buffer().bytes(), b"a 12.5 b");
        assert_eq!(editing.history.len(), 1);
        editing.settle();
        editing.turn(2..6, b"3").unwrap();
        assert!(editing.undo());
        assert_eq!(editing.buffer().bytes(), b"a 12.5 b");
        assert!(editing.undo());
        assert_eq!(editing.buffer().bytes(), b"a 0.5 b");
    }

    #[test]
    fn a_new_line_keeps_the_indentation_and_the_line_end() {
        let mut editing = with_cursor("object o {|\r\n}");
        editing.insert_line().unwrap();
        assert_eq!(shown(&editing), "object o {\r\n  |\r\n}");
        editing.insert(b"a\nb\r\nc").unwrap();
        assert_eq!(shown(&editing), "object o {\r\n  a\r\nb\r\nc|\r\n}");
    }

    #[test]
    fn ten_megabytes_are_refused_and_change_nothing() {
        let mut editing = Editing::new(b"y".to_vec());
        let refused = editing.insert(&vec![b'x'; 10 << 20]).unwrap_err();
        assert_eq!((refused.bytes, refused.max), (10 << 20, limits::TEXT_BYTES_MAX));
        assert_eq!((editing.buffer().bytes(), editing.version()), (b"y".as_slice(), 0));
        editing.insert(&vec![b'x'; limits::TEXT_BYTES_MAX - 1]).unwrap();
        assert!(editing.insert(b"z").is_err());
        editing.delete(Move::Left);
        editing.insert(b"z").unwrap();
    }

    #[test]
    fn undo_memory_is_limited_but_the_last_step_is_always_kept() {
        let mut editing = Editing::new(Vec::new());
        let much = vec![b'x'; limits::TEXT_BYTES_MAX];
        for _ in 0..2 * limits::UNDO_BYTES_MAX / limits::TEXT_BYTES_MAX {
            editing.replace_all(&much).unwrap();
            editing.replace_all(b"").unwrap();
        }
        let kept = editing.history.len();
        assert!(kept * limits::TEXT_BYTES_MAX <= limits::UNDO_BYTES_MAX && kept > 1, "{kept}");
        assert!(editing.undo());
    }

    #[test]
    fn moves_follow_words_lines_and_wide_letters() {
        let mut editing = with_cursor("  let r| = 5\n球球球球 end\n");
        editing.move_cursor(Move::LineStart, false);
        assert_eq!(shown(&editing), "  |let r = 5\n球球球球 end\n");
        editing.move_cursor(Move::LineStart, false);
        editing.move_cursor(Move::WordRight, false);
        editing.move_cursor(Move::WordRight, false);
        assert_eq!(shown(&editing), "  let r| = 5\n球球球球 end\n");
        editing.move_cursor(Move::Down(1), false);
        assert_eq!(shown(&editing), "  let r = 5\n球球球球| end\n");
        editing.move_cursor(Move::Down(1), false);
        editing.move_cursor(Move::Up(2), false);
        assert_eq!(shown(&editing), "  let r| = 5\n球球球球 end\n");
        editing.move_cursor(Move::End, true);
        assert_eq!(editing.selected(), " = 5\n球球球球 end\n".as_bytes());
        editing.move_cursor(Move::Left, false);
        assert_eq!(shown(&editing), "  let r| = 5\n球球球球 end\n");
        editing.select_word(3);
        assert_eq!(editing.selected(), b"let");
        editing.delete(Move::Right);
        editing.delete(Move::WordRight);
        assert_eq!(shown(&editing), "  | = 5\n球球球球 end\n");
    }

    #[test]
    fn formatting_keeps_the_cursor_at_its_word() {
        let mut editing = with_cursor("let a=1+x\n\n\n\nlet  b = |a");
        assert_eq!(editing.format(), Ok(true));
        assert_eq!(shown(&editing), "let a = 1 + x\n\nlet b = |a\n");
        assert!(editing.undo());
        assert_eq!(editing.buffer().bytes(), b"let a=1+x\n\n\n\nlet  b = a");
        for wrong in ["let a = (|", "let a = \u{e4}|"] {
            let mut editing = with_cursor(wrong);
            assert_eq!(editing.format(), Ok(false));
            assert_eq!(shown(&editing), wrong);
        }
        let mut editing = with_cursor("|x\n");
        assert_eq!((editing.format(), editing.undo()), (Ok(true), false));
    }

    #[test]
    fn lines_are_indented_and_commented_out_together() {
        let mut editing = Editing::new(b"a\n\n  b\nc".to_vec());
        editing.select(0..7);
        editing.indent(true);
        assert_eq!(editing.buffer().bytes(), b"  a\n\n    b\nc");
        editing.indent(false);
        editing.indent(false);
        assert_eq!(editing.buffer().bytes(), b"a\n\nb\nc");
        editing.toggle_comment();
        assert_eq!(editing.buffer().bytes(), b"# a\n\n# b\nc");
        assert!(editing.undo());
        editing.toggle_comment();
        editing.toggle_comment();
        assert_eq!(editing.buffer().bytes(), b"a\n\nb\nc");
    }

    #[test]
    fn ranges_of_earlier_versions_are_found_again() {
        let mut editing = Editing::new(b"one two three".to_vec());
        let version = editing.version();
        editing.move_to(0, false);
        editing.insert(b">> ").unwrap();
        assert_eq!(editing.place(version, 4..7), Some(7..10));
        editing.replace_part(8..9, b"OO").unwrap();
        assert_eq!(editing.place(version, 4..7), Some(7..11));
        assert_eq!(editing.place(editing.version(), 4..7), Some(4..7));
        editing.replace_part(6..12, b"").unwrap();
        assert_eq!(editing.place(version, 4..7), None);
        for _ in 0..limits::FOLLOWED_CHANGES_MAX {
            editing.insert(b"x").unwrap();
        }
        assert_eq!(editing.place(version, 0..1), None, "the version is too old");
    }
}
