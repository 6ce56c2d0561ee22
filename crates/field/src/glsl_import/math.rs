//! The functions of GLSL, as operators of the graph.

use std::ops::Range;

use naga::{Expression, Handle, MathFunction, ScalarKind};

use super::calls::{Argument, Executor};
use super::layout::Part;
use super::parse::Special;
use super::problem::{Problem, Result};
use crate::graph::{Graph, Node, NodeId, Op, matrices};

impl Executor<'_, '_> {
    pub(super) fn math(
        &mut self,
        of: MathFunction,
        first: Handle<Expression>,
        others: [Option<Handle<Expression>>; 3],
        place: &Range<u32>,
    ) -> Result<Vec<Part>> {
        let info = self.info(first)?;
        if matches!(info.kind, ScalarKind::Sint | ScalarKind::Uint)
            && let Some(parts) = self.whole_math(of, first, others, place)?
        {
            return Ok(parts);
        }
        let a = self.nodes_of(first)?;
        let mut rest: [Vec<NodeId>; 2] = [Vec::new(), Vec::new()];
        for (nodes, other) in rest.iter_mut().zip(others) {
            if let Some(other) = other {
                *nodes = self.nodes_of(other)?;
            }
        }
        let [b, c] = rest;
        self.step(a.len() * 4, || place.clone())?;
        if let Some(nodes) = whole_vectors(self.graph, of, &a, &b, &c, usize::from(info.rows)) {
            return Ok(nodes.into_iter().map(Part::Node).collect());
        }
        let parts = (0..a.len().max(b.len()).max(c.len())).map(|index| {
            let [a, b, c] = [&a, &b, &c].map(|list| match list.as_slice() {
                [one] => *one,
                list => list.get(index).copied().unwrap_or(self.zero),
            });
            component(self.graph, of, a, b, c).map(Part::Node).ok_or_else(|| {
                let message = format!("the function `{of:?}` has no meaning in a formula");
                Problem::unsupported(place.clone(), message)
            })
        });
        parts.collect()
    }

    /// Functions of constant whole numbers.
    fn whole_math(
        &mut self,
        of: MathFunction,
        first: Handle<Expression>,
        others: [Option<Handle<Expression>>; 3],
        place: &Range<u32>,
    ) -> Result<Option<Vec<Part>>> {
        let len = self.info(first)?.len as usize;
        let mut result = Vec::with_capacity(len);
        for index in 0..len {
            let mut values = [self.part(first, index)?; 3];
            for (value, other) in values.iter_mut().skip(1).zip(others) {
                if let Some(other) = other {
                    *value = self.part(other, index)?;
                }
            }
            let part = match (of, values) {
                (MathFunction::Abs, [Part::Int(a), ..]) => Part::Int(a.wrapping_abs()),
                (MathFunction::Sign, [Part::Int(a), ..]) => Part::Int(a.signum()),
                (MathFunction::Min, [Part::Int(a), Part::Int(b), _]) => Part::Int(a.min(b)),
                (MathFunction::Max, [Part::Int(a), Part::Int(b), _]) => Part::Int(a.max(b)),
                (MathFunction::Clamp, [Part::Int(a), Part::Int(b), Part::Int(c)]) => {
                    Part::Int(a.max(b).min(c))
                }
                (MathFunction::Min, [Part::Uint(a), Part::Uint(b), _]) => Part::Uint(a.min(b)),
                (MathFunction::Max, [Part::Uint(a), Part::Uint(b), _]) => Part::Uint(a.max(b)),
                (
                    MathFunction::Abs
                    | MathFunction::Sign
                    | MathFunction::Min
                    | MathFunction::Max
                    | MathFunction::Clamp
                    | MathFunction::Dot,
                    _,
                ) => return Ok(None),
                _ => return Err(super::operators::bits(place)),
            };
            result.push(part);
        }
        Ok(Some(result))
    }

    pub(super) fn texture(
        &mut self,
        special: Special,
        arguments: &[Argument],
        place: &Range<u32>,
    ) -> Result<Vec<Part>> {
        self.step(64, || place.clone())?;
        let Some(Argument::Parts(at)) = arguments.get(1) else { return Ok(Vec::new()) };
        let nodes = at.iter().map(|part| self.node(*part, place)).collect::<Result<Vec<_>>>()?;
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
                [noise; 4]
            }
            _ => return Err(picture()),
        };
        Ok(parts.map(Part::Node).to_vec())
    }
}

