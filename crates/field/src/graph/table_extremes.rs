//! The least and the greatest entry of any rectangle of a table, without looking at each entry.
//!
//! Bounds of a whole tree of cells ask for rectangles of thousands of entries, thousands of times for each frame. A
//! segment tree over the rows, whose nodes are segment trees over the columns, answers from at most four times
//! log2(rows) times log2(columns) nodes, exactly.

use std::sync::{Arc, OnceLock};

use super::interval::Interval;

/// The extremes of a table, found when they are asked for first. Tables with equal entries are equal, whether they are
/// known or not.
#[derive(Debug, Clone, Default)]
pub(super) struct SharedExtremes(Arc<OnceLock<TableExtremes>>);

impl SharedExtremes {
    /// Those of this table.
    pub(super) fn of(&self, values: &[f32], columns: usize) -> &TableExtremes {
        self.0.get_or_init(|| TableExtremes::of(values, columns))
    }
}

impl PartialEq for SharedExtremes {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

/// Segment trees over a table's rows and columns.
#[derive(Debug, Default)]
pub(super) struct TableExtremes {
    columns: usize,
    rows: usize,
    /// Node `row * 2 * columns + column`: both indices count as in a segment tree, whose root is 1 and whose leaves
    /// begin at the number of entries. An entry that is not finite has no bounds.
    nodes: Vec<(f32, f32)>,
}

/// The bounds of nothing.
const NONE: (f32, f32) = (f32::INFINITY, f32::NEG_INFINITY);

fn hull(a: (f32, f32), b: (f32, f32)) -> (f32, f32) {
    (a.0.min(b.0), a.1.max(b.1))
}

impl TableExtremes {
    /// Those of a table of rows with `columns` entries each.
    pub(super) fn of(values: &[f32], columns: usize) -> Self {
        let rows = values.len().checked_div(columns).unwrap_or(0);
        let width = 2 * columns;
        let mut nodes = vec![NONE; 2 * rows * width];
        for (row, entries) in values.chunks_exact(columns.max(1)).enumerate() {
            let place = (rows + row) * width + columns;
            for (node, value) in nodes.iter_mut().skip(place).zip(entries) {
                *node = if value.is_finite() { (*value, *value) } else { (f32::NEG_INFINITY, f32::INFINITY) };
            }
        }
        for row in (1..2 * rows).rev() {
            if row < rows {
                for column in columns..width {
                    let [upper, lower] = [2 * row, 2 * row + 1].map(|child| nodes[child * width + column]);
                    nodes[row * width + column] = hull(upper, lower);
                }
            }
            let at = row * width;
            for column in (1..columns).rev() {
                nodes[at + column] = hull(nodes[at + 2 * column], nodes[at + 2 * column + 1]);
            }
        }
        Self { columns, rows, nodes }
    }

    /// The extremes in these columns and rows, the ends included; [`Interval::ANY`] if an entry there is not finite. An
    /// empty rectangle has the bounds of nothing.
    pub(super) fn within(&self, columns: (usize, usize), rows: (usize, usize)) -> Interval {
        let mut found = NONE;
        each_node(self.rows, rows, |row| {
            each_node(self.columns, columns, |column| {
                found = hull(found, self.nodes[row * 2 * self.columns + column]);
            });
        });
        let (lo, hi) = found;
        if lo == f32::NEG_INFINITY { Interval::ANY } else { Interval { lo, hi } }
    }
}

/// The nodes of a segment tree over `count` entries that make up the range, its ends included.
fn each_node(count: usize, (first, last): (usize, usize), mut visit: impl FnMut(usize)) {
    if count == 0 {
        return;
    }
    let (mut first, mut end) = (first + count, last.min(count - 1) + 1 + count);
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
        fn extremes_are_those_of_the_entries(
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
            let found = TableExtremes::of(&values, columns).within((left, right), (upper, lower));
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
    fn a_table_without_entries_has_none() {
        for empty in [TableExtremes::of(&[], 4), TableExtremes::of(&[], 0)] {
            assert!(empty.within((0, 3), (0, 0)).lo > empty.within((0, 3), (0, 0)).hi);
        }
    }
}
