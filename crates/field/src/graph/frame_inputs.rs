//! The data that a frame gives to every point: the sound's features, the scene's parameters and the tables.

use super::{BAND_COUNT, SoundInputs};
use std::sync::Arc;

use super::interval::Interval;
use super::node::Input;
use super::table_extremes::{SharedExtremes, TableExtremes};

/// Reads the scene's textures on the CPU.
pub trait TextureReader: std::fmt::Debug + Send + Sync {
    /// The channel (0 red .. 3 alpha) of a texture at (u, v), in 0..1.
    fn read(&self, texture: u16, channel: u8, u: f32, v: f32) -> f32;
}

/// `value` clamped to 0..1; 0 for a NaN.
fn unit(value: f32) -> f32 {
    if value > 0.0 { value.min(1.0) } else { 0.0 }
}

/// A table that is read with coordinates in 0..1 and interpolated linearly. The first entry lies at 0 and the last at
/// 1, unless the rows scroll ([`TableData::scrolling`]). Without entries it is 0 everywhere. Cheap to clone.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TableData {
    columns: usize,
    rows: usize,
    values: Option<Arc<[f32]>>,
    /// If the rows scroll: the row at coordinate 0, and the number of rows from there to coordinate 1.
    scroll: Option<(f32, f32)>,
    /// Bounds of the entries, if the entries themselves are not known.
    unknown: Option<(f32, f32)>,
    extremes: Option<SharedExtremes>,
}

/// Rectangles of fewer entries are looked at one by one.
const FEW_ENTRIES: usize = 24;

impl TableData {
    /// No entries: 0 everywhere.
    pub const EMPTY: Self =
        Self { columns: 0, rows: 0, values: None, scroll: None, unknown: None, extremes: None };

    /// A table of one row.
    pub fn row(values: impl Into<Arc<[f32]>>) -> Self {
        let values = values.into();
        let columns = values.len();
        Self::rows(values, columns)
    }

    /// A table of rows with `columns` entries each; entries of an incomplete last row are not read.
    pub fn rows(values: impl Into<Arc<[f32]>>, columns: usize) -> Self {
        let values = values.into();
        let rows = values.len().checked_div(columns).unwrap_or(0);
        let values = (rows > 0).then_some(values);
        Self { columns, rows, values, extremes: Some(SharedExtremes::default()), ..Self::EMPTY }
    }

    /// The same, with coordinate 0 at row `first` and coordinate 1 at row `first + span`, both clamped to the
    /// existing rows.
    pub fn scrolling(values: impl Into<Arc<[f32]>>, columns: usize, first: f32, span: f32) -> Self {
        Self { scroll: Some((unit(first), span.max(0.0))), ..Self::rows(values, columns) }
    }

    /// The entries, row after row.
    pub fn values(&self) -> &[f32] {
        self.values.as_deref().unwrap_or_default()
    }

    /// The row at coordinate 0, and the number of rows from there to coordinate 1.
    pub fn scroll(&self) -> (f32, f32) {
        self.scroll.unwrap_or((0.0, self.rows.saturating_sub(1) as f32))
    }

    /// A table of which only the bounds of its entries are known. Reading it gives 0.
    fn within(low: f32, high: f32) -> Self {
        Self { unknown: Some((low, high)), ..Self::EMPTY }
    }

    /// The two entries beside a coordinate and the fraction of the way from the first to the second.
    #[inline]
    fn place(coordinate: f32, count: usize, (first, span): (f32, f32)) -> (usize, usize, f32) {
        let last = count - 1;
        let along = (first + unit(coordinate) * span).min(last as f32);
        let first = (along as usize).min(last);
        (first, (first + 1).min(last), along - first as f32)
    }

    /// The two columns beside a coordinate.
    #[inline]
    fn column_place(&self, u: f32) -> (usize, usize, f32) {
        Self::place(u, self.columns, (0.0, (self.columns - 1) as f32))
    }

    /// The two rows beside a coordinate.
    #[inline]
    fn row_place(&self, v: f32) -> (usize, usize, f32) {
        Self::place(v, self.rows, self.scroll())
    }

