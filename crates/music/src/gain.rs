//! Automatic gain, so that quiet and loud sources move a scene in the same way. The gain applies to the values that
//! scenes see, not to measurements in decibels, and depends only on the loudest moment of the last 1.2 s. The gain is 0
//! dB for room noise and for levels of published music, so that a song's quiet passages stay quiet.

use super::bands::decibels;
use super::smoothing::Follower;

/// Automatic gain, on or off. It applies to the 0..1 values that scenes see, never to values in decibels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Gain {
    /// Raises quiet sound and lowers loud sound, both as little as possible.
    #[default]
    Auto,
    /// No gain.
    Off,
}

/// If the loudest recent level is in this range, in decibels, the gain is 0 dB. Published music is in this range.
const KEPT_DB: (f32, f32) = (-20.0, -4.0);

/// From the first to the second level, in decibels, the gain falls to 0 dB. Sound below both levels is room noise.
const GATE_DB: (f32, f32) = (-40.0, -50.0);

/// The time for which the loudest moment counts, in seconds: longer than a beat, so that the gain does not pump.
const HELD_SECONDS: f64 = 1.2;

/// Time constants of the power, of a rising gain and of a falling gain, in seconds.
const POWER_SECONDS: f64 = 0.04;
const GAIN_RISE: f64 = 0.10;
const GAIN_FALL: f64 = 0.03;

/// Returns the gain for a level, both in decibels.
///
/// | level of the loudest moment | gain |
/// |---|---|
/// | above -4 dB | lowers the sound to -4 dB |
/// | -20..-4 dB | 0 dB |
/// | -40..-20 dB | raises the sound to -20 dB |
/// | -50..-40 dB | rises from 0 to 20 dB |
/// | below -50 dB | 0 dB |
fn gain_at(level_db: f32) -> f32 {
    let most = KEPT_DB.0 - GATE_DB.0;
    let open = ((level_db - GATE_DB.1) / (GATE_DB.0 - GATE_DB.1)).clamp(0.0, 1.0);
    let lift = (KEPT_DB.0 - level_db).clamp(0.0, most).min(most * open);
    lift + (KEPT_DB.1 - level_db).min(0.0)
}

/// Computes the gain from the level of the last seconds only, so that a seek affects the gain only briefly.
pub(super) struct AutoGain {
    gain: Gain,
    power: f32,
    power_follower: Follower,
    gain_follower: Follower,
    gain_db: f32,
    /// The powers of the last [`HELD_SECONDS`], the newest first.
    held: Vec<f32>,
}

impl AutoGain {
    pub(super) fn new(gain: Gain, hop_seconds: f64) -> Self {
        Self {
            gain,
            power: 0.0,
            power_follower: Follower::new(POWER_SECONDS, POWER_SECONDS, hop_seconds),
            gain_follower: Follower::new(GAIN_RISE, GAIN_FALL, hop_seconds),
            gain_db: 0.0,
            held: vec![0.0; (HELD_SECONDS / hop_seconds).ceil() as usize],
        }
    }

    /// Turns the gain on or off. The gain then changes smoothly within tenths of a second.
    pub(super) fn set(&mut self, gain: Gain) {
        self.gain = gain;
    }

    pub(super) fn restart(&mut self) {
        self.held.fill(0.0);
        (self.power, self.gain_db) = (0.0, 0.0);
    }

    /// Processes the power of a moment (1: a full-scale sine in both channels). Returns the gain in decibels.
    pub(super) fn follow(&mut self, power: f32) -> f32 {
        self.power_follower.follow(&mut self.power, power);
        self.held.rotate_right(1);
        self.held[0] = self.power;
        let loudest = self.held.iter().fold(0.0_f32, |loudest, power| loudest.max(*power));
        let wanted = if self.gain == Gain::Auto { gain_at(decibels(loudest)) } else { 0.0 };
        self.gain_follower.follow(&mut self.gain_db, wanted);
        self.gain_db
    }
}

pub(super) fn amplitude(gain_db: f32) -> f32 {
    if gain_db == 0.0 { 1.0 } else { 10.0_f32.powf(gain_db / 20.0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gain_follows_the_table() {
        for (level, gain) in [
            (10.0, -14.0),
            (-4.0, 0.0),
            (-12.0, 0.0),
            (-20.0, 0.0),
            (-30.0, 10.0),
            (-40.0, 20.0),
            (-45.0, 10.0),
            (-50.0, 0.0),
            (-120.0, 0.0),
        ] {
            assert!((gain_at(level) - gain).abs() < 1e-4, "{level} dB: {} dB", gain_at(level));
        }
    }

    #[test]
    fn changes_of_the_gain_setting_are_smooth() {
        let mut gain = AutoGain::new(Gain::Off, 0.01);
        let after = |gain: &mut AutoGain| (0..200).fold(0.0, |_, _| gain.follow(1e-3));
        assert_eq!(after(&mut gain).to_bits(), 0.0_f32.to_bits());
        gain.set(Gain::Auto);
        assert!(after(&mut gain) > 9.0, "quiet sound is raised");
        gain.set(Gain::Off);
        assert!(gain.follow(1e-3) > 1.0, "the gain falls gradually");
        assert!(after(&mut gain).abs() < 1e-3);
    }
}
