//! Screen readers and other assistive technology. The system's interface for them belongs to the window's thread, the
//! controls are drawn by the show's: requests go one way, trees of controls the other.

use accesskit_winit::{Adapter, Event, WindowEvent as Asked};
use egui::accesskit::TreeUpdate;
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, EventLoop, EventLoopProxy};
use winit::window::Window;

use crate::shell::messages::WindowMessage;
use crate::ui::overlay::Assistance;

/// What the window asks in the words of the panels.
fn assistance(asked: Asked) -> Assistance {
    match asked {
        Asked::InitialTreeRequested => Assistance::Begins,
        Asked::ActionRequested(request) => Assistance::Act(request),
        Asked::AccessibilityDeactivated => Assistance::Ends,
    }
}

/// Where the show tells its controls.
#[derive(Clone)]
pub(crate) struct AccessibilityPublisher(EventLoopProxy<WindowMessage>);

impl AccessibilityPublisher {
    /// Tells them by way of `event_loop`.
    pub(crate) fn new(event_loop: &EventLoop<WindowMessage>) -> Self {
        Self(event_loop.create_proxy())
    }

    /// Tells what there is now.
    pub(crate) fn tell(&self, controls: TreeUpdate) {
        // A window that has gone shows no controls.
        let _ = self.0.send_event(WindowMessage::Controls(Box::new(controls)));
    }
}

/// The window's side.
pub(crate) struct Accessibility(Adapter);

impl Accessibility {
    /// Offers `window`, which must not be visible yet. Asks for nothing and costs nothing before somebody listens.
    pub(crate) fn new(
        event_loop: &ActiveEventLoop,
        window: &Window,
        proxy: EventLoopProxy<WindowMessage>,
    ) -> Self {
        Self(Adapter::with_event_loop_proxy(event_loop, window, proxy))
    }

    /// Takes an event of the window.
    pub(crate) fn note(&mut self, window: &Window, event: &WindowEvent) {
        self.0.process_event(window, event);
    }

    /// Hands on what controls there are, if somebody listens.
    pub(crate) fn show(&mut self, controls: TreeUpdate) {
        self.0.update_if_active(|| controls);
    }
}

impl From<Event> for WindowMessage {
    fn from(event: Event) -> Self {
        Self::Assistance(assistance(event.window_event))
    }
}
