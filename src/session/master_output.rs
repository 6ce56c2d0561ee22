//! The master output: brightness, blackout and freeze, which apply to every frame.

use std::time::{Duration, Instant};

use crate::show::ShownPicture;

#[derive(Debug, Clone)]
pub(crate) struct MasterOutput {
    /// Fraction of the light, 0..1.
    pub(crate) brightness: f32,
    /// Duration of fades to and from black, and of the fade after a freeze.
    pub(crate) fade: Duration,
    pub(crate) is_black: bool,
    /// Light at the start of the last fade to or from black, 0..1, and the start time of that fade.
    light: (f32, Option<Instant>),
    pub(crate) is_frozen: bool,
    pub(crate) shown: ShownPicture,
}

impl MasterOutput {
    /// Starts without blackout or freeze, with a brightness of 0..1. Changes take `fade` seconds.
    pub(crate) fn new(brightness: f32, fade: f64) -> Self {
        let fade = Duration::try_from_secs_f64(fade).unwrap_or_default();
        let (light, shown) = ((1.0, None), ShownPicture::PLAIN);
        Self { brightness, fade, is_black: false, light, is_frozen: false, shown }
    }

    /// Sets the fraction of the light, 0..1. Ignores values that are not finite.
    pub(crate) fn set_brightness(&mut self, brightness: f32) {
        if brightness.is_finite() {
            self.brightness = brightness.clamp(0.0, 1.0);
        }
    }

    pub(crate) fn set_fade(&mut self, seconds: f64) {
        self.fade = Duration::try_from_secs_f64(seconds).unwrap_or_default();
    }

    /// Starts or ends a blackout. Returns `true` if it starts.
    pub(crate) fn toggle_blackout(&mut self, now: Instant) -> bool {
        // Start from the current light: an opposite fade may be unfinished.
        self.light = (self.light_at(now), Some(now));
        self.is_black = !self.is_black;
        self.is_black
    }

    /// Freezes or releases the frame. Returns `true` if it is frozen.
    pub(crate) fn toggle_freeze(&mut self) -> bool {
        self.is_frozen = !self.is_frozen;
        self.is_frozen
    }

    /// True if the frame is frozen by the user or held by the show.
    pub(crate) fn hold(&self) -> bool {
        self.is_frozen || self.shown.held.is_some_and(|held| held.fraction >= 1.0)
    }

    /// Returns `true` if the user's controls do not change a frame that is shown at `now`.
    pub(crate) fn are_idle(&self, now: Instant) -> bool {
        !self.is_frozen && self.brightness >= 1.0 && self.light_at(now) >= 1.0
    }

    /// Fraction of the light in a frame shown at `now`, 0..1. Fades are linear in light, not in encoded colours.
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
    fn a_blackout_fades_and_can_be_reversed_halfway() {
        let start = Instant::now();
        let at = |ms| start + Duration::from_millis(ms);
        let mut master_output = MasterOutput::new(0.5, 1.0);
        assert_eq!(master_output.gain(at(0)), 0.5);
        assert!(master_output.toggle_blackout(at(0)));
        assert_eq!([0, 500, 1_000, 9_000].map(|ms| master_output.gain(at(ms))), [0.5, 0.25, 0.0, 0.0]);
        assert!(!master_output.toggle_blackout(at(9_000)));
        assert_eq!([9_000, 9_750, 10_000].map(|ms| master_output.gain(at(ms))), [0.0, 0.375, 0.5]);
        // The second toggle follows before the first fade is complete.
        master_output.toggle_blackout(at(20_000));
        master_output.toggle_blackout(at(20_400));
        assert!((master_output.gain(at(20_600)) - 0.4).abs() < 1e-6);
        assert_eq!(master_output.gain(at(21_500)), 0.5);
    }

    #[test]
    fn without_a_fade_it_cuts_and_invalid_values_are_ignored() {
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
        assert_eq!(master_output.fade.as_secs_f64(), 0.0);
    }
}
