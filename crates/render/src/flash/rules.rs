//! The limiter's constants as GLSL, shared with [`super::Limiter`].

use super::fields::{HEIGHT, WIDTH};
use super::grid::{COLUMNS, FLASHES_MAX, ROWS};
use super::limiter::{
    AREA, CEILING_RISE, EARLY, FOLLOW, FRESH, GREY, HOLD, KNEE, OPEN, REACH, RED_RELEASE, RELEASE, SWING,
};
use super::swing::{
    CAUTIOUS, FLARE, RED, ROUNDING, SURE_CHANGE, SURE_DARKER, SURE_RED_CHANGE, SURE_RED_FRACTION,
};

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
