//! The panel for a compiler's messages. Text is laid out in columns, as in a terminal, so that underlines are below
//! their words.

use egui::{Color32, Painter, Pos2, Rect, pos2, vec2};

use super::content::Problem;
use super::style;
use mariana_field::lang::columns;

/// Text sizes in points. The panel uses the largest size at which the longest line fits.
const SIZES: [f32; 5] = [13.0, 12.0, 11.0, 10.0, 9.0];
const HEADING_GAP: f32 = 8.0;
/// Distance between lines, in line heights of the font.
const LINE_HEIGHT: f32 = 1.1;

/// Draws the panel at the lower left and returns its area. The panel is as large as its text. Long text is cut.
pub(super) fn draw(painter: &Painter, space: Rect, problem: &Problem<'_>) -> Rect {
    let inner = space.size() - 2.0 * style::PADDING;
    let heading = style::line(painter, problem.heading, style::HEADING_SIZE, style::ERROR, inner.x);
    let longest = problem.text.lines().map(width).max().unwrap_or(0) as f32;
    let fits = |size: &f32| longest * style::cell(painter, *size, LINE_HEIGHT).x <= inner.x;
    let size = SIZES.into_iter().find(fits).unwrap_or(SIZES[SIZES.len() - 1]);
    let cell = style::cell(painter, size, LINE_HEIGHT);

    let above = heading.size().y + HEADING_GAP;
    let room = vec2(inner.x / cell.x, (inner.y - above) / cell.y).floor().max(vec2(1.0, 1.0));
    let lines = cut(problem.text, room.y as usize, room.x as usize);
    let widest = lines.iter().map(|line| width(line)).max().unwrap_or(0) as f32 * cell.x;
    let text = vec2(widest.max(heading.size().x), above + lines.len() as f32 * cell.y);
    let outer = (text + 2.0 * style::PADDING).min(space.size());
    let rect = Rect::from_min_size(pos2(space.left(), space.bottom() - outer.y), outer);

    style::ground(painter, rect);
    let painter = painter.with_clip_rect(rect.intersect(painter.clip_rect()));
    let start = rect.min + style::PADDING;
    painter.galley(start, heading, style::ERROR);
    for (row, line) in lines.iter().enumerate() {
        let start = start + vec2(0.0, above + row as f32 * cell.y);
        for (column, text, color) in pieces(line) {
            draw_cells(&painter, start + vec2(column as f32 * cell.x, 0.0), text, color, size, cell.x);
        }
    }
    rect
}

/// Draws text so that each character begins in its column, even if a fallback font has other widths.
fn draw_cells(painter: &Painter, start: Pos2, text: &str, color: Color32, size: f32, cell: f32) {
    let mut column = 0;
    for run in runs(text) {
        let at = start + vec2(column as f32 * cell, 0.0);
        painter.text(at, egui::Align2::LEFT_TOP, run, style::monospace(size), color);
        column += width(run);
    }
}

/// Splits `text` into runs of ASCII and single characters beyond ASCII with their combining marks.
fn runs(text: &str) -> impl Iterator<Item = &str> {
    let mut rest = text;
    std::iter::from_fn(move || {
        let mut characters = rest.char_indices();
        let (_, first) = characters.next()?;
        let joins = |other: char| columns(other) == 0 || (first.is_ascii() && other.is_ascii());
        let end = characters.find(|(_, other)| !joins(*other)).map_or(rest.len(), |(at, _)| at);
        let (run, after) = rest.split_at(end);
        rest = after;
        Some(run)
    })
}

fn width(text: &str) -> usize {
    text.chars().map(columns).sum()
}

/// Cuts `text` to `rows` lines of `width_max` columns. If lines are left out, the last line gives their number.
fn cut(text: &str, rows: usize, width_max: usize) -> Vec<String> {
    let all: Vec<&str> = text.trim_end().lines().collect();
    let mut kept = all.clone();
    if all.len() > rows {
        kept.truncate(rows.saturating_sub(1));
        while kept.last().is_some_and(|line| line.trim().is_empty()) {
            kept.pop();
        }
    }
    let mut lines: Vec<String> = kept.iter().map(|line| cut_line(line, width_max)).collect();
    match all.len() - kept.len() {
        0 => {}
        1 => lines.push("… and 1 more line".to_owned()),
        more => lines.push(format!("… and {more} more lines")),
    }
    lines
}

