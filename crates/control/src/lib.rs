//! Hands on a show: every slider, knob, clock, message and file that turns something turns one model.
//!
//! ```text
//! MIDI bytes  ─ parser ─ newest value of each knob ─┐
//! OSC packets ─ bounded ─ newest value of each name ─┼─► wishes ─► once for each frame: mappings ─► model ─► picture
//! slider, text, show, recording, phone ─────────────┘
//! ```
//!
//! **Newest wins.** Between two frames a flood of messages costs one value for each parameter: [`InputQueue`] keeps the newest,
//! and says how many came.
//!
//! **The last hand wins.** [`Model`] knows of each parameter which [`ChangedBy`] holds it, where it is going and how long that
//! takes. It reads no clock: the same turns at the same seconds give the same values, however many frames are drawn.
//!
//! Devices and sockets live on threads of their own and hand over values; nothing here waits for them.

pub mod action;
mod changed_by;
mod glide;
mod input_queue;
pub mod limits;
pub mod midi;
mod model;
pub mod osc;
mod present;
mod slider;

pub use changed_by::ChangedBy;
pub use glide::Glide;
pub use input_queue::{Amount, InputBatch, InputQueue, ParamChange, Refusals};
pub use model::{Directed, Model, Param, Reading, Turn};
pub use present::{Board, Present};
pub use slider::Slider;
