//! Draws the editor at the left of the window: tabs and buttons, the text, and a footer with messages.

mod card;
mod cross;
mod light;
mod page;
mod picker;
mod popup;
mod profile;
mod text;

pub(super) use light::on_screen;

use egui::{Align, Id, Layout, Order, Rect, Sense, Ui, UiBuilder, WidgetInfo, pos2, vec2};

use super::acts::{Acts, Pass};
use super::chips::{self, Chip};
use super::rooms::Rooms;
use super::{assisted, icons, style};
use crate::editor::keys::written_rows;
use crate::editor::{Document, EditAction, Editor, Question};
use mariana_scenes::SceneSource;

/// Width of the editor as a fraction of the window's width. The next two constants limit this width, in points.
const WIDTH_FRACTION: f32 = 0.56;
const WIDTH_MIN: f32 = 500.0;
const WIDTH_MAX: f32 = 860.0;
const LINE: f32 = 24.0;
/// Minimum number of lines of text, so that the completion list has room.
const LINES_MIN: usize = 14;
/// Approximate height of everything around the text.
const AROUND: f32 = 112.0;
const EDGE: f32 = 10.0;

/// Draws the editor, and its marks and cards over the frame. Returns all these areas, the editor's area first.
pub(super) fn show(pass: &mut Pass<'_>, rooms: &Rooms, editor: &Editor) -> Vec<Rect> {
    let Pass { context, acts } = pass;
    let space = rooms.main;
    let fraction = if rooms.is_desk { 1.0 } else { WIDTH_FRACTION };
    let width = (fraction * space.width()).clamp(WIDTH_MIN.min(space.width()), WIDTH_MAX);
    // Make the editor only as high as its text, so that it hides as little of the frame as possible.
    let font = context.layer_painter(egui::LayerId::background());
    let cell = text::cell(&font).y;
    let text = editor.document().map_or(0.0, |document| text::height(&font, width - 2.0 * EDGE, document));
    let wanted = (text + 2.0 * cell).max(LINES_MIN as f32 * cell) + AROUND;
    let rect = Rect::from_min_size(space.min, vec2(width, wanted.min(space.height())));
    let screen = context.viewport_rect();
    light::show(context, screen, editor);
    let area = style::area(Id::unique("editor"), Order::Middle).fixed_pos(rect.min);
    let mut parts = vec![rect];
    area.show(context, |ui| {
        ui.set_clip_rect(rect);
        ui.allocate_rect(rect, Sense::click_and_drag());
        style::ground(ui.painter(), rect);
        let Some(document) = editor.document() else { return };
        let mut inner = rect.shrink2(vec2(EDGE, 6.0));
        inner.min.y = header(ui, inner, editor, document, acts);
        inner.min.y = question(ui, inner, document, acts);
        inner.max.y = footer(ui, inner, editor, document);
        inner.max.y = profile::show(ui, inner, editor, acts);
        parts.extend(text::show(ui, inner, editor, document, acts));
    });
    parts.extend(cross::show(context, screen, rect, editor, acts));
    let mut beside = rooms.side;
    if !rooms.is_desk {
        beside.min.x = (rect.right() + 8.0).min(space.right() - 60.0);
    }
    parts.extend(card::show(context, screen, beside, editor, acts));
    parts
}

fn header(ui: &mut Ui, space: Rect, editor: &Editor, document: &Document, acts: &mut Acts) -> f32 {
    let line = Rect::from_min_size(space.min, vec2(space.width(), LINE));
    let cross = Rect::from_center_size(pos2(line.right() - 0.5 * LINE, line.center().y), vec2(LINE, LINE));
    if icons::closing_cross(ui, cross, "close the editor (Esc)") {
        acts.on_editor(|editor| editor.act(EditAction::Leave));
    }
    let save = match (document.file(), document.is_dirty()) {
        (None, _) => Some("copy to my folder"),
        (_, true) => Some("save"),
        _ => None,
    };
    let save = save.map(|words| (words, EditAction::Save, None));
    let others = [
        ("new", EditAction::New, None),
        ("profile", EditAction::Profile, Some(editor.picture.profiles)),
        ("highlight", EditAction::Light, Some(editor.picture.lights)),
    ];
    let buttons = UiBuilder::new().max_rect(line.with_max_x(cross.left() - 6.0));
    let mut buttons = ui.new_child(buttons.layout(Layout::right_to_left(Align::Center)));
    for (words, command, is_on) in save.into_iter().chain(others) {
        if word(&mut buttons, words, command, is_on) {
            acts.on_editor(move |editor| editor.act(command));
        }
    }
    let (mut left, right) = (line.left(), buttons.min_rect().left() - 6.0);
    for (number, tab) in editor.texts.tabs().into_iter().enumerate() {
        let sign = if tab.dirty { " •" } else { "" };
        let color = match (tab.wrong, tab.shows) {
            (true, _) => style::ERROR,
            (false, true) => style::TEXT,
            (false, false) => style::DIM,
        };
        let (words, width) = (format!("{}{sign}", tab.name), (right - left).max(20.0));
        let galley = style::line(ui.painter(), &words, style::TEXT_SIZE, color, width);
        let rect = Rect::from_min_size(pos2(left, line.top()), vec2(galley.size().x, LINE));
        let at = rect.left_center() - vec2(0.0, 0.5 * galley.size().y);
        ui.painter().galley(at, galley, color);
        let response = ui.interact(rect, Id::unique(("editor tab", number)), Sense::click());
        response.widget_info(|| WidgetInfo::labeled(egui::Role::Tab, true, &tab.name));
        if response.clicked() && !tab.shows {
            acts.on_editor(move |editor| editor.show_text(number));
        }
        left = rect.right() + 14.0;
        if left > right {
            break;
        }
    }
    line.bottom() + 4.0
}

