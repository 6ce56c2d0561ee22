//! Automatic gain, so that quiet and loud sources move a scene alike.
//!
//! **What scenes see is levelled, what is measured is not.** The gain depends only on the loudest moment of the last
//! 1.2 s. It is 0 dB within the range of published music, so that a song's quiet passages stay quiet, and 0 dB for
//! sound as quiet as a room.

use super::bands::decibels;
use super::smoothing::Follower;

/// Whether the 0..1 values that scenes see are levelled. Values in decibels never are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Gain {
    /// Quiet sound is lifted and loud sound lowered, both by no more than is needed.
    #[default]
    Auto,
    /// No gain: scenes see the sound as it is.
    Off,
}

/// Where the loudest recent moment lies between these levels, in decibels, nothing is changed: quiet and loud
/// passages of published music lie there, and they should stay different.
const KEPT_DB: (f32, f32) = (-20.0, -4.0);

/// From the first level down to the second the lift is taken back to nothing: sound that quiet is the room.
const GATE_DB: (f32, f32) = (-40.0, -50.0);

/// How long the loudest moment counts, in seconds: longer than the time between two beats, so that the gain does not
/// pump.
const HELD_SECONDS: f64 = 1.2;

/// Time constant of the power, in seconds.
const POWER_SECONDS: f64 = 0.04;

/// Time constants of the gain, in seconds: upwards, and downwards.
const GAIN_RISE: f64 = 0.10;
/// See [`GAIN_RISE`].
const GAIN_FALL: f64 = 0.03;

/// The gain for a level, both in decibels.
///
/// | level of the loudest moment | gain |
/// |---|---|
/// | above -4 dB | down to -4 dB |
/// | -20..-4 dB | 0 |
/// | -40..-20 dB | up to -20 dB |
/// | -50..-40 dB | from 0 to 20 dB |
/// | below -50 dB | 0 |
fn gain_at(level_db: f32) -> f32 {
    let most = KEPT_DB.0 - GATE_DB.0;
    let open = ((level_db - GATE_DB.1) / (GATE_DB.0 - GATE_DB.1)).clamp(0.0, 1.0);
    let lift = (KEPT_DB.0 - level_db).clamp(0.0, most).min(most * open);
    lift + (KEPT_DB.1 - level_db).min(0.0)
}

/// Follows the level and gives the gain. It forgets everything within seconds, so it soon agrees again after a seek.
pub(super) struct AutoGain {
    gain: Gain,
    power: f32,
    power_follower: Follower,
    gain_follower: Follower,
    gain_db: f32,
    /// The followed powers of the last moments, in a ring.
    held: Vec<f32>,
    next: usize,
}

impl AutoGain {
    /// For moments `hop_seconds` apart.
    pub(super) fn new(gain: Gain, hop_seconds: f64) -> Self {
        Self {
            gain,
            power: 0.0,
            power_follower: Follower::new(POWER_SECONDS, POWER_SECONDS, hop_seconds),
            gain_follower: Follower::new(GAIN_RISE, GAIN_FALL, hop_seconds),
            gain_db: 0.0,
            held: vec![0.0; (HELD_SECONDS / hop_seconds).ceil() as usize],
            next: 0,
        }
    }

    /// Levels from now on, or no longer; what is heard goes over to it within tenths of a second.
    pub(super) fn set(&mut self, gain: Gain) {
        self.gain = gain;
    }

    /// Forgets everything.
    pub(super) fn restart(&mut self) {
        self.held.fill(0.0);
        (self.power, self.gain_db) = (0.0, 0.0);
    }

    /// Takes the power of a moment (1: a full-scale sine in both channels). Returns the gain in decibels.
    pub(super) fn follow(&mut self, power: f32) -> f32 {
        self.power_follower.follow(&mut self.power, power);
        if let Some(slot) = self.held.get_mut(self.next) {
            *slot = self.power;
        }
        self.next = (self.next + 1) % self.held.len();
        let loudest = self.held.iter().fold(0.0_f32, |loudest, power| loudest.max(*power));
        let wanted = if self.gain == Gain::Auto { gain_at(decibels(loudest)) } else { 0.0 };
        self.gain_follower.follow(&mut self.gain_db, wanted);
        self.gain_db
    }
}

/// The factor by which a gain in decibels multiplies amplitudes.
pub(super) fn amplitude(gain_db: f32) -> f32 {
    if gain_db == 0.0 { 1.0 } else { 10.0_f32.powf(gain_db / 20.0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_is_that_of_the_table() {
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
    fn a_change_is_gone_over_to_and_without_one_there_is_no_gain() {
        let mut gain = AutoGain::new(Gain::Off, 0.01);
        let after = |gain: &mut AutoGain| (0..200).fold(0.0, |_, _| gain.follow(1e-3));
        assert_eq!(after(&mut gain).to_bits(), 0.0_f32.to_bits());
        gain.set(Gain::Auto);
        assert!(after(&mut gain) > 9.0, "quiet sound is lifted");
        gain.set(Gain::Off);
        assert!(gain.follow(1e-3) > 1.0, "it falls at once");
        assert!(after(&mut gain).abs() < 1e-3);
    }
}
