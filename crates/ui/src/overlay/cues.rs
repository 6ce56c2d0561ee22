//! The entries of the show: the present one, the times of the others, and entries that wait for a key.

use egui::{Id, Order, Rect, ScrollArea, Sense, Ui, WidgetInfo, pos2, vec2};

use super::acts::{Acts, Pass};
use super::chips::{self, Chip};
use super::content::{CueRow, CueSheet};
use super::now_playing::clock_time;
use super::{kept, style};
use mariana_commands::Command;

/// Width of the panel in points, if the window is wide enough.
const WIDTH: f32 = 380.0;
const ROW: f32 = 24.0;
/// Width of the column of moments, as a part of the panel's width.
const MOMENT: f32 = 0.4;

/// Draws the panel, and scrolls to the present entry when another entry becomes present. Returns the panel's area.
pub(super) fn show(pass: &mut Pass<'_>, space: Rect, sheet: &CueSheet) -> Rect {
    let Pass { context, acts } = pass;
    style::panel(context, "cues", Order::Middle, style::right_part(space, WIDTH), |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        buttons(ui, sheet, acts);
        ui.add_space(6.0);
        let height = (space.height() - 2.0 * style::PADDING.y - 2.0 * ROW).max(ROW);
        let mut scroll = ScrollArea::vertical().max_height(height);
        let before = kept::replace(ui.ctx(), Id::unique("present entry"), sheet.current);
        if let Some(current) = sheet.current.filter(|_| before != Some(sheet.current)) {
            scroll = scroll.vertical_scroll_offset(style::scrolled_to(current, ROW, height));
        }
        scroll.show_rows(ui, ROW, sheet.rows.len(), |ui, rows| {
            ui.set_width((ui.available_width() - style::LANE).max(0.0));
            for index in rows {
                if let Some(cue) = sheet.rows.get(index) {
                    row(ui, cue, index, sheet.current, acts);
                }
            }
        });
    })
}

/// The buttons for the next and the previous entry.
fn buttons(ui: &mut Ui, sheet: &CueSheet, acts: &mut Acts) {
    if sheet.rows.is_empty() {
        let words = "no show is running: press A to let scenes follow the song";
        let galley = style::line(ui.painter(), words, style::TEXT_SIZE, style::DIM, ui.available_width());
        let (place, _) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::hover());
        ui.painter().galley(place.left_top(), galley, style::DIM);
        return;
    }
    let chips = [
        Chip::new("back", "back to the entry before".to_owned(), false),
        Chip::new("next", "next entry".to_owned(), false),
    ];
    match chips::row(ui, "steps", chips) {
        Some(0) => acts.commands.push(Command::PreviousCue),
        Some(_) => acts.commands.push(Command::CueAt(next(sheet) + 1)),
        None => {}
    }
}

/// The index of the entry after the present one: of the entries that wait or begin later, the first.
fn next(sheet: &CueSheet) -> usize {
    let now = sheet.current.and_then(|current| sheet.rows.get(current)?.start);
    let later = |cue: &CueRow| match (cue.start, now) {
        (None, _) => cue.waits,
        (Some(start), Some(now)) => start > now,
        (Some(_), None) => true,
    };
    let after = sheet.current.map_or(0, |current| current + 1);
    let found = sheet.rows.iter().enumerate().skip(after).find(|(_, cue)| later(cue));
    found.map_or(sheet.rows.len(), |(index, _)| index)
}

fn row(ui: &mut Ui, cue: &CueRow, index: usize, current: Option<usize>, acts: &mut Acts) {
    let (place, response) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::click());
    let painter = ui.painter().clone();
    style::light(&painter, place, response.hovered());
    let color = style::lit(current == Some(index), cue.start.is_some() || cue.waits, style::DIM);
    let time = match cue.start {
        Some(start) => clock_time(start),
        None if cue.waits => "Enter".to_owned(),
        None => "–".to_owned(),
    };
    let scene = &cue.scene;
    let put = |text: &str, x: f32, width: f32, color| {
        style::put(&painter, pos2(x, place.center().y), text, style::SMALL_SIZE, color, width);
    };
    let (time_width, moment_width) = (46.0, MOMENT * place.width());
    let left = place.left() + 4.0;
    put(&time, left, time_width, style::DIM);
    put(&cue.moment, left + time_width, moment_width - 6.0, style::DIM);
    let x = left + time_width + moment_width;
    put(scene, x, place.right() - x, color);
    let words = format!("entry {}: {scene} at {}, {time}", index + 1, cue.moment);
    response.widget_info(|| WidgetInfo::selected(egui::Role::Button, true, current == Some(index), &words));
    if response.clicked() {
        acts.commands.push(Command::CueAt(index + 1));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    #[test]
    fn the_next_entry_waits_or_begins_later() {
        let cue = |start, waits| CueRow { moment: String::new(), start, waits, scene: String::new() };
        let rows = vec![cue(Some(0.0), false), cue(Some(4.0), true), cue(None, true), cue(Some(9.0), false)];
        let sheet = |current| CueSheet { rows: Arc::new(rows.clone()), current };
        assert_eq!([None, Some(0), Some(1), Some(2), Some(3)].map(|at| next(&sheet(at))), [0, 1, 2, 3, 4]);
    }
}
