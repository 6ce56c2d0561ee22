//! A parameter as shown by a slider.

use serde::Serialize;

use crate::{Bound, ChangedBy, Param};

/// A parameter that the user can move.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Slider {
    /// The name in the scene.
    pub name: String,
    /// The value, from `min` to `max`.
    pub value: f32,
    /// The smallest value.
    pub min: f32,
    /// The largest value.
    pub max: f32,
    /// The value that a double click restores.
    pub default: f32,
    /// The origin of the last change.
    pub changed_by: ChangedBy,
    /// The sound that moves the parameter, or moved it until another controller took over.
    #[serde(skip)]
    pub bound: Option<Bound>,
}

impl Slider {
    /// Returns the parameter with its range.
    pub fn param(&self) -> Param<'_> {
        Param { name: &self.name, min: self.min, max: self.max, default: self.default }
    }

    /// Returns who changed the value last; empty for the scene's text and the slider itself.
    pub fn changed_by_words(&self) -> &'static str {
        match self.changed_by {
            ChangedBy::Text | ChangedBy::Slider => "",
            other => other.name(),
        }
    }

    /// Returns the value with as many digits as a slider can distinguish.
    pub fn value_text(&self) -> String {
        let decimals = match self.max - self.min {
            span if span >= 200.0 => 0,
            span if span >= 20.0 => 1,
            span if span >= 2.0 => 2,
            _ => 3,
        };
        format!("{:.decimals$}", self.value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_of_sliders_stay_in_their_range() {
        let slider = |min, max| Slider {
            name: "x".into(),
            value: 0.25,
            min,
            max,
            default: 0.5,
            changed_by: ChangedBy::Text,
            bound: None,
        };
        let unit = slider(0.0, 1.0);
        assert_eq!(
            [-1.0, 0.25, 7.0, f32::NAN].map(|value| unit.param().clamped(value)),
            [0.0, 0.25, 1.0, 0.5]
        );
        assert_eq!(
            [-1.0, 0.25, 2.0].map(|position| slider(-4.0, 4.0).param().value_at(position)),
            [-4.0, -2.0, 4.0]
        );
        assert_eq!(slider(-4.0, 4.0).param().fraction_of(2.0), 0.75);
        // An empty range.
        assert_eq!(
            (slider(1.0, 1.0).param().fraction_of(1.0), slider(1.0, 1.0).param().value_at(0.3)),
            (0.0, 1.0)
        );
        assert_eq!(
            [1.0, 10.0, 100.0, 1_000.0].map(|max| slider(0.0, max).value_text()),
            ["0.250", "0.25", "0.2", "0"]
        );
    }
}
