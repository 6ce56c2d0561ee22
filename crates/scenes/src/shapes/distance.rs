//! Signed distances from the coverage of pixels.
//!
//! The squared Euclidean distances are exact for the given seeds: lower envelopes of parabolas, first along columns, then
//! along rows (Felzenszwalb and Huttenlocher 2012, Distance Transforms of Sampled Functions). A pixel that is partly
//! covered is a seed whose own distance follows from the fraction, as if its edge were straight and perpendicular to an
//! axis. The pixels are finer than the grid by [`FINER`], so this error hardly matters.

use super::outline::Coverage;
use mariana_field::graph::ShapeGrid;

/// Pixels per point of the grid, along each side; an even number.
pub(super) const FINER: usize = 4;
/// Maximum number of sweeps over steep patches that make them flatter.
const SWEEPS: usize = 16;
/// A patch with a slope above this is steep. All distances are then divided by the steepest slope that remains.
const STEEP: f32 = 1.002;
/// Allowance for the rounding of values far from edges.
const ROUNDING: f32 = 2e-5;
/// The squared distance of a pixel without a seed: farther than any pixel.
const FAR: f32 = 1e12;
/// Covered fractions below this are 0: they come from rounding.
const LEAST: f32 = 1.0 / 512.0;

/// Returns the distances to the covered pixels at the points of a grid of `columns` by `rows`, negative inside. The
/// coverage has [`FINER`] pixels per point along each side. No bilinear patch has a slope above 1. `None` if the grid
/// is unusable.
pub(super) fn grid(coverage: &Coverage, size: (usize, usize), points_per_unit: f32) -> Option<ShapeGrid> {
    let (columns, rows) = size;
    if coverage.values.iter().all(|value| *value < 0.5) {
        return Some(ShapeGrid::empty(columns, rows, points_per_unit));
    }
    let signed = signed(coverage);
    let at =
        |column: usize, row: usize| signed.get(row * coverage.width + column).copied().unwrap_or_default();
    let mut values = Vec::with_capacity(columns * rows);
    for row in 0..rows {
        for column in 0..columns {
            // A point is between the four pixels around it.
            let (x, y) = (FINER * column + FINER / 2, FINER * row + FINER / 2);
            let sum = at(x, y) + at(x - 1, y) + at(x, y - 1) + at(x - 1, y - 1);
            values.push(0.25 * sum / FINER as f32);
        }
    }
    flatten(&mut values, columns);
    // One unit has `points_per_unit` points.
    let steepest = ShapeGrid::new(values.clone(), columns, 1.0)?.steepest().max(1.0) * (1.0 + ROUNDING);
    let scale = 1.0 / (steepest * points_per_unit);
    values.iter_mut().for_each(|value| *value *= scale);
    ShapeGrid::new(values, columns, points_per_unit)
}

/// Makes patches that are too steep as flat as allowed, without changing their means. The grids that are flat enough
/// are a convex set, so repeated sweeps approach it. Steep patches are at ridges, where the nearest edge changes.
fn flatten(values: &mut [f32], columns: usize) {
    let last = values.len().saturating_sub(columns);
    let mut active: Vec<usize> = (0..last).collect();
    for _ in 0..SWEEPS {
        active.retain(|lower| flatten_patch(values, columns, *lower));
        // A change makes the patches around it steeper.
        let around = [columns + 1, columns, columns - 1, 1, 0];
        let beside =
            |at: usize| around.into_iter().flat_map(move |off| [at.checked_sub(off), Some(at + off)]);
        let mut next: Vec<usize> = active.into_iter().flat_map(beside).flatten().collect();
        next.sort_unstable();
        next.dedup();
        next.retain(|lower| *lower < last);
        if next.is_empty() {
            break;
        }
        active = next;
    }
}

