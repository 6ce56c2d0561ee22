//! Keeps the flashes of a picture few: the light that would be the fourth flash within a second is dimmed.
//!
//! Each cell counts the changes of the picture as it comes in and as it is shown. A rise that could begin a fourth
//! flash marks the cell for limiting, for as long as such rises come and a second more. Marked cells are limited
//! where they cover more than a certain share of a field. A limited cell is never brighter than its darkest moment of
//! the last second plus a little, so that a flash goes on as a flicker too faint to count. Afterwards that ceiling
//! rises slowly. Nothing is ever brightened, and no picture is mixed with an earlier one, so moving things leave no
//! trace. Red that flashes loses saturation instead.
//!
//! What counts as a change is taken more widely than in the definition, because light is measured roughly and drawn in
//! whole bytes, and a change that hardly counts is taken to be as late as it may be. A rise that is too early by less
//! than a frame or so is put off until it is not, and nothing else is done about it: three flashes a second that follow
//! the frames would otherwise be limited now and then.

use super::swing::{CAUTIOUS, Change, LightSwing, ROUNDING, RedSwing, Times};
use super::{CELLS, COLUMNS, FLASHES_MAX, Grid, ROWS, fields, luminance};

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

/// How much of the error each round takes back that makes gains at the centres of cells. A pattern of cells' gains
/// keeps 1/4 to all of itself in their means; these are Chebyshev's rates for that, which leave 2.5 % of any error.
pub const CENTRE_RATES: [f32; 4] = [1.301, 2.077, 1.029, 3.59];

/// How much a cell's mean gain may exceed the wanted one.
pub(super) const LEVEL_ERROR: f32 = 0.015;

/// What a limited cell does to its pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Correction {
    /// Factor of linear light at the centre of the cell, 0..1; interpolated linearly between centres of limited
    /// cells.
    pub gain: f32,
    /// Share of the colour that becomes grey, 0..1.
    pub grey: f32,
    /// Whether the cell is changed at all; if not, its pixels stay as they are.
    pub limited: bool,
    /// Whether the gain is the same all over the cell instead.
    pub level: bool,
}

impl Correction {
    const NONE: Self = Self { gain: 1.0, grey: 0.0, limited: false, level: false };
}

#[derive(Clone)]
struct Cell {
    light: LightSwing,
    light_changes: Times,
    light_until: f64,
    /// The luminance that is shown, with its changes.
    shown: LightSwing,
    shown_changes: Times,
    red: RedSwing,
    red_changes: Times,
    red_until: f64,
    /// The red that is shown, with its changes: dimmed, it does not change when the red that comes does.
    shown_red: RedSwing,
    shown_red_changes: Times,
    /// Darkest luminance of the present part of the memory, and of the part before.
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
        if !limited && self.ceiling >= 1.0 {
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
    corrections: Vec<Correction>,
}

impl Default for Limiter {
    fn default() -> Self {
        Self {
            cells: vec![Cell::new(); CELLS],
            now: 0.0,
            steps: Steps::default(),
            corrections: vec![Correction::NONE; CELLS],
        }
    }
}

impl Limiter {
    /// Takes the frame that is shown next, `seconds` after the last one, and returns what to do to its cells:
    /// nothing, or a correction for each of them.
    pub fn limit(&mut self, seconds: f64, frame: &Grid) -> Option<&[Correction]> {
        let Step { seconds, forgets } = self.steps.next(seconds);
        self.now += seconds;
        self.follow(frame, seconds, forgets);
        let now = self.now;
        let wants = |until: fn(&Cell) -> f64| {
            fields::crowded(|cell| self.cells.get(cell).is_some_and(|cell| until(cell) > now), AREA)
        };
        let (light, red) = (wants(|cell| cell.light_until), wants(|cell| cell.red_until));
        let light = self.with_surroundings(&light, frame);
        let mut any = false;
        let cells = self.cells.iter_mut().zip(&mut self.corrections).zip(frame.colors()).enumerate();
        for (place, ((cell, correction), color)) in cells {
            let came = luminance(*color);
            let limited = marked(&light, place);
            cell.move_ceiling(limited && !is_put_off(cell.light_until, now), seconds as f32);
            let mut shown = came.min(cell.ceiling);
            if limited && cell.is_too_much(shown, now, 0.0) {
                shown = shown.min(cell.shown.low() + SWING);
            }
            let limited_red = marked(&red, place) && cell.red_until > now;
            let greys = limited_red && !is_put_off(cell.red_until, now);
            cell.grey = if greys { GREY } else { (cell.grey - RED_RELEASE * seconds as f32).max(0.0) };
            let gain = if shown < came { shown / came } else { 1.0 };
            let with_grey = |grey: f32| color.map(|value| (value + grey * (came - value)) * gain);
            let puts_off = limited_red && cell.is_too_much_red(with_grey(cell.grey), now, 0.0);
            let grey = if puts_off { GREY } else { cell.grey };
            cell.show(shown, with_grey(grey), now);
            *correction = Correction { gain, grey, limited: shown < came || grey > 0.0, level: false };
            any |= correction.limited;
        }
        if !any {
            return None;
        }
        self.make_centres();
        Some(&self.corrections)
    }

