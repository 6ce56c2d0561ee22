//! Writes the lines: their indentation, their `=` in a common column, and the comments behind them.

use std::collections::BTreeMap;

use super::super::pieces::{behind, width};
use super::layout::{Line, Start, push};

/// Columns of one level of indentation.
const INDENT: usize = 2;
/// Blanks before a comment that the code has reached.
const BEFORE_COMMENT: usize = 2;

/// Returns the text of the lines. It ends with a line end, unless it is empty.
pub(super) fn written(mut lines: Vec<Line>, line_end: &str) -> String {
    align(&mut lines);
    let mut text = String::new();
    // For each line, its column and how far its contents are moved to the right.
    let mut placed: Vec<(usize, isize)> = Vec::with_capacity(lines.len());
    for line in &lines {
        let column = column(line, &placed);
        if line.gap {
            text.push_str(line_end);
        }
        push(&mut text, column, &line.head);
        let mut end = behind(column, &line.head);
        let mut moved = column as isize - line.written_at as isize;
        if let Some(equals) = &line.equals {
            push(&mut text, equals.blanks, &equals.text);
            moved = (end + equals.blanks) as isize - equals.written_at as isize;
            end = behind(end + equals.blanks, &equals.text);
        }
        if let Some(comment) = &line.comment {
            let blanks = match comment.blanks {
                1 => 1,
                _ => comment.written_at.saturating_sub(end).max(BEFORE_COMMENT),
            };
            push(&mut text, blanks, &comment.text);
        }
        text.push_str(line_end);
        placed.push((column, moved));
    }
    text
}

fn column(line: &Line, placed: &[(usize, isize)]) -> usize {
    let of = |index: usize| placed.get(index).copied().unwrap_or_default();
    match line.start {
        Start::Margin => 0,
        Start::Below(index) => of(index).0,
        Start::Inside(index) => of(index).0 + INDENT,
        Start::Behind(index) => {
            let (column, moved) = of(index);
            let wanted = line.written_at.saturating_add_signed(moved);
            let may_be_below = [")", "{", "then", "else"].iter().any(|begin| line.head.starts_with(begin));
            if wanted > column || wanted == column && may_be_below { wanted } else { column + INDENT }
        }
    }
}

/// Arranges the `=` of consecutive lines.
fn align(lines: &mut [Line]) {
    let mut at = 0;
    while let Some(first) = lines.get(at) {
        let (start, is_fn) = (first.start, is_function(first));
        let rest = lines.get(at + 1..).unwrap_or_default();
        let belongs = |line: &&Line| {
            let is_entry = line.equals.is_some() && line.start == start && is_function(line) == is_fn;
            // Comments and continued expressions do not end a table.
            !line.gap && (is_entry || is_comment(line) || matches!(line.start, Start::Behind(_)))
        };
        let length = 1 + rest.iter().take_while(belongs).count();
        let table = lines.iter_mut().skip(at).take(length).filter(|line| line.start == start);
        let mut entries: Vec<Entry<'_>> = table
            .filter_map(|line| {
                let equals = line.equals.as_mut()?;
                let column = equals.written_at.saturating_sub(line.written_at);
                Some(Entry { head: width(&line.head), column, blanks: &mut equals.blanks })
            })
            .collect();
        arrange(&mut entries);
        at += length;
    }
}

/// An entry of a table.
struct Entry<'a> {
    /// The width of the text before the `=`.
    head: usize,
    /// The column of the `=` in the text, relative to the line's beginning.
    column: usize,
    /// Blanks before the `=`.
    blanks: &'a mut usize,
}

/// Sets the blanks before each `=`. Entries are a table if a `=` has more than one blank before it. A column of `=` that
/// the author has aligned stays; entries that are too long for it get one blank.
fn arrange(table: &mut [Entry<'_>]) {
    let is_table = table.iter().any(|entry| *entry.blanks > 1);
    let mut columns: BTreeMap<usize, usize> = BTreeMap::new();
    for entry in table.iter().filter(|entry| entry.column > entry.head) {
        *columns.entry(entry.column).or_default() += 1;
    }
    let sharing = |column: usize| columns.get(&column).copied().unwrap_or_default();
    let shared = columns.keys().copied().filter(|column| sharing(*column) > 1);
    let longest = table.iter().map(|entry| entry.head).max().unwrap_or(0);
    // The column that most entries share, of several such columns the leftmost.
    let common = shared.max_by_key(|column| (sharing(*column), usize::MAX - column)).unwrap_or(longest + 1);
    let is_aligned = table.iter().all(|entry| {
        let is_lone = *entry.blanks == 1 && entry.head >= common;
        entry.column > entry.head && sharing(entry.column) > 1 || is_lone
    });
    for entry in table {
        let column = if is_aligned && sharing(entry.column) > 1 { entry.column } else { common };
        *entry.blanks = if is_table { column.saturating_sub(entry.head).max(1) } else { 1 };
    }
}

fn is_comment(line: &Line) -> bool {
    ["#", "//", "/*"].iter().any(|sign| line.head.starts_with(sign))
}

fn is_function(line: &Line) -> bool {
    line.head.starts_with("fn ")
}
