//! The functions of GLSL, as operators of the graph.

use naga::{MathFunction, ScalarKind};

use super::Result;
use super::calls::Executor;
use super::layout::{ExprId, Part};
use crate::graph::{Graph, NodeId, Op, matrices};
use crate::lang::Diagnostic;

impl Executor<'_, '_> {
    pub(super) fn math(
        &mut self,
        of: MathFunction,
        first: ExprId,
        others: [Option<ExprId>; 3],
    ) -> Result<Vec<Part>> {
        let info = self.info(first)?;
        if matches!(info.kind, ScalarKind::Sint | ScalarKind::Uint)
            && let Some(parts) = self.whole_math(of, first, others)?
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
        self.step(a.len() * 4)?;
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
                Diagnostic::unsupported(self.here, message)
            })
        });
        parts.collect()
    }

    /// Functions of constant whole numbers.
    fn whole_math(
        &mut self,
        of: MathFunction,
        first: ExprId,
        others: [Option<ExprId>; 3],
    ) -> Result<Option<Vec<Part>>> {
        use MathFunction::{Abs, Clamp, Dot, Max, Min, Sign};
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
                (Abs, [Part::Int(a), ..]) => Part::Int(a.wrapping_abs()),
                (Sign, [Part::Int(a), ..]) => Part::Int(a.signum()),
                (Min, [Part::Int(a), Part::Int(b), _]) => Part::Int(a.min(b)),
                (Max, [Part::Int(a), Part::Int(b), _]) => Part::Int(a.max(b)),
                (Clamp, [Part::Int(a), Part::Int(b), Part::Int(c)]) => Part::Int(a.max(b).min(c)),
                (Min, [Part::Uint(a), Part::Uint(b), _]) => Part::Uint(a.min(b)),
                (Max, [Part::Uint(a), Part::Uint(b), _]) => Part::Uint(a.max(b)),
                (Abs | Sign | Min | Max | Clamp | Dot, _) => return Ok(None),
                _ => return Err(super::operators::bits(self.here)),
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
            let mut minor = |a: NodeId, d: NodeId, b: NodeId, c: NodeId| graph.sub(a * d, b * c);
            vec![minor(ay, bz, az, by), minor(az, bx, ax, bz), minor(ax, by, ay, bx)]
        }
        (MathFunction::Reflect, ..) => {
            // a - 2 * dot(b, a) * b
            let dot = graph.dot(b, a);
            let twice = graph.add(dot, dot);
            moved(graph, a, b, twice)
        }
        (MathFunction::Refract, ..) => {
            let &eta = c.first()?;
            let dot = graph.dot(b, a);
            let (dot_squared, eta_squared) = (graph.square(dot), graph.square(eta));
            let k = graph.sub(1.0, eta_squared * (1.0 - dot_squared));
            let root = graph.sqrt(k);
            let factor = graph.add(eta * dot, root);
            let scaled: Vec<NodeId> = a.iter().map(|&a| graph.mul(eta, a)).collect();
            let refracted = moved(graph, &scaled, b, factor).into_iter();
            refracted.map(|node| graph.select(Op::Less.pair(k, 0.0), 0.0, node)).collect()
        }
        (MathFunction::FaceForward, ..) => {
            let dot = graph.dot(c, b);
            a.iter().map(|&a| graph.select(Op::Less.pair(dot, 0.0), a, Op::Neg.of(a))).collect()
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
    a.iter().zip(b).map(|(&a, &b)| graph.sub(a, factor * b)).collect()
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
    if let Some(op) = same_operator(of) {
        return Some(graph.binary(op, a, b));
    }
    Some(match of {
        MathFunction::Clamp => graph.clamp(a, b, c),
        MathFunction::Saturate => graph.clamp(a, 0.0, 1.0),
        MathFunction::Pow => graph.pow(a, b),
        MathFunction::Mix => graph.mix(a, b, c),
        MathFunction::SmoothStep => graph.smoothstep(a, b, c),
        MathFunction::InverseSqrt => graph.div(1.0, Op::Sqrt.of(a)),
        MathFunction::Fma => graph.add(a * b, c),
        MathFunction::Radians => graph.mul(a, std::f32::consts::PI / 180.0),
        MathFunction::Degrees => graph.mul(a, 180.0 / std::f32::consts::PI),
        // asinh(a) = ln(a + sqrt(a² + 1)), acosh(a) = ln(a + sqrt(a² - 1)), atanh(a) = ln((1 + a) / (1 - a)) / 2
        MathFunction::Asinh => graph.unary(Op::Log, a + Op::Sqrt.of(Op::Square.of(a) + 1.0)),
        MathFunction::Acosh => graph.unary(Op::Log, a + Op::Sqrt.of(Op::Square.of(a) - 1.0)),
        MathFunction::Atanh => graph.mul(Op::Log.of((1.0 + a) / (1.0 - a)), 0.5),
        _ => return None,
    })
}