    /// The cells of crowded fields that are to be limited, and the cells around them that are brighter than the
    /// limit: otherwise an edge would be seen where a flashing light becomes too faint to count.
    fn with_surroundings(&self, crowded: &[bool], frame: &Grid) -> Vec<bool> {
        let flashes = |(place, cell): (usize, &Cell)| marked(crowded, place) && cell.light_until > self.now;
        let mut limited: Vec<bool> = self.cells.iter().enumerate().map(flashes).collect();
        let mut rim: Vec<usize> = (0..CELLS).filter(|place| marked(&limited, *place)).collect();
        while let Some(place) = rim.pop() {
            for (step, _) in NEIGHBOURS {
                let beside = neighbour(place, step);
                let Some((cell, color)) = self.cells.get(beside).zip(frame.colors().get(beside)) else {
                    continue;
                };
                let joins = marked(crowded, beside) && luminance(*color) > cell.highest();
                if let Some(known) = limited.get_mut(beside).filter(|known| joins && !**known) {
                    *known = true;
                    rim.push(beside);
                }
            }
        }
        limited
    }

    /// Finds the changes, and those that would be too many, `seconds` and `forgets` as in [`Step`].
    fn follow(&mut self, frame: &Grid, seconds: f64, forgets: bool) {
        let now = self.now;
        for (cell, color) in self.cells.iter_mut().zip(frame.colors()) {
            if forgets {
                cell.lows = [f32::INFINITY, cell.lows[0]];
            }
            let light = luminance(*color);
            cell.lows[0] = cell.lows[0].min(light);
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

    /// Turns the gains that cells shall have on average into those at their centres, between which the picture's gain
    /// is linear: a cell's own gain counts for 9/16 of its mean, one beside it for 3/32, one at its corner for 1/64.
    /// Where the gains beside a cell are so large that its mean would be too large whatever its own is, it has one gain
    /// all over.
    fn make_centres(&mut self) {
        let wanted: Vec<f32> = self.corrections.iter().map(|correction| correction.gain).collect();
        for rate in CENTRE_RATES {
            let before = self.corrections.clone();
            for (place, (own, wanted)) in self.corrections.iter_mut().zip(&wanted).enumerate() {
                if own.limited {
                    own.gain += rate * (wanted - mean_gain(&before, place, own.gain));
                }
            }
        }
        for correction in &mut self.corrections {
            correction.gain = correction.gain.clamp(0.0, 1.0);
        }
        let before = self.corrections.clone();
        for (place, (own, wanted)) in self.corrections.iter_mut().zip(wanted).enumerate() {
            own.level = own.limited && mean_gain(&before, place, own.gain) > wanted + LEVEL_ERROR;
            if own.level {
                own.gain = wanted;
            }
        }
    }
}

/// The mean gain of a cell whose centre has this one. A neighbour that is not limited does not count: the cell's own
/// gain reaches to its edge.
fn mean_gain(corrections: &[Correction], place: usize, own: f32) -> f32 {
    let gain = |step| {
        let beside = corrections.get(neighbour(place, step)).filter(|other| other.limited);
        beside.map_or(own, |other| other.gain)
    };
    NEIGHBOURS.iter().map(|(step, share)| share * gain(*step)).sum()
}

fn marked(marks: &[bool], cell: usize) -> bool {
    marks.get(cell).copied().unwrap_or(false)
}

/// A cell and those around it, by columns and rows, with their shares of its mean.
const NEIGHBOURS: [((isize, isize), f32); 9] = [
    ((-1, -1), 0.015_625),
    ((0, -1), 0.093_75),
    ((1, -1), 0.015_625),
    ((-1, 0), 0.093_75),
    ((0, 0), 0.562_5),
    ((1, 0), 0.093_75),
    ((-1, 1), 0.015_625),
    ((0, 1), 0.093_75),
    ((1, 1), 0.015_625),
];

/// The cell beside another one; at the picture's edge the last cell in that direction.
fn neighbour(place: usize, (right, down): (isize, isize)) -> usize {
    let column = (place % COLUMNS).saturating_add_signed(right).min(COLUMNS - 1);
    let row = (place / COLUMNS).saturating_add_signed(down).min(ROWS - 1);
    row * COLUMNS + column
}

#[cfg(test)]
#[path = "limiter_tests.rs"]
mod tests;
