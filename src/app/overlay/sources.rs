//! The list of what can be listened to.

use egui::{Painter, Rect, pos2, vec2};

use super::content::SourceList;
use super::style;

/// Distance of two rows, in sizes of the text.
const ROW: f32 = 1.6;
/// Widest row, as a share of the window's width.
const WIDTH_MAX: f32 = 0.6;

/// Draws the panel at the upper left of `space`, below the sentences at the top: the rows that fit around the present
/// source.
pub(super) fn draw(painter: &Painter, space: Rect, list: &SourceList) {
    let row_height = ROW * style::TEXT_SIZE;
    let room = ((space.height() - 2.0 * style::PADDING.y) / row_height).floor().max(2.0) as usize - 1;
    let first = list.present.unwrap_or(0).saturating_sub(room / 2).min(list.names.len().saturating_sub(room));
    let width = WIDTH_MAX * space.width();
    let line =
        |text: &str, color| style::line(painter, text, style::proportional(style::TEXT_SIZE), color, width);
    let mut rows = vec![line("D: listen to", style::DIM)];
    for (index, name) in list.names.iter().enumerate().skip(first).take(room) {
        let (mark, color) =
            if list.present == Some(index) { (">", style::ACCENT) } else { ("·", style::TEXT) };
        rows.push(line(&format!("{mark} {name}"), color));
    }
    let widest = rows.iter().map(|row| row.size().x).fold(0.0, f32::max);
    let size = vec2(widest, row_height * rows.len() as f32) + 2.0 * style::PADDING;
    let rect = Rect::from_min_size(space.min, size);
    style::ground(painter, rect);
    for (row, galley) in rows.into_iter().enumerate() {
        let top = rect.top() + style::PADDING.y + row as f32 * row_height;
        painter.galley(pos2(rect.left() + style::PADDING.x, top), galley, style::TEXT);
    }
}
