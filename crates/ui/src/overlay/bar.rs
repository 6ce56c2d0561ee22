//! The player bar, shown while the pointer moves: the track, a seek bar, and a button for every frequent action.
//! Descriptions and keys in tooltips come from the table of commands.

use std::hash::{Hash, Hasher};
use std::sync::Arc;

use egui::{
    Align, Color32, Galley, Id, Layout, Order, Painter, Rect, Response, Sense, Ui, Vec2, WidgetInfo, pos2,
    vec2,
};
use mariana_music::SongStructure;
use mariana_player::LoudnessShape;
use mariana_player::track::Repeat;

use super::acts::{Acts, Pass};
use super::icons::{self, Icon};
use super::now_playing::{NowPlaying, clock_time};
use super::picture::{Cover, draw_cover};
use super::switches::PanelSwitches;
use super::{assisted, marks, style};
use mariana_commands::{Command, Panel, SEEK_SECONDS, Switch, VOLUME_STEP};
use mariana_render::reading_order::isolated;

const WIDTH_MAX: f32 = 1100.0;
/// Height of the seek bar's clickable area.
const RAIL_HEIGHT: f32 = 26.0;
/// Height of the volume slider, and of a seek bar without a loudness curve.
const LINE_HEIGHT: f32 = 4.0;
const BUTTON: f32 = 30.0;
const LEVEL: Vec2 = vec2(18.0, 2.0);
const WORDS: f32 = 19.0;
const GAP: f32 = 3.0;
const COVER_GAP: f32 = 7.0;
const SIGN: f32 = 15.0;
const BAR_STEP: f32 = 3.0;
/// Minimum and maximum width of the volume slider.
const VOLUME_WIDTH: (f32, f32) = (38.0, 84.0);
const TIMES_GAP: f32 = 6.0;
/// Height of the line that shows the song's sections. The next constant is the size of the sections' letters.
const SECTION_HEIGHT: f32 = 3.0;
const LETTER_SIZE: f32 = 9.5;
/// Colours of sections, in order of their letters' first appearance.
const SECTION_COLORS: [Color32; 8] = [
    Color32::from_rgb(112, 178, 230),
    Color32::from_rgb(240, 170, 110),
    Color32::from_rgb(120, 214, 160),
    Color32::from_rgb(206, 150, 226),
    Color32::from_rgb(236, 212, 110),
    Color32::from_rgb(236, 128, 128),
    Color32::from_rgb(110, 208, 200),
    Color32::from_rgb(170, 176, 190),
];
const BUTTON_GAP: f32 = 2.0;

/// The content of the bar.
#[derive(Debug, Clone, Copy)]
pub struct Bar<'a> {
    /// The playing track or input.
    pub now: &'a NowPlaying,
    /// The cover of the track, if it has one.
    pub cover: Option<Cover<'a>>,
    /// The loudness curve of the track, up to the analysed position.
    pub shape: Option<&'a LoudnessShape>,
    /// The structure of the song, once it is known.
    pub song: Option<&'a SongStructure>,
    /// The ends of the marked part of the track, in seconds.
    pub marks: Option<[f64; 2]>,
    /// The present level, 0..1.
    pub level: f32,
    /// The shown scene, such as "speakers, 12 of 17".
    pub scene: &'a str,
    /// The panels that are open: their buttons are lit.
    pub panels: PanelSwitches,
    /// True in full screen.
    pub fullscreen: bool,
    /// True if a show controls the scenes.
    pub follows: bool,
    /// True if there are two decks.
    pub decks: bool,
    /// False if the bar exists for screen readers only.
    pub seen: bool,
}

/// The level 0..1 has this many steps. The bar is laid out again when the level reaches another step.
const LEVEL_STEPS: f32 = 24.0;

impl Hash for Bar<'_> {
    fn hash<H: Hasher>(&self, state: &mut H) {
        let lit = (self.panels, self.fullscreen, self.follows, self.decks);
        (self.now, self.cover, self.scene, lit, self.seen).hash(state);
        self.shape.map(|shape| shape.levels.len()).hash(state);
        self.song.map(|song| song.sections.len()).hash(state);
        self.marks.map(|marks| marks.map(f64::to_bits)).hash(state);
        ((self.level * LEVEL_STEPS) as u32).hash(state);
    }
}

