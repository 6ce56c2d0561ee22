//! Mouse gestures over the frame: clicks, drags that turn the camera, and the wheel that zooms.

use std::time::{Duration, Instant};

use mariana_commands::input::{Input, PointerButton, Wheel};
use mariana_commands::{Command, Switch};

/// Maximum time between the two clicks of a double click, and maximum distance in pixels.
const DOUBLE_CLICK: (Duration, f64) = (Duration::from_millis(400), 6.0);
/// Movement in pixels that turns a press into a drag. It is not 0, because hands shake a little during a click.
const DRAG_MIN: f64 = 4.0;
/// Number of pixels of touchpad scrolling that equals one notch of a wheel.
const NOTCH_PIXELS: f64 = 40.0;

/// The state of the mouse, from events that do not belong to the overlay.
#[derive(Debug, Default)]
pub struct Pointer {
    place: [f64; 2],
    last_click: Option<(Instant, [f64; 2])>,
    /// While the button is held: the last position, and true once the movement is a drag.
    held: Option<([f64; 2], bool)>,
    pressed_at: [f64; 2],
}

impl Pointer {
    /// Handles an event, and returns the command of the gesture that it completes.
    pub(crate) fn handle(&mut self, input: &Input, now: Instant) -> Option<Command> {
        match input {
            Input::PointerMoved(place) => self.moved(*place),
            Input::PointerButton { button: PointerButton::Primary, pressed: true } => self.pressed(now),
            Input::PointerButton { button: PointerButton::Primary, pressed: false } => {
                let (from, drags) = self.held.take()?;
                (!drags).then_some(Command::Inspect(from))
            }
            Input::Wheel(wheel) => {
                let notches = match wheel {
                    Wheel::Notches([_, notches]) => *notches,
                    Wheel::Pixels([_, pixels]) => pixels / NOTCH_PIXELS,
                };
                (notches != 0.0).then_some(Command::ZoomCamera(notches))
            }
            Input::Focused(false) => {
                self.held = None;
                None
            }
            _ => None,
        }
    }

    /// The position in pixels at which the present gesture began; the pointer's position if no button is held.
    pub fn began(&self) -> [f64; 2] {
        if self.held.is_some() { self.pressed_at } else { self.place }
    }

    /// The position in pixels, and true while the first button is held.
    pub fn place(&self) -> ([f64; 2], bool) {
        (self.place, self.held.is_some())
    }

    fn moved(&mut self, to: [f64; 2]) -> Option<Command> {
        self.place = to;
        let (from, drags) = self.held?;
        let way = [to[0] - from[0], to[1] - from[1]];
        if !drags && way[0].hypot(way[1]) < DRAG_MIN {
            return None;
        }
        self.held = Some((to, true));
        self.last_click = None;
        (way != [0.0; 2]).then_some(Command::TurnCamera(way))
    }

    fn pressed(&mut self, now: Instant) -> Option<Command> {
        let double = self.last_click.is_some_and(|(then, place)| {
            let [dx, dy] = [place[0] - self.place[0], place[1] - self.place[1]];
            now.saturating_duration_since(then) <= DOUBLE_CLICK.0 && dx.hypot(dy) <= DOUBLE_CLICK.1
        });
        self.last_click = if double { None } else { Some((now, self.place)) };
        // A double click starts no drag, because a double click changes the window's size under the pointer.
        self.held = (!double).then_some((self.place, false));
        self.pressed_at = self.place;
        double.then_some(Command::Fullscreen(Switch::Toggle))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn to(x: f64, y: f64) -> Input {
        Input::PointerMoved([x, y])
    }

    fn button(pressed: bool) -> Input {
        Input::PointerButton { button: PointerButton::Primary, pressed }
    }

    #[test]
    fn a_held_button_drags_and_a_still_one_clicks() {
        let (mut pointer, now) = (Pointer::default(), Instant::now());
        let (down, up) = (button(true), button(false));
        let mut all = |events: &[&Input]| -> Vec<Option<Command>> {
            events.iter().map(|event| pointer.handle(event, now)).collect()
        };
        let click = [None, None, None, Some(Command::Inspect([10.0, 10.0]))];
        assert_eq!(all(&[&to(10.0, 10.0), &down, &to(12.0, 11.0), &up]), click, "a shaking hand");
        assert_eq!(all(&[&to(13.0, 10.0), &down]), [None, Some(Command::Fullscreen(Switch::Toggle))]);
        assert_eq!(all(&[&to(90.0, 10.0), &up]), [None, None], "the second click drags nothing");
        let drags = all(&[&down, &to(100.0, 13.0), &to(101.0, 13.0), &up, &to(0.0, 0.0)]);
        let drag = |way| Some(Command::TurnCamera(way));
        let ways = [None, drag([10.0, 3.0]), drag([1.0, 0.0]), None, None];
        assert_eq!(drags, ways);
        assert_eq!(all(&[&to(101.0, 13.0), &down])[1], None, "a drag is not a click");
        assert_eq!(all(&[&Input::Focused(false), &to(0.0, 0.0)]), [None, None]);
    }

    #[test]
    fn a_gesture_begins_at_the_press_or_at_the_pointer() {
        let (mut pointer, now) = (Pointer::default(), Instant::now());
        let mut after = |event: &Input| {
            let _ = pointer.handle(event, now);
            pointer.began()
        };
        assert_eq!(after(&to(5.0, 6.0)), [5.0, 6.0]);
        assert_eq!(after(&button(true)), [5.0, 6.0]);
        assert_eq!(after(&to(70.0, 80.0)), [5.0, 6.0]);
        assert_eq!(after(&button(false)), [70.0, 80.0]);
    }

    #[test]
    fn wheels_and_touchpads_zoom() {
        let mut pointer = Pointer::default();
        let mut zoom = |wheel| pointer.handle(&Input::Wheel(wheel), Instant::now());
        assert_eq!(zoom(Wheel::Notches([0.0, -2.0])), Some(Command::ZoomCamera(-2.0)));
        assert_eq!(zoom(Wheel::Pixels([7.0, 20.0])), Some(Command::ZoomCamera(0.5)));
        assert_eq!(zoom(Wheel::Notches([1.0, 0.0])), None);
    }
}
