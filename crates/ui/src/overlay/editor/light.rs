//! Highlights the parts of the frame that the lines at the cursor draw.

use std::hash::{DefaultHasher, Hash, Hasher};

use egui::{Color32, ColorImage, Context, Id, LayerId, Mesh, Order, Pos2, Rect, Shape, pos2};

use crate::editor::{Editor, Light};
use crate::overlay::{kept, style};
use mariana_render::placement::{Map, inverse, led};

/// Opacity of a highlight's inside, 0..255. The next constant is the opacity of its outline.
const INSIDE: u8 = 60;
const EDGE: u8 = 190;
/// Subdivisions of the mesh that follows the frame's corners on the screen.
const PARTS: usize = 12;

/// Returns the screen position of the point `at` of the frame. `at` is in fractions to the right and down.
pub(in crate::overlay) fn on_screen(map: &Map, screen: Rect, at: [f64; 2]) -> Option<Pos2> {
    let [x, y] = led(&inverse(map), at)?;
    Some(pos2(screen.left() + x as f32 * screen.width(), screen.top() + y as f32 * screen.height()))
}

pub(super) fn show(context: &Context, screen: Rect, editor: &Editor) {
    let Some((light, map)) = editor.light().zip(editor.picture.map.as_ref()) else { return };
    if !light.cells.contains(&true) {
        return;
    }
    let mut hasher = DefaultHasher::new();
    (light.columns, &light.cells).hash(&mut hasher);
    // A mask is made only if the cells have changed.
    let of_cells = Id::unique(("editor light", hasher.finish()));
    let mut mesh = Mesh::with_texture(kept::texture(context, of_cells, (), || mask(&light)));
    let fraction = |place: usize| place as f32 / PARTS as f32;
    for row in 0..=PARTS {
        for column in 0..=PARTS {
            let (x, y) = (fraction(column), fraction(row));
            let Some(place) = on_screen(map, screen, [f64::from(x), f64::from(y)]) else { return };
            mesh.vertices.push(egui::epaint::Vertex { pos: place, uv: pos2(x, y), color: Color32::WHITE });
        }
    }
    for row in 0..PARTS as u32 {
        for column in 0..PARTS as u32 {
            let first = row * (PARTS as u32 + 1) + column;
            let below = first + PARTS as u32 + 1;
            mesh.add_triangle(first, first + 1, below);
            mesh.add_triangle(first + 1, below, below + 1);
        }
    }
    let layer = LayerId::new(Order::Background, Id::unique("editor light"));
    context.layer_painter(layer).add(Shape::mesh(mesh));
}

/// Pixels of the mask per cell along each axis. More than one pixel makes the outline smooth.
const FINER: usize = 3;
/// The outline is drawn where the interpolated coverage differs from 0.5 by at most this number.
const OUTLINE: f32 = 0.17;

fn mask(light: &Light) -> ColorImage {
    let (columns, rows) = (light.columns.max(1), light.cells.len() / light.columns.max(1));
    let cell = |column: i64, row: i64| {
        let column = column.clamp(0, columns as i64 - 1) as usize;
        let row = row.clamp(0, rows as i64 - 1) as usize;
        f32::from(u8::from(light.cells.get(row * columns + column).is_some_and(|lit| *lit)))
    };
    let fraction = |x: f32, y: f32| {
        let (left, top) = (x.floor(), y.floor());
        let (right_fraction, lower_fraction) = (x - left, y - top);
        let row = |row: i64| {
            let (a, b) = (cell(left as i64, row), cell(left as i64 + 1, row));
            a + (b - a) * right_fraction
        };
        let (upper, lower) = (row(top as i64), row(top as i64 + 1));
        upper + (lower - upper) * lower_fraction
    };
    let [r, g, b, _] = style::ACCENT.to_array();
    let mut image = ColorImage::filled([FINER * columns, FINER * rows], Color32::TRANSPARENT);
    for (place, pixel) in image.pixels.iter_mut().enumerate() {
        let at = |place: usize| (place as f32 + 0.5) / FINER as f32 - 0.5;
        let (x, y) = (at(place % (FINER * columns)), at(place / (FINER * columns)));
        // The mean of four points around the pixel smooths the steps of the grid.
        let around = [(-0.5, 0.0), (0.5, 0.0), (0.0, -0.5), (0.0, 0.5)];
        let lit = around.into_iter().map(|(dx, dy)| fraction(x + dx, y + dy)).sum::<f32>() / 4.0;
        let covers = match lit {
            lit if (lit - 0.5).abs() < OUTLINE => EDGE,
            lit if lit > 0.5 => INSIDE,
            _ => continue,
        };
        *pixel = Color32::from_rgba_unmultiplied(r, g, b, covers);
    }
    image
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn highlights_have_an_outline_and_the_rest_is_transparent() {
        let cells = (0..16 * 8).map(|cell| (4..12).contains(&(cell % 16))).collect();
        let image = mask(&Light { columns: 16, cells });
        assert_eq!(image.size, [48, 24]);
        let alpha = |x: usize| image.pixels[12 * 48 + x].a();
        assert_eq!((alpha(0), alpha(24), alpha(47)), (0, INSIDE, 0));
        assert!((0..48).filter(|x| alpha(*x) == EDGE).count() >= 2, "no outline");
    }
}
