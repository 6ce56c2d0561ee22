//! One scene inside a shape, the other outside: exact constructive geometry.
//!
//! **What belongs to which side.** Surfaces and their materials do. Light does not: lights, sky and glow are mixed by
//! the share, because a light of one side alone would ask for the side at every step of its rays. A surface that is cut
//! by the portal has the material of its object there.

use super::Steps;
use super::side::Side;
use crate::graph::{Graph, NodeId, Op};
use crate::lang::Camera;

/// The shape in which the second scene appears.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub enum PortalShape {
    /// A ball around the camera's target that grows beyond everything.
    #[default]
    Ball,
    /// The half space to the left of a plane along the line of sight that moves to the right.
    Plane,
}

/// Nearer to its end than this, a portal moves no more: it has left everything behind it.
const LEFT_MIN: f32 = 1e-3;

/// The distance to the portal, negative inside: as large as the way from the eye to the target at the middle, without
/// end towards the end.
fn portal(graph: &mut Graph, shape: PortalShape, camera: &Camera, s: NodeId) -> NodeId {
    let p = super::side::position(graph);
    let off = [0, 1, 2].map(|axis| graph.sub(p[axis], camera.target[axis]));
    let sight = [0, 1, 2].map(|axis| graph.sub(camera.target[axis], camera.position[axis]));
    let length = graph.length(&sight);
    let (one, least) = (graph.constant(1.0), graph.constant(LEFT_MIN));
    let rest = graph.sub(one, s);
    let rest = graph.max(rest, least);
    let grown = match shape {
        PortalShape::Ball => graph.div(s, rest),
        PortalShape::Plane => {
            let begun = graph.max(s, least);
            let (begun, rest) = (graph.div(one, begun), graph.div(one, rest));
            graph.sub(rest, begun)
        }
    };
    let reached = graph.mul(grown, length);
    let from = match shape {
        PortalShape::Ball => graph.length(&off),
        PortalShape::Plane => {
            // To the right in the picture.
            let level = graph.length(&[sight[0], sight[2]]);
            let right = [graph.div(sight[2], level), graph.div(sight[0], level)];
            let (x, z) = (graph.mul(off[0], right[0]), graph.mul(off[2], right[1]));
            graph.sub(x, z)
        }
    };
    graph.sub(from, reached)
}

/// The first scene outside of the portal, the second one inside: planes that both share, the rest, and the material.
pub(super) fn through(
    graph: &mut Graph,
    (a, b): (&Side, &Side),
    shape: PortalShape,
    camera: &Camera,
    s: NodeId,
) -> (Vec<NodeId>, Option<Steps>, Vec<NodeId>) {
    let portal = portal(graph, shape, camera, s);
    // A plane of both goes through the portal as it is.
    let (planes, [a_rest, b_rest]) = if a.planes == b.planes {
        (a.planes.clone(), [a.rest, b.rest])
    } else {
        (Vec::new(), [a, b].map(|side| side.whole(graph)))
    };
    let outside = graph.neg(portal);
    let a_rest = a_rest.map(|steps| steps.map(|part| graph.max(part, outside)));
    let b_rest = b_rest.map(|steps| steps.map(|part| graph.max(part, portal)));
    let rest = match (a_rest, b_rest) {
        (Some(a), Some(b)) => Some([0, 1].map(|part| graph.min(a[part], b[part]))),
        (a, b) => a.or(b),
    };
    let zero = graph.constant(0.0);
    let is_inside = graph.binary(Op::Less, portal, zero);
    let numbers = a.material.iter().zip(&b.material);
    let material = numbers.map(|(&a, &b)| graph.select(is_inside, b, a)).collect();
    (planes, rest, material)
}
