//! The metrical level of a song's beats: all beats that were found, every second one, or twice as many. The likeliest
//! level is decided for each stretch of the song, from how likely the beats are, how strong the onsets at the beats
//! are, and how common the tempo is.

use super::heard::{Heard, Moment};
use super::strengths::{deviation, excesses, largest_around};

/// The range of tempos, in beats per minute.
const TEMPO: (f64, f64) = (48.0, 225.0);
/// The level is decided in stretches of this length, in seconds.
const STRETCH_SECONDS: f64 = 30.0;
/// The cost of a change of level between two stretches.
const CHANGE: f32 = 1.0;

/// The minimum number of beats in a stretch, and the evidence for a level with fewer beats.
const BEATS_OF_STRETCH_MIN: usize = 5;
const NO_EVIDENCE: f32 = -10.0;
/// The evidence for a level: its likeliest tempo in beats per minute, the cost per squared octave of distance from this
/// tempo, the weights of all onsets and of low onsets at the beats, and the weight of the log odds. The weights were
/// chosen on songs.
const LIKELY: (f64, f32) = (162.0, 5.0);
const STRUCK: f32 = 3.5;
const STRUCK_LOW: f32 = 1.3;
const ODDS: f32 = 1.5;
/// The onset of a beat is searched within this many hops before and after the beat.
const AROUND: usize = 2;

/// Returns the beats of the likeliest level in each stretch: all `beats`, every second one, or twice as many.
pub(super) fn leveled(heard: &Heard, beats: &[usize], odds: &[f32]) -> Vec<usize> {
    let of = |value: fn(&Moment) -> f32| {
        let values: Vec<f32> = heard.moments.iter().map(value).collect();
        excesses(&values, heard.hop_seconds)
    };
    let onsets = Onsets {
        all: of(|moment| moment.flux),
        low: of(|moment| moment.low_rise),
        hop_seconds: heard.hop_seconds,
    };
    let every_second = |first: usize| beats.iter().copied().skip(first).step_by(2).collect::<Vec<usize>>();
    let between = beats.windows(2).flat_map(|pair| [pair[0], (pair[0] + pair[1]) / 2]);
    let levels = [beats.to_vec(), every_second(0), every_second(1), between.collect()];
    let hops = onsets.all.len();
    let length = (STRETCH_SECONDS / onsets.hop_seconds) as usize;
    let count = (hops / length.max(1)).max(1);
    let evidence = Evidence::new(onsets, odds);
    let inside = |level: &[usize], stretch: usize| {
        let place = |hop: usize| level.partition_point(|beat| *beat < hop);
        place(stretch * hops / count)..place((stretch + 1) * hops / count)
    };
    let of = |stretch: usize| {
        levels.iter().map(|level| evidence.of(&level[inside(level, stretch)])).collect::<Vec<f32>>()
    };
    let scores: Vec<Vec<f32>> = (0..count).map(of).collect();
    let mut found: Vec<usize> = Vec::new();
    for (stretch, choice) in choices(&scores).into_iter().enumerate() {
        let mine = levels.get(choice).map_or(&[][..], |level| &level[inside(level, stretch)]);
        let apart = mine.windows(2).next().map_or(1, |pair| 3 * (pair[1] - pair[0]) / 5);
        let after = found.last().map_or(0, |last| last + apart);
        found.extend(mine.iter().filter(|beat| **beat >= after));
    }
    found
}

/// The onsets of a song, as excesses over the mean nearby.
struct Onsets {
    all: Vec<f32>,
    low: Vec<f32>,
    hop_seconds: f64,
}

/// Returns the likeliest level of each stretch (Viterbi 1967).
fn choices(scores: &[Vec<f32>]) -> Vec<usize> {
    let likeliest =
        |best: &[f32]| (0..best.len()).max_by(|a, b| best[*a].total_cmp(&best[*b])).unwrap_or_default();
    let mut best: Vec<f32> = Vec::new();
    let mut came_from = Vec::new();
    for score in scores {
        let leap = likeliest(&best);
        let stays = |level: usize| best.get(level).is_none_or(|own| *own >= best[leap] - CHANGE);
        let from: Vec<usize> =
            (0..score.len()).map(|level| if stays(level) { level } else { leap }).collect();
        let value = |level: usize| match best.get(from[level]) {
            Some(value) if from[level] == level => value + score[level],
            Some(value) => value - CHANGE + score[level],
            None => score[level],
        };
        best = (0..score.len()).map(value).collect();
        came_from.push(from);
    }
    let mut level = likeliest(&best);
    let mut choices = vec![0; scores.len()];
    for (choice, from) in choices.iter_mut().zip(&came_from).rev() {
        *choice = level;
        level = from.get(level).copied().unwrap_or_default();
    }
    choices
}

/// Measures how likely beats are. The strengths are the largest nearby, relative to the usual strength.
struct Evidence {
    all: Vec<f32>,
    low: Vec<f32>,
    odds: Vec<f32>,
    hop_seconds: f64,
}

impl Evidence {
    fn new(onsets: Onsets, odds: &[f32]) -> Self {
        let of = |strengths: &[f32]| {
            let scale = 0.5 / deviation(strengths).max(1e-6);
            largest_around(strengths, AROUND).into_iter().map(|strength| scale * strength).collect()
        };
        let Onsets { all, low, hop_seconds } = onsets;
        Self { all: of(&all), low: of(&low), odds: largest_around(odds, AROUND), hop_seconds }
    }

    fn of(&self, beats: &[usize]) -> f32 {
        let (Some(first), Some(last)) = (beats.first(), beats.last()) else { return NO_EVIDENCE };
        if beats.len() < BEATS_OF_STRETCH_MIN {
            return NO_EVIDENCE;
        }
        let tempo = 60.0 * (beats.len() - 1) as f64 / ((last - first) as f64 * self.hop_seconds);
        if !(TEMPO.0..TEMPO.1).contains(&tempo) {
            return NO_EVIDENCE;
        }
        let octaves = (tempo / LIKELY.0).log2() as f32;
        let mean = |strengths: &[f32]| {
            let at = |place: &usize| strengths.get(*place).copied().unwrap_or_default();
            beats.iter().map(at).sum::<f32>() / beats.len() as f32
        };
        STRUCK * mean(&self.all) + STRUCK_LOW * mean(&self.low) + ODDS * mean(&self.odds)
            - LIKELY.1 * octaves * octaves
    }
}
