//! What is heard in signals and rhythms whose answers are known.

mod analysis;
mod beats;
mod levels_and_curves;
mod rhythm;
mod signals;
mod song_structure;
#[allow(dead_code)] // The example plays more of them.
mod songs;
