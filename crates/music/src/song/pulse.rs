//! The tempo of a song over time, from the repetition of its onsets. The onset strengths are correlated with themselves
//! in a sliding window (the autocorrelation tempogram of Grosche, Müller and Kurth 2010). A period is likely if onsets
//! repeat at many of its multiples (the comb of Davies and Plumbley 2007), and if its tempo is common. The likeliest
//! path of periods is decoded over the whole song (Viterbi 1967).

/// The range of tempos in beats per minute, and the number of tempos in equal ratios.
const TEMPO: (f64, f64) = (45.0, 230.0);
const TEMPOS: usize = 150;
/// The likeliest tempo in beats per minute, and the cost of a tempo per squared octave of distance from this tempo.
const LIKELY: (f64, f32) = (125.0, 0.55);
/// The cost of a change to the next tempo, and the most tempos that a change may pass. A larger change costs as much as
/// passing twice as many.
const CHANGE: f32 = 0.05;
const REACH: usize = 6;

/// The length of the sliding window and its step, in seconds.
const WINDOW_SECONDS: f64 = 12.0;
const STEP_SECONDS: f64 = 1.0;
/// The number of multiples of a period that are compared, and the longest multiple in seconds.
const MULTIPLES: usize = 8;
const LONGEST_SECONDS: f64 = 5.3;

/// The time over which the mean onset strength is subtracted, and over which the strengths are scaled, in seconds.
const MEAN_SECONDS: f64 = 0.4;
const SCALE_SECONDS: f64 = 6.0;
/// The root mean square of the strengths counts as at least this much.
const SCALE_MIN: f32 = 0.02;

/// Returns how much each value exceeds the mean around it, relative to the root mean square of these excesses nearby.
pub(super) fn excesses(values: &[f32], hop_seconds: f64) -> Vec<f32> {
    let reach = |seconds: f64| (0.5 * seconds / hop_seconds) as usize;
    let means = means_around(values.iter().copied(), reach(MEAN_SECONDS));
    let above: Vec<f32> = values.iter().zip(means).map(|(value, mean)| (value - mean).max(0.0)).collect();
    let squares = means_around(above.iter().map(|value| value * value), reach(SCALE_SECONDS));
    above.iter().zip(squares).map(|(value, square)| value / square.max(0.0).sqrt().max(SCALE_MIN)).collect()
}

/// Returns the mean of the values within `reach` of each value.
fn means_around(values: impl Iterator<Item = f32>, reach: usize) -> Vec<f32> {
    let mut sums = vec![0.0_f64];
    for value in values {
        sums.push(sums.last().copied().unwrap_or_default() + f64::from(value));
    }
    let count = sums.len() - 1;
    let mean = |index: usize| {
        let (from, to) = (index.saturating_sub(reach), (index + reach + 1).min(count));
        ((sums[to] - sums[from]) / (to - from) as f64) as f32
    };
    (0..count).map(mean).collect()
}

/// Returns the period of the pulse at each hop, in hops, and how much the onsets repeat at its multiples, 0..1.
pub(super) fn periods(strengths: &[f32], hop_seconds: f64) -> (Vec<f32>, Vec<f32>) {
    let tempo = |index: usize| TEMPO.0 * (TEMPO.1 / TEMPO.0).powf(index as f64 / (TEMPOS - 1) as f64);
    let lags: Vec<f32> = (0..TEMPOS).map(|index| (60.0 / tempo(index) / hop_seconds) as f32).collect();
    let prior = (0..TEMPOS).map(|index| {
        let octaves = (tempo(index) / LIKELY.0).log2() as f32;
        -LIKELY.1 * octaves * octaves
    });
    let prior: Vec<f32> = prior.collect();
    let step = (STEP_SECONDS / hop_seconds).round().max(1.0) as usize;
    let repetition = Repetition::new(hop_seconds);
    let scores: Vec<[f32; TEMPOS]> = (0..strengths.len())
        .step_by(step)
        .map(|middle| {
            let repeated = repetition.around(strengths, middle);
            std::array::from_fn(|index| comb(&repeated, lags[index]) + prior[index])
        })
        .collect();
    let path = path(&scores);
    let lag = |index: usize| path.get(index).or(path.last()).map_or(1.0, |tempo| lags[*tempo]);
    let periods = (0..strengths.len()).map(|hop| {
        let fraction = (hop % step) as f32 / step as f32;
        lag(hop / step) * (1.0 - fraction) + lag(hop / step + 1) * fraction
    });
    let repeated = (0..strengths.len()).map(|hop| {
        let step = hop / step;
        let (tempo, score) = (path.get(step), scores.get(step));
        tempo.zip(score).map_or(0.0, |(tempo, score)| score[*tempo] - prior[*tempo])
    });
    (periods.collect(), repeated.collect())
}

