//! Parameters that follow a sound.

use serde::{Deserialize, Serialize};

use crate::{Curve, Glide, limits};

/// A rule by which a parameter follows an input: `low + (high - low) * curve(input)`.
///
/// The model does not know the inputs. The show gives their values, from 0 to 1, to
/// [`Model::move_bound`](crate::Model::move_bound).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SoundBinding {
    /// The name of the input.
    pub input: String,
    /// The parameter's value where the input is 0.
    pub low: f32,
    /// The parameter's value where the input is 1. It may be less than `low`.
    pub high: f32,
    /// The response curve.
    #[serde(default)]
    pub curve: Curve,
    /// The smoothing time in seconds while the value rises; 0 follows at once.
    #[serde(default)]
    pub smoothing: f32,
    /// The smoothing time in seconds while the value falls; `None` if it is the same.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub release: Option<f32>,
}

impl SoundBinding {
    /// Returns the parameter's value for an input from 0 to 1.
    pub fn value(&self, input: f32) -> f32 {
        let input = if input.is_finite() { input.clamp(0.0, 1.0) } else { 0.0 };
        self.low + (self.high - self.low) * self.curve.at(input)
    }

    /// Returns the binding with its smoothing time in its limits, or `None` if one of its numbers is not finite.
    pub fn mended(mut self) -> Option<Self> {
        let release = self.release.unwrap_or(0.0);
        let is_finite =
            [self.low, self.high, self.smoothing, release].iter().all(|number| number.is_finite());
        for seconds in std::iter::once(&mut self.smoothing).chain(&mut self.release) {
            *seconds = seconds.clamp(0.0, limits::SMOOTHING_SECONDS_MAX);
        }
        is_finite.then_some(self)
    }

    /// Returns the binding as an expression of the scene language, where `input` is the input's expression.
    pub fn expression(&self, input: &str) -> String {
        let curved = self.curve.expression(input);
        let value = match (self.low, self.high) {
            (0.0, 1.0) => curved,
            (low, high) => format!("mix({low}, {high}, {curved})"),
        };
        match (self.smoothing, self.release) {
            (0.0, None | Some(0.0)) => value,
            (rise, Some(fall)) if fall != rise => format!("follow({value}, {rise}, {fall})"),
            (rise, _) => format!("follow({value}, {rise})"),
        }
    }
}

/// A binding of a parameter, as a slider shows it.
#[derive(Debug, Clone, PartialEq)]
pub struct Bound {
    /// The binding.
    pub binding: SoundBinding,
    /// True while the sound moves the parameter; false since another controller has changed the parameter.
    pub is_active: bool,
}

/// A binding with its present value.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Following {
    pub binding: SoundBinding,
    /// The binding's value, smoothed.
    value: Glide,
    /// The parameter's value when the binding began.
    from: f32,
    /// The weight of the binding's value, which rises to 1.
    weight: Glide,
}

impl Following {
    /// Begins at the parameter's value `from`. The parameter passes to the binding's value within `seconds`.
    pub(crate) fn new(binding: SoundBinding, from: f32, seconds: f32, now: f64) -> Self {
        let weight = Glide::at(0.0).ramp(1.0, seconds, now);
        Self { value: Glide::at(from), weight, from, binding }
    }

    pub(crate) fn follow(&mut self, input: f32, now: f64) {
        let SoundBinding { smoothing, release, .. } = self.binding;
        let to = self.binding.value(input);
        let seconds = release.filter(|_| to < self.value.value(now)).unwrap_or(smoothing);
        self.value = self.value.towards(to, seconds, now);
    }

    pub(crate) fn value(&self, now: f64) -> f32 {
        let (value, weight) = (self.value.value(now), self.weight.value(now));
        // Exact at the end: other code compares bits.
        if weight >= 1.0 { value } else { self.from + (value - self.from) * weight }
    }

    pub(crate) fn moves(&self, now: f64) -> bool {
        self.value.moves(now) || self.weight.moves(now)
    }
}

// The origin of a parameter's value.

/// The controller that changed a parameter last.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum ChangedBy {
    /// No controller: the parameter has the value in the scene's text.
    #[default]
    Text,
    /// A slider in the window, or a stored slider value.
    Slider,
    /// A mapped MIDI knob, key or wheel.
    Midi,
    /// An OSC message.
    Osc,
    /// The phone page.
    Phone,
    /// A show that moves parameters.
    Show,
    /// A recorded performance.
    Recording,
    /// A sound to which the parameter is bound.
    Sound,
}

impl ChangedBy {
    /// Returns the label next to a slider.
    pub fn name(self) -> &'static str {
        match self {
            Self::Text => "text",
            Self::Slider => "slider",
            Self::Midi => "MIDI",
            Self::Osc => "OSC",
            Self::Phone => "phone",
            Self::Show => "show",
            Self::Recording => "recording",
            Self::Sound => "sound",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_envelope_rises_at_once_and_falls_slowly() {
        let (input, curve) = ("kick".to_owned(), Curve::Linear);
        let binding = SoundBinding { input, low: 0.0, high: 2.0, curve, smoothing: 0.0, release: Some(1.0) };
        let mut following = Following::new(binding, 0.0, 0.0, 0.0);
        following.follow(1.0, 1.0);
        assert_eq!(following.value(1.0), 2.0);
        following.follow(0.0, 1.0);
        assert!((following.value(2.0) - 2.0 / std::f32::consts::E).abs() < 1e-5);
        following.follow(1.0, 2.0);
        assert_eq!(following.value(2.0), 2.0);
    }

    #[test]
    fn a_binding_maps_its_input_by_range_and_curve() {
        let binding = |low, high, curve| {
            let (input, smoothing, release) = ("bass".to_owned(), 0.0, None);
            SoundBinding { input, low, high, curve, smoothing, release }
        };
        let up = binding(0.5, 2.5, Curve::Slow);
        assert_eq!([0.0, 0.5, 1.0, 7.0, f32::NAN].map(|x| up.value(x)), [0.5, 1.0, 2.5, 2.5, 0.5]);
        assert_eq!(binding(1.0, 0.0, Curve::Root).value(0.25), 0.5);
        assert_eq!(up.expression("bass"), "mix(0.5, 2.5, bass ^ 2)");
        assert_eq!(up.expression("melody / 88"), "mix(0.5, 2.5, (melody / 88) ^ 2)");
        assert_eq!(binding(0.0, 1.0, Curve::Fast).expression("bass"), "bass * (2 - bass)");
        let smooth = |smoothing, release| SoundBinding { smoothing, release, ..up.clone() };
        for (binding, written) in [
            (smooth(0.0, Some(0.0)), "mix(0.5, 2.5, bass ^ 2)"),
            (smooth(0.25, None), "follow(mix(0.5, 2.5, bass ^ 2), 0.25)"),
            (smooth(0.25, Some(0.25)), "follow(mix(0.5, 2.5, bass ^ 2), 0.25)"),
            (smooth(0.0, Some(1.5)), "follow(mix(0.5, 2.5, bass ^ 2), 0, 1.5)"),
        ] {
            assert_eq!(binding.expression("bass"), written);
        }
        assert_eq!(binding(f32::NAN, 1.0, Curve::Fast).mended(), None);
        let long = SoundBinding { smoothing: 1e9, ..up };
        assert_eq!(long.mended().unwrap().smoothing, limits::SMOOTHING_SECONDS_MAX);
    }
}
