//! The background of a window without a frame: a dark gradient in the colours of the panels, with the bands of the sound
//! as bars on a horizon. An empty window looks broken, and a bright one would flash when the first frame appears.

use egui::{Color32, Mesh, Painter, Rect, Shape, pos2, vec2};

/// Positions from the top, 0..1, and their colours.
const STEPS: [(f32, Color32); 4] = [
    (0.0, Color32::from_rgb(8, 10, 18)),
    (0.55, Color32::from_rgb(18, 28, 46)),
    (0.8, Color32::from_rgb(26, 50, 66)),
    (1.0, Color32::from_rgb(12, 22, 32)),
];

/// Height of the horizon and of the highest bar, and width of all bars, as fractions of the screen.
const HORIZON: f32 = 0.62;
const HIGHEST: f32 = 0.3;
const WIDTH: f32 = 0.62;
const BAR: Color32 = Color32::from_rgb(74, 124, 150);
/// The reflections below the horizon.
const REFLECTION: Color32 = Color32::from_rgb(26, 54, 70);

/// Draws the background, and a bar for each of the `bands`, 0..1.
pub(super) fn draw(painter: &Painter, screen: Rect, bands: &[f32]) {
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
    let step = WIDTH * screen.width() / bands.len().max(1) as f32;
    let mut middle =
        screen.min + vec2(0.5 * ((1.0 - WIDTH) * screen.width() + step), HORIZON * screen.height());
    for band in bands {
        let size = vec2(0.6 * step, HIGHEST * screen.height() * band.clamp(0.01, 1.0));
        let [above, below] = [1.0, -0.4].map(|side| middle - vec2(0.0, 0.5 * side * size.y));
        mesh.add_colored_rect(Rect::from_center_size(above, size), BAR);
        mesh.add_colored_rect(Rect::from_center_size(below, size * vec2(1.0, 0.4)), REFLECTION);
        middle.x += step;
    }
    painter.add(Shape::mesh(mesh));
}
