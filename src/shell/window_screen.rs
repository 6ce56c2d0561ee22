//! The [`Screen`] of a session in a window: the window itself, the output on another monitor, and the wallpaper.

use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};

use egui::accesskit::TreeUpdate;
use egui::{CursorIcon, Rect};
use winit::dpi::{PhysicalPosition, PhysicalSize};
use winit::event::WindowEvent;
use winit::window::Fullscreen;

use crate::export::print::print_message;
use crate::gpu::{Gl, Renderer, WorkerContext};
use crate::monitor::Monitor;
use crate::placement::{Area, WHOLE};
use crate::session::{Event, Lay, Paint, Screen, SessionError};
use crate::shell::idle::StayAwake;
use crate::shell::messages::{Message, Typing, WindowMessage, may_open_text};
use crate::shell::monitors::Rect as PlaceOnDesktop;
use crate::shell::output::Output;
use crate::shell::shared_window::SharedWindow;
use crate::shell::translate::input_of;
use crate::shell::wallpaper::{Wall, Wallpaper, filling};
use crate::shell::window::{GlWindowContext, OpenWindow};
use crate::ui::desk_picture::AROUND;

pub(crate) struct WindowScreen {
    output: Output,
    wallpaper: Option<Wallpaper>,
    /// The surfaces of a wallpaper on Wayland, which show the frame instead of the window.
    wall: Option<Wall>,
    placed_at: Option<PlaceOnDesktop>,
    /// True if the window is completely covered.
    occluded: bool,
    inbox: Receiver<Message>,
    typing: Typing,
    /// Taken keys that may have opened a text.
    taken_keys: usize,
    stay_awake: StayAwake,
    news: Vec<String>,
    // The last field: dropped after everything that holds OpenGL objects.
    window: GlWindowContext,
}

impl WindowScreen {
    /// Creates a context for a window. Frames also appear on `output`, or only on the `wall` of a `wallpaper`.
    pub(crate) fn new(
        window: OpenWindow,
        inbox: Receiver<Message>,
        typing: Typing,
        output: Output,
        wallpaper: Option<Wallpaper>,
        wall: Option<Wall>,
    ) -> Result<Self, SessionError> {
        Ok(Self {
            window: window.bind()?,
            output,
            wallpaper,
            wall,
            placed_at: None,
            occluded: false,
            inbox,
            typing,
            taken_keys: 0,
            stay_awake: StayAwake::start(),
            news: Vec::new(),
        })
    }

    fn record_event(&mut self, event: &WindowEvent) {
        match event {
            WindowEvent::Moved(place) if !self.window.is_fullscreen() => {
                self.window.open.place.set(Some((*place).into()));
            }
            WindowEvent::Resized(size) => {
                self.window.resize((*size).into());
                self.window.request_redraw();
            }
            WindowEvent::Occluded(occluded) => self.occluded = *occluded,
            _ => {}
        }
    }

    fn open_output(&mut self, window: SharedWindow) {
        if let Err(error) = self.output.open(window, &self.window) {
            self.news.push(format!("there is no output on another monitor: {error}"));
            self.output.request(None);
        }
        self.window.request_redraw();
    }
}

impl Screen for WindowScreen {
    fn wait(&mut self, until: Instant) -> Vec<Event> {
        let patience = until.saturating_duration_since(Instant::now());
        let first = match self.inbox.recv_timeout(patience) {
            Ok(message) => Some(message),
            Err(RecvTimeoutError::Timeout) => None,
            Err(RecvTimeoutError::Disconnected) => return vec![Event::End],
        };
        let messages: Vec<Message> = first.into_iter().chain(self.inbox.try_iter()).collect();
        let (mut events, mut redraws) = (Vec::new(), false);
        for message in messages {
            match message {
                Message::Window(WindowEvent::RedrawRequested) => redraws = true,
                Message::Window(event) => {
                    self.record_event(&event);
                    let input = input_of(&event);
                    self.taken_keys += usize::from(input.as_ref().is_some_and(may_open_text));
                    events.extend(input.map(Event::Input));
                }
                Message::Monitors(monitors) => self.output.set_monitors(monitors),
                Message::Output(window) => self.open_output(window),
                Message::OutputEvent(event) => {
                    if self.output.handle_event(&event, &self.window) {
                        self.window.request_redraw();
                    }
                }
                Message::Assistance(assistance) => events.push(Event::Assistance(assistance)),
                Message::Wake => {}
                Message::End => events.push(Event::End),
            }
        }
        events.extend(redraws.then_some(Event::Redraw));
        events
    }

