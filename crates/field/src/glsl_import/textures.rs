//! Reads of textures. Shapes cannot read images, but many shaders read a table of random numbers as a noise. Such a read
//! becomes values of `cell_hash`, which are smoothed like the texels of a texture.
//!
//! The tables of Shadertoy have 256 by 256 texels, or 32 in each direction of space. A read of such a table scales the
//! position by 1/256 or 1/32, which tells it from the read of a picture. The green channel is the red one moved by
//! (37, 17), so that a common trick reads two layers of a noise in space at once.

use std::ops::Range;

use super::calls::{Argument, Executor};
use super::layout::Part;
use super::parse::Special;
use super::problem::Problem;
use crate::graph::{Graph, Node, NodeId, Op};

/// Texels of the tables of noise, along one side.
const FLAT: f32 = 256.0;
const SOLID: f32 = 32.0;
/// Offset of the green channel to the red one.
const GREEN: [f32; 2] = [37.0, 17.0];

impl Executor<'_, '_> {
    pub(super) fn texture(
        &mut self,
        special: Special,
        arguments: &[Argument],
        place: &Range<u32>,
    ) -> Result<Vec<Part>, Problem> {
        self.step(64, || place.clone())?;
        let Some(Argument::Parts(at)) = arguments.get(1) else { return Ok(Vec::new()) };
        let mut nodes = Vec::with_capacity(at.len());
        for part in at {
            nodes.push(self.node(*part, place)?);
        }
        let picture = || {
            Problem::unsupported(place.clone(), "a shape cannot read a picture")
                .hint("a read of noise scales the position by 1/256; otherwise use `noise`, or return a number instead")
        };
        let parts = match (special, nodes.as_slice()) {
            (Special::TextureSize, _) => {
                let size = self.graph.constant(FLAT);
                return Ok(vec![Part::Node(size); 2]);
            }
            (Special::Texel, &[x, y, ..]) => cell(self.graph, x, y),
            (_, &[u, v]) => {
                let [x, y] = [u, v].map(|node| unscaled(self.graph, node, FLAT));
                let (x, y) = match (x, y) {
                    (Some(x), Some(y)) => (x, y),
                    (Some(x), None) => (x, scaled_constant(self.graph, v, FLAT).ok_or_else(picture)?),
                    (None, Some(y)) => (scaled_constant(self.graph, u, FLAT).ok_or_else(picture)?, y),
                    (None, None) => return Err(picture()),
                };
                flat_noise(self.graph, x, y)
            }
            (_, &[u, v, w]) => {
                let cells = [u, v, w].map(|node| unscaled(self.graph, node, SOLID));
                let [Some(x), Some(y), Some(z)] = cells else { return Err(picture()) };
                let noise = solid_noise(self.graph, [x, y, z]);
                vec![noise; 4]
            }
            _ => return Err(picture()),
        };
        Ok(parts.into_iter().map(Part::Node).collect())
    }
}

/// Returns x if the node is x divided by the size of a table of noise.
fn unscaled(graph: &mut Graph, node: NodeId, size: f32) -> Option<NodeId> {
    let Node::Binary(op, a, b) = graph.node(node) else { return None };
    let factor = graph.as_constant(b)?;
    let near = |wanted: f32| (factor / wanted - 1.0).abs() < 0.01;
    match op {
        Op::Mul if near(size.recip()) => Some(a),
        Op::Div if near(size) => Some(a),
        _ => None,
    }
}

fn scaled_constant(graph: &mut Graph, node: NodeId, size: f32) -> Option<NodeId> {
    let value = graph.as_constant(node)?;
    Some(graph.constant(value * size))
}

fn wrapped(graph: &mut Graph, a: NodeId, size: f32) -> NodeId {
    let size = graph.constant(size);
    graph.binary(Op::Mod, a, size)
}

/// The four channels of a texel.
fn cell(graph: &mut Graph, x: NodeId, y: NodeId) -> Vec<NodeId> {
    let mut channels = Vec::new();
    for channel in 0..4 {
        let [dx, dy] = GREEN.map(|offset| graph.constant(offset * channel as f32));
        let (x, y) = (graph.sub(x, dx), graph.sub(y, dy));
        let (x, y) = (wrapped(graph, x, FLAT), wrapped(graph, y, FLAT));
        channels.push(graph.binary(Op::Hash, x, y));
    }
    channels
}

/// The whole part and the fraction of a position, measured from the centres of texels.
fn split(graph: &mut Graph, x: NodeId) -> (NodeId, NodeId) {
    let half = graph.constant(0.5);
    let shifted = graph.sub(x, half);
    (graph.unary(Op::Floor, shifted), graph.unary(Op::Fract, shifted))
}

fn flat_noise(graph: &mut Graph, x: NodeId, y: NodeId) -> Vec<NodeId> {
    let one = graph.constant(1.0);
    let ((x, u), (y, v)) = (split(graph, x), split(graph, y));
    let (x1, y1) = (graph.add(x, one), graph.add(y, one));
    let corners = [(x, y), (x1, y), (x, y1), (x1, y1)].map(|(x, y)| cell(graph, x, y));
    let mut channels = Vec::new();
    for channel in 0..4 {
        let zero = graph.constant(0.0);
        let [a, b, c, d] = [0, 1, 2, 3].map(|corner: usize| {
            corners.get(corner).and_then(|cell| cell.get(channel)).copied().unwrap_or(zero)
        });
        let (low, high) = (graph.mix(a, b, u), graph.mix(c, d, u));
        channels.push(graph.mix(low, high, v));
    }
    channels
}

fn solid_noise(graph: &mut Graph, at: [NodeId; 3]) -> NodeId {
    let (zero, one) = (graph.constant(0.0), graph.constant(1.0));
    let parts = at.map(|x| split(graph, x));
    let mut values = Vec::new();
    for corner in 0..8_usize {
        let mut cell = [zero; 3];
        for (axis, (slot, (whole, _))) in cell.iter_mut().zip(parts).enumerate() {
            let moved = if corner >> axis & 1 == 1 { graph.add(whole, one) } else { whole };
            *slot = wrapped(graph, moved, SOLID);
        }
        let [x, y, z] = cell;
        let first = graph.binary(Op::Hash, x, y);
        let many = graph.constant(16_777_216.0);
        let row = graph.mul(first, many);
        values.push(graph.binary(Op::Hash, row, z));
    }
    for (_, fraction) in parts {
        let halves: Vec<NodeId> = values
            .chunks(2)
            .map(|pair| match pair {
                [low, high] => graph.mix(*low, *high, fraction),
                _ => zero,
            })
            .collect();
        values = halves;
    }
    values.first().copied().unwrap_or(zero)
}
