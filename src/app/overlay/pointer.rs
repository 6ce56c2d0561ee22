//! Decides whose a click is: the overlay's if it began on a panel, otherwise the show's.

use egui::{Pos2, Rect, pos2};
use winit::event::{ElementState, TouchPhase, WindowEvent};

/// Where the pointer and the panels are, in pixels.
#[derive(Debug, Default)]
pub(super) struct Pointer {
    /// The pointer's place, while it is in the window.
    pub place: Option<Pos2>,
    /// The panels that take clicks.
    pub panels: Vec<Rect>,
    /// Buttons that are held and were pressed on a panel.
    held: u32,
}

impl Pointer {
    /// Takes an event and returns whether it belongs to the overlay alone.
    pub(super) fn on_event(&mut self, event: &WindowEvent) -> bool {
        match event {
            WindowEvent::CursorMoved { position, .. } => {
                self.place = Some(pos2(position.x as f32, position.y as f32));
                // The show needs the pointer's place wherever it is.
                false
            }
            WindowEvent::CursorLeft { .. } => {
                self.place = None;
                false
            }
            WindowEvent::MouseInput { state, .. } => self.on_button(*state),
            WindowEvent::MouseWheel { .. } => self.held > 0 || self.is_on_panel(self.place),
            WindowEvent::Touch(touch) if touch.phase == TouchPhase::Started => {
                self.is_on_panel(Some(pos2(touch.location.x as f32, touch.location.y as f32)))
            }
            _ => false,
        }
    }

    /// Whether it is on a panel, or was pressed on one and is still held.
    pub(super) fn is_busy(&self) -> bool {
        self.held > 0 || self.is_on_panel(self.place)
    }

    fn on_button(&mut self, state: ElementState) -> bool {
        match state {
            ElementState::Pressed if self.held > 0 || self.is_on_panel(self.place) => self.held += 1,
            ElementState::Released if self.held > 0 => self.held -= 1,
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
    use winit::dpi::PhysicalPosition;
    use winit::event::{DeviceId, MouseButton, MouseScrollDelta};

    use super::*;

    fn moved(x: f64, y: f64) -> WindowEvent {
        WindowEvent::CursorMoved { device_id: DeviceId::dummy(), position: PhysicalPosition { x, y } }
    }

    fn button(state: ElementState) -> WindowEvent {
        WindowEvent::MouseInput { device_id: DeviceId::dummy(), state, button: MouseButton::Left }
    }

    #[test]
    fn a_click_belongs_to_where_it_began() {
        let mut pointer = Pointer {
            panels: vec![Rect::from_min_max(pos2(10.0, 10.0), pos2(20.0, 20.0))],
            ..Default::default()
        };
        let (down, up) = (button(ElementState::Pressed), button(ElementState::Released));
        let wheel = WindowEvent::MouseWheel {
            device_id: DeviceId::dummy(),
            delta: MouseScrollDelta::LineDelta(0.0, 1.0),
            phase: TouchPhase::Moved,
        };
        let mut answers = |events: &[&WindowEvent]| -> Vec<bool> {
            events.iter().map(|event| pointer.on_event(event)).collect()
        };
        assert_eq!(answers(&[&down, &up, &wheel]), [false; 3], "nowhere");
        assert_eq!(answers(&[&moved(15.0, 15.0), &down, &up, &wheel]), [false, true, true, true]);
        assert_eq!(answers(&[&moved(25.0, 15.0), &down, &up, &wheel]), [false; 4]);
        // Dragged out of the panel and into it.
        assert_eq!(
            answers(&[&moved(15.0, 15.0), &down, &moved(25.0, 15.0), &up]),
            [false, true, false, true]
        );
        assert_eq!(answers(&[&down, &moved(15.0, 15.0), &up]), [false, false, false]);
    }
}
