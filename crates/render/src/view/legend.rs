//! Legends that explain a view's colours. The CPU draws them, so that they are the same in a window, a still and a
//! video.

use std::sync::Arc;

use super::letters::{Letters, Line};
use super::scale::{Color, heat};

/// The content of a legend.
#[derive(Debug, Clone, PartialEq)]
pub struct Legend {
    /// The view's name.
    pub title: &'static str,
    /// The description, in lines.
    pub text: String,
    /// A scale with labelled positions.
    pub scale: Option<Scale>,
    /// Single colours with their meanings.
    pub colors: Vec<(Color, String)>,
}

/// A scale of colours.
#[derive(Debug, Clone, PartialEq)]
pub struct Scale {
    /// The scale's colours.
    pub ramp: Ramp,
    /// Positions on the scale, 0..1, with their labels.
    pub ticks: Vec<(f32, String)>,
}

/// Colours of a scale.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Ramp {
    /// The colours of [`heat`].
    Heat,
    /// From black to white.
    Light,
    /// From white to black.
    Dark,
}

impl Ramp {
    /// The colour at a position, 0..1.
    pub fn at(self, fraction: f32) -> Color {
        match self {
            Ramp::Heat => heat(fraction),
            Ramp::Light => [fraction; 3],
            Ramp::Dark => [1.0 - fraction; 3],
        }
    }
}

/// A legend as an opaque image.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LegendPicture {
    /// Width and height in pixels.
    pub size: (u32, u32),
    /// Distance from the left and upper edge of the frame, in pixels.
    pub margin: u32,
    /// Four bytes per pixel, top row first.
    pub rgba: Vec<u8>,
}

const GROUND: Color = [0.035, 0.040, 0.050];
const TEXT: Color = [0.91, 0.92, 0.93];
const DIM: Color = [0.66, 0.68, 0.73];

/// Size of letters relative to the frame's height. The next constant limits this size, in pixels.
const LETTERS_FRACTION: f32 = 1.0 / 44.0;
const LETTERS: (f32, f32) = (11.0, 44.0);
/// Maximum fraction of the frame's width and height for a legend. Larger legends are left out.
const FRACTION_MAX: (f32, f32) = (0.7, 0.7);
/// Maximum number of single colours in a column.
const ROWS_MAX: usize = 6;

/// Draws legends, and caches the last legend.
#[derive(Default)]
pub struct LegendPainter {
    letters: Letters,
    last: Option<Known>,
}

struct Known {
    legend: Legend,
    size: (u32, u32),
    drawn: Option<Arc<LegendPicture>>,
}

impl LegendPainter {
    /// The legend for a frame of `size` pixels; `None` if the legend would cover too much of the frame.
    pub fn picture(&mut self, legend: Legend, size: (u32, u32)) -> Option<Arc<LegendPicture>> {
        if let Some(known) = self.last.as_ref().filter(|known| known.legend == legend && known.size == size) {
            return known.drawn.clone();
        }
        let drawn = draw(&mut self.letters, &legend, size).map(Arc::new);
        self.last = Some(Known { legend, size, drawn: drawn.clone() });
        drawn
    }
}

enum Part {
    Text(Line, Color),
    Block { size: (usize, usize), ramp: Option<Ramp>, color: Color },
}

fn draw(letters: &mut Letters, legend: &Legend, picture: (u32, u32)) -> Option<LegendPicture> {
    let unit = (picture.1 as f32 * LETTERS_FRACTION).clamp(LETTERS.0, LETTERS.1).round();
    let in_units = |count: f32| (count * unit).round() as usize;
    let padding = in_units(0.7);
    let mut parts: Vec<((usize, usize), Part)> = Vec::new();
    let mut y = padding;
    parts.push(((padding, y), Part::Text(letters.line(legend.title, (1.15 * unit).round()), TEXT)));
    y += in_units(1.65);
    for line in legend.text.lines() {
        parts.push(((padding, y), Part::Text(letters.line(line, unit), DIM)));
        y += in_units(1.35);
    }
    if let Some(scale) = &legend.scale {
        y += in_units(0.25);
        let bar = (in_units(17.0), in_units(0.9));
        parts.push(((padding, y), Part::Block { size: bar, ramp: Some(scale.ramp), color: TEXT }));
        y += bar.1;
        for (fraction, text) in &scale.ticks {
            let x = padding + (fraction.clamp(0.0, 1.0) * (bar.0 - 1) as f32).round() as usize;
            parts.push(((x, y), Part::Block { size: (1, in_units(0.3)), ramp: None, color: TEXT }));
            let line = letters.line(text, unit);
            let width = line.size.0;
            let left =
                x.saturating_sub(width / 2).clamp(padding, (padding + bar.0).max(padding + width) - width);
            parts.push(((left, y + in_units(0.3)), Part::Text(line, TEXT)));
        }
        y += in_units(1.75);
    }
    let rows = legend.colors.len().div_ceil(legend.colors.len().div_ceil(ROWS_MAX).max(1)).max(1);
    let (mut x, mut column_width) = (padding, 0);
    let (top, mut bottom) = (y + in_units(0.2), y);
    for (index, (color, text)) in legend.colors.iter().enumerate() {
        if index > 0 && index % rows == 0 {
            x += column_width + in_units(1.0);
            column_width = 0;
        }
        let row = top + (index % rows) * in_units(1.4);
        let block = Part::Block { size: (in_units(1.5), in_units(1.0)), ramp: None, color: *color };
        parts.push(((x, row + in_units(0.15)), block));
        let line = letters.line(text, unit);
        column_width = column_width.max(in_units(2.0) + line.size.0);
        parts.push(((x + in_units(2.0), row), Part::Text(line, TEXT)));
        bottom = bottom.max(row + in_units(1.4));
    }
    lay_out(&parts, padding, bottom, picture)
}

