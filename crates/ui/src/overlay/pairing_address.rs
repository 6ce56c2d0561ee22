//! The connection code for phones: a QR code, and its address as text.

use egui::{Align, Color32, Mesh, Painter, Pos2, Rect, Response, Sense, Ui, WidgetInfo, pos2, vec2};

use super::style;
use mariana_remote::{Code, PairingAddress};

/// Maximum side of the code with its margin, in points. The next constant is a fraction of the panel's width.
const SIDE_MAX: f32 = 190.0;
const FRACTION_MAX: f32 = 0.45;
const GAP: f32 = 14.0;
const AROUND: f32 = 6.0;

pub(super) fn show(ui: &mut Ui, pairing_address: &PairingAddress, about: &str) -> Response {
    let width = ui.available_width();
    let pixel = 1.0 / ui.pixels_per_point();
    let code = &pairing_address.code;
    let square = square(code, SIDE_MAX.min(FRACTION_MAX * width), pixel);
    let height = square * squares(code) as f32 + 2.0 * AROUND;
    let (rect, response) = ui.allocate_exact_size(vec2(width, height), Sense::hover());
    let drawn = draw_code(ui.painter(), code, rect.min + vec2(0.0, AROUND), square, pixel);
    let left = drawn.right() + GAP;
    let width = (rect.right() - left - AROUND).max(1.0);
    let lines = [
        ("Phone", style::HEADING_SIZE, style::TEXT),
        ("Scan the code with the phone's camera, or open", style::SMALL_SIZE, style::DIM),
        (&*pairing_address.url, style::SMALL_SIZE, style::TEXT),
        (about, style::SMALL_SIZE, style::DIM),
    ];
    let mut at = pos2(left, drawn.top());
    for (text, size, color) in lines {
        let galley = style::paragraph(ui.painter(), text, size, color, width, usize::MAX, Align::LEFT);
        let next = at.y + galley.size().y + 5.0;
        ui.painter().galley(at, galley, color);
        at.y = next;
    }
    let words = format!("open {} on a phone. {about}", pairing_address.url);
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Label, true, &words));
    response
}

fn squares(code: &Code) -> usize {
    code.side + 2 * Code::EDGE
}

/// Returns the side of a module (a square of the code) in points: whole pixels, so that the code fits into `side`.
fn square(code: &Code, side: f32, pixel: f32) -> f32 {
    (side / squares(code) as f32 / pixel).floor().max(1.0) * pixel
}

/// Draws the code dark on white, because cameras expect these colours.
fn draw_code(painter: &Painter, code: &Code, from: Pos2, square: f32, pixel: f32) -> Rect {
    let from = pos2((from.x / pixel).round() * pixel, (from.y / pixel).round() * pixel);
    let place = |(x, y): (usize, usize)| {
        let at = from + square * vec2((x + Code::EDGE) as f32, (y + Code::EDGE) as f32);
        Rect::from_min_size(at, vec2(square, square))
    };
    let ground = Rect::from_min_size(from, vec2(square, square) * squares(code) as f32);
    let mut mesh = Mesh::default();
    mesh.add_colored_rect(ground, Color32::WHITE);
    for dark in code.dark() {
        mesh.add_colored_rect(place(dark), Color32::BLACK);
    }
    painter.add(mesh);
    ground
}
