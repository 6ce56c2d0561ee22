//! Pictures from the session, as textures.

use std::hash::{Hash, Hasher};
use std::sync::Arc;

use egui::{
    Color32, ColorImage, Context, Painter, Rect, TextureHandle, TextureId, TextureOptions, pos2, vec2,
};
use image::RgbaImage;

/// The cover of the playing song. Two covers are the same if they share their pixels.
#[derive(Debug, Clone, Copy)]
pub struct Cover<'a>(pub &'a Arc<RgbaImage>);

impl Hash for Cover<'_> {
    fn hash<H: Hasher>(&self, state: &mut H) {
        (Arc::as_ptr(self.0) as usize).hash(state);
    }
}

/// The texture of a picture, replaced when the picture changes.
#[derive(Clone, Default)]
pub(super) struct KeptPicture(Option<(Arc<RgbaImage>, TextureHandle)>);

impl KeptPicture {
    pub(super) fn of(&mut self, context: &Context, image: &Arc<RgbaImage>) -> TextureId {
        if let Some((known, texture)) = &mut self.0 {
            if !Arc::ptr_eq(known, image) {
                texture.set(pixels(image), TextureOptions::LINEAR);
                known.clone_from(image);
            }
            return texture.id();
        }
        let texture = context.load_texture("picture", pixels(image), TextureOptions::LINEAR);
        self.0.insert((image.clone(), texture)).1.id()
    }

    /// Draws the middle of a cover in a square.
    pub(super) fn draw(&mut self, painter: &Painter, square: Rect, Cover(image): Cover<'_>) {
        let (width, height) = (image.width().max(1) as f32, image.height().max(1) as f32);
        let side = width.min(height);
        let part = Rect::from_center_size(pos2(0.5, 0.5), vec2(side / width, side / height));
        let tint = Color32::WHITE.gamma_multiply(painter.opacity());
        let texture = self.of(painter.ctx(), image);
        painter.add(egui::Shape::image(texture, square, part, tint));
    }

    pub(super) fn clear(&mut self) {
        self.0 = None;
    }
}

pub(super) fn pixels(image: &RgbaImage) -> ColorImage {
    let size = [image.width() as usize, image.height() as usize];
    ColorImage::from_rgba_unmultiplied(size, image.as_raw())
}
