//! Keeps the flashes of a picture few: the light that would be the fourth flash within a second is dimmed.
//!
//! Each cell counts the changes of the picture as it comes in and as it is shown. A rise that could begin a fourth
//! flash marks the cell for limiting, for as long as such rises come and a second more. Marked cells are limited
//! where they cover more than a certain share of a field. A limited cell gets a ceiling: its darkest moment of the last
//! second plus a little, so that a flash continues as a flicker too faint to count. Afterwards the ceiling rises slowly.
//! Red that flashes loses saturation instead.
//!
//! **No cell has an edge.** Ceilings spread over the cells around them, higher with the square of the distance, and are
//! interpolated between cells. No pixel is brighter than the ceiling at its place, so no cell is brighter than its own
//! ceiling on average, and a pixel depends on nothing but its own light and on ceilings, which rise slowly: what is dimmed
//! beside a flash does not flicker with it.
//!
//! **What is counted is what is shown.** The mean colours of the dimmed picture are measured again
//! ([`Limiter::note_shown`]), and the ceilings of the next frame follow from those.
//!
//! Light is measured roughly and drawn in whole bytes. Thresholds are therefore lower than those of the definition, and
//! a change that hardly counts is dated as late as possible. A rise that is too early by less than a frame or so is only
//! put off until it is not: three flashes a second that follow the frames would otherwise be limited now and then.

use super::fields;
use super::grid::{CELLS, COLUMNS, FLASHES_MAX, Grid, ROWS, luminance};
use super::swing::{CAUTIOUS, Change, LightSwing, ROUNDING, RedSwing, Times};

/// Share of a field from which on flashes are limited: somewhat less than the share that counts.
pub(super) const AREA: f64 = 0.2;
/// Changes within a second; if the last of this many is a rise, it begins one flash too many.
const CHANGES: usize = 2 * FLASHES_MAX + 1;
/// For how many seconds a cell stays marked for limiting.
pub(super) const HOLD: f64 = 1.0;
/// How much brighter than its darkest moment a limited cell may be: somewhat less than counts as a flash.
pub(super) const SWING: f32 = 0.07;
/// Half of the time for which a darkest moment is remembered, in seconds.
const MEMORY: f64 = 0.6;
/// How fast a ceiling rises when the darkest moments have become brighter, and after the last flash, in luminance per
/// second.
pub(super) const FOLLOW: f32 = 0.25;
pub(super) const RELEASE: f32 = 0.5;
/// Share of grey in a limited red: with this much grey no red is saturated.
pub(super) const GREY: f32 = 0.6;
/// How fast a limited red recovers, in share of grey per second.
pub(super) const RED_RELEASE: f32 = 0.6;
/// A rise that comes early by at most this many seconds is only put off: a frame, of 30 or more a second.
pub(super) const EARLY: f64 = 0.035;

/// A ceiling this high dims nothing.
pub(super) const OPEN: f32 = 1.25;
/// Share of the ceiling up to which light stays as it is; brighter light approaches the ceiling.
pub(super) const KNEE: f32 = 0.8;
/// How far a ceiling spreads, in cells; the cells next to its own have it, too.
pub(super) const REACH: usize = 7;
/// How much a ceiling rises, and a share of grey falls, with the square of the distance beyond the next cell.
pub(super) const CEILING_RISE: f32 = OPEN / ((REACH - 1) * (REACH - 1)) as f32;

/// How the light of a cell is limited, at its centre; interpolated linearly between the centres of cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Correction {
    /// Luminance that no pixel exceeds, up to 1.25, which dims nothing.
    pub ceiling: f32,
    /// Share of the colour that becomes grey, 0..1.
    pub grey: f32,
}

impl Correction {
    const NONE: Self = Self { ceiling: OPEN, grey: 0.0 };

    /// Whether pixels at this place may change.
    pub fn limits(&self) -> bool {
        self.ceiling < OPEN || self.grey > 0.0
    }

    /// The linear light that is shown in place of `color`.
    pub fn apply(&self, color: [f32; 3]) -> [f32; 3] {
        let light = luminance(color);
        let gain = if light > 0.0 { below_ceiling(light, self.ceiling) / light } else { 1.0 };
        color.map(|value| (value + self.grey * (light - value)) * gain)
    }
}

/// The luminance that is shown of `light`: at most the ceiling.
fn below_ceiling(light: f32, ceiling: f32) -> f32 {
    let (knee, rest) = (KNEE * ceiling, (1.0 - KNEE) * ceiling);
    if light > knee { ceiling - rest * (-(light - knee) / rest).exp() } else { light }
}

#[derive(Clone)]
struct Cell {
    light: LightSwing,
    light_changes: Times,
    light_until: f64,
    /// The luminance that was shown, with its changes.
    shown: LightSwing,
    shown_changes: Times,
    red: RedSwing,
    red_changes: Times,
    red_until: f64,
    /// The red that is shown, with its changes: dimmed, it does not change when the red that comes does.
    shown_red: RedSwing,
    shown_red_changes: Times,
    /// Darkest luminance that was shown in the present part of the memory, and in the part before.
    lows: [f32; 2],
    /// Highest luminance; infinite if the cell is not limited.
    ceiling: f32,
    grey: f32,
}

