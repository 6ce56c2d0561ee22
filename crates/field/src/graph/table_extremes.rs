//! Finds the least and the greatest number in any rectangle of a table without visiting every entry. A segment tree
//! over the columns has a segment tree over the rows in each node. A search visits at most 4 log2(rows) log2(columns)
//! nodes. Building a tree of cells asks for rectangles of thousands of entries, thousands of times per frame. In the
//! scene terrain, visiting every entry took 15 % of the time to build the tree.

use super::interval::Interval;

#[derive(Debug, Default)]
pub(super) struct TableExtremes {
    columns: usize,
    rows: usize,
    /// A node is at `column * 2 * rows + row`. Both indices are those of a segment tree: the root is 1, and the leaves
    /// begin at the number of entries. A column's nodes are adjacent, because consecutive cells often ask for the same
    /// column.
    nodes: Vec<(f32, f32)>,
}

const NONE: (f32, f32) = (f32::INFINITY, f32::NEG_INFINITY);

fn hull(a: (f32, f32), b: (f32, f32)) -> (f32, f32) {
    (a.0.min(b.0), a.1.max(b.1))
}

impl TableExtremes {
    /// `entries` holds the least and the greatest number of each entry, row after row.
    pub(super) fn of(entries: impl ExactSizeIterator<Item = (f32, f32)>, columns: usize) -> Self {
        let rows = entries.len().checked_div(columns).unwrap_or(0);
        let height = 2 * rows;
        let mut nodes = vec![NONE; 2 * columns * height];
        let leaves = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
        for ((row, column), (low, high)) in leaves.zip(entries) {
            let is_known = low.is_finite() && high.is_finite();
            let node = if is_known { (low, high) } else { (f32::NEG_INFINITY, f32::INFINITY) };
            nodes[(columns + column) * height + rows + row] = node;
        }
        for column in (1..2 * columns).rev() {
            let at = column * height;
            if column < columns {
                for row in rows..height {
                    let [left, right] = [2 * column, 2 * column + 1].map(|child| nodes[child * height + row]);
                    nodes[at + row] = hull(left, right);
                }
            }
            for row in (1..rows).rev() {
                nodes[at + row] = hull(nodes[at + 2 * row], nodes[at + 2 * row + 1]);
            }
        }
        Self { columns, rows, nodes }
    }

    /// Returns the extremes in a rectangle, including both ends. [`Interval::ANY`] if an entry is not finite; `lo > hi`
    /// if the rectangle is empty.
    pub(super) fn within(&self, columns: (usize, usize), rows: (usize, usize)) -> Interval {
        let mut found = NONE;
        each_node(self.columns, columns, |column| {
            let rows_of_column = self.nodes.get(2 * self.rows * column..).unwrap_or_default();
            each_node(self.rows, rows, |row| {
                found = hull(found, rows_of_column.get(row).copied().unwrap_or(NONE));
            });
        });
        let (lo, hi) = found;
        if lo == f32::NEG_INFINITY { Interval::ANY } else { Interval { lo, hi } }
    }
}

fn each_node(count: usize, span: (usize, usize), mut visit: impl FnMut(usize)) {
    if count == 0 {
        return;
    }
    let (mut first, mut end) = (span.0 + count, span.1.min(count - 1) + 1 + count);
    while first < end {
        if first % 2 == 1 {
            visit(first);
            first += 1;
        }
        if end % 2 == 1 {
            end -= 1;
            visit(end);
        }
        first /= 2;
        end /= 2;
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn extremes_match_a_search_of_all_entries(
            columns in 1_usize..9,
            rows in 1_usize..9,
            seed in prop::collection::vec(-100.0_f32..100.0, 81),
            ends in prop::array::uniform4(0_usize..9),
            broken in prop::option::of(0_usize..81),
        ) {
            let mut values = seed[..columns * rows].to_vec();
            if let Some(value) = broken.and_then(|place| values.get_mut(place)) {
                *value = f32::NAN;
            }
            let [a, b, c, d] = ends;
            let (left, right) = (a.min(b) % columns, a.max(b).min(columns - 1));
            let (upper, lower) = (c.min(d) % rows, c.max(d).min(rows - 1));
            let extremes = TableExtremes::of(values.iter().map(|value| (*value, *value)), columns);
            let found = extremes.within((left, right), (upper, lower));
            let mut expected = Interval { lo: f32::INFINITY, hi: f32::NEG_INFINITY };
            for row in upper..=lower {
                for &value in &values[row * columns + left..=row * columns + right] {
                    expected = match value.is_finite() && !expected.is_any() {
                        true => Interval { lo: expected.lo.min(value), hi: expected.hi.max(value) },
                        false => Interval::ANY,
                    };
                }
            }
            prop_assert_eq!(found.is_any(), expected.is_any());
            prop_assert!(found.is_any() || (found.lo, found.hi) == (expected.lo, expected.hi));
        }
    }

    #[test]
    fn a_table_without_entries_has_empty_bounds() {
        for empty in [4, 0].map(|columns| TableExtremes::of([].into_iter(), columns)) {
            assert!(empty.within((0, 3), (0, 0)).lo > empty.within((0, 3), (0, 0)).hi);
        }
    }
}
