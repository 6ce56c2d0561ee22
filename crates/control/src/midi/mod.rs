//! MIDI input. Bytes become messages, messages become knob movements, and knob movements change parameters and run
//! actions. Everything except the ports is a function of bytes and times. Each port runs on its own thread.

mod clock;
mod device;
mod encoding;
mod fake;
mod file;
mod hub;
mod learn;
mod mapping;
mod message;
mod ports;
mod source;

pub use clock::{ClockReading, MidiClock};
pub use device::{Device, Said};
pub use encoding::Encoding;
#[cfg(unix)]
pub use fake::FolderPorts;
pub use file::MappingFile;
pub use hub::{MidiHub, MidiState};
pub use learn::Learning;
pub use mapping::{Curve, Mapping, Mappings, Outcome, Target};
pub use message::{Message, Parser};
pub use ports::{Hear, Ports, SystemPorts};
pub use source::{KnobMove, Source};