impl Cell {
    const fn new() -> Self {
        Self {
            light: LightSwing::NEW,
            light_changes: Times::NEW,
            light_until: 0.0,
            shown: LightSwing::NEW,
            shown_changes: Times::NEW,
            red: RedSwing::NEW,
            red_changes: Times::NEW,
            red_until: 0.0,
            shown_red: RedSwing::NEW,
            shown_red_changes: Times::NEW,
            lows: [f32::INFINITY; 2],
            ceiling: f32::INFINITY,
            grey: 0.0,
        }
    }

    /// The highest luminance of a limited cell.
    fn highest(&self) -> f32 {
        self.lows[0].min(self.lows[1]) + SWING
    }

    /// Moves the ceiling of the luminance to where it belongs `seconds` later.
    fn move_ceiling(&mut self, limited: bool, seconds: f32) {
        self.ceiling = match limited {
            true => self.highest().min(self.ceiling + FOLLOW * seconds),
            false => self.ceiling + RELEASE * seconds,
        };
        if !limited && self.ceiling >= OPEN {
            self.ceiling = f32::INFINITY;
        }
    }

    /// Whether showing this luminance would begin one flash too many.
    fn is_too_much(&self, light: f32, now: f64, early: f64) -> bool {
        let mut shown = self.shown;
        shown.step(light, &CAUTIOUS) == Some(Change::Up)
            && self.shown_changes.count(now, early) + 1 >= CHANGES
    }

    /// The same of a red.
    fn is_too_much_red(&self, color: [f32; 3], now: f64, early: f64) -> bool {
        let mut shown = self.shown_red;
        shown.step(color, &CAUTIOUS) == Some(Change::Up)
            && self.shown_red_changes.count(now, early) + 1 >= CHANGES
    }

    /// Notes what is shown.
    fn show(&mut self, light: f32, color: [f32; 3], now: f64) {
        let renews = self.shown.may_count_only_at(light, &CAUTIOUS);
        if self.shown.step(light, &CAUTIOUS).is_some() {
            self.shown_changes.note(now);
        } else if renews {
            self.shown_changes.renew(now);
        }
        let renews = self.shown_red.may_count_only_at(color, &CAUTIOUS);
        if self.shown_red.step(color, &CAUTIOUS).is_some() {
            self.shown_red_changes.note(now);
        } else if renews {
            self.shown_red_changes.renew(now);
        }
    }
}

/// Whether a cell that is marked until then is so only because a rise is put off.
fn is_put_off(until: f64, now: f64) -> bool {
    until > now && until - now <= EARLY + ROUNDING
}

/// What the time between two frames means for the limiter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// Seconds since the frame before.
    pub seconds: f64,
    /// Whether a part of the memory of dark moments ends.
    pub forgets: bool,
}

/// Makes [`Step`]s of the times between frames.
#[derive(Debug, Clone, Default)]
pub struct Steps {
    /// Seconds since the present part of the memory began.
    memory: f64,
}

impl Steps {
    /// The step to a frame that is shown `seconds` after the last one.
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

/// Keeps the flashes of a picture few, frame by frame, on the processor: what `gpu::flash_pass` does on the GPU, to
/// compare it with.
pub struct Limiter {
    cells: Vec<Cell>,
    now: f64,
    steps: Steps,
    step: Step,
    corrections: Vec<Correction>,
}

impl Default for Limiter {
    fn default() -> Self {
        Self {
            cells: vec![Cell::new(); CELLS],
            now: 0.0,
            steps: Steps::default(),
            step: Step { seconds: 0.0, forgets: false },
            corrections: vec![Correction::NONE; CELLS],
        }
    }
}

impl Limiter {
    /// Takes the frame that is shown next, `seconds` after the last one, and returns what to do to its cells. What is
    /// then shown goes to [`Limiter::note_shown`].
    pub fn limit(&mut self, seconds: f64, frame: &Grid) -> &[Correction] {
        self.step = self.steps.next(seconds);
        let seconds = self.step.seconds;
        self.now += seconds;
        self.follow(frame, seconds);
        let now = self.now;
        let wants = |until: fn(&Cell) -> f64| {
            fields::crowded(|cell| self.cells.get(cell).is_some_and(|cell| until(cell) > now), AREA)
        };
        let (light, red) = (wants(|cell| cell.light_until), wants(|cell| cell.red_until));
        let mut own = vec![Own::NONE; CELLS];
        for (place, ((cell, own), color)) in
            self.cells.iter_mut().zip(&mut own).zip(frame.colors()).enumerate()
        {
            let came = luminance(*color);
            let limited = marked(&light, place) && cell.light_until > now;
            cell.move_ceiling(limited && !is_put_off(cell.light_until, now), seconds as f32);
            let mut shown = came.min(cell.ceiling);
            let mut highest = f32::INFINITY;
            if limited && cell.is_too_much(shown, now, 0.0) {
                highest = cell.shown.low() + SWING;
                shown = shown.min(highest);
            }
            let limited_red = marked(&red, place) && cell.red_until > now;
            let greys = limited_red && !is_put_off(cell.red_until, now);
            cell.grey = if greys { GREY } else { (cell.grey - RED_RELEASE * seconds as f32).max(0.0) };
            let gain = if shown < came { shown / came } else { 1.0 };
            let likely = color.map(|value| (value + cell.grey * (came - value)) * gain);
            let puts_off_red = limited_red && cell.is_too_much_red(likely, now, 0.0);
            let grey = if puts_off_red { GREY } else { cell.grey };
            *own = Own { ceiling: cell.ceiling, highest, grey };
        }
        if own.iter().any(Own::limits) {
            own = spread(&spread(&own, |at| (at, 0)), |at| (0, at));
        }
        for (correction, own) in self.corrections.iter_mut().zip(own) {
            *correction = Correction { ceiling: own.ceiling.min(own.highest).min(OPEN), grey: own.grey };
        }
        &self.corrections
    }