/// Flattens one patch. Returns true if it was too steep.
fn flatten_patch(values: &mut [f32], columns: usize, lower: usize) -> bool {
    if (lower + 1).is_multiple_of(columns) {
        return false;
    }
    let places = [lower, lower + 1, lower + columns, lower + columns + 1];
    let [a, b, c, d] = places.map(|at| values[at]);
    let across = (b - a).abs().max((d - c).abs());
    let up = (c - a).abs().max((d - b).abs());
    let steepest = across.hypot(up);
    if steepest <= STEEP {
        return false;
    }
    let mean = 0.25 * (a + b + c + d);
    for (place, value) in places.into_iter().zip([a, b, c, d]) {
        values[place] = mean + (value - mean) / steepest;
    }
    true
}

/// Returns the distance of each pixel's centre from the edge, in pixels, negative where covered.
fn signed(coverage: &Coverage) -> Vec<f32> {
    let squares = |outside: bool| {
        let seed = |value: &f32| {
            let off = if outside { 0.5 - value } else { value - 0.5 };
            if off >= 0.5 - LEAST { FAR } else { off.max(0.0) * off.max(0.0) }
        };
        let mut squares: Vec<f32> = coverage.values.iter().map(seed).collect();
        transform(&mut squares, coverage.width, coverage.height);
        squares
    };
    let (outside, inside) = (squares(true), squares(false));
    outside.iter().zip(&inside).map(|(outside, inside)| outside.sqrt() - inside.sqrt()).collect()
}

/// Replaces seeds by squared distances: each value becomes the least sum of a seed and its squared distance.
fn transform(values: &mut [f32], width: usize, height: usize) {
    let longest = width.max(height);
    let mut envelope = Envelope { roots: Vec::with_capacity(longest), line: vec![0.0; longest] };
    for column in 0..width {
        envelope.along(values, (0..height).map(|row| row * width + column));
    }
    for row in 0..height {
        envelope.along(values, row * width..(row + 1) * width);
    }
}

/// The lower envelope of the parabolas at the seeds of one line.
struct Envelope {
    /// The place and seed of each parabola on the envelope, and where it begins to be the lowest.
    roots: Vec<(f64, f64, f64)>,
    line: Vec<f32>,
}

