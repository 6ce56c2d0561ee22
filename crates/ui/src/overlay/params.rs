//! The sliders of the scene's parameters. egui's sliders would take the keyboard focus from the show.

use egui::{Align2, Id, Order, Painter, Rect, Response, Sense, Ui, WidgetInfo, pos2, vec2};

use super::acts::{Acts, Pass};
use super::binding::{self, OpenBinding};
use super::content::SnapshotRow;
use super::{assisted, snapshots, style};
use mariana_commands::Command;
use mariana_control::Slider;

/// Width of the panel in points, if the window is wide enough.
const WIDTH: f32 = 260.0;
const RAIL_HEIGHT: f32 = 3.0;
const KNOB_RADIUS: f32 = 5.5;
/// Height of a slider's clickable area, in points. It is larger than the drawn slider.
pub(super) const HOLD_HEIGHT: f32 = 18.0;
const RESET_SIZE: f32 = 16.0;
/// The usual step of a slider for keys and screen readers, as a fraction of the range.
pub(super) const STEP: f64 = 0.05;

/// The scene's sliders, the parameter for which a control is being learned, and the snapshots.
pub(super) struct Shown<'a> {
    pub sliders: &'a [Slider],
    pub learning: Option<&'a str>,
    pub snapshots: SnapshotRow,
}

pub(super) fn width(window: f32) -> f32 {
    WIDTH.min(window - 2.0 * style::MARGIN).max(0.0)
}

/// Draws the panel at the upper right. Returns the panel's area. Ignores clicks while the area `cover` overlaps the panel.
pub(super) fn show(
    pass: &mut Pass<'_>,
    space: Rect,
    cover: Option<Rect>,
    Shown { sliders, learning, snapshots }: Shown<'_>,
    open: &mut OpenBinding,
) -> Rect {
    let Pass { context, acts } = pass;
    let place = style::right_part(space, width(space.width() + 2.0 * style::MARGIN));
    let id = Id::unique("overlay parameters");
    if context.memory(|memory| memory.area_rect(id)).is_none() {
        // Discard egui's first pass, because it only finds the size.
        context.request_discard("the size of the parameters' panel");
    }
    let area =
        style::area(id, Order::Middle).interactable(cover.is_none_or(|cover| cover.right() <= place.left()));
    style::framed(context, area, style::frame(), place, |ui| {
        let height = (space.height() - 2.0 * style::PADDING.y).max(0.0);
        egui::ScrollArea::vertical().max_height(height).show(ui, |ui| {
            ui.set_width((ui.available_width() - style::LANE).max(0.0));
            for (place, slider) in sliders.iter().enumerate() {
                let is_learning = learning == Some(&*slider.name);
                ui.push_id(place, |ui| {
                    let value = row(ui, slider.clone(), is_learning, open, acts);
                    if value.to_bits() != slider.value.to_bits() {
                        acts.commands.push(Command::MoveSlider((place, value)));
                    }
                    if open.is_of(&slider.name) {
                        binding::show(ui, slider, open, acts);
                    }
                });
            }
            snapshots::show(ui, snapshots, acts);
        });
    })
}

