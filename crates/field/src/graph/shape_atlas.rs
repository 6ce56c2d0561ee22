//! Texts and pictures as 2D distances: the grids of all of a scene's texts and pictures, in one larger grid.
//!
//! A grid holds signed distances at its points. Between the points the value is bilinear, computed in the same
//! arithmetic on the CPU and in shaders, because the weights of texture filters have only eight bits. The slope of a
//! bilinear patch is largest in a corner. Grids are made so that it is at most 1 ([`ShapeGrid::steepest`]).
//!
//! Each grid has a place in the larger grid, which expressions read by [`Op::Shape`](super::Op::Shape) in columns and
//! rows. The numbers that convert units to columns and rows are read by [`Op::ShapeNumber`](super::Op::ShapeNumber).
//! They are constant within a frame, so the CPU computes them.
//!
//! Bounds over a rectangle are the extremes of its blocks in a pyramid (Williams 1983, with extremes instead of means).
//! Within one grid, the value in the middle and the slope of 1 give bounds too. The tighter ones hold.

use std::sync::Arc;

use super::interval::Interval;

/// Number of columns of the larger grid.
pub const SHAPE_COLUMNS: usize = 2048;
/// Number of rows that the larger grid may have.
pub const SHAPE_ROWS_MAX: usize = 2048;
/// Columns and rows per unit of the coordinates in which the larger grid is read. With it, the coordinates of a text with
/// this many points per unit need no factor, which saves clauses. A power of two, so that it rounds nothing.
pub const SHAPE_STEP: f32 = 64.0;
/// Numbers of one shape: half its width and height in units, coordinates per unit, and the coordinates of its centre.
pub const SHAPE_NUMBERS: usize = 5;
/// Largest number of shapes in a frame: of two scenes that are blended.
pub const FRAME_SHAPES_MAX: usize = 64;

/// Patches per side of a block of the pyramid's finest level.
const BLOCK: usize = 4;
/// A search in the pyramid visits at most this many blocks per side.
const BLOCKS_VISITED: usize = 4;
/// The value without shapes.
const NOTHING: f32 = 1.0;
const ROUNDING: f32 = 8.0 * f32::EPSILON;

/// The signed distances to one text or picture, at the points of a grid that is centred at the origin.
#[derive(Debug, Clone, PartialEq)]
pub struct ShapeGrid {
    columns: usize,
    /// Points per unit.
    pub points_per_unit: f32,
    /// In units, row after row, from the bottom.
    values: Arc<[f32]>,
}

impl ShapeGrid {
    /// Returns a grid of rows with `columns` values each, in units, the lowest row first. `None` unless the grid has
    /// two columns and rows, fits the larger grid, and holds only finite numbers.
    pub fn new(values: impl Into<Arc<[f32]>>, columns: usize, points_per_unit: f32) -> Option<Self> {
        let values = values.into();
        let rows = values.len().checked_div(columns)?;
        let fits = (2..SHAPE_COLUMNS).contains(&columns) && (2..SHAPE_ROWS_MAX).contains(&rows);
        let is_whole = rows * columns == values.len() && values.iter().all(|value| value.is_finite());
        let is_scaled = points_per_unit.is_finite() && points_per_unit > 0.0;
        (fits && is_whole && is_scaled).then_some(Self { columns, points_per_unit, values })
    }

    /// Returns a grid of large distances. Its size is clamped to the sizes that [`ShapeGrid::new`] accepts, and its
    /// scale to a normal number.
    pub fn empty(columns: usize, rows: usize, points_per_unit: f32) -> Self {
        let (columns, rows) = (columns.clamp(2, SHAPE_COLUMNS - 1), rows.clamp(2, SHAPE_ROWS_MAX - 1));
        let points_per_unit = points_per_unit.clamp(f32::MIN_POSITIVE, f32::MAX);
        let far = ((columns + rows) as f32 / points_per_unit).min(f32::MAX);
        Self { columns, points_per_unit, values: vec![far; columns * rows].into() }
    }

    /// Numbers of columns and rows.
    pub fn size(&self) -> (usize, usize) {
        (self.columns, self.rows())
    }

