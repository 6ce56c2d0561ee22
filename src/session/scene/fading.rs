//! The change from one scene to another: a fade or a cut. [`super::scene_change`] draws the moving outgoing scene, also
//! in a show's fades. If the outgoing scene cannot be drawn any more, its last frame is mixed into the frames of the
//! incoming scene ([`Renderer::keep_light`]). A frozen frame fades in the same way.
//!
//! **A fade follows the song's time,** as a show's fades do: a frame depends only on its moment of the song, and a
//! recording has the same fade. Only a fade that begins during a pause uses the clock.

use std::time::{Duration, Instant};

use crate::clock;
use crate::gpu::{GpuError, Renderer};
use mariana_player::Moment;

/// Maximum progress in one frame of a fade by the clock, so that a slow frame does not turn the fade into a cut.
const STEP_MAX: Duration = Duration::from_millis(125);

#[derive(Default)]
pub(crate) struct Fading {
    /// Usual duration of a fade; zero cuts.
    length: Duration,
    /// True if scenes are cut regardless of `length`.
    cuts: bool,
    /// Duration of the next fade, if it differs from the usual one.
    pub(crate) next: Option<Duration>,
    going: Duration,
    from: From,
    state: State,
    begun: Option<Instant>,
    /// The fraction of the outgoing scene in the last frame of a running fade.
    fraction: f32,
    announced: bool,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
enum From {
    #[default]
    Scene,
    HeldPicture,
}

#[derive(Debug, Clone, Copy, Default, PartialEq)]
enum State {
    #[default]
    None,
    /// A fade begins with the next frame, the first one of another scene.
    Wanted,
    /// A fade by the clock, and its elapsed time.
    Going(Duration),
    /// A fade in song time: its start in seconds, and the track with the number of its repetition.
    WithSong(f64, (u64, u32)),
    /// A fade whose fraction is set by a show; `true` once the light of the held frame is stored.
    Given(f32, bool),
}

impl Fading {
    /// Fades take this many seconds; 0 cuts.
    pub(super) fn of(seconds: f64) -> Self {
        Self { length: Duration::from_secs_f64(seconds), ..Self::default() }
    }

    pub(crate) fn seconds(&self) -> f64 {
        self.length.as_secs_f64()
    }

    /// Sets the duration of fades in seconds; 0 cuts. Returns a message.
    pub(crate) fn set_seconds(&mut self, seconds: f64) -> String {
        self.length = Duration::try_from_secs_f64(seconds).unwrap_or_default();
        self.cuts = false;
        match seconds > 0.0 {
            true => format!("scenes fade into each other for {seconds:.1} s"),
            false => "scenes are cut".to_owned(),
        }
    }

    pub(crate) fn cuts(&self) -> bool {
        self.cuts || self.length.is_zero()
    }

    /// Cuts scenes from now on, or restores the fades. Returns a message.
    pub(crate) fn set_cuts(&mut self, cuts: bool) -> String {
        self.cuts = cuts;
        match cuts {
            true => "scenes are cut".to_owned(),
            false => self.set_seconds(self.seconds()),
        }
    }

    /// Requests a fade, because the next frame shows another scene.
    pub(super) fn request(&mut self) {
        let usual = if self.cuts { Duration::ZERO } else { self.length };
        self.going = self.next.take().unwrap_or(usual);
        (self.from, self.announced) = (From::Scene, false);
        self.state = if self.going.is_zero() { State::None } else { State::Wanted };
    }

    /// Notes that the frozen frame is released and fades out within `seconds`.
    pub(super) fn release(&mut self, seconds: f64) {
        self.next = Some(Duration::try_from_secs_f64(seconds).unwrap_or_default());
        self.request();
        self.from = From::HeldPicture;
    }

    /// Mixes a `fraction` of the frame that a show holds into the next frames. `None` ends the fade.
    pub(super) fn mix_held(&mut self, fraction: Option<f32>) {
        match (fraction, self.state) {
            (Some(fraction), State::Given(_, kept)) => self.state = State::Given(fraction, kept),
            (Some(fraction), _) => {
                (self.state, self.from) = (State::Given(fraction, false), From::HeldPicture)
            }
            (None, State::Given(..)) => self.state = State::None,
            (None, _) => {}
        }
    }

