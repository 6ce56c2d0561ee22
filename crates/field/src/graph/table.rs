//! Tables of the sound, read as smooth curves and surfaces.
//!
//! A row of entries c is the uniform cubic B-spline Σ cᵢ B(x - i) (de Boor 1978). Its slope and curvature are
//! continuous, and every value is in the range of the four entries around it. Rows are blended by the same spline.
//! At its ends a row is continued by its mirror image, so the curve is level there and meets the constant value
//! beyond the end without a kink.
//!
//! The curve between two entries, a piece, is stored as its four Bézier points. A shader reads a piece with one fetch.
//! Values are in the hull of the points, slopes in the hull of the points' differences (Farin 2002). With straight
//! lines the scene terrain took 64.2 evaluations per pixel, with splines 59.6: their slopes do not jump.

use std::array;
use std::sync::{Arc, OnceLock};

use super::interval::Interval;
use super::table_extremes::TableExtremes;

/// Four Bézier points, or four weights that sum to 1.
type Points = [f32; 4];

/// A table that is read with coordinates in 0..1. The first entry is at 0 and the last at 1, unless the rows scroll
/// ([`TableData::scrolling`]). A table without entries is 0 everywhere. Cloning is cheap.
#[derive(Debug, Clone, Default)]
pub struct TableData {
    columns: usize,
    rows: usize,
    values: Option<Arc<[f32]>>,
    /// For scrolling rows, the row at coordinate 0 and the number of rows from there to coordinate 1.
    scroll: Option<(f32, f32)>,
    unknown: Option<(f32, f32)>,
    derived: Option<Arc<Derived>>,
}

#[derive(Debug, Default)]
struct Derived {
    pieces: OnceLock<Vec<Points>>,
    extremes: OnceLock<Extremes>,
}

/// The extremes of each patch's Bézier points and of their differences. A patch joins a piece to that of the next row.
#[derive(Debug)]
struct Extremes {
    values: TableExtremes,
    across: TableExtremes,
    down: TableExtremes,
}

type Touched<'a> = (&'a Extremes, (usize, usize), (usize, usize));

impl PartialEq for TableData {
    fn eq(&self, other: &Self) -> bool {
        (self.columns, self.rows, self.scroll, self.unknown)
            == (other.columns, other.rows, other.scroll, other.unknown)
            && self.values == other.values
    }
}

/// Upper bound of an evaluation's rounding error, relative to the largest Bézier point.
const ROUNDING: f32 = 16.0 * f32::EPSILON;

/// `value` clamped to 0..1; 0 for a NaN.
pub(super) fn unit(value: f32) -> f32 {
    if value > 0.0 { value.min(1.0) } else { 0.0 }
}

fn bezier([a, b, c, d]: [f32; 4]) -> Points {
    [(a + 4.0 * b + c) / 6.0, (2.0 * b + c) / 3.0, (b + 2.0 * c) / 3.0, (b + 4.0 * c + d) / 6.0]
}

fn bernstein(x: f32) -> Points {
    let s = 1.0 - x;
    [s * s * s, 3.0 * s * s * x, 3.0 * s * x * x, x * x * x]
}

/// Returns the weights of the four entries around a point at the fraction `x` between the second and the third entry.
fn spline(x: f32) -> Points {
    let s = 1.0 - x;
    let inner = |x: f32| 2.0 / 3.0 - 0.5 * x * x * (2.0 - x);
    [s * s * s / 6.0, inner(x), inner(s), x * x * x / 6.0]
}

fn dot(a: Points, b: Points) -> f32 {
    (a[0] * b[0] + a[1] * b[1]) + (a[2] * b[2] + a[3] * b[3])
}

/// Returns the entry to read at `index`, mirrored at the ends. `index` is in -1..=`count` + 1.
fn mirrored(index: isize, count: usize) -> usize {
    let last = count.saturating_sub(1);
    let index = index.unsigned_abs();
    if index <= last { index } else { (2 * last).saturating_sub(index) }
}

fn around(first: usize, count: usize) -> [usize; 4] {
    array::from_fn(|index| mirrored(first as isize + index as isize - 1, count))
}

/// Returns the number of pieces between `count` entries. A single entry is one constant piece.
fn pieces_between(count: usize) -> usize {
    count.saturating_sub(1).max(1)
}

impl TableData {
    /// No entries: 0 everywhere.
    pub const EMPTY: Self =
        Self { columns: 0, rows: 0, values: None, scroll: None, unknown: None, derived: None };