    /// The values, row after row from the bottom.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    fn rows(&self) -> usize {
        self.values.len() / self.columns
    }

    fn half(&self, points: usize) -> f32 {
        (points - 1) as f32 / (2.0 * self.points_per_unit)
    }

    /// Returns the steepest slope of the bilinear patches.
    pub fn steepest(&self) -> f32 {
        let mut steepest = 0.0_f32;
        for rows in self.values.windows(2 * self.columns).step_by(self.columns) {
            let (lower, upper) = rows.split_at(self.columns);
            for (lower, upper) in lower.windows(2).zip(upper.windows(2)) {
                let across = (lower[1] - lower[0]).abs().max((upper[1] - upper[0]).abs());
                let up = (upper[0] - lower[0]).abs().max((upper[1] - lower[1]).abs());
                steepest = steepest.max(across.hypot(up));
            }
        }
        steepest * self.points_per_unit
    }
}

/// A shape of a scene, for [`ShapeAtlas::new`].
#[derive(Debug, Clone, PartialEq)]
pub struct AtlasShape {
    /// The distances.
    pub grid: ShapeGrid,
    /// True if other distances may replace these from frame to frame. The size of the grid stays.
    pub changes: bool,
}

/// The larger grid, which holds the grids of all shapes of a scene. The default has no shapes. Cloning is cheap.
#[derive(Debug, Clone, Default)]
pub struct ShapeAtlas(Option<Arc<Grids>>);

#[derive(Debug)]
struct Grids {
    rows: usize,
    values: Vec<f32>,
    placed: Vec<Placed>,
    /// Bounds of all numbers of shapes.
    numbers: Interval,
    /// From fine to coarse.
    levels: Vec<Level>,
}

#[derive(Debug, Clone)]
struct Placed {
    shape: AtlasShape,
    column: usize,
    row: usize,
}

/// The least and the greatest value of each block.
#[derive(Debug)]
struct Level {
    columns: usize,
    rows: usize,
    blocks: Vec<(f32, f32)>,
}

impl PartialEq for ShapeAtlas {
    /// True if both are the same grid in memory, or have no shapes.
    fn eq(&self, other: &Self) -> bool {
        match (&self.0, &other.0) {
            (Some(one), Some(other)) => Arc::ptr_eq(one, other),
            (one, other) => one.is_none() && other.is_none(),
        }
    }
}

impl Placed {
    fn numbers(&self) -> [f32; SHAPE_NUMBERS] {
        let (columns, rows) = self.shape.grid.size();
        let grid = &self.shape.grid;
        let middle = |first: usize, count: usize| first as f32 + 0.5 * (count - 1) as f32;
        [
            grid.half(columns),
            grid.half(rows),
            grid.points_per_unit / SHAPE_STEP,
            middle(self.column, columns) / SHAPE_STEP,
            middle(self.row, rows) / SHAPE_STEP,
        ]
    }

    /// True if the shape's patches, with one more patch at each side, hold the patches of a rectangle.
    fn holds(&self, columns: (usize, usize), rows: (usize, usize)) -> bool {
        let (width, height) = self.shape.grid.size();
        let within =
            |first: usize, count: usize, (low, high): (usize, usize)| low >= first && high < first + count;
        within(self.column, width, columns) && within(self.row, height, rows)
    }

    fn touches(&self, columns: (usize, usize), rows: (usize, usize)) -> bool {
        let (width, height) = self.shape.grid.size();
        let overlap = |first: usize, count: usize, (low, high): (usize, usize)| {
            low <= first + count && high + 1 >= first
        };
        overlap(self.column, width, columns) && overlap(self.row, height, rows)
    }

    /// Bounds of all distances that may replace these: no point is deeper than its distance from the rim.
    fn any(&self) -> Interval {
        let [width, height, ..] = self.numbers();
        Interval { lo: -width.min(height), hi: 4.0 * (width + height) }
    }
}

/// Finds places for grids of these sizes in rows of [`SHAPE_COLUMNS`] columns, each with a free column and row after
/// it. Returns the places and the number of rows that are needed.
fn placed(sizes: impl Iterator<Item = (usize, usize)>) -> (Vec<(usize, usize)>, usize) {
    let (mut column, mut row, mut height) = (0, 0, 0);
    let places = sizes.map(|(columns, rows)| {
        if column + columns + 1 > SHAPE_COLUMNS {
            (column, row, height) = (0, row + height, 0);
        }
        let place = (column, row);
        column += columns + 1;
        height = height.max(rows + 1);
        place
    });
    let places = places.collect();
    (places, row + height)
}

impl ShapeAtlas {
    /// No shapes.
    pub const NONE: Self = Self(None);

