//! Draws the settings panel: a row for each setting, with its values, in groups. While the user turns a setting that
//! changes the image, the panel lets the image through, except for the row that is turned.

use std::time::Duration;

use egui::{Align, Id, Layout, Order, Rect, Response, Sense, Ui, pos2, vec2};

use super::acts::{On, PanelAct, Pass};
use super::chips::{self, Chip};
use super::{assisted, kept, params, style, words};
use crate::clock;
use crate::settings_panel::{SettingsPanel, whole_steps};
use mariana_commands::{Command, Panel};
use mariana_control::{ChangedBy, Slider};
use mariana_settings::{SettingRow, Values};

const WIDTH_MAX: f32 = 640.0;
const ROW: f32 = 26.0;
/// Height of a group's heading.
const HEADING: f32 = 22.0;
/// How long the panel lets the image through after a change.
const LINGERS: Duration = Duration::from_millis(1_200);
/// Opacity of the panel's background, and of the rows that are not turned, while it lets the image through.
const FADED: (f32, f32) = (0.2, 0.35);
/// Maximum width of a row's name: first in points, then as a fraction of the row.
const NAME: (f32, f32) = (170.0, 0.34);
/// The delays that the slider can set, and its default, in milliseconds. Keys can set larger delays.
const RAIL_MS: [f32; 3] = [-500.0, 500.0, 0.0];

/// The state that the last layout has shown.
#[derive(Clone, Copy)]
struct Seen {
    selected: usize,
    /// Height of the panel's list.
    height: f32,
    /// True while the pointer holds a slider.
    held: bool,
}

const MEANING_LINES: usize = 2;

pub(super) fn show(pass: &mut Pass<'_>, space: Rect, settings: &SettingsPanel) -> Rect {
    let Pass { context, acts } = pass;
    let before: Option<Seen> = kept::last(context, Id::unique("seen settings"));
    let gives_way = gives_way(context, settings, before);
    let area = style::area(Id::unique("settings"), Order::Foreground);
    let mut frame = style::frame();
    if gives_way {
        frame.fill = frame.fill.gamma_multiply(FADED.0);
    }
    style::framed(context, area, frame, style::middle(space, WIDTH_MAX), |ui| {
        ui.spacing_mut().item_spacing = vec2(0.0, 0.0);
        ui.scope(|ui| {
            fade(ui, gives_way);
            let hint = "change with the arrows and Enter, or a click · saved automatically";
            if words::heading(ui, ROW, "Settings", hint, false, "close the settings") {
                acts.commands.push(Command::TogglePanel(Panel::Settings));
            }
        });
        let mut ask = |act| acts.on_panels.push(PanelAct::Settings(act));
        let meaning = MEANING_LINES as f32 * 1.3 * style::SMALL_SIZE + 6.0;
        let height = (space.height() - 2.0 * style::PADDING.y - ROW - meaning).max(ROW);
        let pointed = rows(ui, height, gives_way, settings, before, &mut ask);
        let row = settings.rows.get(pointed.unwrap_or(settings.selected));
        fade(ui, gives_way);
        footing(ui, row.map_or("", |row| &row.purpose), meaning);
    })
}

/// True while the user turns a setting, and shortly after.
fn gives_way(context: &egui::Context, settings: &SettingsPanel, seen: Option<Seen>) -> bool {
    let left = settings.turned.and_then(|turned| LINGERS.checked_sub(clock::since(turned)));
    if let Some(left) = left {
        context.request_repaint_after(left);
    }
    left.is_some_and(|left| !left.is_zero()) || seen.is_some_and(|seen| seen.held)
}

fn fade(ui: &mut Ui, gives_way: bool) {
    if gives_way {
        ui.set_opacity(FADED.1);
    }
}

fn draw_group(ui: &mut Ui, words: &str) {
    let (place, _) = ui.allocate_exact_size(vec2(ui.available_width(), HEADING), Sense::hover());
    let galley = style::line(ui.painter(), words, style::SMALL_SIZE, style::DIM, place.width());
    let at = pos2(place.left() + 6.0, place.bottom() - galley.size().y - 2.0);
    ui.painter().galley(at, galley, style::DIM);
    assisted::text(ui.ctx(), words, words, false);
}

/// Draws all rows. Returns the index of the row under the pointer.
fn rows(
    ui: &mut Ui,
    height: f32,
    gives_way: bool,
    settings: &SettingsPanel,
    before: Option<Seen>,
    ask: &mut impl FnMut(On<SettingsPanel>),
) -> Option<usize> {
    let rows = &settings.rows;
    let moved = before.is_some_and(|seen| seen.selected != settings.selected || seen.height != height);
    let mut held = false;
    let pointed = style::scrolled(ui, height, before.is_none(), |ui| {
        let (mut pointed, mut group) = (None, None);
        for (place, row) in rows.iter().enumerate() {
            // A fold is the heading of its group.
            let has_heading =
                group.replace(row.group) != Some(row.group) && !matches!(row.values, Values::Fold { .. });
            let is_selected = place == settings.selected;
            let drawn = ui.push_id(place, |ui| {
                if has_heading {
                    ui.scope(|ui| {
                        fade(ui, gives_way);
                        draw_group(ui, row.group.name());
                    });
                }
                fade(ui, gives_way && !is_selected);
                let ground = ui.painter().add(egui::Shape::Noop);
                let drawn = draw_row(ui, row, place, is_selected, &mut held, ask);
                if gives_way && is_selected {
                    ui.painter().set(ground, style::ground_of(drawn.rect));
                }
                drawn
            });
            if drawn.inner.contains_pointer() {
                pointed = Some(place);
            }
            if is_selected && moved {
                drawn.response.scroll_to_me(None);
            }
        }
        pointed
    });
    let seen = Seen { selected: settings.selected, height, held };
    kept::replace(ui.ctx(), Id::unique("seen settings"), seen);
    pointed
}

