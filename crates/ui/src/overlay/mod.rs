//! The overlay: everything drawn over the frame, from notices and sliders to the editor.
//!
//! The session passes an [`OverlayContent`] and asks [`Overlay::due`] when the window must be drawn again. Unchanged
//! content is painted again without a new layout, and an empty overlay has no cost.
//!
//! Keys belong to the show until Shift+Tab, or Tab with a screen reader, moves the focus to the controls. Escape
//! returns the focus to the show. A click that begins on a panel belongs to the overlay.

mod acts;
mod assisted;
mod bar;
mod binding;
mod browser;
mod calm;
mod chips;
mod content;
mod controllers;
mod corners;
mod cues;
mod decks;
mod editor;
mod files;
mod fonts;
mod help;
mod icons;
mod kept;
mod marks;
mod now_playing;
mod pairing_address;
mod panels;
mod params;
mod pending;
mod picture;
mod pointer;
mod preview;
mod problem;
mod ray;
mod rooms;
mod settings;
mod snapshots;
mod sources;
mod style;
mod switches;
#[cfg(test)]
mod tests;
mod tracks;
mod video;
mod welcome;
mod words;

use std::time::Instant;

use egui::accesskit::TreeUpdate;
use egui::{ClippedPrimitive, CursorIcon, Event, Modifiers, RawInput, Rect, Vec2};
use egui_glow::Painter;

pub use acts::{Acts, On, PanelAct};
pub use assisted::Assistance;
pub use bar::Bar;
pub use content::{
    CueRow, CueSheet, Deck, DeckStrip, Notice, OverlayContent, Problem, SNAPSHOTS, SnapshotRow, SourceList,
};
pub use marks::near_border;
pub use now_playing::{NowPlaying, clock_time};
use panels::{Panels, pressed};
use pending::PendingInput;
pub use picture::Cover;
use pointer::Pointer;
pub use preview::NextScene;
pub use ray::RayView;
pub use switches::PanelSwitches;
pub use welcome::Welcome;

use mariana_commands::input::{Input, Key, NamedKey};
use mariana_render::gpu::error::GpuError;
use mariana_render::gpu::gl::Gl;
use mariana_render::system_fonts::SystemFonts;

/// The overlay of a window. Drop it before the window's OpenGL context.
pub struct Overlay {
    gl: Gl,
    panels: Panels,
    input: PendingInput,
    /// The painter, which is created at the first draw.
    painter: Option<Painter>,
    pointer: Pointer,
    cursor: CursorIcon,
    /// The last reported position of the text cursor, in pixels.
    typed_at: Option<Rect>,
    shown: Option<Shown>,
    /// True while an assistive technology receives the controls.
    pub assisted: bool,
}

struct Shown {
    primitives: Vec<ClippedPrimitive>,
    pixels_per_point: f32,
    size: (u32, u32),
    fingerprint: u64,
    interactive: bool,
    changes_at: Option<Instant>,
}

/// The result of [`Overlay::paint`].
#[derive(Default)]
pub struct Painted {
    /// What the user's input does.
    pub acts: Acts,
    /// The tree of controls for assistive technology.
    pub controls: Option<TreeUpdate>,
    /// The new cursor icon, if it has changed.
    pub cursor: Option<CursorIcon>,
    /// The new position of the text cursor in pixels, if it has changed. An input method places its candidates there.
    pub typed_at: Option<Rect>,
}

impl Overlay {
    /// Creates an empty overlay without calling OpenGL. Other threads call `wake` when the overlay becomes
    /// [`Self::due`].
    pub fn new(gl: &Gl, wake: impl Fn() + Send + 'static) -> Self {
        let panels = Panels::new(SystemFonts::default(), wake);
        Self {
            gl: gl.clone(),
            panels,
            input: PendingInput::new(usize::try_from(gl.info().texture_side_max).ok()),
            painter: None,
            pointer: Pointer::default(),
            cursor: CursorIcon::Default,
            typed_at: None,
            shown: None,
            assisted: false,
        }
    }

    /// Handles input other than keys (see [`Overlay::handle_key`]). Returns true if only the overlay may use the input.
    pub fn on_input(&mut self, input: &Input) -> bool {
        let consumed = self.pointer.on_event(input);
        self.input.add(input, self.panels.context.pixels_per_point());
        if !self.shown.as_ref().is_some_and(|shown| shown.interactive) {
            self.input.forget_pointer();
        }
        consumed
    }

