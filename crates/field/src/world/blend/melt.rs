//! The mixture of two fields, made such that rays get through it.
//!
//! **Why no solid is deep.** `(1-s)*a + s*b` never changes faster than a distance. But deep in a solid of one side and far
//! from those of the other, one value falls as the other rises: the mixture hardly changes, rays creep, and its surfaces
//! are cones without end. So values inside of solids fall no lower than -[`DEEPEST`]. What goes on without end, the rock
//! around a tunnel or all that is behind a wall, is hollow from the depth [`HOLLOW`] on: else it would lie over the other
//! scene as a slab up to the horizon.
//!
//! **Why steps are long.** Where nothing is lower than -[`DEEPEST`], the mixture has its surfaces where `a` is at most
//! `DEEPEST * s/(1-s)`, and likewise `b`. So `a` less that much is a distance that no surface is nearer than, and it is
//! larger than the mixture far from `a`. The largest of all three has the mixture's surfaces and its slope of at most 1.

use super::Steps;
use super::side::Side;
use crate::graph::{Graph, NodeId};
use crate::world::PLANES_MAX;

/// No value is lower inside of a solid.
pub(super) const DEEPEST: f32 = 0.5;

/// So deep in a solid values are 0 again, and rise.
const HOLLOW: f32 = 3.0;

/// A share next to 0, which may be divided by.
const LEAST: f32 = 1e-6;

/// The mixture of two sides: planes that are solved, and the rest.
///
/// A mixture of two minima is the least of all mixtures of their operands. So planes of both scenes stay planes, and
/// what is left to be traced is far above them.
pub(super) fn melt(graph: &mut Graph, a: &Side, b: &Side, s: NodeId) -> (Vec<NodeId>, Option<Steps>) {
    let mixture = Mixture::of(graph, s);
    let pairs = a.planes.len() * b.planes.len();
    if pairs == 0 || pairs > PLANES_MAX {
        let (Some(a), Some(b)) = (a.whole(graph), b.whole(graph)) else { return (Vec::new(), None) };
        return (Vec::new(), Some(mixture.steps(graph, a, b)));
    }
    let mut planes = Vec::with_capacity(pairs);
    for &a in &a.planes {
        for &b in &b.planes {
            planes.push(graph.mix(a, b, s));
        }
    }
    let (all_a, all_b) = (a.whole(graph), b.whole(graph));
    let left = all_a.zip(b.rest).map(|(a, b)| mixture.steps(graph, a, b));
    let right = a.rest.zip(all_b).map(|(a, b)| mixture.steps(graph, a, b));
    let rest = match (left, right) {
        (Some(a), Some(b)) => Some([0, 1].map(|part| graph.min(a[part], b[part]))),
        (a, b) => a.or(b),
    };
    (planes, rest)
}

/// How values are mixed.
struct Mixture {
    share: NodeId,
    /// How far from the surfaces of each side those of the mixture may be.
    reaches: [NodeId; 2],
}

impl Mixture {
    fn of(graph: &mut Graph, share: NodeId) -> Self {
        let [one, least, deepest] = [1.0, LEAST, DEEPEST].map(|number| graph.constant(number));
        let rest = graph.sub(one, share);
        let reaches = [(share, rest), (rest, share)].map(|(other, own)| {
            let own = graph.max(own, least);
            let ratio = graph.div(other, own);
            graph.mul(ratio, deepest)
        });
        Self { share, reaches }
    }

    fn steps(&self, graph: &mut Graph, a: Steps, b: Steps) -> Steps {
        [0, 1].map(|part| {
            let sides = [a[part], b[part]].map(|value| shallow(graph, value));
            let mixed = graph.mix(sides[0], sides[1], self.share);
            sides.into_iter().zip(self.reaches).fold(mixed, |most, (value, reach)| {
                let beyond = graph.sub(value, reach);
                graph.max(most, beyond)
            })
        })
    }
}

/// The value with solids that are not deep, and hollow farther in.
fn shallow(graph: &mut Graph, value: NodeId) -> NodeId {
    let [deepest, hollow] = [-DEEPEST, -HOLLOW].map(|number| graph.constant(number));
    let farther_in = graph.sub(hollow, value);
    let limited = graph.max(value, deepest);
    graph.max(limited, farther_in)
}
