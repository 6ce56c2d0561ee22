//! Key, mode and chords, from pitch class fractions.

use serde::{Deserialize, Serialize};

use super::units::{Unit, distance};

/// The names of the pitch classes, C first.
pub const PITCH_CLASSES: [&str; 12] = ["C", "C#", "D", "Eb", "E", "F", "F#", "G", "G#", "A", "Bb", "B"];

/// The mode of a key or triad.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Mode {
    /// Major third.
    Major,
    /// Minor third.
    Minor,
}

impl Mode {
    /// The mode's name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Major => "major",
            Self::Minor => "minor",
        }
    }
}

/// A key or triad: its root and mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
pub struct Tonality {
    /// The pitch class of the root, from 0 for C to 11 for B.
    pub root: u8,
    /// The mode.
    pub mode: Mode,
}

impl Tonality {
    /// The name of the root.
    pub fn root_name(self) -> &'static str {
        PITCH_CLASSES.get(usize::from(self.root)).copied().unwrap_or("C")
    }

    pub(crate) fn all() -> impl Iterator<Item = Self> {
        [Mode::Major, Mode::Minor].into_iter().flat_map(|mode| (0..12).map(move |root| Self { root, mode }))
    }

    /// Returns the correlation of pitch class weights, C first, with the profile of this key (Krumhansl 1990).
    pub(crate) fn fit_as_key(self, classes: &[f32; 12]) -> f32 {
        let profile = if self.mode == Mode::Major { MAJOR } else { MINOR };
        correlation(&turned(classes, self.root), &profile)
    }

    /// Returns the correlation of pitch class weights, C first, with the tones of this triad.
    pub(crate) fn fit_as_triad(self, classes: &[f32; 12]) -> f32 {
        let third = if self.mode == Mode::Major { 4 } else { 3 };
        let tones: [f32; 12] =
            std::array::from_fn(|class| if [0, third, 7].contains(&class) { 1.0 } else { 0.0 });
        correlation(&turned(classes, self.root), &tones)
    }
}

/// The fit of each pitch class above the tonic (probe-tone ratings of Krumhansl and Kessler 1982).
const MAJOR: [f32; 12] = [6.35, 2.23, 3.48, 2.33, 4.38, 4.09, 2.52, 5.19, 2.39, 3.66, 2.29, 2.88];
const MINOR: [f32; 12] = [6.33, 2.68, 3.52, 5.38, 2.60, 3.53, 2.54, 4.75, 3.98, 2.69, 3.34, 3.17];

/// Added to a key's correlation if the song consists only of the tonic's triad; otherwise a fraction of this is added.
const TONIC_FRACTION: f32 = 0.4;
/// Added likewise if every section of the song begins with the tonic's triad.
const FIRST_FRACTION: f32 = 0.3;

const KEY_MIN: f32 = 0.55;
/// A song has a key only if at least this fraction of its beats has pitches.
const PITCHED_MIN: f32 = 0.4;

/// The minimum difference between the strongest and the weakest pitch class, relative to the mean.
const CONTRAST_MIN: f32 = 0.8;

/// At least this many pitch classes have more than 4 % of the sum.
const HEARD_MIN: usize = 4;

/// In harmony, the pitch classes of beats have at least this mean distance from the song's. A held note has less.
const CHANGE_MIN: f32 = 0.05;

const CHORD_MIN: f32 = 0.35;
/// The cost of a chord change, subtracted from the sum of correlations.
const CHANGE_COST: f32 = 0.45;

/// Returns the song's pitch class weights; `None` for sound without harmony, such as noise or a held note.
pub(super) fn pitches_of(units: &[Unit]) -> Option<[f32; 12]> {
    let pitched = units.iter().filter(|unit| unit.chroma.iter().any(|fraction| *fraction > 0.0)).count();
    if (pitched as f32) < PITCHED_MIN * units.len().max(1) as f32 {
        return None;
    }
    let mut sum = [0.0_f32; 12];
    for unit in units {
        // A loud beat counts up to four times as much as a quiet beat.
        let weight = (unit.level / 60.0).max(0.25);
        sum.iter_mut().zip(unit.chroma).for_each(|(sum, fraction)| *sum += weight * fraction);
    }
    let total: f32 = sum.iter().sum();
    let mean = sum.map(|fraction| fraction / total.max(f32::MIN_POSITIVE));
    let change = units.iter().filter(|unit| unit.chroma.iter().any(|fraction| *fraction > 0.0));
    let change = change.map(|unit| distance(&unit.chroma, &mean)).sum::<f32>() / pitched.max(1) as f32;
    (change >= CHANGE_MIN && are_varied(&sum)).then_some(sum)
}

/// True if pitch class weights have a contrast, and enough of them are heard. A held note has fewer.
pub(crate) fn are_varied(classes: &[f32; 12]) -> bool {
    let total: f32 = classes.iter().sum();
    let largest = classes.iter().copied().fold(0.0, f32::max);
    let smallest = classes.iter().copied().fold(f32::INFINITY, f32::min);
    let heard = classes.iter().filter(|weight| **weight > 0.04 * total).count();
    heard >= HEARD_MIN && largest - smallest >= CONTRAST_MIN * total / 12.0
}

