//! Portals: the second scene is inside a shape and the first scene is outside, by exact constructive solid geometry.
//!
//! **Sides.** Surfaces and their materials belong to a side. Lights, sky and glow are mixed by the fraction instead,
//! because a light that shines on one side only would need the side at every step of its shadow rays. Where the portal
//! cuts through a solid, the cut has the material of the side whose surface is nearer.

use super::alignment::Vector;
use super::side::{self, Before, Side, Steps};
use crate::graph::{Graph, NodeId, Op};
use crate::lang::{Camera, Scene};

/// The shape in which the second scene appears.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub enum PortalShape {
    /// A ball around the camera's target that grows beyond the scene.
    #[default]
    Ball,
    /// The half space to the left of a plane. The plane is parallel to the line of sight and moves to the right.
    Plane,
    /// The shape in the second scene's block `about`, which grows around the camera's target. A ball if it has none.
    Own,
}

/// A portal stops growing when this fraction of the transition is left. By then all surfaces are inside the portal.
const LEFT_MIN: f32 = 1e-3;
/// Fraction of a transition in which a scene's shape emerges, and in which the shape is filled up at the end.
const QUARTER: f32 = 0.25;

struct Seen {
    off: Vector,
    right: Vector,
    view: Vector,
    length: NodeId,
}

impl Seen {
    fn by(graph: &mut Graph, camera: &Camera) -> Self {
        let p = side::position(graph);
        let off = [0, 1, 2].map(|axis| graph.sub(p[axis], camera.target[axis]));
        let view = [0, 1, 2].map(|axis| graph.sub(camera.target[axis], camera.position[axis]));
        let length = graph.length(&view);
        let level = graph.length(&[view[0], view[2]]);
        // If the camera looks straight down, its right side is arbitrary.
        let level = graph.max(level, LEFT_MIN);
        let (zero, left) = (graph.constant(0.0), graph.neg(view[0]));
        let right = [graph.div(view[2], level), zero, graph.div(left, level)];
        Self { off, right, view, length }
    }

    /// Returns the coordinates of the point along the directions right, up and towards the eye.
    fn point(&self, graph: &mut Graph) -> Vector {
        let length = graph.max(self.length, LEFT_MIN);
        let back = self.view.map(|part| graph.neg(part / length));
        let [rx, ry, rz] = self.right;
        let [bx, by, bz] = back;
        let mut cross = |[a, b]: [NodeId; 2], [c, d]: [NodeId; 2]| graph.sub(a * d, b * c);
        let up = [cross([ry, rz], [by, bz]), cross([rz, rx], [bz, bx]), cross([rx, ry], [bx, by])];
        [self.right, up, back].map(|axis| graph.dot(&self.off, &axis))
    }
}

/// Returns the portal's relative size, which grows from 0 at the fraction 0 to beyond the scene at the fraction 1.
fn growth(graph: &mut Graph, fraction: NodeId) -> NodeId {
    graph.div(fraction, Op::Max.pair(1.0 - fraction, LEFT_MIN))
}

fn ball(graph: &mut Graph, seen: &Seen, fraction: NodeId) -> NodeId {
    let (grown, from) = (growth(graph, fraction), graph.length(&seen.off));
    graph.sub(from, grown * seen.length)
}

fn half_space(graph: &mut Graph, seen: &Seen, fraction: NodeId) -> NodeId {
    let (begun, rest) = (graph.max(fraction, LEFT_MIN), graph.max(1.0 - fraction, LEFT_MIN));
    let from = graph.dot(&seen.off, &seen.right);
    graph.sub(from, (1.0 / rest - 1.0 / begun) * seen.length)
}

/// Returns the distance to the scene's own shape, which grows with the fraction `s`. The shape may have holes and may
/// be infinite. A growing ball therefore reveals the shape in the first quarter, and another ball fills the shape in
/// the last quarter.
fn own_shape(
    graph: &mut Graph,
    seen: &Seen,
    scene: &Scene,
    shape: NodeId,
    before: Before,
    s: NodeId,
) -> NodeId {
    let grown = growth(graph, s);
    let size = graph.max(Op::Max.pair(grown, LEFT_MIN) * seen.length, LEFT_MIN);
    let point = seen.point(graph).map(|part| graph.div(part, size));
    let value = side::copied_at(graph, &scene.graph, shape, before, point);
    let value = graph.mul(value, size);
    let filled = 1.0 - (1.0 - s) * (1.0 / QUARTER);
    let (out, filled) = (graph.min(s * (1.0 / QUARTER), 1.0), graph.max(filled, 0.0));
    let (out, filled) = (ball(graph, seen, out), ball(graph, seen, filled));
    let value = graph.max(value, out);
    graph.min(value, filled)
}

/// Returns the distance to the portal, negative inside. At the middle of the transition, the size of the portal is the
/// distance from the eye to the target. Towards the end the portal grows without limit. `to` is the second scene, and
/// `before` counts the images and parameters of the first scene, which precede its own.
pub(super) fn distance(
    graph: &mut Graph,
    shape: PortalShape,
    to: &Scene,
    before: Before,
    camera: &Camera,
    s: NodeId,
) -> NodeId {
    let seen = Seen::by(graph, camera);
    match (shape, to.about.portal) {
        (PortalShape::Own, Some(shape)) => own_shape(graph, &seen, to, shape, before, s),
        (PortalShape::Plane, _) => half_space(graph, &seen, s),
        (PortalShape::Ball | PortalShape::Own, _) => ball(graph, &seen, s),
    }
}

/// Planes, other surfaces, and the values of the material.
type Through = (Vec<NodeId>, Option<Steps>, Vec<NodeId>);

/// Puts the first scene outside of the portal and the second one inside.
pub(super) fn through(graph: &mut Graph, a: &Side, b: &Side, portal: NodeId) -> Through {
    // Planes that both scenes have in common stay planes.
    let (planes, [a_rest, b_rest]) = if a.planes == b.planes {
        (a.planes.clone(), [a.rest, b.rest])
    } else {
        (Vec::new(), [a, b].map(|side| side.whole(graph)))
    };
    let outside = graph.neg(portal);
    let a_rest = a_rest.map(|steps| steps.map(|part| graph.max(part, outside)));
    let b_rest = b_rest.map(|steps| steps.map(|part| graph.max(part, portal)));
    let rest = side::nearer(graph, a_rest, b_rest);
    // Do not use the sign of the portal's distance: at a cut surface it depends on rounding.
    let [a_near, b_near] = [(a, outside), (b, portal)].map(|(side, portal)| match side.whole(graph) {
        Some([_, estimate]) => graph.max(estimate, portal),
        None => graph.constant(f32::MAX),
    });
    let is_second = graph.binary(Op::Less, b_near, a_near);
    let numbers = a.material.iter().zip(&b.material);
    let material = numbers.map(|(&a, &b)| graph.select(is_second, b, a)).collect();
    (planes, rest, material)
}
