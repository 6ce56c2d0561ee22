//! Draws the visible lines of the text: line numbers, colours, selection, mistakes, cursor, and grips on numbers.

use egui::output::IMEOutput;
use egui::text::{LayoutJob, TextFormat};
use egui::{
    Color32, CursorIcon, FontId, IMEPurpose, Id, Painter, PointerState, Pos2, Rect, Response, Sense, Stroke,
    StrokeKind, Ui, Vec2, pos2, vec2,
};
use mariana_editing::{TripleKind, TurnSpeed, cells};
use mariana_field::lang::WordKind;

use super::page::Page;
use super::{picker, popup};
use crate::editor::{Document, Editor, Wrapping};
use crate::overlay::acts::{Acts, PanelAct};
use crate::overlay::{assisted, style};

const SIZE: f32 = 13.0;
/// Distance between lines, in line heights of the font.
const LINE_HEIGHT: f32 = 1.18;
const LANE: f32 = 10.0;
/// Height of a number's grip, and its overlap with the number's line.
const GRIP: (f32, f32) = (9.0, 3.0);
const GRIP_WIDTH_MIN: f32 = 18.0;
/// More rows than any window has.
const ROWS_COUNTED: usize = 200;

const SELECTED: Color32 = Color32::from_rgba_premultiplied(22, 40, 52, 90);
const CURRENT: Color32 = Color32::from_rgba_premultiplied(16, 17, 19, 22);

fn color_of(kind: WordKind) -> Color32 {
    match kind {
        WordKind::Number => Color32::from_rgb(244, 190, 120),
        WordKind::Keyword => Color32::from_rgb(208, 160, 240),
        WordKind::Function => style::ACCENT,
        WordKind::Input => Color32::from_rgb(150, 218, 160),
        WordKind::Name => style::TEXT,
        WordKind::Text => Color32::from_rgb(190, 214, 130),
        WordKind::Comment => Color32::from_rgb(172, 178, 190),
        WordKind::Sign => Color32::from_rgb(184, 190, 200),
        WordKind::Unknown => style::ERROR,
    }
}

pub(super) fn cell(painter: &Painter) -> Vec2 {
    style::cell(painter, SIZE, LINE_HEIGHT)
}

/// Number of columns of a row in a width. The last column is left free for a space or half of a wide letter.
fn columns_in(width: f32, cell: Vec2) -> usize {
    ((width / cell.x) as usize).saturating_sub(1)
}

/// Height of a text in an editor of a width: exact for short texts, the number of lines for long ones.
pub(super) fn height(painter: &Painter, width: f32, document: &Document) -> f32 {
    let (cell, buffer) = (cell(painter), document.editing.buffer());
    let columns = columns_in(width - gutter(document, cell) - LANE, cell);
    let rows = Wrapping::new(columns).rows_up_to(buffer, ROWS_COUNTED);
    rows.max(buffer.line_count()) as f32 * cell.y
}

fn gutter(document: &Document, cell: Vec2) -> f32 {
    let digits = document.editing.buffer().line_count().to_string().len().max(3) as f32;
    (digits + 1.5) * cell.x
}

