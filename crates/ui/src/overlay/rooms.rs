//! The areas for panels: over the frame, or around the small frame of a control window.

use egui::{Rect, pos2, vec2};

use super::style;
use crate::desk_picture::COLUMN;
use mariana_render::placement::Area;

/// Areas of a window, in points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rooms {
    /// The area for the editor, lists, settings and messages.
    pub(super) main: Rect,
    /// The area for sliders and the next scene.
    pub(super) side: Rect,
    /// True in a control window: the small frame is above `side`.
    pub(super) is_desk: bool,
}

impl Rooms {
    /// Divides `space`, a part of a window of `screen` points. `picture` is the area of the small frame, if the window
    /// has one.
    pub(super) fn of(space: Rect, screen: Rect, picture: Option<Area>) -> Self {
        let Some([_, _, _, bottom]) = picture else {
            return Self { main: space, side: space, is_desk: false };
        };
        let at = |fraction: f64, from: f32, length: f32| from + fraction as f32 * length;
        let edge = at(1.0 - COLUMN, screen.left(), screen.width()).clamp(space.left(), space.right());
        let below = at(bottom, screen.top(), screen.height()) + style::MARGIN;
        let main =
            Rect::from_min_max(space.min, pos2((edge - style::MARGIN).max(space.left()), space.bottom()));
        let side = Rect::from_min_max(pos2(edge, below.min(space.bottom())), space.max);
        Self { main, side, is_desk: true }
    }

    pub(super) fn below(&mut self, rect: Rect) {
        self.side.min.y = (rect.bottom() + style::MARGIN).min(self.side.bottom());
    }

    /// Position and width for a small panel at the upper right of the frame, or in the side column of a control window.
    pub(super) fn small(&self, size_max: f32, fraction: f32) -> (egui::Pos2, f32) {
        match self.is_desk {
            true => (self.side.min + vec2(5.0, 5.0), size_max.min(self.side.width() - 10.0).max(0.0)),
            false => {
                let width = size_max.min(fraction * self.side.width());
                (pos2(self.side.right() - 10.0 - width, self.side.top() + 10.0), width)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::desk_picture::small_in;

    #[test]
    fn in_a_control_window_areas_overlap_neither_the_frame_nor_each_other() {
        let screen = Rect::from_min_size(pos2(0.0, 0.0), vec2(1280.0, 720.0));
        let space = screen.shrink(style::MARGIN);
        let over = Rooms::of(space, screen, None);
        assert!(over.main == space && over.side == space && !over.is_desk);
        let area = small_in((1280, 720), (1920, 1080));
        let mut rooms = Rooms::of(space, screen, Some(area));
        let [left, top, right, bottom] = area.map(|fraction| fraction as f32);
        let picture =
            Rect::from_min_max(pos2(1280.0 * left, 720.0 * top), pos2(1280.0 * right, 720.0 * bottom));
        for room in [rooms.main, rooms.side] {
            assert!(!room.intersects(picture) && space.contains_rect(room), "{room} and {picture}");
        }
        assert!(!rooms.main.intersects(rooms.side));
        assert!(rooms.main.height() == space.height() && rooms.side.height() > 300.0);
        rooms.below(Rect::from_min_max(pos2(900.0, 300.0), pos2(1000.0, 400.0)));
        assert_eq!(rooms.side.top(), 400.0 + style::MARGIN);
        rooms.below(screen);
        assert!(rooms.side.height() == 0.0);
    }
}
