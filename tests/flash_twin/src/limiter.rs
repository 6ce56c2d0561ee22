//! Limits the flashes of a video: dims light that would cause a fourth flash within a second.
//!
//! Each cell counts the changes of the incoming and of the displayed frames. A rise that could begin a fourth flash
//! marks the cell for a second. If more than a certain fraction of a field is marked at the same time, its marked cells
//! are limited until their marks end. The limit is a ceiling: the lowest luminance of the last second plus a margin too
//! small to count as a flash. After the flashes the ceiling rises slowly. Flashing red is limited by removing saturation.
//!
//! **Limits have no visible edges.** A ceiling spreads over neighbouring cells, where it rises with the squared
//! distance. Ceilings are interpolated between cells, so a cell's mean does not exceed its own ceiling. A pixel depends
//! only on its own light and on ceilings, so dimmed pixels next to a flash do not flicker with it.
//!
//! **The displayed frames count**: each frame is measured again after dimming ([`Limiter::record_shown`]).

use mariana_render::flash::{
    AREA, CAUTIOUS, CEILING_RISE, CELLS, COLUMNS, EARLY, FLASHES_MAX, FOLLOW, FRESH, GREY, HOLD, KNEE, OPEN,
    REACH, RED_RELEASE, RELEASE, ROUNDING, ROWS, SWING, Step, Steps,
};

use super::fields::{self, Grid, luminance};
use super::swing::{Change, LightSwing, RedSwing, Times};

/// If a second contains this many changes and the last change is a rise, the rise begins one flash too many.
const CHANGES: usize = 2 * FLASHES_MAX + 1;

/// The limit on the light at a cell's centre. Limits are interpolated linearly between centres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Correction {
    /// Maximum luminance of a pixel. The highest ceiling, 1.25, dims nothing.
    pub ceiling: f32,
    /// Fraction of the colour that becomes grey, 0..1.
    pub grey: f32,
}

impl Correction {
    const NONE: Self = Self { ceiling: OPEN, grey: 0.0 };

    /// True if pixels at this cell may change.
    pub fn limits(&self) -> bool {
        self.ceiling < OPEN || self.grey > 0.0
    }

    /// Limits a linear colour.
    pub fn apply(&self, color: [f32; 3]) -> [f32; 3] {
        let light = luminance(color);
        let gain = if light > 0.0 { below_ceiling(light, self.ceiling) / light } else { 1.0 };
        color.map(|value| (value + self.grey * (light - value)) * gain)
    }
}

fn below_ceiling(light: f32, ceiling: f32) -> f32 {
    let (knee, rest) = (KNEE * ceiling, (1.0 - KNEE) * ceiling);
    if light > knee { ceiling - rest * (-(light - knee) / rest).exp() } else { light }
}

#[derive(Clone)]
struct Cell {
    light: LightSwing,
    light_changes: Times,
    light_until: f64,
    light_limited: bool,
    shown: LightSwing,
    shown_changes: Times,
    red: RedSwing,
    red_changes: Times,
    red_until: f64,
    red_limited: bool,
    /// The displayed red and its changes. Dimming can make these changes differ from the input's.
    shown_red: RedSwing,
    shown_red_changes: Times,
    /// Lowest displayed luminance in the current half of the memory, and in the previous half.
    lows: [f32; 2],
    /// Maximum luminance. It is infinite if the cell is not limited.
    ceiling: f32,
    grey: f32,
}

impl Cell {
    const fn new() -> Self {
        Self {
            light: LightSwing::NEW,
            light_changes: Times::NEW,
            light_until: 0.0,
            light_limited: false,
            shown: LightSwing::NEW,
            shown_changes: Times::NEW,
            red: RedSwing::NEW,
            red_changes: Times::NEW,
            red_until: 0.0,
            red_limited: false,
            shown_red: RedSwing::NEW,
            shown_red_changes: Times::NEW,
            lows: [f32::INFINITY; 2],
            ceiling: f32::INFINITY,
            grey: 0.0,
        }
    }

    fn highest(&self) -> f32 {
        self.lows[0].min(self.lows[1]) + SWING
    }

    fn move_ceiling(&mut self, limited: bool, seconds: f32) {
        self.ceiling = match limited {
            true => self.highest().min(self.ceiling + FOLLOW * seconds),
            false => self.ceiling + RELEASE * seconds,
        };
        if !limited && self.ceiling >= OPEN {
            self.ceiling = f32::INFINITY;
        }
    }

    /// True if displaying this luminance would begin one flash too many.
    fn is_too_much(&self, light: f32, now: f64, early: f64) -> bool {
        let mut shown = self.shown;
        shown.step(light, &CAUTIOUS) == Some(Change::Up)
            && self.shown_changes.count(now, early) + 1 >= CHANGES
    }

    fn is_too_much_red(&self, color: [f32; 3], now: f64, early: f64) -> bool {
        let mut shown = self.shown_red;
        shown.step(color, &CAUTIOUS) == Some(Change::Up)
            && self.shown_red_changes.count(now, early) + 1 >= CHANGES
    }

