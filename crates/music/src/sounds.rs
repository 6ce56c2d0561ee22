//! Drums, notes, tonal and percussive levels, and loudness: features that are measured from the same hops and spectra
//! as the bands.

use super::StereoFrame;
use super::bands::height;
use super::drums::Drums;
use super::features::Features;
use super::loudness::Loudness;
use super::notes::Notes;
use super::resolution::Resolution;
use super::smoothing::Follower;
use super::split::Split;

/// Attack and release times of the tonal and percussive levels, in seconds.
const SPLIT_ATTACK: f64 = 0.010;
const SPLIT_RELEASE: f64 = 0.200;

pub(super) struct Sounds {
    /// The frames per hop, the sample rate, and true for centred windows.
    setup: (usize, f64, bool),
    pub(super) drums: Drums,
    loudness: Loudness,
    notes: Notes,
    split: Split,
    follower: Follower,
}

/// Creates the measurements that allocate no memory.
fn drums_and_notes(hop: usize, rate: f64, centred: bool) -> (Drums, Notes) {
    let (short, hop_seconds) = (hop * Resolution::Short.hops(), hop as f64 / rate);
    let drums = Drums::new(short / 2, rate / short as f64, hop_seconds, centred);
    (drums, Notes::new(hop, rate, hop_seconds))
}

impl Sounds {
    pub(super) fn new(hop: usize, rate: f64, centred: bool) -> Self {
        let hop_seconds = hop as f64 / rate;
        let middle = hop * Resolution::Middle.hops();
        let (drums, notes) = drums_and_notes(hop, rate, centred);
        Self {
            setup: (hop, rate, centred),
            drums,
            loudness: Loudness::new(rate, hop_seconds),
            notes,
            split: Split::new(middle / 2, rate / middle as f64),
            follower: Follower::new(SPLIT_ATTACK, SPLIT_RELEASE, hop_seconds),
        }
    }

    pub(super) fn restart(&mut self) {
        let (hop, rate, centred) = self.setup;
        (self.drums, self.notes) = drums_and_notes(hop, rate, centred);
        self.loudness.restart();
        self.split.restart();
    }

    /// Measures a moment from the newest hop of frames and the spectra of [`Resolution::ALL`].
    pub(super) fn follow(
        &mut self,
        newest: &[StereoFrame],
        [long, middle, short]: [&[f32]; Resolution::ALL.len()],
        features: &mut Features,
    ) {
        [features.kick, features.snare, features.hat] = self.drums.follow(middle, short);
        let level = height(features.level_db + features.gain_db);
        let parts = self.split.follow(middle);
        for (value, part) in [&mut features.tonal, &mut features.percussive].into_iter().zip(parts) {
            self.follower.follow(value, part * level);
        }
        self.notes.follow(long, middle, features);
        features.loudness_lufs = self.loudness.follow(newest);
    }
}