/// Returns the key of a song, or `None` if no key fits. The returned key has the largest correlation with the pitch
/// classes (Krumhansl 1990). A key and its relative key have the same notes, so the fraction of the tonic's triad also
/// counts, among all chords and among the first chords of sections.
pub(super) fn key(
    units: &[Unit],
    chords: &[Option<Tonality>],
    firsts: &[Option<Tonality>],
) -> Option<Tonality> {
    let sum = pitches_of(units)?;
    let fits = |key: &Tonality| key.fit_as_key(&sum);
    let fraction = |of: &[Option<Tonality>], key: &Tonality| {
        of.iter().filter(|chord| chord.as_ref() == Some(key)).count() as f32 / of.len().max(1) as f32
    };
    let likely = |key: &Tonality| {
        fits(key) + TONIC_FRACTION * fraction(chords, key) + FIRST_FRACTION * fraction(firsts, key)
    };
    let best = Tonality::all().max_by(|a, b| likely(a).total_cmp(&likely(b)))?;
    (fits(&best) >= KEY_MIN).then_some(best)
}

/// Returns the chord of each unit: the likeliest sequence of triads (a hidden Markov model like Sheh and Ellis 2003,
/// with correlations instead of probabilities). A unit has `None` if no triad fits or if it has no pitches.
pub(super) fn chords(units: &[Unit]) -> Vec<Option<Tonality>> {
    if pitches_of(units).is_none() {
        return vec![None; units.len()];
    }
    let chords: Vec<Option<Tonality>> = Tonality::all().map(Some).chain([None]).collect();
    let fits = |unit: &Unit, chord: &Option<Tonality>| match chord {
        None => CHORD_MIN,
        Some(chord) => chord.fit_as_triad(&unit.chroma),
    };
    let scores = units.iter().map(|unit| chords.iter().map(|chord| fits(unit, chord)).collect());
    let path = likeliest_states(&scores.collect::<Vec<_>>(), CHANGE_COST);
    path.into_iter().map(|chord| chords[chord]).collect()
}

/// Returns the likeliest sequence of states (Viterbi 1967). The rows of `scores` belong to successive times, and contain
/// the score of each state. Every change of the state costs `change`.
pub(super) fn likeliest_states(scores: &[Vec<f32>], change: f32) -> Vec<usize> {
    let mut best = vec![0.0_f32; scores.first().map_or(0, Vec::len)];
    let mut came_from = Vec::with_capacity(scores.len());
    for score in scores {
        let likeliest = largest(&best);
        let floor = best[likeliest] - change;
        let from = |state: usize| if best[state] >= floor { state } else { likeliest };
        came_from.push((0..best.len()).map(from).collect::<Vec<usize>>());
        best = best.iter().zip(score).map(|(before, score)| before.max(floor) + score).collect();
    }
    let mut state = largest(&best);
    let mut states = Vec::with_capacity(scores.len());
    for from in came_from.iter().rev() {
        states.push(state);
        state = from[state];
    }
    states.reverse();
    states
}

/// Returns the index of the largest value.
pub(crate) fn largest(values: &[f32]) -> usize {
    (0..values.len()).max_by(|a, b| values[*a].total_cmp(&values[*b])).unwrap_or_default()
}

fn turned(fractions: &[f32; 12], root: u8) -> [f32; 12] {
    std::array::from_fn(|class| fractions[(class + usize::from(root)) % 12])
}

/// Pearson's correlation; 0 if one of the inputs is constant.
fn correlation(a: &[f32; 12], b: &[f32; 12]) -> f32 {
    let less_mean = |values: &[f32; 12]| {
        let mean = values.iter().sum::<f32>() / 12.0;
        values.map(|value| value - mean)
    };
    let (a, b) = (less_mean(a), less_mean(b));
    let product = |a: &[f32; 12], b: &[f32; 12]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f32>();
    let scale = (product(&a, &a) * product(&b, &b)).sqrt();
    if scale > 1e-9 { product(&a, &b) / scale } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_profile_has_its_own_key() {
        for key in Tonality::all() {
            let profile = if key.mode == Mode::Major { MAJOR } else { MINOR };
            let sum: f32 = profile.iter().sum();
            let fraction = |class: usize| profile[(class + 12 - usize::from(key.root)) % 12] / sum;
            // Alternate between even and odd pitch classes, because a constant chord would count as a held note.
            let units = [0, 1].map(|turn| {
                let chroma =
                    std::array::from_fn(|class| if class % 2 == turn { fraction(class) } else { 0.0 });
                Unit { chroma, level: 60.0, low: 0.0, onsets: 0.0, timbre: [0.0; 20] }
            });
            assert_eq!(super::key(&units, &[], &[]), Some(key));
            let held = Unit { chroma: std::array::from_fn(fraction), ..units[0] };
            assert_eq!(super::key(&[held; 4], &[], &[]), None);
        }
    }
}
