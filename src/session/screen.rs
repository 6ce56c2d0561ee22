//! The screen of a session: a window with its outputs, or an offscreen surface.

use std::time::{Duration, Instant};

use egui::accesskit::TreeUpdate;
use egui::{CursorIcon, Rect};

use super::SessionError;
use super::lay::Lay;
use crate::gpu::{Gl, Renderer, WorkerContext};
use crate::input::Input;
use crate::monitor::Monitor;
use crate::placement::Area;
use crate::ui::overlay::Assistance;

/// What a screen reports to its session.
#[derive(Debug, Clone, PartialEq)]
pub enum Event {
    /// Input of the user.
    Input(Input),
    /// A request of assistive technology.
    Assistance(Assistance),
    /// The window needs a new frame.
    Redraw,
    /// The session is to end.
    End,
}

/// Paints over the frame in the current framebuffer of the given size in pixels.
pub type Paint<'a> = &'a mut dyn FnMut((u32, u32)) -> Result<(), SessionError>;

/// The surface that shows a session. The context of [`Screen::gl`] is current on the session's thread. Changes to the
/// window are only requests: the window system may carry them out later or never, so query the window's state.
pub trait Screen {
    /// Waits for events, at most until the given time. Returns the events in order; several redraw requests become one.
    fn wait(&mut self, until: Instant) -> Vec<Event>;

    /// The context in which the session draws.
    fn gl(&self) -> &Gl;

    /// Contexts for compiling programs on other threads; fewer than `count` if the driver provides fewer.
    fn worker_contexts(&self, count: usize) -> Vec<WorkerContext>;

    /// Replaces a lost context. Everything created in the old one must have been dropped.
    ///
    /// # Errors
    /// Fails if the driver provides no new context.
    fn renew(self: Box<Self>) -> Result<Box<dyn Screen>, SessionError>;

    /// The monitor's frames per second, if known.
    fn refresh_rate(&self) -> Option<f64>;

    /// Width and height of the window in pixels; `None` while it has no area.
    fn size(&self) -> Option<(u32, u32)>;

    /// Pixels per point of the window.
    fn scale(&self) -> f32;

    /// Size in pixels of the surface for frames: the output, otherwise the wallpaper, otherwise the window.
    fn picture_size(&self) -> Option<(u32, u32)>;

    /// The window's position on the desktop in pixels, unless it fills the screen; `None` if unknown.
    fn place(&self) -> Option<(i32, i32)>;

    /// True if the window fills its monitor.
    fn is_fullscreen(&self) -> bool;

    /// Lets the window fill its monitor, or ends this.
    fn set_fullscreen(&mut self, on: bool);

    /// Sets the window's title.
    fn set_title(&mut self, title: &str);

    /// Brings the window to the front.
    fn raise(&mut self);

    /// Sets the pointer's shape; [`CursorIcon::None`] hides it.
    fn set_cursor(&mut self, cursor: CursorIcon);

    /// Sets whether the input method may compose text.
    fn allow_composing(&mut self, on: bool);

    /// Reports the position of the text cursor, in pixels.
    fn set_place_of_letters(&mut self, place: Rect);

    /// Sets whether letter keys belong to the session, such as keys that are typed into a text. Otherwise the key that
    /// quits ends the program at once.
    fn set_keys_are_text(&mut self, on: bool);

    /// Passes the controls to screen readers.
    fn show_controls(&mut self, controls: TreeUpdate);

    /// Requests [`Event::Redraw`].
    fn request_redraw(&self);

    /// True if the frames may be visible.
    fn is_seen(&self) -> bool;

    /// True if texts over the frame would be visible.
    fn shows_words(&self) -> bool;

    /// True if a user may be waiting for the first frame: then the song starts before it.
    fn is_awaited(&self) -> bool;

    /// True if something other than the window must be redrawn, even with an unchanged frame.
    fn is_stale(&self) -> bool;

    /// Shows the frame in the window or the wallpaper, and calls `paint` to draw over it. If `small` is given, the
    /// frame fills only this part of the window. `is_new` is true for a changed frame. Returns the time spent before
    /// the frame is handed over to the window system.
    ///
    /// # Errors
    /// Fails if the frame cannot be shown.
    fn show(
        &mut self,
        renderer: &mut Renderer,
        lay: &Lay,
        small: Option<Area>,
        is_new: bool,
        paint: Paint<'_>,
    ) -> Result<Duration, SessionError>;

    /// Shows black, and calls `paint` to draw over it. Does nothing without a visible window.
    ///
    /// # Errors
    /// Fails if the window cannot be drawn.
    fn show_waiting(&mut self, paint: Paint<'_>) -> Result<(), SessionError>;

    /// True if another window or monitor shows the frame.
    fn has_output(&self) -> bool;

    /// Sets whether the screen must neither lock nor go dark.
    fn keep_awake(&mut self, on: bool);

    /// Updates outputs and wallpaper after changes of monitors. Returns messages about the changes.
    fn update(&mut self) -> Vec<String>;

    /// The connected monitors.
    fn monitors(&self) -> Vec<Monitor>;

    /// Looks for monitors again.
    fn update_monitors(&mut self);

    /// Shows the frame on the monitor with this name or number, once it is connected; `None` ends the output.
    fn request_output(&mut self, monitor: Option<String>);

    /// Notes that the placement of the frame has changed.
    fn lie_differently(&mut self);

    /// Shows the frame on the output, if it is out of date. `is_new` is true if the frame has changed.
    ///
    /// # Errors
    /// Fails if the frame cannot be shown.
    fn show_on_output(
        &mut self,
        renderer: &mut Renderer,
        lay: &Lay,
        is_new: bool,
    ) -> Result<(), SessionError>;
}
