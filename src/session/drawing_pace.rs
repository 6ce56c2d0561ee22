//! Chooses when the next frame is due and at which quality, measures drawing times, and detects an idle show.

use std::time::{Duration, Instant};

use crate::clock;
use crate::config::QualityChoice;
use crate::limits;
use crate::session::dynamic_resolution::{DynamicResolution, Level};
use crate::session::pacing::Pacing;
use crate::session::scene::Shown;
use crate::session::times::Times;
use mariana_player::Moment;

/// A show that has not changed for this time is idle, and is drawn in the best quality.
const STANDS_STILL: Duration = Duration::from_millis(400);

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Verdict {
    GoOn,
    DrawSmaller,
    /// Remove the scene: even with fewer pixels it would be too slow.
    TakeBack,
}

/// The number of new frames per second, counted over a second or more so that it is readable.
#[derive(Debug, Default)]
struct PictureRate {
    /// Start time of the count, and the number of frames since that time.
    counted: Option<(Instant, u32)>,
    last: Option<Instant>,
    per_second: Option<f64>,
}

impl PictureRate {
    const COUNTED_FOR: Duration = Duration::from_secs(1);
    const GONE_AFTER: Duration = Duration::from_secs(3);

    fn record(&mut self, now: Instant) {
        if self.last.replace(now).is_none_or(|last| now.saturating_duration_since(last) > Self::GONE_AFTER) {
            (self.counted, self.per_second) = (None, None);
        }
        let (since, count) = self.counted.get_or_insert((now, 0));
        let passed = now.saturating_duration_since(*since);
        if passed >= Self::COUNTED_FOR {
            self.per_second = Some(f64::from(*count) / passed.as_secs_f64());
            (*since, *count) = (now, 0);
        }
        *count += 1;
    }

    fn at(&self, now: Instant) -> Option<f64> {
        let last = self.last.filter(|last| now.saturating_duration_since(*last) <= Self::GONE_AFTER);
        last.and(self.per_second)
    }
}

pub(crate) struct DrawingPace {
    pub(crate) pacing: Pacing,
    pub(crate) resolution: DynamicResolution,
    pub(crate) times: Times,
    /// The last shown frame. An equal frame is not drawn again.
    pub(crate) shown: Option<Shown>,
    pub(crate) window_size: Option<(u32, u32)>,
    moved: Instant,
    pictured: Option<Instant>,
    rate: PictureRate,
}

impl DrawingPace {
    /// Starts at `now` with at most `fps` frames per second. `software` is true for a software renderer.
    pub(crate) fn new(quality: QualityChoice, fps: f64, software: bool, now: Instant) -> Self {
        let resolution = if software { DynamicResolution::beginning_small } else { DynamicResolution::new };
        Self {
            pacing: Pacing::new(fps, now),
            resolution: resolution(quality, fps),
            times: Times::default(),
            shown: None,
            window_size: None,
            moved: now,
            pictured: None,
            rate: PictureRate::default(),
        }
    }

    /// The same pace for a new context, in which no frame has been drawn.
    pub(crate) fn renewed(self, now: Instant) -> Self {
        Self { shown: None, pictured: None, moved: now, ..self }
    }

    /// The moment of the next frame: `now`, or the moment of the last frame if both would look the same.
    pub(crate) fn moment(&self, now: Moment, moves_by_itself: bool) -> Moment {
        let same = |shown: &Shown| shown.moment.features == now.features && !moves_by_itself;
        self.shown.filter(same).map_or(now, |shown| shown.moment)
    }

    /// Notes the frame that would be shown at `now`. Returns `true` if it differs from the last shown frame.
    pub(crate) fn record_wanted(&mut self, moment: Option<Moment>, revision: u64, now: Instant) -> bool {
        let moves = self.shown.is_none_or(|shown| moment != Some(shown.moment) || shown.revision != revision);
        if moves {
            self.moved = now;
        }
        moves
    }

    pub(crate) fn stands_still(&self, now: Instant) -> bool {
        now.saturating_duration_since(self.moved) >= STANDS_STILL
    }

    /// The level of the next frame. An idle show gets the best, and so does a view: its legend must be readable.
    pub(crate) fn level(&self, now: Instant, is_view: bool) -> Level {
        if self.stands_still(now) || is_view {
            self.resolution.still_level()
        } else {
            self.resolution.level()
        }
    }