    /// The value at column coordinate u and row coordinate v, both clamped to 0..1.
    pub fn at(&self, u: f32, v: f32) -> f32 {
        let Some(values) = &self.values else { return 0.0 };
        let (left, right, x) = self.column_place(u);
        let (upper, lower, y) = self.row_place(v);
        let row = |row: usize| {
            let row = &values[row * self.columns..];
            row[left] * (1.0 - x) + row[right] * x
        };
        if upper == lower { row(upper) } else { row(upper) * (1.0 - y) + row(lower) * y }
    }

    /// The slopes by u and by v; 0 beyond the ends.
    pub fn slopes(&self, u: f32, v: f32) -> (f32, f32) {
        let Some(values) = &self.values else { return (0.0, 0.0) };
        let (left, right, x) = self.column_place(u);
        let (upper, lower, y) = self.row_place(v);
        let value = |row: usize, column: usize| values[row * self.columns + column];
        let inside = |coordinate: f32| (0.0..=1.0).contains(&coordinate);
        let by_u = |row: usize| value(row, right) - value(row, left);
        let by_v = |column: usize| value(lower, column) - value(upper, column);
        (
            if inside(u) {
                (by_u(upper) * (1.0 - y) + by_u(lower) * y) * (self.columns - 1) as f32
            } else {
                0.0
            },
            if inside(v) { (by_v(left) * (1.0 - x) + by_v(right) * x) * self.scroll().1 } else { 0.0 },
        )
    }

    /// Bounds of [`TableData::slopes`] over intervals of the coordinates: those of all pieces that can be touched,
    /// and 0 beyond the ends.
    pub fn slope_bounds(&self, u: Interval, v: Interval) -> (Interval, Interval) {
        if self.unknown.is_some() {
            return (Interval::ALL, Interval::ALL);
        }
        let touched @ (left, right, upper, lower) = self.touched(u, v);
        let none = Interval::point(0.0);
        if let Some(extremes) = self.extremes_of_many(touched) {
            let [across, down] = extremes.of_slopes(|| self.slope_extremes());
            let before = |end: usize, first: usize| end.checked_sub(1).filter(|last| *last >= first);
            let by_u = before(right, left).map(|last| across.within((left, last), (upper, lower)));
            let by_v = before(lower, upper).map(|last| down.within((left, right), (upper, last)));
            return (none.hull(by_u.unwrap_or(none)), none.hull(by_v.unwrap_or(none)));
        }
        let (mut by_u, mut by_v) = (none, none);
        for row in upper..=lower {
            for column in left..=right {
                if column < right {
                    by_u = by_u.hull(self.across(row, column));
                }
                if row < lower {
                    by_v = by_v.hull(self.down(row, column));
                }
            }
        }
        (by_u, by_v)
    }

    /// The extremes of all slopes by u and by v.
    fn slope_extremes(&self) -> [TableExtremes; 2] {
        let (columns, rows) = (self.columns.saturating_sub(1), self.rows.saturating_sub(1));
        let ends = |slope: Interval| (slope.lo, slope.hi);
        let across = (0..self.rows * columns).map(|at| ends(self.across(at / columns, at % columns)));
        let down = (0..rows * self.columns).map(|at| ends(self.down(at / self.columns, at % self.columns)));
        [TableExtremes::of(across, columns), TableExtremes::of(down, self.columns)]
    }

    /// The slope by u from an entry to the one in the next column.
    fn across(&self, row: usize, column: usize) -> Interval {
        let scale = self.columns.saturating_sub(1) as f32;
        Self::piece(self.entry(row, column), self.entry(row, column + 1), scale)
    }

    /// The slope by v from an entry to the one in the next row.
    fn down(&self, row: usize, column: usize) -> Interval {
        Self::piece(self.entry(row, column), self.entry(row + 1, column), self.scroll().1)
    }

    fn entry(&self, row: usize, column: usize) -> f32 {
        self.values()[row * self.columns + column]
    }

    /// The slope from one entry to the next, where `scale` entries lie between 0 and 1, widened by the rounding of
    /// the interpolation between rows.
    fn piece(from: f32, to: f32, scale: f32) -> Interval {
        let error = 16.0 * f32::EPSILON * from.abs().max(to.abs()) * scale;
        let slope = (to - from) * scale;
        Interval::new(slope - error, slope + error)
    }