    /// Notes that the show now holds the last drawn frame, which may still contain the previously held frame.
    pub(crate) fn hold_anew(&mut self) {
        if let State::Given(_, kept) = &mut self.state {
            *kept = false;
        }
    }

    /// Cuts: ends the fade in progress, and forgets the duration of the next fade.
    pub(super) fn cut(&mut self) {
        (self.state, self.next) = (State::None, None);
    }

    pub(super) fn goes_on(&self) -> bool {
        self.state != State::None
    }

    /// Returns `true` if a fade changes the next frame even while the song is paused.
    pub(super) fn goes_on_by_itself(&self) -> bool {
        matches!(self.state, State::Wanted | State::Going(_))
    }

    pub(super) fn follows_song(&self) -> bool {
        matches!(self.state, State::WithSong(..))
    }

    pub(crate) fn is_to_begin(&self) -> bool {
        self.state == State::Wanted
    }

    /// The fraction of the outgoing scene at a moment; `None` without a fade between scenes.
    pub(super) fn fraction_of_scene(&self, moment: &Moment) -> Option<f32> {
        match self.state {
            _ if self.from != From::Scene => None,
            State::None | State::Given(..) => None,
            State::Wanted => Some(1.0),
            State::Going(_) => Some(self.fraction),
            State::WithSong(..) => self.fraction_in_song(moment),
        }
    }

    pub(crate) fn fraction_held(&self) -> f32 {
        if self.from == From::HeldPicture && self.goes_on() { self.fraction } else { 0.0 }
    }

    /// Duration and start, in seconds of the song, of a fade between scenes that is in progress.
    pub(super) fn of_scene_with_song(&self) -> Option<(f64, f64)> {
        match self.state {
            State::WithSong(start, _) if self.from == From::Scene => Some((self.going.as_secs_f64(), start)),
            _ => None,
        }
    }

    pub(super) fn announce(&mut self) {
        if self.is_to_begin() && !std::mem::replace(&mut self.announced, true) {
            tracing::info!("a fade begins");
        }
    }

    /// Begins a frame. `runs` is true if the song is running, `is_live` if the outgoing scene was drawn for the same
    /// moment.
    pub(super) fn begin_picture(
        &mut self,
        renderer: &mut Renderer,
        moment: &Moment,
        runs: bool,
        is_live: bool,
    ) {
        let keeps = matches!(self.state, State::Wanted | State::Given(_, false)) && !is_live;
        if keeps {
            let kept = renderer.keep_light().unwrap_or_else(|error: GpuError| {
                tracing::info!("no fade: {error}");
                false
            });
            match &mut self.state {
                State::Given(_, is_kept) => *is_kept = kept,
                state if !kept => *state = State::None,
                _ => {}
            }
        }
        let fraction = self.step(clock::now(), moment, runs);
        renderer.set_fade(fraction);
    }

