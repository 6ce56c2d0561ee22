//! Keeps the window's frame rate: slow frames get fewer pixels and cheaper shading; when there is time left, both are
//! restored.
//!
//! A pure controller: it takes frame times and costs, and returns a level. It reduces the level within a quarter of a
//! second, by as many steps as needed, and raises it by one step after a few seconds without a slow frame. After a step
//! that proved too early, it waits longer before the next, so that the level does not oscillate.
//!
//! **Only the window adapts.** Stills, videos, measurements and the frame of an idle show use the best level. A level
//! sets the number of pixels, which `upscale.frag` enlarges, and the shaders' `frame_quality`, which makes costly but
//! hardly visible shading cheaper. The cost of a frame is the time reported by the GPU's timer, or the wall time with a
//! software renderer.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use crate::config::{Choice, QualityChoice};
use crate::gpu::edge_samples::EdgeSamples;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Level {
    /// Fraction of the window's width and height that is drawn, 0..1; the rest is interpolated.
    pub scale: f64,
    pub quality: f32,
    pub edges: EdgeSamples,
}

const fn moving(scale: f64, quality: f32) -> Level {
    Level { scale, quality, edges: EdgeSamples::Two }
}

/// The levels, the best one first. Each costs about a fifth less than the previous one, so that a step is not visible.
///
/// Two samples at edges instead of four save as much time as 0.92 of the width and height does, and the image stays up
/// to 5 dB closer to 64 samples in every pixel (`mariana bench --edges`).
const LEVELS: [Level; 15] = [
    Level { scale: 1.0, quality: 1.0, edges: EdgeSamples::Four },
    moving(1.0, 1.0),
    moving(0.92, 0.8),
    moving(0.84, 0.8),
    moving(0.77, 0.6),
    moving(0.70, 0.6),
    moving(0.64, 0.4),
    moving(0.58, 0.4),
    moving(0.52, 0.2),
    moving(0.46, 0.2),
    moving(0.41, 0.0),
    moving(0.36, 0.0),
    moving(0.32, 0.0),
    moving(0.28, 0.0),
    moving(0.25, 0.0),
];
/// Sides of at most this many pixels are not reduced.
const SIDE_MIN: u32 = 16;
const HIGH: usize = 3;
const MEDIUM: usize = 6;
const LOW: usize = 9;
/// The first level with visible losses. It is used only if better levels stay below [`FPS_USABLE`].
const POOR: usize = 9;
/// Below this many frames per second a show does not seem to move.
const FPS_USABLE: f64 = 24.0;

/// Before the level is reduced, the frames of this time span are examined, and at least this many frames.
const LOOK: (Duration, usize) = (Duration::from_millis(250), 3);
/// Two frames in a row that take this many times as long as allowed reduce the level at once.
const FAR_TOO_LONG: f64 = 4.0;
/// Initial and maximum time without slow frames before a better level is tried.
const PATIENCE: (Duration, Duration) = (Duration::from_secs(2), Duration::from_secs(64));
const PATIENCE_FRAMES: usize = 8;
/// If a better level must be reduced again within this time, it was tried too early.
const TOO_EARLY: Duration = Duration::from_secs(12);
/// If a better level holds for this time, the initial [`PATIENCE`] applies again.
const FORGOTTEN: Duration = Duration::from_secs(60);
const FRAMES_MAX: usize = 4096;
/// Number of frames ignored after a change of level: they also create targets, and GPU times arrive late.
const SETTLING: usize = 1;
/// Cost of a frame with two samples at edges, relative to four.
const TWO_SAMPLES: f64 = 0.8;
/// After a longer gap without frames, earlier costs are ignored.
const PAUSE: Duration = Duration::from_secs(3);
/// Fractions of the time allowed for a frame. The controller reduces the level above `FULL`, aims at `AIM`, and raises
/// the level if the cost would stay below `FREE`.
const FULL: f64 = 0.97;
const AIM: f64 = 0.8;
const FREE: f64 = 0.72;
/// If a lower level saves less than this fraction of the cost, pixels are not the bottleneck.
const HELP: f64 = 0.1;
/// Initial and maximum time for which a level is kept because fewer pixels do not help.
const HELPLESS: (Duration, Duration) = (Duration::from_secs(10), Duration::from_secs(320));

impl Level {
    /// The level of a frame that may take as long as it needs.
    pub(crate) const STILL: Self = Self { scale: 1.0, quality: 1.0, edges: EdgeSamples::Sixteen };

    /// Returns the size of a frame for a window of `window` pixels. Short sides are not reduced.
    pub(crate) fn size_in(self, window: (u32, u32)) -> (u32, u32) {
        let side =
            |pixels: u32| ((f64::from(pixels) * self.scale).round() as u32).max(pixels.clamp(1, SIDE_MIN));
        (side(window.0), side(window.1))
    }

