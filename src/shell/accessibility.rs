//! Support for screen readers and the like, by AccessKit. The window's thread owns the system's interface and passes
//! requests to the show. The show's thread draws the controls and sends their tree to the window.

use accesskit_winit::{Adapter, Event, WindowEvent as Asked};
use egui::accesskit::TreeUpdate;
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, EventLoop, EventLoopProxy};
use winit::window::Window;

use crate::shell::messages::WindowMessage;
use crate::ui::overlay::Assistance;

fn assistance(asked: Asked) -> Assistance {
    match asked {
        Asked::InitialTreeRequested => Assistance::Begins,
        Asked::ActionRequested(request) => Assistance::Act(request),
        Asked::AccessibilityDeactivated => Assistance::Ends,
    }
}

/// Sends the show's controls to the window's thread.
#[derive(Clone)]
pub(crate) struct AccessibilityPublisher(EventLoopProxy<WindowMessage>);

impl AccessibilityPublisher {
    pub(crate) fn new(event_loop: &EventLoop<WindowMessage>) -> Self {
        Self(event_loop.create_proxy())
    }

    pub(crate) fn publish(&self, controls: TreeUpdate) {
        // A closed window needs no controls.
        let _ = self.0.send_event(WindowMessage::Controls(Box::new(controls)));
    }
}

pub(crate) struct Accessibility(Adapter);

impl Accessibility {
    /// Creates the adapter of `window`, which must not be visible yet. Does nothing until assistive technology
    /// connects.
    pub(crate) fn new(
        event_loop: &ActiveEventLoop,
        window: &Window,
        proxy: EventLoopProxy<WindowMessage>,
    ) -> Self {
        Self(Adapter::with_event_loop_proxy(event_loop, window, proxy))
    }

    pub(crate) fn handle_event(&mut self, window: &Window, event: &WindowEvent) {
        self.0.process_event(window, event);
    }

    pub(crate) fn show(&mut self, controls: TreeUpdate) {
        self.0.update_if_active(|| controls);
    }
}

impl From<Event> for WindowMessage {
    fn from(event: Event) -> Self {
        Self::Assistance(assistance(event.window_event))
    }
}