fn question(ui: &mut Ui, space: Rect, document: &Document, acts: &mut Acts) -> f32 {
    let (words, first, second) = match &document.question {
        None => return space.top(),
        Some(Question::Kept(_)) => ("There is unsaved text from last time.", "restore it", "discard it"),
        Some(Question::Conflict(_)) => {
            ("Another program has changed this file.", "keep my text", "load the new one")
        }
        Some(Question::Gone) => {
            ("This file was deleted. Your text is still here.", "save it again", "leave it")
        }
    };
    assisted::text(ui.ctx(), "question", words, true);
    let font = style::proportional(style::SMALL_SIZE);
    let job = egui::text::LayoutJob::simple(words.to_owned(), font, style::ERROR, space.width().max(1.0));
    let galley = ui.painter().layout_job(job);
    // In a narrow editor the sentence has lines of its own above the buttons.
    let layout = Layout::left_to_right(Align::Center).with_main_wrap(true);
    let line = Rect::from_min_size(space.min, vec2(space.width(), LINE));
    let mut row = ui.new_child(UiBuilder::new().max_rect(line).layout(layout));
    let (place, _) = row.allocate_exact_size(galley.size().max(vec2(0.0, LINE)), Sense::hover());
    let top = place.center().y - 0.5 * galley.size().y;
    row.painter().galley(pos2(place.left(), top), galley, style::ERROR);
    for (words, is_first) in [(first, true), (second, false)] {
        if word(&mut row, words, EditAction::Answer { first: is_first }, None) {
            acts.on_editor(move |editor| editor.apply_answer(is_first));
        }
    }
    row.min_rect().bottom() + 4.0
}

fn written_key(action: EditAction) -> &'static str {
    written_rows().find(|row| row.action == action).map_or("", |row| row.written)
}

/// A button with words. Returns true if the user clicked it. `is_on` is the state of a switch.
fn word(ui: &mut Ui, words: &str, action: EditAction, is_on: Option<bool>) -> bool {
    let name = format!("{words} ({})", written_key(action));
    let role = is_on.map(|_| egui::Role::Button);
    let chip = Chip { role, ..Chip::new(words, name, is_on.unwrap_or_default()) };
    chips::single(ui, &chip, f32::INFINITY, Some(Id::unique(("editor word", words))))
}

/// Draws the mistake or documentation at the cursor, then the message or cursor position. Returns the footer's top.
fn footer(ui: &Ui, space: Rect, editor: &Editor, document: &Document) -> f32 {
    let painter = ui.painter();
    let (small, width) = (style::proportional(style::SMALL_SIZE), space.width());
    let mut lines = Vec::new();
    let mut add = |words: &str, font: egui::FontId, color| {
        let galley = style::line_in(painter, words, font, color, width);
        lines.push((galley, color));
    };
    if let Some(mistake) = document.mistake() {
        assisted::text(ui.ctx(), "mistake", &mistake.message, true);
        add(&mistake.message, small.clone(), style::ERROR);
        add(&mistake.hint, small.clone(), style::ACCENT);
    } else if let Some(warning) = document.warning() {
        add(&warning.message, small.clone(), style::DIM);
        add(&warning.hint, small.clone(), style::ACCENT);
    } else if let Some(about) = document.about(document.editing.cursor()).map(|(_, about)| about) {
        let facts = if about.facts.is_empty() { String::new() } else { format!("  [{}]", about.facts) };
        add(&about.head, style::monospace(style::SMALL_SIZE), style::ACCENT);
        add(&format!("{}{facts}", about.text), small.clone(), style::DIM);
    } else {
        add("", small.clone(), style::DIM);
        add("", small.clone(), style::DIM);
    }
    match (editor.finding.line.as_ref(), editor.notice.words()) {
        (Some(find), answer) => {
            let cursor = if find.typing { "|" } else { "" };
            let answer = answer.map_or(String::new(), |answer| format!("   {answer}"));
            let letters = if find.typing { editor.preedit() } else { "" };
            add(&format!("find: {}{letters}{cursor}{answer}", find.query), small, style::TEXT);
        }
        (None, Some(answer)) => {
            assisted::text(ui.ctx(), "answer", answer, true);
            add(answer, small, style::TEXT);
        }
        (None, None) => {
            let (editing, buffer) = (&document.editing, document.editing.buffer());
            let line = buffer.line_of(editing.cursor());
            let inside = editing.cursor() - buffer.line_start(line);
            let column = mariana_editing::cells(buffer.line(line)).filter(|cell| cell.start < inside).count();
            let state = match &document.source {
                SceneSource::File(_) if document.is_dirty() => "not saved",
                SceneSource::File(_) if document.disk.is_none() => "loading",
                SceneSource::File(_) => "saved",
                SceneSource::Formula(_) => "a formula without a file",
                _ => "comes with Mariana",
            };
            let focus = if editor.has_focus() { "" } else { " · keys control the show: click here to type" };
            add(&format!("line {}, {} · {state}{focus}", line + 1, column + 1), small, style::DIM);
        }
    }
    let heights: f32 = lines.iter().map(|(galley, _)| galley.size().y.max(15.0) + 2.0).sum();
    let top = space.bottom() - heights;
    painter.hline(space.x_range(), top - 3.0, egui::Stroke::new(1.0, style::RAIL));
    let mut y = top;
    for (galley, color) in lines {
        let height = galley.size().y.max(15.0) + 2.0;
        painter.galley(pos2(space.left(), y), galley, color);
        y += height;
    }
    top - 6.0
}