    /// What finds extremes where so many entries are touched that they are not looked at one by one.
    fn extremes_of_many(
        &self,
        (left, right, upper, lower): (usize, usize, usize, usize),
    ) -> Option<&SharedExtremes> {
        let entries = (right + 1).saturating_sub(left) * (lower + 1).saturating_sub(upper);
        self.extremes.as_ref().filter(|_| entries > FEW_ENTRIES)
    }

    /// First and last column and first and last row whose entries can be read. For a table without entries the range
    /// is empty: the first lies behind the last.
    fn touched(&self, u: Interval, v: Interval) -> (usize, usize, usize, usize) {
        if self.values.is_none() {
            return (1, 0, 1, 0);
        }
        let touched = |coordinate: Interval, count: usize, place: &dyn Fn(f32) -> (usize, usize, f32)| {
            if coordinate.is_any() {
                return (0, count - 1);
            }
            (place(coordinate.lo).0, place(coordinate.hi).1)
        };
        let (left, right) = touched(u, self.columns, &|u| self.column_place(u));
        let (upper, lower) = touched(v, self.rows, &|v| self.row_place(v));
        (left, right, upper, lower)
    }

    /// Bounds of the value over intervals of the coordinates: the extremes of the entries that can be touched.
    pub fn bounds(&self, u: Interval, v: Interval) -> Interval {
        if let Some((low, high)) = self.unknown {
            return Interval { lo: low, hi: high };
        }
        let Some(values) = &self.values else { return Interval::point(0.0) };
        let touched @ (left, right, upper, lower) = self.touched(u, v);
        let bounds = match self.extremes_of_many(touched) {
            Some(extremes) => extremes.of(values, self.columns).within((left, right), (upper, lower)),
            _ => {
                let mut bounds = Interval { lo: f32::INFINITY, hi: f32::NEG_INFINITY };
                for row in upper..=lower {
                    for &value in &values[row * self.columns..][left..=right] {
                        if !value.is_finite() {
                            return Interval::ANY;
                        }
                        bounds = Interval { lo: bounds.lo.min(value), hi: bounds.hi.max(value) };
                    }
                }
                bounds
            }
        };
        if bounds.is_any() {
            return bounds;
        }
        // The interpolation rounds relative to the larger of the two entries.
        let error = bounds.lo.abs().max(bounds.hi.abs()) * super::interval::LIBRARY_ERROR + f32::MIN_POSITIVE;
        Interval { lo: bounds.lo - error, hi: bounds.hi + error }
    }
}

/// The frame that constant folding passes to operators, none of which reads it.
pub(super) static SILENT: FrameInputs = FrameInputs {
    time: 0.0,
    sound: SoundInputs::SILENCE,
    bands: [0.0; BAND_COUNT],
    eye: [0.0; 3],
    params: Vec::new(),
    hoisted: Vec::new(),
    spectrum: TableData::EMPTY,
    waveform: TableData::EMPTY,
    history: TableData::EMPTY,
    textures: None,
    ranges: None,
};

/// The inputs of a frame. The default is silence at time 0.
#[derive(Debug, Clone, Default)]
pub struct FrameInputs {
    /// Time in seconds.
    pub time: f32,
    /// The numbers of the sound.
    pub sound: SoundInputs,
    /// The frequency bands, low to high.
    pub bands: [f32; BAND_COUNT],
    /// Position of the eye.
    pub eye: [f32; 3],
    /// The scene's parameters by number; missing ones are 0.
    pub params: Vec<f32>,
    /// The values that were computed once for this frame, by number; missing ones are 0.
    pub hoisted: Vec<f32>,
    /// The spectrum, low to high.
    pub spectrum: TableData,
    /// The waveform, old to new.
    pub waveform: TableData,
    /// The history of the spectrum: a row per age, the newest first.
    pub history: TableData,
    /// The scene's textures; without a reader every texture is 0.
    pub textures: Option<Arc<dyn TextureReader>>,
    /// The ranges of the parameters; set only where nothing else is known of them ([`FrameInputs::any`]).
    pub ranges: Option<Arc<[Interval]>>,
}

/// Longest time in seconds for which the bounds for every frame hold: a day.
const TIME_MAX: f32 = 86_400.0;

