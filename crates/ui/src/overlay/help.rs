//! The table of keys.

use std::sync::Arc;

use egui::{CornerRadius, Galley, Painter, Rect, vec2};

use super::style;
use mariana_commands::{Binding, bindings};

/// Minimum text size in points, for windows that are too small for the table.
const SIZE_MIN: f32 = 6.0;
const COLUMNS_MAX: usize = 2;
/// Distance between columns, in ems.
const COLUMN_GAP: f32 = 2.0;

struct Row {
    caps: Vec<Arc<Galley>>,
    meaning: Arc<Galley>,
}

/// The table at one text size. Lengths are in points.
struct Table {
    rows: Vec<Row>,
    columns: usize,
    row_height: f32,
    caps_width: f32,
    meaning_width: f32,
    heading: Arc<Galley>,
    em: f32,
}

pub(super) fn draw(painter: &Painter, space: Rect) -> Rect {
    let room = space.size() - 2.0 * style::PADDING;
    // Choose the number of columns that allows the largest text.
    let shrink_of = |table: &Table| (room / table.size()).min_elem().min(1.0);
    let tables = (1..=COLUMNS_MAX).map(|columns| Table::new(painter, style::TEXT_SIZE, columns));
    let Some(mut table) = tables.max_by(|a, b| {
        // If two layouts allow the same text size, prefer fewer columns.
        shrink_of(a).total_cmp(&shrink_of(b)).then(b.columns.cmp(&a.columns))
    }) else {
        return Rect::NOTHING;
    };
    let shrink = shrink_of(&table);
    if shrink < 1.0 {
        table = Table::new(painter, (style::TEXT_SIZE * shrink).max(SIZE_MIN), table.columns);
    }
    let rect = Rect::from_center_size(space.center(), table.size() + 2.0 * style::PADDING);
    // Where even the smallest text has no room, show the first keys.
    let rect = rect.translate(vec2(0.0, (space.top() - rect.top()).max(0.0)));
    style::ground(painter, rect);
    table.draw(painter, rect.shrink2(style::PADDING));
    rect
}

impl Table {
    fn new(painter: &Painter, em: f32, columns: usize) -> Self {
        let text =
            |text: &str, color| painter.layout_no_wrap(text.to_owned(), style::proportional(em), color);
        let rows: Vec<Row> = bindings()
            .map(|binding| Row {
                caps: caps(binding).map(|cap| text(cap, style::TEXT)).collect(),
                meaning: text(binding.help, style::TEXT),
            })
            .collect();
        let caps_width = |row: &Row| row.caps.iter().map(|cap| cap.size().x + em * 1.4).sum::<f32>();
        Self {
            row_height: (1.75 * em).floor(),
            caps_width: rows.iter().map(caps_width).fold(0.0, f32::max),
            meaning_width: rows.iter().map(|row| row.meaning.size().x).fold(0.0, f32::max),
            heading: text("Keys", style::DIM),
            rows,
            columns,
            em,
        }
    }

    fn size(&self) -> egui::Vec2 {
        let height = self.row_height * (self.rows_in_column() + 1) as f32;
        vec2(self.column_width() * self.columns as f32 - COLUMN_GAP * self.em, height)
    }

    fn rows_in_column(&self) -> usize {
        self.rows.len().div_ceil(self.columns.max(1))
    }

    /// Width of a column, including the gap to the next column.
    fn column_width(&self) -> f32 {
        self.caps_width + self.em + self.meaning_width + COLUMN_GAP * self.em
    }

    fn draw(&self, painter: &Painter, rect: Rect) {
        painter.galley(rect.min, self.heading.clone(), style::DIM);
        for (index, row) in self.rows.iter().enumerate() {
            let (column, line) = (index / self.rows_in_column(), index % self.rows_in_column());
            let middle = rect.top() + self.row_height * (line as f32 + 1.5);
            let start = rect.left() + column as f32 * self.column_width();
            let mut left = start;
            for cap in &row.caps {
                let size = vec2(cap.size().x + 0.9 * self.em, 1.4 * self.em);
                let place = Rect::from_min_size(egui::pos2(left, middle - 0.5 * size.y), size);
                painter.rect_filled(place, CornerRadius::same((0.3 * self.em) as u8), style::RAIL);
                painter.galley(place.center() - 0.5 * cap.size(), cap.clone(), style::TEXT);
                left += size.x + 0.5 * self.em;
            }
            let at = egui::pos2(start + self.caps_width + self.em, middle - 0.5 * row.meaning.size().y);
            painter.galley(at, row.meaning.clone(), style::TEXT);
        }
    }
}

/// The single keys of a binding: "F, F11 or double click" has three.
fn caps(binding: &Binding) -> impl Iterator<Item = &'static str> {
    binding.written.split(", ").flat_map(|part| part.split(" or "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_of_a_binding_has_a_keycap() {
        let full_screen = bindings().find(|binding| binding.written.contains("F11")).unwrap();
        assert_eq!(caps(full_screen).collect::<Vec<_>>(), ["F", "F11", "double click"]);
        for binding in bindings() {
            // Every named key has a keycap. Media keys have no names.
            assert!(caps(binding).count() <= binding.keys.len() + 1, "{}", binding.written);
        }
    }
}
