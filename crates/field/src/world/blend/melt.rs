//! The melt: a union of two scenes in which the old solids shrink while the new ones grow.
//!
//! **Union.** A mixture (1-s)*a + s*b of two distances soon loses small objects, such as a heart in a tunnel. A melt
//! therefore shrinks the solids of both scenes and draws their union. The distance a becomes a + q*f(b), where f(b)
//! rises from 0 at the surfaces of b to 1 far away, and q grows without limit while the fraction of a falls to 0
//! ([`yielding`]). The old scene shrinks onto the surfaces of the new scene, and the new scene grows out of the old
//! one. q is proportional to the depth of the scene's solids ([`super::depth`]): at a fraction of 0.2 the solids have
//! lost half of their depth. Endless solids, such as the rock around a tunnel, become shells of the thickness
//! [`HOLLOW`], so that they vanish before the melt ends.
//!
//! **Slopes.** f has a slope of at most 1 / [`REACH`], so (a + q*f(b)) / (1 + q/[`REACH`]) has a slope of at most 1.
//! The maximum of this quotient and a has the same surfaces, and allows longer steps far from surfaces. Solids are at
//! most half of [`HOLLOW`] deep, so the scene is empty beyond some distance x from b, where q*f(b) exceeds that depth.
//! The distance is therefore at least b - x, so rays are as fast as in b alone once a has vanished.
//!
//! **Materials.** A point has the material of the nearer surface. Where surfaces meet, materials mix over [`SEAM`].
//! Near the start and the end of the melt, one scene is a thin film on the other scene. Materials therefore fade during
//! the first and last [`BEGIN`] of the fraction.

use super::depth;
use super::side::{self, Side, Steps};
use crate::graph::{Graph, NodeId, Op};
use crate::world::PLANES_MAX;

/// Thickness of the shell of a hollow solid.
pub(super) const HOLLOW: f32 = 3.0;

/// Distance from the other scene's surfaces at which f is 1/2.
const REACH: f32 = 4.0;

/// Half the width of a seam between materials, as a difference of the two distances.
const SEAM: f32 = 0.3;

/// Fraction at which the new scene's materials are complete.
const BEGIN: f32 = 0.2;

const LEAST: f32 = 1e-6;

pub(super) struct Melt {
    pub(super) planes: Vec<NodeId>,
    pub(super) rest: Option<Steps>,
    /// The weight of the second side's material.
    pub(super) owner: NodeId,
    /// The least haze that the material has. It makes planes of only one side fade into the sky.
    pub(super) haze: NodeId,
}

/// Returns the melt of two sides. If both have planes, each pair becomes a plane in between. If only one side has
/// planes, they recede and fade into the sky.
pub(super) fn melt(graph: &mut Graph, a: &Side, b: &Side, s: NodeId) -> Melt {
    let remaining = graph.sub(1.0, s);
    let lost_a = lost(graph, depth::of(graph, a), [s, remaining]);
    let lost_b = lost(graph, depth::of(graph, b), [remaining, s]);
    let pairs = a.planes.len() * b.planes.len();
    let are_traced = pairs > PLANES_MAX;
    let mut planes = Vec::new();
    let (mut owner_of_planes, mut haze) = (s, graph.constant(0.0));
    if pairs == 0 {
        let (alone, lost, fraction) = match b.planes.is_empty() {
            true => (a, lost_a, s),
            false => (b, lost_b, remaining),
        };
        planes.extend(alone.planes.iter().map(|plane| graph.add(*plane, lost)));
        owner_of_planes = graph.constant(if b.planes.is_empty() { 0.0 } else { 1.0 });
        haze = graph.square(fraction);
    } else if !are_traced {
        for &a in &a.planes {
            planes.extend(b.planes.iter().map(|b| graph.mix(a, *b, s)));
        }
    }
    let [all_a, all_b] = [a, b].map(|side| side.whole(graph));
    let [own_a, own_b] = if are_traced { [all_a, all_b] } else { [a.rest, b.rest] };
    let left = own_a.map(|own| yielding(graph, own, all_b, lost_a));
    let right = own_b.map(|own| yielding(graph, own, all_a, lost_b));
    let rest = side::nearer(graph, left.map(|left| left.steps), right.map(|right| right.steps));
    let offset = [left, right].map(|side| side.map(|side| side.offset));
    let [owner, haze] = owner(graph, &planes, owner_of_planes, haze, offset, s);
    Melt { planes, rest, owner, haze }
}

