//! An image for painting shapes: supersampled, in linear light.

use super::noise::smoothstep;
use super::shape::{Point, Shape};

/// Samples per pixel along each axis.
const SAMPLES: usize = 2;

/// A linear colour, 0..1.
pub type Color = [f32; 3];

/// Converts an sRGB colour 0xRRGGBB to a linear colour.
pub fn rgb(hex: u32) -> Color {
    let linear = |s: f32| if s <= 0.040_45 { s / 12.92 } else { ((s + 0.055) / 1.055).powf(2.4) };
    [16, 8, 0].map(|shift| linear((hex >> shift & 0xFF) as f32 / 255.0))
}

/// Converts a linear component to an sRGB byte.
pub fn to_srgb(x: f32) -> u8 {
    let x = x.clamp(0.0, 1.0);
    let s = if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 };
    (s * 255.0).round() as u8
}

pub fn scale(color: Color, factor: f32) -> Color {
    color.map(|c| c * factor)
}

/// One number per sample of the image.
pub struct Grid {
    side: usize,
    values: Vec<f32>,
}

impl Grid {
    /// Computes the signed distance to `shape` at each sample, in units. Distances above `reach` become `reach`.
    pub fn distance(side: usize, shape: &Shape, reach: f32) -> Self {
        let samples = side * SAMPLES;
        let mut values = vec![reach; samples * samples];
        let span = sample_span(samples, shape, reach);
        let rows = &mut values[span.y.start * samples..span.y.end * samples];
        let workers = std::thread::available_parallelism().map_or(1, usize::from);
        let rows_per_worker = span.y.len().div_ceil(workers).max(1);
        std::thread::scope(|scope| {
            for (part, rows) in rows.chunks_mut(rows_per_worker * samples).enumerate() {
                let (xs, y0) = (span.x.clone(), span.y.start + part * rows_per_worker);
                scope.spawn(move || {
                    for (y, row) in rows.chunks_mut(samples).enumerate() {
                        for x in xs.clone() {
                            row[x] = shape.distance(position(x, y0 + y));
                        }
                    }
                });
            }
        });
        Self { side: samples, values }
    }

    /// Converts signed distances to coverage, 0..1.
    pub fn coverage(&self) -> Self {
        Self { side: self.side, values: self.values.iter().map(|&d| coverage(d, 0.0)).collect() }
    }

    /// Returns the value of the sample that contains `p`.
    pub fn at(&self, p: Point) -> f32 {
        let index = |v: f32| ((v * SAMPLES as f32) as usize).min(self.side - 1);
        self.values[index(p[1]) * self.side + index(p[0])]
    }

    /// Returns a copy, blurred by about `radius` units with three box filters along each axis.
    fn blurred(&self, radius: f32) -> Self {
        let reach = (radius * SAMPLES as f32 / 2.0).round().max(1.0) as usize;
        let n = self.side;
        let mut values = self.values.clone();
        let mut line = vec![0.0; n];
        let mut pass = |start: usize, step: usize| {
            for _ in 0..3 {
                for (i, v) in line.iter_mut().enumerate() {
                    *v = values[start + i * step];
                }
                let mut sum: f64 = line[..reach.min(n)].iter().map(|&v| f64::from(v)).sum();
                for i in 0..n {
                    if let Some(&v) = line.get(i + reach) {
                        sum += f64::from(v);
                    }
                    if i > reach {
                        sum -= f64::from(line[i - reach - 1]);
                    }
                    values[start + i * step] = (sum / (2 * reach + 1) as f64) as f32;
                }
            }
        };
        (0..n).for_each(|y| pass(y * n, 1));
        (0..n).for_each(|x| pass(x, n));
        Self { side: n, values }
    }
}

/// A height map that inflates a flat shape like a cushion, for shading.
pub struct Relief {
    height: Grid,
}

impl Relief {
    /// Inflates a shape, given the shape's `coverage`. Each of `radii` (in units) rounds the edge once more.
    pub fn new(coverage: &Grid, radii: &[f32]) -> Self {
        let mut height = vec![0.0; coverage.values.len()];
        for &radius in radii {
            let soft = coverage.blurred(radius);
            for (h, s) in height.iter_mut().zip(&soft.values) {
                *h += radius * (2.0 * s - 1.0).max(0.0).sqrt();
            }
        }
        let height = Grid { side: coverage.side, values: height };
        Self { height: height.blurred(2.0) }
    }