    /// Returns a grid with the given shapes, in their order. `None` if they need more than [`SHAPE_ROWS_MAX`] rows, or
    /// if there are more than [`FRAME_SHAPES_MAX`].
    pub fn new(shapes: Vec<AtlasShape>) -> Option<Self> {
        if shapes.is_empty() {
            return Some(Self::default());
        }
        let (places, rows) = placed(shapes.iter().map(|shape| shape.grid.size()));
        if rows > SHAPE_ROWS_MAX || shapes.len() > FRAME_SHAPES_MAX {
            return None;
        }
        let mut values = vec![NOTHING; rows * SHAPE_COLUMNS];
        let placed: Vec<Placed> = shapes
            .into_iter()
            .zip(places)
            .map(|(shape, (column, row))| Placed { shape, column, row })
            .collect();
        for Placed { shape, column, row } in &placed {
            let (columns, count) = shape.grid.size();
            // Repeat the last column and row in the free ones: rounded coordinates may reach them.
            for line in 0..=count {
                let from = line.min(count - 1) * columns;
                let from = &shape.grid.values[from..from + columns];
                let at = (row + line) * SHAPE_COLUMNS + column;
                values[at..at + columns].copy_from_slice(from);
                values[at + columns] = from[columns - 1];
            }
        }
        let levels = levels(&values, rows);
        let numbers = placed.iter().flat_map(Placed::numbers).map(Interval::point);
        let numbers = numbers.fold(Interval::point(0.0), Interval::hull);
        Some(Self(Some(Arc::new(Grids { rows, values, placed, numbers, levels }))))
    }

    /// Returns the shapes of both grids, first the shapes of `self`; `None` as in [`ShapeAtlas::new`].
    pub fn joined(&self, other: &Self) -> Option<Self> {
        Self::new(self.shapes().chain(other.shapes()).cloned().collect())
    }

    /// Replaces the distances of shapes by their numbers. Ignores grids of other sizes, and shapes that do not change.
    pub fn with(&self, changed: &[(usize, ShapeGrid)]) -> Self {
        let mut shapes: Vec<AtlasShape> = self.shapes().cloned().collect();
        for (number, grid) in changed {
            let fits = |shape: &&mut AtlasShape| {
                shape.changes
                    && shape.grid.size() == grid.size()
                    && shape.grid.points_per_unit == grid.points_per_unit
            };
            if let Some(shape) = shapes.get_mut(*number).filter(fits) {
                shape.grid = grid.clone();
            }
        }
        Self::new(shapes).unwrap_or_else(|| self.clone())
    }

    /// The shapes, in their order.
    pub fn shapes(&self) -> impl Iterator<Item = &AtlasShape> {
        self.0.iter().flat_map(|grids| &grids.placed).map(|placed| &placed.shape)
    }

    /// Number of rows; 0 without shapes.
    pub fn rows(&self) -> usize {
        self.0.as_ref().map_or(0, |grids| grids.rows)
    }

    /// Returns a number of a shape: `SHAPE_NUMBERS` numbers for each shape, in order. The index is rounded down and
    /// clamped; 0 for a NaN. Numbers of missing shapes are 0.
    pub fn number(&self, index: f32) -> f32 {
        let index = clamped(index);
        let placed = self.0.as_ref().and_then(|grids| grids.placed.get(index / SHAPE_NUMBERS));
        placed.map_or(0.0, |placed| placed.numbers()[index % SHAPE_NUMBERS])
    }

    /// Returns bounds of [`ShapeAtlas::number`].
    pub fn number_bounds(&self, index: Interval) -> Interval {
        match &self.0 {
            Some(grids) if index.is_any() || clamped(index.lo) != clamped(index.hi) => grids.numbers,
            _ => Interval::point(self.number(index.lo)),
        }
    }

    /// Returns the distance at the coordinates of a column and a row, in units, both clamped to the grid.
    #[inline]
    pub fn at(&self, column: f32, row: f32) -> f32 {
        let Some(grids) = &self.0 else { return NOTHING };
        let ([low, across, up, both], x, y) = grids.patch(SHAPE_STEP * column, SHAPE_STEP * row);
        (both * x + up) * y + (across * x + low)
    }

