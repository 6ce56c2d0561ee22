//! Live input: bars, harmony, builds, drops and new sections, heard without knowledge of the music to come.
//!
//! ```text
//! hop ─┬─► bars, chroma
//!      ├─► slots of 40 ms ─────────► drops ◄─┐
//!      └─► steps of half a second ─┬─► builds┘
//!                                  └─► key, novelty
//! ```
//!
//! Nothing here is known in silence, speech or noise: builds and drops need a tempo, the key needs pitches.

use crate::beat::Beat;
use crate::rises::{LowAndHigh, Rises};
use crate::scale::{BAND_COUNT, NOTE_COUNT, SPECTRUM_POINTS};
use crate::smoothing::Follower;
use crate::song::{PITCH_CLASSES, Tonality};
use bars::{LiveBar, LiveBars};
use builds::Builds;
use drops::{Drops, Slot};
use harmony::{CLASSES, Harmony, classes};
use novelty::Novelty;

mod bars;
mod builds;
mod drops;
mod energy;
mod harmony;
mod novelty;

pub use energy::LiveEnergy;

/// The approximate durations of a slot and of a step, in seconds.
const SLOT_SECONDS: f64 = 0.04;
const STEP_SECONDS: f64 = 0.5;

/// The bands of the low frequencies, up to 144 Hz, and of the high frequencies, from 4 kHz on.
const LOW: std::ops::Range<usize> = 0..8;
const HIGH: std::ops::Range<usize> = 25..BAND_COUNT;

/// Builds and drops need a tempo within this time, in seconds.
const TEMPO_SECONDS: f32 = 8.0;
/// The least value of a build that a drop may follow.
const BUILD_MIN: f32 = 0.3;
/// A drop follows a build that ended at most this long ago, in seconds.
const BUILD_SECONDS: f32 = 2.0;
/// Attack and release times of a build, in seconds.
const BUILD_ATTACK: f64 = 0.7;
const BUILD_RELEASE: f64 = 0.3;
/// The duration of a drop's fade in bars, and in seconds without a tempo.
const DROP_BARS: f32 = 2.0;
const DROP_SECONDS: f32 = 4.0;

/// The measurements of a hop.
pub(crate) struct Hop<'a> {
    /// The power of each band.
    pub(crate) powers: &'a [f32; BAND_COUNT],
    /// The level of each note, 0..1.
    pub(crate) notes: &'a [f32; NOTE_COUNT],
    pub(crate) spectrum: &'a [f32; SPECTRUM_POINTS],
    /// The power of each bin of the short window.
    pub(crate) short: &'a [f32],
    /// The flux, relative to the largest recent flux.
    pub(crate) flux: f32,
    /// True at an onset.
    pub(crate) begins: bool,
    pub(crate) beat: Beat,
}

/// Sums over the hops of a slot and the slots of a step.
#[derive(Default)]
struct Sums {
    slot: Slot,
    hops: usize,
    powers: [f32; BAND_COUNT],
    classes: [f32; CLASSES],
    slots: usize,
}

/// Follows live input. Owns no memory.
pub(crate) struct Live {
    /// The arguments of [`Live::new`], for a restart.
    setup: (usize, f64, f64),
    rises: Rises,
    bars: LiveBars,
    harmony: Harmony,
    builds: Builds,
    drops: Drops,
    novelty: Novelty,
    hop_seconds: f32,
    hops_per_slot: usize,
    slots_per_step: usize,
    sums: Sums,
    follower: Follower,
    song: LiveSong,
    times: Times,
}

/// The progress of a build, and times in seconds.
struct Times {
    build: f32,
    since_build: f32,
    since_tempo: f32,
    drop_length: f32,
}

impl Live {
    /// Creates a listener for short spectra of `bins` bins of `bin_hz` hertz.
    pub(crate) fn new(bins: usize, bin_hz: f64, hop_seconds: f64) -> Self {
        let hops_per_slot = (SLOT_SECONDS / hop_seconds).round().max(1.0) as usize;
        let slot_seconds = hops_per_slot as f64 * hop_seconds;
        let slots_per_step = (STEP_SECONDS / slot_seconds).round().max(1.0) as usize;
        let (since_build, since_tempo, drop_length) = (BUILD_SECONDS, TEMPO_SECONDS, DROP_SECONDS);
        Self {
            setup: (bins, bin_hz, hop_seconds),
            rises: Rises::new(bins, bin_hz, hop_seconds),
            bars: LiveBars::new(),
            harmony: Harmony::new(hop_seconds, slots_per_step as f64 * slot_seconds),
            builds: Builds::new(),
            drops: Drops::new(slot_seconds),
            novelty: Novelty::new(),
            hop_seconds: hop_seconds as f32,
            hops_per_slot,
            slots_per_step,
            sums: Sums::default(),
            follower: Follower::new(BUILD_ATTACK, BUILD_RELEASE, hop_seconds),
            song: LiveSong::UNKNOWN,
            times: Times { build: 0.0, since_build, since_tempo, drop_length },
        }
    }

