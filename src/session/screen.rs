//! Where a session shows its pictures: a window with its outputs, or a surface that nobody sees.

use std::time::{Duration, Instant};

use egui::accesskit::TreeUpdate;
use egui::{CursorIcon, Rect};

use super::SessionError;
use super::lay::Lay;
use crate::gpu::background::WorkerContext;
use crate::gpu::gl::Gl;
use crate::gpu::renderer::Renderer;
use crate::input::Input;
use crate::monitor::Monitor;
use crate::placement::Area;
use crate::ui::overlay::Assistance;

/// Something that happened where the session is shown.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Event {
    /// A user did something.
    Input(Input),
    /// Assistive technology asks for something.
    Assistance(Assistance),
    /// The window is to be drawn.
    Redraw,
    /// The session is to end.
    End,
}

/// Paints over the picture in the current framebuffer of so many pixels.
pub(crate) type Paint<'a> = &'a mut dyn FnMut((u32, u32)) -> Result<(), SessionError>;

/// See the module. The context of [`Screen::gl`] is current on the session's thread.
///
/// Changes of the window are requests: whether and when the window system follows them shows in later answers.
pub(crate) trait Screen {
    /// Waits until something happens, at most until a moment. Returns what happened since the last call, in order; of
    /// several requests to draw, one.
    fn wait(&mut self, until: Instant) -> Vec<Event>;

    /// The functions of the context.
    fn gl(&self) -> &Gl;

    /// Contexts for compiling programs on other threads; fewer than asked for if the driver gives fewer.
    fn worker_contexts(&self, count: usize) -> Vec<WorkerContext>;

    /// Makes the context anew, because the driver has lost it. What was made in the old one must be gone.
    ///
    /// # Errors
    /// The driver gives no other context.
    fn renew(self: Box<Self>) -> Result<Box<dyn Screen>, SessionError>;

    /// Frames per second of the monitor, if they are known.
    fn refresh_rate(&self) -> Option<f64>;

    /// Width and height of the window in pixels; `None` while it has no area.
    fn size(&self) -> Option<(u32, u32)>;

    /// Pixels per point of the window.
    fn scale(&self) -> f32;

    /// Width and height of the screen that pictures are drawn for, in pixels: the output's, else the wallpaper's, else
    /// the window's.
    fn picture_size(&self) -> Option<(u32, u32)>;

    /// Where the window begins on the desktop while it does not fill the screen, in pixels; `None` if nobody knows.
    fn place(&self) -> Option<(i32, i32)>;

    /// Whether the window fills its screen.
    fn is_fullscreen(&self) -> bool;

    /// Lets the window fill its screen, or no longer.
    fn set_fullscreen(&mut self, on: bool);

    /// Sets the title.
    fn set_title(&mut self, title: &str);

    /// Shows the window in front of others.
    fn raise(&mut self);

    /// Sets the look of the pointer; [`CursorIcon::None`] hides it.
    fn set_cursor(&mut self, cursor: CursorIcon);

    /// Lets input methods put letters together, or not.
    fn allow_composing(&mut self, on: bool);

    /// Reports where letters are typed, in pixels.
    fn set_place_of_letters(&mut self, place: Rect);

    /// Reports whether keys are text, so that no letter ends the program.
    fn set_keys_are_text(&mut self, on: bool);

    /// Reports the controls to assistive technology.
    fn show_controls(&mut self, controls: TreeUpdate);

    /// Requests a [`Event::Redraw`].
    fn request_redraw(&self);

    /// Whether somebody may see the pictures.
    fn is_seen(&self) -> bool;

    /// Whether words over the picture would be shown.
    fn shows_words(&self) -> bool;

    /// Whether something other than the window is to be drawn, although the picture is the same.
    fn is_stale(&self) -> bool;

    /// Shows the picture in the window, or where the wallpaper is, with what `paint` paints over it. It lies in the
    /// part `small` of the window if there is one. `is_new` if it looks different. Returns how long it took until the
    /// window system was to show it.
    ///
    /// # Errors
    /// What the driver refuses, or `paint` returns.
    fn show(
        &mut self,
        renderer: &mut Renderer,
        lay: &Lay,
        small: Option<Area>,
        is_new: bool,
        paint: Paint<'_>,
    ) -> Result<Duration, SessionError>;

    /// Shows black with what `paint` paints over it; nothing where there is no window to be seen.
    ///
    /// # Errors
    /// What the driver refuses, or `paint` returns.
    fn show_waiting(&mut self, paint: Paint<'_>) -> Result<(), SessionError>;

    /// Whether there is an output that shows the picture.
    fn has_output(&self) -> bool;

    /// Brings outputs and wallpaper up to date with the monitors. Returns sentences about what has changed.
    fn update(&mut self) -> Vec<String>;

    /// The monitors that are there.
    fn monitors(&self) -> Vec<Monitor>;

    /// Looks for monitors from now on.
    fn look_at_monitors(&mut self);

    /// Fills the monitor with this name or number with the picture, once it is there, or none.
    fn want_output(&mut self, monitor: Option<String>);

    /// The picture lies otherwise than before on the output.
    fn lie_differently(&mut self);

    /// Shows the picture on the output, if that shows another one; `is_new` if it looks different.
    ///
    /// # Errors
    /// What the driver refuses.
    fn show_on_output(
        &mut self,
        renderer: &mut Renderer,
        lay: &Lay,
        is_new: bool,
    ) -> Result<(), SessionError>;
}