    /// True if the last frame lacks pixels or samples of the current level, with sides of at most `side_max`.
    pub(crate) fn could_be_better(&self, now: Instant, is_view: bool, side_max: u32) -> bool {
        let Some((shown, window)) = self.shown.zip(self.window_size) else { return false };
        let level = self.level(now, is_view);
        (shown.size, shown.edges) != (drawn_size(level, window, side_max), level.edges)
    }

    /// Notes a new frame that was begun at `begun`. Returns the seconds since the previous one, 0 for the first.
    pub(crate) fn record_picture(&mut self, begun: Instant) -> f64 {
        let last = self.pictured.replace(begun).unwrap_or(begun);
        self.rate.record(begun);
        begun.saturating_duration_since(last).as_secs_f64()
    }

    /// The rate and the size of frames, such as "60 fps · 1280x720". The rate is left out while the show is idle.
    pub(crate) fn about_pictures(&self, now: Instant) -> String {
        let rate = self.rate.at(now).map(|rate| format!("{rate:.0} fps"));
        let size = self.shown.map(|Shown { size: (width, height), .. }| format!("{width}x{height}"));
        rate.into_iter().chain(size).collect::<Vec<_>>().join(" · ")
    }

    /// Judges a frame that will take `seconds`. While the show is idle, a slow frame is accepted.
    pub(crate) fn weigh(&mut self, level: Level, seconds: f64, now: Instant) -> Verdict {
        if level != self.resolution.level() {
            Verdict::GoOn
        } else if self.resolution.expects(now, seconds) {
            Verdict::DrawSmaller
        } else if seconds > limits::PICTURE_SECONDS_MAX {
            Verdict::TakeBack
        } else {
            Verdict::GoOn
        }
    }

    pub(crate) fn make_smaller(&mut self) -> bool {
        self.shown.is_some() && self.resolution.make_smaller()
    }

    /// Notes the frame that the window shows. Returns `true` for the first one.
    pub(crate) fn show(&mut self, shown: Shown) -> bool {
        self.shown.replace(shown).is_none()
    }

    /// Notes that drawing and showing a new frame took `time`. `cost` excludes the wait for the monitor.
    pub(crate) fn record_times(&mut self, level: Level, time: Duration, cost: Duration) {
        self.times.record(time);
        if level == self.resolution.level() {
            self.resolution.record(clock::now(), cost);
        }
    }
}

/// Returns the size of a frame at `level`: at most the maximum number of pixels, with sides of at most `side_max`.
pub(crate) fn drawn_size(level: Level, window: (u32, u32), side_max: u32) -> (u32, u32) {
    let within = (window.0.min(side_max), window.1.min(side_max));
    level.size_in(within_pixels(within, limits::PICTURE_PIXELS_MAX))
}

