//! The rules by which flashes are limited, as defined by WCAG 2.3.1.
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
//! without reading back, so that even the frame that begins the flash is dimmed. `tests/flash_twin` does the
//! same on the CPU, and tests compare both. The limiter only darkens and never mixes in older frames, so a limited frame
//! is not smeared.
//!
//! Measured light is approximate, and drawn light is rounded to bytes. Thresholds are therefore lower than WCAG's, and
//! a borderline change is dated as late as possible. A rise that is too early by about a frame is only delayed by a
//! frame. Otherwise three flashes a second in step with the frames would sometimes be limited.

/// Cells from left to right. A field of view spans a third of them.
pub const COLUMNS: usize = 48;
/// Cells from top to bottom.
pub const ROWS: usize = 36;
/// Cells of a grid.
pub const CELLS: usize = COLUMNS * ROWS;
/// Cells of a field of view from left to right.
pub const FIELD_COLUMNS: usize = COLUMNS / 3;
/// Cells of a field of view from top to bottom.
pub const FIELD_ROWS: usize = ROWS / 3;

/// Maximum number of flashes of a kind, general or red, that are allowed in one second.
pub const FLASHES_MAX: usize = 3;

/// The smallest changes that count.
#[derive(Debug, Clone, Copy)]
pub struct Thresholds {
    /// Smallest change of luminance, as a fraction of the maximum luminance.
    pub light_change: f32,
    /// Changes do not count if their darker state has at least this luminance.
    pub light_darker: f32,
    /// A colour is a saturated red if red makes up at least this fraction of the colour's linear light.
    pub red_fraction: f32,
    /// Smallest change of a red's chromaticity, in the CIE 1976 UCS diagram.
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
/// Rise of the ceiling in luminance per second while the lowest luminance rises.
pub const FOLLOW: f32 = 0.25;
/// Rise of the ceiling in luminance per second after flashes.
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

const _: () = assert!(COLUMNS.is_multiple_of(3) && ROWS.is_multiple_of(3), "a field has whole cells");
const _: () = assert!(FLASHES_MAX == 3, "the shaders remember six changes before the newest change");
const _: () = assert!(COLUMNS.is_multiple_of(2) && COLUMNS <= 48, "half a row fits into the bits of a float");
const _: () = assert!(FIELD_COLUMNS <= 16 && FIELD_ROWS <= 16, "the shaders count bits in words of 16");

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
