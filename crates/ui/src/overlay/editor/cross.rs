//! A cross in the frame, at the position whose numbers are at the text cursor. The user drags the cross's arms to move
//! the position along an axis, or its middle to move the position in the view plane.

use egui::{Color32, Context, CursorIcon, Id, LayerId, Order, Pos2, Rect, Sense, Stroke, Vec2, vec2};
use glam::DVec3;

use super::light::on_screen;
use crate::editor::Editor;
use crate::overlay::acts::Acts;
use crate::overlay::style;
use mariana_render::frame::camera::Camera;
use mariana_render::placement::Map;

/// Length of an arm perpendicular to the view direction, in points.
const ARM: f32 = 64.0;
/// Minimum length of an arm that can be dragged. A shorter arm points at the camera.
const ARM_MIN: f32 = 10.0;
/// Half the side of a handle's clickable area.
const HANDLE: f32 = 9.0;
/// Speed while Shift is held, as a fraction of the usual speed.
const FINE: f64 = 0.1;
const COLORS: [Color32; 3] =
    [Color32::from_rgb(236, 96, 84), Color32::from_rgb(120, 204, 96), Color32::from_rgb(104, 148, 244)];

/// A draggable handle: its position, and pairs of a screen direction and the corresponding vector in the scene.
struct Handle {
    name: &'static str,
    at: Pos2,
    ways: Vec<(Vec2, DVec3)>,
}

/// Draws the cross unless the area `hidden` covers it. Returns the areas of the cross's handles.
pub(super) fn show(
    context: &Context,
    screen: Rect,
    hidden: Rect,
    editor: &Editor,
    acts: &mut Acts,
) -> Vec<Rect> {
    let parts =
        editor.document().and_then(|document| editor.held_numbers.place(document)).zip(editor.picture.view());
    let Some((place, (map, camera))) = parts else { return Vec::new() };
    let place = DVec3::from_array(place);
    let seen = |point: DVec3| seen_at(camera, map, screen, point);
    let Some(middle) = seen(place).filter(|at| screen.contains(*at) && !hidden.contains(*at)) else {
        return Vec::new();
    };
    // Arms have the same length on screen at any distance and frame size.
    let depth = (place - camera.position).dot(camera.forward);
    let length = f64::from(ARM / (0.5 * screen.height())) * depth * camera.tan_half.1;
    let upwards = seen(place + length * camera.up).map_or(ARM, |tip| (tip - middle).length());
    let length = length * f64::from(ARM / upwards.max(1.0));
    let way = |along: DVec3| seen(place + length * along).map(|tip| (tip - middle, length * along));
    let plane: Vec<_> = [camera.right, camera.up].into_iter().filter_map(way).collect();
    let mut handles = vec![Handle { name: "middle", at: middle, ways: plane }];
    let painter = context.layer_painter(LayerId::new(Order::Background, Id::unique("cross")));
    for ((name, axis), color) in [("x", DVec3::X), ("y", DVec3::Y), ("z", DVec3::Z)].into_iter().zip(COLORS) {
        let Some((arm, along)) = way(axis).filter(|(arm, _)| arm.length() > ARM_MIN) else { continue };
        let tip = middle + arm;
        for (width, color) in [(4.5, style::ON_ACCENT), (2.2, color)] {
            painter.line_segment([middle, tip], Stroke::new(width, color));
        }
        painter.circle(tip, 5.0, color, Stroke::new(1.2, style::ON_ACCENT));
        let font = style::proportional(style::SMALL_SIZE);
        painter.text(tip + 11.0 * arm.normalized(), egui::Align2::CENTER_CENTER, name, font, color);
        handles.push(Handle { name, at: tip, ways: vec![(arm, along)] });
    }
    painter.circle(middle, 5.5, style::TEXT, Stroke::new(1.4, style::ON_ACCENT));
    handles.iter().map(|handle| drag(context, handle, acts)).collect()
}

fn seen_at(camera: &Camera, map: &Map, screen: Rect, point: DVec3) -> Option<Pos2> {
    let (x, y) = camera.project(point)?;
    on_screen(map, screen, [0.5 + 0.5 * x, 0.5 - 0.5 * y])
}

fn drag(context: &Context, handle: &Handle, acts: &mut Acts) -> Rect {
    let rect = Rect::from_center_size(handle.at, Vec2::splat(2.0 * HANDLE));
    let id = Id::unique(("cross handle", handle.name));
    let area = style::area(id, Order::Background).fixed_pos(rect.min);
    area.show(context, |ui| {
        let response = ui.allocate_rect(rect, Sense::drag());
        if response.hovered() || response.dragged() {
            ui.ctx().set_cursor_icon(CursorIcon::Move);
            ui.painter().circle_stroke(handle.at, HANDLE, Stroke::new(1.4, style::TEXT));
        }
        let moved = response.drag_delta();
        if !response.dragged() || moved == Vec2::ZERO {
            return;
        }
        let fine = if ui.input(|input| input.modifiers.shift) { FINE } else { 1.0 };
        let way = (fine * way_of(&handle.ways, moved)).to_array();
        acts.on_editor(move |editor| editor.move_place(way));
    });
    rect
}

fn way_of(ways: &[(Vec2, DVec3)], moved: Vec2) -> DVec3 {
    match ways {
        [(on_screen, along)] => f64::from(moved.dot(*on_screen) / on_screen.length_sq()) * *along,
        [(a, along_a), (b, along_b)] => {
            let area = a.x * b.y - a.y * b.x;
            if area.abs() < 1e-3 {
                return DVec3::ZERO;
            }
            let fractions = vec2(moved.x * b.y - moved.y * b.x, a.x * moved.y - a.y * moved.x) / area;
            f64::from(fractions.x) * *along_a + f64::from(fractions.y) * *along_b
        }
        _ => DVec3::ZERO,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_screen_movement_is_projected_to_the_axis_or_plane() {
        let x = (vec2(64.0, 0.0), DVec3::new(2.0, 0.0, 0.0));
        assert_eq!(way_of(&[x], vec2(32.0, 50.0)), DVec3::new(1.0, 0.0, 0.0));
        let y = (vec2(0.0, -64.0), DVec3::new(0.0, 2.0, 0.0));
        assert_eq!(way_of(&[x, y], vec2(-32.0, -16.0)), DVec3::new(-1.0, 0.5, 0.0));
        assert_eq!(way_of(&[x, x], vec2(5.0, 5.0)), DVec3::ZERO);
    }
}
