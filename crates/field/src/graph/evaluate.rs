//! A simple evaluator of graphs. Tests compare the fast evaluators with it.

use std::fmt::Write as _;

use super::Graph;
use super::frame_inputs::FrameInputs;
use super::interval::Interval;
use super::node::{Input, Node, NodeId};

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
    pub fn evaluate(&self, roots: &[NodeId], point: &Point, frame: &FrameInputs) -> Vec<f32> {
        self.evaluate_in(&self.order(roots), roots, point, frame)
    }

    /// Like [`Graph::evaluate`], but takes the order that [`Graph::order`] returned for this graph and these roots.
    pub fn evaluate_in(
        &self,
        order: &[NodeId],
        roots: &[NodeId],
        point: &Point,
        frame: &FrameInputs,
    ) -> Vec<f32> {
        let mut values = vec![0.0; roots.iter().max().map_or(0, |last| last.index() + 1)];
        for &id in order {
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

    /// Returns bounds of a value for inputs of the point within `point`, in the order of [`Input::OF_POINT`]. With
    /// [`FrameInputs::any`], they hold for every frame. Textures have no bounds.
    pub fn bounds(&self, root: NodeId, point: [Interval; 6], frame: &FrameInputs) -> Interval {
        let mut bounds = vec![Interval::ANY; root.index() + 1];
        for id in self.order(&[root]) {
            bounds[id.index()] = match self.node(id) {
                Node::Constant(value) => Interval::point(value),
                Node::Input(input) => {
                    input.of_point().map_or_else(|| frame.bounds(input), |place| point[place])
                }
                Node::Unary(op, a) => op.bounds(bounds[a.index()], Interval::point(0.0), frame),
                Node::Binary(op, a, b) => op.bounds(bounds[a.index()], bounds[b.index()], frame),
                Node::Texture { .. } => Interval::ANY,
            };
        }
        bounds[root.index()]
    }

    /// Returns a Graphviz `digraph` of the nodes that `root` needs: a box per node, edges from operands to users.
    pub fn to_dot(&self, root: NodeId) -> String {
        let mut text = String::from("digraph expression {\n  node [shape=box];\n");
        for id in self.order(&[root]) {
            let node = self.node(id);
            // Writing to a String cannot fail.
            let _ = match node {
                Node::Constant(value) => writeln!(text, "  n{} [label=\"{value:?}\"];", id.0),
                Node::Input(input) => writeln!(text, "  n{} [label=\"{input}\"];", id.0),
                Node::Unary(op, _) | Node::Binary(op, _, _) => {
                    writeln!(text, "  n{} [label=\"{}\"];", id.0, op.name())
                }
                Node::Texture { texture, channel, .. } => {
                    let channel = ["red", "green", "blue", "alpha"][usize::from(channel & 3)];
                    writeln!(text, "  n{} [label=\"TEXTURE {texture} {channel}\"];", id.0)
                }
            };
            for (place, operand) in node.operands().enumerate() {
                let name = ["a", "b"][place];
                let _ = writeln!(text, "  n{} -> n{} [label=\"{name}\"];", operand.0, id.0);
            }
        }
        text.push_str("}\n");
        text
    }
}

fn input_value(input: Input, point: &Point, frame: &FrameInputs) -> f32 {
    match input.of_point() {
        Some(place) => point.inputs()[place],
        None => frame.value(input),
    }
}
