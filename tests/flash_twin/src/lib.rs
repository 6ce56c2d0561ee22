//! The flash limiter on the CPU, as a reference for the one on the GPU (`mariana_render::flash`), and an analyser that counts
//! flashes.

mod analyser;
mod fields;
mod limiter;
mod swing;

pub use analyser::{Analyser, Flashes};
pub use fields::Grid;
pub use limiter::{Correction, Limiter};
