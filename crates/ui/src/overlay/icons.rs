//! Icons, drawn from lines and polygons so that they are sharp at every scale.

use egui::{Color32, Painter, Pos2, Rect, Sense, Shape, Stroke, Ui, Vec2, WidgetInfo, vec2};

use super::style;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Icon {
    Play,
    Pause,
    Previous,
    Next,
    Shuffle,
    Repeat,
    RepeatOne,
    Volume,
    Muted,
    Tracks,
    Source,
    Scenes,
    Show,
    Decks,
    Sliders,
    Settings,
    Keys,
    Fullscreen,
    Cross,
    Star,
    Folder,
    Video,
    Text,
    Plus,
    Up,
    Note,
}

pub(super) fn draw(painter: &Painter, icon: Icon, rect: Rect, size: f32, color: Color32) {
    let pen = Pen { painter, middle: rect.center(), unit: 0.5 * size, color };
    match icon {
        Icon::Play => pen.surface(&[(-0.6, -0.85), (0.85, 0.0), (-0.6, 0.85)]),
        Icon::Pause => {
            pen.block((-0.65, -0.8), (-0.18, 0.8));
            pen.block((0.18, -0.8), (0.65, 0.8));
        }
        Icon::Previous => {
            pen.block((-0.8, -0.75), (-0.52, 0.75));
            pen.surface(&[(0.8, -0.75), (0.8, 0.75), (-0.5, 0.0)]);
        }
        Icon::Next => {
            pen.block((0.52, -0.75), (0.8, 0.75));
            pen.surface(&[(-0.8, -0.75), (0.5, 0.0), (-0.8, 0.75)]);
        }
        Icon::Shuffle => {
            pen.line(&[(-0.9, 0.5), (-0.4, 0.5), (0.3, -0.5), (0.6, -0.5)]);
            pen.line(&[(-0.9, -0.5), (-0.4, -0.5), (-0.2, -0.22)]);
            pen.line(&[(0.1, 0.22), (0.3, 0.5), (0.6, 0.5)]);
            pen.surface(&[(0.55, -0.82), (0.95, -0.5), (0.55, -0.18)]);
            pen.surface(&[(0.55, 0.18), (0.95, 0.5), (0.55, 0.82)]);
        }
        Icon::Repeat | Icon::RepeatOne => {
            pen.line(&[(-0.85, 0.1), (-0.85, -0.55), (0.4, -0.55)]);
            pen.line(&[(0.85, -0.1), (0.85, 0.55), (-0.4, 0.55)]);
            pen.surface(&[(0.35, -0.9), (0.75, -0.55), (0.35, -0.2)]);
            pen.surface(&[(-0.35, 0.2), (-0.75, 0.55), (-0.35, 0.9)]);
            if icon == Icon::RepeatOne {
                pen.line(&[(-0.15, -0.1), (0.03, -0.25), (0.03, 0.28)]);
            }
        }
        Icon::Volume | Icon::Muted => {
            pen.surface(&[(-0.9, -0.3), (-0.5, -0.3), (-0.5, 0.3), (-0.9, 0.3)]);
            pen.surface(&[(-0.5, -0.3), (-0.05, -0.75), (-0.05, 0.75), (-0.5, 0.3)]);
            if icon == Icon::Muted {
                pen.line(&[(0.3, -0.35), (0.9, 0.35)]);
                pen.line(&[(0.3, 0.35), (0.9, -0.35)]);
            } else {
                pen.arc((-0.05, 0.0), 0.45);
                pen.arc((-0.05, 0.0), 0.85);
            }
        }
        Icon::Decks => {
            pen.block((-0.95, -0.75), (-0.12, 0.15));
            pen.block((0.12, -0.75), (0.95, 0.15));
            pen.line(&[(-0.95, 0.62), (0.95, 0.62)]);
            pen.block((-0.2, 0.38), (0.2, 0.86));
        }
        Icon::Text => {
            pen.line(&[(-0.4, -0.6), (-0.9, 0.0), (-0.4, 0.6)]);
            pen.line(&[(0.4, -0.6), (0.9, 0.0), (0.4, 0.6)]);
            pen.line(&[(0.15, -0.8), (-0.15, 0.8)]);
        }
        Icon::Tracks => {
            for y in [-0.6, 0.0, 0.6] {
                pen.block((-0.9, y - 0.11), (-0.66, y + 0.11));
                pen.line(&[(-0.4, y), (0.9, y)]);
            }
        }
        Icon::Source => {
            pen.rounded((-0.3, -0.9), (0.3, 0.25));
            pen.line(&[(-0.62, -0.05), (-0.5, 0.38), (0.0, 0.55), (0.5, 0.38), (0.62, -0.05)]);
            pen.line(&[(0.0, 0.55), (0.0, 0.9)]);
            pen.line(&[(-0.35, 0.9), (0.35, 0.9)]);
        }
        Icon::Scenes => {
            for (x, y) in [(-0.85, -0.75), (0.1, -0.75), (-0.85, 0.1), (0.1, 0.1)] {
                pen.frame((x, y), (x + 0.75, y + 0.65));
            }
        }
        Icon::Show => {
            pen.frame((-0.85, -0.15), (0.85, 0.8));
            pen.line(&[(-0.85, -0.45), (0.8, -0.85)]);
            for x in [-0.5, 0.0, 0.5] {
                pen.line(&[(x - 0.1, -0.15), (x + 0.15, 0.2)]);
            }
        }
        Icon::Video => {
            pen.frame((-0.95, -0.6), (0.4, 0.6));
            pen.surface(&[(0.5, 0.0), (0.95, -0.5), (0.95, 0.5)]);
        }
        Icon::Sliders => {
            for (y, knob) in [(-0.6, 0.35), (0.0, -0.4), (0.6, 0.1)] {
                pen.line(&[(-0.9, y), (0.9, y)]);
                pen.dot((knob, y), 0.24);
            }
        }
        Icon::Settings => {
            let eighth = std::f32::consts::TAU / 8.0;
            for tooth in 0..8 {
                let turn = |offset: f32, radius: f32| {
                    let angle = (tooth as f32 + offset) * eighth;
                    (radius * angle.cos(), radius * angle.sin())
                };
                pen.surface(&[turn(-0.24, 0.55), turn(-0.17, 0.95), turn(0.17, 0.95), turn(0.24, 0.55)]);
            }
            pen.ring(0.5, 0.28);
        }
        Icon::Keys => {
            pen.frame((-0.95, -0.6), (0.95, 0.6));
            for (x, y) in [(-0.6, -0.25), (-0.2, -0.25), (0.2, -0.25), (0.6, -0.25)] {
                pen.dot((x, y), 0.1);
            }
            pen.line(&[(-0.45, 0.25), (0.45, 0.25)]);
        }
        Icon::Fullscreen => {
            for (x, y) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
                let (x, y) = (0.8 * x, 0.75 * y);
                pen.line(&[(x, 0.4 * y), (x, y), (0.4 * x, y)]);
            }
        }
        Icon::Folder => {
            pen.line(&[
                (-0.85, 0.7),
                (-0.85, -0.65),
                (-0.3, -0.65),
                (-0.1, -0.4),
                (0.85, -0.4),
                (0.85, 0.7),
                (-0.95, 0.7),
            ]);
            pen.line(&[(-0.85, -0.05), (0.85, -0.05)]);
        }
        Icon::Star => {
            let tip = |turn: f32| (turn.sin(), -turn.cos());
            let fifth = std::f32::consts::TAU / 5.0;
            for point in 0..5 {
                let turn = point as f32 * fifth;
                let (a, b, c) = (tip(turn), tip(turn + 0.5 * fifth), tip(turn - 0.5 * fifth));
                let inner = |(x, y): (f32, f32)| (0.42 * x, 0.42 * y);
                pen.surface(&[(0.0, 0.0), inner(c), a, inner(b)]);
            }
        }
        Icon::Plus => {
            pen.line(&[(-0.75, 0.0), (0.75, 0.0)]);
            pen.line(&[(0.0, -0.75), (0.0, 0.75)]);
        }
        Icon::Up => {
            pen.line(&[(-0.6, -0.1), (0.0, -0.75), (0.6, -0.1)]);
            pen.line(&[(0.0, -0.75), (0.0, 0.8)]);
        }
        Icon::Note => {
            pen.line(&[(-0.35, 0.6), (-0.35, -0.75), (0.7, -0.75), (0.7, 0.4)]);
            pen.dot((-0.6, 0.6), 0.27);
            pen.dot((0.45, 0.4), 0.27);
        }
        Icon::Cross => {
            pen.line(&[(-0.55, -0.55), (0.55, 0.55)]);
            pen.line(&[(-0.55, 0.55), (0.55, -0.55)]);
        }
    }
}

