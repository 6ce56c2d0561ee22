//! Ten-degree fields of view. A field is a rectangle with a third of the image's width and height, at any position.

use mariana_render::flash::{CELLS, COLUMNS, FIELD_COLUMNS as WIDTH, FIELD_ROWS as HEIGHT, ROWS};

const FIELD: usize = WIDTH * HEIGHT;

/// A summed-area table: for each corner of cells, the sum over all cells above and to the left of the corner.
type Sums = Vec<u32>;

/// Calls `see` for each field, with the field's first cell and the fraction, 0..1, of marked cells.
fn for_each_field(marked: impl Fn(usize) -> bool, mut see: impl FnMut(usize, f64)) {
    let sums = summed(|cell| u32::from(marked(cell)));
    let at = |x: usize, y: usize| sums.get(y * (COLUMNS + 1) + x).copied().unwrap_or(0);
    for y in 0..=ROWS - HEIGHT {
        for x in 0..=COLUMNS - WIDTH {
            let inside = at(x + WIDTH, y + HEIGHT) + at(x, y) - at(x + WIDTH, y) - at(x, y + HEIGHT);
            see(y * COLUMNS + x, f64::from(inside) / FIELD as f64);
        }
    }
}

fn summed(value: impl Fn(usize) -> u32) -> Sums {
    let mut sums = vec![0; (COLUMNS + 1) * (ROWS + 1)];
    for cell in 0..CELLS {
        let (x, y) = (cell % COLUMNS, cell / COLUMNS);
        let at = |x: usize, y: usize| sums.get(y * (COLUMNS + 1) + x).copied().unwrap_or(0);
        let sum = value(cell) + at(x, y + 1) + at(x + 1, y) - at(x, y);
        if let Some(place) = sums.get_mut((y + 1) * (COLUMNS + 1) + x + 1) {
            *place = sum;
        }
    }
    sums
}

pub(super) fn largest_fraction(marked: impl Fn(usize) -> bool) -> f64 {
    let mut largest: f64 = 0.0;
    for_each_field(marked, |_, fraction| largest = largest.max(fraction));
    largest
}

/// Finds the fields in which more than `fraction` of the cells is marked, and marks all cells of these fields. Returns
/// an empty list if there is no such field.
pub(super) fn crowded(marked: impl Fn(usize) -> bool, fraction: f64) -> Vec<bool> {
    let mut first = vec![0; CELLS];
    let mut any = false;
    for_each_field(marked, |cell, inside| {
        if inside > fraction
            && let Some(place) = first.get_mut(cell)
        {
            (*place, any) = (1, true);
        }
    });
    if !any {
        return Vec::new();
    }
    // The cell is in each field whose first cell is less than a field's size to the left of the cell and above it.
    let sums = summed(|cell| first.get(cell).copied().unwrap_or(0));
    let at = |x: usize, y: usize| sums.get(y * (COLUMNS + 1) + x).copied().unwrap_or(0);
    let covered = (0..CELLS).map(|cell| {
        let (right, below) = (cell % COLUMNS + 1, cell / COLUMNS + 1);
        let (left, above) = (right.saturating_sub(WIDTH), below.saturating_sub(HEIGHT));
        at(right, below) + at(left, above) > at(left, below) + at(right, above)
    });
    covered.collect()
}

/// The mean colour of each cell of an image: linear RGB, 0..1, row by row.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid(Vec<[f32; 3]>);

impl Grid {
    /// Builds a grid from the colours of [`CELLS`] cells. Missing colours and values that are not finite become black.
    pub fn new(colors: impl IntoIterator<Item = [f32; 3]>) -> Self {
        let unit = |value: f32| if value.is_finite() { value.clamp(0.0, 1.0) } else { 0.0 };
        let mut cells: Vec<[f32; 3]> = colors.into_iter().take(CELLS).map(|color| color.map(unit)).collect();
        cells.resize(CELLS, [0.0; 3]);
        Self(cells)
    }

