//! OSC over UDP. Incoming packets are bounded, interpreted by one table and put into the input queue; outgoing packets
//! carry the audio features.

mod address;
mod packet;
mod place;
mod receiver;
mod sender;

pub use address::{Asked, FixedAddress, Pattern, Query, Refused, fixed_addresses, is_pattern, understand};
pub use packet::{Timed, messages};
pub use place::{Place, PlaceError, PortState};
pub use receiver::{OscReceiver, ReceiverState};
pub use sender::{OscSender, Sample};
