//! Divides the cells of the search for a scene's box (`bounds.rs`).

use super::bounds::{Part, REACH};
use crate::bounds::Bounds as Cell;

/// Maximum number of pieces of a cell.
pub(super) const PIECES: usize = 5;

/// Ratio of the sides of a cube and of the next smaller cube.
pub(super) const NESTED: f32 = 4.0;

/// Offset of the cube's centre from the origin, so that the first cuts do not pass through objects at the origin.
const ASIDE: f32 = 0.017 * REACH;

/// Divides a cube into 64 cells, of which the inner ones form the next smaller cube.
pub(super) fn nested(half: f32) -> [Cell; 64] {
    let cuts = [-half, -half / NESTED, 0.0, half / NESTED, half].map(|cut| ASIDE + cut);
    std::array::from_fn(|cell| {
        let place = place_in(cell);
        Cell { low: place.map(|place| cuts[place]), high: place.map(|place| cuts[place + 1]) }
    })
}

/// Divides a cell into 4x4x4 equal cells.
pub(super) fn sixty_fourths(cell: &Cell) -> [Cell; 64] {
    std::array::from_fn(|part| {
        let mut child = *cell;
        for (axis, place) in place_in(part).into_iter().enumerate() {
            (child.low[axis], child.high[axis]) = slice(cell, axis, place, 4);
        }
        child
    })
}

/// Returns the place of one of 4x4x4 cells.
fn place_in(cell: usize) -> [usize; 3] {
    [cell % 4, cell / 4 % 4, cell / 16]
}

/// Halves a cell along its longer axes. The inner half at a face stays in one piece, because it may never be needed.
pub(super) fn pieces(part: &Part, face: usize) -> Vec<Part> {
    let (axis, mut cell) = (face % 3, part.cell);
    let longest = cell.size();
    let count = |axis: usize| if cell.side(axis) > 0.6 * longest { 2 } else { 1 };
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let (of_u, of_v) = (count(u), count(v));
    let piece = |cell: Cell, is_tight: bool| Part { cell, is_tight, program: part.program.clone(), ..*part };
    let mut pieces = Vec::with_capacity(PIECES);
    if count(axis) == 2 {
        let (mut inner, middle) = (cell, 0.5 * (cell.low[axis] + cell.high[axis]));
        (*cell.face_mut((face + 3) % 6), *inner.face_mut(face)) = (middle, middle);
        pieces.push(piece(inner, false));
    }
    for place in 0..of_u * of_v {
        let mut quarter = cell;
        (quarter.low[u], quarter.high[u]) = slice(&cell, u, place % of_u, of_u);
        (quarter.low[v], quarter.high[v]) = slice(&cell, v, place / of_u, of_v);
        pieces.push(piece(quarter, part.is_tight));
    }
    pieces
}

/// Returns the coordinate at a depth below a face of a cell.
pub(super) fn below(cell: &Cell, face: usize, depth: f32) -> f32 {
    let (low, high) = (cell.low[face % 3], cell.high[face % 3]);
    if face < 3 { (low + depth).min(high) } else { (high - depth).max(low) }
}

/// Returns the extent of one of `count` equal slices. Neighbours have exactly the same face in common.
fn slice(cell: &Cell, axis: usize, place: usize, count: usize) -> (f32, f32) {
    let (low, high) = (cell.low[axis], cell.high[axis]);
    let face = |place: usize| match place == count {
        true => high,
        false => low + (high - low) * (place as f32 / count as f32),
    };
    (face(place), face(place + 1))
}
