//! The functions of GLSL, as operators of the graph.

use naga::{Expression, Handle, MathFunction, ScalarKind};

use super::Result;
use super::calls::Executor;
use super::layout::Part;
use crate::graph::{Graph, NodeId, Op, matrices};
use crate::lang::{Diagnostic, Span};

impl Executor<'_, '_> {
    pub(super) fn math(
        &mut self,
        of: MathFunction,
        first: Handle<Expression>,
        others: [Option<Handle<Expression>>; 3],
        place: Span,
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
        self.step(a.len() * 4, || place)?;
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
                Diagnostic::unsupported(place, message)
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
        place: Span,
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

/// The remainder of a division by `size`, 0..size.
pub(super) fn wrapped(graph: &mut Graph, a: NodeId, size: f32) -> NodeId {
    let size = graph.constant(size);
    graph.binary(Op::Mod, a, size)
}

fn scaled(graph: &mut Graph, a: NodeId, factor: f32) -> NodeId {
    let factor = graph.constant(factor);
    graph.mul(a, factor)
}
