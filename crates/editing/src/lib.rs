//! What an editor of scenes knows without a window: the text, what is done to it, its colours, what may be written at a
//! place, and numbers that are turned.
//!
//! **A text is bytes.** [`Buffer`] keeps them as one piece with the places where lines begin: inserting a letter moves
//! what stands behind it, some 20 µs in a text of 400 kB, and everything else is plain: a place is a byte, a mistake's
//! place needs no translation, and what nobody edits stays as it was read, be it UTF-8 or not.
//!
//! **Only lines that show are looked at.** Colours and columns are found line by line; nothing walks through the whole
//! text for a key, except finding.

mod buffer;
mod colors;
mod columns;
mod completion;
mod editing;
mod find;
mod history;
pub mod limits;
mod movement;
mod numbers;
mod triples;

pub use buffer::Buffer;
pub use colors::Colors;
pub use columns::{Cell, cells, column_of, offset_of, width};
pub use completion::{About, Proposal, about, documentation, proposals};
pub use editing::{Editing, Refused};
pub use find::find;
pub use history::Change;
pub use movement::Move;
pub use numbers::{Number, TurnSpeed, numbers_before};
pub use triples::{Triple, TripleKind, triples, written_part};
