//! The layout of the panels: turns input and content into shapes, without a window or OpenGL.

use std::time::{Duration, Instant};

use egui::{
    Align, Align2, Context, Event, FullOutput, Id, Key, LayerId, Modifiers, Order, Painter, RawInput, Rect,
    pos2, vec2,
};

use super::acts::{Acts, Pass};
use super::binding::OpenBinding;
use super::content::{Notice, OverlayContent, Problem};
use super::fonts::Fallback;
use super::rooms::Rooms;
use super::{
    assisted, bar, browser, calm, controllers, corners, cues, decks, editor, files, help, params, preview,
    problem, ray, settings, sources, style, tracks, video, welcome,
};
use crate::open_panel::OpenPanel;
use mariana_render::system_fonts::SystemFonts;

/// Maximum width of a line at the top or in the corner, as a fraction of the window's width.
const LINE_WIDTH_MAX: f32 = 0.8;
const SENTENCE_ROWS_MAX: usize = 6;
/// Maximum height of a problem, as a fraction of the window's height.
const PROBLEM_HEIGHT_MAX: f32 = 0.75;
/// Width of a value bar below a short text, in points.
const FRACTION_WIDTH: f32 = 180.0;
/// Minimum width for a problem next to the parameters, in points.
const PROBLEM_WIDTH_MIN: f32 = 420.0;
/// Minimum width for a list next to the parameters, in points.
const LIST_WIDTH_MIN: f32 = 300.0;
/// Minimum width for messages next to the track list, in points. Messages must not cover its heading and buttons.
const SENTENCE_WIDTH_MIN: f32 = 190.0;

pub(super) struct Panels {
    pub(super) context: Context,
    pub(super) fallback: Fallback,
    /// The slider whose sounds are listed.
    binding: OpenBinding,
    pub(super) wants_focus: bool,
    /// True if the last layout had controls. egui focuses no control in its first layout.
    had_controls: bool,
}

pub(super) struct LaidOut {
    pub output: FullOutput,
    /// Panels that take clicks, in points.
    pub panels: Vec<Rect>,
    pub acts: Acts,
    /// Time until egui needs another layout without input. It is very long if egui needs no layout.
    pub repaint_after: Duration,
}

impl Panels {
    /// Creates an empty layout. The font thread calls `wake` when it has found missing characters in `fonts`.
    pub(super) fn new(fonts: SystemFonts, wake: impl Fn() + Send + 'static) -> Self {
        let context = Context::default();
        style::apply(&context);
        let fallback = Fallback::new(&context, fonts, wake);
        Self { context, fallback, binding: OpenBinding::default(), wants_focus: false, had_controls: false }
    }

    #[cfg(test)]
    pub(super) fn fallback(&self) -> &Fallback {
        &self.fallback
    }

    pub(super) fn forget_focus(&mut self) {
        self.wants_focus = false;
        self.had_controls = false;
    }

    pub(super) fn lay_out(
        &mut self,
        mut input: RawInput,
        content: &OverlayContent<'_>,
        now: Instant,
    ) -> LaidOut {
        if self.had_controls && std::mem::take(&mut self.wants_focus) {
            input.events.extend(pressed(Key::Tab, Modifiers::NONE));
        }
        self.had_controls = content.bar.is_some() || content.is_interactive();
        let (mut panels, mut acts) = (Vec::new(), Acts::default());
        self.fallback.add_found(&self.context);
        let binding = &mut self.binding;
        // egui may request another pass after it has learned sizes.
        let output = self.context.run_pass(input, |context| {
            panels.clear();
            acts = Acts::default();
            let mut pass = Pass { context, acts: &mut acts };
            show(&mut pass, content, now, &mut panels, binding);
        });
        self.fallback.request_missing();
        let root = output.viewport_output.values().next();
        let repaint_after = root.map_or(Duration::MAX, |viewport| viewport.repaint_delay);
        LaidOut { output, panels, acts, repaint_after }
    }
}

pub(super) fn pressed(key: Key, modifiers: Modifiers) -> [Event; 2] {
    let event = |pressed| Event::Key { key, physical_key: None, pressed, repeat: false, modifiers };
    [true, false].map(event)
}