    /// Takes the mean colours of the frame as it is shown, after [`Limiter::limit`].
    pub fn note_shown(&mut self, shown: &Grid) {
        for (cell, color) in self.cells.iter_mut().zip(shown.colors()) {
            if self.step.forgets {
                cell.lows = [f32::INFINITY, cell.lows[0]];
            }
            let light = luminance(*color);
            cell.lows[0] = cell.lows[0].min(light);
            cell.show(light, *color, self.now);
        }
    }

    /// Finds the changes, and those that would be too many, `seconds` after the last frame.
    fn follow(&mut self, frame: &Grid, seconds: f64) {
        let now = self.now;
        for (cell, color) in self.cells.iter_mut().zip(frame.colors()) {
            let light = luminance(*color);
            let kinds = [
                (cell.light.step(light, &CAUTIOUS), &mut cell.light_changes, &mut cell.light_until),
                (cell.red.step(*color, &CAUTIOUS), &mut cell.red_changes, &mut cell.red_until),
            ];
            for (change, times, until) in kinds {
                let Some(change) = change else { continue };
                times.note(now);
                if change == Change::Up && times.count(now, EARLY) >= CHANGES {
                    *until = now + HOLD;
                }
            }
            // At most as bright, and at most as red, as it may be shown.
            let shown = light.min(cell.ceiling + RELEASE * seconds as f32);
            for (early, hold) in [(0.0, EARLY), (EARLY, HOLD)] {
                if cell.is_too_much(shown, now, early) {
                    cell.light_until = cell.light_until.max(now + hold);
                }
                if cell.is_too_much_red(*color, now, early) {
                    cell.red_until = cell.red_until.max(now + hold);
                }
            }
        }
    }
}

/// What a cell itself asks for, before it spreads.
#[derive(Debug, Clone, Copy)]
struct Own {
    /// See [`Cell::ceiling`].
    ceiling: f32,
    /// The highest luminance while a rise is put off. It lasts a frame or two, so only the next cells have it, too.
    highest: f32,
    grey: f32,
}

impl Own {
    const NONE: Self = Self { ceiling: f32::INFINITY, highest: f32::INFINITY, grey: 0.0 };

    fn limits(&self) -> bool {
        self.ceiling.min(self.highest) < OPEN || self.grey > 0.0
    }
}

/// Spreads what cells ask for along one axis: the steps to a cell at some distance from -7 to 7.
fn spread(own: &[Own], step: impl Fn(isize) -> (isize, isize)) -> Vec<Own> {
    let reach = REACH as isize;
    let spread = |place: usize| {
        let mut all = Own::NONE;
        for at in -reach..=reach {
            let Some(other) = own.get(neighbour(place, step(at))) else { continue };
            let beyond = (at.unsigned_abs().max(1) - 1) as f32;
            let rise = CEILING_RISE * beyond * beyond;
            all.ceiling = all.ceiling.min(other.ceiling + rise);
            all.grey = all.grey.max(other.grey - rise);
            if at.abs() <= 1 {
                all.highest = all.highest.min(other.highest);
            }
        }
        all
    };
    (0..own.len()).map(spread).collect()
}

fn marked(marks: &[bool], cell: usize) -> bool {
    marks.get(cell).copied().unwrap_or(false)
}

/// The cell beside another one; at the picture's edge the last cell in that direction.
fn neighbour(place: usize, (right, down): (isize, isize)) -> usize {
    let column = (place % COLUMNS).saturating_add_signed(right).min(COLUMNS - 1);
    let row = (place / COLUMNS).saturating_add_signed(down).min(ROWS - 1);
    row * COLUMNS + column
}

#[cfg(test)]
#[path = "limiter_tests.rs"]
mod tests;