/// Draws the bar at the bottom of `space`. Returns the bar's area.
pub(super) fn show(pass: &mut Pass<'_>, space: Rect, bar: &Bar<'_>) -> Rect {
    let Pass { context, acts } = pass;
    style::strip(context, Id::unique("bar"), space, WIDTH_MAX, bar.seen, |ui| {
        ui.spacing_mut().item_spacing = vec2(BUTTON_GAP, GAP);
        match bar.cover {
            Some(cover) => {
                ui.horizontal(|ui| {
                    let side = WORDS + GAP + RAIL_HEIGHT;
                    let (square, _) = ui.allocate_exact_size(Vec2::splat(side), Sense::hover());
                    draw_cover(ui.painter(), square, cover);
                    ui.add_space(COVER_GAP);
                    ui.vertical(|ui| {
                        words(ui, bar);
                        seek_rail(ui, bar, acts);
                    });
                });
            }
            None => {
                words(ui, bar);
                seek_rail(ui, bar, acts);
            }
        }
        buttons(ui, bar, acts);
    })
}

fn words(ui: &mut Ui, bar: &Bar<'_>) {
    let full = ui.available_width();
    let (line, _) = ui.allocate_exact_size(vec2(full, WORDS), Sense::hover());
    let painter = ui.painter();
    let (right, size) = (line.right_center(), style::SMALL_SIZE);
    let end = style::put_right(painter, right, bar.scene, size, style::DIM, 0.4 * full) - 16.0;
    assisted::text(ui.ctx(), "scene", bar.scene, false);
    let mut text = isolated(&bar.now.title).into_owned();
    if let Some(artist) = &bar.now.artist {
        text = format!("{text} · {}", isolated(artist));
    }
    if bar.now.place.1 > 1 && !bar.now.live {
        text = format!("{text} · {} of {}", bar.now.place.0 + 1, bar.now.place.1);
    }
    assisted::text(ui.ctx(), "track", &text, false);
    style::put(painter, line.left_center(), &text, style::TEXT_SIZE, style::TEXT, end - line.left());
}

fn seek_rail(ui: &mut Ui, bar: &Bar<'_>, acts: &mut Acts) {
    let full = ui.available_width();
    let (place, response) = ui.allocate_exact_size(vec2(full, RAIL_HEIGHT), Sense::click_and_drag());
    let rail = Rect::from_center_size(place.center(), vec2(full, LINE_HEIGHT));
    let painter = ui.painter().clone();
    let Some((duration, fraction)) = bar.now.duration.zip(bar.now.fraction()).filter(|_| !bar.now.live)
    else {
        style::fraction(&painter, rail, if bar.now.live { bar.level.clamp(0.0, 1.0) } else { 0.0 });
        return;
    };
    let fraction_at = |x: f32| ((x - rail.left()) / rail.width().max(1.0)).clamp(0.0, 1.0);
    let pointed =
        response.interact_pointer_pos().or_else(|| response.hover_pos()).map(|at| fraction_at(at.x));
    let held = response.dragged() || response.is_pointer_button_down_on();
    let shown = pointed.filter(|_| held).unwrap_or(fraction);
    match bar.shape {
        Some(shape) => draw_shape(&painter, place, shape, shown),
        None => style::fraction(&painter, rail, shown),
    }
    if let Some(song) = bar.song {
        draw_sections(&painter, place, song, duration);
    }
    let knob = pos2(rail.left() + shown * rail.width(), rail.center().y);
    painter.circle_filled(knob, if response.hovered() || held { 7.0 } else { 5.0 }, style::ACCENT);
    let (name, position) = ("position in the track in seconds", bar.now.position);
    if let Some(wanted) = assisted::rail(ui, &response, name, position, 0.0..=duration, SEEK_SECONDS) {
        acts.commands.push(Command::SeekTo(wanted));
    }
    marks::show(ui, place, bar, duration, acts);
    let Some(pointed) = pointed else { return };
    let seconds = f64::from(pointed) * duration;
    if response.clicked() || response.drag_stopped() {
        acts.commands.push(Command::SeekTo(seconds));
    }
    let front = ui.ctx().layer_painter(egui::LayerId::new(Order::Tooltip, Id::unique("hover time")));
    let galley = style::line(&front, &clock_time(seconds), style::SMALL_SIZE, style::TEXT, 200.0);
    let size = galley.size() + vec2(12.0, 6.0);
    let x =
        (rail.left() + pointed * rail.width()).clamp(rail.left() + 0.5 * size.x, rail.right() - 0.5 * size.x);
    let label = Rect::from_center_size(pos2(x, place.top() - 0.5 * size.y - 2.0), size);
    style::ground(&front, label);
    front.galley(label.center() - 0.5 * galley.size(), galley, style::TEXT);
}

