//! How one scene gives way to another in the picture: it fades, or is cut. [`super::scene_change`] draws what goes on below the
//! scene that comes, and the fades of a show.
//!
//! Where the scene that goes cannot go on, its last picture is mixed into those of the one that comes
//! ([`Renderer::keep_light`]); so is a picture that was held.
//!
//! **A fade goes with the song,** as those of shows do: what shows at a moment of a song follows from the moment, and a
//! recording of it has the same fade. Only a fade that begins while nothing plays takes its time from the clock.

use std::time::{Duration, Instant};

use crate::gpu::error::GpuError;
use crate::gpu::renderer::Renderer;
use mariana_player::Moment;

/// The most that one picture takes from a fade, so that a picture that takes long does not make a cut of it.
const STEP_MAX: Duration = Duration::from_millis(125);

/// See the module.
pub(crate) struct Fading {
    /// How long a fade takes; zero is a cut.
    length: Duration,
    /// Whether scenes are cut all the same.
    cuts: bool,
    /// How long the next one takes instead.
    next: Option<Duration>,
    /// How long the one takes that goes on.
    going: Duration,
    from: From,
    state: State,
    /// When the last picture was begun.
    begun: Option<Instant>,
    /// The share of what goes in the last picture, of a fade that goes on.
    fraction: f32,
    /// Whether it was announced.
    announced: bool,
}

/// What fades away.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum From {
    /// The scene before.
    Scene,
    /// A picture that was held.
    HeldPicture,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum State {
    None,
    /// The next picture is the first of another scene.
    Wanted,
    /// For how long it has faded.
    Going(Duration),
    /// Since when it fades, in seconds of the song, and what plays.
    WithSong(f64, (u64, u32)),
    /// A show says how far it has come; whether the light of what goes is kept.
    ActionValue(f32, bool),
}

/// A picture that is begun.
#[derive(Clone, Copy)]
pub(super) struct Begun<'a> {
    /// When.
    pub now: Instant,
    /// What it shows.
    pub moment: &'a Moment,
    /// Whether the song runs.
    pub runs: bool,
    /// Whether the scene that goes was drawn under it at the same moment.
    pub is_live: bool,
}

impl Fading {
    /// Fades take this many seconds; 0 is a cut.
    pub(super) fn of(seconds: f64) -> Self {
        let length = Duration::from_secs_f64(seconds);
        let (from, state) = (From::Scene, State::None);
        Self {
            length,
            cuts: false,
            next: None,
            going: length,
            from,
            state,
            begun: None,
            fraction: 0.0,
            announced: false,
        }
    }

    /// How many seconds a fade takes.
    pub(super) fn seconds(&self) -> f64 {
        self.length.as_secs_f64()
    }

    /// From now on fades take this many seconds; 0 is a cut. Returns what is said.
    pub(crate) fn set_seconds(&mut self, seconds: f64) -> String {
        self.length = Duration::try_from_secs_f64(seconds).unwrap_or_default();
        self.cuts = false;
        match seconds > 0.0 {
            true => format!("scenes fade into each other for {seconds:.1} s"),
            false => "scenes are cut".to_owned(),
        }
    }

    /// Whether scenes are cut.
    pub(crate) fn cuts(&self) -> bool {
        self.cuts || self.length.is_zero()
    }

    /// From now on scenes are cut, or fade as they did before. Returns what is said.
    pub(crate) fn set_cuts(&mut self, cuts: bool) -> String {
        self.cuts = cuts;
        match cuts {
            true => "scenes are cut".to_owned(),
            false => self.set_seconds(self.seconds()),
        }
    }

    /// The next picture shows another scene.
    pub(super) fn want(&mut self) {
        let usual = if self.cuts { Duration::ZERO } else { self.length };
        self.going = self.next.take().unwrap_or(usual);
        (self.from, self.announced) = (From::Scene, false);
        self.state = if self.going.is_zero() { State::None } else { State::Wanted };
    }

    /// The next picture comes after one that was held, and that one fades away for so many seconds.
    pub(super) fn release(&mut self, seconds: f64) {
        self.next_takes(seconds);
        self.want();
        self.from = From::HeldPicture;
    }

    /// A picture that a show holds has this share of the next ones; without a share it is gone.
    pub(super) fn mix_held(&mut self, fraction: Option<f32>) {
        match (fraction, self.state) {
            (Some(fraction), State::ActionValue(_, kept)) => self.state = State::ActionValue(fraction, kept),
            (Some(fraction), _) => {
                (self.state, self.from) = (State::ActionValue(fraction, false), From::HeldPicture)
            }
            (None, State::ActionValue(..)) => self.state = State::None,
            (None, _) => {}
        }
    }