    /// Returns true while a control has the keyboard focus.
    pub fn has_key_focus(&self) -> bool {
        self.panels.context.memory(|memory| memory.focused().is_some())
    }

    /// Returns the keyboard focus to the show.
    pub fn drop_key_focus(&self) {
        self.panels.context.memory_mut(|memory| {
            if let Some(id) = memory.focused() {
                memory.surrender_focus(id);
            }
        });
    }

    /// Passes a key to the controls. Tab moves the focus; Enter, Space and arrows act on the focused control. Returns
    /// false for unrelated keys.
    pub fn handle_key(&mut self, key: &Key, shift: bool) -> bool {
        let Some(key) = key_of_controls(key) else { return false };
        if self.has_key_focus() {
            let modifiers = Modifiers { shift, ..Modifiers::NONE };
            self.input.extend(pressed(key, modifiers));
        } else {
            self.panels.wants_focus = true;
        }
        true
    }

    /// Handles an event of assistive technology.
    pub fn assist(&mut self, assistance: Assistance) {
        let context = &self.panels.context;
        match assistance {
            Assistance::Begins => context.enable_accesskit(),
            Assistance::Ends => context.disable_accesskit(),
            Assistance::Act(request) => {
                return self.input.extend([Event::AccessKitActionRequest(request)]);
            }
        }
        self.assisted = assistance == Assistance::Begins;
        // Make the next paint lay out the panels again and report the controls.
        self.shown = None;
    }

    /// Returns when `content` must be drawn again: `now` or later. `None` if only input can change the drawing.
    pub fn due(&self, content: &OverlayContent<'_>, now: Instant) -> Option<Instant> {
        let Some(shown) = &self.shown else {
            let changes =
                !content.is_empty(now) || content.hides_pointer == (self.cursor != CursorIcon::None);
            return changes.then_some(now);
        };
        let changed = content.fingerprint(now) != shown.fingerprint;
        let touched = !self.input.is_empty();
        let relaid = changed || touched || self.panels.wants_focus || self.panels.fallback.has_found();
        if relaid { Some(now) } else { shown.changes_at.map(|at| at.max(now)) }
    }

    /// Paints `content` over a window of `size` pixels, with `scale` pixels per point. Makes no OpenGL calls if
    /// there is no content.
    ///
    /// # Errors
    /// Fails if the driver reports an error.
    pub fn paint(
        &mut self,
        scale: f32,
        size: (u32, u32),
        content: OverlayContent<'_>,
        now: Instant,
    ) -> Result<Painted, GpuError> {
        if content.is_empty(now) {
            self.panels.forget_focus();
            if self.shown.take().is_some() {
                self.pointer.panels.clear();
                self.input.clear();
            }
            let cursor = if content.hides_pointer { CursorIcon::None } else { CursorIcon::Default };
            return Ok(Painted { cursor: self.changed_cursor(cursor), ..Painted::default() });
        }
        let pixels_per_point = scale * style::zoom(points(size, scale));
        let stands = self.due(&content, now).is_none_or(|due| due > now)
            && self.shown.as_ref().is_some_and(|shown| {
                shown.size == size && shown.pixels_per_point.to_bits() == pixels_per_point.to_bits()
            });
        let painted = if stands { Painted::default() } else { self.lay_out(scale, size, &content, now)? };
        if let (Some(shown), Some(painter)) = (&self.shown, &mut self.painter) {
            self.gl.lend_window("drawing the overlay", || {
                painter.paint_primitives(size.into(), shown.pixels_per_point, &shown.primitives);
            })?;
        }
        Ok(painted)
    }

