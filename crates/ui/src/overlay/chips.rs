//! Small buttons side by side, in as many lines as needed.

use std::borrow::Cow;

use egui::{Id, Role, Sense, Ui, WidgetInfo, vec2};

use super::style;

/// Height of a chip in points.
const HEIGHT: f32 = 20.0;
const PADDING: f32 = 6.0;
const GAP: f32 = 3.0;

/// A button of a row.
pub(super) struct Chip<'a> {
    pub text: Cow<'a, str>,
    /// The name for screen readers. Also the tooltip, if it says more than the text at its end.
    pub name: String,
    /// True for a chosen value, which is filled.
    pub is_chosen: bool,
    /// True for the number of a snapshot that has not been taken.
    pub is_dim: bool,
    /// False for a part that cannot be clicked now.
    pub is_enabled: bool,
    /// What screen readers call a button that is chosen or not; `None` for one that only does something.
    pub role: Option<Role>,
}

impl<'a> Chip<'a> {
    pub(super) fn new(text: impl Into<Cow<'a, str>>, name: String, is_chosen: bool) -> Self {
        let role = Some(Role::Button);
        Self { text: text.into(), name, is_chosen, is_dim: false, is_enabled: true, role }
    }
}

/// Draws a row of chips. Returns the index of the clicked chip.
pub(super) fn row<'a>(ui: &mut Ui, id: &str, chips: impl IntoIterator<Item = Chip<'a>>) -> Option<usize> {
    let mut clicked = None;
    ui.push_id(id, |ui| {
        ui.spacing_mut().item_spacing = vec2(GAP, GAP);
        ui.horizontal_wrapped(|ui| {
            for (place, chip) in chips.into_iter().enumerate() {
                if single(ui, &chip, ui.max_rect().width(), None) {
                    clicked = Some(place);
                }
            }
        });
    });
    clicked
}

/// Draws a row with a chip for each of `values`. Returns the value of the clicked chip.
pub(super) fn choose<'a, T: Copy>(
    ui: &mut Ui,
    id: &str,
    values: &[T],
    chip: impl Fn(T) -> Chip<'a>,
) -> Option<T> {
    row(ui, id, values.iter().copied().map(chip)).and_then(|place| values.get(place)).copied()
}

/// Draws a chip of at most `width` points. `id` keeps the focus with it if chips before it come and go. Returns true if it
/// was clicked.
pub(super) fn single(ui: &mut Ui, chip: &Chip<'_>, width: f32, id: Option<Id>) -> bool {
    let plain = if chip.is_dim || !chip.is_enabled { style::DIM } else { style::BUTTON };
    let galley = style::line(ui.painter(), &chip.text, style::SMALL_SIZE, plain, width - 2.0 * PADDING);
    let size = vec2(galley.size().x + 2.0 * PADDING, HEIGHT);
    let sense = if chip.is_enabled { Sense::click() } else { Sense::hover() };
    let (rect, own) = ui.allocate_exact_size(size, if id.is_some() { Sense::hover() } else { sense });
    let response = id.map_or(own, |id| ui.interact(rect, id, sense));
    let (fill, color) = match (chip.is_chosen, response.hovered() && chip.is_enabled) {
        (true, _) => (style::ACCENT, style::ON_ACCENT),
        (false, true) => (style::AHEAD, style::TEXT),
        (false, false) => (style::RAIL, plain),
    };
    ui.painter().rect_filled(rect, 4.0, fill);
    let place = rect.center() - 0.5 * galley.size();
    ui.painter().galley_with_override_text_color(place, galley, color);
    response.widget_info(|| match chip.role {
        Some(role) => WidgetInfo::selected(role, chip.is_enabled, chip.is_chosen, &chip.name),
        None => WidgetInfo::labeled(Role::Button, chip.is_enabled, &chip.name),
    });
    let clicked = response.clicked();
    if !chip.name.ends_with(&*chip.text) {
        response.on_hover_text(&chip.name);
    }
    clicked
}