fn draw_row(
    ui: &mut Ui,
    row: &SettingRow,
    place: usize,
    is_selected: bool,
    held: &mut bool,
    ask: &mut impl FnMut(On<SettingsPanel>),
) -> Response {
    let width = ui.available_width();
    let pick = |value: usize| -> On<SettingsPanel> {
        Box::new(move |panel| Vec::from_iter(panel.pick(place, value)))
    };
    // Rows that are alternatives to each other are buttons. In all other rows, only the values can be clicked.
    if let Values::OneOfRows { chosen: is_on, .. } | Values::Fold { open: is_on } = row.values {
        let (rect, response) = ui.allocate_exact_size(vec2(width, ROW), Sense::click());
        style::light(ui.painter(), rect, is_selected || response.hovered());
        draw_name(ui, row, rect, is_selected);
        let is_fold = matches!(row.values, Values::Fold { .. });
        let role = if is_fold { egui::Role::Button } else { egui::Role::RadioButton };
        assisted::selected(&response, role, is_on, &row.name);
        if response.clicked() {
            ask(pick(0));
        }
        return response;
    }
    let name = vec2((NAME.1 * width).min(NAME.0), ROW);
    let drawn = words::named_row(
        ui,
        name,
        is_selected,
        |ui, rect| draw_name(ui, row, rect, is_selected),
        |ui| {
            if let Values::Names { options, chosen } = &row.values {
                let chip = |(at, (name, _)): (usize, &(&'static str, _))| {
                    let name_of = format!("{}: {name}", row.name);
                    Chip { role: Some(egui::Role::RadioButton), ..Chip::new(*name, name_of, at == *chosen) }
                };
                return chips::row(ui, "values", options.iter().enumerate().map(chip)).map(pick);
            }
            let (number, settled) = draw_number(ui, row, held)?;
            Some(Box::new(move |panel| Vec::from_iter(panel.change_number(place, number, settled))))
        },
    );
    drawn.inner.into_iter().for_each(ask);
    drawn.response
}

/// Draws the name at the left. Marks a row that is an alternative to other rows, and a value from the command line.
fn draw_name(ui: &Ui, row: &SettingRow, rect: Rect, is_selected: bool) {
    let (painter, width) = (ui.painter(), rect.width() - 12.0);
    let (mark, color) = match (&row.values, is_selected) {
        (Values::OneOfRows { chosen: true, .. }, _) => ("> ", style::ACCENT),
        (Values::OneOfRows { chosen: false, .. }, false) => ("· ", style::TEXT),
        (Values::OneOfRows { chosen: false, .. }, true) => ("· ", style::ACCENT),
        (Values::Fold { open }, _) => (if *open { "- " } else { "+ " }, style::ACCENT),
        (_, true) => ("", style::ACCENT),
        (_, false) => ("", style::TEXT),
    };
    let words = format!("{mark}{}", row.name);
    let left = pos2(rect.left() + 6.0, rect.top() + 0.5 * ROW);
    let end = style::put(painter, left, &words, style::TEXT_SIZE, color, width);
    if row.for_this_run {
        // If there is no room for the words, draw only a dot.
        let room = (left.x + width - end).max(8.0);
        style::put(painter, pos2(end + 6.0, left.y), THIS_RUN, style::SMALL_SIZE, style::DIM, room);
    }
}

const THIS_RUN: &str = "this run";

/// Draws a slider for a number. Returns the value that the user sets, and true once the user releases the slider.
fn draw_number(ui: &mut Ui, row: &SettingRow, is_held: &mut bool) -> Option<(f64, bool)> {
    let (number, words, unit, [min, max, default], step, rounded): (_, _, _, _, _, fn(f64) -> f64) =
        match row.values {
            Values::Delay(0.0) => (0.0, "0 ms".to_owned(), "milliseconds", RAIL_MS, 0.01, whole_steps),
            Values::Delay(shift) => {
                (shift, format!("{shift:+.0} ms"), "milliseconds", RAIL_MS, 0.01, whole_steps)
            }
            Values::Brightness(number) => {
                (number, format!("{number:.0} %"), "percent", [0.0, 100.0, 100.0], 0.05, f64::round)
            }
            _ => return None,
        };
    let (name, value) = (format!("{} in {unit}", row.name), number as f32);
    let mut slider = Slider { name, value, min, max, default, changed_by: ChangedBy::Text, bound: None };
    let response = ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
        let (place, _) = ui.allocate_exact_size(vec2(84.0, params::HOLD_HEIGHT), Sense::hover());
        let right = place.right_center() - vec2(8.0, 0.0);
        style::put_right(ui.painter(), right, &words, style::TEXT_SIZE, style::TEXT, 80.0);
        params::rail(ui, &mut slider, step, true)
    });
    let response = response.inner;
    *is_held |= response.is_pointer_button_down_on();
    let wanted = if slider.value == value { number } else { rounded(slider.value.into()) };
    let is_released = response.drag_stopped() || response.clicked();
    (is_released || wanted != number).then_some((wanted, !response.is_pointer_button_down_on()))
}

fn footing(ui: &mut Ui, words: &str, height: f32) {
    let (place, _) = ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::hover());
    let (painter, width) = (ui.painter(), place.width());
    let galley =
        style::paragraph(painter, words, style::SMALL_SIZE, style::DIM, width, MEANING_LINES, Align::LEFT);
    painter.galley(pos2(place.left() + 6.0, place.top() + 6.0), galley, style::DIM);
}
