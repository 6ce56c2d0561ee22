//! Audio output: the callback ([`OutputCallback`]), the devices, and the silent clock that replaces them.

mod output_callback;
mod port;

pub use output_callback::{Controls, OutputCallback, OutputCallbackLink, Segment};
pub(crate) use port::{OutputPort, OutputWatch, Supervisor};
