//! The grid of cells in which flashes are counted.

/// Cells from left to right. A field of view spans a third of them.
pub const COLUMNS: usize = 48;
/// Cells from top to bottom.
pub const ROWS: usize = 36;
/// Cells of a grid.
pub const CELLS: usize = COLUMNS * ROWS;

/// Maximum number of flashes of a kind, general or red, that are allowed in one second.
pub const FLASHES_MAX: usize = 3;

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
        let linear = crate::srgb::linear_of_bytes();
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
