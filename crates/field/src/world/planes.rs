//! Splits a scene into planes, which rays hit exactly, and the rest, which is traced.
//!
//! A part of an object's union is taken out of the scene if it is `a*x + b*y + c*z + d` with numbers that are constant
//! within a frame. Up to four parts are taken out. A ray then finds a floor by one division instead of many steps along
//! it. Without the floor, the scene often has bounds.

use std::collections::HashSet;

use crate::graph::{Graph, Input, Node, NodeId, Op};
use crate::lang::Scene;
use crate::rays::WITHOUT_GLASS;

/// Maximum number of planes that are taken out of a scene. Further planes are traced like other shapes.
pub const PLANES_MAX: usize = 4;

/// A part of an object's shape that is a plane: `a*x + b*y + c*z + d` with numbers that are constant within a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Plane {
    /// The part of the shape.
    pub shape: NodeId,
    /// Index of the object.
    pub object: usize,
}

/// All surfaces that are not planes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rest {
    /// The length of a ray's step.
    pub bound: NodeId,
    /// The distance to an actual surface, for penumbras and occlusion.
    pub estimate: NodeId,
    /// The number of the object that has this actual surface.
    pub object: NodeId,
}

/// The dependence of an expression on the point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Shape {
    Constant,
    Affine,
    Other,
}

/// Takes the planes out of a scene's shapes. The shape of an object with a `bound` stays whole.
pub(super) fn split(scene: &mut Scene) -> (Vec<Plane>, Option<Rest>) {
    let shapes: Vec<NodeId> = scene.objects.iter().map(|object| object.shape).collect();
    let kinds = kinds(&scene.graph, &shapes);
    let mut planes = Vec::new();
    let mut rest: Vec<Solid> = Vec::new();
    for (index, object) in scene.objects.iter().enumerate() {
        let glass = scene.materials.get(object.material).map(|material| material.glass);
        let away = glass.and_then(|glass| away_of(&mut scene.graph, glass));
        if let Some(bound) = object.bound {
            rest.push(Solid { object: index, shape: object.shape, bound: Some(bound), away });
            continue;
        }
        let mut others = Vec::new();
        for part in operands_of_minimum(&scene.graph, object.shape) {
            if planes.len() < PLANES_MAX && kinds.get(part.index()) == Some(&Shape::Affine) {
                planes.push(Plane { shape: part, object: index });
            } else {
                others.push(part);
            }
        }
        let graph = &mut scene.graph;
        if let Some(shape) = others.into_iter().reduce(|a, b| graph.min(a, b)) {
            rest.push(Solid { object: index, shape, bound: None, away });
        }
    }
    let graph = &mut scene.graph;
    (planes, combine(graph, &rest))
}

struct Solid {
    object: usize,
    shape: NodeId,
    bound: Option<NodeId>,
    /// The distance by which the penumbra moves an object of glass away; `None` for other objects.
    away: Option<NodeId>,
}

impl Solid {
    /// The shape; glass is moved away.
    fn moved(&self, graph: &mut Graph) -> NodeId {
        self.away.map_or(self.shape, |away| graph.add(self.shape, away))
    }
}

/// Returns the distance by which the penumbra moves glass away from rays. Rays to lights pass glass whose material is
/// the same everywhere. With [`WITHOUT_GLASS`], all glass is away.
fn away_of(graph: &mut Graph, glass: NodeId) -> Option<NodeId> {
    if graph.as_constant(glass).is_some_and(|glass| glass <= 0.0) {
        return None;
    }
    let used = graph.inputs_used(&[glass]);
    let is_fixed = used.textures.is_empty() && used.inputs.iter().all(|input| input.of_point().is_none());
    let penumbra = graph.input(Input::NX);
    Some(if is_fixed {
        graph.mul(penumbra, CLEAR_OF_SHADOWS * glass)
    } else {
        graph.max(penumbra - 0.1 * WITHOUT_GLASS, 0.0)
    })
}

/// The distance of glass grows by this multiple of the penumbra, so that rays to lights pass through it.
const CLEAR_OF_SHADOWS: f32 = 1e6;