    /// The show holds another picture than before: the last one that was drawn, in which the one before has its share.
    pub(crate) fn hold_anew(&mut self) {
        if let State::ActionValue(_, kept) = &mut self.state {
            *kept = false;
        }
    }

    /// The next change takes this many seconds instead.
    pub(super) fn next_takes(&mut self, seconds: f64) {
        self.next = Some(Duration::try_from_secs_f64(seconds).unwrap_or_default());
    }

    /// The next change takes as long as changes take.
    pub(super) fn next_takes_the_usual(&mut self) {
        self.next = None;
    }

    /// What comes next does not fade.
    pub(super) fn cut(&mut self) {
        (self.state, self.next) = (State::None, None);
    }

    /// Whether the next picture may differ from this one because of a fade.
    pub(super) fn goes_on(&self) -> bool {
        self.state != State::None
    }

    /// Whether the next picture differs from this one because of a fade, although the song stands still.
    pub(super) fn goes_on_by_itself(&self) -> bool {
        matches!(self.state, State::Wanted | State::Going(_))
    }

    /// Whether a fade goes with the song.
    pub(super) fn follows_song(&self) -> bool {
        matches!(self.state, State::WithSong(..))
    }

    /// Whether the next picture is the first one of a fade.
    pub(crate) fn is_to_begin(&self) -> bool {
        self.state == State::Wanted
    }

    /// The share that the scene which goes has at a moment; none if no scene fades away then.
    pub(super) fn fraction_of_scene(&self, moment: &Moment) -> Option<f32> {
        match self.state {
            _ if self.from != From::Scene => None,
            State::None | State::ActionValue(..) => None,
            State::Wanted => Some(1.0),
            State::Going(_) => Some(self.fraction),
            State::WithSong(..) => self.fraction_in_song(moment),
        }
    }

    /// The share of a picture that was held in the last picture.
    pub(crate) fn fraction_held(&self) -> f32 {
        if self.from == From::HeldPicture && self.goes_on() { self.fraction } else { 0.0 }
    }

    /// How long a scene fades away with the song, and since when, in seconds; none if there is no such fade.
    pub(super) fn of_scene_with_song(&self) -> Option<(f64, f64)> {
        match self.state {
            State::WithSong(start, _) if self.from == From::Scene => Some((self.going.as_secs_f64(), start)),
            _ => None,
        }
    }

    /// Says in the log that a fade begins, once.
    pub(super) fn announce(&mut self) {
        if self.is_to_begin() && !std::mem::replace(&mut self.announced, true) {
            tracing::info!("a fade begins");
        }
    }

    /// Tells the renderer, before a picture is begun, what of an older one is mixed into it.
    pub(super) fn begin_picture(&mut self, renderer: &mut Renderer, begun: Begun<'_>) {
        let keeps = matches!(self.state, State::Wanted | State::ActionValue(_, false)) && !begun.is_live;
        if keeps {
            let kept = renderer.keep_light().unwrap_or_else(|error: GpuError| {
                tracing::info!("no fade: {error}");
                false
            });
            match &mut self.state {
                State::ActionValue(_, is_kept) => *is_kept = kept,
                state if !kept => *state = State::None,
                _ => {}
            }
        }
        let fraction = self.step(begun);
        renderer.set_fade(fraction);
    }

    /// The share of what goes in a picture that is begun; none if there is no fade, or no longer.
    fn step(&mut self, begun: Begun<'_>) -> Option<f32> {
        let since = self
            .begun
            .replace(begun.now)
            .map_or(Duration::ZERO, |last| begun.now.saturating_duration_since(last));
        let fraction = match self.state {
            State::None | State::ActionValue(_, false) => return None,
            State::ActionValue(fraction, true) => Some(fraction),
            State::Wanted => {
                self.announce();
                let time = begun.moment.song_time;
                // Texts tell moments to the millisecond; and the first picture is one of both.
                let start = ((time * 1e3).floor() - 1.0) / 1e3;
                self.state = match begun.runs && start >= 0.0 {
                    true => State::WithSong(start, of_what(begun.moment)),
                    false => State::Going(Duration::ZERO),
                };
                if self.follows_song() { self.fraction_in_song(begun.moment) } else { Some(1.0) }
            }
            State::Going(gone) => {
                let gone = gone + since.min(STEP_MAX);
                self.state = State::Going(gone);
                let left = 1.0 - gone.as_secs_f64() / self.going.as_secs_f64();
                (left > 0.0).then_some(left as f32)
            }
            State::WithSong(..) => self.fraction_in_song(begun.moment),
        };
        match fraction {
            Some(fraction) => self.fraction = fraction,
            None => {
                self.state = State::None;
                tracing::info!("a fade ends");
            }
        }
        fraction
    }

