//! What the lines at the cursor make, lit up over the picture.

use std::hash::{DefaultHasher, Hash, Hasher};

use egui::{
    Color32, ColorImage, Context, Id, LayerId, Mesh, Order, Pos2, Rect, Shape, TextureHandle, TextureOptions,
    pos2,
};

use crate::app::editor::{Editor, Light};
use crate::app::overlay::style;
use crate::placement::{Map, inverse, led};

/// How much of what is lit up the colour covers, of 255, inside and at its edge.
const INSIDE: u8 = 60;
const EDGE: u8 = 190;
/// Parts into which the picture is divided on its way to the screen: it may lie there slanted.
const PARTS: usize = 12;

/// The last mask, which is uploaded again only if it has changed.
#[derive(Clone)]
struct Kept {
    fingerprint: u64,
    texture: TextureHandle,
}

/// Where a place of the picture, as shares to the right and down, is on the screen.
pub(super) fn on_screen(map: &Map, screen: Rect, at: [f64; 2]) -> Option<Pos2> {
    let [x, y] = led(&inverse(map), at)?;
    Some(pos2(screen.left() + x as f32 * screen.width(), screen.top() + y as f32 * screen.height()))
}

/// Draws it under the panels.
pub(super) fn show(context: &Context, screen: Rect, editor: &Editor) {
    let Some((light, map)) = editor.light().zip(editor.map()) else { return };
    if !light.cells.contains(&true) {
        return;
    }
    let id = Id::unique("editor light");
    let mut hasher = DefaultHasher::new();
    (light.columns, &light.cells).hash(&mut hasher);
    let fingerprint = hasher.finish();
    let kept = context.data(|data| data.get_temp::<Kept>(id)).filter(|kept| kept.fingerprint == fingerprint);
    let kept = kept.unwrap_or_else(|| {
        let texture = context.load_texture("editor light", mask(&light), TextureOptions::LINEAR);
        Kept { fingerprint, texture }
    });
    context.data_mut(|data| data.insert_temp(id, kept.clone()));
    let mut mesh = Mesh::with_texture(kept.texture.id());
    let share = |place: usize| place as f32 / PARTS as f32;
    for row in 0..=PARTS {
        for column in 0..=PARTS {
            let (x, y) = (share(column), share(row));
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
    context.layer_painter(LayerId::new(Order::Background, id)).add(Shape::mesh(mesh));
}

/// A pixel for each cell.
fn mask(light: &Light) -> ColorImage {
    let (columns, rows) = (light.columns.max(1), light.cells.len() / light.columns.max(1));
    let is_lit = |column: usize, row: usize| light.cells.get(row * columns + column).is_some_and(|lit| *lit);
    let inside = |column: usize, row: usize| {
        let beside = [(1, 1), (1, 0), (1, 2), (0, 1), (2, 1)];
        beside.into_iter().all(|(dx, dy)| {
            let (x, y) = ((column + dx).wrapping_sub(1), (row + dy).wrapping_sub(1));
            x >= columns || y >= rows || is_lit(x, y)
        })
    };
    let mut image = ColorImage::filled([columns, rows], Color32::TRANSPARENT);
    for (place, pixel) in image.pixels.iter_mut().enumerate() {
        let (column, row) = (place % columns, place / columns);
        if is_lit(column, row) {
            let covers = if inside(column, row) { INSIDE } else { EDGE };
            let [r, g, b, _] = style::ACCENT.to_array();
            *pixel = Color32::from_rgba_unmultiplied(r, g, b, covers);
        }
    }
    image
}
