//! The style: one set of colours, sizes and shapes for all panels. Backgrounds are dark and mostly opaque, so that
//! light text is readable over bright and dark frames.

use std::sync::Arc;

use egui::epaint::RectShape;
use egui::layers::ShapeIdx;
use egui::text::{LayoutJob, TextWrapping};
use egui::{
    Align, Color32, CornerRadius, FontId, Galley, Id, Order, Painter, Pos2, Rect, Stroke, StrokeKind, Ui,
    Vec2, vec2,
};

use mariana_render::reading_order::as_seen;

pub(super) const TEXT: Color32 = Color32::from_rgb(232, 234, 238);
pub(super) const DIM: Color32 = Color32::from_rgb(178, 184, 194);
/// Colour of the part of a track that has not been played, and of other shapes. Too dark for text.
pub(super) const AHEAD: Color32 = Color32::from_rgb(92, 98, 110);
pub(super) const BUTTON: Color32 = Color32::from_rgb(196, 200, 208);
pub(super) const ERROR: Color32 = Color32::from_rgb(255, 146, 130);
/// Colour of hints and chosen values.
pub(super) const ACCENT: Color32 = Color32::from_rgb(130, 204, 232);
/// Colour of text on a background of [`ACCENT`].
pub(super) const ON_ACCENT: Color32 = Color32::from_rgb(8, 10, 13);
pub(super) const RAIL: Color32 = Color32::from_rgba_premultiplied(38, 38, 38, 38);

pub(super) const GROUND: Color32 = Color32::from_rgba_premultiplied(8, 10, 13, 236);
const EDGE: Color32 = Color32::from_rgba_premultiplied(20, 20, 20, 20);
const CORNERS: CornerRadius = CornerRadius::same(7);

/// Distance of panels from the window's edge and from each other, in points.
pub(super) const MARGIN: f32 = 14.0;
pub(super) const PADDING: Vec2 = Vec2::new(14.0, 11.0);
/// Width of the lane for a scroll bar.
pub(super) const LANE: f32 = 10.0;
pub(super) const TEXT_SIZE: f32 = 14.0;
pub(super) const SMALL_SIZE: f32 = 12.5;
pub(super) const HEADING_SIZE: f32 = 15.5;
/// Minimum text size in small windows, in the window system's points. Only the table of keys and a problem use
/// smaller text.
const SMALLEST: f32 = 9.0;

pub(super) fn proportional(size: f32) -> FontId {
    FontId::proportional(size)
}

pub(super) fn monospace(size: f32) -> FontId {
    FontId::monospace(size)
}

/// One line of text. Text beyond `width` points is replaced by an ellipsis.
pub(super) fn line(painter: &Painter, text: &str, size: f32, color: Color32, width: f32) -> Arc<Galley> {
    line_in(painter, text, proportional(size), color, width)
}

/// Like [`line`], in a font.
pub(super) fn line_in(
    painter: &Painter,
    text: &str,
    font: FontId,
    color: Color32,
    width: f32,
) -> Arc<Galley> {
    let mut job = LayoutJob::simple_singleline(as_seen(text).into_owned(), font, color);
    job.wrap = TextWrapping::truncate_at_width(width.max(1.0));
    painter.layout_job(job)
}

/// Text in at most `rows` lines of `width` points. Text beyond the last line is replaced by an ellipsis.
pub(super) fn paragraph(
    painter: &Painter,
    text: &str,
    size: f32,
    color: Color32,
    width: f32,
    rows: usize,
    halign: Align,
) -> Arc<Galley> {
    let mut job = LayoutJob::simple(as_seen(text).into_owned(), proportional(size), color, width.max(1.0));
    (job.wrap.max_rows, job.halign) = (rows, halign);
    painter.layout_job(job)
}

/// The size of a letter's cell: the width of the digits, and the distance between lines that are `height` font lines
/// apart.
pub(super) fn cell(painter: &Painter, size: f32, height: f32) -> Vec2 {
    let font = monospace(size);
    painter.fonts_mut(|fonts| vec2(fonts.glyph_width(&font, '0'), (height * fonts.row_height(&font)).round()))
}

pub(super) fn ground(painter: &Painter, rect: Rect) {
    painter.add(ground_of(rect));
}

pub(super) fn ground_of(rect: Rect) -> RectShape {
    RectShape::new(rect, CORNERS, GROUND, Stroke::new(1.0, EDGE), StrokeKind::Inside)
}

