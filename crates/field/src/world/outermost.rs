//! The open cells of the search for a scene's box (`bounds.rs`), sorted by how far out they are.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;
use std::rc::Rc;

use super::bounds::Bounds;
use crate::region::every_frame::BoxProgram;

/// A cell that may contain a surface, with a program for this cell.
pub(super) struct Part {
    pub(super) cell: Bounds,
    pub(super) program: Rc<BoxProgram>,
    /// True if slices without surfaces are already cut off.
    pub(super) is_trimmed: bool,
}

/// Returns how far out a cell extends at a face. The faces are those at the low ends, then those at the high ends.
pub(super) fn end(cell: &Bounds, face: usize) -> f32 {
    if face < 3 { -cell.low[face] } else { cell.high[face % 3] }
}

/// The open cells, sorted by how far out they are at each face.
#[derive(Default)]
pub(super) struct Parts {
    parts: Vec<Option<Part>>,
    /// For each face, the ends, sizes and numbers of the cells. Of equally far cells, the smallest comes first: if it
    /// contains a surface, the others need no division. Cells that have been taken are removed when they come first.
    orders: [BinaryHeap<(Sortable, Reverse<Sortable>, usize)>; 6],
}

impl Parts {
    pub(super) fn of(list: Vec<Part>) -> Self {
        let mut parts = Self::default();
        list.into_iter().for_each(|part| parts.put(part));
        parts
    }

    pub(super) fn put(&mut self, part: Part) {
        let size = Sortable(part.cell.size());
        for (face, order) in self.orders.iter_mut().enumerate() {
            order.push((Sortable(end(&part.cell, face)), Reverse(size), self.parts.len()));
        }
        self.parts.push(Some(part));
    }

    /// Returns the number of the outermost cell at a face.
    fn outermost(&mut self, face: usize) -> Option<usize> {
        let order = self.orders.get_mut(face)?;
        while let Some((_, _, number)) = order.peek() {
            if self.parts.get(*number).is_some_and(Option::is_some) {
                return Some(*number);
            }
            order.pop();
        }
        None
    }

    pub(super) fn take_outermost(&mut self, face: usize) -> Option<Part> {
        let number = self.outermost(face)?;
        self.parts.get_mut(number)?.take()
    }

    pub(super) fn hull(&mut self) -> Option<Bounds> {
        let mut ends = [0.0; 6];
        for (face, known) in ends.iter_mut().enumerate() {
            let number = self.outermost(face)?;
            *known = end(&self.parts.get(number)?.as_ref()?.cell, face);
        }
        let [x, y, z, high @ ..] = ends;
        Some(Bounds { low: [-x, -y, -z], high })
    }
}

/// A number in the order of [`f32::total_cmp`].
#[derive(Clone, Copy)]
struct Sortable(f32);

impl PartialEq for Sortable {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Sortable {}

impl PartialOrd for Sortable {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Sortable {
    fn cmp(&self, other: &Self) -> Ordering {
        self.0.total_cmp(&other.0)
    }
}