    /// Returns the unit normal at `p`: x right, y down, z towards the viewer.
    pub fn normal(&self, p: Point) -> [f32; 3] {
        let e = 1.0;
        let at = |dx: f32, dy: f32| self.height.at([(p[0] + dx).max(0.0), (p[1] + dy).max(0.0)]);
        let x = (at(-e, 0.0) - at(e, 0.0)) / (2.0 * e);
        let y = (at(0.0, -e) - at(0.0, e)) / (2.0 * e);
        let length = (x * x + y * y + 1.0).sqrt();
        [x / length, y / length, 1.0 / length]
    }

    /// Returns the light at `p`, from about 0.3 (shade) to 1.15. Light comes from the upper left and from the sky.
    pub fn light(&self, p: Point) -> f32 {
        let n = self.normal(p);
        let sun = (-0.42 * n[0] - 0.62 * n[1] + 0.66 * n[2]).max(0.0);
        0.30 + 0.72 * sun + 0.13 * (0.5 - 0.5 * n[1])
    }
}

/// An image: premultiplied linear colour and alpha for each sample.
pub struct Canvas {
    side: usize,
    samples: usize,
    rgba: Vec<[f32; 4]>,
}

impl Canvas {
    /// Creates a transparent image of `side` x `side` pixels. One unit is one pixel.
    pub fn new(side: usize) -> Self {
        let samples = side * SAMPLES;
        Self { side, samples, rgba: vec![[0.0; 4]; samples * samples] }
    }

    /// Paints `shape` over the image, within `clip` if there is one.
    ///
    /// `soft` widens the edge to a gradient from `soft` units outside to `soft` units inside. `paint` returns
    /// colour and opacity from the position and the signed distance to the outline.
    pub fn fill(
        &mut self,
        shape: &Shape,
        clip: Option<&Grid>,
        soft: f32,
        paint: impl Fn(Point, f32) -> (Color, f32),
    ) {
        self.visit(shape, clip, soft, |under, p, d, cover| {
            let (color, opacity) = paint(p, d);
            let alpha = cover * opacity.clamp(0.0, 1.0);
            let over = |k: usize| color[k].max(0.0) * alpha + under[k] * (1.0 - alpha);
            *under = [over(0), over(1), over(2), alpha + under[3] * (1.0 - alpha)];
        });
    }

    /// Darkens the image under `shape` by `strength`, 0..1. Alpha does not change, so that no shadow appears
    /// around the painted parts.
    pub fn darken(&mut self, shape: &Shape, clip: Option<&Grid>, soft: f32, strength: f32) {
        self.visit(shape, clip, soft, |under, _, _, cover| {
            for channel in &mut under[..3] {
                *channel *= 1.0 - strength * cover;
            }
        });
    }

    /// Calls `change` for each covered sample, with the sample's colour, position, signed distance and coverage.
    fn visit(
        &mut self,
        shape: &Shape,
        clip: Option<&Grid>,
        soft: f32,
        change: impl Fn(&mut [f32; 4], Point, f32, f32),
    ) {
        let span = sample_span(self.samples, shape, soft + 1.0);
        for y in span.y {
            for x in span.x.clone() {
                let i = y * self.samples + x;
                let mask = clip.map_or(1.0, |grid| grid.values[i]);
                if mask <= 0.0 {
                    continue;
                }
                let p = position(x, y);
                let d = shape.distance(p);
                let cover = mask * coverage(d, soft);
                if cover > 0.0 {
                    change(&mut self.rgba[i], p, d, cover);
                }
            }
        }
    }

