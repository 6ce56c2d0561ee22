//! What turns a parameter.

use serde::Serialize;

/// Whose hand turned a parameter last.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum ChangedBy {
    /// Nobody: the parameter is as the scene's text declares it.
    #[default]
    Text,
    /// A slider in the window, or one that was remembered.
    Slider,
    /// A mapped knob, key or wheel.
    Midi,
    /// A message over the network.
    Osc,
    /// The page for phones.
    Phone,
    /// A show that moves parameters.
    Show,
    /// A performance that was recorded.
    Recording,
}

impl ChangedBy {
    /// All of them.
    pub const ALL: [Self; 7] =
        [Self::Text, Self::Slider, Self::Midi, Self::Osc, Self::Phone, Self::Show, Self::Recording];

    /// What people read beside a slider.
    pub fn name(self) -> &'static str {
        match self {
            Self::Text => "text",
            Self::Slider => "slider",
            Self::Midi => "MIDI",
            Self::Osc => "OSC",
            Self::Phone => "phone",
            Self::Show => "show",
            Self::Recording => "recording",
        }
    }
}