    /// Returns a table of one row.
    pub fn row(values: impl Into<Arc<[f32]>>) -> Self {
        let values = values.into();
        let columns = values.len();
        Self::rows(values, columns)
    }

    /// Returns a table of rows with `columns` entries each. Entries of an incomplete last row are ignored.
    pub fn rows(values: impl Into<Arc<[f32]>>, columns: usize) -> Self {
        let values = values.into();
        let rows = values.len().checked_div(columns).unwrap_or(0);
        let values = (rows > 0).then_some(values);
        let derived = values.is_some().then(Arc::default);
        Self { columns, rows, values, derived, ..Self::EMPTY }
    }

    /// Like [`TableData::rows`], with coordinate 0 at row `first` and 1 at row `first + span`, both clamped.
    pub fn scrolling(values: impl Into<Arc<[f32]>>, columns: usize, first: f32, span: f32) -> Self {
        Self { scroll: Some((first.max(0.0), span.max(0.0))), ..Self::rows(values, columns) }
    }

    /// Returns a table with known bounds but unknown entries. Reading the table returns 0.
    pub(super) fn within(low: f32, high: f32) -> Self {
        Self { unknown: Some((low, high)), ..Self::EMPTY }
    }

    /// Returns the entries, row after row.
    pub fn values(&self) -> &[f32] {
        self.values.as_deref().unwrap_or_default()
    }

    /// Returns the row at coordinate 0, and the number of rows from there to coordinate 1.
    pub fn scroll(&self) -> (f32, f32) {
        self.scroll.unwrap_or((0.0, self.rows.saturating_sub(1) as f32))
    }

    /// Returns the Bézier points of each row's pieces, for shaders: a mirrored row before the first row, all
    /// rows, and two mirrored rows after the last row. Empty if the table has no entries.
    pub fn rows_of_pieces(&self) -> impl Iterator<Item = &[[f32; 4]]> {
        let width = pieces_between(self.columns);
        (0..self.row_of_pieces_count())
            .map(move |row| &self.pieces()[mirrored(row as isize - 1, self.rows) * width..][..width])
    }

    /// Returns the number of [`TableData::rows_of_pieces`], without computing the pieces.
    pub fn row_of_pieces_count(&self) -> usize {
        if self.values.is_some() { self.rows + 3 } else { 0 }
    }

    /// Returns the number of pieces of a row.
    pub fn pieces_in_row(&self) -> usize {
        pieces_between(self.columns)
    }

    fn pieces(&self) -> &[Points] {
        let Some((values, derived)) = self.values.as_ref().zip(self.derived.as_ref()) else { return &[] };
        derived.pieces.get_or_init(|| {
            let width = pieces_between(self.columns);
            let mut pieces = Vec::with_capacity(self.rows * width);
            for row in values.chunks_exact(self.columns) {
                pieces.extend((0..width).map(|first| bezier(around(first, self.columns).map(|at| row[at]))));
            }
            pieces
        })
    }

    /// Returns the piece at a coordinate, and the coordinate's position in the piece, 0..1.
    #[inline]
    fn place(coordinate: f32, count: usize, first: f32, span: f32) -> (usize, f32) {
        let along = (first + unit(coordinate) * span).min((count - 1) as f32);
        let piece = (along as usize).min(count.saturating_sub(2));
        (piece, along - piece as f32)
    }

    #[inline]
    fn column_place(&self, u: f32) -> (usize, f32) {
        Self::place(u, self.columns, 0.0, (self.columns - 1) as f32)
    }

    #[inline]
    fn row_place(&self, v: f32) -> (usize, f32) {
        let (first, span) = self.scroll();
        Self::place(v, self.rows, first, span)
    }

    /// Returns the Bézier points of a piece in the four rows around a row.
    #[inline]
    fn strips(&self, row: usize, piece: usize) -> [Points; 4] {
        let (pieces, width) = (self.pieces(), pieces_between(self.columns));
        around(row, self.rows).map(|row| pieces[row * width + piece])
    }

    /// Returns the value at column coordinate u and row coordinate v, both clamped to 0..1.
    pub fn at(&self, u: f32, v: f32) -> f32 {
        if self.values.is_none() {
            return 0.0;
        }
        let (piece, x) = self.column_place(u);
        if self.rows == 1 {
            return dot(bernstein(x), self.pieces()[piece]);
        }
        let (row, y) = self.row_place(v);
        dot(bernstein(x), blended(self.strips(row, piece), spline(y)))
    }