    /// As [`crate::show::Plan::at`] has it, so that a recording has the same share.
    fn fraction_in_song(&self, moment: &Moment) -> Option<f32> {
        let State::WithSong(start, of) = self.state else { return None };
        let gone = (moment.song_time - start) / self.going.as_secs_f64();
        (of == of_what(moment) && gone > 0.0 && gone < 1.0).then_some(1.0 - gone as f32)
    }
}

/// The track that plays, and for which time in turn.
fn of_what(moment: &Moment) -> (u64, u32) {
    (moment.track, moment.lap)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(song_time: f64) -> Moment {
        Moment { song_time, track: 3, ..Moment::default() }
    }

    fn begun(now: Instant, moment: &Moment, runs: bool) -> Begun<'_> {
        Begun { now, moment, runs, is_live: true }
    }

    #[test]
    fn a_fade_takes_its_time_and_slow_pictures_make_no_cut_of_it() {
        let start = Instant::now();
        let mut fading = Fading::of(0.5);
        let stands = at(7.0);
        let fraction =
            |fading: &mut Fading, ms| fading.step(begun(start + Duration::from_millis(ms), &stands, false));
        assert_eq!(fraction(&mut fading, 0), None);
        fading.want();
        assert!(fading.goes_on());
        // The scene that goes stood for a while.
        assert_eq!(fraction(&mut fading, 9_000), Some(1.0));
        assert_eq!(fraction(&mut fading, 9_100), Some(0.8));
        assert_eq!(fraction(&mut fading, 9_200), Some(0.6));
        // Seconds in one picture.
        assert_eq!(fraction(&mut fading, 14_200), Some(0.35));
        assert_eq!(fraction(&mut fading, 14_300), Some(0.15));
        assert_eq!((fraction(&mut fading, 14_400), fading.goes_on()), (None, false));
    }

    #[test]
    fn while_a_song_plays_a_fade_goes_with_it() {
        let now = Instant::now();
        let mut fading = Fading::of(2.0);
        fading.want();
        let fraction = fading.step(begun(now, &at(10.25), true));
        assert_eq!((fraction, fading.of_scene_with_song()), (Some(1.0 - 0.0005), Some((2.0, 10.249))));
        // The song rests, and goes on; what shows follows from the moment.
        for (time, wanted) in [(11.249, Some(0.5)), (11.249, Some(0.5)), (10.749, Some(0.75))] {
            let found = fading.step(begun(now, &at(time), false));
            assert_eq!(found.map(|found| (found * 1e4).round() / 1e4), wanted);
            assert!(fading.follows_song() && !fading.goes_on_by_itself());
        }
        assert_eq!(fading.step(begun(now, &at(12.5), true)), None);
        assert!(!fading.goes_on());
        fading.want();
        fading.step(begun(now, &at(20.0), true));
        let another = Moment { track: 4, ..at(20.5) };
        assert_eq!(fading.step(begun(now, &another, true)), None, "another track plays");
    }

    #[test]
    fn a_fade_without_length_is_a_cut() {
        let mut fading = Fading::of(0.0);
        fading.want();
        assert!(!fading.goes_on());
        fading.set_seconds(3.0);
        fading.set_cuts(true);
        fading.want();
        assert!(!fading.goes_on());
        fading.set_cuts(false);
        fading.want();
        assert!(fading.goes_on());
    }

    #[test]
    fn a_picture_that_was_held_is_no_scene_that_goes() {
        let now = Instant::now();
        let mut fading = Fading::of(2.0);
        fading.release(1.0);
        assert_eq!(fading.step(begun(now, &at(4.0), false)), Some(1.0));
        assert_eq!((fading.fraction_held(), fading.fraction_of_scene(&at(4.0))), (1.0, None));
        fading.cut();
        assert_eq!(fading.fraction_held(), 0.0);
        fading.mix_held(Some(0.25));
        assert_eq!(fading.step(begun(now, &at(4.0), true)), None, "no light of it is kept");
        fading.state = State::ActionValue(0.25, true);
        fading.hold_anew();
        assert_eq!(
            fading.state,
            State::ActionValue(0.25, false),
            "the light of another picture is to be kept"
        );
        fading.mix_held(None);
        assert!(!fading.goes_on());
    }
}