/// Draws the loudness curve around the middle of `place`. The part up to `fraction` is drawn as played. Where the
/// loudness is unknown, draws a thin line.
fn draw_shape(painter: &Painter, place: Rect, shape: &LoudnessShape, fraction: f32) {
    let bars = (place.width() / BAR_STEP).floor().max(1.0) as usize;
    for bar in 0..bars {
        let (from, to) =
            (bar * shape.parts / bars, ((bar + 1) * shape.parts / bars).max(bar * shape.parts / bars + 1));
        let known = shape.levels.get(from..to.min(shape.levels.len())).unwrap_or_default();
        let level = known.iter().copied().fold(0.0, f32::max).clamp(0.0, 1.0);
        let left = place.left() + bar as f32 * place.width() / bars as f32;
        let height = 2.0 + level * (place.height() - 6.0);
        let middle = pos2(left + 0.5 * BAR_STEP, place.center().y);
        let passed = (bar as f32 + 0.5) / bars as f32 <= fraction;
        let color = if passed { style::ACCENT } else { style::AHEAD };
        painter.rect_filled(Rect::from_center_size(middle, vec2(BAR_STEP - 1.0, height)), 1.0, color);
    }
}

/// Draws a coloured line with a letter for each section at the bottom of `place`, and a mark for each drop at the top.
fn draw_sections(painter: &Painter, place: Rect, song: &SongStructure, duration: f64) {
    let x = |time: f64| place.left() + (time / duration).clamp(0.0, 1.0) as f32 * place.width();
    let mut letters: Vec<&str> = Vec::new();
    for section in &song.sections {
        let number = letters.iter().position(|letter| *letter == section.letter).unwrap_or(letters.len());
        if number == letters.len() {
            letters.push(&section.letter);
        }
        let color = SECTION_COLORS[number % SECTION_COLORS.len()];
        let (left, right) = (x(section.start), x(section.end) - 1.0);
        let line =
            Rect::from_min_max(pos2(left, place.bottom() - SECTION_HEIGHT), pos2(right, place.bottom()));
        painter.rect_filled(line, 1.0, color);
        let letter = style::line(painter, &section.letter, LETTER_SIZE, color, f32::MAX);
        if letter.size().x + 4.0 < right - left {
            let at = pos2(left + 2.0, line.top() - letter.size().y + 1.0);
            painter.galley(at, letter, color);
        }
    }
    for drop in &song.drops {
        let mark = Rect::from_min_size(pos2(x(*drop) - 1.0, place.top()), vec2(2.0, SECTION_HEIGHT + 2.0));
        painter.rect_filled(mark, 0.0, style::TEXT);
    }
}

/// A control of the bar's lowest row.
enum Control {
    Button(Icon, Box<Command>, Lamp),
    Volume,
    Times(Arc<Galley>),
}

impl Control {
    /// The least width in points, with the gap to the next control.
    fn width(&self) -> f32 {
        let width = match self {
            Self::Button(..) => BUTTON,
            Self::Volume => VOLUME_WIDTH.0,
            Self::Times(text) => text.size().x + TIMES_GAP,
        };
        width + BUTTON_GAP
    }