    /// Returns the slopes along u and along v; 0 beyond the ends.
    pub fn slopes(&self, u: f32, v: f32) -> (f32, f32) {
        if self.values.is_none() {
            return (0.0, 0.0);
        }
        let ((piece, x), (row, y)) = (self.column_place(u), self.row_place(v));
        let strips = self.strips(row, piece);
        let inside = |coordinate: f32| (0.0..=1.0).contains(&coordinate);
        let by_u = || {
            let (points, s) = (blended(strips, spline(y)), 1.0 - x);
            let weights = [s * s, 2.0 * s * x, x * x, 0.0];
            dot(weights, array::from_fn(|k| points[(k + 1).min(3)] - points[k])) * self.columns_scale()
        };
        let by_v = || {
            let s = 1.0 - y;
            let weights = [s * s / 6.0, 1.0 / 6.0 + s * y / 3.0, y * y / 6.0, 0.0];
            let points = strips.map(|points| dot(bernstein(x), points));
            dot(weights, array::from_fn(|k| points[(k + 1).min(3)] - points[k])) * self.rows_scale()
        };
        (if inside(u) { by_u() } else { 0.0 }, if inside(v) { by_v() } else { 0.0 })
    }

    /// Returns the factor that turns a difference of neighbouring Bézier points into a slope along u.
    fn columns_scale(&self) -> f32 {
        3.0 * self.columns.saturating_sub(1) as f32
    }

    fn rows_scale(&self) -> f32 {
        if self.rows > 1 { 3.0 * self.scroll().1 } else { 0.0 }
    }

    /// Returns bounds of [`TableData::slopes`] over intervals. They include 0 if an interval extends beyond the table.
    pub fn slope_bounds(&self, u: Interval, v: Interval) -> (Interval, Interval) {
        if self.unknown.is_some() {
            return (Interval::ALL, Interval::ALL);
        }
        let none = Interval::point(0.0);
        let Some((extremes, columns, rows)) = self.touched(u, v) else { return (none, none) };
        let scaled = |differences: Interval, scale: f32, is_inside: bool| {
            let slopes = match differences.is_any() {
                true => Interval::ANY,
                false => Interval::new(differences.lo * scale, differences.hi * scale),
            };
            if is_inside { slopes } else { slopes.hull(none) }
        };
        let is_inside = |coordinate: Interval, count: usize, (first, span): (f32, f32)| {
            coordinate.lo >= 0.0 && coordinate.hi <= 1.0 && first + coordinate.hi * span <= (count - 1) as f32
        };
        let width = (0.0, (self.columns - 1) as f32);
        let (across, down) = (extremes.across.within(columns, rows), extremes.down.within(columns, rows));
        let by_u = scaled(across, self.columns_scale(), is_inside(u, self.columns, width));
        (by_u, scaled(down, self.rows_scale(), is_inside(v, self.rows, self.scroll())))
    }

    /// Returns bounds of the value over intervals: the extremes of the Bézier points that affect it.
    pub fn bounds(&self, u: Interval, v: Interval) -> Interval {
        let bounds = match (self.unknown, self.touched(u, v)) {
            (Some((lo, hi)), _) => Interval { lo, hi },
            (None, Some((extremes, columns, rows))) => extremes.values.within(columns, rows),
            (None, None) => return Interval::point(0.0),
        };
        if bounds.is_any() {
            return bounds;
        }
        let error = bounds.lo.abs().max(bounds.hi.abs()) * ROUNDING + f32::MIN_POSITIVE;
        // Weights are never negative, so non-negative points give a non-negative value.
        let lo = if bounds.lo >= 0.0 { (bounds.lo - error).max(0.0) } else { bounds.lo - error };
        Interval { lo, hi: bounds.hi + error }
    }

