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

use fields::{HEIGHT, WIDTH};
use limiter::{
    AREA, CEILING_RISE, EARLY, FOLLOW, FRESH, GREY, HOLD, KNEE, OPEN, REACH, RED_RELEASE, RELEASE, SWING,
};
use swing::{CAUTIOUS, FLARE, RED, ROUNDING, SURE_CHANGE, SURE_DARKER, SURE_RED_CHANGE, SURE_RED_FRACTION};

mod analyser;
mod fields;
mod limiter;
mod swing;

pub use analyser::{Analyser, Flashes};
pub use fields::{CELLS, COLUMNS, FLASHES_MAX, Grid, ROWS};
pub use limiter::{Correction, Limiter, Step, Steps};

// The limiter's constants as GLSL, shared with [`Limiter`].

const _: () = assert!(FLASHES_MAX == 3, "the shaders remember six changes before the newest change");
const _: () = assert!(COLUMNS.is_multiple_of(2) && COLUMNS <= 48, "half a row fits into the bits of a float");
const _: () =
    assert!(WIDTH <= 16 && HEIGHT <= 16 && WIDTH < COLUMNS / 2, "the shaders count bits in words of 16");

/// The text of `flash_rules.glsl`.
pub fn rules_glsl() -> String {
    let wholes = [
        ("COLUMNS", COLUMNS),
        ("ROWS", ROWS),
        ("FIELD_COLUMNS", WIDTH),
        ("FIELD_ROWS", HEIGHT),
        ("REACH", REACH),
    ];
    let numbers = [
        ("LIGHT_CHANGE", CAUTIOUS.light_change),
        ("LIGHT_DARKER", CAUTIOUS.light_darker),
        ("SURE_CHANGE", SURE_CHANGE),
        ("SURE_DARKER", SURE_DARKER),
        ("RED_FRACTION", CAUTIOUS.red_fraction),
        ("RED_CHANGE", CAUTIOUS.red_change),
        ("SURE_RED_FRACTION", SURE_RED_FRACTION),
        ("SURE_RED_CHANGE", SURE_RED_CHANGE),
        ("FLARE", FLARE),
        ("ROUNDING", ROUNDING as f32),
        ("AREA", AREA as f32),
        ("HOLD", HOLD as f32),
        ("FRESH", FRESH as f32),
        ("EARLY", EARLY as f32),
        ("SWING", SWING),
        ("FOLLOW", FOLLOW),
        ("RELEASE", RELEASE),
        ("GREY", GREY),
        ("RED_RELEASE", RED_RELEASE),
        ("OPEN", OPEN),
        ("KNEE", KNEE),
        ("CEILING_RISE", CEILING_RISE),
    ];
    let wholes = wholes.map(|(name, value)| format!("const int {name} = {value};\n")).concat();
    let numbers = numbers.map(|(name, value)| format!("const float {name} = {value:?};\n")).concat();
    format!("{wholes}{numbers}const vec2 RED = vec2({:?}, {:?});\n", RED[0], RED[1])
}
