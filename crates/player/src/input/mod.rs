//! Live input: sound from a device, or the computer's own sound.
//!
//! ```text
//! device ─► InputCallback ─► ring of frames ─► listening thread ─► ring of moments ─► Live::now
//! ```
//!
//! Both rings are wait-free at both ends, and a moment carries the index of its sample and its time. The window keeps
//! the moments of the last seconds, so that the image can be delayed against the incoming sound.

mod input_callback;
mod listener;
mod live;
mod port;
mod probe;

pub use input_callback::{InputCallback, InputCallbackLink, InputCounters};
pub use live::{Live, LiveOptions, LiveStatus};
