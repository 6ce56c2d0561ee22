//! Draws the settings panel: a row for each setting, with its values, in groups. While the user turns a setting that
//! changes the image, the panel lets the image through, except for the row that is turned.

use std::time::Duration;

use egui::{Id, Order, Rect, Response, Sense, Ui, WidgetInfo, pos2, vec2};

use super::acts::{On, PanelAct, Pass};
use super::{assisted, params, style, words};
use crate::clock;
use crate::settings_panel::{SettingsPanel, whole_steps};
use mariana_commands::{Command, Panel};
use mariana_settings::{Setting, SettingRow, Values};

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
/// Largest delay that the slider can set, in milliseconds in each direction. Keys can set larger delays.
const RAIL_MS: f64 = 500.0;
pub(super) struct Seen {
    selected: usize,
    /// Height of the panel's list.
    height: f32,
    /// True while the pointer holds a slider.
    held: bool,
}

const MEANING_LINES: usize = 2;

pub(super) fn show(
    pass: &mut Pass<'_>,
    space: Rect,
    settings: &SettingsPanel,
    last_seen: &mut Option<Seen>,
) -> Rect {
    let Pass { context, acts } = pass;
    let gives_way = gives_way(context, settings, last_seen.as_ref());
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
            if words::heading(ui, ROW, "Settings", hint, "", "close the settings") {
                acts.commands.push(Command::TogglePanel(Panel::Settings));
            }
        });
        let mut ask = |act| acts.on_panels.push(PanelAct::Settings(act));
        let meaning = MEANING_LINES as f32 * 1.3 * style::SMALL_SIZE + 6.0;
        let height = (space.height() - 2.0 * style::PADDING.y - ROW - meaning).max(ROW);
        let pointed = rows(ui, height, gives_way, settings, last_seen, &mut ask);
        let row = settings.rows.get(pointed.unwrap_or(settings.selected));
        fade(ui, gives_way);
        footing(ui, row.map_or("", |row| &row.purpose), meaning);
    })
}