/// A close button with the accessible name `words`. Returns true if it was clicked.
pub(super) fn closing_cross(ui: &Ui, place: Rect, words: &str) -> bool {
    let response = ui.interact(place, ui.scope_id().with("close"), Sense::click());
    let color = if response.hovered() { style::TEXT } else { style::DIM };
    draw(ui.painter(), Icon::Cross, place, 13.0, color);
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, words));
    response.clicked()
}

/// Draws in icon coordinates: from -1 to 1, to the right and down.
struct Pen<'a> {
    painter: &'a Painter,
    middle: Pos2,
    unit: f32,
    color: Color32,
}

impl Pen<'_> {
    fn at(&self, (x, y): (f32, f32)) -> Pos2 {
        self.middle + self.unit * vec2(x, y)
    }

    fn stroke(&self) -> Stroke {
        Stroke::new((0.2 * self.unit).max(1.0), self.color)
    }

    fn line(&self, points: &[(f32, f32)]) {
        let points = points.iter().map(|point| self.at(*point)).collect();
        self.painter.add(Shape::line(points, self.stroke()));
    }

    fn surface(&self, corners: &[(f32, f32)]) {
        let corners = corners.iter().map(|corner| self.at(*corner)).collect();
        self.painter.add(Shape::convex_polygon(corners, self.color, Stroke::NONE));
    }

    fn block(&self, least: (f32, f32), most: (f32, f32)) {
        self.painter.rect_filled(Rect::from_min_max(self.at(least), self.at(most)), 0.0, self.color);
    }

    fn frame(&self, least: (f32, f32), most: (f32, f32)) {
        let rect = Rect::from_min_max(self.at(least), self.at(most));
        self.painter.rect_stroke(rect, 0.12 * self.unit, self.stroke(), egui::StrokeKind::Inside);
    }

    fn rounded(&self, least: (f32, f32), most: (f32, f32)) {
        let rect = Rect::from_min_max(self.at(least), self.at(most));
        self.painter.rect_filled(rect, 0.3 * self.unit, self.color);
    }

    fn dot(&self, middle: (f32, f32), radius: f32) {
        self.painter.circle_filled(self.at(middle), radius * self.unit, self.color);
    }

    fn ring(&self, radius: f32, width: f32) {
        let stroke = Stroke::new(width * self.unit, self.color);
        self.painter.circle_stroke(self.middle, radius * self.unit, stroke);
    }

    fn arc(&self, middle: (f32, f32), radius: f32) {
        let points = (-4..=4).map(|step| {
            let angle = step as f32 * 0.2;
            self.at(middle) + radius * self.unit * Vec2::angled(angle)
        });
        self.painter.add(Shape::line(points.collect(), self.stroke()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_icon_stays_in_its_button() {
        let all = [
            Icon::Play,
            Icon::Pause,
            Icon::Previous,
            Icon::Next,
            Icon::Shuffle,
            Icon::Repeat,
            Icon::RepeatOne,
            Icon::Volume,
            Icon::Muted,
            Icon::Tracks,
            Icon::Source,
            Icon::Scenes,
            Icon::Sliders,
            Icon::Settings,
            Icon::Keys,
            Icon::Fullscreen,
            Icon::Cross,
            Icon::Star,
            Icon::Folder,
            Icon::Plus,
            Icon::Up,
            Icon::Note,
            Icon::Video,
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
