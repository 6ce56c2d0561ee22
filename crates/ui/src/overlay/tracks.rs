//! The track list: a click plays a track, a drag moves a track, and the cross removes a track.

use egui::{Id, Order, Rect, ScrollArea, Sense, Ui, WidgetInfo, pos2, vec2};
use mariana_commands::Command;
use mariana_player::ListedTracks;

use super::events::UiEvent;
use super::icons::{self, Icon};
use super::now_playing::clock_time;
use super::style;

/// Width of the panel in points, if the window is wide enough.
const WIDTH: f32 = 380.0;
const ROW: f32 = 24.0;
const LANE: f32 = 10.0;

/// The content of the panel.
#[derive(Debug, Clone, Copy)]
pub struct Tracks<'a> {
    /// The tracks.
    pub list: &'a ListedTracks,
    /// The index of the playing track.
    pub present: usize,
}

pub(super) fn show(
    context: &egui::Context,
    space: Rect,
    tracks: &Tracks<'_>,
    events: &mut Vec<UiEvent>,
) -> Rect {
    let width = WIDTH.min(space.width());
    let area =
        style::area(Id::unique("tracks"), Order::Middle).fixed_pos(pos2(space.right() - width, space.top()));
    let shown = area.show(context, |ui| {
        style::frame().show(ui, |ui| {
            ui.set_width((width - 2.0 * style::PADDING.x).max(0.0));
            ui.spacing_mut().item_spacing.y = 0.0;
            heading(ui, tracks);
            let height = (space.height() - 2.0 * style::PADDING.y - 1.5 * ROW).max(ROW);
            let scroll = ScrollArea::vertical().max_height(height);
            scroll.show_rows(ui, ROW, tracks.list.entries.len(), |ui, rows| {
                ui.set_width((ui.available_width() - LANE).max(0.0));
                rows.for_each(|index| row(ui, tracks, index, events));
            });
        });
    });
    shown.response.rect
}

fn heading(ui: &mut Ui, tracks: &Tracks<'_>) {
    let count = tracks.list.entries.len();
    let words = match count {
        1 => "1 track · drop music here to play it, with Shift to add it".to_owned(),
        _ => format!("{count} tracks · drop music here to play it, with Shift to add it"),
    };
    let (place, _) = ui.allocate_exact_size(vec2(ui.available_width(), 1.5 * ROW), Sense::hover());
    let font = style::proportional(style::SMALL_SIZE);
    let galley = style::line(ui.painter(), &words, font, style::DIM, place.width());
    ui.painter().galley(place.left_top(), galley, style::DIM);
}

fn row(ui: &mut Ui, tracks: &Tracks<'_>, index: usize, events: &mut Vec<UiEvent>) {
    let Some(track) = tracks.list.entries.get(index) else { return };
    let (place, response) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::click_and_drag());
    let cross = Rect::from_center_size(place.right_center() - vec2(0.5 * ROW, 0.0), vec2(ROW, ROW));
    let crossed = ui.interact(cross, response.id.with("remove"), Sense::click());
    let over = response.contains_pointer() || crossed.contains_pointer();
    let painter = ui.painter().clone();
    if over {
        painter.rect_filled(place, 4.0, style::RAIL);
        let color = if crossed.hovered() { style::TEXT } else { style::DIM };
        icons::draw(&painter, Icon::Cross, cross, 11.0, color);
    }
    let is_present = index == tracks.present;
    let color = if is_present { style::ACCENT } else { style::TEXT };
    let small = |text: &str| {
        let font = style::proportional(style::SMALL_SIZE);
        style::line(&painter, text, font, style::DIM, 80.0)
    };
    let number = small(&(index + 1).to_string());
    let length = small(&track.duration.map(clock_time).unwrap_or_default());
    let indent = 10.0 + 7.5 * tracks.list.entries.len().to_string().len() as f32;
    let right = cross.left() - length.size().x - 4.0;
    let room = right - place.left() - indent - 6.0;
    let name = style::line(&painter, &track.name, style::proportional(style::TEXT_SIZE), color, room);
    let put = |galley: std::sync::Arc<egui::Galley>, x: f32| {
        painter.galley(pos2(x, place.center().y - 0.5 * galley.size().y), galley, color);
    };
    put(number, place.left() + 2.0);
    put(name, place.left() + indent);
    put(length, right);

    response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, &track.name));
    crossed.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, format!("remove {}", track.name)));
    if crossed.clicked() {
        events.push(UiEvent::Command(Command::RemoveTrack(index)));
    } else if response.clicked() {
        events.push(UiEvent::Command(Command::PlayTrack(index)));
    }
    response.dnd_set_drag_payload(index);
    // Draw a line at the drop position: above or below the row under the pointer.
    let Some(pointer) = response.ctx.pointer_interact_pos().filter(|_| response.contains_pointer()) else {
        return;
    };
    let below = pointer.y > place.center().y;
    if response.dnd_hover_payload::<usize>().is_some() {
        let y = if below { place.bottom() } else { place.top() };
        painter.hline(place.x_range(), y, egui::Stroke::new(2.0, style::ACCENT));
    }
    if let Some(from) = response.dnd_release_payload::<usize>() {
        let gap = index + usize::from(below);
        let to = if gap > *from { gap - 1 } else { gap };
        if to != *from {
            events.push(UiEvent::Command(Command::MoveTrack((*from, to))));
        }
    }
}