/// Draws the text in `space`. Returns the area of the colour picker, if the picker is open.
pub(super) fn show(
    ui: &Ui,
    space: Rect,
    editor: &Editor,
    document: &Document,
    acts: &mut Acts,
) -> Option<Rect> {
    let buffer = document.editing.buffer();
    let font = style::monospace(SIZE);
    let cell = cell(ui.painter());
    let gutter = gutter(document, cell);
    let rect = Rect::from_min_max(space.min + vec2(gutter, 0.0), space.max - vec2(LANE, 0.0));
    let columns = columns_in(rect.width(), cell);
    let wrapping = Wrapping::new(columns);
    let page = Page::new(rect, cell, wrapping, buffer, document.view);
    let rows = (rect.height() / cell.y).max(1.0);
    acts.on_panels
        .push(PanelAct::Editor(Box::new(move |editor| editor.record_drawn(rows as usize, columns))));

    let whole = Rect::from_min_max(space.min, rect.max);
    let response = ui.interact(whole, Id::unique("editor text"), Sense::click_and_drag());
    let painter = ui.painter().with_clip_rect(space.intersect(ui.clip_rect()));
    let seen = page.seen.clone();
    draw_ground(&painter, space, &page, document);
    if let Some(line) = editor.probed_line().filter(|line| seen.contains(line)) {
        // Mark the line that drew the clicked point.
        let rect = Rect::from_min_size(pos2(space.left(), page.at(line, 0).y), vec2(3.0, cell.y));
        painter.rect_filled(rect, 1.0, style::ACCENT);
    }
    for line in seen.clone() {
        draw_number(&painter, space.left() + gutter - 1.5 * cell.x, &page, line, document);
        let clipped = painter.with_clip_rect(rect.intersect(painter.clip_rect()));
        draw_line(&clipped, &page, document, line, &font);
        draw_colors(&clipped, &page, document, line);
    }
    draw_mistakes(&painter, space, &page, document);
    draw_cursor(&painter, &page, document, editor.has_focus());
    if editor.finding.line.as_ref().is_none_or(|find| !find.typing) {
        draw_preedit(&painter, &page, document, editor.preedit(), &font);
    }
    point(ui, &painter, &page, editor, document, &response, acts);
    if wrapping.rows_up_to(buffer, rows as usize) > rows as usize || document.view != (0.0, 0.0) {
        lane(ui, space, document, rows, acts);
    }
    let cursor = document.editing.cursor();
    let line = buffer.line_of(cursor);
    let words = String::from_utf8_lossy(buffer.line(line)).into_owned();
    assisted::text(ui.ctx(), "editor", &format!("{}, line {}: {words}", document.name(), line + 1), false);
    if let Some(proposing) = editor.proposals.shown.as_ref() {
        let at = page.rect_of(buffer, &(proposing.from..cursor)).left_bottom();
        popup::show(ui, space, at, cell.y, proposing, editor.proposals.object_preview(), acts);
    }
    let (at, _) = editor.held_numbers.picked_color(document)?;
    picker::show(ui.ctx(), page.rect_of(buffer, &(at..at)), editor, acts)
}

fn draw_ground(painter: &Painter, space: Rect, page: &Page, document: &Document) {
    let (editing, buffer) = (&document.editing, document.editing.buffer());
    let current = buffer.line_of(editing.cursor());
    if page.seen.contains(&current) {
        painter.rect_filled(page.rect_of_line(current, space.left()), 2.0, CURRENT);
    }
    let selection = editing.selection();
    if selection.is_empty() {
        return;
    }
    for line in page.seen.clone() {
        let range = buffer.line_range(line);
        let (from, to) = (selection.start.max(range.start), selection.end.min(range.end));
        if from > to || selection.start >= buffer.line_start(line + 1) && line + 1 < buffer.line_count() {
            continue;
        }
        let mut rects = page.rects_of(buffer, &(from..to));
        if let Some(last) = rects.last_mut().filter(|_| selection.end > range.end) {
            last.max.x += 0.6 * page.cell.x;
        }
        for rect in rects {
            painter.rect_filled(rect, 0.0, SELECTED);
        }
    }
}

fn draw_number(painter: &Painter, right: f32, page: &Page, line: usize, document: &Document) {
    let is_current = document.editing.buffer().line_of(document.editing.cursor()) == line;
    let color = if is_current { style::TEXT } else { style::DIM };
    let galley = style::line_in(painter, &(line + 1).to_string(), style::monospace(SIZE), color, f32::MAX);
    painter.galley(pos2(right - galley.size().x, page.at(line, 0).y), galley, color);
}

/// Draws a line's letters. Letters beyond ASCII are placed one by one, because a fallback font may have other widths.
fn draw_line(painter: &Painter, page: &Page, document: &Document, line: usize, font: &FontId) {
    let text = document.editing.buffer().line(line);
    let words = document.words(line);
    let visible = page.visible_columns(line);
    let mut row_starts =
        page.starts(line).iter().copied().skip_while(|start| *start <= visible.start).peekable();
    let mut words = words.iter().peekable();
    let mut run = TextRun::default();
    for cell in cells(text) {
        if cell.column + cell.width <= visible.start {
            continue;
        }
        if cell.column >= visible.end {
            break;
        }
        if row_starts.next_if(|start| *start <= cell.column).is_some() {
            run.flush(painter, page, line);
        }
        while words.next_if(|word| word.end <= cell.start).is_some() {}
        let word = words.peek().filter(|word| word.start <= cell.start);
        let color = word.map_or(style::TEXT, |word| color_of(word.kind));
        let bytes = text.get(cell.start..cell.end).unwrap_or_default();
        let (shown, color) = match std::str::from_utf8(bytes) {
            Ok("\t") => continue,
            Ok(shown) if cell.is_text && !shown.contains(char::is_control) => (shown, color),
            _ => ("\u{fffd}", style::ERROR),
        };
        // A letter beyond ASCII has more bytes than columns, so the next letter begins another run.
        if !shown.is_ascii() || cell.column != run.column + run.job.text.len() {
            run.flush(painter, page, line);
            run.column = cell.column;
        }
        run.job.append(shown, 0.0, TextFormat::simple(font.clone(), color));
    }
    run.flush(painter, page, line);
}

