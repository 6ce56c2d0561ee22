//! OSC over UDP: what comes in is bounded, understood by one table and put among the wishes; what goes out is what the
//! show hears.

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
