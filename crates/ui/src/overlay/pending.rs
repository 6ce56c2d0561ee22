//! Collects the user's input between layouts and translates it into egui's events.

use std::time::Instant;

use egui::{Event, Modifiers, MouseWheelUnit, Pos2, RawInput, TouchDeviceId, TouchId, pos2, vec2};

use crate::clock;
use mariana_commands::input::{self, Input, PointerButton, TouchPhase, Wheel};

#[derive(Debug)]
pub(super) struct PendingInput {
    raw: RawInput,
    /// Position of the pointer, in points.
    place: Option<Pos2>,
    held: Modifiers,
    finger: Option<u64>,
    started: Instant,
}

impl PendingInput {
    /// Starts without events. egui's textures may have sides of up to `texture_side_max` texels.
    pub(super) fn new(texture_side_max: Option<usize>) -> Self {
        let raw = RawInput { max_texture_side: texture_side_max, focused: true, ..RawInput::default() };
        Self { raw, place: None, held: Modifiers::NONE, finger: None, started: clock::now() }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.raw.events.is_empty()
    }

    pub(super) fn extend(&mut self, events: impl IntoIterator<Item = Event>) {
        self.raw.events.extend(events);
    }

    pub(super) fn clear(&mut self) {
        self.raw.events.clear();
    }

    pub(super) fn forget_pointer(&mut self) {
        self.raw.events.retain(|event| matches!(event, Event::AccessKitActionRequest(_) | Event::Key { .. }));
    }

    /// Adds events of the pointer's first button and of modifier keys. egui gets no other buttons and keys.
    pub(super) fn add(&mut self, input: &Input, pixels_per_point: f32) {
        let points = |[x, y]: [f64; 2]| pos2(x as f32, y as f32) / pixels_per_point;
        match input {
            Input::PointerMoved(place) => self.move_to(points(*place)),
            Input::PointerLeft => self.leave(),
            Input::PointerButton { button: PointerButton::Primary, pressed } => self.press(*pressed),
            Input::Wheel(wheel) => {
                let (unit, delta) = match wheel {
                    Wheel::Notches([x, y]) => (MouseWheelUnit::Line, vec2(*x as f32, *y as f32)),
                    Wheel::Pixels(pixels) => (MouseWheelUnit::Point, points(*pixels).to_vec2()),
                };
                let (phase, modifiers) = (egui::TouchPhase::Move, self.held);
                let source = egui::MouseWheelSource::Unknown;
                self.raw.events.push(Event::MouseWheel { unit, delta, phase, modifiers, source });
            }
            Input::Touch { finger, phase, place } => self.touch(*finger, *phase, points(*place)),
            Input::Modifiers(held) => {
                self.held = modifiers(*held);
                self.raw.events.push(Event::ModifiersChanged(self.held));
            }
            Input::Focused(focused) => {
                self.raw.focused = *focused;
                if !focused {
                    self.held = Modifiers::NONE;
                }
                self.raw.events.push(Event::WindowFocused(*focused));
            }
            Input::PointerButton { button: PointerButton::Other, .. } => {}
            Input::Key(_) | Input::Text(_) | Input::Composing(_) | Input::Dropped(_) => {}
        }
    }

    /// Removes and returns the input until `now`, for a screen with `scale` pixels per point.
    pub(super) fn drain(&mut self, scale: f32, now: Instant) -> RawInput {
        self.raw.time = Some(now.saturating_duration_since(self.started).as_secs_f64());
        let viewport = self.raw.viewports.entry(self.raw.viewport_id).or_default();
        viewport.native_pixels_per_point = Some(scale);
        self.raw.take()
    }

    fn move_to(&mut self, place: Pos2) {
        self.place = Some(place);
        self.raw.events.push(Event::PointerMoved(place));
    }

    fn leave(&mut self) {
        self.place = None;
        self.raw.events.push(Event::PointerGone);
    }

    fn press(&mut self, pressed: bool) {
        let (button, modifiers) = (egui::PointerButton::Primary, self.held);
        let press = self.place.map(|pos| Event::PointerButton { pos, button, pressed, modifiers });
        self.raw.events.extend(press);
    }

    fn touch(&mut self, finger: u64, phase: TouchPhase, pos: Pos2) {
        self.raw.events.push(Event::Touch {
            device_id: TouchDeviceId(0),
            id: TouchId::from(finger),
            phase: match phase {
                TouchPhase::Started => egui::TouchPhase::Start,
                TouchPhase::Moved => egui::TouchPhase::Move,
                TouchPhase::Ended => egui::TouchPhase::End,
                TouchPhase::Cancelled => egui::TouchPhase::Cancel,
            },
            pos,
            force: None,
        });
        if self.finger.is_some_and(|first| first != finger) {
            return;
        }
        match phase {
            TouchPhase::Started => {
                self.finger = Some(finger);
                self.move_to(pos);
                self.press(true);
            }
            TouchPhase::Moved => self.move_to(pos),
            TouchPhase::Ended => {
                self.finger = None;
                self.press(false);
                self.leave();
            }
            TouchPhase::Cancelled => {
                self.finger = None;
                self.leave();
            }
        }
    }
}

fn modifiers(held: input::Modifiers) -> Modifiers {
    let is_mac = cfg!(target_os = "macos");
    Modifiers {
        alt: held.contains(input::Modifiers::ALT),
        ctrl: held.contains(input::Modifiers::CONTROL),
        shift: held.contains(input::Modifiers::SHIFT),
        mac_cmd: is_mac && held.contains(input::Modifiers::SUPER),
        command: held.contains(if is_mac { input::Modifiers::SUPER } else { input::Modifiers::CONTROL }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_first_finger_acts_as_the_pointer() {
        let mut pending = PendingInput::new(None);
        let touch = |finger, phase, x| Input::Touch { finger, phase, place: [x, 8.0] };
        for input in [
            touch(7, TouchPhase::Started, 4.0),
            touch(9, TouchPhase::Started, 90.0),
            touch(7, TouchPhase::Ended, 4.0),
        ] {
            pending.add(&input, 2.0);
        }
        let events = pending.drain(2.0, Instant::now()).events;
        let places: Vec<Pos2> = events
            .iter()
            .filter_map(|event| match event {
                Event::PointerMoved(place) => Some(*place),
                _ => None,
            })
            .collect();
        assert_eq!(places, [pos2(2.0, 4.0)]);
        assert_eq!(events.last(), Some(&Event::PointerGone));
        assert!(pending.is_empty());
    }
}
