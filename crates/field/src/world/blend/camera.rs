//! The camera of a blend, between the cameras of two scenes.
//!
//! The target moves in a straight line. The line of sight turns around the target by yaw and pitch, in the shorter
//! direction, and its length is interpolated. Between two cameras that look at an object from opposite sides, the
//! camera therefore moves around the object and does not pass through its own target.

use std::f32::consts::TAU;

use crate::graph::{Graph, NodeId, Op};
use crate::lang::Camera;

struct LineOfSight {
    /// The angle around the vertical in radians; 0 along z.
    yaw: NodeId,
    /// The angle above the horizon in radians.
    pitch: NodeId,
    length: NodeId,
}

impl LineOfSight {
    fn of(graph: &mut Graph, camera: &Camera) -> Self {
        let [x, y, z] = [0, 1, 2].map(|axis| graph.sub(camera.target[axis], camera.position[axis]));
        let level = graph.length(&[x, z]);
        let (yaw, pitch) = (graph.binary(Op::Atan2, x, z), graph.binary(Op::Atan2, y, level));
        Self { yaw, pitch, length: graph.length(&[x, y, z]) }
    }

    fn vector(&self, graph: &mut Graph) -> [NodeId; 3] {
        let [sin_yaw, cos_yaw] = [Op::Sin, Op::Cos].map(|op| graph.unary(op, self.yaw));
        let [sin_pitch, cos_pitch] = [Op::Sin, Op::Cos].map(|op| graph.unary(op, self.pitch));
        let level = graph.mul(self.length, cos_pitch);
        [graph.mul(level, sin_yaw), graph.mul(self.length, sin_pitch), graph.mul(level, cos_yaw)]
    }
}

/// Mixes two cameras. At the fraction `s` = 0 the result is `a`.
pub(super) fn mixed(graph: &mut Graph, a: &Camera, b: &Camera, s: NodeId) -> Camera {
    let lines = [a, b].map(|camera| LineOfSight::of(graph, camera));
    let numbers = a.numbers().into_iter().zip(b.numbers());
    let mixed = Camera::of(numbers.map(|(a, b)| graph.mix(a, b, s)));
    let turn = graph.sub(lines[1].yaw, lines[0].yaw);
    // The shorter way around.
    let turn = turn - Op::Floor.of(turn / TAU + 0.5) * TAU;
    let line = LineOfSight {
        yaw: graph.add(lines[0].yaw, turn * s),
        pitch: graph.mix(lines[0].pitch, lines[1].pitch, s),
        length: graph.mix(lines[0].length, lines[1].length, s),
    };
    let away = line.vector(graph);
    let sharp = [(a, &lines[0]), (b, &lines[1])].map(|(camera, line)| nearness(graph, camera, line));
    let nearness = graph.mix(sharp[0], sharp[1], s);
    Camera {
        position: [0, 1, 2].map(|axis| graph.sub(mixed.target[axis], away[axis])),
        focus: graph.div(1.0, nearness),
        ..mixed
    }
}

/// Returns the reciprocal of a camera's focus distance, because blur is proportional to the reciprocal. If the focus
/// distance is infinite, the camera focuses on its target.
fn nearness(graph: &mut Graph, camera: &Camera, line: &LineOfSight) -> NodeId {
    let is_finite = Op::LessEqual.pair(Op::Abs.of(camera.focus), f32::MAX);
    let distance = graph.select(is_finite, camera.focus, line.length);
    graph.div(1.0, distance)
}
