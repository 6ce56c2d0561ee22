//! Decides if a click belongs to the overlay or to the show. Clicks that begin on a panel belong to the overlay.

use egui::{Pos2, Rect, pos2};
use mariana_commands::input::{Input, TouchPhase};

/// The positions of the pointer and the panels, in pixels.
#[derive(Debug, Default)]
pub(super) struct Pointer {
    pub place: Option<Pos2>,
    /// The panels that take clicks.
    pub panels: Vec<Rect>,
    /// The number of held buttons that were pressed on a panel.
    held: u32,
}

impl Pointer {
    /// Handles an event. Returns true if only the overlay may use the event.
    pub(super) fn on_event(&mut self, input: &Input) -> bool {
        match input {
            Input::PointerMoved([x, y]) => {
                self.place = Some(pos2(*x as f32, *y as f32));
                // The show needs every position of the pointer.
                false
            }
            Input::PointerLeft => {
                self.place = None;
                false
            }
            Input::PointerButton { pressed, .. } => self.on_button(*pressed),
            Input::Wheel(_) => self.held > 0 || self.is_on_panel(self.place),
            Input::Touch { phase: TouchPhase::Started, place: [x, y], .. } => {
                self.is_on_panel(Some(pos2(*x as f32, *y as f32)))
            }
            _ => false,
        }
    }

    /// True if the pointer is on a panel, or was pressed on a panel and is still held.
    pub(super) fn is_busy(&self) -> bool {
        self.held > 0 || self.is_on_panel(self.place)
    }

    fn on_button(&mut self, pressed: bool) -> bool {
        match pressed {
            true if self.held > 0 || self.is_on_panel(self.place) => self.held += 1,
            false if self.held > 0 => self.held -= 1,
            _ => return false,
        }
        true
    }

    fn is_on_panel(&self, place: Option<Pos2>) -> bool {
        place.is_some_and(|place| self.panels.iter().any(|panel| panel.contains(place)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mariana_commands::input::{PointerButton, Wheel};

    fn moved(x: f64, y: f64) -> Input {
        Input::PointerMoved([x, y])
    }

    fn button(pressed: bool) -> Input {
        Input::PointerButton { button: PointerButton::Primary, pressed }
    }

    #[test]
    fn a_click_belongs_to_where_it_began() {
        let mut pointer = Pointer {
            panels: vec![Rect::from_min_max(pos2(10.0, 10.0), pos2(20.0, 20.0))],
            ..Default::default()
        };
        let (down, up) = (button(true), button(false));
        let wheel = Input::Wheel(Wheel::Notches([0.0, 1.0]));
        let mut answers =
            |events: &[&Input]| -> Vec<bool> { events.iter().map(|event| pointer.on_event(event)).collect() };
        assert_eq!(answers(&[&down, &up, &wheel]), [false; 3], "the position is unknown");
        assert_eq!(answers(&[&moved(15.0, 15.0), &down, &up, &wheel]), [false, true, true, true]);
        assert_eq!(answers(&[&moved(25.0, 15.0), &down, &up, &wheel]), [false; 4]);
        assert_eq!(
            answers(&[&moved(15.0, 15.0), &down, &moved(25.0, 15.0), &up]),
            [false, true, false, true]
        );
        assert_eq!(answers(&[&down, &moved(15.0, 15.0), &up]), [false, false, false]);
    }
}