    /// Draws the control. The volume slider takes the `spare` width.
    fn show(self, ui: &mut Ui, bar: &Bar<'_>, spare: f32, acts: &mut Acts) {
        match self {
            Self::Button(icon, command, lamp) => {
                let response = button(ui, icon, &words_of(&command), lamp);
                if response.clicked() {
                    acts.commands.push(*command);
                }
                match icon {
                    Icon::SOURCE => {
                        let bottom = response.rect.center_bottom() - vec2(0.0, LEVEL.y);
                        let level = bar.level.clamp(0.0, 1.0);
                        style::fraction(ui.painter(), Rect::from_center_size(bottom, LEVEL), level);
                    }
                    Icon::REPEAT | Icon::REPEAT_ONE => {
                        let holds = match bar.now.repeat {
                            Repeat::Off => "repeat is off",
                            Repeat::All => "repeats all tracks",
                            Repeat::One => "repeats this track",
                        };
                        assisted::describe(ui.ctx(), response.id, holds);
                    }
                    _ => {}
                }
            }
            Self::Volume => volume(ui, bar.now, (VOLUME_WIDTH.0 + spare).min(VOLUME_WIDTH.1), acts),
            Self::Times(text) => {
                let size = vec2(text.size().x + TIMES_GAP, BUTTON);
                let (place, _) = ui.allocate_exact_size(size, Sense::hover());
                let at = place.right_center() - vec2(text.size().x, 0.5 * text.size().y);
                ui.painter().galley(at, text, style::DIM);
            }
        }
    }
}

/// The controls of the lowest row, from its left edge and from its right edge. Each control has a rank. A narrow bar
/// leaves out the controls with the highest ranks, but screen readers find all of a bar that is not seen.
fn controls(bar: &Bar<'_>, painter: &Painter) -> [Vec<(u8, Control)>; 2] {
    let now = bar.now;
    let button = |icon, command, lamp| Control::Button(icon, Box::new(command), lamp);
    let panel =
        |icon, panel| button(icon, Command::TogglePanel(panel), Lamp::Seen(bar.panels.open == Some(panel)));
    let pause = if now.paused { Icon::PLAY } else { Icon::PAUSE };
    let sound = if now.muted { Icon::MUTED } else { Icon::VOLUME };
    let repeat = if now.repeat == Repeat::One { Icon::REPEAT_ONE } else { Icon::REPEAT };
    let times = style::line(painter, &now.times(), style::SMALL_SIZE, style::DIM, f32::MAX);
    let mut left = vec![
        (10, button(Icon::PREVIOUS, Command::PreviousTrack, Lamp::None)),
        (0, button(pause, Command::Pause(Switch::Toggle), Lamp::Hidden(now.paused))),
        (3, button(Icon::NEXT, Command::NextTrack, Lamp::None)),
        (15, button(Icon::SHUFFLE, Command::Shuffle(Switch::Toggle), Lamp::Seen(now.shuffled))),
        (16, button(repeat, Command::NextRepeat, Lamp::Seen(now.repeat != Repeat::Off))),
        (8, button(sound, Command::Mute(Switch::Toggle), Lamp::Hidden(now.muted))),
        (9, Control::Volume),
        (4, Control::Times(times)),
    ];
    let mut right = vec![
        (2, button(Icon::FULLSCREEN, Command::Fullscreen(Switch::Toggle), Lamp::Hidden(bar.fullscreen))),
        (1, button(Icon::KEYS, Command::ToggleHelp, Lamp::Seen(bar.panels.help))),
        (6, panel(Icon::SETTINGS, Panel::Settings)),
        (13, button(Icon::SLIDERS, Command::ToggleSliders, Lamp::Seen(bar.panels.sliders))),
        (12, panel(Icon::TEXT, Panel::Editor)),
        (5, panel(Icon::SCENES, Panel::Scenes)),
        (19, button(Icon::DECKS, Command::Decks(Switch::Toggle), Lamp::Seen(bar.decks))),
        (18, button(Icon::SHOW, Command::Follow(Switch::Toggle), Lamp::Seen(bar.follows))),
        (14, panel(Icon::SOURCE, Panel::Sources)),
        (7, panel(Icon::TRACKS, Panel::Tracks)),
        (11, panel(Icon::FOLDER, Panel::Files)),
        (17, panel(Icon::VIDEO, Panel::Video)),
    ];
    if now.live {
        left.retain(|(_, control)| matches!(control, Control::Button(Icon::PAUSE | Icon::PLAY, ..)));
        right.retain(|(_, control)| !matches!(control, Control::Button(Icon::TRACKS, ..)));
    }
    [left, right]
}

