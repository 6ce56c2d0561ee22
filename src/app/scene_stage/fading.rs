//! How one scene gives way to another in the picture: it fades, or is cut. Fades of a show are in [`super::mixing`].
//!
//! The scene that goes stands still meanwhile: its last picture is mixed into those of the one that comes
//! ([`Renderer::keep_light`]).

use std::time::{Duration, Instant};

use crate::gpu::error::GpuError;
use crate::gpu::renderer::Renderer;

/// The most that one picture takes from a fade, so that a picture that takes long does not make a cut of it.
const STEP_MAX: Duration = Duration::from_millis(125);

/// See the module.
pub(super) struct Fading {
    /// How long a fade takes; zero is a cut.
    length: Duration,
    /// How long the next one takes instead.
    next: Option<Duration>,
    /// How long the one takes that goes on.
    going: Duration,
    state: State,
    /// When the last picture was begun.
    begun: Option<Instant>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum State {
    None,
    /// The next picture is the first of another scene.
    Wanted,
    /// For how long it has faded.
    Going(Duration),
}

impl Fading {
    /// Fades take this many seconds; 0 is a cut.
    pub(super) fn of(seconds: f64) -> Self {
        let length = Duration::from_secs_f64(seconds);
        Self { length, next: None, going: length, state: State::None, begun: None }
    }

    /// How many seconds a fade takes.
    pub(super) fn seconds(&self) -> f64 {
        self.length.as_secs_f64()
    }

    /// The next picture shows another scene.
    pub(super) fn want(&mut self) {
        self.going = self.next.take().unwrap_or(self.length);
        self.state = if self.going.is_zero() { State::None } else { State::Wanted };
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

    /// Whether the next picture differs from this one because of a fade.
    pub(super) fn goes_on(&self) -> bool {
        self.state != State::None
    }

    /// Tells the renderer, before a picture is begun at `now`, what of an older one is mixed into it.
    pub(super) fn begin_picture(&mut self, renderer: &mut Renderer, now: Instant) {
        if self.state == State::Wanted {
            let kept = renderer.keep_light().unwrap_or_else(|error: GpuError| {
                tracing::info!("no fade: {error}");
                false
            });
            self.state = if kept { State::Going(Duration::ZERO) } else { State::None };
            if kept {
                tracing::info!("a fade begins");
            }
        }
        let share = self.share(now);
        renderer.set_fade(share);
    }

    /// The share of the picture that goes in one that is begun at `now`; none if there is no fade, or no longer.
    fn share(&mut self, now: Instant) -> Option<f32> {
        let since =
            self.begun.replace(now).map_or(Duration::ZERO, |last| now.saturating_duration_since(last));
        let State::Going(gone) = self.state else { return None };
        let gone = gone + since.min(STEP_MAX);
        if gone >= self.going {
            self.state = State::None;
            tracing::info!("a fade ends");
            return None;
        }
        self.state = State::Going(gone);
        Some((1.0 - gone.as_secs_f64() / self.going.as_secs_f64()) as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fade_takes_its_time_and_slow_pictures_make_no_cut_of_it() {
        let start = Instant::now();
        let mut fading = Fading::of(0.5);
        assert_eq!(fading.share(start), None);
        fading.want();
        assert!(fading.goes_on());
        fading.state = State::Going(Duration::ZERO);
        let at = |ms| start + Duration::from_millis(ms);
        assert_eq!(fading.share(at(100)), Some(0.8));
        assert_eq!(fading.share(at(200)), Some(0.6));
        // Seconds in one picture.
        assert_eq!(fading.share(at(5_200)), Some(0.35));
        assert_eq!(fading.share(at(5_300)), Some(0.15));
        assert_eq!((fading.share(at(5_400)), fading.goes_on()), (None, false));
    }

    #[test]
    fn a_fade_without_length_is_a_cut() {
        let mut fading = Fading::of(0.0);
        fading.want();
        assert!(!fading.goes_on());
    }
}
