//! The origin of a parameter's value.

use serde::Serialize;

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
    /// All variants.
    pub const ALL: [Self; 8] = [
        Self::Text,
        Self::Slider,
        Self::Midi,
        Self::Osc,
        Self::Phone,
        Self::Show,
        Self::Recording,
        Self::Sound,
    ];

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