/// Functions that do not work on each component.
fn whole_vectors(
    graph: &mut Graph,
    of: MathFunction,
    a: &[NodeId],
    b: &[NodeId],
    c: &[NodeId],
    rows: usize,
) -> Option<Vec<NodeId>> {
    let (zero, one) = (graph.constant(0.0), graph.constant(1.0));
    Some(match (of, a, b) {
        (MathFunction::Dot, ..) => vec![graph.dot(a, b)],
        (MathFunction::Length, ..) => vec![graph.length(a)],
        (MathFunction::Distance, ..) => {
            let difference: Vec<NodeId> = a.iter().zip(b).map(|(&a, &b)| graph.sub(a, b)).collect();
            vec![graph.length(&difference)]
        }
        (MathFunction::Normalize, ..) => {
            let length = graph.length(a);
            a.iter().map(|&a| graph.div(a, length)).collect()
        }
        (MathFunction::Cross, &[ax, ay, az], &[bx, by, bz]) => {
            let mut minor = |a, d, b, c| {
                let (left, right) = (graph.mul(a, d), graph.mul(b, c));
                graph.sub(left, right)
            };
            vec![minor(ay, bz, az, by), minor(az, bx, ax, bz), minor(ax, by, ay, bx)]
        }
        (MathFunction::Reflect, ..) => {
            // a - 2 * dot(b, a) * b
            let dot = graph.dot(b, a);
            let twice = graph.add(dot, dot);
            moved(graph, a, b, twice)
        }
        (MathFunction::Refract, ..) => {
            let eta = c.first().copied().unwrap_or(one);
            let dot = graph.dot(b, a);
            let (dot_squared, eta_squared) = (graph.square(dot), graph.square(eta));
            let rest = graph.sub(one, dot_squared);
            let bent = graph.mul(eta_squared, rest);
            let k = graph.sub(one, bent);
            let (root, along) = (graph.sqrt(k), graph.mul(eta, dot));
            let factor = graph.add(along, root);
            let scaled: Vec<NodeId> = a.iter().map(|&a| graph.mul(eta, a)).collect();
            let refracted = moved(graph, &scaled, b, factor);
            let total = graph.binary(Op::Less, k, zero);
            refracted.into_iter().map(|node| graph.select(total, zero, node)).collect()
        }
        (MathFunction::FaceForward, ..) => {
            let dot = graph.dot(c, b);
            let towards = graph.binary(Op::Less, dot, zero);
            a.iter()
                .map(|&a| {
                    let negated = graph.neg(a);
                    graph.select(towards, a, negated)
                })
                .collect()
        }
        (MathFunction::Outer, ..) => {
            b.iter().flat_map(|&b| a.iter().map(move |&a| (a, b))).map(|(a, b)| graph.mul(a, b)).collect()
        }
        (MathFunction::Transpose, ..) => matrices::transposed(a, rows),
        (MathFunction::Determinant, ..) => vec![matrices::determinant(graph, a, rows)],
        (MathFunction::Inverse, ..) => matrices::inverse(graph, a, rows),
        _ => return None,
    })
}

/// a - factor * b
fn moved(graph: &mut Graph, a: &[NodeId], b: &[NodeId], factor: NodeId) -> Vec<NodeId> {
    let moved = a.iter().zip(b).map(|(&a, &b)| {
        let along = graph.mul(factor, b);
        graph.sub(a, along)
    });
    moved.collect()
}

/// Returns the operator of the graph with the same name.
fn same_operator(of: MathFunction) -> Option<Op> {
    macro_rules! same {
        ($($name:ident)+) => {
            match of {
                $(MathFunction::$name => Some(Op::$name),)+
                _ => None,
            }
        };
    }
    same! {
        Abs Min Max Cos Cosh Sin Sinh Tan Tanh Acos Asin Atan Atan2 Ceil Floor Round Fract Trunc Exp
        Exp2 Log Log2 Sign Step Sqrt
    }
}

