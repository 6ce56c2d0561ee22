//! Where the sound goes: the callback's work ([`Feeder`]), the devices, and the silent clock that stands in for them.

mod feeder;
mod null_output;
mod port;

pub use feeder::{Controls, Counters, Feeder, FeederLink, Segment};
pub use port::{OutputChoice, OutputRequest, OutputStatus, Supervisor};
