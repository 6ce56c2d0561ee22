//! Draws the file list with its shortcuts.

use egui::{Id, Order, Rect, ScrollArea, Sense, Ui, WidgetInfo, pos2, vec2};

use super::events::{FileListEvent, UiEvent};
use super::icons;
use super::style;
use crate::file_browser::FileBrowser;

const WIDTH_MAX: f32 = 760.0;
const ROW: f32 = 24.0;
const LANE: f32 = 10.0;

pub(super) fn show(
    context: &egui::Context,
    space: Rect,
    files: &FileBrowser,
    last_selected: &mut Option<usize>,
    events: &mut Vec<UiEvent>,
) -> Rect {
    let width = space.width().min(WIDTH_MAX);
    let area = style::area(Id::unique("files"), Order::Foreground)
        .fixed_pos(pos2(space.center().x - 0.5 * width, space.top()));
    let shown = area.show(context, |ui| {
        style::frame().show(ui, |ui| {
            ui.set_width((width - 2.0 * style::PADDING.x).max(0.0));
            ui.spacing_mut().item_spacing = vec2(6.0, 0.0);
            let mut ask = |request| events.push(UiEvent::Files(request));
            heading(ui, files, &mut ask);
            places(ui, files, &mut ask);
            rows(ui, space.height() - 2.0 * style::PADDING.y - 4.0 * ROW, files, last_selected, &mut ask);
            footing(ui);
        });
    });
    shown.response.rect
}

fn heading(ui: &mut Ui, files: &FileBrowser, ask: &mut impl FnMut(FileListEvent)) {
    let (place, _) = ui.allocate_exact_size(vec2(ui.available_width(), 1.2 * ROW), Sense::hover());
    let cross = Rect::from_center_size(place.right_center() - vec2(0.5 * ROW, 2.0), vec2(ROW, ROW));
    if icons::closing_cross(ui, cross, "close the list of files") {
        ask(FileListEvent::Close);
    }
    let words = match files.query() {
        "" => files.folder().display().to_string(),
        query => format!("{query} · in {}", files.folder().display()),
    };
    let font = style::proportional(style::HEADING_SIZE);
    let galley = style::line(ui.painter(), &words, font, style::TEXT, cross.left() - place.left() - 8.0);
    ui.painter().galley(place.min, galley, style::TEXT);
}

fn places(ui: &mut Ui, files: &FileBrowser, ask: &mut impl FnMut(FileListEvent)) {
    ui.horizontal_wrapped(|ui| {
        if word(ui, "up").clicked() {
            ask(FileListEvent::Up);
        }
        for (index, place) in files.places().iter().enumerate() {
            if word(ui, &place.name).clicked() {
                ask(FileListEvent::EnterPlace(index));
            }
        }
        ui.add_space(12.0);
        if word(ui, "play this folder").clicked() {
            ask(FileListEvent::OpenFolder { append: false });
        }
        if word(ui, "add this folder").clicked() {
            ask(FileListEvent::OpenFolder { append: true });
        }
    });
}

fn word(ui: &mut Ui, words: &str) -> egui::Response {
    let font = style::proportional(style::TEXT_SIZE);
    let galley = style::line(ui.painter(), words, font, style::ACCENT, ui.available_width().max(80.0));
    let (place, response) = ui.allocate_exact_size(vec2(galley.size().x + 14.0, ROW), Sense::click());
    let color = if response.hovered() { style::TEXT } else { style::ACCENT };
    ui.painter().rect_filled(place.shrink2(vec2(0.0, 2.0)), 4.0, style::RAIL);
    ui.painter().galley_with_override_text_color(place.center() - 0.5 * galley.size(), galley, color);
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, words));
    response
}

fn rows(
    ui: &mut Ui,
    height: f32,
    files: &FileBrowser,
    last_selected: &mut Option<usize>,
    ask: &mut impl FnMut(FileListEvent),
) {
    if let Some(trouble) = files.trouble() {
        let (place, _) = ui.allocate_exact_size(vec2(ui.available_width(), 2.0 * ROW), Sense::hover());
        let font = style::proportional(style::TEXT_SIZE);
        let galley = style::line(ui.painter(), trouble, font, style::DIM, place.width());
        ui.painter().galley(place.left_center() - vec2(0.0, 0.5 * galley.size().y), galley, style::DIM);
        return;
    }
    let height = height.max(2.0 * ROW);
    let mut scroll = ScrollArea::vertical().max_height(height).auto_shrink([false, true]);
    if last_selected.replace(files.selected()) != Some(files.selected()) {
        scroll = scroll.vertical_scroll_offset(style::scrolled_to(files.selected(), ROW, height));
    }
    scroll.show_rows(ui, ROW, files.count(), |ui, places| {
        ui.set_width((ui.available_width() - LANE).max(0.0));
        for place in places {
            let Some(entry) = files.entry(place) else { break };
            let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::click());
            let painter = ui.painter();
            if place == files.selected() || response.hovered() {
                painter.rect_filled(rect, 4.0, style::RAIL);
            }
            let color = if place == files.selected() { style::ACCENT } else { style::TEXT };
            let words = if entry.is_folder { format!("{}/", entry.name) } else { entry.name.clone() };
            let font = style::proportional(style::TEXT_SIZE);
            let galley = style::line(painter, &words, font, color, rect.width() - 12.0);
            painter.galley(pos2(rect.left() + 6.0, rect.center().y - 0.5 * galley.size().y), galley, color);
            response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, &entry.name));
            if response.clicked() {
                let append = ui.input(|input| input.modifiers.shift);
                ask(FileListEvent::Open { place, append });
            }
        }
    });
}

fn footing(ui: &mut Ui) {
    let (place, _) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::hover());
    let words =
        "type to search · Enter opens, Shift+Enter adds, Ctrl+Enter plays the folder · Backspace goes up";
    let font = style::proportional(style::SMALL_SIZE);
    let galley = style::line(ui.painter(), words, font, style::DIM, place.width());
    ui.painter().galley(pos2(place.left(), place.bottom() - galley.size().y), galley, style::DIM);
}
