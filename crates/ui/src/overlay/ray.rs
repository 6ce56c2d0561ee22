//! The diagram of the ray under the pointer.

use std::sync::Arc;

use egui::{Color32, Painter, Pos2, Rect, Stroke, vec2};

use super::editor::on_screen;
use super::style;
use mariana_render::placement::Map;
use mariana_render::ray_diagram::{Ink, Mark, RayDiagram};

/// A diagram, and its place in the window.
#[derive(Debug, Clone)]
pub struct RayView {
    /// The diagram.
    pub diagram: Arc<RayDiagram>,
    /// Maps positions in the window to positions in the frame, both as fractions.
    pub map: Map,
}

fn color([red, green, blue, opacity]: Ink) -> Color32 {
    Color32::from_rgba_unmultiplied(red, green, blue, opacity)
}

pub(super) fn draw(painter: &Painter, screen: Rect, view: &RayView) {
    let size = vec2(view.diagram.size.x, view.diagram.size.y);
    let place = |x: f32, y: f32| -> Option<Pos2> {
        on_screen(&view.map, screen, [f64::from(x / size.x), f64::from(y / size.y)])
    };
    let (Some(low), Some(high)) = (place(0.0, 0.0), place(size.x, size.y)) else { return };
    // Points of the window per pixel of the diagram.
    let scale = (high - low).abs().min_elem() / size.min_elem().max(1.0);
    for group in &view.diagram.groups {
        let [low, high] = group.clip.map(|corner| place(corner.x, corner.y));
        let (Some(low), Some(high)) = (low, high) else { continue };
        let painter = painter.with_clip_rect(Rect::from_two_pos(low, high).intersect(screen));
        for mark in &group.marks {
            draw_mark(&painter, mark, scale, &place);
        }
    }
}

fn draw_mark(painter: &Painter, mark: &Mark, scale: f32, place: &dyn Fn(f32, f32) -> Option<Pos2>) {
    let stroke = |width: f32, ink: Ink| Stroke::new(width * scale, color(ink));
    match mark {
        Mark::Line { from, to, width, ink } => {
            if let (Some(from), Some(to)) = (place(from.x, from.y), place(to.x, to.y)) {
                painter.line_segment([from, to], stroke(*width, *ink));
            }
        }
        Mark::Circle { center, radius, width, ink } => {
            if let Some(center) = place(center.x, center.y) {
                painter.circle_stroke(center, radius * scale, stroke(*width, *ink));
            }
        }
        Mark::Disc { center, radius, ink } => {
            if let Some(center) = place(center.x, center.y) {
                painter.circle_filled(center, radius * scale, color(*ink));
            }
        }
        Mark::Ground { low, high, ink } => {
            if let (Some(low), Some(high)) = (place(low.x, low.y), place(high.x, high.y)) {
                painter.rect_filled(Rect::from_two_pos(low, high), 0.0, color(*ink));
            }
        }
        Mark::Text { at, size, words, ink } => {
            if let Some(at) = place(at.x, at.y) {
                let font = style::proportional(size * scale);
                painter.text(at, egui::Align2::LEFT_TOP, words, font, color(*ink));
            }
        }
    }
}
