//! Splits draws into parts, so that a window stays responsive and no driver's watchdog mistakes a long draw for a hang.
//!
//! Probes all over a scene's first frame find the cost of a pixel. Each drawn part updates this cost. No part takes
//! longer than a quarter of a second, and splitting does not change the image. Most frames are a single part.
//!
//! In the window, a frame takes as many calls as it needs. Between two calls the show handles input, and the previous
//! image stays visible. A frame that would take far too long is started again with fewer pixels. If the region tree or
//! first frame of a new scene takes more than `picture_seconds_max`, the show refuses the scene and reports why it is
//! expensive. With a software renderer this judgement counts processor time, so that no scene is refused because other
//! programs are busy.

use std::cell::Cell;
use std::time::Duration;

#[cfg(not(target_family = "wasm"))]
use cpu_time::ProcessTime;
use web_time::Instant;
#[cfg(target_family = "wasm")]
use web_time::Instant as ProcessTime;

use super::program::Program;
use crate::faults::{self, Fault};

/// Target time of a part in seconds: half of the limit (`limits.rs`), because the costs of pixels differ.
pub(super) const PART_SECONDS: f64 = 0.12;
/// Seconds for submitting a draw and waiting for its end. With a value of 1 ms, cheap pixels seemed ten times as
/// expensive as they are.
const OVERHEAD: f64 = 0.00025;
/// Maximum factor between the highest and the second-highest cost per pixel. A higher cost is clamped.
const OUTLIER: f64 = 4.0;
/// Assumed growth of the cost per pixel from one version of a scene to the next.
const WARY: f64 = 4.0;
/// Number of probes along each side of an image. A probe is a square with sides of [`GRAIN`] pixels.
const PROBES: u32 = 6;
/// The sides of parts are multiples of this number, because renderers draw neighbouring pixels together.
const GRAIN: u32 = 8;
/// Software renderers draw squares of this size, so part heights that are multiples of this number are the best.
const ROW: u32 = 64;
/// Images with fewer pixels than this are not probed. Instead, their first parts are small.
const PROBED_MIN: u64 = 4 * (PROBES * GRAIN) as u64 * (PROBES * GRAIN) as u64;
/// Number of probes after which the time of a frame can be predicted.
const TELLING: u32 = 9;

/// A rectangle of a target that is drawn at once, in pixels from its lower left corner.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Tile {
    pub(super) x: u32,
    pub(super) y: u32,
    pub(super) width: u32,
    pub(super) height: u32,
}

impl Tile {
    pub(super) fn whole(size: (u32, u32)) -> Self {
        let (width, height) = size;
        Self { x: 0, y: 0, width, height }
    }

    pub(super) fn pixels(self) -> u64 {
        u64::from(self.width) * u64::from(self.height)
    }
}

/// The duration of a draw.
#[derive(Debug, Clone, Copy)]
pub(super) struct DrawTime {
    passed: Duration,
    /// The time without waiting for other programs; at most `passed`.
    own: Duration,
}

/// Measures the time of a draw.
pub(super) struct DrawTimer {
    begun: Instant,
    /// `None` if a GPU draws: the GPU's load is unknown.
    processor: Option<ProcessTime>,
}

impl DrawTimer {
    /// Starts to measure. `software` is true if the processor draws.
    pub(super) fn start(software: bool) -> Self {
        Self { begun: Instant::now(), processor: software.then(ProcessTime::now) }
    }

    pub(super) fn stop(&self) -> DrawTime {
        let passed = self.begun.elapsed();
        // A software renderer draws on all processors.
        let threads = std::thread::available_parallelism().map_or(1, |count| count.get() as u32);
        let own = self.processor.map_or(passed, |processor| processor.elapsed() / threads);
        DrawTime { passed, own: own.min(passed) }
    }
}

/// The cost of a scene's pixel with one of its programs: the highest cost in the last and the current frame, because
/// the cost of a cheap part, such as the sky, does not predict the rest.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct PixelCost {
    /// Seconds that almost no pixel of the last frame exceeded; 0 if unknown.
    last: f64,
    /// The two highest costs in the current frame so far.
    this: [f64; 2],
}

impl PixelCost {
    fn is_known(self) -> bool {
        self.greatest() > 0.0
    }

    fn pixels(self) -> u64 {
        if self.is_known() { (PART_SECONDS / self.greatest()) as u64 } else { 0 }
    }

    /// Upper estimate of the seconds for a number of pixels; 0 if unknown.
    pub(super) fn seconds(self, pixels: u64) -> f64 {
        self.greatest() * pixels as f64
    }

