//! A language server for scenes (Language Server Protocol 3.17), without input and output.
//!
//! ```text
//! messages ─ Server::receive ─► answers
//!                 │ Server::next_check ─► Check::run, on another thread
//!                 ◄──── Server::checked ◄────┘ diagnostics
//! ```
//!
//! [`Server`] answers requests from the tokens and names of a text, which takes milliseconds. A [`Check`] compiles a
//! text, which may take longer. It runs on a thread of the caller, so that a key press never waits for a compiler, and
//! only the newest version of a document is compiled.
//!
//! The crate has its own records of the protocol's messages. The server needs a few dozen of the protocol's several
//! hundred types.

mod check;
mod color;
mod completion;
mod documents;
pub mod grammars;
mod hover;
pub mod limits;
mod navigation;
mod outline;
mod positions;
mod protocol;
mod rename;
mod semantic_tokens;
mod server;
mod signature;
mod uri;

pub use check::{Check, Checked};
pub use documents::ReadInclude;
pub use server::{Ending, Server};