    /// Builds the grid of a finished image: sRGB, four bytes per pixel, row by row.
    pub fn of_picture(rgba: &[u8], size: (u32, u32)) -> Self {
        let (width, height) = size;
        let linear = mariana_render::srgb::linear_of_bytes();
        let light = |byte: u8| f64::from(linear.get(usize::from(byte)).copied().unwrap_or(0.0));
        let (width, height) = (width as usize, height as usize);
        // If the image has fewer pixels than cells, each cell takes the nearest pixel.
        let span = |cell: usize, cells: usize, side: usize| {
            let first = cell * side / cells;
            first..((cell + 1) * side / cells).max(first + 1)
        };
        let pixels = rgba.as_chunks::<4>().0;
        let mean = |cell: usize| {
            let (mut sum, mut count) = ([0.0; 3], 0.0);
            for y in span(cell / COLUMNS, ROWS, height) {
                for x in span(cell % COLUMNS, COLUMNS, width) {
                    let Some([r, g, b, _]) = pixels.get(y * width + x) else { continue };
                    for (sum, byte) in sum.iter_mut().zip([r, g, b]) {
                        *sum += light(*byte);
                    }
                    count += 1.0;
                }
            }
            sum.map(|sum: f64| (sum / f64::max(count, 1.0)) as f32)
        };
        Self::new((0..CELLS).map(mean))
    }

    pub(super) fn colors(&self) -> &[[f32; 3]] {
        &self.0
    }
}

/// Relative luminance of linear RGB with the primaries of sRGB.
pub(super) fn luminance([r, g, b]: [f32; 3]) -> f32 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

#[cfg(test)]
mod tests {
    use super::*;

    fn within(cell: usize, x: std::ops::Range<usize>, y: std::ops::Range<usize>) -> bool {
        x.contains(&(cell % COLUMNS)) && y.contains(&(cell / COLUMNS))
    }

    #[test]
    fn the_largest_fraction_is_found_at_any_position() {
        assert_eq!(largest_fraction(|_| true), 1.0);
        assert_eq!(largest_fraction(|_| false), 0.0);
        for (x, y) in [(0, 0), (17, 11), (COLUMNS - 8, ROWS - 6)] {
            assert_eq!(largest_fraction(|cell| within(cell, x..x + 8, y..y + 6)), 0.25);
        }
        let apart = |cell| within(cell, 0..4, 0..6) || within(cell, 40..48, 30..36);
        assert_eq!(largest_fraction(apart), 0.25);
    }

    #[test]
    fn all_cells_of_crowded_fields_are_crowded() {
        assert!(crowded(|cell| within(cell, 0..8, 0..6), 0.25).is_empty());
        let cells = crowded(|cell| within(cell, 0..9, 0..6), 0.25);
        // Only the field in the corner contains the whole rectangle.
        for (cell, crowded) in cells.iter().enumerate() {
            assert_eq!(*crowded, within(cell, 0..WIDTH, 0..HEIGHT), "{cell}");
        }
        assert!(crowded(|_| true, 0.25).iter().all(|cell| *cell));
    }
}

#[cfg(test)]
mod grid_tests {
    use super::*;

    #[test]
    fn cells_are_means_of_linear_light_and_a_pixel_fills_them_all() {
        let mut rgba = vec![255; 96 * 72 * 4];
        for at in [0, 96] {
            rgba[4 * at..4 * at + 3].fill(0);
        }
        let grid = Grid::of_picture(&rgba, (96, 72));
        assert_eq!(grid.colors()[..2], [[0.5; 3], [1.0; 3]]);
        let one = Grid::of_picture(&[188, 0, 0, 255], (1, 1));
        assert!(one.colors().iter().all(|[r, g, b]| (r - 0.503).abs() < 1e-3 && (*g, *b) == (0.0, 0.0)));
        assert_eq!(Grid::of_picture(&[], (9, 9)), Grid::new([[f32::NAN; 3]]));
    }
}