    /// Approximate cost relative to the best level.
    fn cost(self) -> f64 {
        let edges = if self.edges == EdgeSamples::Two { TWO_SAMPLES } else { 1.0 };
        self.scale * self.scale * (0.85 + 0.15 * f64::from(self.quality)) * edges
    }
}

fn level_at(index: usize) -> Level {
    LEVELS.get(index).copied().unwrap_or(LEVELS[0])
}

#[derive(Debug, Clone, Default)]
pub(crate) struct DynamicResolution {
    choice: QualityChoice,
    /// Seconds per frame.
    interval: f64,
    level: usize,
    /// Times and costs in seconds of the last frames at this level.
    frames: VecDeque<(Instant, f64)>,
    settling: usize,
    /// True until the first valid cost, which alone chooses the level.
    begins: bool,
    /// True once the driver has had no memory for a frame.
    lacks_room: bool,
    last: Option<Instant>,
    patience: Duration,
    tried: Option<Instant>,
    /// The level and the cost before the last reduction, until the effect of the reduction is known.
    gave_way: Option<(usize, f64)>,
    helpless_until: Option<Instant>,
    helpless: Duration,
}

impl DynamicResolution {
    pub(crate) fn new(choice: QualityChoice, fps: f64) -> Self {
        let level = match choice {
            QualityChoice::Auto | QualityChoice::Best => 0,
            QualityChoice::High => HIGH,
            QualityChoice::Medium => MEDIUM,
            QualityChoice::Low => LOW,
        };
        Self {
            choice,
            interval: 1.0 / fps,
            level,
            settling: SETTLING,
            patience: PATIENCE.0,
            helpless: HELPLESS.0,
            ..Self::default()
        }
    }

    /// Creates the controller for a software renderer. The first frame has the fewest pixels: at full size, its targets
    /// and parts that were never finished took 0.1 s. The cost of the first frame then chooses the level.
    pub(crate) fn beginning_small(choice: QualityChoice, fps: f64) -> Self {
        let new = Self::new(choice, fps);
        if choice == QualityChoice::Auto {
            Self { level: LEVELS.len() - 1, begins: true, ..new }
        } else {
            new
        }
    }

    pub(crate) fn chosen_anew(&self, choice: QualityChoice) -> Self {
        Self::new(choice, 1.0 / self.interval)
    }

    pub(crate) fn level(&self) -> Level {
        level_at(self.level)
    }

    /// The level of an idle show, which has time for the best level.
    pub(crate) fn still_level(&self) -> Level {
        match self.choice {
            QualityChoice::Auto | QualityChoice::Best if !self.lacks_room => Level::STILL,
            _ => self.level(),
        }
    }

    /// Notes a frame that was drawn at `now`. `cost` excludes the wait for the monitor.
    pub(crate) fn record(&mut self, now: Instant, cost: Duration) {
        if self.choice != QualityChoice::Auto {
            return;
        }
        let paused =
            self.last.replace(now).is_some_and(|last| now.saturating_duration_since(last) > PAUSE + cost);
        if paused {
            self.frames.clear();
        }
        if self.settling > 0 {
            self.settling -= 1;
            return;
        }
        if std::mem::take(&mut self.begins) {
            return self.begin(cost.as_secs_f64());
        }
        self.frames.push_back((now, cost.as_secs_f64()));
        let old = |(then, _): &(Instant, f64)| now.saturating_duration_since(*then) > self.patience;
        while self.frames.len() > FRAMES_MAX
            || (self.frames.len() > PATIENCE_FRAMES && self.frames.front().is_some_and(old))
        {
            self.frames.pop_front();
        }
        let Some(cost) = self.recent(now) else { return };
        if self.looks_helpless(now, cost) {
            return;
        }
        if cost > FULL * self.time_at(self.level) {
            self.give_way(now, cost);
        } else {
            self.come_back(now);
        }
    }

    /// Notes a frame's expected time in seconds. Returns `true` if the frame should be restarted at another level.
    pub(crate) fn expects(&mut self, now: Instant, seconds: f64) -> bool {
        let before = self.level;
        if self.choice == QualityChoice::Auto && seconds > FAR_TOO_LONG * self.time_at(self.level) {
            self.give_way(now, seconds);
        }
        self.level != before
    }

    /// Draws smaller frames, even if frames are fast. Returns `false` if all frames have their smallest size.
    pub(crate) fn make_smaller(&mut self) -> bool {
        let has_smaller = self.level + 1 < LEVELS.len();
        // The first lack of memory reduces stills, which had all pixels until then.
        let shrinks_stills = !std::mem::replace(&mut self.lacks_room, true);
        if has_smaller {
            self.change(self.level + 1);
        }
        has_smaller || shrinks_stills
    }