fn cut_line(line: &str, width_max: usize) -> String {
    if width(line) <= width_max {
        return line.to_owned();
    }
    let mut column = 0;
    let fits = |character: &char| {
        column += columns(*character);
        column < width_max
    };
    line.chars().take_while(fits).chain(['…']).collect()
}

/// Splits a line into differently coloured parts. Returns the first column, text and colour of each part.
fn pieces(line: &str) -> Vec<(usize, &str, Color32)> {
    let split = |at: usize, left: Color32, right: Color32| {
        let (before, after) = line.split_at_checked(at).unwrap_or((line, ""));
        vec![(0, before, left), (width(before), after, right)]
    };
    let indent = line.len() - line.trim_start().len();
    let text = line.trim_start();
    if text.starts_with("error") {
        return split(indent + "error".len(), style::ERROR, style::TEXT);
    }
    if text.starts_with("-->") || text.starts_with(":::") || text.starts_with('…') {
        return vec![(0, line, style::DIM)];
    }
    if text.starts_with("= ") {
        return split(indent + 1, style::DIM, style::ACCENT);
    }
    if let Some((number, after)) = line.split_once('|')
        && number.chars().all(|character| character == ' ' || character.is_ascii_digit())
    {
        let marks = after.trim_start();
        let color = match marks.chars().next() {
            Some('^') if number.trim().is_empty() => style::ERROR,
            Some('-') if number.trim().is_empty() => style::ACCENT,
            _ => style::TEXT,
        };
        return split(number.len() + 1, style::DIM, color);
    }
    vec![(0, line, style::TEXT)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_that_do_not_fit_are_counted() {
        let text = "error: a\n1\n2\n\nerror: b\n";
        assert_eq!(cut(text, 5, 80), ["error: a", "1", "2", "", "error: b"]);
        let longer = format!("{text}3\n");
        for rows in [4, 5] {
            assert_eq!(cut(&longer, rows, 80), ["error: a", "1", "2", "… and 3 more lines"], "{rows} rows");
        }
        assert_eq!(cut("1\n2\n3", 1, 80), ["… and 3 more lines"]);
        assert_eq!(cut("", 4, 80), [""; 0]);
    }

    #[test]
    fn long_lines_end_in_an_ellipsis_within_their_columns() {
        assert_eq!(cut_line("abcdef", 6), "abcdef");
        assert_eq!(cut_line("abcdefg", 6), "abcde…");
        // A wide character takes two columns, so only the first of the wide characters fits.
        assert_eq!(cut_line("ab球球球", 6), "ab球…");
        assert_eq!(cut_line("ab球球", 6), "ab球球");
    }

    #[test]
    fn parts_have_the_colours_of_their_meaning() {
        let colors =
            |line| pieces(line).into_iter().map(|(_, text, color)| (text, color)).collect::<Vec<_>>();
        use style::{ACCENT, DIM, ERROR, TEXT};
        assert_eq!(colors("error: no such name"), [("error", ERROR), (": no such name", TEXT)]);
        assert_eq!(colors("  --> a.scene:3:4"), [("  --> a.scene:3:4", DIM)]);
        assert_eq!(colors("12 | a | ^b"), [("12 |", DIM), (" a | ^b", TEXT)]);
        assert_eq!(colors("12 | ^b"), [("12 |", DIM), (" ^b", TEXT)]);
        assert_eq!(colors("   |     ^^^ here"), [("   |", DIM), ("     ^^^ here", ERROR)]);
        assert_eq!(colors("   |     --- there"), [("   |", DIM), ("     --- there", ACCENT)]);
        assert_eq!(colors("   = help: try"), [("   =", DIM), (" help: try", ACCENT)]);
        assert_eq!(colors("a | b"), [("a | b", TEXT)]);
    }

    #[test]
    fn every_character_beyond_ascii_is_placed_by_itself() {
        assert_eq!(runs("ab 球e\u{301}ü!").collect::<Vec<_>>(), ["ab ", "球", "e\u{301}", "ü", "!"]);
        assert_eq!(runs("").count(), 0);
    }
}
