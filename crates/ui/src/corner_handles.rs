//! The corners of the picture while they are moved by hand, with keys or with the pointer.
//!
//! It is a plain value: the overlay draws it, keys and pointer change it, and the stage moves the picture.

use std::hash::{DefaultHasher, Hash, Hasher};

use mariana_commands::input::{Key, NamedKey};

use mariana_commands::{Command, MovedCorner};
use mariana_render::placement::{Area, Corners};

/// How far an arrow moves a corner, as a share of the screen.
const STEP: f64 = 0.001;
/// The same with Shift held.
const LARGE_STEP: f64 = 0.01;

/// See the module.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CornerHandles {
    corners: Corners,
    selected: usize,
    /// Where in the window the screen is that they are corners of.
    area: Area,
}

impl CornerHandles {
    /// Hands on these corners, of which the upper left is selected.
    pub fn new(corners: Corners) -> Self {
        Self { corners, selected: 0, area: [0.0, 0.0, 1.0, 1.0] }
    }

    /// Says where in the window the screen is, as shares of it.
    pub fn set_area(&mut self, area: Area) {
        self.area = area;
    }

    /// Takes the corners as they are now; one of them is selected.
    pub fn take(&mut self, selected: usize, corners: Corners) {
        (self.selected, self.corners) = (selected.min(3), corners);
    }

    /// Takes a key and returns the command that it sends, if any; `None` for keys that are not theirs. Tab selects the next corner, arrows move it, Home puts all of them back.
    pub fn take_key(&mut self, key: &Key, shift: bool) -> Option<Option<Command>> {
        let step = if shift { LARGE_STEP } else { STEP };
        let way = match key {
            Key::Named(NamedKey::Tab) => {
                self.selected = (self.selected + if shift { 3 } else { 1 }) % 4;
                return Some(None);
            }
            Key::Named(NamedKey::Home) => return Some(Some(Command::ResetCorners)),
            Key::Named(NamedKey::ArrowLeft) => [-step, 0.0],
            Key::Named(NamedKey::ArrowRight) => [step, 0.0],
            Key::Named(NamedKey::ArrowUp) => [0.0, -step],
            Key::Named(NamedKey::ArrowDown) => [0.0, step],
            _ => return None,
        };
        let [x, y] = <[[f64; 2]; 4]>::from(self.corners).get(self.selected).copied()?;
        let place = [x + way[0], y + way[1]];
        Some(Some(Command::MoveCorner(MovedCorner { corner: self.selected, place, settled: true })))
    }

    /// Which corner keys move.
    pub fn selected(&self) -> usize {
        self.selected
    }

    /// Where the corners are in the window, as shares of it.
    pub fn places(&self) -> [[f64; 2]; 4] {
        let [left, top, right, bottom] = self.area;
        <[[f64; 2]; 4]>::from(self.corners)
            .map(|[x, y]| [left + x * (right - left), top + y * (bottom - top)])
    }

    /// The place of the screen at a place of the window.
    pub fn on_screen(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [left, top, right, bottom] = self.area;
        [(x - left) / (right - left).max(1e-9), (y - top) / (bottom - top).max(1e-9)]
    }

    /// Another number for everything that looks different.
    pub fn fingerprint(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        self.selected.hash(&mut hasher);
        for place in self.places() {
            place.map(f64::to_bits).hash(&mut hasher);
        }
        hasher.finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_select_and_move_corners_and_leave_other_keys_alone() {
        let mut handles = CornerHandles::new(Corners::default());
        let key = |key: NamedKey| Key::Named(key);
        assert_eq!(handles.take_key(&key(NamedKey::Tab), false), Some(None));
        let moved = handles.take_key(&key(NamedKey::ArrowLeft), true);
        let to = |place| Some(Some(Command::MoveCorner(MovedCorner { corner: 1, place, settled: true })));
        assert_eq!(moved, to([1.0 - LARGE_STEP, 0.0]));
        handles.take(1, Corners::default().with(1, [0.9, 0.1]).unwrap());
        let moved = handles.take_key(&key(NamedKey::ArrowDown), false);
        assert_eq!(moved, to([0.9, 0.1 + STEP]));
        assert_eq!(handles.take_key(&key(NamedKey::Tab), true), Some(None));
        assert_eq!(handles.selected(), 0);
        assert_eq!(handles.take_key(&key(NamedKey::Home), false), Some(Some(Command::ResetCorners)));
        assert_eq!(handles.take_key(&Key::Character("n".into()), false), None);
    }

    #[test]
    fn places_in_the_window_are_those_on_the_screen_in_its_area() {
        let mut handles = CornerHandles::new(Corners::default().with(2, [0.5, 0.75]).unwrap());
        let before = handles.fingerprint();
        handles.set_area([0.25, 0.0, 0.75, 1.0]);
        assert_ne!(handles.fingerprint(), before);
        assert_eq!(handles.places()[2], [0.5, 0.75]);
        assert_eq!(handles.places()[3], [0.25, 1.0]);
        assert_eq!(handles.on_screen([0.5, 0.75]), [0.5, 0.75]);
        assert_eq!(handles.on_screen([0.25, 1.0]), [0.0, 1.0]);
    }
}
