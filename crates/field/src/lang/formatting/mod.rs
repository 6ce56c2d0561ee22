//! Formats the text of a scene: indentation, blanks between tokens, aligned `=`, blank lines.
//!
//! The formatter keeps every token, comment and line break, because a line break can end an expression. It works in
//! three steps: [`pieces()`] splits the text, [`layout`] arranges the pieces of each line, and [`alignment`] writes the
//! lines with their `=` and comments in columns. Columns that the author has aligned are kept. If
//! the `=` of consecutive lines are no longer aligned, they get a common column.

mod alignment;
mod layout;
mod spacing;
#[cfg(test)]
mod tests;

use super::check_syntax;
use super::foreign::is_shader;
use super::pieces::pieces;
use super::source::BYTE_ORDER_MARK;

/// Returns the text with regular indentation and blanks; `None` if it has mistakes in its tokens or grammar. The
/// result means the same as `text`, and formatting it again changes nothing. A text in GLSL stays as it is.
pub fn formatted(text: &str) -> Option<String> {
    if is_shader(text) {
        return Some(text.to_owned());
    }
    let (mistakes, _) = check_syntax("", text);
    if !mistakes.is_empty() {
        return None;
    }
    let mark = if text.starts_with(BYTE_ORDER_MARK) { "\u{feff}" } else { "" };
    let line_end =
        if text.split_once('\n').is_some_and(|(first, _)| first.ends_with('\r')) { "\r\n" } else { "\n" };
    let lines = layout::lines(&pieces(text));
    Some(mark.to_owned() + &alignment::written(lines, line_end))
}
