//! Icons, drawn from lines and polygons so that they are sharp at every scale.

use std::f32::consts::TAU;

use egui::emath::Rot2;
use egui::{Color32, Painter, Pos2, Rect, Sense, Shape, Stroke, StrokeKind, Ui, Vec2, WidgetInfo, vec2};

use super::style;

/// The shapes, each a word and the points that it is drawn through, from -1 to 1 to the right and down. The last number
/// of a dot, an arc or a ring is its radius. Fifths and eighths are repeated around the middle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Icon(&'static str);

impl Icon {
    pub(super) const PLAY: Self = Self("fill -.6 -.85 .85 0 -.6 .85");
    pub(super) const PAUSE: Self = Self("block -.65 -.8 -.18 .8; block .18 -.8 .65 .8");
    pub(super) const PREVIOUS: Self = Self("block -.8 -.75 -.52 .75; fill .8 -.75 .8 .75 -.5 0");
    pub(super) const NEXT: Self = Self("block .52 -.75 .8 .75; fill -.8 -.75 .5 0 -.8 .75");
    pub(super) const SHUFFLE: Self = Self(
        "line -.9 .5 -.4 .5 .3 -.5 .6 -.5; line -.9 -.5 -.4 -.5 -.2 -.22; line .1 .22 .3 .5 .6 .5; \
         fill .55 -.82 .95 -.5 .55 -.18; fill .55 .18 .95 .5 .55 .82",
    );
    pub(super) const REPEAT: Self = Self(
        "line -.85 .1 -.85 -.55 .4 -.55; line .85 -.1 .85 .55 -.4 .55; \
         fill .35 -.9 .75 -.55 .35 -.2; fill -.35 .2 -.75 .55 -.35 .9",
    );
    pub(super) const REPEAT_ONE: Self = Self(
        "line -.85 .1 -.85 -.55 .4 -.55; line .85 -.1 .85 .55 -.4 .55; \
         fill .35 -.9 .75 -.55 .35 -.2; fill -.35 .2 -.75 .55 -.35 .9; line -.15 -.1 .03 -.25 .03 .28",
    );
    pub(super) const VOLUME: Self = Self(
        "fill -.9 -.3 -.5 -.3 -.5 .3 -.9 .3; fill -.5 -.3 -.05 -.75 -.05 .75 -.5 .3; \
         arc -.05 0 .45; arc -.05 0 .85",
    );
    pub(super) const MUTED: Self = Self(
        "fill -.9 -.3 -.5 -.3 -.5 .3 -.9 .3; fill -.5 -.3 -.05 -.75 -.05 .75 -.5 .3; \
         line .3 -.35 .9 .35; line .3 .35 .9 -.35",
    );
    pub(super) const DECKS: Self =
        Self("block -.95 -.75 -.12 .15; block .12 -.75 .95 .15; line -.95 .62 .95 .62; block -.2 .38 .2 .86");
    pub(super) const TEXT: Self =
        Self("line -.4 -.6 -.9 0 -.4 .6; line .4 -.6 .9 0 .4 .6; line .15 -.8 -.15 .8");
    pub(super) const TRACKS: Self = Self(
        "block -.9 -.71 -.66 -.49; line -.4 -.6 .9 -.6; block -.9 -.11 -.66 .11; line -.4 0 .9 0; \
         block -.9 .49 -.66 .71; line -.4 .6 .9 .6",
    );
    pub(super) const SOURCE: Self = Self(
        "capsule -.3 -.9 .3 .25; line -.62 -.05 -.5 .38 0 .55 .5 .38 .62 -.05; line 0 .55 0 .9; \
         line -.35 .9 .35 .9",
    );
    pub(super) const SCENES: Self =
        Self("frame -.85 -.75 -.1 -.1; frame .1 -.75 .85 -.1; frame -.85 .1 -.1 .75; frame .1 .1 .85 .75");
    pub(super) const SHOW: Self = Self(
        "frame -.85 -.15 .85 .8; line -.85 -.45 .8 -.85; \
         line -.6 -.15 -.35 .2; line -.1 -.15 .15 .2; line .4 -.15 .65 .2",
    );
    pub(super) const VIDEO: Self = Self("frame -.95 -.6 .4 .6; fill .5 0 .95 -.5 .95 .5");
    pub(super) const SLIDERS: Self = Self(
        "line -.9 -.6 .9 -.6; dot .35 -.6 .24; line -.9 0 .9 0; dot -.4 0 .24; line -.9 .6 .9 .6; \
         dot .1 .6 .24",
    );
    pub(super) const SETTINGS: Self = Self("eighths .54 -.103 .942 -.126 .942 .126 .54 .103; ring 0 0 .5");
    pub(super) const KEYS: Self = Self(
        "frame -.95 -.6 .95 .6; dot -.6 -.25 .1; dot -.2 -.25 .1; dot .2 -.25 .1; dot .6 -.25 .1; \
         line -.45 .25 .45 .25",
    );
    pub(super) const FULLSCREEN: Self = Self(
        "line -.8 -.3 -.8 -.75 -.32 -.75; line .8 -.3 .8 -.75 .32 -.75; line .8 .3 .8 .75 .32 .75; \
         line -.8 .3 -.8 .75 -.32 .75",
    );
    pub(super) const FOLDER: Self =
        Self("line -.85 .7 -.85 -.65 -.3 -.65 -.1 -.4 .85 -.4 .85 .7 -.95 .7; line -.85 -.05 .85 -.05");
    pub(super) const STAR: Self = Self("fifths 0 0 -.247 -.34 0 -1 .247 -.34");
    pub(super) const PLUS: Self = Self("line -.75 0 .75 0; line 0 -.75 0 .75");
    pub(super) const UP: Self = Self("line -.6 -.1 0 -.75 .6 -.1; line 0 -.75 0 .8");
    pub(super) const NOTE: Self =
        Self("line -.35 .6 -.35 -.75 .7 -.75 .7 .4; dot -.6 .6 .27; dot .45 .4 .27");
    pub(super) const CROSS: Self = Self("line -.55 -.55 .55 .55; line -.55 .55 .55 -.55");
}