/// Returns the depth q that solids lose far from the other side. The last argument is the fraction of the other side,
/// then the fraction of the solids' own side.
fn lost(graph: &mut Graph, depth: f32, [other_fraction, own_fraction]: [NodeId; 2]) -> NodeId {
    // If the solids' own fraction is 0.2, q is half of the depth.
    graph.mul(other_fraction / Op::Max.pair(own_fraction, LEAST), 0.125 * depth)
}

#[derive(Clone, Copy)]
struct Yielding {
    steps: Steps,
    /// The estimate before it is turned into a distance.
    offset: NodeId,
}

fn yielding(graph: &mut Graph, own: Steps, other: Option<Steps>, lost: NodeId) -> Yielding {
    let last = farthest(graph, lost);
    let slope = graph.add(lost / REACH, 1.0);
    let parts = [0, 1].map(|part| {
        let value = hollow(graph, own[part]);
        // This is x / (x + reach), in a form whose interval bounds are exact.
        let Some(other) = other else {
            let offset = graph.add(value, lost);
            return [offset, offset];
        };
        let away = graph.max(other[part], 0.0);
        let offset = graph.add(value, lost * (1.0 - REACH / (away + REACH)));
        let distance = graph.max(offset / slope, other[part] - last);
        [graph.max(value, distance), offset]
    });
    Yielding { steps: parts.map(|part| part[0]), offset: parts[1][1] }
}

/// Returns the distance from the other side beyond which no solids are left, if remote solids lose the depth `lost`.
fn farthest(graph: &mut Graph, lost: NodeId) -> NodeId {
    let kept = graph.div(0.5 * HOLLOW, Op::Max.pair(lost, LEAST));
    graph.div(kept * REACH, Op::Max.pair(1.0 - kept, LEAST))
}

fn hollow(graph: &mut Graph, value: NodeId) -> NodeId {
    graph.max(value, -HOLLOW - value)
}

/// Computes [`Melt::owner`] and [`Melt::haze`]. The tuple holds the planes, and the owner and haze of points on them.
fn owner(
    graph: &mut Graph,
    planes: &[NodeId],
    owner_of_planes: NodeId,
    haze: NodeId,
    offset: [Option<NodeId>; 2],
    s: NodeId,
) -> [NodeId; 2] {
    let away = offset.map(|offset| offset.unwrap_or_else(|| graph.constant(f32::MAX)));
    let across = (away[0] - away[1]) * (0.5 / SEAM) + 0.5;
    let mut nearer = graph.clamp(across, 0.0, 1.0);
    let mut own_haze = graph.constant(0.0);
    if let Some(plane) = planes.iter().copied().reduce(|a, b| graph.min(a, b)) {
        let solid = Op::Abs.of(Op::Min.pair(away[0], away[1]));
        let is_plane = graph.binary(Op::Less, Op::Abs.of(plane), solid);
        nearer = graph.select(is_plane, owner_of_planes, nearer);
        own_haze = graph.select(is_plane, haze, 0.0);
    }
    // Near the start and the end of the melt, limit the weight in proportion to the fraction.
    let come = graph.mul(s, 1.0 / BEGIN);
    let nearer = graph.max(nearer, 1.0 - (1.0 - s) * (1.0 / BEGIN));
    [graph.min(nearer, come), own_haze]
}
