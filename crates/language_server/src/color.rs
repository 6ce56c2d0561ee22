//! Colours in a text. Scenes contain linear light; an editor shows sRGB.

use mariana_editing::{TripleKind, triples, written_part};
use serde_json::{Value, json};

use crate::documents::Documents;
use crate::positions::{self, Span};
use crate::protocol::{Color, TextEdit};

pub(crate) fn colors(documents: &mut Documents, uri: &str) -> Value {
    let Some(document) = documents.open.get_mut(uri) else { return json!([]) };
    let mut found = Vec::new();
    for line in 0..document.buffer.line_count() {
        let start = document.buffer.line_start(line);
        for triple in triples(&document.buffer, &mut document.colors, line) {
            let values = triple.values();
            if triple.kind != TripleKind::Color || values.iter().any(|value| !(0.0..=1.0).contains(value)) {
                continue;
            }
            let [red, green, blue] = values.map(to_srgb);
            let range =
                positions::range(&document.buffer, start + triple.range.start..start + triple.range.end);
            found.push(json!({ "range": range, "color": Color { red, green, blue, alpha: 1.0 } }));
        }
    }
    json!(found)
}

/// Returns the text of a colour that the user has chosen.
pub(crate) fn presentations(color: Color, range: Span) -> Value {
    let Color { red, green, blue, .. } = color;
    let [red, green, blue] = [red, green, blue].map(|part| written_part(to_linear(part.clamp(0.0, 1.0))));
    let new_text = format!("vec3({red}, {green}, {blue})");
    let edit = TextEdit { range, new_text: new_text.clone() };
    json!([{ "label": new_text, "textEdit": edit }])
}

/// IEC 61966-2-1.
fn to_srgb(linear: f64) -> f64 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

fn to_linear(srgb: f64) -> f64 {
    if srgb <= 0.040_45 { srgb / 12.92 } else { ((srgb + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_stay_the_same_on_the_way_to_an_editor_and_back() {
        for step in 0..=1000 {
            let value = f64::from(step) / 1000.0;
            assert!((to_linear(to_srgb(value)) - value).abs() < 1e-6, "{value}");
        }
    }
}