fn draw_colors(painter: &Painter, page: &Page, document: &Document, line: usize) {
    let (triples, start) = document.triples(line);
    for triple in triples.into_iter().filter(|triple| triple.kind == TripleKind::Color) {
        let word = start + triple.word.start..start + triple.word.end;
        let mut rect = page.rect_of(document.editing.buffer(), &word);
        rect.min.y = rect.bottom() - 3.5;
        let (color, stroke) = (picker::screen_color(triple.values()), Stroke::new(0.5, style::AHEAD));
        painter.rect(rect, 1.5, color, stroke, StrokeKind::Outside);
    }
}

/// Letters side by side, and the column of the first one.
#[derive(Default)]
struct TextRun {
    column: usize,
    job: LayoutJob,
}

impl TextRun {
    fn flush(&mut self, painter: &Painter, page: &Page, line: usize) {
        let Self { column, job } = std::mem::take(self);
        if !job.text.trim().is_empty() {
            painter.galley(page.at(line, column), painter.layout_job(job), style::TEXT);
        }
    }
}

fn draw_mistakes(painter: &Painter, space: Rect, page: &Page, document: &Document) {
    let buffer = document.editing.buffer();
    let mistakes = document.mistakes().filter(|mistake| !mistake.range.is_empty() || mistake.range.start > 0);
    let warnings = document.warnings().map(|warning| (warning, style::DIM));
    for (mistake, color) in warnings.chain(mistakes.map(|mistake| (mistake, style::ERROR))) {
        let (first, last) = (buffer.line_of(mistake.range.start), buffer.line_of(mistake.range.end));
        for line in first.max(page.seen.start)..(last + 1).min(page.seen.end) {
            let range = buffer.line_range(line);
            let part =
                mistake.range.start.max(range.start)..mistake.range.end.min(range.end).max(range.start);
            let rects = page.rects_of(buffer, &part);
            if let Some(rect) = rects.first().filter(|_| line == first) {
                let at = pos2(space.left() + 3.0, rect.center().y);
                painter.circle_filled(at, 3.0, color);
            }
            for mut rect in rects.into_iter().filter(|rect| rect.y_range().intersects(page.rect.y_range())) {
                rect.max.x = rect.max.x.max(rect.min.x + page.cell.x);
                wave(painter, rect, color);
            }
        }
    }
}

fn wave(painter: &Painter, rect: Rect, color: Color32) {
    let (mut x, mut up) = (rect.left(), false);
    let mut points = Vec::new();
    while x <= rect.right() {
        points.push(pos2(x, rect.bottom() - if up { 3.5 } else { 1.0 }));
        (x, up) = (x + 2.5, !up);
    }
    painter.line(points, Stroke::new(1.3, color));
}

fn draw_cursor(painter: &Painter, page: &Page, document: &Document, focused: bool) {
    let cursor = document.editing.cursor();
    let rect = page.rect_of(document.editing.buffer(), &(cursor..cursor));
    let color = if focused { style::TEXT } else { style::AHEAD };
    painter.vline(rect.left(), rect.y_range(), Stroke::new(1.6, color));
    if focused {
        // An input method places its candidate window at this position.
        let cursor_rect = rect.intersect(page.rect);
        let (purpose, should_interrupt_composition) = (IMEPurpose::Normal, false);
        painter.ctx().output_mut(|output| {
            output.ime =
                Some(IMEOutput { purpose, rect: page.rect, cursor_rect, should_interrupt_composition });
        });
    }
}

/// Draws underlined text that an input method is composing. This text covers the text after the cursor.
fn draw_preedit(painter: &Painter, page: &Page, document: &Document, letters: &str, font: &FontId) {
    if letters.is_empty() {
        return;
    }
    let cursor = document.editing.cursor();
    let at = page.rect_of(document.editing.buffer(), &(cursor..cursor)).left_top();
    let galley = style::line_in(painter, letters, font.clone(), style::TEXT, f32::MAX);
    let rect = Rect::from_min_size(at, vec2(galley.size().x + 2.0, page.cell.y));
    painter.rect_filled(rect, 0.0, style::ON_ACCENT);
    painter.galley(at, galley, style::TEXT);
    painter.hline(rect.x_range(), rect.bottom() - 1.5, Stroke::new(1.5, style::ACCENT));
}