/// A panel area that egui lays out, with a fixed position and without a fade.
pub(super) fn area(id: egui::Id, order: egui::Order) -> egui::Area {
    egui::Area::new(id).kind(egui::UiKind::Window).order(order).constrain(false).fade_in(false)
}

/// Shows a panel at the top left of `place`, with the width and at most the height of `place`. Returns its area.
pub(super) fn panel(
    context: &egui::Context,
    id: &str,
    order: Order,
    place: Rect,
    content: impl FnOnce(&mut Ui),
) -> Rect {
    framed(context, area(Id::unique(id), order), frame(), place, content)
}

/// Shows a panel in this area and frame, as [`panel`] does.
pub(super) fn framed(
    context: &egui::Context,
    area: egui::Area,
    frame: egui::Frame,
    place: Rect,
    content: impl FnOnce(&mut Ui),
) -> Rect {
    let shown = area.fixed_pos(place.min).show(context, |ui| {
        frame.show(ui, |ui| {
            // A window of a few pixels leaves no width.
            let inner = (place.size() - 2.0 * PADDING).max(Vec2::ZERO);
            ui.set_width(inner.x);
            // Without this, egui limits the height of a new panel, and a panel keeps the height of its last layout.
            ui.set_max_height(inner.y);
            content(ui);
        });
    });
    shown.response.rect
}

/// Shows a panel in the middle of the lower edge of `space`. A panel that is not seen exists for screen readers only.
/// Returns its area.
pub(super) fn strip(
    context: &egui::Context,
    id: Id,
    space: Rect,
    width_max: f32,
    is_seen: bool,
    content: impl FnOnce(&mut Ui),
) -> Rect {
    let area = area(id, Order::Middle).pivot(egui::Align2::CENTER_BOTTOM).fixed_pos(space.center_bottom());
    let shown = area.show(context, |ui| {
        if !is_seen {
            ui.set_opacity(0.0);
        }
        frame().show(ui, |ui| {
            ui.set_width((space.width().min(width_max) - 2.0 * PADDING.x).max(0.0));
            content(ui);
        });
    });
    shown.response.rect
}

/// The middle of `space`, at most `width_max` points wide.
pub(super) fn middle(space: Rect, width_max: f32) -> Rect {
    Rect::from_center_size(space.center(), vec2(space.width().min(width_max), space.height()))
}

/// The right part of `space`, at most `width_max` points wide.
pub(super) fn right_part(space: Rect, width_max: f32) -> Rect {
    space.with_min_x(space.right() - space.width().min(width_max))
}

/// Draws a line of text from the middle of its left edge. Returns the x of its right edge.
pub(super) fn put(painter: &Painter, left: Pos2, text: &str, size: f32, color: Color32, width: f32) -> f32 {
    let galley = line(painter, text, size, color, width);
    let end = left.x + galley.size().x;
    painter.galley(left - vec2(0.0, 0.5 * galley.size().y), galley, color);
    end
}

/// Draws a line of text up to the middle of its right edge. Returns the x of its left edge.
pub(super) fn put_right(
    painter: &Painter,
    right: Pos2,
    text: &str,
    size: f32,
    color: Color32,
    width: f32,
) -> f32 {
    let galley = line(painter, text, size, color, width);
    let left = right.x - galley.size().x;
    painter.galley(right - vec2(galley.size().x, 0.5 * galley.size().y), galley, color);
    left
}

/// Lights the row that was drawn above the shape `ground`, up to the right edge.
pub(super) fn light_behind(ui: &Ui, ground: ShapeIdx, row: Rect, is_lit: bool) {
    if is_lit {
        let row = row.with_max_x(ui.max_rect().right());
        ui.painter().set(ground, RectShape::filled(row, 4.0, RAIL));
    }
}

/// Lights the ground of a selected or pointed row.
pub(super) fn light(painter: &Painter, rect: Rect, is_lit: bool) {
    if is_lit {
        painter.rect_filled(rect, 4.0, RAIL);
    }
}

/// The colour of a control: accented while it is on, and brighter than `plain` under the pointer.
pub(super) fn lit(is_on: bool, is_pointed: bool, plain: Color32) -> Color32 {
    match (is_on, is_pointed) {
        (true, _) => ACCENT,
        (false, true) => TEXT,
        (false, false) => plain,
    }
}

/// Draws a rail that is filled up to a fraction, 0..1.
pub(super) fn fraction(painter: &Painter, rail: Rect, fraction: f32) {
    let radius = 0.5 * rail.height();
    painter.rect_filled(rail, radius, RAIL);
    let filled = vec2(fraction.clamp(0.0, 1.0) * rail.width(), rail.height());
    painter.rect_filled(Rect::from_min_size(rail.min, filled), radius, ACCENT);
}