    fn gl(&self) -> &Gl {
        &self.window.gl
    }

    fn worker_contexts(&self, count: usize) -> Vec<WorkerContext> {
        WorkerContext::beside_window(&self.window.open.config, self.window.gl.info(), count)
    }

    fn renew(mut self: Box<Self>) -> Result<Box<dyn Screen>, SessionError> {
        self.output.close(&self.window);
        if let Some(wall) = &mut self.wall {
            wall.let_go();
        }
        let Self { window, .. } = *self;
        let window = window.let_go().bind()?;
        Ok(Box::new(Self { window, ..*self }))
    }

    fn refresh_rate(&self) -> Option<f64> {
        self.window.open.refresh_rate
    }

    fn size(&self) -> Option<(u32, u32)> {
        self.window.size()
    }

    fn scale(&self) -> f32 {
        self.window.window().scale_factor() as f32
    }

    fn picture_size(&self) -> Option<(u32, u32)> {
        let of_wallpaper = self.wallpaper.as_ref().and_then(Wallpaper::screen);
        let of_wall = self.wall.as_ref().and_then(Wall::screen);
        let of_window = self.window.size().filter(|_| self.wall.is_none());
        self.output.size().or(of_wall).or(of_wallpaper).or(of_window)
    }

    fn place(&self) -> Option<(i32, i32)> {
        self.window.open.place.get()
    }

    fn is_fullscreen(&self) -> bool {
        self.window.is_fullscreen()
    }

    fn set_fullscreen(&mut self, on: bool) {
        self.window.window().set_fullscreen(on.then_some(Fullscreen::Borderless(None)));
    }

    fn set_title(&mut self, title: &str) {
        self.window.window().set_title(title);
    }

    fn raise(&mut self) {
        self.window.window().focus_window();
    }

    fn set_cursor(&mut self, cursor: CursorIcon) {
        let window = self.window.window();
        match winit_cursor(cursor) {
            Some(icon) => {
                window.set_cursor_visible(true);
                window.set_cursor(icon);
            }
            None => window.set_cursor_visible(false),
        }
    }

    fn allow_composing(&mut self, on: bool) {
        self.window.window().set_ime_allowed(on);
    }

    fn set_place_of_letters(&mut self, place: Rect) {
        let corner = PhysicalPosition::new(place.left(), place.top());
        let size = PhysicalSize::new(place.width().max(1.0), place.height().max(1.0));
        self.window.window().set_ime_cursor_area(corner, size);
    }

    fn set_keys_are_text(&mut self, on: bool) {
        self.typing.set(on, std::mem::take(&mut self.taken_keys));
    }

    fn show_controls(&mut self, controls: TreeUpdate) {
        self.output.send(WindowMessage::Controls(Box::new(controls)));
    }

    fn request_redraw(&self) {
        self.window.request_redraw();
    }

    fn is_seen(&self) -> bool {
        let is_paused = self.wallpaper.as_ref().is_some_and(Wallpaper::is_paused);
        let rests = self.wall.as_ref().map_or(is_paused, |wall| wall.rests(is_paused));
        !(self.occluded || rests) || self.output.size().is_some()
    }

    fn shows_words(&self) -> bool {
        self.wall.as_ref().is_none_or(Wall::shows_words)
    }

    fn is_awaited(&self) -> bool {
        self.wall.is_none()
    }

    fn is_stale(&self) -> bool {
        self.output.is_stale() || self.wall.as_ref().is_some_and(Wall::is_due)
    }