fn point(
    ui: &Ui,
    painter: &Painter,
    page: &Page,
    editor: &Editor,
    document: &Document,
    response: &Response,
    acts: &mut Acts,
) {
    let buffer = document.editing.buffer();
    let (modifiers, pointer, scrolled) =
        ui.input(|input| (input.modifiers, input.pointer.clone(), input.smooth_scroll_delta()));
    let (pressed, down) = (pointer.primary_pressed(), pointer.primary_down());
    if editor.held_numbers.turns_three() {
        // The user is changing the numbers with the picker or the cross, so the text ignores the pointer.
        if !down {
            acts.on_editor(Editor::let_go);
        }
        return;
    }
    if let Some(turned) = editor.held_numbers.turned() {
        let speed = match (modifiers.shift, modifiers.ctrl) {
            (true, _) => TurnSpeed::Fine,
            (false, true) => TurnSpeed::Coarse,
            (false, false) => TurnSpeed::Usual,
        };
        draw_grip(painter, grip_of(page.rect_of(buffer, &turned)), true);
        ui.ctx().set_cursor_icon(CursorIcon::ResizeHorizontal);
        let moved = pointer.delta().x;
        if !down {
            acts.on_editor(Editor::let_go);
        } else if moved != 0.0 {
            acts.on_editor(move |editor| editor.turn_number(moved, speed));
        }
        return;
    }
    let Some(at) = response.hover_pos().or_else(|| response.interact_pointer_pos()) else { return };
    if scrolled != Vec2::ZERO {
        let rows = -scrolled.y / page.cell.y;
        acts.on_editor(move |editor| editor.scroll(rows));
    }
    let offset = page.offset(buffer, at);
    let number = document.is_open().then(|| number_at(page, document, at)).flatten();
    let grips = number.as_ref().filter(|rect| modifiers.alt || grip_of(**rect).contains(at));
    if let Some(rect) = number.filter(|_| !response.dragged()) {
        draw_grip(painter, grip_of(rect), grips.is_some());
    }
    let color = color_at(page, document, at);
    ui.ctx().set_cursor_icon(match (grips.is_some(), color.is_some()) {
        (true, _) => CursorIcon::ResizeHorizontal,
        (false, true) => CursorIcon::PointingHand,
        (false, false) => CursorIcon::Text,
    });
    if let Some(rect) = grips.filter(|_| pressed) {
        let at = page.offset(buffer, rect.center());
        return acts.on_editor(move |editor| editor.grab(at));
    }
    if let Some(color) = color.filter(|_| response.clicked() && !modifiers.shift) {
        acts.on_editor(move |editor| editor.pick_color(color));
    } else if pressed && response.contains_pointer() {
        acts.on_editor(move |editor| editor.press(offset, 1, modifiers.shift));
    } else if response.triple_clicked() {
        acts.on_editor(move |editor| editor.press(offset, 3, false));
    } else if response.double_clicked() {
        acts.on_editor(move |editor| editor.press(offset, 2, false));
    } else if response.dragged() && down && has_moved(&pointer) {
        acts.on_editor(move |editor| editor.drag_to(offset));
    } else if grips.is_none() {
        hover_help(response, document, page, offset, at);
    }
}

/// True if the pointer has moved since the press. A small movement during a click must not select text.
fn has_moved(pointer: &PointerState) -> bool {
    let way = pointer.press_origin().zip(pointer.latest_pos());
    way.is_some_and(|(from, to)| from.distance(to) > 3.0)
}

fn number_at(page: &Page, document: &Document, at: Pos2) -> Option<Rect> {
    let buffer = document.editing.buffer();
    [at, at - vec2(0.0, GRIP.0)].into_iter().find_map(|near| {
        let offset = page.offset(buffer, near);
        let (number, start) = document.number(offset)?;
        let rect = page.rect_of(buffer, &(start + number.range.start..start + number.range.end));
        (rect.contains(near) || grip_of(rect).contains(at)).then_some(rect)
    })
}

