//! A flat-sawn board of warm brown oak, with the grain along x, seamless in both directions.
//!
//! Everything is a periodic function of the tile's coordinates u, v in 0..1. The growth rings are the fractional part
//! of `RINGS * v` plus noise that is stretched along the grain. If the noise changes faster than `RINGS * v`, the
//! rings close and form the long arches of a flat-sawn board.

use super::noise::{gradient, mix, mix3, random, smoothstep, turbulence};

pub const SIDE: usize = 1024;
/// Samples per pixel along each axis.
const SAMPLES: usize = 2;
/// Number of growth rings from top to bottom.
const RINGS: i32 = 30;

/// Paints the image as rows of sRGB bytes, `SIDE * SIDE * 3` bytes.
pub fn paint() -> Vec<u8> {
    let mut pixels = vec![0; SIDE * SIDE * 3];
    let workers = std::thread::available_parallelism().map_or(1, usize::from);
    let rows_per_worker = SIDE.div_ceil(workers);
    std::thread::scope(|scope| {
        for (part, rows) in pixels.chunks_mut(rows_per_worker * SIDE * 3).enumerate() {
            scope.spawn(move || {
                for (i, pixel) in rows.chunks_exact_mut(3).enumerate() {
                    let (x, y) = (i % SIDE, part * rows_per_worker + i / SIDE);
                    pixel.copy_from_slice(&pixel_at(x, y));
                }
            });
        }
    });
    pixels
}

fn pixel_at(x: usize, y: usize) -> [u8; 3] {
    let mut sum = [0.0; 3];
    for sample in 0..SAMPLES * SAMPLES {
        let u = (x as f32 + ((sample % SAMPLES) as f32 + 0.5) / SAMPLES as f32) / SIDE as f32;
        let v = (y as f32 + ((sample / SAMPLES) as f32 + 0.5) / SAMPLES as f32) / SIDE as f32;
        let color = color_at(u, v);
        for (s, c) in sum.iter_mut().zip(color) {
            *s += c;
        }
    }
    sum.map(|s| (s / (SAMPLES * SAMPLES) as f32).round().clamp(0.0, 255.0) as u8)
}

/// Returns the colour at u, v: sRGB, 0..255.
fn color_at(u: f32, v: f32) -> [f32; 3] {
    // Fibres run along x and drift by a few pixels. Rings, fibres and pores drift together.
    let drift = 0.006 * turbulence(u * 2.0, v * 3.0, [2, 3], 3, 11);
    let v = v + drift;

    let ring = ring_at(u, v);
    let index = (ring.floor() as i32).rem_euclid(RINGS);
    let phase = ring - ring.floor();
    // Latewood darkens towards the end of the year and ends abruptly.
    let late_edge = mix(0.86, 0.94, random(index, 0, 21));
    let latewood = smoothstep(0.25, late_edge, phase) * smoothstep(1.0, late_edge, phase);
    let latewood = latewood * mix(0.35, 1.0, random(index, 1, 22));
    // Earlywood has the wide pores.
    let earlywood = smoothstep(0.45, 0.05, phase) + 0.6 * smoothstep(0.93, 1.0, phase);

    let fibres = turbulence(u * 16.0, v * 170.0, [16, 170], 2, 31);
    let hairs =
        gradient(u * 40.0, v * 430.0, [40, 430], 35) + 0.7 * gradient(u * 90.0, v * 300.0, [90, 300], 36);
    let streaks = turbulence(u * 5.0, v * 46.0, [5, 46], 3, 32);
    let clouds = turbulence(u * 2.0, v * 2.0, [2, 2], 3, 33);
    let year = random(index, 2, 23) - 0.5;

    let tone =
        0.66 - 0.36 * latewood + 0.15 * fibres + 0.07 * hairs + 0.13 * streaks + 0.10 * clouds + 0.16 * year;
    let mut color = palette(tone);
    // The hue varies between honey and red brown.
    let hue = turbulence(u * 3.0, v * 4.0, [3, 4], 2, 34);
    color = [color[0] * (1.0 + 0.02 * hue), color[1] * (1.0 - 0.025 * hue), color[2] * (1.0 - 0.06 * hue)];

    let coarse = pores(u, v, [20, 256], 41, 0.13 + 0.60 * earlywood.min(1.0), [0.50, 0.25]);
    let fine = pores(u, v, [36, 400], 42, 0.30 + 0.25 * earlywood.min(1.0), [0.45, 0.26]);
    let dark = (0.62 * coarse).max(0.38 * fine);
    mix3(color, [58.0, 28.0, 12.0], dark)
}

/// Returns the ring coordinate. Its integer part is the year (modulo [`RINGS`]), its fraction is the season.
fn ring_at(u: f32, v: f32) -> f32 {
    let figure = 2.3 * gradient(u * 2.0 + 0.37, v * 3.0 + 0.21, [2, 3], 51)
        + 1.3 * gradient(u * 3.0, v * 8.0, [3, 8], 58)
        + 0.45 * turbulence(u * 4.0, v * 22.0, [4, 22], 2, 53)
        + 0.14 * turbulence(u * 10.0, v * 120.0, [10, 120], 2, 54);
    let ring = RINGS as f32 * v + figure;
    // Years have different widths.
    ring + 0.8 * gradient(ring * 0.5, 0.5, [RINGS / 2, 1], 55)
}

/// Maps a tone to sRGB, 0..255: from dark latewood (0) over oak to pale earlywood (1).
fn palette(tone: f32) -> [f32; 3] {
    const STOPS: [[f32; 3]; 4] =
        [[92.0, 49.0, 22.0], [142.0, 84.0, 41.0], [186.0, 121.0, 66.0], [216.0, 160.0, 102.0]];
    let t = tone.clamp(0.0, 1.0) * 3.0;
    let i = (t as usize).min(2);
    mix3(STOPS[i], STOPS[i + 1], t - i as f32)
}

/// Returns the darkness, 0..1, of vessels that are cut open at the surface: at most one dash per cell of a grid.
///
/// `cells` has the number of cells along u and v, `density` is the fraction of cells with a dash, and `half_size` is
/// half the largest length and width of a dash, in cells.
fn pores(u: f32, v: f32, cells: [i32; 2], seed: u32, density: f32, half_size: [f32; 2]) -> f32 {
    let (x, y) = (u * cells[0] as f32, v * cells[1] as f32);
    let (x0, y0) = (x.floor() as i32, y.floor() as i32);
    let mut darkest: f32 = 0.0;
    for cy in y0 - 1..=y0 + 1 {
        for cx in x0 - 1..=x0 + 1 {
            let (wx, wy) = (cx.rem_euclid(cells[0]), cy.rem_euclid(cells[1]));
            let presence = density - random(wx, wy, seed);
            if presence <= 0.0 {
                continue;
            }
            let chance = |salt: u32| random(wx, wy, seed + 1000 * salt);
            let dx = x - (cx as f32 + chance(1));
            let dy = y - (cy as f32 + chance(2));
            let half_length = half_size[0] * mix(0.3, 1.0, chance(3) * chance(3));
            let half_width = half_size[1] * mix(0.6, 1.0, chance(4));
            let taper = 1.0 - (dx / half_length).powi(2);
            if taper <= 0.0 {
                continue;
            }
            let across = dy.abs() / half_width;
            let body = smoothstep(1.15, 0.35, across / taper.sqrt().max(0.2));
            darkest = darkest
                .max(body * taper.min(0.5) * 2.0 * mix(0.45, 1.0, chance(5)) * (presence * 12.0).min(1.0));
        }
    }
    darkest
}
