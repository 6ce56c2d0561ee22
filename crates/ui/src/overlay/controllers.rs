//! Draws the controllers panel.

use egui::{Color32, Order, Pos2, Rect, Response, Sense, Ui, WidgetInfo, pos2, vec2};

use super::acts::Pass;
use super::{assisted, pairing_address, style, words};
use crate::controllers_panel::{ControllerRow, ControllersPanel, MappingField};
use mariana_commands::{Command, Panel};
use mariana_control::midi::Mapping;
use mariana_settings::KnobEdit;

const WIDTH_MAX: f32 = 640.0;
const LINE: f32 = 24.0;
const INDENT: f32 = 16.0;
/// Width of the targets' names, as a fraction of a row.
const NAME: f32 = 0.34;

pub(super) type Seen = Option<usize>;

pub(super) fn show(pass: &mut Pass<'_>, space: Rect, panel: &ControllersPanel, seen: &mut Seen) -> Rect {
    let Pass { context, acts } = pass;
    style::panel(context, "hands", Order::Foreground, style::middle(space, WIDTH_MAX), |ui| {
        ui.spacing_mut().item_spacing = vec2(0.0, 0.0);
        let mut ask = |command| acts.commands.push(command);
        let hint = "click a row, then move a knob · saved automatically";
        if words::heading(ui, LINE, "Controllers", hint, "", "close the controllers") {
            ask(Command::TogglePanel(Panel::Controllers));
        }
        let height = (space.height() - 2.0 * style::PADDING.y - LINE).max(LINE);
        let before = seen.replace(panel.selected);
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
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 2.0 * LINE), Sense::hover());
    style::light(ui.painter(), rect, selected.is_some());
    let line = Rect::from_min_size(rect.min, vec2(rect.width(), LINE));
    let left = rect.left() + 6.0 + INDENT;
    put(ui, pos2(left, line.center().y), words, style::BUTTON, rect.right() - left);
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Label, true, words));
    let mut at = pos2(left, rect.top() + LINE);
    for field in MappingField::ALL {
        let text = field.words(mapping);
        let galley = style::line(ui.painter(), &text, style::SMALL_SIZE, style::TEXT, f32::MAX);
        let place = Rect::from_min_size(at, vec2(galley.size().x + 14.0, LINE)).shrink2(vec2(1.0, 2.0));
        if place.right() > rect.right() {
            break;
        }
        at.x = place.right() + 3.0;
        let request = field.request(mapping, stands);
        let button = ui.interact(place, ui.scope_id().with(text.as_str()), Sense::click());
        let (is_selected, is_pointed) = (selected == Some(field), button.hovered() && request.is_some());
        let color = style::value_ground(ui.painter(), place, is_selected, is_pointed);
        let color = if request.is_none() && !is_selected { style::DIM } else { color };
        let top = place.center().y - 0.5 * galley.size().y;
        ui.painter().galley_with_override_text_color(pos2(place.left() + 6.0, top), galley, color);
        button.widget_info(|| {
            WidgetInfo::labeled(egui::Role::Button, request.is_some(), format!("{text}, {words}"))
        });
        if let Some(request) = request.filter(|_| button.clicked()) {
            ask(request);
        }
        let button = match field {
            MappingField::From | MappingField::To if stands.is_some() => {
                button.on_hover_text("click to set this end to the parameter's present value")
            }
            MappingField::PickUp => {
                button.on_hover_text("picks up: acts once the knob reaches the value · jumps: acts at once")
            }
            _ => button,
        };
        drop(button);
    }
    response
}

fn put(ui: &Ui, left: Pos2, text: &str, color: Color32, width: f32) {
    style::put(ui.painter(), left, text, style::TEXT_SIZE, color, width);
}