/// True while the user turns a setting, and shortly after.
fn gives_way(context: &egui::Context, settings: &SettingsPanel, seen: Option<&Seen>) -> bool {
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

/// Height of the heading above a row: 0 if the row before is in the same group.
fn heading_above(rows: &[SettingRow], place: usize) -> f32 {
    let group_of = |row: &SettingRow| row.group;
    let before = place.checked_sub(1).and_then(|before| rows.get(before)).map(group_of);
    let begins = rows.get(place).is_some_and(|row| {
        // The fold is the heading of its group.
        before != Some(row.group) && !matches!(row.values, Values::Fold { .. })
    });
    if begins { HEADING } else { 0.0 }
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
    last_seen: &mut Option<Seen>,
    ask: &mut impl FnMut(On<SettingsPanel>),
) -> Option<usize> {
    let rows = &settings.rows;
    let before = last_seen.as_ref();
    let moved = before.is_some_and(|seen| seen.selected != settings.selected || seen.height != height);
    let mut held = false;
    let pointed = style::scrolled(ui, height, before.is_none(), |ui| {
        let mut pointed = None;
        for (place, row) in rows.iter().enumerate() {
            let is_selected = place == settings.selected;
            let drawn = ui.push_id(place, |ui| {
                if heading_above(rows, place) > 0.0 {
                    ui.scope(|ui| {
                        fade(ui, gives_way);
                        draw_group(ui, row.group.name());
                    });
                }
                fade(ui, gives_way && !is_selected);
                if gives_way && is_selected {
                    let size =
                        vec2(ui.available_width(), ROW * lines_of(ui, row, ui.available_width()) as f32);
                    style::ground(ui.painter(), Rect::from_min_size(ui.cursor().min, size));
                }
                draw_row(ui, row, place, is_selected, &mut held, ask)
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
    *last_seen = Some(Seen { selected: settings.selected, height, held });
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
    let start = start_of_values(width);
    let height = ROW * lines_of(ui, row, width) as f32;
    // Rows that are alternatives to each other are buttons. In all other rows, only the values can be clicked.
    let is_button = matches!(row.values, Values::OneOfRows { .. } | Values::Fold { .. });
    let sense = if is_button { Sense::click() } else { Sense::hover() };
    let (rect, response) = ui.allocate_exact_size(vec2(width, height), sense);
    style::light(ui.painter(), rect, is_selected || response.hovered() && is_button);
    let values = Rect::from_min_max(pos2(rect.left() + start, rect.top()), rect.max);
    let pick = |value: usize| -> On<SettingsPanel> {
        Box::new(move |panel| Vec::from_iter(panel.pick(place, value)))
    };
    let name_width = if is_button { width } else { start } - 12.0;
    draw_name(ui, row, rect, name_width, is_selected);
    match &row.values {
        Values::OneOfRows { chosen, .. } => {
            response.widget_info(|| WidgetInfo::selected(egui::Role::RadioButton, true, *chosen, &row.name));
            if response.clicked() {
                ask(pick(0));
            }
        }
        Values::Fold { open } => {
            response.widget_info(|| WidgetInfo::selected(egui::Role::Button, true, *open, &row.name));
            if response.clicked() {
                ask(pick(0));
            }
        }
        Values::Names { options, chosen } => {
            if let Some(value) = draw_names(ui, values, row, options, *chosen) {
                ask(pick(value));
            }
        }
        Values::Delay(number) | Values::Brightness(number) => {
            let scale = if matches!(row.values, Values::Delay(_)) { &SHIFT } else { &PERCENT };
            if let Some((number, settled)) = draw_number(ui, values, &row.name, *number, scale, held) {
                ask(Box::new(move |panel| Vec::from_iter(panel.change_number(place, number, settled))));
            }
        }
    }
    response
}

/// Draws the name at the left. Marks a row that is an alternative to other rows, and a value from the command line.
fn draw_name(ui: &Ui, row: &SettingRow, rect: Rect, width: f32, is_selected: bool) {
    let painter = ui.painter();
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

fn name_width(ui: &Ui, name: &str) -> f32 {
    style::line(ui.painter(), name, style::TEXT_SIZE, style::TEXT, f32::MAX).size().x + 18.0
}

fn start_of_values(width: f32) -> f32 {
    (NAME.1 * width).min(NAME.0)
}

fn lines_of(ui: &Ui, row: &SettingRow, width: f32) -> usize {
    let Values::Names { options, .. } = &row.values else { return 1 };
    let width = width - start_of_values(width);
    let mut lines = 1;
    let mut left = 0.0;
    for (name, _) in options {
        let next = name_width(ui, name);
        if left > 0.0 && left + next > width {
            (lines, left) = (lines + 1, 0.0);
        }
        left += next;
    }
    lines
}

/// Draws values side by side, in as many lines as needed. Returns the index of the clicked value.
fn draw_names(
    ui: &Ui,
    rect: Rect,
    row: &SettingRow,
    options: &[(&str, Setting)],
    chosen: usize,
) -> Option<usize> {
    let mut clicked = None;
    let mut at = rect.min;
    for (place, (name, _)) in options.iter().enumerate() {
        let width = name_width(ui, name);
        if at.x > rect.left() && at.x + width > rect.right() + 0.5 {
            at = pos2(rect.left(), at.y + ROW);
        }
        let ground = Rect::from_min_size(at, vec2(width, ROW)).shrink2(vec2(2.0, 3.0));
        at.x += width;
        let response = ui.interact(ground, ui.scope_id().with(("value", place)), Sense::click());
        let painter = ui.painter();
        let color = style::value_ground(painter, ground, place == chosen, response.hovered());
        let galley = style::line(painter, name, style::TEXT_SIZE, color, width);
        painter.galley_with_override_text_color(ground.center() - 0.5 * galley.size(), galley, color);
        assisted::selected(
            &response,
            egui::Role::RadioButton,
            place == chosen,
            format_args!("{}: {name}", row.name),
        );
        if response.clicked() {
            clicked = Some(place);
        }
    }
    clicked
}

struct Scale {
    from: f64,
    to: f64,
    /// The value that a double click sets.
    usual: f64,
    words: fn(f64) -> String,
    rounded: fn(f64) -> f64,
    unit: &'static str,
    step: f64,
}

const SHIFT: Scale = Scale {
    from: -RAIL_MS,
    to: RAIL_MS,
    usual: 0.0,
    words: |shift| if shift == 0.0 { "0 ms".to_owned() } else { format!("{shift:+.0} ms") },
    rounded: whole_steps,
    unit: "milliseconds",
    step: 10.0,
};

const PERCENT: Scale = Scale {
    from: 0.0,
    to: 100.0,
    usual: 100.0,
    words: |percent| format!("{percent:.0} %"),
    rounded: f64::round,
    unit: "percent",
    step: 5.0,
};

/// Draws a slider for a number. Returns the value that the user sets, and true once the user releases the slider.
fn draw_number(
    ui: &Ui,
    rect: Rect,
    name: &str,
    shift: f64,
    scale: &Scale,
    is_held: &mut bool,
) -> Option<(f64, bool)> {
    let painter = ui.painter();
    let words = (scale.words)(shift);
    let number = style::line(painter, &words, style::TEXT_SIZE, style::TEXT, 80.0);
    let place = pos2(rect.right() - 8.0 - number.size().x, rect.center().y - 0.5 * number.size().y);
    painter.galley(place, number, style::TEXT);
    let hold =
        Rect::from_min_max(rect.min, pos2((rect.right() - 84.0).max(rect.left() + 1.0), rect.bottom()));
    let rail =
        Rect::from_center_size(hold.center(), vec2((hold.width() - 18.0).max(1.0), params::RAIL_HEIGHT));
    let x_of = |shift: f64| {
        let fraction = ((shift - scale.from) / (scale.to - scale.from)).clamp(0.0, 1.0);
        rail.left() + fraction as f32 * rail.width()
    };
    let response = ui.interact(hold, ui.scope_id().with("number"), Sense::click_and_drag());
    *is_held |= response.is_pointer_button_down_on();
    let held = response.hovered() || response.is_pointer_button_down_on();
    let base = if scale.from < 0.0 { 0.0 } else { scale.from };
    params::draw_rail(painter, rail, x_of(base), x_of(base), x_of(shift), held);
    let name = format!("{name} in {}", scale.unit);
    if let Some(wanted) = assisted::rail(ui, &response, &name, shift, scale.from..=scale.to, scale.step) {
        return Some(((scale.rounded)(wanted), true));
    }
    if response.double_clicked() {
        return Some((scale.usual, true));
    }
    let settled = response.drag_stopped() || response.clicked();
    let pointer =
        response.interact_pointer_pos().filter(|_| settled || response.is_pointer_button_down_on())?;
    let fraction = f64::from((pointer.x - rail.left()) / rail.width()).clamp(0.0, 1.0);
    let wanted = (scale.rounded)(scale.from + fraction * (scale.to - scale.from));
    (settled || wanted != shift).then_some((wanted, settled))
}

fn footing(ui: &mut Ui, words: &str, height: f32) {
    let (place, _) = ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::hover());
    let galley =
        style::paragraph(ui.painter(), words, style::SMALL_SIZE, style::DIM, place.width(), MEANING_LINES);
    ui.painter().galley(pos2(place.left() + 6.0, place.top() + 6.0), galley, style::DIM);
}
