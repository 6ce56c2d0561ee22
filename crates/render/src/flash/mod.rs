//! Detection and limiting of flashes as defined by WCAG 2.3.1.
//!
//! A general flash is a pair of opposing changes of relative luminance by 10 % or more of the maximum, where the darker
//! state is below 80 %. A red flash is a pair of opposing changes to and from a saturated red. At most three flashes of
//! a kind may occur in any one second. Small flashes are exempt: simultaneous flashes that together cover at most a
//! quarter of any ten degrees of the field of view. Ten degrees are a third of a screen's width and height. Changes in
//! the same direction are simultaneous if they begin within a twentieth of a second: a thin bolt that moves up and down
//! is no flash, although it lights many places in turn.
//!
//! Each frame is reduced to the mean colours of 48 by 36 cells, because finer patterns do not count as flashes. Each
//! cell counts its own changes. The area of flashes is the number of cells in a field that change at the same time and
//! have too many changes within the second before.
//!
//! **Flashes are limited in the finished frame**, whatever the scene does. The GPU limits them (`gpu::flash_pass`)
//! without reading back, so that even the frame that begins the flash is dimmed. [`Limiter`] does the same on the CPU,
//! and tests compare both. The limiter only darkens and never mixes in older frames, so a limited frame is not smeared.

mod analyser;
mod fields;
mod grid;
mod limiter;
mod rules;
mod swing;

pub use analyser::{Analyser, Flashes};
pub use grid::{CELLS, COLUMNS, FLASHES_MAX, Grid, ROWS};
pub use limiter::{Correction, Limiter, Step, Steps};
pub use rules::rules_glsl;
