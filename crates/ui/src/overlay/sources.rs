//! Draws the list of sound sources.

use egui::{Id, Order, Rect, ScrollArea, Sense, pos2, vec2};

use super::acts::Pass;
use super::content::SourceList;
use super::{assisted, style};
use mariana_commands::Command;

/// Height of a row as a multiple of the text size.
const ROW: f32 = 1.7;
/// Maximum width of a row, as a fraction of the window's width.
const WIDTH_MAX: f32 = 0.6;

/// Draws the panel at the upper left of `space` and returns the panel's area. A click chooses a source.
pub(super) fn show(pass: &mut Pass<'_>, space: Rect, list: &SourceList) -> Rect {
    let Pass { context, acts } = pass;
    let row_height = ROW * style::TEXT_SIZE;
    let area = style::area(Id::unique("sources"), Order::Foreground).fixed_pos(space.min);
    let shown = area.show(context, |ui| {
        style::frame().show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            let line = |text: &str, color| {
                style::line(ui.painter(), text, style::TEXT_SIZE, color, WIDTH_MAX * space.width())
            };
            let heading = line("D: listen to", style::DIM);
            let rows: Vec<_> = list
                .names
                .iter()
                .enumerate()
                .map(|(index, name)| {
                    let (mark, color) =
                        if list.present == Some(index) { (">", style::ACCENT) } else { ("·", style::TEXT) };
                    (line(&format!("{mark} {name}"), color), name)
                })
                .collect();
            let widest = rows.iter().map(|(row, _)| row.size().x).fold(heading.size().x, f32::max);
            let (place, _) = ui.allocate_exact_size(vec2(widest, row_height), Sense::hover());
            ui.painter().galley(place.min, heading, style::DIM);
            let height = (space.height() - 2.0 * style::PADDING.y - row_height).max(row_height);
            ScrollArea::vertical().max_height(height).show(ui, |ui| {
                for (index, (galley, name)) in rows.into_iter().enumerate() {
                    let (place, response) = ui.allocate_exact_size(vec2(widest, row_height), Sense::click());
                    style::light(ui.painter(), place.expand2(vec2(5.0, 0.0)), response.hovered());
                    let top = place.center().y - 0.5 * galley.size().y;
                    ui.painter().galley(pos2(place.left(), top), galley, style::TEXT);
                    let is_present = list.present == Some(index);
                    assisted::selected(&response, egui::Role::RadioButton, is_present, name);
                    if response.clicked() {
                        acts.commands.push(Command::Listen(index));
                    } else if is_present && response.rect.is_positive() && !ui.is_rect_visible(place) {
                        response.scroll_to_me(None);
                    }
                }
            });
        });
    });
    shown.response.rect
}