    /// Returns the slopes along columns and along rows; 0 beyond the grid.
    pub fn slopes(&self, column: f32, row: f32) -> (f32, f32) {
        let Some(grids) = &self.0 else { return (0.0, 0.0) };
        let (column, row) = (SHAPE_STEP * column, SHAPE_STEP * row);
        let ([_, across, up, both], x, y) = grids.patch(column, row);
        let inside = |at: f32, count: usize| at >= 0.0 && at <= (count - 1) as f32;
        (
            if inside(column, SHAPE_COLUMNS) { SHAPE_STEP * (both * y + across) } else { 0.0 },
            if inside(row, grids.rows) { SHAPE_STEP * (both * x + up) } else { 0.0 },
        )
    }

    /// Returns bounds of [`ShapeAtlas::slopes`].
    pub fn slope_bounds(&self, column: Interval, row: Interval) -> (Interval, Interval) {
        let none = Interval::point(0.0);
        let Some(grids) = &self.0 else { return (none, none) };
        let (columns, rows) = grids.touched(scaled(column), scaled(row));
        let mut steepest = 0.0_f32;
        for placed in grids.placed.iter().filter(|placed| placed.touches(columns, rows)) {
            steepest = steepest.max(1.0 / placed.shape.grid.points_per_unit);
        }
        // Patches between shapes are as steep as their corners.
        let inside = grids.placed.iter().any(|placed| placed.holds(columns, rows));
        let steepest = SHAPE_STEP * if inside { 1.001 * steepest } else { grids.widest() };
        let slopes = Interval { lo: -steepest, hi: steepest };
        (slopes, slopes)
    }

    /// Returns bounds of [`ShapeAtlas::at`] over intervals. With `any_content`, shapes that change may have any content.
    #[inline]
    pub fn bounds(&self, column: Interval, row: Interval, any_content: bool) -> Interval {
        let Some(grids) = &self.0 else { return Interval::point(NOTHING) };
        let (column, row) = (scaled(column), scaled(row));
        let (columns, rows) = grids.touched(column, row);
        let (low, high) = grids.extremes(columns, rows);
        let error = low.abs().max(high.abs()) * ROUNDING + f32::MIN_POSITIVE;
        let mut bounds = Interval { lo: low - error, hi: high + error };
        if !column.is_any()
            && !row.is_any()
            && let Some(placed) = grids.placed.iter().find(|placed| placed.holds(columns, rows))
        {
            let half = |side: Interval, count: usize| {
                let [low, high] = [side.lo, side.hi].map(|end| end.clamp(0.0, (count - 1) as f32));
                (0.5 * (low + high), 0.5 * (high - low))
            };
            let ((x, across), (y, up)) = (half(column, SHAPE_COLUMNS), half(row, grids.rows));
            let middle = self.at(x / SHAPE_STEP, y / SHAPE_STEP);
            let reach = across.hypot(up) / placed.shape.grid.points_per_unit * 1.001 + error;
            bounds = Interval { lo: bounds.lo.max(middle - reach), hi: bounds.hi.min(middle + reach) };
        }
        if any_content {
            let changing =
                grids.placed.iter().filter(|placed| placed.shape.changes && placed.touches(columns, rows));
            return changing.fold(bounds, |bounds, placed| bounds.hull(placed.any()));
        }
        bounds
    }

    /// The numbers of the shapes, and the coefficients of the bilinear patches for shaders: four to a texel, one texel
    /// for each point. The first row holds the numbers, each in the first component of a texel. Empty without shapes.
    pub fn texels(&self) -> Vec<[f32; 4]> {
        let Some(grids) = &self.0 else { return Vec::new() };
        let mut texels = Vec::with_capacity((grids.rows + 1) * SHAPE_COLUMNS);
        texels.extend((0..SHAPE_COLUMNS).map(|at| [self.number(at as f32), 0.0, 0.0, 0.0]));
        for row in 0..grids.rows {
            texels.extend((0..SHAPE_COLUMNS).map(|column| grids.coefficients(column, row)));
        }
        texels
    }
}

/// Converts coordinates to columns or rows.
fn scaled(coordinate: Interval) -> Interval {
    coordinate.map_rising(|end| SHAPE_STEP * end)
}

fn clamped(index: f32) -> usize {
    (index.max(0.0) as usize).min(SHAPE_NUMBERS * FRAME_SHAPES_MAX - 1)
}

/// Returns the patch at a coordinate, and the position in the patch, 0..1.
#[inline(always)]
fn place(coordinate: f32, count: usize) -> (usize, f32) {
    let along = if coordinate > 0.0 { coordinate.min((count - 1) as f32) } else { 0.0 };
    let patch = (along as usize).min(count - 2);
    (patch, along - patch as f32)
}

