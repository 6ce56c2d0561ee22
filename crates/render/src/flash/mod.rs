//! The flashes of a moving picture, as WCAG 2.3.1 defines them: counting them, and keeping them few.
//!
//! A general flash is a pair of opposing changes of relative luminance by 10 % or more of the maximum, where the
//! darker state is below 0.8. A red flash is a pair of opposing changes to and from a saturated red. No more than
//! three of a kind may occur in any one second, unless those that occur at the same time cover no more than a quarter
//! of any ten degrees of the field of view, which are a third of a screen's width and height.
//!
//! A picture is reduced to a grid of cells, each with its mean colour: finer patterns do not count as flashes. Each
//! cell counts its own changes; the area is that of the cells of a field that have too many flashes within the same
//! second.
//!
//! **Flashes are limited in the finished picture**, whatever the scene does. The limiter gets the mean colours
//! of 48 by 36 cells of the picture that is about to be shown, counts changes as WCAG 2.3.1 does, and gives cells a
//! ceiling so that there is no fourth flash within a second. It runs on the GPU (`gpu::flash_pass`), where its
//! state stays: nothing is read back, and yet it is never a frame late. [`Limiter`] is the same on the processor, and
//! tests compare the two. No light is raised and nothing of an older picture is used, so a limited picture is darker,
//! not smeared. Ceilings spread smoothly over some cells around a flash; farther away the picture stays as it is.

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