/// Returns the union of `parts`.
///
/// Beyond `bound` a shape's value is the distance to the wrong surface, which would tear a penumbra. Beyond the bound,
/// the estimate therefore grows until it casts no shadow. The growth is gradual, so that no edge is visible.
fn combine(graph: &mut Graph, parts: &[Solid]) -> Option<Rest> {
    let penumbra = graph.input(Input::NX);
    let (first, others) = parts.split_first()?;
    let mut object = graph.constant(first.object as f32);
    let mut nearest = first.moved(graph);
    for part in others {
        let shape = part.moved(graph);
        let closer = graph.binary(Op::Less, shape, nearest);
        object = graph.select(closer, part.object as f32, object);
        nearest = graph.min(nearest, shape);
    }
    let (mut bound, mut estimate): (Option<NodeId>, Option<NodeId>) = (None, None);
    for part in parts {
        let shape = part.moved(graph);
        let mut trusted = shape;
        let mut step = shape;
        if let Some(left_out) = part.bound {
            let growth = graph.max(1.0, penumbra / left_out);
            trusted = graph.mul(shape, growth);
            step = graph.min(shape, left_out);
        }
        bound = Some(bound.map_or(step, |bound| graph.min(bound, step)));
        estimate = Some(estimate.map_or(trusted, |estimate| graph.min(estimate, trusted)));
    }
    Some(Rest { bound: bound?, estimate: estimate?, object })
}

/// Returns the operands of nested minima, from left to right, without duplicates.
fn operands_of_minimum(graph: &Graph, root: NodeId) -> Vec<NodeId> {
    let mut operands = Vec::new();
    let mut seen = HashSet::new();
    let mut stack = vec![root];
    while let Some(id) = stack.pop() {
        if !seen.insert(id) {
            continue;
        }
        match graph.node(id) {
            Node::Binary(Op::Min, a, b) => stack.extend([b, a]),
            _ => operands.push(id),
        }
    }
    operands
}

/// For each node below the roots, its dependence on the point. Indexed by node.
fn kinds(graph: &Graph, roots: &[NodeId]) -> Vec<Shape> {
    let mut kinds = vec![Shape::Other; graph.len()];
    for id in graph.order(roots) {
        let kind = match graph.node(id) {
            Node::Constant(_) => Shape::Constant,
            Node::Input(Input::X | Input::Y | Input::Z) => Shape::Affine,
            Node::Input(input) if input.of_point().is_none() => Shape::Constant,
            Node::Input(_) | Node::Texture { .. } => Shape::Other,
            Node::Unary(op, a) => match (op, kinds[a.index()]) {
                (_, Shape::Constant) => Shape::Constant,
                (Op::Neg, kind) => kind,
                _ => Shape::Other,
            },
            Node::Binary(op, a, b) => match (op, kinds[a.index()], kinds[b.index()]) {
                (_, Shape::Constant, Shape::Constant) => Shape::Constant,
                (_, Shape::Other, _) | (_, _, Shape::Other) => Shape::Other,
                (Op::Add | Op::Sub, _, _) => Shape::Affine,
                (Op::Mul, Shape::Constant, _) | (Op::Mul | Op::Div, _, Shape::Constant) => Shape::Affine,
                _ => Shape::Other,
            },
        };
        kinds[id.index()] = kind;
    }
    kinds
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lang::{compile, no_includes};

    fn scene(text: &str) -> Scene {
        compile("test", text, &mut no_includes).scene.unwrap()
    }

    #[test]
    fn planes_are_taken_out_of_a_minimum() {
        let mut formula = scene("min(y, sqrt(x*x+(y-1)*(y-1)+(z-6)*(z-6))-1)");
        let (planes, rest) = split(&mut formula);
        assert_eq!(planes.len(), 1);
        assert_eq!(formula.graph.node(planes[0].shape), Node::Input(Input::Y));
        assert!(matches!(formula.graph.node(rest.unwrap().estimate), Node::Binary(Op::Sub, _, _)));
    }

    #[test]
    fn a_plane_may_be_turned_moved_and_driven_by_sound() {
        let mut tilted = scene("0.6*x + (y - volume.x)*0.8 - z/2 + sin(t)");
        let (planes, rest) = split(&mut tilted);
        assert_eq!((planes.len(), rest), (1, None));
    }

    #[test]
    fn bent_and_cut_shapes_are_not_planes() {
        for text in ["y + 0.1*sin(x)", "max(y, x)", "abs(y)", "y*y", "y*x", "1/y", "length(p) - 1"] {
            let (planes, rest) = split(&mut scene(text));
            assert!(planes.is_empty() && rest.is_some(), "{text}");
        }
    }

    #[test]
    fn no_more_planes_than_the_limit_are_taken_out() {
        let mut room = scene("union(for i in 0..7: y + i*x)");
        let (planes, rest) = split(&mut room);
        assert_eq!(planes.len(), PLANES_MAX);
        assert!(rest.is_some());
    }
}
