//! Tests of the grid of an image.

use crate::witness::grid_of;
use mariana_render::flash::Grid;

#[test]
fn cells_are_means_of_linear_light_and_a_pixel_fills_them_all() {
    let mut rgba = vec![255; 96 * 72 * 4];
    for at in [0, 96] {
        rgba[4 * at..4 * at + 3].fill(0);
    }
    let grid = grid_of(&rgba, (96, 72));
    assert_eq!(grid.colors()[..2], [[0.5; 3], [1.0; 3]]);
    let one = grid_of(&[188, 0, 0, 255], (1, 1));
    assert!(one.colors().iter().all(|[r, g, b]| (r - 0.503).abs() < 1e-3 && (*g, *b) == (0.0, 0.0)));
    assert_eq!(grid_of(&[], (9, 9)), Grid::new([[f32::NAN; 3]]));
}
