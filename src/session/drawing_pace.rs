//! When pictures are drawn, and how well: what the last one showed, how long pictures take, and whether the show moves.

use std::time::{Duration, Instant};

use crate::clock;
use crate::config::QualityChoice;
use crate::limits::LIMITS;
use crate::session::dynamic_resolution::{DynamicResolution, Level};
use crate::session::frame_times::FrameTimes;
use crate::session::pacing::Pacing;
use crate::session::scene::Shown;
use mariana_player::Moment;

/// After standing still for this long, a show is drawn as well as possible.
const STANDS_STILL: Duration = Duration::from_millis(400);

/// How to go on with a picture that is being drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// As it was begun.
    GoOn,
    /// Anew, with fewer pixels.
    DrawSmaller,
    /// Not at all: fewer pixels would not be enough.
    TakeBack,
}

/// How many new pictures there are in a second: counted for a second or more, so that the number can be read.
#[derive(Debug, Default)]
struct PictureRate {
    /// When counting began, and the pictures since.
    counted: Option<(Instant, u32)>,
    /// The last picture.
    last: Option<Instant>,
    per_second: Option<f64>,
}

impl PictureRate {
    const COUNTED_FOR: Duration = Duration::from_secs(1);
    /// Without a new picture for this long there is no rate.
    const GONE_AFTER: Duration = Duration::from_secs(3);