    fn lay_out(
        &mut self,
        scale: f32,
        size: (u32, u32),
        content: &OverlayContent<'_>,
        now: Instant,
    ) -> Result<Painted, GpuError> {
        // Create the painter first: egui's textures need it.
        if self.painter.is_none() {
            let painter = Painter::new(self.gl.shared(), "", None, false);
            let refused = |reason| GpuError::Object { what: "the painter of the panels", reason };
            let remedy = "update the graphics driver";
            self.painter = Some(painter.map_err(|error| refused(format!("{error}; {remedy}")))?);
        }
        let interactive = content.is_interactive();
        let input = self.raw_input(scale, size, interactive, now);
        let laid_out = self.panels.lay_out(input, content, now);
        let mut output = laid_out.output;
        let controls = output.platform_output.accesskit_update.take();
        let cursor =
            if content.hides_pointer { CursorIcon::None } else { output.platform_output.cursor_icon };
        let typed_at = output.platform_output.ime.take().map(|ime| ime.cursor_rect * output.pixels_per_point);

        let mut textures = output.textures_delta;
        let painter = &mut self.painter;
        self.gl.lend_window("uploading the overlay's letters", || {
            let Some(painter) = painter else { return textures.clear() };
            for (id, images) in textures.set.drain() {
                for image in images {
                    painter.set_texture(id, &image);
                }
            }
            for id in textures.free.drain() {
                painter.free_texture(id);
            }
        })?;

        let pixels_per_point = output.pixels_per_point;
        self.pointer.panels = laid_out.panels.iter().map(|rect| *rect * pixels_per_point).collect();
        let own = now.checked_add(laid_out.repaint_after);
        let fades = content.notice.as_ref().and_then(|notice| notice.next_change(now));
        let answer = content.editor.and_then(|editor| editor.notice.goes_at());
        let goes = content.welcome.as_ref().and_then(|welcome| welcome.next_change(now));
        self.shown = Some(Shown {
            primitives: self.panels.context.tessellate(output.shapes, pixels_per_point),
            pixels_per_point,
            size,
            fingerprint: content.fingerprint(now),
            interactive,
            changes_at: own.into_iter().chain(fades).chain(goes).chain(answer).min(),
        });
        let (cursor, typed_at) = (self.changed_cursor(cursor), self.changed_place_of_letters(typed_at));
        Ok(Painted { acts: laid_out.acts, controls, cursor, typed_at })
    }

    fn changed_place_of_letters(&mut self, at: Option<Rect>) -> Option<Rect> {
        let changed = at.filter(|rect| rect.is_finite() && self.typed_at != at);
        self.typed_at = changed.or(self.typed_at);
        changed
    }

    fn changed_cursor(&mut self, cursor: CursorIcon) -> Option<CursorIcon> {
        let is_new = self.cursor != cursor;
        self.cursor = cursor;
        is_new.then_some(cursor)
    }

    /// True if the pointer is over a panel, or was pressed on a panel and is still held.
    pub fn has_pointer(&self) -> bool {
        self.pointer.is_busy()
    }

    fn raw_input(&mut self, scale: f32, size: (u32, u32), interactive: bool, now: Instant) -> RawInput {
        let zoom = style::zoom(points(size, scale));
        // Do not call `set_zoom_factor`: egui would then derive the window's size from the previous pass.
        self.panels.context.options_mut(|options| options.zoom_factor = zoom);
        let mut input = self.input.drain(scale, now);
        input.screen_rect = Some(Rect::from_min_size(egui::Pos2::ZERO, points(size, scale * zoom)));
        let was = self.shown.as_ref().is_some_and(|shown| shown.interactive);
        if was && !interactive {
            // Controls that are only for screen readers do not react to the pointer.
            input.events.push(Event::PointerGone);
        }
        if interactive && !was {
            // Send egui the pointer events that it did not get while no control reacted to the pointer.
            if self.panels.context.input(|input| input.pointer.any_down()) {
                input.events.push(egui::Event::PointerGone);
            }
            if let Some(place) = self.pointer.place {
                input.events.push(egui::Event::PointerMoved(place / (scale * zoom)));
            }
        }
        input
    }
}

impl Drop for Overlay {
    fn drop(&mut self) {
        if let Some(painter) = &mut self.painter {
            painter.destroy();
        }
    }
}

fn key_of_controls(key: &Key) -> Option<egui::Key> {
    let Key::Named(named) = key else { return None };
    match named {
        NamedKey::Tab => Some(egui::Key::Tab),
        NamedKey::Enter => Some(egui::Key::Enter),
        NamedKey::Space => Some(egui::Key::Space),
        NamedKey::Escape => Some(egui::Key::Escape),
        NamedKey::ArrowLeft => Some(egui::Key::ArrowLeft),
        NamedKey::ArrowRight => Some(egui::Key::ArrowRight),
        _ => None,
    }
}

fn points(size: (u32, u32), pixels_per_point: f32) -> Vec2 {
    Vec2::new(size.0 as f32, size.1 as f32) / pixels_per_point
}