    /// Returns the extremes, and the first and last column and row of the patches in u and v; `None` without entries.
    fn touched(&self, u: Interval, v: Interval) -> Option<Touched<'_>> {
        let derived = self.derived.as_ref()?;
        let touched = |coordinate: Interval, count: usize, place: &dyn Fn(f32) -> (usize, f32)| {
            if coordinate.is_any() {
                return (0, pieces_between(count) - 1);
            }
            (place(coordinate.lo).0, place(coordinate.hi).0)
        };
        let columns = touched(u, self.columns, &|u| self.column_place(u));
        let rows = touched(v, self.rows, &|v| self.row_place(v));
        Some((derived.extremes.get_or_init(|| self.extremes()), columns, rows))
    }

    fn extremes(&self) -> Extremes {
        let (width, height) = (pieces_between(self.columns), pieces_between(self.rows));
        let ranges: Vec<_> = (0..width * height).map(|at| self.patch(at / width, at % width)).collect();
        let of = |which: usize| TableExtremes::of(ranges.iter().map(|ranges| ranges[which]), width);
        Extremes { values: of(0), across: of(1), down: of(2) }
    }

    /// Returns the ranges of a patch's Bézier points and of their differences, widened; NaN if an entry is not finite.
    fn patch(&self, row: usize, piece: usize) -> [(f32, f32); 3] {
        let strips = self.strips(row, piece);
        let points: [Points; 4] = array::from_fn(|k| match self.rows {
            1 => [strips[0][k]; 4],
            _ => bezier(strips.map(|strip| strip[k])),
        });
        let values = range(points.iter().flatten().copied());
        let error = 2.0 * ROUNDING * values.0.abs().max(values.1.abs());
        let widened = |(low, high): (f32, f32)| (low - error, high + error);
        let across = range(points.windows(2).flat_map(|two| (0..4).map(|k| two[1][k] - two[0][k])));
        let down = range(points.iter().flat_map(|points| points.windows(2).map(|two| two[1] - two[0])));
        [values, widened(across), widened(down)]
    }
}

#[inline]
fn blended(strips: [Points; 4], weights: Points) -> Points {
    array::from_fn(|k| dot(weights, strips.map(|points| points[k])))
}