    fn note(&mut self, now: Instant) {
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

/// See the module.
pub(crate) struct DrawingPace {
    pacing: Pacing,
    resolution: DynamicResolution,
    times: FrameTimes,
    /// What the last frame showed. A show that stands still is not drawn again.
    shown: Option<Shown>,
    /// The window's size at the last drawing.
    window_size: Option<(u32, u32)>,
    /// When the show last moved.
    moved: Instant,
    /// When the last new picture was begun.
    pictured: Option<Instant>,
    rate: PictureRate,
}

impl DrawingPace {
    /// For at most `fps` frames per second from `now` on, drawn by a GPU or by `software`.
    pub(crate) fn new(quality: QualityChoice, fps: f64, software: bool, now: Instant) -> Self {
        let resolution = if software { DynamicResolution::beginning_small } else { DynamicResolution::new };
        Self {
            pacing: Pacing::new(fps, now),
            resolution: resolution(quality, fps),
            times: FrameTimes::default(),
            shown: None,
            window_size: None,
            moved: now,
            pictured: None,
            rate: PictureRate::default(),
        }
    }

    /// The same for another context, in which nothing was drawn yet.
    pub(crate) fn renewed(self, now: Instant) -> Self {
        Self { shown: None, pictured: None, moved: now, ..self }
    }

    /// Draws by another choice from now on.
    pub(crate) fn set_quality(&mut self, quality: QualityChoice) {
        self.resolution = self.resolution.chosen_anew(quality);
    }

    /// What the last frame showed.
    pub(crate) fn shown(&self) -> Option<Shown> {
        self.shown
    }

    /// How long frames took, for the log.
    pub(crate) fn times(&self) -> &FrameTimes {
        &self.times
    }

    /// When the next frame is due, perhaps one that answers a hand.
    pub(crate) fn due(&self, answers: bool) -> Instant {
        self.pacing.due(answers)
    }

    /// Notes a frame that was begun at `now`, when it was due.
    pub(crate) fn begun(&mut self, now: Instant, answers: bool) {
        self.pacing.begun(now, answers);
    }

    /// Notes the window's size at a drawing; none while it has no area.
    pub(crate) fn set_window_size(&mut self, size: Option<(u32, u32)>) {
        self.window_size = size;
    }

    /// What the next picture shows: what is heard `now`, or what the last picture showed if it would look the same.
    pub(crate) fn moment(&self, now: Moment, moves_by_itself: bool) -> Moment {
        let same = |shown: &Shown| shown.moment.features == now.features && !moves_by_itself;
        self.shown.filter(same).map_or(now, |shown| shown.moment)
    }

    /// Notes what would be shown at `now`. Returns whether the show moves.
    pub(crate) fn note_wanted(&mut self, moment: Option<Moment>, revision: u64, now: Instant) -> bool {
        let moves = self.shown.is_none_or(|shown| moment != Some(shown.moment) || shown.revision != revision);
        if moves {
            self.moved = now;
        }
        moves
    }

    /// Returns `true` after [`STANDS_STILL`] without a change.
    pub(crate) fn stands_still(&self, now: Instant) -> bool {
        now.saturating_duration_since(self.moved) >= STANDS_STILL
    }

    /// How the next picture is drawn: as well as possible if it stands still, and also if it is a view, whose legend
    /// is read.
    pub(crate) fn level(&self, now: Instant, is_view: bool) -> Level {
        if self.stands_still(now) || is_view {
            self.resolution.still_level()
        } else {
            self.resolution.level()
        }
    }

    /// Says whether samples are saved because the scene is being edited. A show that stands still is drawn well all the
    /// same: there is time.
    pub(crate) fn set_edited(&mut self, edited: bool) {
        self.resolution.set_edited(edited);
    }

    /// Whether a show that stands still could be drawn better than it is, by a driver whose textures have up to
    /// `side_max` texels.
    pub(crate) fn could_be_better(&self, now: Instant, is_view: bool, side_max: u32) -> bool {
        let Some((shown, window)) = self.shown.zip(self.window_size) else { return false };
        let level = self.level(now, is_view);
        (shown.size, shown.edges) != (drawn_size(level, window, side_max), level.edges)
    }

    /// Notes a new picture that was begun at `begun`. Returns the seconds since the one before, 0 for the first.
    pub(crate) fn note_picture(&mut self, begun: Instant) -> f64 {
        let last = self.pictured.replace(begun).unwrap_or(begun);
        self.rate.note(begun);
        begun.saturating_duration_since(last).as_secs_f64()
    }

    /// The rate and the size of pictures, such as "60 fps · 1280x720"; no rate while nothing moves.
    pub(crate) fn about_pictures(&self, now: Instant) -> String {
        let rate = self.rate.at(now).map(|rate| format!("{rate:.0} fps"));
        let size = self.shown.map(|Shown { size: (width, height), .. }| format!("{width}x{height}"));
        rate.into_iter().chain(size).collect::<Vec<_>>().join(" · ")
    }

    /// In words, such as "high quality".
    pub(crate) fn quality(&self) -> String {
        self.resolution.to_string()
    }

    /// Judges a picture that will take this many seconds. For one that stands still there is time.
    pub(crate) fn weigh(&mut self, level: Level, seconds: f64, now: Instant) -> Verdict {
        if level != self.resolution.level() {
            Verdict::GoOn
        } else if self.resolution.expects(now, seconds) {
            Verdict::DrawSmaller
        } else if seconds > LIMITS.picture_seconds_max {
            Verdict::TakeBack
        } else {
            Verdict::GoOn
        }
    }

    /// Draws fewer pixels from now on, because the driver had no memory for a picture. False if that is no help.
    pub(crate) fn make_smaller(&mut self) -> bool {
        self.shown.is_some() && self.resolution.make_smaller()
    }

    /// Notes what the window shows. Returns whether it is the first picture.
    pub(crate) fn show(&mut self, shown: Shown) -> bool {
        self.shown.replace(shown).is_none()
    }

    /// Notes that a new picture took `time` until it was shown, and `cost` without waiting for the monitor.
    pub(crate) fn note_times(&mut self, level: Level, time: Duration, cost: Duration) {
        self.times.note(time);
        if level == self.resolution.level() {
            self.resolution.note(clock::now(), cost);
        }
    }
}

/// The size in which a level draws a window. A size beyond the driver's textures, whose sides have up to `side_max`
/// texels, or with more pixels than a picture may have, is reduced too.
pub(crate) fn drawn_size(level: Level, window: (u32, u32), side_max: u32) -> (u32, u32) {
    let within = (window.0.min(side_max), window.1.min(side_max));
    level.size_in(within_pixels(within, LIMITS.picture_pixels_max))
}

/// A size of at most `max` pixels and of the same shape, as far as whole pixels allow.
fn within_pixels(size: (u32, u32), max: u64) -> (u32, u32) {
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

    /// A pace whose last picture showed `moment`, drawn as it is drawn at `now`.
    fn shows(moment: Moment, now: Instant) -> DrawingPace {
        let mut pace = DrawingPace::new(QualityChoice::Auto, 60.0, false, now);
        pace.set_window_size(Some(WINDOW));
        let level = pace.level(now, false);
        let shown = Shown { moment, size: WINDOW, edges: level.edges, revision: 3 };
        assert!(pace.show(shown) && !pace.show(shown), "only the first is the first");
        pace
    }

    #[test]
    fn the_rate_is_that_of_the_last_second_and_goes_when_nothing_moves() {
        let start = Instant::now();
        let at = |milliseconds: u64| start + Duration::from_millis(milliseconds);
        let mut rate = PictureRate::default();
        (0..50).for_each(|n| rate.note(at(20 * n)));
        assert_eq!(rate.at(at(980)), None, "not yet a second");
        rate.note(at(1_000));
        assert_eq!(rate.at(at(1_000)), Some(50.0));
        (1..=10).for_each(|n| rate.note(at(1_000 + 100 * n)));
        assert_eq!((rate.at(at(2_000)), rate.at(at(5_001))), (Some(10.0), None));
        rate.note(at(60_000));
        assert_eq!(rate.at(at(60_000)), None, "the pause is no slow picture");
    }

    #[test]
    fn what_would_look_the_same_is_the_moment_that_is_shown() {
        let pace = shows(moment(1.0, 0.5), Instant::now());
        let (same, louder) = (moment(2.0, 0.5), moment(2.0, 0.6));
        assert_eq!(pace.moment(same, false).song_time, 1.0);
        assert_eq!(pace.moment(same, true).song_time, 2.0, "its scene moves by itself");
        assert_eq!(pace.moment(louder, false).song_time, 2.0);
    }

    #[test]
    fn a_show_that_stands_still_is_drawn_once_more_and_better() {
        let now = Instant::now();
        let mut pace = shows(moment(1.0, 0.5), now);
        assert!(!pace.note_wanted(Some(moment(1.0, 0.5)), 3, now));
        assert!(!pace.could_be_better(now, false, SIDE_MAX));
        assert!(pace.could_be_better(now, true, SIDE_MAX), "the legend of a view is read");
        let later = now + STANDS_STILL;
        assert!(pace.could_be_better(later, false, SIDE_MAX));
        let level = pace.level(later, false);
        pace.show(Shown { moment: moment(1.0, 0.5), size: WINDOW, edges: level.edges, revision: 3 });
        assert!(!pace.could_be_better(later, false, SIDE_MAX));
        // It moves if the sound does, if the scene does, and if there is nothing to hear.
        assert!(pace.note_wanted(Some(moment(1.0, 0.6)), 3, later));
        assert!(pace.note_wanted(Some(moment(1.0, 0.5)), 4, later));
        assert!(pace.note_wanted(None, 3, later));
        assert!(pace.level(later, false) != level);
    }

    #[test]
    fn pictures_that_take_too_long_are_smaller_or_none_and_stills_have_time() {
        let now = Instant::now();
        let mut pace = shows(moment(1.0, 0.5), now);
        let (moving, still) = (pace.level(now, false), pace.level(now + STANDS_STILL, false));
        let too_long = LIMITS.picture_seconds_max + 1.0;
        assert_eq!(pace.weigh(still, too_long, now), Verdict::GoOn);
        assert_eq!(pace.weigh(moving, 0.01, now), Verdict::GoOn);
        assert_eq!(pace.weigh(moving, too_long, now), Verdict::DrawSmaller);
        let smallest = pace.level(now, false);
        assert!(smallest.scale < moving.scale);
        assert_eq!(pace.weigh(smallest, too_long, now), Verdict::TakeBack);
    }

    #[test]
    fn another_context_begins_with_a_first_picture() {
        let now = Instant::now();
        let mut pace = shows(moment(1.0, 0.5), now);
        assert_eq!(pace.note_picture(now), 0.0);
        assert_eq!(pace.note_picture(now + Duration::from_millis(500)), 0.5);
        let mut pace = pace.renewed(now);
        assert_eq!((pace.shown(), pace.note_picture(now + Duration::from_secs(9))), (None, 0.0));
        assert!(!pace.make_smaller(), "the first picture is not the one that was too large");
    }

    #[test]
    fn windows_beyond_what_can_be_drawn_are_drawn_smaller() {
        let level =
            DrawingPace::new(QualityChoice::Best, 60.0, false, Instant::now()).level(Instant::now(), false);
        assert_eq!(drawn_size(level, WINDOW, SIDE_MAX), WINDOW);
        assert_eq!(drawn_size(level, (4000, 300), 2048), (2048, 300));
        assert_eq!(drawn_size(level, (300, 4000), 2048), (300, 2048));
        let (width, height) = drawn_size(level, (SIDE_MAX, SIDE_MAX), SIDE_MAX);
        assert!(width == height && u64::from(width) * u64::from(height) <= LIMITS.picture_pixels_max);
        assert_eq!(drawn_size(level, (1, 9), SIDE_MAX), (1, 9));
    }
}
