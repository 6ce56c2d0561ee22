//! Where the sound goes: the work of the callback ([`OutputCallback`]), the devices, and the silent clock that stands
//! in for them.

mod null_output;
mod output_callback;
mod port;

pub use output_callback::{Controls, Counters, OutputCallback, OutputCallbackLink, Segment};
pub(crate) use port::OutputWatch;
pub use port::{OutputChoice, OutputRequest, OutputStatus, Supervisor};
