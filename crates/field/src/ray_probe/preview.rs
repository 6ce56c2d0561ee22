//! Small images of formulas, drawn on the CPU with one light and without shadows.

use super::{Ray, RayProbe};
use crate::graph::FrameInputs;
use crate::region::{RegionOptions, RegionPlan};
use crate::vectors::dot;
use crate::world::World;

/// Position of the eye, which looks at the origin.
const EYE: [f32; 3] = [1.5, 1.5, -3.0];
/// Tangent of half the field of view.
const TAN_HALF: f32 = 0.46;
const LIGHT: [f32; 3] = [-0.35, 0.85, -0.4];
const DARKEST: f32 = 0.18;
/// Colour of lit surfaces, as sRGB.
const COLOR: [f32; 3] = [236.0, 214.0, 186.0];

/// Draws a formula with `side` pixels along each side. The result has rows from the upper left, with red, green, blue
/// and coverage per pixel; `None` if the text is not a formula.
pub fn preview(formula: &str, side: usize) -> Option<Vec<[u8; 4]>> {
    let world = World::parse("portrait", formula).ok()?;
    let mut frame = FrameInputs { eye: EYE, ..FrameInputs::default() };
    frame.hoisted = world.hoisted.values(&frame);
    let regions = RegionPlan::new(&world).build(&frame, &RegionOptions::default());
    let planes = world.frame_tape.values(&frame).planes;
    let ray_probe = RayProbe::new(&world, &regions, &frame, &planes);
    let forward = super::unit(EYE.map(|part| -part));
    let [right, up] = super::sides(forward);
    let light = super::unit(LIGHT);
    let step = 2.0 * TAN_HALF / side.max(1) as f32;
    let shade = |x: f32, y: f32| {
        let (a, b) = (x * step - TAN_HALF, TAN_HALF - y * step);
        let direction = super::unit(std::array::from_fn(|i| forward[i] + a * right[i] + b * up[i]));
        let ray = Ray { origin: EYE, direction, spread: 0.5 * step };
        let hit = ray_probe.trace(&ray).hit?;
        let lit = dot(ray_probe.normal(&ray, &hit), light);
        Some(DARKEST + (1.0 - DARKEST) * (0.5 + 0.5 * lit).powi(2))
    };
    let pixel = |place: usize| {
        let (x, y) = ((place % side) as f32, (place / side) as f32);
        let places = [(0.25, 0.25), (0.75, 0.25), (0.25, 0.75), (0.75, 0.75)];
        let lit: Vec<f32> = places.into_iter().filter_map(|(dx, dy)| shade(x + dx, y + dy)).collect();
        let mean = lit.iter().sum::<f32>() / lit.len().max(1) as f32;
        let [r, g, b] = COLOR.map(|part| (part * mean.sqrt()).clamp(0.0, 255.0) as u8);
        [r, g, b, (255.0 * lit.len() as f32 / 4.0) as u8]
    };
    Some((0..side * side).map(pixel).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lang::examples;

    #[test]
    fn a_ball_is_round_and_lit_from_above() {
        let picture = preview("sphere(p, 1)", 48).unwrap();
        let at = |x: usize, y: usize| picture[y * 48 + x];
        assert_eq!([at(0, 0)[3], at(47, 47)[3], at(24, 24)[3]], [0, 0, 255]);
        assert!(at(22, 12)[0] > at(26, 36)[0] + 40, "{:?} above, {:?} below", at(22, 12), at(26, 36));
        let covered =
            |place: &dyn Fn(usize) -> usize| (0..48).filter(|i| picture[place(*i)][3] > 127).count();
        let (wide, high) = (covered(&|x| 24 * 48 + x), covered(&|y| y * 48 + 24));
        assert!(wide.abs_diff(high) <= 1 && wide > 20, "{wide} x {high}");
        assert_eq!(preview("no formula", 8), None);
    }

    #[test]
    fn every_function_with_a_picture_has_a_visible_preview() {
        for (name, formula) in examples() {
            let picture = preview(formula, 16).unwrap_or_else(|| panic!("{name} cannot be drawn"));
            let covered = picture.iter().filter(|pixel| pixel[3] > 127).count();
            assert!((8..256).contains(&covered), "{name} covers {covered} of 256 pixels");
        }
    }
}
