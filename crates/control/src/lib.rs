//! Controller input for a show. Sliders, MIDI, OSC, phones, scene texts, shows and recordings all change one
//! [`Model`] of parameters.
//!
//! ```text
//! MIDI bytes  ─ parser ─ newest value of each knob ─┐
//! OSC packets ─ bounded ─ newest value of each name ─┼─► input queue ─► once per frame: mappings ─► model ─► frame
//! slider, text, show, recording, phone ─────────────┘
//! ```
//!
//! - **The newest value wins.** [`InputQueue`] keeps one value per parameter between two frames.
//! - **The last controller wins.** [`Model`] stores each parameter's target, its smoothing time, and the origin of
//!   its last change ([`ChangedBy`]). The same changes at the same times give the same values at any frame rate.
//! - Devices and sockets run on their own threads. The show never waits for them.

pub mod action;
mod binding;
mod glide;
mod input_queue;
pub mod limits;
pub mod midi;
mod model;
pub mod osc;
mod present;
mod slider;

pub use binding::{Bound, ChangedBy, SoundBinding};
pub use glide::Glide;
pub use input_queue::{Amount, InputBatch, InputQueue, ParamChange};
pub use midi::Curve;
pub use model::{Directed, Model, Param, Reading, Turn};
pub use present::{Board, Present};
pub use slider::Slider;
