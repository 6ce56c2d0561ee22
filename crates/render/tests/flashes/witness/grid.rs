//! The mean colours of the cells of an image.

use mariana_render::flash::{CELLS, COLUMNS, Grid, ROWS};

/// Builds the grid of a finished image: sRGB, four bytes per pixel, row by row.
pub(crate) fn grid_of(rgba: &[u8], size: (u32, u32)) -> Grid {
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
    Grid::new((0..CELLS).map(mean))
}

/// Relative luminance of linear RGB with the primaries of sRGB.
pub(crate) fn luminance([r, g, b]: [f32; 3]) -> f32 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}