fn show(
    pass: &mut Pass<'_>,
    content: &OverlayContent<'_>,
    now: Instant,
    panels: &mut Vec<Rect>,
    binding: &mut OpenBinding,
) {
    let context = pass.context;
    assisted::window(context);
    let screen = context.viewport_rect();
    let space = screen.shrink(style::MARGIN.min(0.1 * screen.size().min_elem()));
    let back = context.layer_painter(LayerId::new(Order::Background, Id::unique("overlay lines")));
    if content.calm {
        calm::draw(&back, screen, content.bands);
    }
    if let Some(view) = content.ray {
        ray::draw(&back, screen, view);
    }
    let front = context.layer_painter(LayerId::new(Order::Foreground, Id::unique("overlay front")));

    let space = show_bar(pass, space, content, panels);
    if let Some(OpenPanel::Corners(handles)) = content.panel {
        panels.extend(corners::show(pass, screen, handles));
    }
    let mut rooms = Rooms::of(space, screen, content.picture);
    if let Some(next) = content.next {
        let rect = preview::show(context, &rooms, next);
        if rooms.is_desk {
            rooms.below(rect);
        }
    }
    let Rooms { main: space, mut side, is_desk } = rooms;
    if is_desk {
        // Put the sliders below the small frame and the next scene, along their left edge.
        side.set_width(params::width(side.width() + 2.0 * style::MARGIN));
    }
    let mut left = space;
    if let Some(text) = content.corner {
        assisted::text(context, "about the picture", text, false);
        left.max.y = corner(&back, space, text).top() - 0.5 * style::MARGIN;
    }
    let mut beside_sliders = space;
    let help = content.help.map(|keys| help::show(pass, space, keys));
    if let Some(sliders) = content.params.filter(|sliders| !sliders.is_empty()) {
        let shown = params::Shown { sliders, learning: content.learning, snapshots: content.snapshots };
        let rect = params::show(pass, side, help, shown, binding);
        panels.push(rect);
        leave_beside(&mut left, rect);
        beside_sliders = beside(space, rect);
    }
    if let Some(text) = content.editor {
        let parts = editor::show(pass, &rooms, text);
        let right = parts.first().map_or(left.left(), |rect| rect.right() + style::MARGIN);
        panels.extend(parts);
        left.min.x = right.min(left.right());
    }
    let mut sentences = space;
    if let Some(rect) = show_right_list(pass, space, content) {
        panels.push(rect);
        leave_beside(&mut left, rect);
        sentences.max.x = (rect.left() - style::MARGIN).max(space.left() + SENTENCE_WIDTH_MIN);
    }
    if let Some(problem) = &content.problem {
        left.min.y = left.max.y - (PROBLEM_HEIGHT_MAX * screen.height()).min(left.height());
        panels.push(show_problem(context, &back, left, problem));
    }
    panels.extend(help);
    let list = show_list(pass, space, beside_sliders, content);
    panels.extend(list);
    if let Some(words) = content.welcome.as_ref().filter(|words| !words.is_gone(now)) {
        welcome::draw(&back, left, words, now);
    }
    let below = show_sentences(context, &front, sentences, list.is_some(), content, now);
    if let Some(list) = &content.sources {
        panels.push(sources::show(pass, below, list));
    }
    assisted::ring(context, &front);
}

/// Shows the bar and the strip of decks. Returns the space above them.
fn show_bar(
    pass: &mut Pass<'_>,
    mut space: Rect,
    content: &OverlayContent<'_>,
    panels: &mut Vec<Rect>,
) -> Rect {
    let above = |rect: Rect, space: Rect| (rect.top() - 0.5 * style::MARGIN).max(space.top());
    if let Some(bar) = &content.bar {
        let rect = bar::show(pass, space, bar);
        if bar.seen {
            panels.push(rect);
            space.max.y = above(rect, space);
        }
    }
    if let Some(strip) = &content.decks {
        let rect = decks::show(pass, space, strip);
        panels.push(rect);
        space.max.y = above(rect, space);
    }
    space
}

fn show_problem(context: &Context, back: &Painter, space: Rect, problem: &Problem<'_>) -> Rect {
    assisted::text(context, "problem", problem.heading, true);
    assisted::text(context, "problem's text", problem.text, false);
    problem::draw(back, space, problem)
}

/// Shows the track list or the entries of the show at the right, if one of them is open. Returns its area.
fn show_right_list(pass: &mut Pass<'_>, space: Rect, content: &OverlayContent<'_>) -> Option<Rect> {
    if let Some(OpenPanel::Tracks(list)) = content.panel {
        return Some(tracks::show(pass, space, list));
    }
    let sheet = content.cues.as_ref()?;
    Some(cues::show(pass, space, sheet))
}

