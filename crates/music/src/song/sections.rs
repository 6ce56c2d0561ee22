//! The sections of a song: borders and repeats. The borders are the cheapest segmentation into homogeneous stretches
//! (Jensen 2007, the shortest path through a song; Foote 2000 finds the same borders as peaks of novelty). Within a
//! stretch, timbre is constant, and harmony is constant or repeats every one, two, four or eight bars (Serrà et al.
//! 2014). Whole phrases cost less than other lengths (Sargent, Bimbot and Vincent 2011). Stretches with similar timbre
//! and a similar sequence of harmonies get the same letter. The required similarity depends on how exactly the song's
//! stretches return: with a computer every note returns, with players much changes.

use serde::{Deserialize, Serialize};

use super::harmony::Harmony;
use super::heard::{Heard, TIMBRE_BANDS};
use super::units::{Unit, distance, units, within};

/// The cost of a section. A cost of 1 is the mean squared deviation of the song's bars from their mean.
const SECTION_COST: f32 = 2.0;
/// The cost of each bar of a repeating harmony.
const LOOP_COST: f32 = 0.12;
/// The periods of a repeating harmony, in bars.
const LOOPS: [usize; 4] = [1, 2, 4, 8];
const LONGEST: usize = 96;
/// The extra cost of a section whose length is no multiple of four bars, by its length in bars modulo four.
const ODD_COST: [f32; 4] = [0.0, 1.2, 0.5, 1.2];
/// If a section is shorter than four bars, the extra cost of each missing bar.
const SHORT_COST: f32 = 1.0;

/// Timbre is divided by its deviation, or at least by this: the root of the sum of squares over all bands, in decibels.
const TIMBRE_LEAST: f32 = 8.0;
/// Chroma is divided by its deviation, or at least by this: the root of the summed squares of the class fractions.
const CHROMA_LEAST: f32 = 0.09;

/// The maximum distance of sections with the same letter, if all sections return exactly and if none do.
const SAME: (f32, f32) = (0.27, 0.52);
/// How much the maximum distance grows with the median distance of each section from its nearest section.
const SAME_BY_NEAREST: f32 = 2.0;
/// A difference of timbre adds 1 to the distance if it is this many times as large as the median difference between a
/// bar and the mean of all bars, within a range: the root of the sum of squares over all bands, in decibels.
const TIMBRE_SCALE: f32 = 2.2;
const TIMBRE_RANGE: (f32, f32) = (14.0, 50.0);
/// Added to the distance, divided by the beats of the shorter section: short sections resemble others by chance.
const BY_CHANCE: f32 = 0.8;

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Stretch {
    pub(super) bars: std::ops::Range<usize>,
    pub(super) letter: usize,
}

/// Returns the sections of the bars. `beats` are the beats of the song or other short steps. `firsts` contains the
/// first beat of each bar, and the end of the beats.
pub(super) fn sections(bars: &[Unit], beats: &[Unit], firsts: &[usize]) -> Vec<Stretch> {
    if bars.is_empty() {
        return Vec::new();
    }
    let stretches = cut(bars);
    let between = distances(&stretches, bars, &Harmony::new(beats), firsts);
    let letters = letters(&between);
    let mut sections: Vec<Stretch> = Vec::new();
    for (bars, letter) in stretches.into_iter().zip(letters) {
        match sections.last_mut() {
            Some(last) if last.letter == letter => last.bars.end = bars.end,
            _ => sections.push(Stretch { bars, letter }),
        }
    }
    sections
}

/// Outliers are clamped to this many standard deviations, so that a pause does not become a section.
const FARTHEST: f32 = 2.5;

/// Subtracts the mean of `rows` and divides by their deviation, at least by `least`. Outliers do not widen the scale.
fn with_unit_deviation<const N: usize>(rows: &[[f32; N]], least: f32) -> Vec<[f32; N]> {
    let count = rows.len().max(1) as f32;
    let mean: [f32; N] =
        std::array::from_fn(|column| rows.iter().map(|row| row[column]).sum::<f32>() / count);
    let away = |row: &[f32; N]| -> [f32; N] { std::array::from_fn(|column| row[column] - mean[column]) };
    let length = |row: &[f32; N]| away(row).iter().map(|x| x * x).sum::<f32>().sqrt();
    let mut lengths: Vec<f32> = rows.iter().map(length).collect();
    lengths.sort_by(f32::total_cmp);
    let farthest = FARTHEST * lengths.get(lengths.len() / 2).copied().unwrap_or_default();
    let square: f32 = lengths.iter().map(|length| length.min(farthest).powi(2)).sum::<f32>() / count;
    let deviation = square.sqrt().max(least);
    rows.iter()
        .map(|row| {
            let scale = 1.0 / deviation.max(length(row) / FARTHEST);
            away(row).map(|x| x * scale)
        })
        .collect()
}

/// Prefix sums of every row or of every `step`-th row, and of the squared lengths of these rows.
struct Sums<const N: usize> {
    step: usize,
    /// `sums[n]` is the sum of rows n - step, n - 2·step and so on.
    sums: Vec<[f32; N]>,
    squares: Vec<f32>,
}

