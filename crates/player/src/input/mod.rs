//! Live input: sound from a device, or the computer's own sound.
//!
//! ```text
//! device ─► InputCallback ─► ring of frames ─► listening thread ─► ring of moments ─► Live::now
//! ```
//!
//! Both rings are wait-free for their writers and readers. The window keeps the moments of the last seconds, so that
//! the image can be delayed.

mod input_callback;
mod listener;
mod live;
mod port;

pub use input_callback::{InputCallback, InputCallbackLink, InputCounters};
pub use live::{Live, LiveStatus};