    fn time_at(&self, level: usize) -> f64 {
        if level < POOR { self.interval } else { self.interval.max(1.0 / FPS_USABLE) }
    }

    /// The cost of a typical recent frame, without outliers; `None` before there are enough frames.
    fn recent(&self, now: Instant) -> Option<f64> {
        let last_two = self.cost_of(2, 0.0).filter(|_| self.frames.len() >= 2);
        let far_too_long = last_two.filter(|cost| *cost > FAR_TOO_LONG * self.time_at(self.level));
        if far_too_long.is_some() {
            return far_too_long;
        }
        let young = |then: &Instant| now.saturating_duration_since(*then) <= LOOK.0;
        let count = self.frames.iter().rev().take_while(|(then, _)| young(then)).count().max(LOOK.1);
        (self.frames.len() >= count).then(|| self.cost_of(count, 0.5))?
    }

    /// Returns the quantile `part`, 0..1, of the costs of the last `count` frames.
    fn cost_of(&self, count: usize, part: f64) -> Option<f64> {
        let mut costs: Vec<f64> = self.frames.iter().rev().take(count).map(|(_, cost)| *cost).collect();
        costs.sort_by(f64::total_cmp);
        costs.get(((costs.len() as f64 * part) as usize).min(costs.len().saturating_sub(1))).copied()
    }

    /// If fewer pixels have not helped, restores the previous level and returns `true`.
    fn looks_helpless(&mut self, now: Instant, cost: f64) -> bool {
        let Some((before, cost_before)) = self.gave_way.take() else { return false };
        let expected = level_at(self.level).cost() / level_at(before).cost();
        let helped = cost < (1.0 - HELP) * cost_before || expected > 1.0 - HELP;
        if helped {
            self.helpless = HELPLESS.0;
            return false;
        }
        self.helpless_until = Some(now + self.helpless);
        self.helpless = (2 * self.helpless).min(HELPLESS.1);
        self.change(before);
        true
    }

    /// Chooses the best level that fits. `cost` is the cost of one frame at the current level.
    fn begin(&mut self, cost: f64) {
        let fraction = cost / self.level().cost();
        let fits = |level: &usize| fraction * level_at(*level).cost() <= FREE * self.time_at(*level);
        match (0..self.level).find(fits) {
            Some(better) => self.change(better),
            None => self.report_level(),
        }
    }

    fn give_way(&mut self, now: Instant, cost: f64) {
        let last = LEVELS.len() - 1;
        if self.level >= last || self.helpless_until.is_some_and(|until| now < until) {
            return;
        }
        let fraction = cost / self.level().cost();
        let fits = |level: &usize| fraction * level_at(*level).cost() <= AIM * self.time_at(*level);
        let next = (self.level + 1..=last).find(fits).unwrap_or(last);
        if self.tried.take().is_some_and(|tried| now.saturating_duration_since(tried) < TOO_EARLY) {
            self.patience = (2 * self.patience).min(PATIENCE.1);
        }
        self.gave_way = Some((self.level, cost));
        self.change(next);
    }

    fn come_back(&mut self, now: Instant) {
        let Some(better) = self.level.checked_sub(1) else { return };
        let since = self.frames.front().map(|(then, _)| now.saturating_duration_since(*then));
        // Add `LOOK`, because the stored frames span slightly less time than the patience.
        let waited = since.is_some_and(|since| since + LOOK.0 >= self.patience);
        if !waited || self.frames.len() < PATIENCE_FRAMES {
            return;
        }
        let Some(cost) = self.cost_of(self.frames.len(), 0.9) else { return };
        if cost * level_at(better).cost() / self.level().cost() > FREE * self.time_at(better) {
            return;
        }
        if self.tried.is_some_and(|tried| now.saturating_duration_since(tried) >= FORGOTTEN) {
            self.patience = PATIENCE.0;
        }
        self.tried = Some(now);
        self.change(better);
    }

    fn change(&mut self, level: usize) {
        self.level = level;
        self.report_level();
        self.frames.clear();
        self.settling = SETTLING;
    }

    fn report_level(&self) {
        tracing::info!("drawing {} of the window's width and height", self.level().scale);
    }
}

impl std::fmt::Display for DynamicResolution {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.choice {
            QualityChoice::Auto => write!(f, "quality auto {}", LEVELS.len() - self.level),
            choice => write!(f, "{} quality", choice.name()),
        }
    }
}

#[cfg(test)]
#[path = "dynamic_resolution_tests.rs"]
mod tests;