    /// Converts the image to rows of sRGB bytes with straight alpha. Transparent pixels get the colour of their
    /// surroundings, so that filtering and mipmaps add no foreign colour at edges.
    pub fn into_bytes(self) -> Vec<u8> {
        let mut level = Vec::with_capacity(self.side * self.side);
        for y in 0..self.side {
            for x in 0..self.side {
                level.push(mean(&self.rgba, self.samples, x, y, SAMPLES));
            }
        }
        let near = dilate(&level, self.side);
        let bytes = level.iter().zip(bleed(&near, self.side)).flat_map(|(pixel, color)| {
            let [r, g, b] = color.map(to_srgb);
            [r, g, b, (pixel[3].clamp(0.0, 1.0) * 255.0).round() as u8]
        });
        bytes.collect()
    }
}

/// Pixels with less alpha count as transparent, because their alpha rounds to 0.
const ALPHA_MIN: f32 = 1.0 / 1024.0;

/// Grows the painted area by some pixels. Each new pixel is opaque and has the mean colour of its painted neighbours.
fn dilate(level: &[[f32; 4]], side: usize) -> Vec<[f32; 4]> {
    /// Width of the grown border in pixels, enough for a mipmap level or two.
    const DILATION: usize = 10;
    let mut grown = level.to_vec();
    for _ in 0..DILATION {
        let before = grown.clone();
        for (i, pixel) in grown.iter_mut().enumerate().filter(|(_, pixel)| pixel[3] <= ALPHA_MIN) {
            let (x, y) = (i % side, i / side);
            let mut sum = [0.0; 4];
            for ny in y.saturating_sub(1)..(y + 2).min(side) {
                for nx in x.saturating_sub(1)..(x + 2).min(side) {
                    let near = before[ny * side + nx];
                    if near[3] > ALPHA_MIN {
                        sum = [0, 1, 2, 3].map(|k| sum[k] + near[k]);
                    }
                }
            }
            if sum[3] > 0.0 {
                *pixel = sum.map(|v| v / sum[3]);
            }
        }
    }
    grown
}

/// Converts premultiplied pixels to straight colours. A transparent pixel gets the mean colour of a block around it.
fn bleed(level: &[[f32; 4]], side: usize) -> Vec<Color> {
    let coarse = if side > 1 && side.is_multiple_of(2) {
        let half = side / 2;
        let means = (0..half * half).map(|i| mean(level, side, i % half, i / half, 2));
        bleed(&means.collect::<Vec<_>>(), half)
    } else {
        vec![[0.0; 3]]
    };
    let half = (side / 2).max(1);
    let straight = level.iter().enumerate().map(|(i, pixel)| {
        if pixel[3] > ALPHA_MIN {
            [0, 1, 2].map(|k| pixel[k] / pixel[3])
        } else {
            coarse[(i / side / 2).min(half - 1) * half + (i % side / 2).min(half - 1)]
        }
    });
    straight.collect()
}

/// Returns the mean of the `n` x `n` block (`x`, `y`) of an image with width `side`.
fn mean(rgba: &[[f32; 4]], side: usize, x: usize, y: usize, n: usize) -> [f32; 4] {
    let mut sum = [0.0; 4];
    for i in 0..n * n {
        let sample = rgba[(y * n + i / n) * side + x * n + i % n];
        for (s, v) in sum.iter_mut().zip(sample) {
            *s += v / (n * n) as f32;
        }
    }
    sum
}

/// The range of samples that a shape can cover.
struct Span {
    x: std::ops::Range<usize>,
    y: std::ops::Range<usize>,
}

fn sample_span(samples: usize, shape: &Shape, reach: f32) -> Span {
    let (low, high) = shape.bounds();
    let range = |axis: usize| {
        let from = ((low[axis] - reach) * SAMPLES as f32).floor().max(0.0) as usize;
        let to = ((high[axis] + reach) * SAMPLES as f32).ceil().max(0.0) as usize;
        from.min(samples)..to.min(samples)
    };
    Span { x: range(0), y: range(1) }
}

/// Returns the centre of a sample, in units.
fn position(x: usize, y: usize) -> Point {
    [(x as f32 + 0.5) / SAMPLES as f32, (y as f32 + 0.5) / SAMPLES as f32]
}

/// Returns the coverage of a sample at signed distance `d` from the outline, with an edge widened by `soft`.
fn coverage(d: f32, soft: f32) -> f32 {
    let half = soft + 0.5 / SAMPLES as f32;
    smoothstep(half, -half, d)
}