/// Draws the caret of a search.
pub(super) fn caret(painter: &Painter, top: Pos2) {
    painter.vline(top.x, top.y..=top.y + HEADING_SIZE * 1.2, Stroke::new(1.5, ACCENT));
}

pub(super) fn scrolled_to(row: usize, row_height: f32, height: f32) -> f32 {
    (row as f32 * row_height - 0.5 * (height - row_height)).max(0.0)
}

/// Shows rows with a scroll bar, in at most `height` points; with `to_top`, scrolled to the first row.
pub(super) fn scrolled<R>(ui: &mut Ui, height: f32, to_top: bool, rows: impl FnOnce(&mut Ui) -> R) -> R {
    let mut area = egui::ScrollArea::vertical().max_height(height).auto_shrink([false, true]).animated(false);
    if to_top {
        area = area.vertical_scroll_offset(0.0);
    }
    let shown = area.show(ui, |ui| {
        ui.set_width((ui.available_width() - LANE).max(0.0));
        rows(ui)
    });
    shown.inner
}

pub(super) fn frame() -> egui::Frame {
    egui::Frame::new()
        .fill(GROUND)
        .stroke(Stroke::new(1.0, EDGE))
        .corner_radius(CORNERS)
        .inner_margin(egui::Margin::symmetric(PADDING.x as i8, PADDING.y as i8))
}

pub(super) fn apply(context: &egui::Context) {
    context.set_theme(egui::Theme::Dark);
    context.all_styles_mut(|style| {
        style.animation_time = 0.0;
        style.interaction.selectable_labels = false;
        style.spacing.item_spacing = Vec2::new(8.0, 4.0);
        style.visuals.override_text_color = Some(TEXT);
    });
}

/// Returns the zoom of panels: below 1 in small windows, and above 1 in windows of more than 1920x1080 points, which
/// are seen from further away than small windows.
pub(super) fn zoom(size: Vec2) -> f32 {
    let shrunk = (size.x / 560.0).min(size.y / 360.0).clamp(SMALLEST / SMALL_SIZE, 1.0);
    let grown = (size.x / 1920.0).min(size.y / 1080.0).clamp(1.0, 2.0);
    shrunk * grown
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Minimum contrast of text (WCAG 1.4.3).
    const CONTRAST_MIN: f32 = 4.5;

    fn over(above: Color32, below: [f32; 3]) -> [f32; 3] {
        let [red, green, blue, alpha] = above.to_array().map(f32::from);
        let left = 1.0 - alpha / 255.0;
        [red + below[0] * left, green + below[1] * left, blue + below[2] * left]
    }

    /// Relative luminance of an sRGB colour with channels of 0..255, as WCAG 2 defines it.
    fn luminance(color: [f32; 3]) -> f32 {
        let linear = |channel: f32| {
            let value = channel / 255.0;
            if value <= 0.040_45 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
        };
        let [red, green, blue] = color.map(linear);
        0.2126 * red + 0.7152 * green + 0.0722 * blue
    }

    fn contrast(text: Color32, grounds: &[Color32], picture: f32) -> f32 {
        let below = grounds.iter().fold([picture; 3], |below, ground| over(*ground, below));
        let (text, below) = (luminance(over(text, below)), luminance(below));
        (text.max(below) + 0.05) / (text.min(below) + 0.05)
    }

    /// Asserts that texts of these colours are legible over these layers, over any frame.
    pub(in crate::overlay) fn assert_legible(texts: &[Color32], grounds: &[Color32]) {
        for text in texts {
            for picture in [0.0, 255.0] {
                let contrast = contrast(*text, grounds, picture);
                assert!(
                    contrast >= CONTRAST_MIN,
                    "{text:?} over {grounds:?} over {picture}: contrast {contrast:.2}"
                );
            }
        }
    }

    #[test]
    fn text_has_enough_contrast_over_any_frame() {
        let texts = [TEXT, DIM, BUTTON, ERROR, ACCENT];
        assert_legible(&texts, &[GROUND]);
        // A selected row, a chip or a key.
        assert_legible(&texts, &[GROUND, RAIL]);
        assert_legible(&[ON_ACCENT], &[GROUND, ACCENT]);
        assert_legible(&[TEXT], &[GROUND, AHEAD]);
        let black_on_white = contrast(Color32::BLACK, &[Color32::WHITE], 0.0);
        assert!((black_on_white - 21.0).abs() < 0.01, "{black_on_white}");
    }
}
