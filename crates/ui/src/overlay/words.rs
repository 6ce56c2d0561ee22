//! Buttons that consist of words.

use egui::{InnerResponse, Rect, Response, Sense, Shape, Ui, Vec2, WidgetInfo, pos2, vec2};

use super::{icons, style};

/// Height of a button with the space around it.
pub(super) const BUTTON: f32 = 24.0;
const PADDING: f32 = 7.0;

/// A button with these words. A button that is not `enabled` is dim and ignores clicks.
pub(super) fn button(ui: &mut Ui, words: &str, enabled: bool) -> Response {
    let room = (ui.available_width() - 2.0 * PADDING).max(60.0);
    let galley = style::line(ui.painter(), words, style::TEXT_SIZE, style::ACCENT, room);
    let sense = if enabled { Sense::click() } else { Sense::hover() };
    let (place, response) = ui.allocate_exact_size(vec2(galley.size().x + 2.0 * PADDING, BUTTON), sense);
    let color = match (enabled, response.hovered()) {
        (false, _) => style::DIM,
        (true, true) => style::TEXT,
        (true, false) => style::ACCENT,
    };
    style::light(ui.painter(), place.shrink2(vec2(0.0, 2.0)), enabled);
    ui.painter().galley_with_override_text_color(place.center() - 0.5 * galley.size(), galley, color);
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, enabled, words));
    response
}

/// A line of dim words at the bottom of `place`.
pub(super) fn hint(ui: &Ui, place: Rect, words: &str) {
    style::put(ui.painter(), place.left_center(), words, style::SMALL_SIZE, style::DIM, place.width());
}

/// A row that consists of a name of this size and of values right of it.
pub(super) fn named_row<R>(
    ui: &mut Ui,
    size: Vec2,
    is_selected: bool,
    name: impl FnOnce(&Ui, Rect),
    values: impl FnOnce(&mut Ui) -> R,
) -> InnerResponse<R> {
    let ground = ui.painter().add(Shape::Noop);
    let drawn = ui.horizontal(|ui| {
        let (place, _) = ui.allocate_exact_size(size, Sense::hover());
        name(ui, place);
        let values = ui.vertical(|ui| {
            // The row is as wide as the panel, also for the pointer.
            ui.set_min_width(ui.available_width());
            ui.add_space(2.0);
            let values = values(ui);
            ui.add_space(2.0);
            values
        });
        values.inner
    });
    style::light_behind(ui, ground, drawn.response.rect, is_selected);
    drawn
}

/// The top of a panel: its title, which is the text of a search if `is_search`, a hint, and a close button with the
/// accessible name `closing`. Returns true if the button was clicked.
pub(super) fn heading(
    ui: &mut Ui,
    height: f32,
    title: &str,
    hint: &str,
    is_search: bool,
    closing: &str,
) -> bool {
    let (place, _) = ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::hover());
    let cross = Rect::from_center_size(place.right_center() - vec2(0.5 * height, 3.0), vec2(height, height));
    let is_closed = icons::closing_cross(ui, cross, closing);
    let painter = ui.painter();
    let room = cross.left() - place.left() - 22.0;
    let titled = |room: f32| style::line(painter, title, style::HEADING_SIZE, style::TEXT, room);
    // A long title leaves a third of the room to the hint.
    let hint_room = (room - titled(room).size().x).max(room / 3.0);
    let hint = style::line(painter, hint, style::SMALL_SIZE, style::DIM, hint_room);
    let title = titled(room - hint.size().x);
    let end = place.left() + title.size().x;
    if is_search {
        style::caret(painter, pos2(end + 2.0, place.top()));
    }
    let top = place.top() + title.size().y - hint.size().y - 1.0;
    painter.galley(pos2(end + 14.0, top), hint, style::DIM);
    painter.galley(place.min, title, style::TEXT);
    is_closed
}