impl Grids {
    #[inline(always)]
    fn patch(&self, column: f32, row: f32) -> ([f32; 4], f32, f32) {
        let ((column, x), (row, y)) = (place(column, SHAPE_COLUMNS), place(row, self.rows));
        (self.coefficients(column, row), x, y)
    }

    /// Returns the coefficients of 1, x, y and xy in a patch.
    #[inline(always)]
    fn coefficients(&self, column: usize, row: usize) -> [f32; 4] {
        let (right, above) = ((column + 1).min(SHAPE_COLUMNS - 1), (row + 1).min(self.rows - 1));
        let at = |column: usize, row: usize| self.values[row * SHAPE_COLUMNS + column];
        let (low, across) = (at(column, row), at(right, row) - at(column, row));
        let upper = at(column, above);
        [low, across, upper - low, (at(right, above) - upper) - across]
    }

    /// Returns the first and last column and row of the patches in two intervals.
    #[inline]
    fn touched(&self, column: Interval, row: Interval) -> ((usize, usize), (usize, usize)) {
        let patches = |side: Interval, count: usize| match side.is_any() {
            true => (0, count - 2),
            false => (place(side.lo, count).0, place(side.hi, count).0),
        };
        (patches(column, SHAPE_COLUMNS), patches(row, self.rows))
    }

    /// Returns the least and the greatest value in a rectangle of patches, or in a larger one.
    fn extremes(&self, columns: (usize, usize), rows: (usize, usize)) -> (f32, f32) {
        let mut side = BLOCK;
        let mut found = (f32::INFINITY, f32::NEG_INFINITY);
        for (number, level) in self.levels.iter().enumerate() {
            let blocks = |(first, last): (usize, usize)| (first / side, last / side);
            let ((left, right), (lower, upper)) = (blocks(columns), blocks(rows));
            let few = right - left < BLOCKS_VISITED && upper - lower < BLOCKS_VISITED;
            if few || number + 1 == self.levels.len() {
                for row in lower..=upper.min(level.rows - 1) {
                    let blocks = &level.blocks[row * level.columns..][..level.columns];
                    for (low, high) in blocks.iter().take(right + 1).skip(left) {
                        found = (found.0.min(*low), found.1.max(*high));
                    }
                }
                return found;
            }
            side *= 2;
        }
        found
    }

    /// An upper bound of the slope of every patch, also between shapes.
    fn widest(&self) -> f32 {
        let (low, high) = self.extremes((0, SHAPE_COLUMNS - 2), (0, self.rows - 2));
        high - low
    }
}

