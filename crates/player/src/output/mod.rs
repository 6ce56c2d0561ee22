//! Audio output: the callback ([`OutputCallback`]), the devices, and the silent clock that replaces them.

mod null_output;
mod output_callback;
mod port;

pub use output_callback::{Controls, Counters, OutputCallback, OutputCallbackLink, Segment};
pub(crate) use port::OutputWatch;
pub use port::{OutputChoice, OutputRequest, OutputStatus, Supervisor};
