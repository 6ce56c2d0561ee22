//! The flash limiter on the CPU, as a reference for the one on the GPU (`mariana::flash`), and an analyser that counts
//! flashes.

mod analyser;
mod fields;
mod limiter;
mod swing;

pub(crate) use analyser::{Analyser, Flashes};
pub(crate) use fields::Grid;
pub(crate) use limiter::{Correction, Limiter};
