//! Tests of the fields of view.

use crate::witness::fields::{crowded, largest_fraction};
use mariana_render::flash::rules::{FIELD_COLUMNS as WIDTH, FIELD_ROWS as HEIGHT};
use mariana_render::flash::{COLUMNS, ROWS};

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