fn color_at(page: &Page, document: &Document, at: Pos2) -> Option<usize> {
    let buffer = document.editing.buffer();
    let (triples, start) = document.triples(buffer.line_of(page.offset(buffer, at)));
    let mut words = triples.into_iter().filter(|triple| triple.kind == TripleKind::Color);
    words.find_map(|triple| {
        let word = start + triple.word.start..start + triple.word.end;
        page.rect_of(buffer, &word).contains(at).then_some(word.start)
    })
}

fn grip_of(number: Rect) -> Rect {
    let width = number.width().max(GRIP_WIDTH_MIN);
    Rect::from_min_size(pos2(number.center().x - 0.5 * width, number.bottom() - GRIP.1), vec2(width, GRIP.0))
}

fn draw_grip(painter: &Painter, rect: Rect, held: bool) {
    let color = if held { style::ACCENT } else { style::AHEAD };
    painter.rect_filled(rect.shrink2(vec2(0.0, 2.5)), 2.0, color);
    let middle = rect.center().y;
    for (x, way) in [(rect.left() - 5.0, -1.0), (rect.right() + 5.0, 1.0)] {
        let tip = pos2(x + 2.5 * way, middle);
        let ends = [tip - vec2(3.5 * way, 3.0), tip - vec2(3.5 * way, -3.0)];
        painter.line(vec![ends[0], tip, ends[1]], Stroke::new(1.4, color));
    }
}

fn hover_help(response: &Response, document: &Document, page: &Page, offset: usize, at: Pos2) {
    let buffer = document.editing.buffer();
    let line = buffer.line_of(offset);
    let behind = page.rect_of(buffer, &(offset..offset)).left() + page.cell.x;
    if at.x > behind || !response.hovered() {
        return;
    }
    if let Some(mistake) =
        document.mistakes().chain(document.warnings()).find(|one| one.range.contains(&offset))
    {
        let words = match mistake.hint.as_str() {
            "" => mistake.message,
            hint => format!("{}\n{hint}", mistake.message),
        };
        response.clone().on_hover_text_at_pointer(words);
        return;
    }
    let Some((range, about)) = document.about(offset) else { return };
    if buffer.line_of(range.start) != line || !(range.start..=range.end).contains(&offset) {
        return;
    }
    response.clone().on_hover_ui_at_pointer(|ui| {
        ui.set_max_width(420.0);
        ui.label(egui::RichText::new(&about.head).monospace().color(style::ACCENT));
        if !about.text.is_empty() {
            ui.label(&about.text);
        }
        if !about.facts.is_empty() {
            ui.label(egui::RichText::new(&about.facts).small().color(style::DIM));
        }
    });
}

fn lane(ui: &Ui, space: Rect, document: &Document, rows: f32, acts: &mut Acts) {
    let count = document.editing.buffer().line_count() as f32;
    let lane = Rect::from_min_max(pos2(space.right() - LANE + 3.0, space.top()), space.max);
    let response = ui.interact(lane, Id::unique("editor lane"), Sense::click_and_drag());
    let whole = count + 0.5 * rows;
    let y = |line: f32| lane.top() + line / whole * lane.height();
    let thumb = Rect::from_min_max(
        pos2(lane.left(), y(document.view.0)),
        pos2(lane.right(), y(document.view.0 + rows)),
    );
    let color = if response.hovered() || response.dragged() { style::DIM } else { style::AHEAD };
    ui.painter().rect_filled(thumb.shrink2(vec2(1.5, 0.0)), 2.0, color);
    for mistake in document.mistakes() {
        let at = y(document.editing.buffer().line_of(mistake.range.start) as f32);
        ui.painter().hline(lane.x_range(), at, Stroke::new(2.0, style::ERROR));
    }
    if let Some(at) = response.interact_pointer_pos().filter(|_| response.dragged() || response.clicked()) {
        let wanted = (at.y - lane.top()) / lane.height().max(1.0) * whole - 0.5 * rows;
        let rows = wanted - document.view.0;
        acts.on_editor(move |editor| editor.scroll(rows));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::overlay::style::tests::assert_legible;

    #[test]
    fn every_colour_of_the_text_is_legible_in_a_selection() {
        let kinds = [
            WordKind::Number,
            WordKind::Keyword,
            WordKind::Function,
            WordKind::Input,
            WordKind::Name,
            WordKind::Text,
            WordKind::Comment,
            WordKind::Sign,
            WordKind::Unknown,
        ];
        assert_legible(&kinds.map(color_of), &[style::GROUND]);
        assert_legible(&kinds.map(color_of), &[style::GROUND, CURRENT, SELECTED]);
    }
}
