//! The background of a window without a frame: a dark gradient in the colours of the panels. An empty window looks
//! broken, and a bright one would flash when the first frame appears.

use egui::{Color32, Mesh, Painter, Rect, Shape, pos2};

/// Positions from the top, 0..1, and their colours.
const STEPS: [(f32, Color32); 4] = [
    (0.0, Color32::from_rgb(8, 10, 18)),
    (0.55, Color32::from_rgb(18, 28, 46)),
    (0.8, Color32::from_rgb(26, 50, 66)),
    (1.0, Color32::from_rgb(12, 22, 32)),
];

pub(super) fn draw(painter: &Painter, screen: Rect) {
    let mut mesh = Mesh::default();
    for (number, (fraction, color)) in (0_u32..).zip(STEPS) {
        let y = screen.top() + fraction * screen.height();
        mesh.colored_vertex(pos2(screen.left(), y), color);
        mesh.colored_vertex(pos2(screen.right(), y), color);
        if number > 0 {
            let first = 2 * (number - 1);
            mesh.add_triangle(first, first + 1, first + 2);
            mesh.add_triangle(first + 1, first + 3, first + 2);
        }
    }
    painter.add(Shape::mesh(mesh));
}