/// A size of at most `max` pixels with the aspect ratio of `size`, up to rounding.
pub(crate) fn within_pixels(size: (u32, u32), max: u64) -> (u32, u32) {
    let pixels = f64::from(size.0) * f64::from(size.1);
    let scale = (max as f64 / pixels.max(1.0)).sqrt().min(1.0);
    let side = |side: u32| ((f64::from(side) * scale) as u32).max(1);
    (side(size.0), side(size.1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use mariana_music::Features;

    const WINDOW: (u32, u32) = (640, 360);
    const SIDE_MAX: u32 = 16_384;

    fn moment(song_time: f64, volume: f32) -> Moment {
        let features = Features { volume: [volume; 2], ..Features::SILENCE };
        Moment { song_time, features, segment: 1, ..Moment::default() }
    }

    fn shows(moment: Moment, now: Instant) -> DrawingPace {
        let mut pace = DrawingPace::new(QualityChoice::Auto, 60.0, false, now);
        pace.window_size = Some(WINDOW);
        let level = pace.level(now, false);
        let shown = Shown { moment, size: WINDOW, edges: level.edges, revision: 3 };
        assert!(pace.show(shown) && !pace.show(shown), "only the first call reports the first frame");
        pace
    }

    #[test]
    fn the_rate_covers_the_last_second_and_ends_when_the_show_is_idle() {
        let start = Instant::now();
        let at = |milliseconds: u64| start + Duration::from_millis(milliseconds);
        let mut rate = PictureRate::default();
        (0..50).for_each(|n| rate.record(at(20 * n)));
        assert_eq!(rate.at(at(980)), None, "less than a second");
        rate.record(at(1_000));
        assert_eq!(rate.at(at(1_000)), Some(50.0));
        (1..=10).for_each(|n| rate.record(at(1_000 + 100 * n)));
        assert_eq!((rate.at(at(2_000)), rate.at(at(5_001))), (Some(10.0), None));
        rate.record(at(60_000));
        assert_eq!(rate.at(at(60_000)), None, "a pause does not count as a slow frame");
    }

    #[test]
    fn an_unchanged_sound_keeps_the_shown_moment() {
        let pace = shows(moment(1.0, 0.5), Instant::now());
        let (same, louder) = (moment(2.0, 0.5), moment(2.0, 0.6));
        assert_eq!(pace.moment(same, false).song_time, 1.0);
        assert_eq!(pace.moment(same, true).song_time, 2.0, "its scene moves by itself");
        assert_eq!(pace.moment(louder, false).song_time, 2.0);
    }

    #[test]
    fn an_idle_show_is_drawn_once_more_at_the_best_quality() {
        let now = Instant::now();
        let mut pace = shows(moment(1.0, 0.5), now);
        assert!(!pace.record_wanted(Some(moment(1.0, 0.5)), 3, now));
        assert!(!pace.could_be_better(now, false, SIDE_MAX));
        assert!(pace.could_be_better(now, true, SIDE_MAX), "the legend of a view must be readable");
        let later = now + STANDS_STILL;
        assert!(pace.could_be_better(later, false, SIDE_MAX));
        let level = pace.level(later, false);
        pace.show(Shown { moment: moment(1.0, 0.5), size: WINDOW, edges: level.edges, revision: 3 });
        assert!(!pace.could_be_better(later, false, SIDE_MAX));
        // A frame differs if the sound or the revision changes, or the sound ends.
        assert!(pace.record_wanted(Some(moment(1.0, 0.6)), 3, later));
        assert!(pace.record_wanted(Some(moment(1.0, 0.5)), 4, later));
        assert!(pace.record_wanted(None, 3, later));
        assert!(pace.level(later, false) != level);
    }

    #[test]
    fn slow_frames_get_smaller_or_are_given_up_and_stills_have_time() {
        let now = Instant::now();
        let mut pace = shows(moment(1.0, 0.5), now);
        let (moving, still) = (pace.level(now, false), pace.level(now + STANDS_STILL, false));
        let too_long = limits::PICTURE_SECONDS_MAX + 1.0;
        assert_eq!(pace.weigh(still, too_long, now), Verdict::GoOn);
        assert_eq!(pace.weigh(moving, 0.01, now), Verdict::GoOn);
        assert_eq!(pace.weigh(moving, too_long, now), Verdict::DrawSmaller);
        let smallest = pace.level(now, false);
        assert!(smallest.scale < moving.scale);
        assert_eq!(pace.weigh(smallest, too_long, now), Verdict::TakeBack);
    }

    #[test]
    fn a_new_context_begins_with_a_first_frame() {
        let now = Instant::now();
        let mut pace = shows(moment(1.0, 0.5), now);
        assert_eq!(pace.record_picture(now), 0.0);
        assert_eq!(pace.record_picture(now + Duration::from_millis(500)), 0.5);
        let mut pace = pace.renewed(now);
        assert_eq!((pace.shown, pace.record_picture(now + Duration::from_secs(9))), (None, 0.0));
        assert!(!pace.make_smaller(), "no frame was shown, so none can be too large");
    }

    #[test]
    fn windows_beyond_the_limits_are_drawn_smaller() {
        let level =
            DrawingPace::new(QualityChoice::Best, 60.0, false, Instant::now()).level(Instant::now(), false);
        assert_eq!(drawn_size(level, WINDOW, SIDE_MAX), WINDOW);
        assert_eq!(drawn_size(level, (4000, 300), 2048), (2048, 300));
        assert_eq!(drawn_size(level, (300, 4000), 2048), (300, 2048));
        let (width, height) = drawn_size(level, (SIDE_MAX, SIDE_MAX), SIDE_MAX);
        assert!(width == height && u64::from(width) * u64::from(height) <= limits::PICTURE_PIXELS_MAX);
        assert_eq!(drawn_size(level, (1, 9), SIDE_MAX), (1, 9));
    }
}
