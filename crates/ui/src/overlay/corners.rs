//! Draws draggable handles on the corners of the frame.

use egui::{Id, LayerId, Order, Rect, Sense, Stroke, WidgetInfo, pos2, vec2};

use super::acts::Pass;
use super::{assisted, style};
use crate::corner_handles::CornerHandles;
use mariana_commands::{Command, MovedCorner};

/// Width and height of the area in which a handle can be grabbed, in points.
const HOLD: f32 = 44.0;
const RADIUS: f32 = 11.0;
const NAMES: [&str; 4] =
    ["upper left corner", "upper right corner", "lower right corner", "lower left corner"];

/// Draws the handles in a window of `screen` points. Returns the areas in which they can be grabbed.
pub(super) fn show(pass: &mut Pass<'_>, screen: Rect, handles: &CornerHandles) -> Vec<Rect> {
    let Pass { context, acts } = pass;
    let places = handles.places().map(|[x, y]| {
        pos2(screen.left() + x as f32 * screen.width(), screen.top() + y as f32 * screen.height())
    });
    let lines = context.layer_painter(LayerId::new(Order::Middle, Id::unique("edges of the picture")));
    for side in 0..places.len() {
        let ends = [side, (side + 1) % places.len()].map(|at| places.get(at).copied().unwrap_or_default());
        lines.line_segment(ends, Stroke::new(4.0, style::RAIL));
        lines.line_segment(ends, Stroke::new(1.5, style::ACCENT));
    }
    let words = "drag the corners, or use Tab and the arrows (Shift for large steps) · Home resets them · Y when done";
    let galley = style::line(&lines, words, style::SMALL_SIZE, style::TEXT, 0.9 * screen.width());
    let ground = Rect::from_center_size(screen.center(), galley.size() + vec2(24.0, 12.0));
    style::ground(&lines, ground);
    lines.galley(ground.center() - 0.5 * galley.size(), galley, style::TEXT);
    assisted::text(context, "corners", words, true);

    let mut grabs = Vec::new();
    for (corner, place) in places.into_iter().enumerate() {
        // If a corner is outside the window, draw its handle at the window's edge.
        let seen = screen.shrink(RADIUS.min(0.5 * screen.size().min_elem())).clamp(place);
        let grab = Rect::from_center_size(seen, vec2(HOLD, HOLD)).intersect(screen);
        let area = style::area(Id::unique("corner of the picture").with(corner), Order::Foreground)
            .fixed_pos(grab.min);
        area.show(context, |ui| {
            let (rect, response) = ui.allocate_exact_size(grab.size(), Sense::drag());
            let held = response.dragged() || response.hovered();
            let painter = ui.painter();
            let at = rect.center() + (seen - grab.center());
            painter.circle_filled(at, RADIUS, if held { style::ACCENT } else { style::GROUND });
            let color = if corner == handles.selected { style::ACCENT } else { style::TEXT };
            painter.circle_stroke(at, RADIUS, Stroke::new(2.0, color));
            response.widget_info(|| {
                WidgetInfo::labeled(egui::Role::Button, true, NAMES.get(corner).copied().unwrap_or_default())
            });
            let way = response.drag_delta();
            let settled = response.drag_stopped();
            if way != vec2(0.0, 0.0) || settled {
                let to = place + way;
                let fraction =
                    [(to.x - screen.left()) / screen.width(), (to.y - screen.top()) / screen.height()];
                let place = handles.on_screen(fraction.map(f64::from));
                acts.commands.push(Command::MoveCorner(MovedCorner { corner, place, settled }));
            }
        });
        grabs.push(grab);
    }
    grabs
}
