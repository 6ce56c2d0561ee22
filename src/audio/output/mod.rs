//! Where the sound goes: the callback's work ([`Feeder`]), the device ([`cpal_output`]), the silent clock
//! ([`null_output`]) and the [`Supervisor`] that changes from one to the other.

mod cpal_output;
mod feeder;
mod null_output;
mod supervisor;

pub use cpal_output::{hosts_by_preference, hush_sound_library};
pub use feeder::{Controls, Counters, Feeder, FeederLink, Segment};
pub use supervisor::{OutputChoice, OutputRequest, OutputStatus, Supervisor};
