//! Draws the controllers panel.

use egui::{Color32, Id, Order, Pos2, Rect, Response, Sense, Shape, Ui, WidgetInfo, pos2, vec2};

use super::acts::Pass;
use super::chips::{self, Chip};
use super::{assisted, kept, pairing_address, style, words};
use crate::controllers_panel::{ControllerRow, ControllersPanel, MappingField};
use mariana_commands::{Command, Panel};
use mariana_control::midi::Mapping;
use mariana_settings::KnobEdit;

const WIDTH_MAX: f32 = 640.0;
const LINE: f32 = 24.0;
const INDENT: f32 = 16.0;
/// Width of the targets' names, as a fraction of a row.
const NAME: f32 = 0.34;

pub(super) fn show(pass: &mut Pass<'_>, space: Rect, panel: &ControllersPanel) -> Rect {
    let Pass { context, acts } = pass;
    style::panel(context, "hands", Order::Foreground, style::middle(space, WIDTH_MAX), |ui| {
        ui.spacing_mut().item_spacing = vec2(0.0, 0.0);
        let mut ask = |command| acts.commands.push(command);
        let hint = "click a row, then move a knob · saved automatically";
        if words::heading(ui, LINE, "Controllers", hint, false, "close the controllers") {
            ask(Command::TogglePanel(Panel::Controllers));
        }
        let height = (space.height() - 2.0 * style::PADDING.y - LINE).max(LINE);
        let before = kept::replace(ui.ctx(), Id::unique("selected controller"), panel.selected);
        let moved = before.is_some_and(|before| before != panel.selected);
        // Start at the top, because the connection code is there.
        style::scrolled(ui, height, before.is_none(), |ui| {
            for (place, row) in panel.rows.iter().enumerate() {
                let is_selected = place == panel.selected;
                let drawn = ui.push_id(place, |ui| draw_row(ui, row, is_selected, panel.field(), &mut ask));
                if is_selected && moved {
                    drawn.inner.scroll_to_me(None);
                }
            }
        });
    })
}

fn draw_row(
    ui: &mut Ui,
    row: &ControllerRow,
    is_selected: bool,
    field: MappingField,
    ask: &mut impl FnMut(Command),
) -> Response {
    match row {
        ControllerRow::Words { text, is_bad } => {
            let color = if *is_bad { style::ERROR } else { style::DIM };
            let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), LINE), Sense::hover());
            put(ui, rect.left_center(), text, color, rect.width());
            response.widget_info(|| WidgetInfo::labeled(egui::Role::Label, true, text));
            response
        }
        ControllerRow::Phone { pairing_address, about } => pairing_address::show(ui, pairing_address, about),
        ControllerRow::Clock(on) => {
            let name = "MIDI clock sets the tempo";
            let state = if *on { "on" } else { "off" };
            let response = two_words(ui, is_selected, (name, style::TEXT), (state, style::ACCENT));
            response.widget_info(|| WidgetInfo::selected(egui::Role::CheckBox, true, *on, name));
            if response.clicked() {
                ask(Command::EditMappings(KnobEdit::Clock(!on)));
            }
            response
        }
        ControllerRow::Target { target, name, about, learns } => {
            let color = if *learns { style::ACCENT } else { style::TEXT };
            let about_color = if *learns { style::ACCENT } else { style::DIM };
            let response = two_words(ui, is_selected, (name, color), (about, about_color));
            assisted::selected(&response, egui::Role::Button, *learns, format_args!("learn {name}"));
            if response.clicked() {
                ask(Command::Learn(target.clone()));
            }
            response
        }
        ControllerRow::Knob { mapping, words, stands } => {
            draw_knob(ui, mapping, words, *stands, is_selected.then_some(field), ask)
        }
    }
}

fn two_words(ui: &mut Ui, is_selected: bool, name: (&str, Color32), about: (&str, Color32)) -> Response {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), LINE), Sense::click());
    style::light(ui.painter(), rect, is_selected || response.hovered());
    let middle = rect.left() + NAME * rect.width();
    put(ui, rect.left_center() + vec2(6.0, 0.0), name.0, name.1, middle - rect.left() - 12.0);
    put(ui, pos2(middle, rect.center().y), about.0, about.1, rect.right() - middle - 6.0);
    response
}

fn draw_knob(
    ui: &mut Ui,
    mapping: &Mapping,
    words: &str,
    stands: Option<f32>,
    selected: Option<MappingField>,
    ask: &mut impl FnMut(Command),
) -> Response {
    let ground = ui.painter().add(Shape::Noop);
    let drawn = ui.horizontal(|ui| {
        ui.add_space(6.0 + INDENT);
        ui.vertical(|ui| {
            let (line, label) = ui.allocate_exact_size(vec2(ui.available_width(), LINE), Sense::hover());
            put(ui, line.left_center(), words, style::BUTTON, line.width());
            label.widget_info(|| WidgetInfo::labeled(egui::Role::Label, true, words));
            let clicked = chips::choose(ui, "fields", &MappingField::ALL, |field| {
                let text = field.words(mapping);
                let is_enabled = field.request(mapping, stands).is_some();
                let name = format!("{text}, {words}{}", if is_enabled { field.hint() } else { "" });
                Chip { is_enabled, ..Chip::new(text, name, selected == Some(field)) }
            });
            if let Some(request) = clicked.and_then(|field| field.request(mapping, stands)) {
                ask(request);
            }
            ui.add_space(3.0);
        });
    });
    style::light_behind(ui, ground, drawn.response.rect, selected.is_some());
    drawn.response
}

fn put(ui: &Ui, left: Pos2, text: &str, color: Color32, width: f32) {
    style::put(ui.painter(), left, text, style::TEXT_SIZE, color, width);
}
