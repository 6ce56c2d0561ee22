//! The numbers by which flashes are found and limited, also as GLSL.

use super::grid::{COLUMNS, FLASHES_MAX, ROWS};

/// Width of a field of view of ten degrees, in cells. A field may be at any position.
pub const FIELD_COLUMNS: usize = COLUMNS / 3;
/// Height of a field, in cells.
pub const FIELD_ROWS: usize = ROWS / 3;
const _: () = assert!(COLUMNS.is_multiple_of(3) && ROWS.is_multiple_of(3), "a field has whole cells");

/// The changes that count.
#[derive(Debug, Clone, Copy)]
pub struct Thresholds {
    /// Smallest change of luminance that counts, as a fraction of the maximum luminance.
    pub light_change: f32,
    /// Changes do not count if their darker state has at least this luminance.
    pub light_darker: f32,
    /// A colour is a saturated red if red makes up at least this fraction of the colour's linear light.
    pub red_fraction: f32,
    /// Smallest change of a red's chromaticity that counts, in the CIE 1976 UCS diagram.
    pub red_change: f32,
}

/// Thresholds that miss no change despite approximate measurements and 8-bit images.
pub const CAUTIOUS: Thresholds =
    Thresholds { light_change: 0.095, light_darker: 0.805, red_fraction: 0.78, red_change: 0.19 };
/// Thresholds above which a change certainly counts, whatever the measurement errors. They are as much stricter than
/// WCAG's as [`CAUTIOUS`] is looser.
pub const SURE: Thresholds =
    Thresholds { light_change: 0.105, light_darker: 0.795, red_fraction: 0.82, red_change: 0.21 };
/// Changes within this time are simultaneous, in seconds.
pub const SIMULTANEOUS: f64 = 0.05;
/// Light that a screen always reflects. Because of it, almost black pixels have no colour.
pub const FLARE: f32 = 0.01;
/// Chromaticity of sRGB's red.
pub const RED: [f32; 2] = [0.4507, 0.5229];

/// Tolerance, in seconds, for comparing frame times, which are rounded.
pub const ROUNDING: f64 = 1e-6;
/// Fraction of a field above which flashes are limited. It is a little less than WCAG's quarter.
pub const AREA: f64 = 0.2;
/// Seconds for which a cell stays marked. The last [`EARLY`] of them do not count.
pub const HOLD: f64 = 1.0 + EARLY;
/// A mark that has at least this many seconds left is new: its rise is simultaneous with rises now. Rises are dated up
/// to a fiftieth of a second too early or too late.
pub const FRESH: f64 = HOLD - SIMULTANEOUS - 0.02;
/// Margin between a cell's lowest luminance and its ceiling. A change of this size is too small for a flash.
pub const SWING: f32 = 0.07;
/// Half of the time for which the lowest luminance is remembered, in seconds.
const MEMORY: f64 = 0.6;
/// Rise of the ceiling in luminance per second if the lowest luminance rises.
pub const FOLLOW: f32 = 0.25;
/// The same after the flashes.
pub const RELEASE: f32 = 0.5;
/// Fraction of grey that is mixed into a limited red, so that the red is no longer saturated.
pub const GREY: f32 = 0.6;
/// Decrease per second of the fraction of grey, after the flashes.
pub const RED_RELEASE: f32 = 0.6;
/// A rise at most this many seconds too early is delayed, not limited: by one frame at 30 frames a second.
pub const EARLY: f64 = 0.035;

/// A ceiling of this height dims nothing.
pub const OPEN: f32 = 1.25;
/// Light below this fraction of the ceiling does not change. Brighter light is compressed below the ceiling.
pub const KNEE: f32 = 0.8;
/// Distance in cells over which a ceiling spreads. Adjacent cells get the ceiling unchanged.
pub const REACH: usize = 7;
/// Rise of a ceiling per squared distance beyond the adjacent cell. The fraction of grey falls by the same number.
pub const CEILING_RISE: f32 = OPEN / ((REACH - 1) * (REACH - 1)) as f32;

/// The limit on the light at a cell's centre. Limits are interpolated linearly between centres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Correction {
    /// Maximum luminance of a pixel. The highest ceiling, 1.25, dims nothing.
    pub ceiling: f32,
    /// Fraction of the colour that becomes grey, 0..1.
    pub grey: f32,
}

/// The time between two frames, as the limiter needs it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// Seconds since the previous frame.
    pub seconds: f64,
    /// True if the current half of the memory ends and a new half begins.
    pub forgets: bool,
}

/// Computes [`Step`]s from the times between frames.
#[derive(Debug, Clone, Default)]
pub struct Steps {
    /// Seconds since the current half of the memory began.
    memory: f64,
}

impl Steps {
    /// The step to a frame that is shown `seconds` after the previous frame.
    pub fn next(&mut self, seconds: f64) -> Step {
        let seconds = if seconds.is_finite() { seconds.clamp(0.0, 60.0) } else { 0.0 };
        self.memory += seconds;
        let forgets = self.memory >= MEMORY;
        if forgets {
            self.memory = 0.0;
        }
        Step { seconds, forgets }
    }
}

const _: () = assert!(FLASHES_MAX == 3, "the shaders remember six changes before the newest change");
const _: () = assert!(COLUMNS.is_multiple_of(2) && COLUMNS <= 48, "half a row fits into the bits of a float");
const _: () = assert!(
    FIELD_COLUMNS <= 16 && FIELD_ROWS <= 16 && FIELD_COLUMNS < COLUMNS / 2,
    "the shaders count bits in words of 16"
);

/// The text of `flash_rules.glsl`.
pub fn rules_glsl() -> String {
    let wholes = [
        ("COLUMNS", COLUMNS),
        ("ROWS", ROWS),
        ("FIELD_COLUMNS", FIELD_COLUMNS),
        ("FIELD_ROWS", FIELD_ROWS),
        ("REACH", REACH),
    ];
    let numbers = [
        ("LIGHT_CHANGE", CAUTIOUS.light_change),
        ("LIGHT_DARKER", CAUTIOUS.light_darker),
        ("SURE_CHANGE", SURE.light_change),
        ("SURE_DARKER", SURE.light_darker),
        ("RED_FRACTION", CAUTIOUS.red_fraction),
        ("RED_CHANGE", CAUTIOUS.red_change),
        ("SURE_RED_FRACTION", SURE.red_fraction),
        ("SURE_RED_CHANGE", SURE.red_change),
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
