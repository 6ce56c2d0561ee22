//! OSC over UDP. Incoming packets are bounded, interpreted by one table and put into the input queue; outgoing packets
//! carry the audio features.

mod address;
mod packet;
mod pattern;
mod place;
mod receiver;
mod sender;
mod waiting;

pub use address::{Asked, FixedAddress, Query, Refused, fixed_addresses, understand};
pub use packet::{Timed, messages};
pub use pattern::{Pattern, is_pattern};
pub use place::{Place, PlaceError};
pub use receiver::{OscReceiver, ReceiverState};
pub use sender::{OscSender, Sample};