impl Envelope {
    fn along(&mut self, values: &mut [f32], places: impl Iterator<Item = usize> + Clone) {
        self.roots.clear();
        for (at, place) in places.clone().enumerate() {
            let seed = values[place];
            if seed >= FAR {
                continue;
            }
            let (at, seed) = (at as f64, f64::from(seed));
            let mut from = f64::NEG_INFINITY;
            while let Some((other, others, begin)) = self.roots.last() {
                from = ((seed + at * at) - (others + other * other)) / (2.0 * (at - other));
                if from > *begin {
                    break;
                }
                self.roots.pop();
                from = f64::NEG_INFINITY;
            }
            self.roots.push((at, seed, from));
        }
        let mut current = 0;
        for (at, to) in self.line.iter_mut().enumerate() {
            while self.roots.get(current + 1).is_some_and(|next| next.2 <= at as f64) {
                current += 1;
            }
            *to = self
                .roots
                .get(current)
                .map_or(FAR, |(root, seed, _)| ((at as f64 - root) * (at as f64 - root) + seed) as f32);
        }
        for (place, value) in places.zip(&self.line) {
            values[place] = *value;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::outline::{Filling, Steps};
    use super::*;
    use kurbo::{Affine, BezPath, Circle, Rect, Shape};
    use proptest::prelude::*;

    fn distances(path: &BezPath, (columns, rows): (usize, usize), per_unit: f32) -> ShapeGrid {
        let pixels = Affine::scale(FINER as f64) * path;
        let size = (FINER * columns, FINER * rows);
        let coverage = Coverage::of(&pixels, Filling::Turning, size.0, size.1, &mut Steps(1 << 20)).unwrap();
        grid(&coverage, (columns, rows), per_unit).unwrap()
    }

    fn assert_near(found: &ShapeGrid, off: impl Fn(f64, f64) -> f64, error: f64) {
        let (columns, _) = found.size();
        for (at, value) in found.values().iter().enumerate() {
            let (x, y) = ((at % columns) as f64 + 0.5, (at / columns) as f64 + 0.5);
            let wanted = off(x, y) / f64::from(found.points_per_unit);
            // The steepest patch makes all values smaller.
            assert!(
                (f64::from(*value) - wanted).abs() < error + 0.15 * wanted.abs(),
                "{value} {wanted} at {x}, {y}"
            );
        }
    }

    #[test]
    fn discs_and_boxes_have_their_distances() {
        let disc = distances(&Circle::new((20.3, 15.1), 9.7).to_path(1e-3), (41, 30), 2.0);
        assert_near(&disc, |x, y| (x - 20.3).hypot(y - 15.1) - 9.7, 0.1);
        assert!(disc.steepest() <= 1.0 && disc.steepest() > 0.9);
        let rect = distances(&Rect::new(8.25, 6.5, 30.0, 21.75).to_path(1.0), (40, 30), 10.0);
        let off = |x: f64, y: f64| {
            let (x, y) = ((x - 19.125).abs() - 10.875, (y - 14.125).abs() - 7.625);
            x.max(0.0).hypot(y.max(0.0)) + x.max(y).min(0.0)
        };
        assert_near(&rect, off, 0.1);
        assert!(rect.steepest() <= 1.0);
    }

    #[test]
    fn nothing_is_near_an_empty_picture() {
        let empty = distances(&BezPath::new(), (9, 7), 2.0);
        assert!(empty.values().iter().all(|value| *value >= 8.0) && empty.steepest() == 0.0);
    }

    type Spot = ([f64; 2], f64);

    /// The steepest slope around discs and bars at these centres, of these sizes.
    fn steepest_around(spots: &[Spot]) -> f32 {
        let mut path = BezPath::new();
        for (number, ([x, y], size)) in spots.iter().copied().enumerate() {
            path.extend(match number % 2 {
                0 => Circle::new((x, y), size).to_path(1e-2),
                _ => {
                    Affine::rotate_about(size, (x, y))
                        * Rect::new(x - size, y - 0.3, x + size, y + 0.3).to_path(1.0)
                }
            });
        }
        distances(&path, (30, 30), 1.0).steepest()
    }

    #[test]
    fn many_ridges_near_each_other_are_flattened_too() {
        let spots: [Spot; 11] = [
            ([11.98880906723772, 10.169019705675412], 4.971971010970727),
            ([5.551993807948415, 8.71655502529198], 0.3),
            ([2.0, 20.76055828600115], 0.3),
            ([3.268643137199101, 5.164516230655854], 0.5194110403598561),
            ([25.09912341083455, 19.516069758202214], 2.0783196496725487),
            ([20.97664432812108, 15.458155266095115], 3.5826276927894005),
            ([16.82229392071038, 13.702238880530535], 1.2470082024059168),
            ([2.0, 22.32130750157283], 0.3),
            ([17.6251758110972, 7.767869019812307], 1.1734652360404565),
            ([25.356464919636313, 19.79297282980616], 2.3905054709352314),
            ([8.41341816400715, 5.847516837162278], 3.521143193070708),
        ];
        assert!(steepest_around(&spots) <= 1.0);
    }

    proptest! {
        #[test]
        fn no_patch_is_steeper_than_1(
            spots in prop::collection::vec((prop::array::uniform2(2.0_f64..28.0), 0.3_f64..6.0), 1..12),
        ) {
            let steepest = steepest_around(&spots);
            prop_assert!(steepest <= 1.0, "{steepest}");
        }

        #[test]
        fn squared_distances_are_the_least_of_all_seeds(
            seeds in prop::collection::vec(prop_oneof![2 => Just(FAR), 1 => 0.0_f32..0.25], 30),
        ) {
            let (width, height) = (6, 5);
            let mut values = seeds.clone();
            transform(&mut values, width, height);
            for (at, value) in values.iter().enumerate() {
                let off = |seed: usize| {
                    let of = |place: usize| ((place % width) as f32, (place / width) as f32);
                    (of(at).0 - of(seed).0).powi(2) + (of(at).1 - of(seed).1).powi(2)
                };
                let least = seeds.iter().enumerate().map(|(seed, own)| own + off(seed));
                let least = least.fold(f32::INFINITY, f32::min);
                prop_assert!((value - least).abs() < 1e-4 || (*value >= FAR && least >= FAR), "{value} {least}");
            }
        }
    }
}
