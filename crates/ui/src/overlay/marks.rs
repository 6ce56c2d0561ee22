//! The marks on the seek bar: the ends of the part of the song that a video shows.

use egui::{Painter, Rect, Sense, Ui, pos2, vec2};
use mariana_music::SongStructure;

use super::acts::Acts;
use super::bar::Bar;
use super::{assisted, style};
use mariana_commands::{Command, Edge, Mark, Panel};

/// Width of the part of a mark that can be dragged, in points.
const HANDLE: f32 = 12.0;
/// A dragged mark snaps to a border within this distance, in points.
const REACH: f32 = 8.0;
/// The step of a focused mark, in seconds.
const STEP: f64 = 1.0;

/// Returns the border of a section, or the end of the track, within `reach` seconds of `time`; otherwise `time`.
pub fn near_border(time: f64, song: Option<&SongStructure>, duration: f64, reach: f64) -> f64 {
    let borders =
        song.into_iter().flat_map(|song| &song.sections).flat_map(|section| [section.start, section.end]);
    let borders = borders.chain([0.0, duration]).filter(|border| (border - time).abs() <= reach);
    let nearest = borders.min_by(|a, b| (a - time).abs().total_cmp(&(b - time).abs()));
    nearest.unwrap_or(time).clamp(0.0, duration.max(0.0))
}

/// Draws the marks over the seek bar, and moves the dragged one. While the panel of videos is open, there are always
/// marks to drag.
pub(super) fn show(ui: &Ui, place: Rect, bar: &Bar<'_>, duration: f64, acts: &mut Acts) {
    let whole = (bar.panels.open == Some(Panel::Video)).then_some([0.0, duration]);
    let Some(marks) = bar.marks.or(whole) else { return };
    let x = |time: f64| place.left() + (time / duration).clamp(0.0, 1.0) as f32 * place.width();
    let [left, right] = marks.map(x);
    let painter = ui.painter();
    for outside in [place.left()..=left, right..=place.right()] {
        let shade = Rect::from_x_y_ranges(outside, place.y_range());
        painter.rect_filled(shade, 0.0, style::GROUND.gamma_multiply(0.7));
    }
    let per_point = duration / f64::from(place.width().max(1.0));
    for (edge, at, name) in [
        (Edge::Start, marks[0], "start of the part for a video in seconds"),
        (Edge::End, marks[1], "end of the part for a video in seconds"),
    ] {
        let handle = Rect::from_center_size(pos2(x(at), place.center().y), vec2(HANDLE, place.height()));
        let response = ui.interact(handle, ui.scope_id().with(("mark", edge)), Sense::click_and_drag());
        draw(painter, x(at), place, edge, response.hovered() || response.dragged());
        let asked = assisted::rail(ui, &response, name, at, 0.0..=duration, STEP);
        let dragged = response.interact_pointer_pos().filter(|_| response.dragged());
        let dragged = dragged.map(|pointer| {
            let time = f64::from(pointer.x - place.left()) * per_point;
            near_border(time, bar.song, duration, f64::from(REACH) * per_point)
        });
        if let Some(time) = asked.or(dragged).filter(|time| *time != at) {
            acts.commands.push(Command::Mark(Mark { edge, at: Some(time) }));
        }
        let words = "drag to mark the part of the song for a video; the keys < and > mark the present moment";
        response.on_hover_text(words);
    }
}

/// Draws a bracket that opens towards the part.
fn draw(painter: &Painter, x: f32, place: Rect, edge: Edge, is_lit: bool) {
    let color = if is_lit { style::TEXT } else { style::ACCENT };
    let inwards = if edge == Edge::Start { 5.0 } else { -5.0 };
    painter.rect_filled(
        Rect::from_center_size(pos2(x, place.center().y), vec2(2.5, place.height())),
        0.0,
        color,
    );
    for y in [place.top() + 1.0, place.bottom() - 1.0] {
        let tip = Rect::from_two_pos(pos2(x, y - 1.0), pos2(x + inwards, y + 1.0));
        painter.rect_filled(tip, 0.0, color);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mariana_music::Section;

    #[test]
    fn marks_snap_to_the_borders_of_sections() {
        let section = |start, end| Section { start, end, letter: "A".to_owned(), energy: 0.5 };
        let song =
            SongStructure { sections: vec![section(0.0, 20.5), section(20.5, 40.0)], ..Default::default() };
        let snapped = |time, reach| near_border(time, Some(&song), 60.0, reach);
        assert_eq!([20.0, 21.4, 30.0].map(|time| snapped(time, 1.0)), [20.5, 20.5, 30.0]);
        assert_eq!([-3.0, 0.4, 59.5, 70.0].map(|time| snapped(time, 1.0)), [0.0, 0.0, 60.0, 60.0]);
        assert_eq!(near_border(20.0, None, 60.0, 1.0), 20.0);
    }
}
