//! Colours in the text: a swatch below each colour's `vec3`, and a colour picker that opens on click.

use egui::color_picker::{Alpha, color_picker_hsva_2d};
use egui::ecolor::Hsva;
use egui::{Color32, Context, Id, Order, Pos2, Rect, Rgba, pos2};

use crate::editor::Editor;
use crate::overlay::acts::Acts;
use crate::overlay::{icons, style};

/// Width of the colour field. The next constant is the approximate height of the whole picker.
const WIDTH: f32 = 190.0;
const HEIGHT: f32 = 310.0;

/// The picked colour. It keeps hue and saturation even if the numbers do not determine them, as for black.
#[derive(Clone, Copy)]
struct Picked {
    at: usize,
    color: Hsva,
    /// Multiplier of `color` for colours with a component above 1; otherwise 1.
    bright: f64,
}

/// Converts a linear colour to a screen colour. Scales colours brighter than white down, so that they keep their hue.
pub(super) fn screen_color(values: [f64; 3]) -> Color32 {
    let bright = brightness(values);
    let [r, g, b] = values.map(|part| (part.max(0.0) / bright) as f32);
    Rgba::from_rgb(r, g, b).into()
}

fn brightness(values: [f64; 3]) -> f64 {
    values.into_iter().fold(1.0, f64::max)
}

pub(super) fn show(context: &Context, at: Rect, editor: &Editor, acts: &mut Acts) -> Option<Rect> {
    let (place, values) = editor.held_numbers.picked_color(editor.document()?)?;
    let id = Id::unique("picked color");
    let known = context.data(|data| data.get_temp::<Picked>(id)).filter(|known| known.at == place);
    let near = |known: &Picked| {
        let [r, g, b] = known.color.to_rgb().map(|part| f64::from(part) * known.bright);
        [r, g, b].iter().zip(values).all(|(a, b)| (a - b).abs() < 2e-3 * known.bright)
    };
    let mut picked = known.filter(near).unwrap_or_else(|| {
        let bright = brightness(values);
        let color = Hsva::from_rgb(values.map(|part| (part.max(0.0) / bright) as f32));
        Picked { at: place, color, bright }
    });
    let screen = context.viewport_rect();
    let top = if at.bottom() + HEIGHT < screen.bottom() { at.bottom() + 6.0 } else { at.top() - HEIGHT };
    let corner: Pos2 = pos2(at.left().min(screen.right() - WIDTH - 40.0), top.max(screen.top() + 4.0));
    let area = style::area(id, Order::Foreground).fixed_pos(corner);
    let shown = area.show(context, |ui| {
        let frame = style::frame().fill(style::ON_ACCENT);
        frame.show(ui, |ui| {
            ui.spacing_mut().slider_width = WIDTH;
            let corner = ui.cursor().min;
            let changed = color_picker_hsva_2d(ui, &mut picked.color, Alpha::Opaque);
            // Cover egui's first row, because it has numbers in screen units and a button for egui's own clipboard.
            let row =
                Rect::from_min_size(corner, egui::vec2(ui.min_rect().width(), ui.spacing().interact_size.y));
            ui.painter().rect_filled(row, 0.0, style::ON_ACCENT);
            ui.interact(row, Id::unique("picker heading"), egui::Sense::click_and_drag());
            let words = match picked.bright > 1.0 {
                true => format!("colour, {} times as bright as white", short(picked.bright)),
                false => "colour".to_owned(),
            };
            let galley = style::line(ui.painter(), &words, style::SMALL_SIZE, style::DIM, row.width() - 24.0);
            ui.painter().galley(row.min, galley, style::DIM);
            changed
        })
    });
    let rect = shown.response.rect;
    let cross = Rect::from_min_size(pos2(rect.right() - 26.0, rect.top() + 6.0), egui::vec2(20.0, 20.0));
    let closes = style::area(Id::unique("picker cross"), Order::Foreground).fixed_pos(cross.min);
    closes.show(context, |ui| {
        if icons::closing_cross(ui, cross, "close (Esc)") {
            acts.on_editor(Editor::close_picker);
        }
    });
    if shown.inner.inner {
        let color = picked.color.to_rgb().map(|part| f64::from(part) * picked.bright);
        acts.on_editor(move |editor| editor.set_color(color));
    }
    context.data_mut(|data| data.insert_temp(id, picked));
    Some(rect)
}

fn short(value: f64) -> String {
    mariana_editing::written_part((100.0 * value).round() / 100.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_linear_colour_becomes_a_screen_colour() {
        assert_eq!(screen_color([1.0, 1.0, 1.0]), Color32::WHITE);
        assert_eq!(screen_color([0.0, 0.0, 0.0]), Color32::BLACK);
        // On a screen, half the light looks more than half as bright.
        assert!(screen_color([0.5, 0.5, 0.5]).r() > 180);
        assert_eq!(screen_color([300.0, 0.0, 0.0]), Color32::from_rgb(255, 0, 0));
        assert_eq!(screen_color([-1.0, 0.0, 2.0]), Color32::from_rgb(0, 0, 255));
    }
}