fn buttons(ui: &mut Ui, bar: &Bar<'_>, acts: &mut Acts) {
    let mut groups = controls(bar, ui.painter());
    let spare = loop {
        let width: f32 = groups.iter().flatten().map(|(_, control)| control.width()).sum();
        let spare = ui.available_width() - width;
        match groups.iter().flatten().map(|(rank, _)| *rank).max() {
            Some(last) if spare < 0.0 && bar.seen => {
                groups.iter_mut().for_each(|group| group.retain(|(rank, _)| *rank != last))
            }
            _ => break spare.max(0.0),
        }
    };
    let [left, right] = groups;
    ui.horizontal(|ui| {
        left.into_iter().for_each(|(_, control)| control.show(ui, bar, spare, acts));
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            right.into_iter().for_each(|(_, control)| control.show(ui, bar, spare, acts));
        });
    });
}

pub(super) fn words_of(command: &Command) -> String {
    match (command, command.binding()) {
        (_, Some(binding)) => format!("{} ({})", binding.help, binding.written),
        (Command::TogglePanel(Panel::Sources), None) => {
            let key = Command::NextSource.binding().map_or("", |binding| binding.written);
            format!("choose a sound source ({key} for the next source)")
        }
        (_, None) => String::new(),
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Lamp {
    None,
    /// A switch whose colour shows its state. Screen readers get the state too.
    Seen(bool),
    /// A switch whose icon shows its state. Screen readers get the state too.
    Hidden(bool),
}

/// A button with an icon. `words` are its tooltip and accessible name.
pub(super) fn button(ui: &mut Ui, icon: Icon, words: &str, lamp: Lamp) -> Response {
    let (place, response) = ui.allocate_exact_size(vec2(BUTTON, BUTTON), Sense::click());
    let color = style::lit(lamp == Lamp::Seen(true), response.hovered(), style::BUTTON);
    if response.hovered() {
        ui.painter().rect_filled(place.shrink(1.0), 5.0, style::RAIL);
    }
    icons::draw(ui.painter(), icon, place, SIGN, color);
    response.widget_info(|| match lamp {
        Lamp::None => WidgetInfo::labeled(egui::Role::Button, true, words),
        Lamp::Seen(on) | Lamp::Hidden(on) => WidgetInfo::selected(egui::Role::Button, true, on, words),
    });
    response.on_hover_text(words)
}

fn volume(ui: &mut Ui, now: &NowPlaying, width: f32, acts: &mut Acts) {
    let (place, response) = ui.allocate_exact_size(vec2(width, BUTTON), Sense::click_and_drag());
    let rail = Rect::from_center_size(place.center(), vec2(width - 14.0, LINE_HEIGHT));
    let volume = if now.muted { 0.0 } else { now.volume };
    let mut shown = volume;
    if let Some(at) = response.interact_pointer_pos().filter(|_| response.is_pointer_button_down_on()) {
        shown = ((at.x - rail.left()) / rail.width()).clamp(0.0, 1.0);
        if shown.to_bits() != now.volume.to_bits() || now.muted {
            acts.commands.push(Command::Volume(shown));
        }
    }
    style::fraction(ui.painter(), rail, shown);
    let knob = pos2(rail.left() + shown * rail.width(), rail.center().y);
    ui.painter().circle_filled(knob, if response.hovered() { 6.0 } else { 5.0 }, style::ACCENT);
    let (percent, step) = (100.0 * f64::from(volume), 100.0 * f64::from(VOLUME_STEP));
    if let Some(wanted) = assisted::rail(ui, &response, "volume in percent", percent, 0.0..=100.0, step) {
        acts.commands.push(Command::Volume(wanted as f32 / 100.0));
    }
    response.on_hover_text(format!("volume {:.0} %", 100.0 * shown));
}
