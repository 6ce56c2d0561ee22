//! Draws the card about the clicked point of the frame.

use egui::{Context, Id, LayerId, Order, Pos2, Rect, Sense, Stroke, WidgetInfo, pos2, vec2};

use super::light::on_screen;
use crate::editor::Editor;
use crate::overlay::acts::Acts;
use crate::overlay::{assisted, icons, style};
use mariana_scenes::probing::Surface;

/// Width of the card. The next constant is the width of the column of names in the card.
const WIDTH: f32 = 250.0;
const NAMES: f32 = 62.0;
const ROW: f32 = 17.0;
const APART: f32 = 16.0;

pub(super) fn show(
    context: &Context,
    screen: Rect,
    space: Rect,
    editor: &Editor,
    acts: &mut Acts,
) -> Option<Rect> {
    let probed = editor.picture.probed.as_ref()?;
    let point = on_screen(editor.picture.map.as_ref()?, screen, probed.at)?;
    let marks = context.layer_painter(LayerId::new(Order::Background, Id::unique("probed point")));
    for (radius, width, color) in [(6.0, 3.5, style::ON_ACCENT), (6.0, 1.6, style::ACCENT)] {
        marks.circle_stroke(point, radius, Stroke::new(width, color));
    }
    let rows = rows(probed.surface.as_ref());
    let names = if probed.surface.is_some() { NAMES } else { 0.0 };
    let written = probed.surface.as_ref().and_then(|surface| surface.written.clone());
    let line = written.and_then(|(file, range)| editor.texts.line_at(file, range));
    let head = probed.surface.as_ref().map_or("the sky", |surface| surface.object.as_str());
    let reported: Vec<String> = rows.iter().map(|(name, value)| format!("{name} {value}")).collect();
    let of_line = line.as_ref().map(|(name, number, words)| format!("{name}, line {number}: {words}"));
    let words = [&[head.to_owned()], reported.as_slice(), of_line.as_slice()].concat().join("; ");
    assisted::text(context, "probed", &words, true);

    let height = 14.0 + ROW * (1 + rows.len() + 2 * usize::from(line.is_some())) as f32;
    let rect = placed(space, point, vec2(WIDTH, height));
    let area = style::area(Id::unique("probed card"), Order::Foreground).fixed_pos(rect.min);
    area.show(context, |ui| {
        ui.set_clip_rect(rect.expand(1.0));
        ui.allocate_rect(rect, Sense::click_and_drag());
        let painter = ui.painter();
        style::ground(painter, rect);
        let cross = Rect::from_min_size(pos2(rect.right() - ROW - 6.0, rect.top() + 5.0), vec2(ROW, ROW));
        if icons::closing_cross(ui, cross, "close (Esc in the text)") {
            acts.on_editor(|editor| _ = editor.close_probed());
        }
        let (left, width) = (rect.left() + 10.0, rect.width() - 20.0);
        let mut y = rect.top() + 6.0;
        let mut add = |x: f32, text: &str, font, color, width: f32, next: f32| {
            let galley = style::line_in(painter, text, font, color, width);
            painter.galley(pos2(x, y), galley, color);
            y += next;
        };
        add(left, head, style::proportional(style::TEXT_SIZE), style::ACCENT, width - ROW, ROW + 2.0);
        for (name, value) in &rows {
            add(left, name, style::proportional(style::SMALL_SIZE), style::DIM, names, 0.0);
            let font =
                if names > 0.0 { style::monospace(12.0) } else { style::proportional(style::SMALL_SIZE) };
            add(left + names, value, font, style::TEXT, width - names, ROW);
        }
        let Some((name, number, words)) = &line else { return };
        let place = rect.with_min_y(rect.bottom() - 2.0 * ROW - 10.0).shrink(4.0);
        let response = ui.interact(place, Id::unique("probed line"), Sense::click());
        response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, words));
        if response.hovered() {
            painter.rect_filled(place, 3.0, style::RAIL);
        }
        let heading = format!("{name}, line {number}: click to go there");
        add(left, &heading, style::proportional(style::SMALL_SIZE), style::DIM, width, ROW);
        add(left, words, style::monospace(12.0), style::TEXT, width, ROW);
        if response.clicked() {
            acts.on_editor(Editor::jump_to_probed);
        }
    });
    Some(rect)
}

fn rows(surface: Option<&Surface>) -> Vec<(&'static str, String)> {
    let Some(surface) = surface else { return vec![("", "no surface in this direction".to_owned())] };
    let three = |v: [f32; 3], decimals: usize| {
        let [x, y, z] = v.map(|part| {
            let text = format!("{part:.decimals$}");
            match text.strip_prefix('-') {
                Some(rest) if rest.trim_matches(['0', '.']).is_empty() => rest.to_owned(),
                _ => text,
            }
        });
        format!("{x}, {y}, {z}")
    };
    vec![
        ("material", surface.material.clone()),
        ("distance", format!("{:.3}", surface.distance)),
        ("position", three(surface.position, 3)),
        ("normal", three(surface.normal, 2)),
    ]
}

fn placed(space: Rect, point: Pos2, size: egui::Vec2) -> Rect {
    let right = point.x + APART + size.x <= space.right();
    let x = if right { point.x + APART } else { point.x - APART - size.x };
    // If there is no room next to the editor, the card covers the editor's edge.
    let x = x.max(space.left()).min(space.right() - size.x);
    let y = (point.y + APART).min(space.bottom() - size.y).max(space.top());
    // If there is room above the point, the card must not cover the point.
    let covers = Rect::from_min_size(pos2(x, y), size).contains(point);
    let above = point.y - APART - size.y;
    Rect::from_min_size(pos2(x, if covers && above >= space.top() { above } else { y }), size)
}
