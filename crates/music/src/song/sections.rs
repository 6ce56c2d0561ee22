//! The sections of a song: borders and repeats. The borders are the cheapest segmentation into homogeneous stretches
//! (Jensen 2007, the shortest path through a song; Foote 2000 finds the same borders as peaks of novelty). Within a
//! stretch, timbre is constant, and harmony is constant or repeats every one, two, four or eight bars (Serrà et al.
//! 2014). Whole phrases cost less than other lengths (Sargent, Bimbot and Vincent 2011). Stretches with similar timbre
//! and harmony get the same letter (McFee and Ellis 2014 cluster in the same way).

use super::heard::TIMBRE_BANDS;
use super::units::Unit;

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

/// The maximum distance between sections with the same letter, in the units of the costs.
const SAME: f32 = 0.2;

/// The scaled timbre and chroma of the bars, each with a mean squared deviation of at most 1.
struct Scaled {
    timbre: Vec<[f32; TIMBRE_BANDS]>,
    chroma: Vec<[f32; 12]>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Stretch {
    pub(super) bars: std::ops::Range<usize>,
    pub(super) letter: usize,
}

pub(super) fn sections(bars: &[Unit]) -> Vec<Stretch> {
    if bars.is_empty() {
        return Vec::new();
    }
    let scaled = scaled(bars);
    let stretches = cut(&scaled);
    let letters = letters(&stretches, &scaled);
    let mut sections: Vec<Stretch> = Vec::new();
    for (bars, letter) in stretches.into_iter().zip(letters) {
        match sections.last_mut() {
            Some(last) if last.letter == letter => last.bars.end = bars.end,
            _ => sections.push(Stretch { bars, letter }),
        }
    }
    sections
}

fn scaled(bars: &[Unit]) -> Scaled {
    let timbre: Vec<_> = bars.iter().map(|bar| bar.timbre).collect();
    let chroma: Vec<_> = bars.iter().map(|bar| bar.chroma).collect();
    Scaled {
        timbre: with_unit_deviation(&timbre, TIMBRE_LEAST),
        chroma: with_unit_deviation(&chroma, CHROMA_LEAST),
    }
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
fn cut(scaled: &Scaled) -> Vec<std::ops::Range<usize>> {
    let timbre = Sums::new(&scaled.timbre, 1);
    let harmonies = LOOPS.map(|step| Sums::new(&scaled.chroma, step));
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
    let count = scaled.timbre.len();
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

/// Returns the letter of each stretch. The letters are clusters by mean distance (average linkage; Sokal and Michener
/// 1958), named in order of appearance.
fn letters(stretches: &[std::ops::Range<usize>], scaled: &Scaled) -> Vec<usize> {
    let count = stretches.len();
    let mut clusters: Vec<Vec<usize>> = (0..count).map(|index| vec![index]).collect();
    let between: Vec<Vec<f32>> =
        stretches.iter().map(|a| stretches.iter().map(|b| dissimilarity(a, b, scaled)).collect()).collect();
    let mean = |a: &[usize], b: &[usize]| {
        let sum: f32 = a.iter().flat_map(|x| b.iter().map(|y| between[*x][*y])).sum();
        sum / (a.len() * b.len()) as f32
    };
    loop {
        let pairs = (0..clusters.len()).flat_map(|a| (a + 1..clusters.len()).map(move |b| (a, b)));
        let nearest = pairs
            .map(|(a, b)| (a, b, mean(&clusters[a], &clusters[b])))
            .min_by(|a, b| a.2.total_cmp(&b.2))
            .filter(|(.., distance)| *distance < SAME);
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

/// Returns the squared distance of the mean timbres, plus half the squared distance of the chromas. The chromas are
/// compared bar by bar, over the length of the shorter stretch.
fn dissimilarity(a: &std::ops::Range<usize>, b: &std::ops::Range<usize>, scaled: &Scaled) -> f32 {
    let square = |a: &[f32], b: &[f32]| a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f32>();
    let timbre = square(&mean(&scaled.timbre[a.clone()]), &mean(&scaled.timbre[b.clone()]));
    let (first, second) = (&scaled.chroma[a.clone()], &scaled.chroma[b.clone()]);
    let common = first.len().min(second.len()).max(1);
    let bar_by_bar = first.iter().zip(second).map(|(a, b)| square(a, b)).sum::<f32>() / common as f32;
    timbre + 0.5 * bar_by_bar
}

fn mean<const N: usize>(rows: &[[f32; N]]) -> [f32; N] {
    std::array::from_fn(|column| rows.iter().map(|row| row[column]).sum::<f32>() / rows.len().max(1) as f32)
}
