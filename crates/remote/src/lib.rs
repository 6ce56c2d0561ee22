//! A page for phones, by which they steer a show.
//!
//! ```text
//! phone ─ GET /TOKEN/ ──────► page, style and script, which are part of the program
//!       ─ GET /TOKEN/picture/SCENE ─► album ◄─ small pictures that the program made
//!       ─ GET /TOKEN/hands ─► WebSocket ─► wishes ─► the show
//!                                       ◄─ board ◄─
//! ```
//!
//! **Nobody who lacks the token learns or does anything.** It is new at each start and stands in the address, which the
//! window shows as a code of squares. It has 130 random bits, more than anyone can guess, so a wrong token needs no penalty. A page
//! of another place that a browser shows is refused by its `Origin`, and one under another name for this computer by its
//! `Host`.
//!
//! **No request reaches a file.** What is answered stands in a table of texts that are part of the program, or in the
//! [`Album`], which is in memory.
//!
//! **Nobody is waited for.** Each connection has a thread, bounded in number, bytes and time ([`limits`]); what phones
//! wish for goes among the [`InputQueue`](mariana_control::Wishes), and how the show stands comes from the
//! [`Board`](mariana_control::Board). A phone that reads slowly gets only the newest state.

mod album;
mod connection_limit;
mod heartbeat;
pub mod http;
pub mod limits;
pub mod message;
mod page;
mod pairing_address;
mod phone_session;
mod route;
mod server;
mod state_delta;
mod token;

pub use album::Album;
pub use page::{PAGE_PATH, SESSION_PATH, page_text};
pub use pairing_address::{Code, PairingAddress};
pub use server::{Remote, RemotePlace, RemoteState};
