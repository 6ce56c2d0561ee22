//! The header of an ISF shader: a comment with JSON, which lists its inputs.
//!
//! The inputs become uniforms with values, so that only this file handles ISF.

use std::fmt::Write as _;

use serde_json::Value;

use super::Result;
use super::outside::Channel;
use crate::lang::{Diagnostic, Span};

/// Larger numbers of an input are cut, because a scene's numbers have 32 bits.
const NUMBER_MAX: f64 = 1e30;

/// An input that a user sets: its default, of one number or several, and its range.
#[derive(Debug)]
pub(super) struct Slider {
    pub name: String,
    pub values: Vec<f64>,
    pub range: [f64; 2],
    /// True for a number without steps.
    pub is_smooth: bool,
}

/// The inputs that a header declares.
#[derive(Debug, Default)]
pub(super) struct Inputs {
    pub is_isf: bool,
    /// Uniforms, as GLSL.
    pub declarations: String,
    pub sliders: Vec<Slider>,
    pub channels: Vec<(String, Channel)>,
}

impl Inputs {
    /// Reads the header of a text; empty for a text that does not begin with one.
    pub(super) fn of(text: &str) -> Result<Self> {
        let mut inputs = Self::default();
        let Some(json) = text.trim_start_matches('\u{feff}').trim_start().strip_prefix("/*") else {
            return Ok(inputs);
        };
        let json = json.split_once("*/").map_or(json, |(json, _)| json).trim();
        if !json.starts_with('{') || !json.contains("\"INPUTS\"") && !json.contains("\"ISFVSN\"") {
            return Ok(inputs);
        }
        let header: Value = serde_json::from_str(json).map_err(|error| {
            Diagnostic::new(
                Span::new(0, 2),
                format!("the JSON at the start of this ISF shader has a mistake: {error}"),
            )
            .hint("mend the JSON between `/*{` and `}*/`")
        })?;
        inputs.is_isf = true;
        list(&header, "INPUTS").iter().for_each(|input| inputs.declare(input));
        let imported = header.get("IMPORTED").and_then(Value::as_object).into_iter().flatten();
        imported.for_each(|(name, _)| inputs.sampler(name, Channel::Picture));
        let passes = list(&header, "PASSES");
        let targets = passes.iter().filter_map(|pass| pass.get("TARGET")?.as_str());
        targets.for_each(|name| inputs.sampler(name, Channel::LastFrame));
        if let Some(last) = passes.len().checked_sub(1) {
            // The last pass draws the picture.
            let _ = writeln!(inputs.declarations, "const int PASSINDEX = {last};");
        }
        Ok(inputs)
    }

    fn declare(&mut self, input: &Value) {
        let text = |key| input.get(key).and_then(Value::as_str).unwrap_or("");
        let number = |value: &Value| value.as_f64().or_else(|| value.as_bool().map(f64::from));
        let (name, choices) = (text("NAME"), list(input, "VALUES"));
        let end = |key, of: fn(f64, f64) -> f64| {
            let own = input.get(key).and_then(number);
            own.or_else(|| choices.iter().filter_map(number).reduce(of))
        };
        let least = end("MIN", f64::min).unwrap_or(0.0);
        let most = end("MAX", f64::max).unwrap_or(least + 1.0);
        let (of, components) = match text("TYPE") {
            "audio" => return self.sampler(name, Channel::Waveform),
            "audioFFT" => return self.sampler(name, Channel::Spectrum),
            "float" => ("float", 1),
            "long" => ("int", 1),
            "bool" | "event" => ("bool", 1),
            "point2D" => ("vec2", 2),
            "color" => ("vec4", 4),
            _ => return self.sampler(name, Channel::Picture),
        };
        if !self.is_free(name) {
            return;
        }
        let default = list(input, "DEFAULT");
        let values = (0..components).map(|index| default.get(index).and_then(number).unwrap_or(least));
        let values: Vec<f64> = values.map(|value| value.clamp(-NUMBER_MAX, NUMBER_MAX)).collect();
        let written: Vec<String> = values.iter().map(|value| format!("{value:?}")).collect();
        let _ = writeln!(self.declarations, "uniform {of} {name} = {of}({});", written.join(", "));
        let [least, most] = [least, most].map(|end| end.clamp(-NUMBER_MAX, NUMBER_MAX));
        let wide = least + 1e-3 * least.abs().max(1.0);
        let range = values
            .iter()
            .fold([least, most.max(wide)], |range, &value| [range[0].min(value), range[1].max(value)]);
        self.sliders.push(Slider { name: name.to_owned(), values, range, is_smooth: of == "float" });
    }

    /// True for a name that GLSL can declare and no other input has.
    fn is_free(&self, name: &str) -> bool {
        let starts = name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
        // Names of the import itself begin with `glsl_`.
        starts
            && !name.starts_with("glsl_")
            && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
            && !self.channels.iter().any(|(known, _)| known == name)
            && !self.sliders.iter().any(|known| known.name == name)
    }

    fn sampler(&mut self, name: &str, channel: Channel) {
        if self.is_free(name) {
            let _ = writeln!(self.declarations, "uniform sampler2D {name};");
            self.channels.push((name.to_owned(), channel));
        }
    }
}

/// Returns the values of a list. A single value counts as a list of one.
fn list<'v>(of: &'v Value, key: &str) -> &'v [Value] {
    match of.get(key) {
        Some(Value::Array(values)) => values,
        Some(value) => std::slice::from_ref(value),
        None => &[],
    }
}