/// Returns the least and the greatest number; NaN if a number is not finite.
fn range(numbers: impl Iterator<Item = f32>) -> (f32, f32) {
    numbers.fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), number| match number.is_finite() {
        true if low.is_nan() => (low, high),
        true => (low.min(number), high.max(number)),
        false => (f32::NAN, f32::NAN),
    })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn cubic(x: f64) -> f64 {
        let x = x.abs();
        match x {
            _ if x < 1.0 => 2.0 / 3.0 - x * x + 0.5 * x * x * x,
            _ if x < 2.0 => (2.0 - x).powi(3) / 6.0,
            _ => 0.0,
        }
    }

    fn defined(table: &TableData, u: f64, v: f64) -> f64 {
        let (columns, rows) = (table.columns as i32, table.rows as i32);
        let mirrored = |index: i32, count: i32| {
            let period = (2 * (count - 1)).max(1);
            let index = index.rem_euclid(period);
            index.min(period - index).min(count - 1)
        };
        let x = u.clamp(0.0, 1.0) * f64::from(columns - 1);
        let (first, span) = table.scroll();
        let y = (f64::from(first) + v.clamp(0.0, 1.0) * f64::from(span)).min(f64::from(rows - 1));
        let mut sum = 0.0;
        for row in -3..rows + 3 {
            for column in -3..columns + 3 {
                let at = mirrored(row, rows) * columns + mirrored(column, columns);
                let weight = cubic(x - f64::from(column)) * cubic(y - f64::from(row));
                sum += weight * f64::from(table.values()[at as usize]);
            }
        }
        sum
    }

    fn table(columns: usize, rows: usize, seed: &[f32], scroll: Option<(f32, f32)>) -> TableData {
        let values = seed[..columns * rows].to_vec();
        match scroll {
            Some((first, span)) => TableData::scrolling(values, columns, first, span),
            None => TableData::rows(values, columns),
        }
    }

    proptest! {
        #[test]
        fn sound_tables_are_cubic_splines(
            columns in 1_usize..12,
            rows in 1_usize..12,
            seed in prop::collection::vec(-1.0_f32..1.0, 144),
            (u, v) in (-0.2_f32..1.2, -0.2_f32..1.2),
            scroll in prop::option::of((0.0_f32..4.0, 0.0_f32..6.0)),
        ) {
            let table = table(columns, rows, &seed, scroll);
            let expected = defined(&table, f64::from(u), f64::from(v));
            prop_assert!((f64::from(table.at(u, v)) - expected).abs() < 1e-4, "{} is not {expected}", table.at(u, v));
        }

        #[test]
        fn bounds_of_tables_hold_values_and_slopes(
            columns in 1_usize..12,
            rows in 1_usize..12,
            seed in prop::collection::vec(prop_oneof![Just(0.0_f32), -100.0_f32..100.0], 144),
            ends in prop::array::uniform4(-0.2_f32..1.2),
            inside in prop::collection::vec((0.0_f32..=1.0, 0.0_f32..=1.0), 16),
            scroll in prop::option::of((0.0_f32..4.0, 0.0_f32..6.0)),
            broken in prop::option::of(0_usize..144),
        ) {
            let mut seed = seed;
            if let Some(value) = broken.and_then(|place| seed.get_mut(place)) {
                *value = f32::NAN;
            }
            let table = table(columns, rows, &seed, scroll);
            let [a, b, c, d] = ends;
            let (u, v) = (Interval::new(a.min(b), a.max(b)), Interval::new(c.min(d), c.max(d)));
            let (bounds, slopes) = (table.bounds(u, v), table.slope_bounds(u, v));
            for (s, t) in inside {
                let between = |i: Interval, t: f32| (i.lo + t * (i.hi - i.lo)).clamp(i.lo, i.hi);
                let (x, y) = (between(u, s), between(v, t));
                let (by_u, by_v) = table.slopes(x, y);
                prop_assert!(bounds.contains(table.at(x, y)), "{} at {x}, {y} not in {bounds:?}", table.at(x, y));
                prop_assert!(slopes.0.contains(by_u), "{by_u} at {x}, {y} not in {:?}", slopes.0);
                prop_assert!(slopes.1.contains(by_v), "{by_v} at {x}, {y} not in {:?}", slopes.1);
            }
        }

        #[test]
        fn bounds_of_tables_are_close(
            seed in prop::collection::vec(0.0_f32..1.0, 144),
            (column, row) in (0_usize..11, 0_usize..11),
        ) {
            let table = table(12, 12, &seed, None);
            let within = |piece: usize| Interval::new((piece as f32 + 0.01) / 11.0, (piece as f32 + 0.99) / 11.0);
            let bounds = table.bounds(within(column), within(row));
            let four = |first: usize| around(first, 12);
            let entries = four(row).into_iter().flat_map(|row| four(column).map(|column| seed[row * 12 + column]));
            let (low, high) = range(entries);
            prop_assert!(low - 1e-4 <= bounds.lo && bounds.hi <= high + 1e-4, "{bounds:?} beyond {low}..{high}");
            prop_assert!(bounds.hi - bounds.lo <= 0.9 * (high - low), "{bounds:?} of {low}..{high}");
        }
    }

    #[test]
    fn curves_end_level_and_continue_as_constants() {
        let table = TableData::row(vec![0.0, 1.0, 2.0, 3.0]);
        for end in [0.0, 1.0] {
            assert!(table.slopes(end, 0.0).0.abs() < 1e-5);
            assert_eq!(table.at(end, 0.0), table.at(3.0 * end - 1.0, 0.0));
        }
        let (inside, _) = table.slope_bounds(Interval::new(0.4, 0.45), Interval::point(0.0));
        assert!(inside.lo > 0.0, "it rises there: {inside:?}");
    }

    #[test]
    fn a_table_of_equal_entries_is_that_entry() {
        for (columns, rows) in [(1, 1), (1, 5), (5, 1), (2, 2), (7, 3)] {
            let table = TableData::rows(vec![0.7; columns * rows], columns);
            for at in [0.0, 0.3, 0.99, 1.0] {
                assert!((table.at(at, 1.0 - at) - 0.7).abs() < 1e-6, "{columns} x {rows}");
                let (by_u, by_v) = table.slopes(at, at);
                assert!(by_u.abs() < 1e-4 && by_v.abs() < 1e-4, "{by_u} {by_v}");
            }
        }
    }

    #[test]
    fn shaders_get_mirrored_rows_at_both_ends() {
        let table = TableData::rows(vec![1.0, 1.0, 2.0, 2.0, 3.0, 3.0, 4.0, 4.0], 2);
        let rows: Vec<f32> = table.rows_of_pieces().map(|row| row[0][0]).collect();
        assert_eq!(rows, [2.0, 1.0, 2.0, 3.0, 4.0, 3.0, 2.0]);
        assert_eq!(TableData::EMPTY.rows_of_pieces().count(), 0);
        assert_eq!(
            TableData::row(vec![5.0]).rows_of_pieces().map(|row| row[0][3]).collect::<Vec<_>>(),
            [5.0; 4]
        );
    }
}
