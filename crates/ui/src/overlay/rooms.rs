//! Where panels stand: over the picture, or on a desk whose picture is small beside and below it.

use egui::{Rect, pos2, vec2};

use super::style;
use crate::desk_picture::COLUMN;
use mariana_render::placement::Area;

/// Parts of a window, in points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rooms {
    /// For what is read and written: the editor, lists, settings, words.
    pub(super) main: Rect,
    /// For what is turned and looked at: sliders and the next scene.
    pub(super) side: Rect,
    /// Whether the picture is small and stands between them.
    pub(super) is_desk: bool,
}

impl Rooms {
    /// Of `space`, which panels may have in a window of `screen` points whose small picture has the part `picture`.
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

    /// What of the side is left below something.
    pub(super) fn below(&mut self, rect: Rect) {
        self.side.min.y = (rect.bottom() + style::MARGIN).min(self.side.bottom());
    }

    /// Where something small stands that is at the upper right of the picture, or on a desk below it.
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
    fn on_a_desk_no_room_is_over_the_picture_or_over_the_other() {
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