    fn show(
        &mut self,
        renderer: &mut Renderer,
        lay: &Lay,
        small: Option<Area>,
        is_new: bool,
        paint: Paint<'_>,
    ) -> Result<Duration, SessionError> {
        let begun = Instant::now();
        let Self { window, wallpaper, wall, .. } = self;
        if let Some(wall) = wall {
            let mut paint = Some(paint);
            wall.show(window, is_new, |pixels, has_words| {
                if lay.screen == pixels {
                    lay.show(renderer, pixels, WHOLE)?;
                } else {
                    lay.show_panel(renderer, pixels, filling(lay.screen, pixels, WHOLE))?;
                }
                match paint.take_if(|_| has_words) {
                    Some(paint) => paint(pixels),
                    None => Ok(()),
                }
            })?;
            return Ok(begun.elapsed());
        }
        let size = window.size().unwrap_or_default();
        let panels = wallpaper.as_ref().map(|wallpaper| wallpaper.panels(lay.screen)).unwrap_or_default();
        if let Some(area) = small.filter(|_| panels.is_empty()) {
            window.gl.clear_window(size, AROUND)?;
            lay.show_small(renderer, size, area)?;
        } else if panels.is_empty() {
            lay.show(renderer, size, lay.area_in(size))?;
        }
        for panel in panels {
            lay.show_panel(renderer, size, panel)?;
        }
        paint(size)?;
        let painting = begun.elapsed();
        window.swap()?;
        Ok(painting)
    }

    fn show_waiting(&mut self, paint: Paint<'_>) -> Result<(), SessionError> {
        let Some(size) = self.window.size().filter(|_| self.wall.is_none()) else { return Ok(()) };
        self.window.gl.clear_window(size, [0.0; 3])?;
        paint(size)?;
        self.window.swap()
    }

    fn keep_awake(&mut self, on: bool) {
        // A wallpaper is no reason to stay awake.
        if self.wallpaper.is_none() && self.stay_awake.set(on) {
            self.output.send(WindowMessage::KeepAwake(on));
        }
    }

    fn has_output(&self) -> bool {
        self.output.size().is_some()
    }

    fn update(&mut self) -> Vec<String> {
        if let Some(wall) = &mut self.wall {
            wall.update(&self.window);
        }
        if let Some(place) = self.wallpaper.as_ref().and_then(Wallpaper::place)
            && self.placed_at != Some(place)
        {
            self.placed_at = Some(place);
            let ((x, y), (width, height)) = place;
            let window = self.window.window();
            window.set_outer_position(PhysicalPosition::new(x, y));
            let _ = window.request_inner_size(PhysicalSize::new(width, height));
        }
        let was = self.output.size();
        self.news.extend(self.output.update(&self.window));
        if self.output.size() != was {
            self.window.request_redraw();
        }
        self.news.iter().for_each(|sentence| print_message(sentence));
        std::mem::take(&mut self.news)
    }

    fn monitors(&self) -> Vec<Monitor> {
        self.output.monitors()
    }

    fn update_monitors(&mut self) {
        self.output.update_monitors();
    }

    fn request_output(&mut self, monitor: Option<String>) {
        self.output.request(monitor);
    }

    fn lie_differently(&mut self) {
        self.output.redraw();
        self.window.request_redraw();
    }

    fn show_on_output(
        &mut self,
        renderer: &mut Renderer,
        lay: &Lay,
        is_new: bool,
    ) -> Result<(), SessionError> {
        let Some(surface) = self.output.due(is_new) else { return Ok(()) };
        let size = surface.size();
        self.window.draw_on(surface, || Ok(lay.show(renderer, size, WHOLE)?))
    }
}

/// Translates the panels' cursor; `None` hides it.
fn winit_cursor(cursor: CursorIcon) -> Option<winit::window::CursorIcon> {
    use winit::window::CursorIcon as Winit;
    Some(match cursor {
        CursorIcon::None => return None,
        CursorIcon::PointingHand => Winit::Pointer,
        CursorIcon::Text => Winit::Text,
        CursorIcon::Grab => Winit::Grab,
        CursorIcon::Grabbing => Winit::Grabbing,
        CursorIcon::Move => Winit::Move,
        CursorIcon::ResizeHorizontal => Winit::EwResize,
        CursorIcon::ResizeVertical => Winit::NsResize,
        _ => Winit::Default,
    })
}