impl<const N: usize> Sums<N> {
    fn new(rows: &[[f32; N]], step: usize) -> Self {
        let mut sums = vec![[0.0; N]; step];
        let mut squares = vec![0.0; step];
        for (index, row) in rows.iter().enumerate() {
            let before = sums[index];
            sums.push(std::array::from_fn(|column| before[column] + row[column]));
            squares.push(squares[index] + row.iter().map(|x| x * x).sum::<f32>());
        }
        Self { step, sums, squares }
    }

    /// Sums the squared distances of the rows `start..end`, each from the mean of every `step`-th row.
    fn deviation(&self, start: usize, end: usize) -> f32 {
        let of_phase = |phase: usize| {
            let first = start + phase;
            let count = (end - first).div_ceil(self.step);
            let last = first + count * self.step;
            let (from, to) = (&self.sums[first], &self.sums[last]);
            let square: f32 = from.iter().zip(to).map(|(a, b)| (b - a) * (b - a)).sum();
            (self.squares[last] - self.squares[first] - square / count as f32).max(0.0)
        };
        (0..self.step.min(end - start)).map(of_phase).sum()
    }
}

/// Returns the cheapest segmentation (dynamic programming; Jackson et al. 2005).
fn cut(bars: &[Unit]) -> Vec<std::ops::Range<usize>> {
    let timbre: Vec<_> = bars.iter().map(|bar| bar.timbre).collect();
    let chroma: Vec<_> = bars.iter().map(|bar| bar.chroma).collect();
    let timbre = Sums::new(&with_unit_deviation(&timbre, TIMBRE_LEAST), 1);
    let chroma = with_unit_deviation(&chroma, CHROMA_LEAST);
    let harmonies = LOOPS.map(|step| Sums::new(&chroma, step));
    let cost = |start: usize, end: usize| {
        let length = end - start;
        let harmony = harmonies
            .iter()
            .filter(|sums| sums.step <= length)
            .map(|sums| sums.deviation(start, end) + LOOP_COST * sums.step as f32)
            .fold(f32::INFINITY, f32::min);
        SECTION_COST
            + timbre.deviation(start, end)
            + harmony
            + ODD_COST[length % 4]
            + SHORT_COST * 4_usize.saturating_sub(length) as f32
    };
    let count = bars.len();
    let mut best = vec![0.0_f32];
    let mut starts = vec![0];
    for end in 1..=count {
        let of_start = |start: usize| (start, best[start] + cost(start, end));
        let (start, cost) = (end.saturating_sub(LONGEST)..end)
            .map(of_start)
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .unwrap_or((0, f32::INFINITY));
        best.push(cost);
        starts.push(start);
    }
    let mut stretches = Vec::new();
    let mut end = count;
    while end > 0 {
        stretches.push(starts[end]..end);
        end = starts[end];
    }
    stretches.reverse();
    stretches
}

/// Returns the distance of every two stretches: the squared difference of their mean timbres, plus the distance of
/// their harmonies, plus a term for short stretches. The diagonal is 0.
fn distances(
    stretches: &[std::ops::Range<usize>],
    bars: &[Unit],
    harmony: &Harmony,
    firsts: &[usize],
) -> Vec<Vec<f32>> {
    let middle = mean_timbre(bars);
    let mut away: Vec<f32> = bars.iter().map(|bar| distance(&bar.timbre, &middle)).collect();
    let scale = (TIMBRE_SCALE * median(&mut away)).clamp(TIMBRE_RANGE.0, TIMBRE_RANGE.1);
    let of_stretch = |stretch: &std::ops::Range<usize>| {
        let first = |bar: usize| firsts.get(bar).copied().unwrap_or_default();
        let timbre = mean_timbre(bars.get(stretch.clone()).unwrap_or_default());
        (timbre, first(stretch.start)..first(stretch.end))
    };
    let measured: Vec<_> = stretches.iter().map(of_stretch).collect();
    let mut between = vec![vec![0.0; stretches.len()]; stretches.len()];
    for (a, (timbre, beats)) in measured.iter().enumerate() {
        for (b, (other_timbre, other_beats)) in measured.iter().enumerate().take(a) {
            let difference = distance(timbre, other_timbre) / scale;
            let short = beats.len().min(other_beats.len()).max(1) as f32;
            let harmony = harmony.distance(beats.clone(), other_beats.clone());
            let apart = difference * difference + harmony + BY_CHANCE / short;
            (between[a][b], between[b][a]) = (apart, apart);
        }
    }
    between
}

