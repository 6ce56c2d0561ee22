//! Draws the completion list: names, and documentation of the selected name.

use egui::{Color32, Id, LayerId, Order, Pos2, Rect, Sense, Ui, WidgetInfo, pos2, vec2};

use crate::editor::{ObjectPreview, Proposing};
use crate::overlay::acts::Acts;
use crate::overlay::{assisted, picture, style};

const ROWS: usize = 8;
const ROW: f32 = 18.0;
const WIDTH: f32 = 190.0;
const PICTURE: f32 = 72.0;
const ABOUT_WIDTH: f32 = 330.0;

/// Draws the list below `at`. If there is no room below, draws it above the text line, which has the height `line`.
pub(super) fn show(
    ui: &Ui,
    space: Rect,
    at: Pos2,
    line: f32,
    proposing: &Proposing,
    object_preview: Option<&ObjectPreview>,
    acts: &mut Acts,
) {
    let painter = ui.ctx().layer_painter(LayerId::new(Order::Foreground, Id::unique("proposals")));
    let count = proposing.list.len().min(ROWS);
    let size = vec2(WIDTH, count as f32 * ROW + 8.0);
    let below = at.y + 2.0 + size.y <= space.bottom();
    let top = if below { at.y + 2.0 } else { at.y - line - size.y - 2.0 };
    let left = (at.x - 6.0).min(space.right() - WIDTH).max(space.left());
    let rect = Rect::from_min_size(pos2(left, top), size);
    style::ground(&painter, rect);
    style::ground(&painter, rect);
    let first = proposing.selected.saturating_sub(ROWS - 1);
    for (row, (number, one)) in proposing.list.iter().enumerate().skip(first).take(ROWS).enumerate() {
        let place = Rect::from_min_size(
            pos2(rect.left() + 4.0, rect.top() + 4.0 + row as f32 * ROW),
            vec2(WIDTH - 8.0, ROW),
        );
        let selected = number == proposing.selected;
        let response = ui.interact(place, Id::unique(("proposal", row)), Sense::click());
        if selected || response.hovered() {
            painter.rect_filled(place, 3.0, style::RAIL);
        }
        let color = if selected { style::ACCENT } else { style::TEXT };
        let galley = style::line_in(&painter, &one.name, style::monospace(12.5), color, place.width() - 8.0);
        painter.galley(pos2(place.left() + 4.0, place.center().y - 0.5 * galley.size().y), galley, color);
        response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, &one.name));
        if response.clicked() {
            acts.on_editor(move |editor| editor.accept_proposal(number));
        }
    }
    let Some(one) = proposing.list.get(proposing.selected) else { return };
    assisted::text(ui.ctx(), "proposal", &format!("{}: {}", one.about.head, one.about.text), true);
    let width = ABOUT_WIDTH.min(ui.ctx().viewport_rect().right() - rect.right() - 16.0);
    if width < 120.0 {
        return;
    }
    let head = painter.layout(one.about.head.clone(), style::monospace(12.0), style::ACCENT, width - 16.0);
    let text = painter.layout(one.about.text.clone(), style::proportional(12.5), style::TEXT, width - 16.0);
    let facts = painter.layout(one.about.facts.clone(), style::proportional(11.5), style::DIM, width - 16.0);
    let parts = [head, text, facts].map(|part| Some(part).filter(|part| !part.text().is_empty()));
    let parts: Vec<_> = parts.into_iter().flatten().collect();
    let height: f32 = parts.iter().map(|part| part.size().y + 3.0).sum();
    let widest = parts.iter().map(|part| part.size().x).fold(0.0, f32::max);
    let picture_height = object_preview.map_or(0.0, |_| PICTURE + 6.0);
    let size = vec2(widest.max(picture_height) + 16.0, height + picture_height + 11.0);
    let about = Rect::from_min_size(rect.right_top() + vec2(4.0, 0.0), size);
    style::ground(&painter, about);
    style::ground(&painter, about);
    let mut y = about.top() + 6.0;
    if let Some(object_preview) = object_preview {
        let place = Rect::from_min_size(pos2(about.left() + 8.0, y + 1.0), vec2(PICTURE, PICTURE));
        painter.rect_filled(place, 4.0, style::RAIL);
        let (uv, white) = (Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0)), Color32::WHITE);
        painter.image(picture::texture(ui.ctx(), object_preview), place, uv, white);
        y += picture_height;
    }
    for part in parts {
        let height = part.size().y;
        painter.galley(pos2(about.left() + 8.0, y), part, style::TEXT);
        y += height + 3.0;
    }
}
