//! The state of the corner handles of the keystone correction. The overlay draws the handles. Keys and the pointer move
//! them. The stage moves the frame's corners.

use mariana_commands::input::{Key, NamedKey};

use mariana_commands::{Command, MovedCorner};
use mariana_render::placement::{Area, Corners};

/// Movement per press of an arrow key, as a fraction of the screen. With Shift, the next constant applies.
const STEP: f64 = 0.001;
const LARGE_STEP: f64 = 0.01;

/// The four corners and the index of the selected corner.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CornerHandles {
    corners: Corners,
    /// The index of the selected corner.
    pub selected: usize,
    /// The part of the window that shows the output's screen, as fractions of the window.
    pub area: Area,
}

impl CornerHandles {
    /// Shows handles for these corners and selects the upper left corner.
    pub fn new(corners: Corners) -> Self {
        Self { corners, selected: 0, area: [0.0, 0.0, 1.0, 1.0] }
    }

    /// Sets the corners and selects one of them.
    pub fn set_corners(&mut self, selected: usize, corners: Corners) {
        (self.selected, self.corners) = (selected.min(3), corners);
    }

    /// Handles a key. Tab selects the next corner, arrows move the selected corner, and Home resets all four. Returns
    /// the key's commands; `None` for a key that belongs to the show.
    pub fn handle_key(&mut self, key: &Key, shift: bool) -> Option<Vec<Command>> {
        let step = if shift { LARGE_STEP } else { STEP };
        let way = match key {
            Key::Named(NamedKey::Tab) => {
                self.selected = (self.selected + if shift { 3 } else { 1 }) % 4;
                return Some(Vec::new());
            }
            Key::Named(NamedKey::Home) => return Some(vec![Command::ResetCorners]),
            Key::Named(NamedKey::ArrowLeft) => [-step, 0.0],
            Key::Named(NamedKey::ArrowRight) => [step, 0.0],
            Key::Named(NamedKey::ArrowUp) => [0.0, -step],
            Key::Named(NamedKey::ArrowDown) => [0.0, step],
            _ => return None,
        };
        let [x, y] = <[[f64; 2]; 4]>::from(self.corners).get(self.selected).copied()?;
        let place = [x + way[0], y + way[1]];
        Some(vec![Command::MoveCorner(MovedCorner { corner: self.selected, place, settled: true })])
    }

    /// The corners' positions as fractions of the window.
    pub fn places(&self) -> [[f64; 2]; 4] {
        let [left, top, right, bottom] = self.area;
        <[[f64; 2]; 4]>::from(self.corners)
            .map(|[x, y]| [left + x * (right - left), top + y * (bottom - top)])
    }

    /// Converts a position in the window to a position on the screen.
    pub fn on_screen(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [left, top, right, bottom] = self.area;
        [(x - left) / (right - left).max(1e-9), (y - top) / (bottom - top).max(1e-9)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_select_and_move_corners_and_leave_other_keys_alone() {
        let mut handles = CornerHandles::new(Corners::default());
        let key = |key: NamedKey| Key::Named(key);
        assert_eq!(handles.handle_key(&key(NamedKey::Tab), false), Some(vec![]));
        let moved = handles.handle_key(&key(NamedKey::ArrowLeft), true);
        let to = |place| Some(vec![Command::MoveCorner(MovedCorner { corner: 1, place, settled: true })]);
        assert_eq!(moved, to([1.0 - LARGE_STEP, 0.0]));
        handles.set_corners(1, Corners::default().with(1, [0.9, 0.1]).unwrap());
        let moved = handles.handle_key(&key(NamedKey::ArrowDown), false);
        assert_eq!(moved, to([0.9, 0.1 + STEP]));
        assert_eq!(handles.handle_key(&key(NamedKey::Tab), true), Some(vec![]));
        assert_eq!(handles.selected, 0);
        assert_eq!(handles.handle_key(&key(NamedKey::Home), false), Some(vec![Command::ResetCorners]));
        assert_eq!(handles.handle_key(&Key::Character("n".into()), false), None);
    }

    #[test]
    fn positions_convert_between_window_and_screen() {
        let mut handles = CornerHandles::new(Corners::default().with(2, [0.5, 0.75]).unwrap());
        let before = handles;
        handles.area = [0.25, 0.0, 0.75, 1.0];
        assert_ne!(handles, before);
        assert_eq!(handles.places()[2], [0.5, 0.75]);
        assert_eq!(handles.places()[3], [0.25, 1.0]);
        assert_eq!(handles.on_screen([0.5, 0.75]), [0.5, 0.75]);
        assert_eq!(handles.on_screen([0.25, 1.0]), [0.0, 1.0]);
    }
}
