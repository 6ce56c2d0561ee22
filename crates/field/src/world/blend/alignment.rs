//! Aligns the second scene of a blend with the first.
//!
//! The objects and cameras of two scenes may be far apart. The second scene is therefore moved, and turned around the
//! vertical, until its eye and line of sight coincide with the first scene's. Then the visible object of the first
//! scene turns into the visible object of the second scene, the camera hardly has to move, and lamps are as near to
//! objects as in their own scenes.

use crate::graph::{Graph, NodeId};
use crate::lang::Camera;
use crate::world::Bounds;

pub(super) type Vector = [NodeId; 3];

/// The position of the second scene within the first: `second = turned(first) + offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Alignment {
    /// Cosine and sine of the angle around the vertical from the first line of sight to the second.
    turn: [f32; 2],
    offset: [f32; 3],
}

impl Alignment {
    /// The alignment that leaves both scenes unchanged.
    pub const NONE: Self = Self { turn: [1.0, 0.0], offset: [0.0; 3] };

    /// The alignment that gives two cameras the same eye and direction. Pass the cameras at half of the blend.
    pub fn of(from: &Camera<f32>, to: &Camera<f32>) -> Self {
        let yaw = |camera: &Camera<f32>| {
            let [x, z] = [0, 2].map(|axis| camera.target[axis] - camera.position[axis]);
            x.atan2(z)
        };
        let (sin, cos) = (yaw(to) - yaw(from)).sin_cos();
        let turned = Self { turn: [cos, sin], offset: [0.0; 3] }.own_place(from.position);
        let offset = [0, 1, 2].map(|axis| to.position[axis] - turned[axis]);
        let numbers = [cos, sin].into_iter().chain(offset);
        if numbers.into_iter().all(f32::is_finite) { Self { turn: [cos, sin], offset } } else { Self::NONE }
    }

    /// Maps a point of the first scene to a point of the second scene.
    fn own_place(&self, [x, y, z]: [f32; 3]) -> [f32; 3] {
        let ([cos, sin], [a, b, c]) = (self.turn, self.offset);
        [cos * x + sin * z + a, y + b, cos * z - sin * x + c]
    }

    fn common_place(&self, [x, y, z]: [f32; 3]) -> [f32; 3] {
        let ([cos, sin], [a, b, c]) = (self.turn, self.offset);
        let (x, z) = (x - a, z - c);
        [cos * x - sin * z, y - b, cos * z + sin * x]
    }

    /// Returns a box of the first scene that contains the box `bounds` of the second scene.
    pub(super) fn common_box(&self, bounds: &Bounds) -> Bounds {
        if *self == Self::NONE {
            return *bounds;
        }
        let corner = |number: usize| {
            let at = |axis: usize| if number >> axis & 1 == 0 { bounds.low[axis] } else { bounds.high[axis] };
            let place = self.common_place([at(0), at(1), at(2)]);
            Bounds { low: place, high: place }
        };
        (1..8).fold(corner(0), |all, number| all.hull(&corner(number), 0.0))
    }

    pub(super) fn own_direction(&self, graph: &mut Graph, v: Vector) -> Vector {
        self.turned(graph, v, self.turn)
    }

    pub(super) fn common_direction(&self, graph: &mut Graph, v: Vector) -> Vector {
        let [cos, sin] = self.turn;
        self.turned(graph, v, [cos, -sin])
    }

    pub(super) fn own_point(&self, graph: &mut Graph, p: Vector) -> Vector {
        let turned = self.own_direction(graph, p);
        [0, 1, 2].map(|axis| graph.add(turned[axis], self.offset[axis]))
    }

    pub(super) fn common_point(&self, graph: &mut Graph, p: Vector) -> Vector {
        let off = [0, 1, 2].map(|axis| graph.sub(p[axis], self.offset[axis]));
        self.common_direction(graph, off)
    }

    fn turned(&self, graph: &mut Graph, [x, y, z]: Vector, turn: [f32; 2]) -> Vector {
        if turn == Self::NONE.turn {
            return [x, y, z];
        }
        let [cos, sin] = turn;
        [graph.add(cos * x, sin * z), y, graph.sub(cos * z, sin * x)]
    }
}
