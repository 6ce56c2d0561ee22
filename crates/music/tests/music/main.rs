//! What is heard in signals and rhythms whose answers are known.

mod analysis;
mod beats;
mod levels_and_curves;
mod rhythm;
mod signals;