impl FrameInputs {
    /// The inputs of all frames at once: any sound, any time, parameters within their ranges. Bounds over them hold
    /// for every frame; values computed with them are those of silence.
    pub fn any(params: impl IntoIterator<Item = (f32, f32)>) -> Self {
        Self {
            spectrum: TableData::within(0.0, 1.0),
            waveform: TableData::within(-1.0, 1.0),
            history: TableData::within(0.0, 1.0),
            ranges: Some(params.into_iter().map(|(low, high)| Interval::new(low, high)).collect()),
            ..Self::default()
        }
    }

    /// Bounds of an input: a single value, unless these are the inputs of every frame ([`FrameInputs::any`]).
    pub fn bounds(&self, input: Input) -> Interval {
        let Some(params) = &self.ranges else { return Interval::point(self.value(input)) };
        match input {
            Input::T => Interval { lo: 0.0, hi: TIME_MAX },
            Input::Sound(input) => {
                let (lo, hi) = input.range();
                Interval { lo, hi }
            }
            Input::Band(_) => Interval::UNIT,
            Input::Param(i) => params.get(usize::from(i)).copied().unwrap_or(Interval::ANY),
            Input::X | Input::Y | Input::Z | Input::NX | Input::NY | Input::NZ => Interval::ANY,
            Input::EyeX | Input::EyeY | Input::EyeZ | Input::Hoisted(_) => Interval::ANY,
        }
    }

    /// The value of an input that is the same all over the frame; 0 for the inputs of a point.
    pub fn value(&self, input: Input) -> f32 {
        match input {
            Input::X | Input::Y | Input::Z | Input::NX | Input::NY | Input::NZ => 0.0,
            Input::T => self.time,
            Input::Sound(input) => self.sound[input],
            Input::Band(i) => self.bands.get(usize::from(i)).copied().unwrap_or(0.0),
            Input::EyeX => self.eye[0],
            Input::EyeY => self.eye[1],
            Input::EyeZ => self.eye[2],
            Input::Param(i) => self.params.get(usize::from(i)).copied().unwrap_or(0.0),
            Input::Hoisted(i) => self.hoisted.get(usize::from(i)).copied().unwrap_or(0.0),
        }
    }

    /// The band with the number floor(index), clamped to the existing bands; band 0 for a NaN.
    pub fn band(&self, index: f32) -> f32 {
        self.bands[Self::band_number(index)]
    }

    /// The number of the band that [`FrameInputs::band`] reads.
    pub fn band_number(index: f32) -> usize {
        (index.max(0.0) as usize).min(BAND_COUNT - 1)
    }

    /// Bounds of [`FrameInputs::band`].
    pub fn band_bounds(&self, index: Interval) -> Interval {
        if self.ranges.is_some() {
            return Interval::UNIT;
        }
        let (first, last) = if index.is_any() {
            (0, BAND_COUNT - 1)
        } else {
            (Self::band_number(index.lo), Self::band_number(index.hi))
        };
        self.bands[first..=last]
            .iter()
            .map(|&band| Interval::point(band))
            .fold(Interval::point(self.bands[first]), |bounds, band| bounds.hull(band))
    }

    /// One channel of a texture; 0 without a reader, and always in 0..1.
    pub fn texture(&self, texture: u16, channel: u8, u: f32, v: f32) -> f32 {
        let value = self.textures.as_ref().map_or(0.0, |reader| reader.read(texture, channel, u, v));
        unit(value)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn slopes_of_large_rectangles_are_those_of_all_their_pieces(
            columns in 1_usize..12,
            rows in 1_usize..12,
            seed in prop::collection::vec(-100.0_f32..100.0, 144),
            ends in prop::array::uniform4(-0.2_f32..1.2),
            scroll in prop::option::of((0.0_f32..4.0, 0.0_f32..6.0)),
            broken in prop::option::of(0_usize..144),
        ) {
            let mut values = seed[..columns * rows].to_vec();
            if let Some(value) = broken.and_then(|place| values.get_mut(place)) {
                *value = f32::NAN;
            }
            let table = match scroll {
                Some((first, span)) => TableData::scrolling(values, columns, first, span),
                None => TableData::rows(values, columns),
            };
            let one_by_one = TableData { extremes: None, ..table.clone() };
            let [a, b, c, d] = ends;
            let (u, v) = (Interval::new(a.min(b), a.max(b)), Interval::new(c.min(d), c.max(d)));
            prop_assert_eq!(table.slope_bounds(u, v), one_by_one.slope_bounds(u, v));
        }
    }
}