fn component(graph: &mut Graph, of: MathFunction, a: NodeId, b: NodeId, c: NodeId) -> Option<NodeId> {
    let one = graph.constant(1.0);
    if let Some(op) = same_operator(of) {
        return Some(graph.binary(op, a, b));
    }
    Some(match of {
        MathFunction::Clamp => graph.clamp(a, b, c),
        MathFunction::Saturate => {
            let zero = graph.constant(0.0);
            graph.clamp(a, zero, one)
        }
        MathFunction::Pow => graph.pow(a, b),
        MathFunction::Mix => graph.mix(a, b, c),
        MathFunction::SmoothStep => graph.smoothstep(a, b, c),
        MathFunction::InverseSqrt => {
            let root = graph.sqrt(a);
            graph.div(one, root)
        }
        MathFunction::Fma => {
            let product = graph.mul(a, b);
            graph.add(product, c)
        }
        MathFunction::Radians => scaled(graph, a, std::f32::consts::PI / 180.0),
        MathFunction::Degrees => scaled(graph, a, 180.0 / std::f32::consts::PI),
        // asinh(a) = ln(a + sqrt(a² + 1)), acosh(a) = ln(a + sqrt(a² - 1)), atanh(a) = ln((1 + a) / (1 - a)) / 2
        MathFunction::Asinh | MathFunction::Acosh => {
            let squared = graph.square(a);
            let shifted =
                if of == MathFunction::Asinh { graph.add(squared, one) } else { graph.sub(squared, one) };
            let root = graph.sqrt(shifted);
            let sum = graph.add(a, root);
            graph.unary(Op::Log, sum)
        }
        MathFunction::Atanh => {
            let (above, below) = (graph.add(one, a), graph.sub(one, a));
            let ratio = graph.div(above, below);
            let logarithm = graph.unary(Op::Log, ratio);
            scaled(graph, logarithm, 0.5)
        }
        _ => return None,
    })
}

fn scaled(graph: &mut Graph, a: NodeId, factor: f32) -> NodeId {
    let factor = graph.constant(factor);
    graph.mul(a, factor)
}

// Reads of textures. Shapes cannot read images, but many shaders read a table of random numbers as a noise. Such a read
// becomes values of `cell_hash`, which are smoothed like the texels of a texture.
//
// The tables of Shadertoy have 256 by 256 texels, or 32 in each direction of space. A read of such a table scales the
// position by 1/256 or 1/32, which tells it from the read of a picture. The green channel is the red one moved by
// (37, 17), so that a common trick reads two layers of a noise in space at once.

/// Texels of the tables of noise, along one side.
const FLAT: f32 = 256.0;
const SOLID: f32 = 32.0;
/// Offset of the green channel to the red one.
const GREEN: [f32; 2] = [37.0, 17.0];

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
fn cell(graph: &mut Graph, x: NodeId, y: NodeId) -> [NodeId; 4] {
    std::array::from_fn(|channel| {
        let [dx, dy] = GREEN.map(|offset| graph.constant(offset * channel as f32));
        let (x, y) = (graph.sub(x, dx), graph.sub(y, dy));
        let (x, y) = (wrapped(graph, x, FLAT), wrapped(graph, y, FLAT));
        graph.binary(Op::Hash, x, y)
    })
}

/// The whole part and the fraction of a position, measured from the centres of texels.
fn split(graph: &mut Graph, x: NodeId) -> (NodeId, NodeId) {
    let half = graph.constant(0.5);
    let shifted = graph.sub(x, half);
    (graph.unary(Op::Floor, shifted), graph.unary(Op::Fract, shifted))
}

fn flat_noise(graph: &mut Graph, x: NodeId, y: NodeId) -> [NodeId; 4] {
    let one = graph.constant(1.0);
    let ((x, u), (y, v)) = (split(graph, x), split(graph, y));
    let (x1, y1) = (graph.add(x, one), graph.add(y, one));
    let corners = [(x, y), (x1, y), (x, y1), (x1, y1)].map(|(x, y)| cell(graph, x, y));
    std::array::from_fn(|channel| {
        let [a, b, c, d] = corners.map(|corner| corner[channel]);
        let (low, high) = (graph.mix(a, b, u), graph.mix(c, d, u));
        graph.mix(low, high, v)
    })
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