    pub(crate) fn restart(&mut self) {
        let (bins, bin_hz, hop_seconds) = self.setup;
        *self = Self::new(bins, bin_hz, hop_seconds);
    }

    /// Processes a hop.
    pub(crate) fn follow(&mut self, hop: &Hop<'_>) -> (LiveBar, LiveSong) {
        let Beat { tempo, phase } = hop.beat;
        let LowAndHigh { low_rise, high_rise, .. } = self.rises.follow(hop.short);
        let strokes = [low_rise, high_rise, hop.flux];
        let bar = self.bars.follow((tempo > 0.0).then_some(phase), strokes, hop.spectrum);
        let classes = classes(hop.notes);
        self.song.chroma = self.harmony.chroma(&classes);
        self.times.since_tempo = if tempo > 0.0 { 0.0 } else { self.times.since_tempo + self.hop_seconds };
        self.times.since_build += self.hop_seconds;
        self.song.drop = (self.song.drop - self.hop_seconds / self.times.drop_length).max(0.0);

        let sums = &mut self.sums;
        sums.slot.low += hop.powers[LOW].iter().sum::<f32>();
        sums.slot.total += hop.powers.iter().sum::<f32>();
        sums.slot.onsets += f32::from(u8::from(hop.begins));
        sums.powers.iter_mut().zip(hop.powers).for_each(|(sum, power)| *sum += power);
        sums.classes.iter_mut().zip(classes).for_each(|(sum, level)| *sum += level);
        sums.hops += 1;
        if sums.hops == self.hops_per_slot {
            self.end_slot(tempo, bar.beats);
        }
        self.follower.follow(&mut self.song.build, self.times.build);
        (bar, self.song)
    }

    fn end_slot(&mut self, tempo: f32, bar_beats: f32) {
        let sums = &mut self.sums;
        let scale = 1.0 / self.hops_per_slot as f32;
        let slot = Slot { low: scale * sums.slot.low, total: scale * sums.slot.total, ..sums.slot };
        (sums.slot, sums.hops, sums.slots) = (Slot::default(), 0, sums.slots + 1);
        let has_tempo = self.times.since_tempo < TEMPO_SECONDS;
        let after_build = self.times.since_build < BUILD_SECONDS;
        if self.drops.follow(slot, after_build) && has_tempo {
            let beats = DROP_BARS * if bar_beats > 0.0 { bar_beats } else { 4.0 };
            self.times.drop_length = if tempo > 0.0 { beats * 60.0 / tempo } else { DROP_SECONDS };
            (self.song.drop, self.times.build) = (1.0, 0.0);
        }
        if self.sums.slots == self.slots_per_step {
            self.end_step(has_tempo);
        }
    }

    fn end_step(&mut self, has_tempo: bool) {
        let Sums { powers, classes, .. } = std::mem::take(&mut self.sums);
        let scale = 1.0 / (self.hops_per_slot * self.slots_per_step) as f32;
        let (powers, classes) = (powers.map(|sum| scale * sum), classes.map(|sum| scale * sum));
        self.song.key = self.harmony.key(&classes);
        self.song.novelty = self.novelty.follow(&powers, &classes);
        let sum = |bands: std::ops::Range<usize>| powers[bands].iter().sum();
        let build = self.builds.follow(sum(HIGH), sum(LOW));
        self.times.build = if has_tempo { build } else { 0.0 };
        if self.times.build >= BUILD_MIN {
            self.times.since_build = 0.0;
        }
    }
}

// Facts about the playing song, found from live input.

/// The harmony and the form of live input, heard without knowledge of the music to come.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LiveSong {
    /// Level of each pitch class, C first, relative to the strongest, 0..1. Noise has low levels.
    pub chroma: [f32; PITCH_CLASSES.len()],
    /// The key of about the last 30 s; `None` while unknown.
    pub key: Option<Tonality>,
    /// Progress of a build, 0..1: how far the high frequencies have risen while the low ones are withdrawn.
    pub build: f32,
    /// 1 at a drop, falling to 0 over two bars.
    pub drop: f32,
    /// How much the last 4 s differ from the 12 s before, in standard deviations, 0 and more. Above about 0.8 a new
    /// section is likely.
    pub novelty: f32,
}

impl LiveSong {
    /// Nothing is known.
    pub const UNKNOWN: Self =
        Self { chroma: [0.0; PITCH_CLASSES.len()], key: None, build: 0.0, drop: 0.0, novelty: 0.0 };
}