    pub(super) fn record(&mut self, pixels: u64, time: Duration) {
        let seconds = time.as_secs_f64();
        // If a part took little more than the overhead, assume that its pixels cost as much as the overhead.
        let cost = if seconds > 2.0 * OVERHEAD { seconds - OVERHEAD } else { OVERHEAD };
        let (cost, [first, second]) = (cost / pixels.max(1) as f64, self.this);
        self.this = if cost > first { [cost, first] } else { [first, second.max(cost)] };
    }

    /// Seconds that almost no pixel exceeds. Clamps the highest cost to [`OUTLIER`] times the second-highest, because a
    /// busy system can delay a part.
    fn greatest(self) -> f64 {
        self.last.max(self.of_this())
    }

    fn of_this(self) -> f64 {
        match self.this {
            [first, second] if second > 0.0 => first.min(OUTLIER * second),
            [first, _] => first,
        }
    }

    pub(super) fn finish_picture(&mut self) {
        if self.of_this() > 0.0 {
            (self.last, self.this) = (self.of_this(), [0.0; 2]);
        }
    }
}

/// The cost of a scene's pixels with the program that drew the scene last.
#[derive(Debug, Default)]
pub(super) struct Costs(Cell<Option<(glow::Program, PixelCost)>>);

impl Costs {
    pub(super) fn of(&self, program: &Program) -> PixelCost {
        self.0
            .get()
            .filter(|(of, _)| *of == program.native())
            .map_or_else(PixelCost::default, |(_, cost)| cost)
    }

    /// Assumes several times the cost of the scene's last version, because the scene may have become more expensive.
    pub(super) fn expect(&self, of_last_version: &Self) {
        let expected = of_last_version
            .0
            .get()
            .map(|(program, cost)| (program, PixelCost { last: WARY * cost.greatest(), this: [0.0; 2] }));
        self.0.set(expected);
    }

    pub(super) fn keep(&self, program: &Program, cost: PixelCost) {
        self.0.set(Some((program.native(), cost)));
    }
}

#[derive(Debug, Clone, Default)]
pub(super) struct Parts {
    areas: Vec<Tile>,
    /// What remains to be drawn of the current row of parts.
    row: Option<Tile>,
    /// True if the next draw is not measured, because the driver may compile the program during it.
    warms_up: bool,
    /// True if the last part was the unmeasured draw.
    warming_up: bool,
    probes: u32,
    probing: bool,
    probed: Measured,
    size: (u32, u32),
}

#[derive(Debug, Clone, Copy, Default)]
struct Measured {
    count: u32,
    pixels: u64,
    /// Without waiting for other programs.
    seconds: f64,
}

impl Parts {
    pub(super) fn of(areas: Vec<Tile>, size: (u32, u32), cost: PixelCost) -> Self {
        let pixels: u64 = areas.iter().map(|area| area.pixels()).sum();
        let probes = if cost.is_known() || pixels < PROBED_MIN { 0 } else { PROBES * PROBES };
        let warms_up = !cost.is_known() && pixels > 0;
        Self { areas, warms_up, probes, size, ..Self::default() }
    }

    pub(super) fn are_one(&self, cost: PixelCost) -> bool {
        !self.warms_up && self.probes == 0 && cost.is_known() && cost.pixels() >= self.pixels_left()
    }

    pub(super) fn were_one(&self) -> bool {
        !self.probing && !self.warming_up && self.probed.pixels == 0 && self.pixels_left() == 0
    }

    fn pixels_left(&self) -> u64 {
        self.areas.iter().chain(&self.row).map(|area| area.pixels()).sum()
    }

    pub(super) fn next(&mut self, cost: PixelCost) -> Option<Tile> {
        self.warming_up = std::mem::take(&mut self.warms_up);
        if self.warming_up {
            return Some(self.probe());
        }
        self.probing = self.probes > 0;
        if self.probing {
            self.probes -= 1;
            return Some(self.probe());
        }
        let pixels = cost.pixels().max(u64::from(GRAIN * GRAIN));
        if self.row.is_none() {
            self.row = Some(self.next_row(pixels)?);
        }
        let row = self.row.as_mut()?;
        let across = u32::try_from(pixels / u64::from(row.height.max(1))).unwrap_or(u32::MAX);
        let width = if across >= row.width { row.width } else { (across / GRAIN * GRAIN).max(GRAIN) };
        let part = Tile { width: width.min(row.width), ..*row };
        row.x += part.width;
        row.width -= part.width;
        if row.width == 0 {
            self.row = None;
        }
        Some(part)
    }

    fn next_row(&mut self, pixels: u64) -> Option<Tile> {
        let area = loop {
            let area = self.areas.last_mut()?;
            if area.pixels() > 0 {
                break area;
            }
            self.areas.pop();
        };
        let rows = u32::try_from(pixels / u64::from(area.width.max(1))).unwrap_or(u32::MAX);
        let height = if rows >= area.height {
            area.height
        } else if rows >= ROW {
            rows / ROW * ROW
        } else if pixels >= u64::from(ROW * ROW) {
            ROW
        } else {
            ((pixels as f64).sqrt() as u32 / GRAIN * GRAIN).max(GRAIN)
        };
        let row = Tile { height: height.min(area.height), ..*area };
        area.y += row.height;
        area.height -= row.height;
        Some(row)
    }

