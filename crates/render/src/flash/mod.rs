//! Detection and limiting of flashes as defined by WCAG 2.3.1.
//!
//! A general flash is a pair of opposing changes of relative luminance by 10 % or more of the maximum, where the darker
//! state is below 0.8. A red flash is a pair of opposing changes to and from a saturated red. No more than three of a
//! kind may occur in any one second, unless those that occur at the same time cover no more than a quarter of any ten
//! degrees of the field of view, which are a third of a screen's width and height.
//!
//! Each frame is reduced to a grid of cells with their mean colours, because finer patterns do not count as flashes.
//! Each cell counts its own changes. The area of flashes is the number of cells of a field with too many flashes within
//! the same second.
//!
//! **Flashes are limited in the finished frame**, whatever the scene does. The limiter gets the mean colours of 48 by
//! 36 cells of the frame that is about to be shown, counts changes as WCAG 2.3.1 does, and gives cells a ceiling so
//! that there is no fourth flash within a second. It runs on the GPU (`gpu::flash_pass`) and keeps its state there: it
//! reads nothing back, and still acts on the same frame. [`Limiter`] does the same on the CPU, and tests compare the
//! two. The limiter raises no light and uses no older frame, so a limited frame is darker but not smeared. Ceilings
//! spread smoothly over some cells around a flash; pixels farther away do not change.

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
