//! Tests of the flash limiter. Its twin on the CPU computes the same frames, and an analyser counts their flashes.

#![allow(clippy::unwrap_used)]

mod analyser_tests;
mod fields_tests;
mod gpu;
mod grid_tests;
mod limiter_tests;
mod swing_tests;
mod witness;
