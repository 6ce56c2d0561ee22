//! A shape as a distance function: distances at many points, its bounds and its largest slope.

use glam::Vec3;
use mariana_field::graph::FrameInputs;
use mariana_field::lang::{compile, no_includes};
use mariana_field::tape::{Batch, Points, Tape, TapeOptions};

/// Half the side of the cube in which the shape is searched. The cube's centre is the origin.
const REACH: f32 = 2.2;
/// Number of points along each side of the cube.
const GRID: usize = 72;

/// Compiles a formula to a tape.
///
/// # Errors
/// Fails with the compiler's messages.
pub fn tape(name: &str, formula: &str) -> Result<Tape, String> {
    let compiled = compile(name, formula, &mut no_includes);
    let Some(scene) = &compiled.scene else { return Err(compiled.render(false)) };
    Tape::build(&scene.graph, &[scene.distance], &TapeOptions::default())
        .map_err(|error| format!("{name}: {error}"))
}

pub struct SampledField<'a> {
    batch: Batch<'a>,
    /// Factor that turns a value of the function into a lower bound of the true distance.
    pub step: f32,
    /// Factor that turns a value near the surface into approximately the true distance. The factor exceeds 1 if the
    /// function is far below the true distance.
    pub scale: f32,
    coordinates: [Vec<f32>; 3],
}

pub struct Extent {
    /// Points on and in the shape.
    pub points: Vec<Vec3>,
    /// Height of the shape's lowest point.
    pub floor: f32,
}

impl<'a> SampledField<'a> {
    /// Creates a distance function from a tape and measures the function's slopes.
    pub fn new(tape: &'a Tape, frame: &'a FrameInputs) -> Self {
        let batch = Batch::new(tape, frame);
        let mut field = Self { batch, step: 1.0, scale: 1.0, coordinates: Default::default() };
        let points = grid();
        let slopes = field.gradients(&points, 4e-3);
        let distances = field.distances(&points);
        let outside = slopes.iter().zip(&distances).filter(|(_, distance)| **distance > 0.0);
        let steepest = outside.fold(1.0_f32, |steepest, (slope, _)| steepest.max(slope.length()));
        field.step = 0.95 / steepest;
        let near = slopes.iter().zip(&distances).filter(|(_, distance)| distance.abs() < 0.05);
        let mut near: Vec<f32> = near.map(|(slope, _)| slope.length()).collect();
        near.sort_by(f32::total_cmp);
        field.scale = near.get(near.len() / 2).map_or(1.0, |typical| 1.0 / typical.clamp(0.1, 10.0));
        field
    }

    /// Returns the function's values, without a factor.
    pub fn distances(&mut self, points: &[Vec3]) -> Vec<f32> {
        for (axis, coordinates) in self.coordinates.iter_mut().enumerate() {
            coordinates.clear();
            coordinates.extend(points.iter().map(|point| point[axis]));
        }
        let position = [0, 1, 2].map(|axis| self.coordinates[axis].as_slice());
        self.batch.run(Points { position, normal: None }).swap_remove(0)
    }

    /// Returns gradients, measured at the corners of a tetrahedron with edges of about `3 * reach`.
    pub fn gradients(&mut self, points: &[Vec3], reach: f32) -> Vec<Vec3> {
        let mut gradients = vec![Vec3::ZERO; points.len()];
        for corner in [[1.0, -1.0, -1.0], [-1.0, -1.0, 1.0], [-1.0, 1.0, -1.0], [1.0, 1.0, 1.0]] {
            let corner = Vec3::from(corner);
            let taps: Vec<Vec3> = points.iter().map(|point| point + reach * corner).collect();
            for (gradient, distance) in gradients.iter_mut().zip(self.distances(&taps)) {
                *gradient += corner * (distance / (4.0 * reach));
            }
        }
        gradients
    }

    /// Searches the cube for the shape; returns `None` if the cube is empty.
    pub fn extent(&mut self) -> Option<Extent> {
        let cell = 2.0 * REACH / (GRID - 1) as f32;
        let all = grid();
        let distances = self.distances(&all);
        let near = all.into_iter().zip(distances).filter(|(_, distance)| *distance * self.scale < 0.4 * cell);
        let points: Vec<Vec3> = near.map(|(point, _)| point).collect();
        let lowest = points.iter().map(|point| point.y).reduce(f32::min)?;
        // Raise a plane until it touches the shape.
        let mut floor = lowest - cell;
        for _ in 0..400 {
            let fine = 160;
            let at = |index: usize| REACH * (2.0 * index as f32 / (fine - 1) as f32 - 1.0);
            let plane: Vec<Vec3> =
                (0..fine * fine).map(|i| Vec3::new(at(i % fine), floor, at(i / fine))).collect();
            let least =
                self.distances(&plane).into_iter().fold(f32::MAX, f32::min) * self.scale.max(self.step);
            if least < 2e-3 {
                break;
            }
            floor += (0.4 * least).max(1e-3);
        }
        Some(Extent { points, floor })
    }
}

fn grid() -> Vec<Vec3> {
    let at = |index: usize| REACH * (2.0 * index as f32 / (GRID - 1) as f32 - 1.0);
    (0..GRID.pow(3)).map(|i| Vec3::new(at(i % GRID), at(i / GRID % GRID), at(i / GRID / GRID))).collect()
}
