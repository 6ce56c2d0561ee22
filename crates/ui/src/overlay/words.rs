//! Buttons that consist of words.

use egui::{Rect, Response, Sense, Ui, WidgetInfo, vec2};

use super::style;

/// Height of a button with the space around it.
pub(super) const BUTTON: f32 = 24.0;
const PADDING: f32 = 7.0;

/// A button with these words. A button that is not `enabled` is dim and ignores clicks.
pub(super) fn button(ui: &mut Ui, words: &str, enabled: bool) -> Response {
    let font = style::proportional(style::TEXT_SIZE);
    let room = (ui.available_width() - 2.0 * PADDING).max(60.0);
    let galley = style::line(ui.painter(), words, font, style::ACCENT, room);
    let sense = if enabled { Sense::click() } else { Sense::hover() };
    let (place, response) = ui.allocate_exact_size(vec2(galley.size().x + 2.0 * PADDING, BUTTON), sense);
    let color = match (enabled, response.hovered()) {
        (false, _) => style::DIM,
        (true, true) => style::TEXT,
        (true, false) => style::ACCENT,
    };
    if enabled {
        ui.painter().rect_filled(place.shrink2(vec2(0.0, 2.0)), 4.0, style::RAIL);
    }
    ui.painter().galley_with_override_text_color(place.center() - 0.5 * galley.size(), galley, color);
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, enabled, words));
    response
}

/// A line of dim words at the bottom of `place`.
pub(super) fn hint(ui: &Ui, place: Rect, words: &str) {
    let font = style::proportional(style::SMALL_SIZE);
    let galley = style::line(ui.painter(), words, font, style::DIM, place.width());
    ui.painter().galley(
        egui::pos2(place.left(), place.center().y - 0.5 * galley.size().y),
        galley,
        style::DIM,
    );
}