fn lay_out(
    parts: &[((usize, usize), Part)],
    padding: usize,
    bottom: usize,
    picture: (u32, u32),
) -> Option<LegendPicture> {
    let right = parts.iter().map(|(place, part)| match part {
        Part::Block { size, .. } | Part::Text(Line { size, .. }, _) => place.0 + size.0,
    });
    let size = (right.max().unwrap_or(0) + padding, bottom + padding);
    let margin = padding as u32;
    let (width, height) = (size.0 as u32, size.1 as u32);
    let fits = |part: u32, of: u32, fraction: f32| (part + margin) as f32 <= of as f32 * fraction;
    if !fits(width, picture.0, FRACTION_MAX.0) || !fits(height, picture.1, FRACTION_MAX.1) {
        return None;
    }
    let mut rgba: Vec<u8> =
        GROUND.map(byte).into_iter().chain([255]).cycle().take(4 * size.0 * size.1).collect();
    let mut put = |x: usize, y: usize, color: Color, cover: u8| {
        if x >= size.0 {
            return;
        }
        let at = 4 * (y * size.0 + x);
        for (to, from) in rgba.get_mut(at..at + 3).into_iter().flatten().zip(color) {
            let fraction = f32::from(cover) / 255.0;
            *to = byte(f32::from(*to) / 255.0 * (1.0 - fraction) + from * fraction);
        }
    };
    for (place, part) in parts {
        match part {
            Part::Block { size, ramp, color } => {
                for (x, y) in (0..size.1).flat_map(|y| (0..size.0).map(move |x| (x, y))) {
                    let fraction = x as f32 / (size.0.max(2) - 1) as f32;
                    put(place.0 + x, place.1 + y, ramp.map_or(*color, |ramp| ramp.at(fraction)), 255);
                }
            }
            Part::Text(line, color) => {
                for (index, cover) in line.cover.iter().enumerate().filter(|(_, cover)| **cover > 0) {
                    put(place.0 + index % line.size.0, place.1 + index / line.size.0, *color, *cover);
                }
            }
        }
    }
    Some(LegendPicture { size: (width, height), margin, rgba })
}

/// Converts a value of 0..1 to a byte.
pub fn byte(value: f32) -> u8 {
    (value.clamp(0.0, 1.0) * 255.0).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    fn legend() -> Legend {
        Legend {
            title: "steps",
            text: "what it shows".into(),
            scale: Some(Scale { ramp: Ramp::Heat, ticks: vec![(0.0, "0".into()), (1.0, "100".into())] }),
            colors: vec![([1.0, 0.0, 0.0], "floor".into()), ([0.0, 1.0, 0.0], "ball".into())],
        }
    }

    #[test]
    fn a_legend_shows_colours_and_letters_and_is_left_out_of_small_frames() {
        let mut painter = LegendPainter::default();
        let picture = painter.picture(legend(), (1280, 720)).unwrap();
        assert_eq!(picture.rgba.len() as u32, 4 * picture.size.0 * picture.size.1);
        let count = |color: Color| {
            let wanted = color.map(byte);
            picture.rgba.as_chunks::<4>().0.iter().filter(|pixel| pixel[..3] == wanted).count()
        };
        for color in [heat(0.0), heat(1.0), [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] {
            assert!(count(color) > 10, "{color:?} is missing");
        }
        let letters = count(TEXT);
        assert!(letters > 60, "only {letters} pixels belong to letters");
        assert!(picture.size.0 < 640 && picture.size.1 < 360, "{:?}", picture.size);
        assert!(painter.picture(legend(), (640, 360)).is_some());
        for size in [(160, 90), (1, 1), (16_384, 1)] {
            assert_eq!(painter.picture(legend(), size), None, "{size:?}");
        }
        let other = Legend { title: "depth", ..legend() };
        assert_ne!(painter.picture(other, (1280, 720)).unwrap(), picture);
    }
}
