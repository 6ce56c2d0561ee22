//! A control page for phones.
//!
//! ```text
//! phone ─ GET /TOKEN/ ──────► page, style and script, embedded in the program
//!       ─ GET /TOKEN/picture/SCENE ─► album ◄─ preview images rendered by the program
//!       ─ GET /TOKEN/hands ─► WebSocket ─► input queue ─► the show
//!                                       ◄─ board ◄─
//! ```
//!
//! - **All access needs the token**, which is part of the address in the window's QR code. The token has 130 random
//!   bits, too many to guess, and is new at each start. A wrong `Origin` (another web page) or `Host` is rejected.
//! - **No request reaches a file.** All answers are embedded in the program or come from the [`Album`], in memory.
//! - **The show never waits for phones.** Each connection has a thread, bounded in number, bytes and time
//!   ([`limits`]). Input goes into the [`InputQueue`](mariana_control::InputQueue), and the show's state comes from
//!   the [`Board`](mariana_control::Board). A slow phone gets only the newest state.

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
