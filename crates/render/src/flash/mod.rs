//! Detection and limiting of flashes as defined by WCAG 2.3.1.
//!
//! A general flash is a pair of opposing changes of relative luminance by 10 % or more of the maximum, where the darker
//! state is below 0.8. A red flash is a pair of opposing changes to and from a saturated red. No more than three of a
//! kind may occur in any one second, unless those at the same time cover no more than a quarter of any ten degrees of
//! the field of view, a third of a screen's width and height.
//!
//! Each frame is reduced to the mean colours of 48 by 36 cells, because finer patterns do not count as flashes. Each
//! cell counts its own changes. The area of flashes is the number of cells of a field with too many within the same
//! second.
//!
//! **Flashes are limited in the finished frame**, whatever the scene does, on the GPU (`gpu::flash_pass`): nothing is
//! read back, and the same frame is dimmed. [`Limiter`] does the same on the CPU, and tests compare the two. No light
//! is raised and no older frame used, so a limited frame is darker but not smeared.

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