    /// A square in the image. Probes are spread over the image, so the first few probes are representative.
    fn probe(&self) -> Tile {
        // 7 and 36 have no common divisor, so each square is probed once.
        let number = (self.probes * 7 + 3) % (PROBES * PROBES);
        let place = |index: u32, side: u32| {
            let middle = (2 * index + 1) * side / (2 * PROBES);
            (middle / GRAIN * GRAIN).min(side.saturating_sub(GRAIN))
        };
        let (x, y) = (place(number % PROBES, self.size.0), place(number / PROBES, self.size.1));
        Tile { x, y, width: GRAIN.min(self.size.0), height: GRAIN.min(self.size.1) }
    }

    pub(super) fn record(&mut self, part: Tile, mut time: DrawTime, cost: &mut PixelCost) {
        if self.warming_up {
            return;
        }
        if faults::lasts(Fault::DearPixels) {
            let all = Duration::from_micros(100 * part.pixels());
            time = DrawTime { passed: all, own: all };
        }
        cost.record(part.pixels(), time.passed);
        self.probed.count += u32::from(self.probing);
        self.probed.pixels += part.pixels();
        self.probed.seconds += (time.own.as_secs_f64() - OVERHEAD).max(0.0);
    }

    /// Estimated total time in seconds, without the driver's compilation and other programs; `None` until enough is
    /// known.
    pub(super) fn seconds(&self) -> Option<f64> {
        let known = self.probed;
        let tells = known.count >= TELLING || (self.probes == 0 && known.pixels > 0);
        let each = known.seconds / known.pixels.max(1) as f64;
        tells.then(|| known.seconds + each * self.pixels_left() as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A draw on an idle machine.
    fn undisturbed(time: Duration) -> DrawTime {
        DrawTime { passed: time, own: time }
    }

    /// Draws all parts, with each pixel taking `cost` seconds, and counts how often each pixel is drawn.
    fn drawn(areas: Vec<Tile>, size: (u32, u32), cost: impl Fn(u32, u32) -> f64) -> (Vec<u32>, f64) {
        let mut seen = vec![0; (size.0 * size.1) as usize];
        let (mut known, mut longest) = (PixelCost::default(), 0.0_f64);
        let mut parts = Parts::of(areas, size, known);
        while let Some(part) = parts.next(known) {
            let mut seconds = OVERHEAD / 4.0;
            for y in part.y..part.y + part.height {
                for x in part.x..part.x + part.width {
                    seconds += cost(x, y);
                    if !parts.probing {
                        seen[(y * size.0 + x) as usize] += u32::from(!parts.warming_up);
                    }
                }
            }
            longest = longest.max(seconds);
            parts.record(part, undisturbed(Duration::from_secs_f64(seconds)), &mut known);
        }
        (seen, longest)
    }

    #[test]
    fn every_pixel_is_drawn_once_at_any_cost() {
        for size in [(1, 1), (7, 300), (161, 91), (640, 360)] {
            for cost in [0.0, 1e-7, 2e-5, 3e-3] {
                let (seen, _) = drawn(vec![Tile::whole(size)], size, |_, _| cost);
                assert!(seen.iter().all(|count| *count == 1), "{size:?} at {cost}");
            }
        }
    }

    #[test]
    fn a_changed_scene_is_not_probed_and_may_cost_four_times_as_much() {
        let (last, next) = (Costs::default(), Costs::default());
        next.expect(&last);
        assert_eq!(next.0.get(), None, "neither cost is known");
        let mut cost = PixelCost::default();
        cost.record(64, Duration::from_millis(20));
        last.0.set(Some((glow::NativeProgram(std::num::NonZeroU32::MIN), cost)));
        next.expect(&last);
        let Some((_, expected)) = next.0.get() else { panic!("{next:?}") };
        let size = (640, 360);
        let mut parts = Parts::of(vec![Tile::whole(size)], size, expected);
        assert!(!parts.warms_up && parts.probes == 0);
        let part = parts.next(expected).unwrap();
        let most_expensive = 4.0 * cost.seconds(part.pixels());
        assert!((0.5 * PART_SECONDS..=PART_SECONDS).contains(&most_expensive), "{most_expensive}");
    }

    #[test]
    fn only_the_areas_are_drawn() {
        let areas =
            vec![Tile { x: 0, y: 0, width: 90, height: 10 }, Tile { x: 0, y: 10, width: 30, height: 2 }];
        let (seen, _) = drawn(areas, (100, 20), |_, _| 1e-4);
        assert_eq!(seen.iter().sum::<u32>(), 960);
        assert!(seen.iter().all(|count| *count <= 1) && seen[0] == 1 && seen[10 * 100 + 29] == 1);
    }

    #[test]
    fn an_expensive_scene_is_drawn_in_short_parts() {
        // A scene of foam that takes 2.8 ms per pixel, with sky above or below the foam.
        for foam_is_below in [true, false] {
            let cost = |_, y| if (y < 120) == foam_is_below { 2.8e-3 } else { 1e-6 };
            let (_, longest) = drawn(vec![Tile::whole((320, 180))], (320, 180), cost);
            assert!(longest <= 0.25, "one draw takes {longest} s");
        }
        let (_, longest) = drawn(vec![Tile::whole((1280, 720))], (1280, 720), |_, _| 4e-6);
        assert!(longest <= 0.25, "one draw takes {longest} s");
    }

    #[test]
    fn the_first_probes_predict_the_time_of_an_expensive_frame() {
        let size = (320, 180);
        let mut cost = PixelCost::default();
        let mut parts = Parts::of(vec![Tile::whole(size)], size, cost);
        assert_eq!(parts.seconds(), None);
        for _ in 0..=TELLING {
            let part = parts.next(cost).unwrap();
            parts.record(part, undisturbed(Duration::from_secs_f64(part.pixels() as f64 * 2e-3)), &mut cost);
        }
        let foretold = parts.seconds().unwrap();
        assert!((100.0..120.0).contains(&foretold), "{foretold}");
    }

    #[test]
    fn a_scene_is_not_too_expensive_because_other_programs_are_busy() {
        let size = (320, 180);
        let mut cost = PixelCost::default();
        let mut parts = Parts::of(vec![Tile::whole(size)], size, cost);
        for _ in 0..=TELLING {
            let part = parts.next(cost).unwrap();
            let own = OVERHEAD + part.pixels() as f64 * 2e-5;
            let time =
                DrawTime { passed: Duration::from_secs_f64(20.0 * own), own: Duration::from_secs_f64(own) };
            parts.record(part, time, &mut cost);
        }
        let foretold = parts.seconds().unwrap();
        assert!((1.0..1.3).contains(&foretold), "{foretold}");
        // Parts stay short all the same.
        assert!(cost.seconds(parts.next(cost).unwrap().pixels()) < 2.0 * PART_SECONDS);
    }

    #[test]
    fn a_draw_of_the_processor_takes_no_longer_than_its_processor_time() {
        let [software, hardware] = [true, false].map(DrawTimer::start);
        std::thread::sleep(Duration::from_millis(30));
        let [software, hardware] = [software.stop(), hardware.stop()];
        assert!(software.own <= software.passed && hardware.own == hardware.passed);
    }

    #[test]
    fn compilation_at_the_first_draw_does_not_count_as_cost() {
        for size in [(160, 90), (30, 20)] {
            let mut cost = PixelCost::default();
            let mut parts = Parts::of(vec![Tile::whole(size)], size, cost);
            let first = parts.next(cost).unwrap();
            parts.record(first, undisturbed(Duration::from_secs(5)), &mut cost);
            let mut drawn = 0;
            while let Some(part) = parts.next(cost) {
                let seconds = part.pixels() as f64 * 1e-5 + OVERHEAD;
                parts.record(part, undisturbed(Duration::from_secs_f64(seconds)), &mut cost);
                assert!(parts.seconds().is_none_or(|seconds| seconds < 0.5), "{:?}", parts.seconds());
                drawn += u64::from(!parts.probing) * part.pixels();
            }
            assert_eq!(drawn, Tile::whole(size).pixels());
        }
    }

    #[test]
    fn one_slow_part_on_a_busy_system_does_not_split_the_rest() {
        let size = (320, 180);
        let mut cost = PixelCost::default();
        let mut parts = Parts::of(vec![Tile::whole(size)], size, cost);
        let mut draws = 0;
        while let Some(part) = parts.next(cost) {
            draws += 1;
            let interrupted = if draws == 5 { 0.1 } else { 0.0 };
            let seconds = OVERHEAD + 1e-6 * part.pixels() as f64 + interrupted;
            parts.record(part, undisturbed(Duration::from_secs_f64(seconds)), &mut cost);
        }
        assert!(draws < 100, "{draws} draws");
    }

    #[test]
    fn a_cheap_frame_of_known_cost_is_one_draw() {
        let (size, mut cost) = ((640, 360), PixelCost::default());
        cost.record(64, Duration::from_micros(100));
        cost.finish_picture();
        cost.record(7_000, Duration::from_millis(1));
        cost.finish_picture();
        let mut parts = Parts::of(vec![Tile::whole(size)], size, cost);
        assert_eq!(parts.next(cost), Some(Tile::whole(size)));
        assert_eq!(parts.next(cost), None);
    }
}