fn levels(values: &[f32], rows: usize) -> Vec<Level> {
    let (columns, block_rows) = (SHAPE_COLUMNS.div_ceil(BLOCK), rows.div_ceil(BLOCK));
    let mut blocks = vec![(f32::INFINITY, f32::NEG_INFINITY); columns * block_rows];
    for (row, line) in values.chunks_exact(SHAPE_COLUMNS).enumerate() {
        // A value at the rim of a block is also a corner of the block before.
        let of_row = [row / BLOCK, row.saturating_sub(1) / BLOCK];
        for (column, value) in line.iter().enumerate() {
            for at_row in of_row {
                for at_column in [column / BLOCK, column.saturating_sub(1) / BLOCK] {
                    let block = &mut blocks[at_row * columns + at_column];
                    *block = (block.0.min(*value), block.1.max(*value));
                }
            }
        }
    }
    let mut levels = vec![Level { columns, rows: block_rows, blocks }];
    while let Some(fine) = levels.last().filter(|level| level.blocks.len() > 1) {
        let (columns, rows) = (fine.columns.div_ceil(2), fine.rows.div_ceil(2));
        let mut blocks = vec![(f32::INFINITY, f32::NEG_INFINITY); columns * rows];
        for (at, (low, high)) in fine.blocks.iter().enumerate() {
            let block = &mut blocks[at / fine.columns / 2 * columns + at % fine.columns / 2];
            *block = (block.0.min(*low), block.1.max(*high));
        }
        levels.push(Level { columns, rows, blocks });
    }
    levels
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::graph::testing;

    #[test]
    fn grids_are_read_at_their_places() {
        let grid =
            |value: f32, columns: usize| ShapeGrid::new(vec![value; 3 * columns], columns, 2.0).unwrap();
        let shape =
            |value: f32, columns: usize| AtlasShape { grid: grid(value, columns), changes: value > 4.0 };
        let atlas = ShapeAtlas::new(vec![shape(3.0, 5), shape(4.0, 2040), shape(5.0, 7)]).unwrap();
        let middle = |atlas: &ShapeAtlas, number: usize| {
            let [column, row] = [3, 4].map(|place| atlas.number((SHAPE_NUMBERS * number + place) as f32));
            atlas.at(column, row)
        };
        assert_eq!([0, 1, 2].map(|number| middle(&atlas, number)), [3.0, 4.0, 5.0]);
        assert_eq!(atlas.rows(), 8, "the second shape and the third one share a row");
        assert_eq!([0.0, 1.0, 2.0].map(|index| atlas.number(index)), [1.0, 0.5, 2.0 / SHAPE_STEP]);
        let other = atlas.with(&[(0, grid(9.0, 5)), (2, grid(9.0, 7))]);
        assert_eq!([0, 1, 2].map(|number| middle(&other, number)), [3.0, 4.0, 9.0]);
        let joined = atlas.joined(&other).unwrap();
        assert_eq!([2, 5].map(|number| middle(&joined, number)), [5.0, 9.0]);
        assert!(atlas == atlas.clone() && atlas != other && ShapeAtlas::default() == ShapeAtlas::default());
        let nothing = ShapeAtlas::default();
        assert_eq!((nothing.at(1.0, 2.0), nothing.number(0.0), nothing.texels().len()), (1.0, 0.0, 0));
    }

    #[test]
    fn unusable_grids_are_refused() {
        assert!(ShapeGrid::new(vec![0.0; 4], 2, 1.0).is_some());
        for (values, columns, scale) in [
            (vec![0.0; 2], 2, 1.0),
            (vec![0.0; 5], 2, 1.0),
            (vec![0.0; 4], 0, 1.0),
            (vec![f32::NAN; 4], 2, 1.0),
            (vec![0.0; 4], 2, 0.0),
            (vec![0.0; 2 * SHAPE_COLUMNS], SHAPE_COLUMNS, 1.0),
            (vec![0.0; 2 * SHAPE_ROWS_MAX], 2, 1.0),
        ] {
            assert!(ShapeGrid::new(values, columns, scale).is_none(), "{columns} {scale}");
        }
        let large = AtlasShape { grid: ShapeGrid::empty(2000, 1100, 1.0), changes: false };
        assert!(ShapeAtlas::new(vec![large.clone()]).is_some() && ShapeAtlas::new(vec![large; 2]).is_none());
    }

    #[test]
    fn the_steepest_slope_is_that_of_a_corner() {
        let grid = ShapeGrid::new(vec![0.0, 3.0, 4.0, 7.0], 2, 2.0).unwrap();
        assert_eq!(grid.steepest(), 10.0);
        let twisted = ShapeGrid::new(vec![0.0, 1.0, 0.0, -1.0], 2, 1.0).unwrap();
        assert_eq!(twisted.steepest(), 5.0_f32.sqrt());
    }

    proptest! {
        #[test]
        fn bounds_hold_values_and_slopes(
            corner in prop::array::uniform2(-0.1_f32..1.0),
            size in prop::array::uniform2(prop_oneof![0.0_f32..0.01, 0.0_f32..1.0]),
            along in prop::collection::vec(prop::array::uniform2(0.0_f32..=1.0), 8),
        ) {
            let atlas = testing::frame().shapes;
            let [column, row] = [0, 1].map(|axis| Interval::new(corner[axis], corner[axis] + size[axis]));
            let bounds = atlas.bounds(column, row, false);
            let any = atlas.bounds(column, row, true);
            let (by_column, by_row) = atlas.slope_bounds(column, row);
            for [x, y] in along {
                let at = |side: Interval, along: f32| (side.lo + along * (side.hi - side.lo)).clamp(side.lo, side.hi);
                let (x, y) = (at(column, x), at(row, y));
                let value = atlas.at(x, y);
                prop_assert!(bounds.contains(value) && any.contains(value), "{value} at {x}, {y}: {bounds:?}");
                let slopes = atlas.slopes(x, y);
                prop_assert!(by_column.contains(slopes.0) && by_row.contains(slopes.1), "{slopes:?} {by_column:?}");
            }
        }
    }
}
