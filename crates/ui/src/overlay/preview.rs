//! Draws the preview of the next scene: its image and title, and below them the level and the beat.

use std::sync::Arc;

use egui::{Color32, Id, LayerId, Order, Rect, pos2, vec2};
use image::RgbaImage;

use super::rooms::Rooms;
use super::{assisted, picture, style};

/// The next scene of the show.
#[derive(Debug, Clone)]
pub struct NextScene {
    /// Title.
    pub title: String,
    /// Preview image, once the image is rendered.
    pub picture: Option<Arc<RgbaImage>>,
    /// The present level, 0..1.
    pub level: f32,
    /// Strength of the beat, 0..1.
    pub beat: f32,
}

/// Maximum width of the image in points. The next constant is the maximum as a fraction of the window.
const WIDTH: f32 = 160.0;
const FRACTION: f32 = 0.3;
const LEVEL: f32 = 4.0;

pub(super) fn show(context: &egui::Context, rooms: &Rooms, next: &NextScene) -> Rect {
    let painter = context.layer_painter(LayerId::new(Order::Background, Id::unique("next scene")));
    let (place, width) = rooms.small(WIDTH, FRACTION);
    let words = format!("next: {}", next.title);
    let name = style::line(&painter, &words, style::SMALL_SIZE, style::TEXT, width);
    let place = Rect::from_min_size(place, vec2(width, width * 9.0 / 16.0));
    let below = place.bottom() + 4.0;
    let bottom = below + name.size().y + 4.0 + LEVEL;
    let whole = Rect::from_min_max(place.min, pos2(place.right(), bottom)).expand(5.0);
    style::ground(&painter, whole);
    if let Some(image) = &next.picture {
        let all = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        painter.image(picture::texture(context, image), place, all, Color32::WHITE);
    }
    let beat = pos2(place.right() - 5.0, below + 0.5 * name.size().y);
    painter.galley(pos2(place.left(), below), name, style::TEXT);
    painter.circle_filled(beat, 4.0, style::RAIL);
    painter.circle_filled(beat, 4.0, style::ACCENT.gamma_multiply(next.beat));
    let rail = Rect::from_min_max(pos2(place.left(), bottom - LEVEL), pos2(place.right(), bottom));
    style::fraction(&painter, rail, next.level);
    assisted::text(context, "next scene", &words, true);
    whole
}