    /// The fraction of the outgoing scene in a frame that begins; `None` without a fade.
    fn step(&mut self, now: Instant, moment: &Moment, runs: bool) -> Option<f32> {
        let last = self.begun.replace(now);
        let since = last.map_or(Duration::ZERO, |last| now.saturating_duration_since(last));
        let fraction = match self.state {
            State::None | State::Given(_, false) => return None,
            State::Given(fraction, true) => Some(fraction),
            State::Wanted => {
                self.announce();
                let time = moment.song_time;
                // Start a millisecond early, so that the first frame is mixed. Round as cue lists do.
                let start = ((time * 1e3).floor() - 1.0) / 1e3;
                self.state = match runs && start >= 0.0 {
                    true => State::WithSong(start, of_what(moment)),
                    false => State::Going(Duration::ZERO),
                };
                if self.follows_song() { self.fraction_in_song(moment) } else { Some(1.0) }
            }
            State::Going(gone) => {
                let gone = gone + since.min(STEP_MAX);
                self.state = State::Going(gone);
                let left = 1.0 - gone.as_secs_f64() / self.going.as_secs_f64();
                (left > 0.0).then_some(left as f32)
            }
            State::WithSong(..) => self.fraction_in_song(moment),
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

    /// The same formula as in [`crate::show::Timeline::at`], so that a recording has the same fraction.
    fn fraction_in_song(&self, moment: &Moment) -> Option<f32> {
        let State::WithSong(start, of) = self.state else { return None };
        let gone = (moment.song_time - start) / self.going.as_secs_f64();
        (of == of_what(moment) && gone > 0.0 && gone < 1.0).then_some(1.0 - gone as f32)
    }
}

fn of_what(moment: &Moment) -> (u64, u32) {
    (moment.track, moment.lap)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(song_time: f64) -> Moment {
        Moment { song_time, track: 3, ..Moment::default() }
    }

    #[test]
    fn a_fade_takes_its_time_and_slow_frames_do_not_cut_it() {
        let start = Instant::now();
        let mut fading = Fading::of(0.5);
        let stands = at(7.0);
        let fraction =
            |fading: &mut Fading, ms| fading.step(start + Duration::from_millis(ms), &stands, false);
        assert_eq!(fraction(&mut fading, 0), None);
        fading.request();
        assert!(fading.goes_on());
        // The outgoing scene was shown for a while.
        assert_eq!(fraction(&mut fading, 9_000), Some(1.0));
        assert_eq!(fraction(&mut fading, 9_100), Some(0.8));
        assert_eq!(fraction(&mut fading, 9_200), Some(0.6));
        // One frame takes five seconds.
        assert_eq!(fraction(&mut fading, 14_200), Some(0.35));
        assert_eq!(fraction(&mut fading, 14_300), Some(0.15));
        assert_eq!((fraction(&mut fading, 14_400), fading.goes_on()), (None, false));
    }

    #[test]
    fn a_fade_follows_the_song_while_it_plays() {
        let now = Instant::now();
        let mut fading = Fading::of(2.0);
        fading.request();
        let fraction = fading.step(now, &at(10.25), true);
        assert_eq!((fraction, fading.of_scene_with_song()), (Some(1.0 - 0.0005), Some((2.0, 10.249))));
        // The song is paused and resumed; the fraction depends only on the moment.
        for (time, wanted) in [(11.249, Some(0.5)), (11.249, Some(0.5)), (10.749, Some(0.75))] {
            let found = fading.step(now, &at(time), false);
            assert_eq!(found.map(|found| (found * 1e4).round() / 1e4), wanted);
            assert!(fading.follows_song() && !matches!(fading.state, State::Wanted | State::Going(_)));
        }
        assert_eq!(fading.step(now, &at(12.5), true), None);
        assert!(!fading.goes_on());
        fading.request();
        fading.step(now, &at(20.0), true);
        let another = Moment { track: 4, ..at(20.5) };
        assert_eq!(fading.step(now, &another, true), None, "another track plays");
    }

    #[test]
    fn a_fade_without_length_is_a_cut() {
        let mut fading = Fading::of(0.0);
        fading.request();
        assert!(!fading.goes_on());
        fading.set_seconds(3.0);
        fading.set_cuts(true);
        fading.request();
        assert!(!fading.goes_on());
        fading.set_cuts(false);
        fading.request();
        assert!(fading.goes_on());
    }

    #[test]
    fn a_frozen_frame_is_not_an_outgoing_scene() {
        let now = Instant::now();
        let mut fading = Fading::of(2.0);
        fading.release(1.0);
        assert_eq!(fading.step(now, &at(4.0), false), Some(1.0));
        assert_eq!((fading.fraction_held(), fading.fraction_of_scene(&at(4.0))), (1.0, None));
        fading.cut();
        assert_eq!(fading.fraction_held(), 0.0);
        fading.mix_held(Some(0.25));
        assert_eq!(fading.step(now, &at(4.0), true), None, "its light is not kept yet");
        fading.state = State::Given(0.25, true);
        fading.hold_anew();
        assert_eq!(fading.state, State::Given(0.25, false), "the light of another frame must be kept");
        fading.mix_held(None);
        assert!(!fading.goes_on());
    }
}
