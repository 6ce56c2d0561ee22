//! Pictures from the session, as textures.

use std::hash::{Hash, Hasher};
use std::sync::Arc;

use egui::{Color32, ColorImage, Context, Id, Painter, Rect, TextureId, pos2, vec2};
use image::RgbaImage;

use super::kept;

/// The cover of the playing song. Two covers are the same if they share their pixels.
#[derive(Debug, Clone, Copy)]
pub struct Cover<'a>(pub &'a Arc<RgbaImage>);

impl Hash for Cover<'_> {
    fn hash<H: Hasher>(&self, state: &mut H) {
        (Arc::as_ptr(self.0) as usize).hash(state);
    }
}

/// Returns the texture of a picture. The texture is dropped after a layout that does not draw the picture.
pub(super) fn texture(context: &Context, image: &Arc<RgbaImage>) -> TextureId {
    let id = Id::unique(("picture", Arc::as_ptr(image) as usize));
    let size = [image.width() as usize, image.height() as usize];
    kept::texture(context, id, image.clone(), || ColorImage::from_rgba_unmultiplied(size, image.as_raw()))
}

/// Draws the middle of a cover in a square.
pub(super) fn draw_cover(painter: &Painter, square: Rect, Cover(image): Cover<'_>) {
    let (width, height) = (image.width().max(1) as f32, image.height().max(1) as f32);
    let side = width.min(height);
    let part = Rect::from_center_size(pos2(0.5, 0.5), vec2(side / width, side / height));
    let tint = Color32::WHITE.gamma_multiply(painter.opacity());
    painter.add(egui::Shape::image(texture(painter.ctx(), image), square, part, tint));
}