pub(super) fn draw(painter: &Painter, icon: Icon, rect: Rect, size: f32, color: Color32) {
    let (middle, unit) = (rect.center(), 0.5 * size);
    let stroke = Stroke::new((0.2 * unit).max(1.0), color);
    for shape in icon.0.split("; ") {
        let (kind, numbers) = shape.split_once(' ').unwrap_or_default();
        let numbers: Vec<f32> = numbers.split(' ').filter_map(|number| number.parse().ok()).collect();
        let (points, last) = numbers.as_chunks::<2>();
        let points: Vec<Pos2> = points.iter().map(|[x, y]| middle + unit * vec2(*x, *y)).collect();
        let (whole, radius) = (Rect::from_points(&points), unit * last.iter().sum::<f32>());
        let polygon = |points| Shape::convex_polygon(points, color, Stroke::NONE);
        let repeated = |count: usize| {
            let turn = |index| Rot2::from_angle(TAU * index as f32 / count as f32);
            let turned = |turn: Rot2| points.iter().map(|point| middle + turn * (*point - middle)).collect();
            (0..count).map(|index| polygon(turned(turn(index)))).collect::<Vec<_>>().into()
        };
        painter.add(match kind {
            "fill" => polygon(points),
            "fifths" => repeated(5),
            "eighths" => repeated(8),
            "block" => Shape::rect_filled(whole, 0.0, color),
            "capsule" => Shape::rect_filled(whole, 0.3 * unit, color),
            "frame" => Shape::rect_stroke(whole, 0.12 * unit, stroke, StrokeKind::Inside),
            "dot" => Shape::circle_filled(whole.center(), radius, color),
            "ring" => Shape::circle_stroke(whole.center(), radius, Stroke::new(0.28 * unit, color)),
            "arc" => {
                let at = |step: i32| whole.center() + radius * Vec2::angled(step as f32 * 0.2);
                Shape::line((-4..=4).map(at).collect(), stroke)
            }
            _ => Shape::line(points, stroke),
        });
    }
}

/// A close button with the accessible name `words`. Returns true if it was clicked.
pub(super) fn closing_cross(ui: &Ui, place: Rect, words: &str) -> bool {
    let response = ui.interact(place, ui.scope_id().with("close"), Sense::click());
    let color = if response.hovered() { style::TEXT } else { style::DIM };
    draw(ui.painter(), Icon::CROSS, place, 13.0, color);
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, words));
    response.clicked()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_icon_stays_in_its_button() {
        let all = [
            Icon::PLAY,
            Icon::PAUSE,
            Icon::PREVIOUS,
            Icon::NEXT,
            Icon::SHUFFLE,
            Icon::REPEAT,
            Icon::REPEAT_ONE,
            Icon::VOLUME,
            Icon::MUTED,
            Icon::TRACKS,
            Icon::SOURCE,
            Icon::SCENES,
            Icon::SLIDERS,
            Icon::SETTINGS,
            Icon::KEYS,
            Icon::FULLSCREEN,
            Icon::CROSS,
            Icon::STAR,
            Icon::FOLDER,
            Icon::PLUS,
            Icon::UP,
            Icon::NOTE,
            Icon::VIDEO,
        ];
        for icon in all {
            let context = egui::Context::default();
            let rect = Rect::from_min_size(Pos2::new(50.0, 50.0), Vec2::splat(30.0));
            let mut output = context.run_pass(egui::RawInput::default(), |context| {
                let painter = context.layer_painter(egui::LayerId::background());
                draw(&painter, icon, rect, 16.0, Color32::WHITE);
            });
            output.textures_delta.clear();
            let drawn = output
                .shapes
                .iter()
                .fold(Rect::NOTHING, |all, clipped| all | clipped.shape.visual_bounding_rect());
            assert!(rect.shrink(4.0).contains_rect(drawn), "{icon:?}: {drawn:?}");
            assert!(drawn.width() > 7.0 && drawn.height() > 7.0, "{icon:?}: {drawn:?}");
        }
    }
}
