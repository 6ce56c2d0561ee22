//! A simple evaluator of graphs. Tests compare the fast evaluators with it.

use super::frame_inputs::FrameInputs;
use super::interval::Interval;
use super::node::{Input, Node, NodeId};
use super::order::Order;
use super::{Graph, GraphError};

/// The point at which an expression is evaluated.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Point {
    /// Position in world space.
    pub position: [f32; 3],
    /// Surface normal; used in materials.
    pub normal: [f32; 3],
}

impl Point {
    /// Returns a position without a normal.
    pub const fn at(x: f32, y: f32, z: f32) -> Self {
        Self { position: [x, y, z], normal: [0.0; 3] }
    }

    /// Returns the six inputs in the order of [`Input::OF_POINT`].
    pub const fn inputs(&self) -> [f32; 6] {
        let ([x, y, z], [nx, ny, nz]) = (self.position, self.normal);
        [x, y, z, nx, ny, nz]
    }
}

impl Graph {
    /// Returns the values of `roots` at a point.
    ///
    /// # Errors
    /// [`GraphError::TooManyNodes`] if the graph has reached its limit.
    pub fn evaluate(
        &self,
        roots: &[NodeId],
        point: &Point,
        frame: &FrameInputs,
    ) -> Result<Vec<f32>, GraphError> {
        Ok(self.evaluate_in(&self.order(roots)?, roots, point, frame))
    }

    /// Like [`Graph::evaluate`], but takes the order that [`Graph::order`] returned for this graph and these roots.
    pub fn evaluate_in(
        &self,
        order: &Order,
        roots: &[NodeId],
        point: &Point,
        frame: &FrameInputs,
    ) -> Vec<f32> {
        let mut values = vec![0.0; roots.iter().max().map_or(0, |last| last.index() + 1)];
        for &id in &order.nodes {
            values[id.index()] = match self.node(id) {
                Node::Constant(value) => value,
                Node::Input(input) => input_value(input, point, frame),
                Node::Unary(op, a) => op.value(values[a.index()], 0.0, frame),
                Node::Binary(op, a, b) => op.value(values[a.index()], values[b.index()], frame),
                Node::Texture { texture, channel, u, v } => {
                    frame.texture(texture, channel, values[u.index()], values[v.index()])
                }
            };
        }
        roots.iter().map(|root| values[root.index()] + 0.0).collect()
    }
}

/// Returns bounds of a value of the graph that is the same at all points. With [`FrameInputs::any`], they hold for every
/// frame.
///
/// # Errors
/// [`GraphError::TooManyNodes`] if the graph has reached its limit.
pub(crate) fn bounds_of(graph: &Graph, root: NodeId, frame: &FrameInputs) -> Result<Interval, GraphError> {
    let mut bounds = vec![Interval::ANY; root.index() + 1];
    for &id in &graph.order(&[root])?.nodes {
        bounds[id.index()] = match graph.node(id) {
            Node::Constant(value) => Interval::point(value),
            Node::Input(input) => frame.bounds(input),
            Node::Unary(op, a) => op.bounds(bounds[a.index()], Interval::point(0.0), frame),
            Node::Binary(op, a, b) => op.bounds(bounds[a.index()], bounds[b.index()], frame),
            Node::Texture { .. } => Interval::ANY,
        };
    }
    Ok(bounds[root.index()])
}

fn input_value(input: Input, point: &Point, frame: &FrameInputs) -> f32 {
    match input.of_point() {
        Some(place) => point.inputs()[place],
        None => frame.value(input),
    }
}