/// Shows the open list in the middle, and returns its area. The controllers are in `beside_sliders`, because a click on a
/// slider's name learns its control.
fn show_list(
    pass: &mut Pass<'_>,
    space: Rect,
    beside_sliders: Rect,
    content: &OverlayContent<'_>,
) -> Option<Rect> {
    Some(match content.panel? {
        OpenPanel::Scenes(scenes) => browser::show(pass, space, scenes),
        OpenPanel::Files(list) => files::show(pass, space, list),
        OpenPanel::Settings(rows) => settings::show(pass, space, rows),
        OpenPanel::Controllers(rows) => controllers::show(pass, beside_sliders, rows),
        OpenPanel::Video(rows) => video::show(pass, space, rows),
        OpenPanel::Tracks(_) | OpenPanel::Corners(_) => return None,
    })
}

fn show_sentences(
    context: &Context,
    front: &Painter,
    space: Rect,
    has_list: bool,
    content: &OverlayContent<'_>,
    now: Instant,
) -> Rect {
    let mut below = space;
    if has_list {
        // Keep messages away from the heading and the close button of an open list.
        let sentences = u8::from(content.hint.is_some()) + u8::from(content.notice.is_some());
        below.min.y = (space.max.y - f32::from(sentences) * NOTICE_HEIGHT).max(space.min.y);
    }
    if let Some(text) = content.hint {
        assisted::text(context, "hint", text, true);
        below.min.y = draw_sentence(front, below, text, style::ACCENT).bottom() + 0.5 * style::MARGIN;
    }
    if let Some(notice) = &content.notice {
        assisted::text(context, "notice", notice.text, true);
        below.min.y = draw_notice(front, below, notice, now).bottom() + 0.5 * style::MARGIN;
    }
    below
}

/// Height for a message below a panel's heading, in points.
const NOTICE_HEIGHT: f32 = 60.0;

/// The part of `space` to the left of the sliders; all of `space` if this part is too narrow for a list.
fn beside(space: Rect, sliders: Rect) -> Rect {
    let right = sliders.left() - style::MARGIN;
    let is_wide = right - space.left() >= LIST_WIDTH_MIN;
    if is_wide { space.with_max_x(right) } else { space }
}

fn leave_beside(left: &mut Rect, panel: Rect) {
    let beside = panel.left() - style::MARGIN;
    if beside - left.left() >= PROBLEM_WIDTH_MIN {
        left.max.x = beside;
    }
}

fn corner(painter: &Painter, space: Rect, text: &str) -> Rect {
    let galley = style::line(painter, text, style::SMALL_SIZE, style::TEXT, LINE_WIDTH_MAX * space.width());
    let size = galley.size() + vec2(20.0, 8.0);
    let rect = Rect::from_min_size(pos2(space.left(), space.bottom() - size.y), size);
    style::ground(painter, rect);
    painter.galley(rect.center() - 0.5 * galley.size(), galley, style::TEXT);
    rect
}

fn draw_notice(painter: &Painter, space: Rect, notice: &Notice<'_>, now: Instant) -> Rect {
    let mut painter = painter.clone();
    painter.set_opacity(notice.opacity(now));
    let Some(fraction) = notice.fraction else {
        return draw_sentence(&painter, space, notice.text, style::TEXT);
    };
    let room = LINE_WIDTH_MAX * space.width();
    let galley = style::line(&painter, notice.text, style::HEADING_SIZE, style::TEXT, room);
    let width = galley.size().x.max(FRACTION_WIDTH).min(space.width());
    let size = vec2(width + 32.0, galley.size().y + 24.0);
    let rect = Align2::CENTER_TOP.align_size_within_rect(size, space);
    style::ground(&painter, rect);
    painter.galley(pos2(rect.center().x - 0.5 * galley.size().x, rect.top() + 7.0), galley, style::TEXT);
    let rail = Rect::from_min_size(pos2(rect.left() + 16.0, rect.bottom() - 12.0), vec2(width, 4.0));
    style::fraction(&painter, rail, fraction);
    rect
}

fn draw_sentence(painter: &Painter, space: Rect, text: &str, color: egui::Color32) -> Rect {
    let width = LINE_WIDTH_MAX * space.width();
    let galley =
        style::paragraph(painter, text, style::HEADING_SIZE, color, width, SENTENCE_ROWS_MAX, Align::Center);
    let size = galley.size() + vec2(32.0, 14.0);
    let rect = Align2::CENTER_TOP.align_size_within_rect(size, space);
    style::ground(painter, rect);
    // Centred lines extend to both sides of the drawing position.
    painter.galley(rect.center() - galley.rect.center().to_vec2(), galley, color);
    rect
}