/// Returns the letter of each stretch. The letters are clusters by mean distance (average linkage; Sokal and Michener
/// 1958), named in order of appearance.
fn letters(between: &[Vec<f32>]) -> Vec<usize> {
    let count = between.len();
    let nearest = |stretch: usize| {
        let others = between[stretch].iter().enumerate().filter(|(other, _)| *other != stretch);
        others.map(|(_, distance)| *distance).fold(f32::INFINITY, f32::min)
    };
    let mut nearest: Vec<f32> = (0..count).map(nearest).collect();
    let same = (SAME.0 + SAME_BY_NEAREST * median(&mut nearest)).min(SAME.1);
    let mean = |a: &[usize], b: &[usize]| {
        let sum: f32 = a.iter().flat_map(|x| b.iter().map(|y| between[*x][*y])).sum();
        sum / (a.len() * b.len()) as f32
    };
    let mut clusters: Vec<Vec<usize>> = (0..count).map(|index| vec![index]).collect();
    loop {
        let pairs = (0..clusters.len()).flat_map(|a| (a + 1..clusters.len()).map(move |b| (a, b)));
        let nearest = pairs
            .map(|(a, b)| (a, b, mean(&clusters[a], &clusters[b])))
            .min_by(|a, b| a.2.total_cmp(&b.2))
            .filter(|(.., distance)| *distance < same);
        let Some((a, b, _)) = nearest else { break };
        let joined = clusters.swap_remove(b);
        clusters[a].extend(joined);
    }
    clusters.sort_by_key(|cluster| cluster.iter().min().copied());
    let mut letters = vec![0; count];
    for (letter, cluster) in clusters.iter().enumerate() {
        cluster.iter().for_each(|stretch| letters[*stretch] = letter);
    }
    letters
}

fn mean_timbre(bars: &[Unit]) -> [f32; TIMBRE_BANDS] {
    std::array::from_fn(|band| {
        bars.iter().map(|bar| bar.timbre[band]).sum::<f32>() / bars.len().max(1) as f32
    })
}

/// Sorts the values and returns the middle one, or 0.
fn median(values: &mut [f32]) -> f32 {
    values.sort_by(f32::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or_default()
}

// How a section of a song sounds: onset density, brightness and percussion.

/// How a section sounds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize)]
pub struct SectionSound {
    /// Onsets per second, 0 and more.
    pub onsets: f32,
    /// The mean position on a logarithmic scale from 30 Hz to 16 kHz (0..1), weighted by amplitude (spectral centroid).
    /// Frequencies below 500 Hz count as lower than they are, because the bands there are coarse.
    pub brightness: f32,
    /// The share of percussion: how much the spectral flux exceeds the flux of noise, on average; 0 and more. Strings
    /// have about 0.02, fast drums 0.1. The flux is relative to the loudest recent sound, so the level does not count.
    pub percussive: f32,
}

/// Measures the sound from `start` to `end`, in seconds. In silence all values are 0.
pub(super) fn section_sound(heard: &Heard, start: f64, end: f64) -> SectionSound {
    let (moments, slow) = within(heard, start, end);
    let seconds = (moments.len() as f64 * heard.hop_seconds) as f32;
    let onsets = moments.iter().filter(|moment| moment.begins).count() as f32;
    let (mut all, mut weighted) = (0.0_f32, 0.0_f32);
    for (band, power) in slow.iter().flat_map(|moment| moment.timbre.iter().enumerate()) {
        let amplitude = power.max(0.0).sqrt();
        all += amplitude;
        weighted += amplitude * band as f32 / (TIMBRE_BANDS - 1) as f32;
    }
    SectionSound {
        onsets: if seconds > 0.0 { onsets / seconds } else { 0.0 },
        brightness: if all > 0.0 { weighted / all } else { 0.0 },
        percussive: units(heard, &[start, end]).first().map_or(0.0, |unit| unit.onsets),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{SongListener, StereoFrame};

    const RATE: u32 = 48_000;

    /// Returns the sound of the middle section of ten seconds, where `sample` returns the sample at a time.
    fn sound(sample: impl Fn(f64) -> f64) -> SectionSound {
        let frames: Vec<StereoFrame> = (0..10 * RATE)
            .map(|n| {
                let sample = sample(f64::from(n) / f64::from(RATE)) as f32;
                [sample; 2]
            })
            .collect();
        let mut listener = SongListener::new(RATE);
        listener.push(&frames);
        let structure = listener.finish();
        assert_eq!(structure.sounds.len(), structure.sections.len());
        structure.sounds.get(structure.sounds.len() / 2).copied().unwrap_or_default()
    }

    fn tone(hz: f64, time: f64) -> f64 {
        0.3 * (std::f64::consts::TAU * hz * time).sin()
    }

    #[test]
    fn hits_are_counted_and_percussive() {
        let hit = |time: f64| (-40.0 * (4.0 * time).fract() / 4.0).exp() * tone(2_000.0, time);
        let (hits, held) = (sound(hit), sound(|time| tone(2_000.0, time)));
        assert!((hits.onsets - 4.0).abs() < 0.5, "{hits:?}");
        assert!(held.onsets < 0.5, "{held:?}");
        assert!(hits.percussive > 0.04 && held.percussive < 0.005, "{hits:?} {held:?}");
    }

    #[test]
    fn high_tones_are_bright() {
        let octaves = (16_000.0_f64 / 30.0).log2();
        for hz in [700.0_f64, 2_000.0, 6_000.0] {
            let place = (hz / 30.0).log2() / octaves;
            let found = sound(|time| tone(hz, time)).brightness;
            assert!((f64::from(found) - place).abs() < 0.08, "{hz} Hz: {found}, not {place}");
        }
        assert_eq!(sound(|_| 0.0), SectionSound::default());
    }
}
