//! The mallard texture, seen from afar. Mip levels average colour and alpha separately, and the shader combines the
//! averages. The result is right only if the transparent texels continue the bird's colours far enough. Otherwise a
//! halo around the bird grows with every level.

#![allow(clippy::unwrap_used)]

use std::path::PathBuf;

/// Decodes a channel to linear light, 0..1 (IEC 61966-2-1).
fn linear(step: u8) -> f64 {
    let encoded = f64::from(step) / 255.0;
    if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// Encodes linear light in steps of 0..255.
fn encoded(light: f64) -> f64 {
    255.0 * if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 }
}

/// A texel of a level: the averages of colour and of alpha, and the average of colour times alpha.
#[derive(Debug, Clone, Copy, Default)]
struct Texel {
    color: [f64; 3],
    alpha: f64,
    covered: [f64; 3],
}

fn half(level: &[Texel], side: usize) -> Vec<Texel> {
    let mut smaller = vec![Texel::default(); side * side / 4];
    for (index, texel) in level.iter().enumerate() {
        let to = &mut smaller[(index / side / 2) * (side / 2) + (index % side) / 2];
        to.alpha += 0.25 * texel.alpha;
        for channel in 0..3 {
            to.color[channel] += 0.25 * texel.color[channel];
            to.covered[channel] += 0.25 * texel.covered[channel];
        }
    }
    smaller
}

#[test]
fn the_mallard_has_no_halo_at_any_distance() {
    // Linear light of wood of medium brightness.
    const WOOD: [f64; 3] = [0.30, 0.14, 0.06];
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("assets/textures/mallard.png");
    let picture = image::open(path).unwrap().to_rgba8();
    let mut side = picture.width() as usize;
    let mut level: Vec<Texel> = picture
        .pixels()
        .map(|pixel| {
            let color = [0, 1, 2].map(|channel| linear(pixel.0[channel]));
            let alpha = f64::from(pixel.0[3]) / 255.0;
            Texel { color, alpha, covered: color.map(|light| light * alpha) }
        })
        .collect();
    let mut worst = Vec::new();
    while side > 32 {
        level = half(&level, side);
        side /= 2;
        let errors = level.iter().filter(|texel| texel.alpha > 0.0 && texel.alpha < 1.0).map(|texel| {
            let seen = |channel: usize, covered: f64| encoded(WOOD[channel] * (1.0 - texel.alpha) + covered);
            let off = |channel: usize| {
                (seen(channel, texel.color[channel] * texel.alpha) - seen(channel, texel.covered[channel]))
                    .abs()
            };
            off(0).max(off(1)).max(off(2))
        });
        let mut errors: Vec<f64> = errors.collect();
        errors.sort_by(f64::total_cmp);
        worst.push((side, errors[errors.len() * 95 / 100], errors.last().copied().unwrap_or(0.0)));
    }
    for (side, most, _) in &worst {
        assert!(
            *most <= 10.0,
            "a halo of {most:.1} steps at {side} texels a side; (side, most, worst): {worst:.1?}"
        );
    }
}
