//! What is done to every picture alike, whatever shows: brightness, blackout, and holding the last picture.

use std::time::{Duration, Instant};

use crate::show::Picture;

/// See the module.
#[derive(Debug, Clone)]
pub(crate) struct MasterOutput {
    /// 0..1 of the light.
    brightness: f32,
    /// How long a blackout takes to come and to go, and a picture that was held to give way.
    fade: Duration,
    is_black: bool,
    /// How much light the blackout leaves, 0..1, and when that was so.
    light: (f32, Option<Instant>),
    is_frozen: bool,
    /// What the show does besides.
    shown: Picture,
}

impl MasterOutput {
    /// Everything shows, by a brightness of 0..1; what is changed takes `fade` seconds.
    pub(crate) fn new(brightness: f32, fade: f64) -> Self {
        let mut master_output = Self {
            brightness: 1.0,
            fade: Duration::ZERO,
            is_black: false,
            light: (1.0, None),
            is_frozen: false,
            shown: Picture::PLAIN,
        };
        master_output.set_brightness(brightness);
        master_output.set_fade(fade);
        master_output
    }

    /// From now on pictures have this share of their light, 0..1.
    pub(crate) fn set_brightness(&mut self, brightness: f32) {
        if brightness.is_finite() {
            self.brightness = brightness.clamp(0.0, 1.0);
        }
    }

    /// From now on a change takes this many seconds.
    pub(crate) fn set_fade(&mut self, seconds: f64) {
        self.fade = Duration::try_from_secs_f64(seconds).unwrap_or_default();
    }

    /// How long a change takes, in seconds.
    pub(crate) fn fade_seconds(&self) -> f64 {
        self.fade.as_secs_f64()
    }

    /// Begins a blackout, or ends it. Returns whether it will be black.
    pub(crate) fn toggle_blackout(&mut self, now: Instant) -> bool {
        // What has changed until now changed in the other direction.
        self.light = (self.light_at(now), Some(now));
        self.is_black = !self.is_black;
        self.is_black
    }

    /// Whether it is black, or on its way there.
    pub(crate) fn is_black(&self) -> bool {
        self.is_black
    }

    /// Holds the picture that shows, or lets it go. Returns whether it is held.
    pub(crate) fn toggle_freeze(&mut self) -> bool {
        self.is_frozen = !self.is_frozen;
        self.is_frozen
    }

    /// Whether a hand holds the picture.
    pub(crate) fn is_frozen(&self) -> bool {
        self.is_frozen
    }

    /// From now on the show does this to pictures. Returns what it did before.
    pub(crate) fn follow_show(&mut self, shown: Picture) -> Picture {
        std::mem::replace(&mut self.shown, shown)
    }

    /// Whether the picture is held, by a hand or by the show.
    pub(crate) fn hold(&self) -> bool {
        self.is_frozen || self.shown.held.is_some_and(|held| held.fraction >= 1.0)
    }

    /// Whether the show has a share of a picture that is held.
    pub(crate) fn is_held_by_show(&self) -> bool {
        self.shown.held.is_some()
    }

    /// Whether no hand does anything to a picture that is shown at `now`.
    pub(crate) fn are_idle(&self, now: Instant) -> bool {
        !self.is_frozen && self.brightness >= 1.0 && self.light_at(now) >= 1.0
    }

    /// How much of its light a picture has that is shown at `now`, 0..1. A fade is even in light, not in the numbers of
    /// the screen.
    pub(crate) fn gain(&self, now: Instant) -> f32 {
        self.brightness * self.light_at(now) * self.shown.brightness
    }

    fn light_at(&self, now: Instant) -> f32 {
        let (light, since) = self.light;
        let aim = if self.is_black { 0.0 } else { 1.0 };
        let Some(since) = since else { return aim };
        let passed = now.saturating_duration_since(since).as_secs_f32();
        match self.fade.as_secs_f32() {
            fade if passed >= fade => aim,
            fade if self.is_black => (light - passed / fade).max(aim),
            fade => (light + passed / fade).min(aim),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_blackout_fades_in_and_out_and_turns_round_where_it_is() {
        let start = Instant::now();
        let at = |ms| start + Duration::from_millis(ms);
        let mut master_output = MasterOutput::new(0.5, 1.0);
        assert_eq!(master_output.gain(at(0)), 0.5);
        assert!(master_output.toggle_blackout(at(0)));
        assert_eq!([0, 500, 1_000, 9_000].map(|ms| master_output.gain(at(ms))), [0.5, 0.25, 0.0, 0.0]);
        assert!(!master_output.toggle_blackout(at(9_000)));
        assert_eq!([9_000, 9_750, 10_000].map(|ms| master_output.gain(at(ms))), [0.0, 0.375, 0.5]);
        // Not before it was complete.
        master_output.toggle_blackout(at(20_000));
        master_output.toggle_blackout(at(20_400));
        assert!((master_output.gain(at(20_600)) - 0.4).abs() < 1e-6);
        assert_eq!(master_output.gain(at(21_500)), 0.5);
    }

    #[test]
    fn without_a_fade_it_cuts_and_nonsense_changes_no_brightness() {
        let now = Instant::now();
        let mut master_output = MasterOutput::new(1.0, 0.0);
        master_output.toggle_blackout(now);
        assert_eq!(master_output.gain(now), 0.0);
        master_output.toggle_blackout(now);
        assert_eq!(master_output.gain(now), 1.0);
        for (brightness, kept) in [(f32::NAN, 1.0), (-3.0, 0.0), (7.0, 1.0)] {
            master_output.set_brightness(brightness);
            assert_eq!(master_output.gain(now), kept);
        }
        master_output.set_fade(f64::NAN);
        assert_eq!(master_output.fade_seconds(), 0.0);
    }
}