/// Draws a parameter's name, value and slider. Returns the value after the user's changes. After a click on the name, the
/// next moved control is mapped to the parameter.
fn row(ui: &mut Ui, mut slider: Slider, is_learning: bool, open: &mut OpenBinding, acts: &mut Acts) -> f32 {
    slider.value = slider.param().clamped(slider.value);
    let full = ui.available_width();

    let (line, _) = ui.allocate_exact_size(vec2(full, HOLD_HEIGHT), Sense::hover());
    let painter = ui.painter();
    let changed_by_user = slider.value != slider.default;
    let reset = Rect::from_center_size(
        pos2(line.right() - 0.5 * RESET_SIZE, line.center().y),
        vec2(RESET_SIZE, RESET_SIZE),
    );
    let wave = reset.translate(vec2(-RESET_SIZE - 4.0, 0.0));
    let (right, font) = (pos2(wave.left() - 6.0, line.center().y), style::monospace(style::SMALL_SIZE));
    let value = painter.text(right, Align2::RIGHT_CENTER, slider.value_text(), font, style::TEXT);
    let room = value.left() - line.left() - 8.0;
    let name = style::line(painter, &slider.name, style::TEXT_SIZE, style::TEXT, room);
    let size = name.size();
    let label = ui.interact(
        Rect::from_min_size(pos2(line.left(), line.center().y - 0.5 * size.y), size),
        ui.scope_id().with("name"),
        Sense::click(),
    );
    let color = if is_learning || label.hovered() { style::ACCENT } else { style::TEXT };
    painter.galley_with_override_text_color(label.rect.min, name, color);
    let bound = binding::words(&slider);
    let words = if is_learning {
        "move a knob"
    } else {
        bound.as_deref().unwrap_or_else(|| slider.changed_by_words())
    };
    let words = style::line(painter, words, style::SMALL_SIZE, style::DIM, (room - size.x - 8.0).max(0.0));
    let at = pos2(label.rect.right() + 8.0, line.center().y - 0.5 * words.size().y);
    painter.galley_with_override_text_color(at, words, if is_learning { style::ACCENT } else { style::DIM });
    assisted::selected(&label, egui::Role::Button, is_learning, format_args!("learn {}", slider.name));
    if label.clicked() {
        acts.commands.push(Command::LearnParameter(slider.name.clone()));
    }
    binding::button(ui, wave, &slider, open);
    if changed_by_user && bound.is_none() {
        let response = ui.interact(reset, ui.scope_id().with("reset"), Sense::click());
        let color = if response.hovered() { style::TEXT } else { style::DIM };
        let font = style::monospace(style::TEXT_SIZE);
        ui.painter().text(reset.center(), Align2::CENTER_CENTER, RESET_SIGN, font, color);
        response
            .widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, format!("reset {}", slider.name)));
        if response.clicked() {
            slider.value = slider.default;
        }
    }

    rail(ui, &mut slider, STEP, false);
    ui.add_space(2.0);
    slider.value
}

const RESET_SIGN: &str = "↺";

/// Draws a slider without its name, and changes its value. Keys and screen readers move it by `step`, a fraction of the
/// range. The value is set while the pointer holds the slider and, with `settles`, once more when it is released.
pub(super) fn rail(ui: &mut Ui, slider: &mut Slider, step: f64, settles: bool) -> Response {
    let full = ui.available_width();
    let (hold, response) = ui.allocate_exact_size(vec2(full, HOLD_HEIGHT), Sense::click_and_drag());
    let rail = Rect::from_center_size(hold.center(), vec2(full - 2.0 * KNOB_RADIUS, RAIL_HEIGHT));
    let is_held = response.is_pointer_button_down_on();
    let is_set = is_held || settles && (response.clicked() || response.drag_stopped());
    if response.double_clicked() {
        slider.value = slider.default;
    } else if let Some(pointer) = response.interact_pointer_pos().filter(|_| is_set) {
        slider.value = slider.param().value_at((pointer.x - rail.left()) / rail.width());
    }
    let (range, step) =
        (f64::from(slider.min)..=f64::from(slider.max), step * f64::from(slider.max - slider.min));
    if let Some(wanted) = assisted::rail(ui, &response, &slider.name, slider.value.into(), range, step) {
        slider.value = slider.param().clamped(wanted as f32);
    }
    let x_of = |value: f32| rail.left() + slider.param().fraction_of(value) * rail.width();
    // A number of the settings that can be negative is drawn from 0.
    let base = if settles && slider.min < 0.0 { x_of(0.0) } else { rail.left() };
    let is_lit = response.hovered() || is_held;
    draw_rail(ui.painter(), rail, base, [slider.default, slider.value].map(x_of), is_lit);
    response
}

/// Draws a rail that is filled from `base` to its knob, with a mark at the usual value.
fn draw_rail(painter: &Painter, rail: Rect, base: f32, mark_and_knob: [f32; 2], held: bool) {
    let [mark, knob] = mark_and_knob;
    let radius = RAIL_HEIGHT / 2.0;
    painter.rect_filled(rail, radius, style::RAIL);
    let mark = Rect::from_center_size(pos2(mark, rail.center().y), vec2(1.5, 3.0 * RAIL_HEIGHT));
    painter.rect_filled(mark, 0.0, style::RAIL);
    let filled = Rect::from_x_y_ranges(base.min(knob)..=base.max(knob), rail.y_range());
    painter.rect_filled(filled, radius, style::ACCENT);
    let (knob_radius, color) =
        if held { (KNOB_RADIUS + 0.5, style::TEXT) } else { (KNOB_RADIUS, style::ACCENT) };
    painter.circle_filled(pos2(knob, rail.center().y), knob_radius, color);
}