/// The autocorrelation in a window.
struct Repetition {
    window: Vec<f32>,
    /// For each lag, the reciprocal of the autocorrelation of the window itself.
    scales: Vec<f32>,
}

fn correlations(values: &[f32], lags: usize) -> impl Iterator<Item = f32> {
    (0..lags).map(|lag| product(values, values.get(lag..).unwrap_or_default()))
}

/// Returns the scalar product, as eight partial sums, so that the compiler can vectorize the loop.
fn product(a: &[f32], b: &[f32]) -> f32 {
    let count = a.len().min(b.len());
    let ((a, a_rest), (b, b_rest)) = (a[..count].as_chunks::<8>(), b[..count].as_chunks::<8>());
    let mut sums = [0.0; 8];
    for (a, b) in a.iter().zip(b) {
        sums.iter_mut().zip(a.iter().zip(b)).for_each(|(sum, (a, b))| *sum += a * b);
    }
    sums.iter().sum::<f32>() + a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum::<f32>()
}

impl Repetition {
    fn new(hop_seconds: f64) -> Self {
        let length = (WINDOW_SECONDS / hop_seconds) as usize;
        let window = crate::window::hann(length);
        let lags = (LONGEST_SECONDS / hop_seconds) as usize;
        let scales = correlations(&window, lags).map(|own| 1.0 / own).collect();
        Self { window, scales }
    }

    /// Returns the autocorrelation around `middle` for each lag, relative to lag 0 and to the median of all lags.
    fn around(&self, strengths: &[f32], middle: usize) -> Vec<f32> {
        let start = middle as isize - self.window.len() as isize / 2;
        let windowed = self.window.iter().enumerate().map(|(index, weight)| {
            let hop = usize::try_from(start + index as isize).ok();
            weight * hop.and_then(|hop| strengths.get(hop)).copied().unwrap_or_default()
        });
        let windowed: Vec<f32> = windowed.collect();
        let repeated = correlations(&windowed, self.scales.len());
        let mut repeated: Vec<f32> = repeated.zip(&self.scales).map(|(sum, scale)| sum * scale).collect();
        let own = repeated.first().copied().unwrap_or_default().max(1e-9);
        let mut sorted = repeated.clone();
        let half = sorted.len() / 2;
        let median = *sorted.select_nth_unstable_by(half, f32::total_cmp).1;
        repeated.iter_mut().for_each(|value| *value = (*value - median) / own);
        repeated
    }
}

/// Returns the mean repetition at the multiples of `lag`.
fn comb(repeated: &[f32], lag: f32) -> f32 {
    let at = |place: f32| {
        let (whole, fraction) = (place as usize, place.fract());
        let of = |index: usize| repeated.get(index).copied();
        Some(of(whole)? * (1.0 - fraction) + of(whole + 1)? * fraction)
    };
    let near = |multiple: usize| {
        let place = multiple as f32 * lag;
        [-1.0, 0.0, 1.0].into_iter().filter_map(|by| at(place + by)).fold(0.0_f32, f32::max)
    };
    (1..=MULTIPLES).map(near).sum::<f32>() / MULTIPLES as f32
}

fn path(scores: &[[f32; TEMPOS]]) -> Vec<usize> {
    let Some(first) = scores.first() else { return Vec::new() };
    let likeliest =
        |best: &[f32; TEMPOS]| (0..TEMPOS).max_by(|a, b| best[*a].total_cmp(&best[*b])).unwrap_or_default();
    let mut best = *first;
    let mut came_from = Vec::with_capacity(scores.len());
    for score in &scores[1..] {
        let leap = likeliest(&best);
        let mut from = [leap as u8; TEMPOS];
        let mut next = [best[leap] - CHANGE * 2.0 * REACH as f32; TEMPOS];
        for to in 0..TEMPOS {
            let first = to.saturating_sub(REACH);
            for (near, value) in best.iter().enumerate().take(to + REACH + 1).skip(first) {
                let value = value - CHANGE * near.abs_diff(to) as f32;
                if value > next[to] {
                    (next[to], from[to]) = (value, near as u8);
                }
            }
            next[to] += score[to];
        }
        best = next;
        came_from.push(from);
    }
    let mut path = vec![likeliest(&best)];
    for from in came_from.iter().rev() {
        let tempo = path.last().copied().unwrap_or_default();
        path.push(usize::from(from[tempo]));
    }
    path.reverse();
    path
}
