//! A grid over a frame's media: for each cell, an upper bound of the density, so that rays skip empty space.

use super::lanes::{CELLS, Lanes, bound, bounds_of};
use super::program::INPUTS;
use super::surface::place_of;
use super::{Formula, RegionKey};
use crate::bounds::Bounds;
use crate::graph::{FrameInputs, Graph, Interval, NodeId};
use crate::rays::DENSEST;

/// Number of cells of the grid along each axis.
pub const MEDIUM_SIDE: usize = 16;
/// Where the media have no bound, the grid ends at this distance from its centre.
const REACH: f32 = 32.0;
/// Overlap of cells, as a fraction of the grid's size, because shaders round differently.
const OVERLAP: f32 = 1e-5;
/// The bound of a cell that emits light without dimming any.
const GLOWING: f32 = 1e-9;

/// The parts of a world's grids that all frames share.
#[derive(Debug, Clone, PartialEq)]
pub struct MediumPlan {
    formula: Formula,
    bounds: Bounds,
}

/// The grid of a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct MediumGrid {
    /// Lower corner.
    pub low: [f32; 3],
    /// Extent; never 0.
    pub size: [f32; 3],
    /// Upper bounds of the density, `x + MEDIUM_SIDE * (y + MEDIUM_SIDE * z)`; 0 in cells without a medium.
    pub densities: Vec<f32>,
}

impl MediumGrid {
    /// The largest bound of the density in any cell.
    pub fn densest(&self) -> f32 {
        self.densities.iter().copied().fold(0.0, f32::max)
    }
}

impl MediumPlan {
    /// Creates the plan of media: `roots` are their density and the emitted light in red, green and blue, and `bounds` is a
    /// box around them, whose sides may be infinite.
    pub fn new(graph: &Graph, roots: [NodeId; 4], bounds: Bounds) -> Self {
        Self { formula: Formula::new(graph, &roots, INPUTS, 0), bounds }
    }

    /// Returns the inputs that determine a frame's grid.
    pub fn key(&self, inputs: &FrameInputs) -> RegionKey {
        self.formula.key(inputs)
    }

    /// Builds the grid of a frame. `center` is its centre along axes on which the media have no bound.
    pub fn grid(&self, inputs: &FrameInputs, center: [f32; 3]) -> MediumGrid {
        let mut low = self.bounds.low;
        let mut size = [0.0; 3];
        for axis in 0..3 {
            let high = self.bounds.high[axis].min(center[axis].max(low[axis]) + REACH);
            low[axis] = low[axis].max(center[axis].min(high) - REACH);
            size[axis] = (high - low[axis]).max(1e-3);
        }
        let program = self.formula.folded(Some(inputs));
        let mut rows = vec![Lanes::splat(Interval::point(0.0)); program.inputs];
        let mut densities = Vec::with_capacity(MEDIUM_SIDE.pow(3));
        for first in (0..MEDIUM_SIDE.pow(3)).step_by(CELLS) {
            for (axis, row) in rows.iter_mut().take(3).enumerate() {
                for lane in 0..CELLS {
                    let place = place_of(first + lane, MEDIUM_SIDE)[axis];
                    let face = |number: usize| low[axis] + size[axis] * (number as f32 / MEDIUM_SIDE as f32);
                    let around = OVERLAP * (size[axis] + low[axis].abs());
                    (row.lo[lane], row.hi[lane]) = (face(place) - around, face(place + 1) + around);
                }
            }
            bound(&program, &mut rows, inputs);
            let [density, light @ ..] = [0, 1, 2, 3].map(|root| bounds_of(&program, root, &rows).hi);
            densities.extend((0..CELLS).map(|lane| {
                let (density, light) = (density[lane], light.iter().map(|part| part[lane]).sum::<f32>());
                match (density <= 0.0, light <= 0.0) {
                    (true, true) => 0.0,
                    (true, false) => GLOWING,
                    // An unknown bound may be any density.
                    _ if density.is_nan() => DENSEST,
                    _ => density.min(DENSEST),
                }
            }));
        }
        MediumGrid { low, size, densities }
    }
}
