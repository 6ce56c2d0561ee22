//! The definition of flashes and their limits on the CPU, with which the pictures are judged.

pub(crate) mod analyser;
pub(crate) mod fields;
pub(crate) mod grid;
pub(crate) mod limiter;
pub(crate) mod swing;

pub(crate) use analyser::{Analyser, Flashes};
pub(crate) use grid::grid_of;
pub(crate) use limiter::{Limiter, limits};