    fn show(&mut self, light: f32, color: [f32; 3], now: f64) {
        let renews = self.shown.may_count_only_at(light, &CAUTIOUS);
        if self.shown.step(light, &CAUTIOUS).is_some() {
            self.shown_changes.add(now);
        } else if renews {
            self.shown_changes.renew(now);
        }
        let renews = self.shown_red.may_count_only_at(color, &CAUTIOUS);
        if self.shown_red.step(color, &CAUTIOUS).is_some() {
            self.shown_red_changes.add(now);
        } else if renews {
            self.shown_red_changes.renew(now);
        }
    }
}

/// Returns true if a mark that ends at `until` only delays a rise.
fn is_put_off(until: f64, now: f64) -> bool {
    until > now && until - now <= EARLY + ROUNDING
}

/// True if a mark that ends at `until` began now.
fn is_fresh(until: f64, now: f64) -> bool {
    is_put_off(until, now) || until - now >= FRESH
}

/// The flash limiter on the CPU: a reference for `gpu::flash_pass`, which does the same on the GPU.
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
    /// Takes the next frame, shown `seconds` after the previous frame, and returns a correction for each cell. Pass the
    /// corrected frame to [`Limiter::record_shown`].
    pub fn limit(&mut self, seconds: f64, frame: &Grid) -> &[Correction] {
        self.step = self.steps.next(seconds);
        let seconds = self.step.seconds;
        self.now += seconds;
        self.follow(frame, seconds);
        let now = self.now;
        let wants = |mark: fn(&Cell) -> (Option<Change>, f64)| {
            let is_rising = |cell| {
                let (last, until) = mark(cell);
                last == Some(Change::Up) && is_fresh(until, now)
            };
            fields::crowded(|cell| self.cells.get(cell).is_some_and(is_rising), AREA)
        };
        let light = wants(|cell| (cell.light.last, cell.light_until));
        let red = wants(|cell| (cell.red.last(), cell.red_until));
        let mut own = vec![Own::NONE; CELLS];
        for (place, ((cell, own), color)) in
            self.cells.iter_mut().zip(&mut own).zip(frame.colors()).enumerate()
        {
            let came = luminance(*color);
            let limited = cell.light_until > now && (marked(&light, place) || cell.light_limited);
            cell.light_limited = limited;
            cell.move_ceiling(limited && !is_put_off(cell.light_until, now), seconds as f32);
            let mut shown = came.min(cell.ceiling);
            let mut highest = f32::INFINITY;
            if limited && cell.is_too_much(shown, now, 0.0) {
                highest = cell.shown.low + SWING;
                shown = shown.min(highest);
            }
            let limited_red = cell.red_until > now && (marked(&red, place) || cell.red_limited);
            cell.red_limited = limited_red;
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

    /// Records the mean colours of the displayed frame. Call it after [`Limiter::limit`].
    pub fn record_shown(&mut self, shown: &Grid) {
        for (cell, color) in self.cells.iter_mut().zip(shown.colors()) {
            if self.step.forgets {
                cell.lows = [f32::INFINITY, cell.lows[0]];
            }
            let light = luminance(*color);
            cell.lows[0] = cell.lows[0].min(light);
            cell.show(light, *color, self.now);
        }
    }

    /// Finds the changes in `frame`, `seconds` after the previous frame, and marks cells with too many changes.
    fn follow(&mut self, frame: &Grid, seconds: f64) {
        let now = self.now;
        for (cell, color) in self.cells.iter_mut().zip(frame.colors()) {
            let light = luminance(*color);
            let kinds = [
                (cell.light.step(light, &CAUTIOUS), &mut cell.light_changes, &mut cell.light_until),
                (cell.red.step(*color, &CAUTIOUS), &mut cell.red_changes, &mut cell.red_until),
            ];
            for (change, times, until) in kinds {
                if is_put_off(*until, now) {
                    *until = now;
                }
                let Some(change) = change else { continue };
                times.add(now);
                if change == Change::Up && times.count(now, EARLY) >= CHANGES {
                    *until = now + HOLD;
                }
            }
            // Upper bounds of the displayed brightness and redness.
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

#[derive(Debug, Clone, Copy)]
struct Own {
    ceiling: f32,
    /// Maximum luminance while a rise is delayed. It spreads only to adjacent cells, because a delay is short.
    highest: f32,
    grey: f32,
}

impl Own {
    const NONE: Self = Self { ceiling: f32::INFINITY, highest: f32::INFINITY, grey: 0.0 };

    fn limits(&self) -> bool {
        self.ceiling.min(self.highest) < OPEN || self.grey > 0.0
    }
}

/// Spreads limits along one axis. `step` converts a distance from -7 to 7 to the offset of a cell.
fn spread(own: &[Own], step: impl Fn(isize) -> (isize, isize)) -> Vec<Own> {
    let reach = REACH as isize;
    let spread = |place: usize| {
        let mut all = Own::NONE;
        for at in -reach..=reach {
            let (right, down) = step(at);
            let Some(other) = own.get(neighbour(place, right, down)) else { continue };
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

/// Returns the cell at an offset from `place`, or the last cell in that direction inside the image.
fn neighbour(place: usize, right: isize, down: isize) -> usize {
    let column = (place % COLUMNS).saturating_add_signed(right).min(COLUMNS - 1);
    let row = (place / COLUMNS).saturating_add_signed(down).min(ROWS - 1);
    row * COLUMNS + column
}

#[cfg(test)]
#[path = "limiter_tests.rs"]
mod tests;
