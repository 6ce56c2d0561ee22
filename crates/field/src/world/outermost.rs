//! The open cells of the search for a scene's box (`bounds.rs`), ordered by how far out they are.

use std::cmp::Ordering;
use std::rc::Rc;

use crate::bounds::Bounds;
use crate::region::every_frame::BoxProgram;

/// A cell that may contain a surface, with a program for this cell.
pub(super) struct Part {
    pub(super) cell: Bounds,
    pub(super) program: Rc<BoxProgram>,
    /// A lower bound of the distance.
    pub(super) low: f32,
    /// Number of the last divisions that have not shortened the program.
    pub(super) vain: u8,
    /// True if the cell's outer slice, which is thin enough, may contain a surface.
    pub(super) is_tight: bool,
}

/// Returns how far out a cell extends at a face. The faces are those at the low ends, then those at the high ends.
pub(super) fn end(cell: &Bounds, face: usize) -> f32 {
    if face < 3 { -cell.low[face] } else { cell.high[face % 3] }
}

/// A cell that is ordered by how far out it is at a face. Of equally far cells, the narrowest and then the one with the
/// least distance come first: if one of them contains a surface, the others need no division.
pub(super) struct Outer {
    pub(super) end: f32,
    /// The largest extent along the face.
    pub(super) width: f32,
    pub(super) part: Part,
}

impl Outer {
    pub(super) fn new(part: Part, face: usize) -> Self {
        let width = part.cell.side((face + 1) % 3).max(part.cell.side((face + 2) % 3));
        Self { end: end(&part.cell, face), width, part }
    }
}

impl PartialEq for Outer {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Outer {}

impl PartialOrd for Outer {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Outer {
    fn cmp(&self, other: &Self) -> Ordering {
        self.end
            .total_cmp(&other.end)
            .then_with(|| other.width.total_cmp(&self.width))
            .then_with(|| other.part.low.total_cmp(&self.part.low))
    }
}
