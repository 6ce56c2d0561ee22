//! The welcome text of a new window: the track, the scene, and a few keys to start with.

use std::sync::Arc;
use std::time::{Duration, Instant};

use egui::{Galley, Painter, Rect, Vec2, pos2, vec2};

use super::picture::{Cover, draw_cover};
use super::style;
use mariana_commands::{Command, Switch};

const STANDS: Duration = Duration::from_secs(6);
const FADES: Duration = Duration::from_millis(700);
const NAMED: [Command; 3] = [Command::ToggleHelp, Command::NextScene, Command::Fullscreen(Switch::Toggle)];
/// Maximum width of a line, as a fraction of the window's width.
const WIDTH_MAX: f32 = 0.9;
/// Side of the cover in points, if the window is wide enough.
const COVER: f32 = 112.0;

/// The content of the welcome text.
#[derive(Debug, Clone, Copy, Hash)]
pub struct Welcome<'a> {
    /// The track's title, or the input's name.
    pub title: &'a str,
    /// The track's artist.
    pub artist: Option<&'a str>,
    /// The cover of the track, if it has one.
    pub cover: Option<Cover<'a>>,
    /// The shown scene, such as "speakers, 12 of 17".
    pub scene: &'a str,
    /// The time at which the text appeared.
    pub since: Instant,
}

impl Welcome<'_> {
    fn opacity(&self, now: Instant) -> f32 {
        let fading = now.saturating_duration_since(self.since).saturating_sub(STANDS);
        1.0 - (fading.as_secs_f32() / FADES.as_secs_f32()).min(1.0)
    }

    /// The next time at which the text looks different; `None` once the text is gone.
    pub(super) fn next_change(&self, now: Instant) -> Option<Instant> {
        (self.opacity(now) > 0.0).then(|| now.max(self.since + STANDS))
    }

    pub(super) fn is_gone(&self, now: Instant) -> bool {
        self.opacity(now) <= 0.0
    }
}

pub(super) fn draw(painter: &Painter, space: Rect, welcome: &Welcome<'_>, now: Instant) {
    let mut painter = painter.clone();
    painter.set_opacity(welcome.opacity(now));
    let cover = welcome.cover.map_or(0.0, |_| COVER.min(0.25 * space.width()) + style::PADDING.x);
    let width = WIDTH_MAX * space.width() - 2.0 * style::PADDING.x - cover;
    let line = |text: &str, size: f32, color| style::line(&painter, text, size, color, width);
    let mut lines = vec![line(welcome.title, 1.6 * style::TEXT_SIZE, style::TEXT)];
    lines.extend(welcome.artist.map(|artist| line(artist, style::HEADING_SIZE, style::TEXT)));
    lines.push(line(&format!("scene: {}", welcome.scene), style::TEXT_SIZE, style::DIM));
    let hints = Hints::new(&painter);
    let below = vec2(hints.width().min(width), hints.height);
    let size =
        lines.iter().fold(below, |size, line| vec2(size.x.max(line.size().x), size.y + line.size().y + 3.0));
    let rect = {
        // The cover is a square, in which the lines are centred.
        let size = vec2(size.x + cover, size.y.max(cover - style::PADDING.x)) + 2.0 * style::PADDING;
        Rect::from_min_size(pos2(space.left(), space.bottom() - size.y), size)
    };
    style::ground(&painter, rect);
    let mut at = rect.min + style::PADDING;
    if let Some(of_track) = welcome.cover {
        let square = Rect::from_min_size(at, Vec2::splat(cover - style::PADDING.x));
        draw_cover(&painter, square, of_track);
        at += vec2(cover, 0.5 * (rect.height() - 2.0 * style::PADDING.y - size.y).max(0.0));
    }
    for line in lines {
        let height = line.size().y + 3.0;
        painter.galley(at, line, style::TEXT);
        at.y += height;
    }
    hints.draw(&painter.with_clip_rect(rect), at);
}

struct Hints {
    parts: Vec<(Arc<Galley>, bool)>,
    height: f32,
}

const CAP_PADDING: f32 = 6.0;
const GAP: f32 = 7.0;

impl Hints {
    fn new(painter: &Painter) -> Self {
        let text = |text: &str, color| {
            painter.layout_no_wrap(text.to_owned(), style::proportional(style::SMALL_SIZE), color)
        };
        let mut parts = Vec::new();
        for (command, words) in NAMED.iter().zip(["all keys", "next scene", "full screen"]) {
            let Some(binding) = command.binding() else { continue };
            let cap = binding.written.split([',', ' ']).next().unwrap_or(binding.written);
            parts.push((text(cap, style::TEXT), true));
            parts.push((text(words, style::DIM), false));
        }
        parts.push((text("· drop music here", style::DIM), false));
        let height = parts.iter().map(|(galley, _)| galley.size().y).fold(0.0, f32::max) + 12.0;
        Self { parts, height }
    }

    fn width(&self) -> f32 {
        self.parts.iter().map(|(galley, cap)| Self::width_of(galley, *cap) + GAP).sum::<f32>() - GAP
    }

    fn width_of(galley: &Galley, cap: bool) -> f32 {
        galley.size().x + if cap { 2.0 * CAP_PADDING } else { 0.0 }
    }

    fn draw(self, painter: &Painter, at: egui::Pos2) {
        let mut x = at.x;
        for (galley, cap) in self.parts {
            let size = vec2(Self::width_of(&galley, cap), galley.size().y + 4.0);
            let place = Rect::from_min_size(pos2(x, at.y + self.height - size.y), size);
            style::light(painter, place, cap);
            painter.galley(place.center() - 0.5 * galley.size(), galley, style::TEXT);
            x += size.x + GAP;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_welcome_text_disappears_after_six_seconds() {
        let since = Instant::now();
        let welcome =
            Welcome { title: "demo track", artist: None, cover: None, scene: "speakers, 12 of 17", since };
        let at = |ms| since + Duration::from_millis(ms);
        assert_eq!([0, 5_900].map(|ms| welcome.is_gone(at(ms))), [false; 2]);
        assert!(welcome.is_gone(at(6_701)));
        assert_eq!(welcome.next_change(at(10)), Some(at(6_000)));
        assert_eq!(welcome.next_change(at(6_200)), Some(at(6_200)));
        assert_eq!(welcome.next_change(at(7_000)), None);
    }
}
