//! What is the same all over a frame is computed once a frame, on the processor, and not again at every point.
//!
//! An expression of the frame's inputs alone (a sine of the time, a curve of the volume) becomes an input of its own,
//! [`Input::Hoisted`]: a uniform of the compiled shader, an entry of the interpreter's table.

use std::collections::HashMap;

use super::Roots;
use crate::graph::{FrameInputs, Graph, GraphError, Input, Node, NodeId};
use crate::limits::LIMITS;

/// The expressions that were taken out.
#[derive(Debug, Clone, Default)]
pub struct Hoisted {
    /// Everything that they need, operands first; nodes of the scene's graph.
    order: Vec<(NodeId, Node)>,
    /// Those that the shader reads; the i-th is `Input::Hoisted(i)`.
    roots: Vec<NodeId>,
}

impl Hoisted {
    /// Computes the values of a frame. All are finite.
    pub fn values(&self, inputs: &FrameInputs) -> Vec<f32> {
        let mut values: HashMap<NodeId, f32> = HashMap::with_capacity(self.order.len());
        let value = |values: &HashMap<NodeId, f32>, id: NodeId| values.get(&id).copied().unwrap_or(0.0);
        for (id, node) in &self.order {
            let result = match *node {
                Node::Constant(constant) => constant,
                Node::Input(input) => inputs.value(input),
                Node::Unary(op, a) => op.value(value(&values, a), 0.0, inputs),
                Node::Binary(op, a, b) => op.value(value(&values, a), value(&values, b), inputs),
                Node::Texture { .. } => 0.0,
            };
            values.insert(*id, result + 0.0);
        }
        // The same for uniforms and tables: an overflow is the largest number, what is no number is 0.
        let finite = |value: f32| if value.is_nan() { 0.0 } else { value.clamp(f32::MIN, f32::MAX) };
        self.roots.iter().map(|root| finite(value(&values, *root))).collect()
    }
}

/// Takes out of the roots what does not depend on the point. Nodes that are not hoisted stay as they are, bit for bit.
///
/// # Errors
/// What [`Graph::check`] says.
pub(super) fn hoist(graph: &Graph, roots: &Roots) -> Result<(Graph, Roots, Hoisted), GraphError> {
    let all: Vec<NodeId> = roots.all().collect();
    let order = graph.order(&all)?.nodes;
    let mut of_frame = vec![false; graph.len()];
    let mut is_read = vec![false; graph.len()];
    for &id in &order {
        let operands = match graph.node(id) {
            Node::Constant(_) => [None; 2],
            Node::Input(input) => {
                of_frame[id.index()] = input.of_point().is_none();
                continue;
            }
            Node::Texture { u, v, .. } => {
                is_read[u.index()] = true;
                is_read[v.index()] = true;
                continue;
            }
            Node::Unary(_, a) => [Some(a), None],
            Node::Binary(_, a, b) => [Some(a), Some(b)],
        };
        let fixed = |id: NodeId| of_frame[id.index()] || graph.as_constant(id).is_some();
        if operands.iter().flatten().all(|operand| fixed(*operand)) {
            of_frame[id.index()] = graph.as_constant(id).is_none();
        } else {
            for operand in operands.iter().flatten() {
                is_read[operand.index()] = true;
            }
        }
    }
    for root in &all {
        is_read[root.index()] = true;
    }
    let mut hoisted = Hoisted::default();
    let mut rest = Graph::new();
    rest.reserve(order.len());
    let mut moved: HashMap<NodeId, NodeId> = HashMap::with_capacity(order.len());
    for &id in &order {
        let node = graph.node(id);
        let computed = !matches!(node, Node::Constant(_) | Node::Input(_));
        if of_frame[id.index()] && computed {
            // Read by points, or only on the way to what is.
            if is_read[id.index()] && hoisted.roots.len() < LIMITS.hoisted_max {
                let input = Input::Hoisted(hoisted.roots.len() as u16);
                hoisted.roots.push(id);
                let new = rest.input(input);
                moved.insert(id, new);
                continue;
            }
        }
        let at = |id: NodeId| moved.get(&id).copied().unwrap_or(id);
        let new = match node {
            Node::Constant(value) => rest.constant(value),
            Node::Input(input) => rest.input(input),
            Node::Unary(op, a) => rest.raw(Node::Unary(op, at(a))),
            Node::Binary(op, a, b) => rest.raw(Node::Binary(op, at(a), at(b))),
            Node::Texture { texture, channel, u, v } => rest.texture(texture, channel, at(u), at(v)),
        };
        moved.insert(id, new);
    }
    rest.check()?;
    hoisted.order = graph.order(&hoisted.roots)?.nodes.iter().map(|id| (*id, graph.node(*id))).collect();
    let roots = roots.map(|id| moved.get(&id).copied().unwrap_or(id));
    Ok((rest, roots, hoisted))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::Point;
    use crate::lang::{compile, no_includes};
    use crate::tape::{PointEvaluator, Tape, TapeOptions};
    use crate::world::World;

    const TEXT: &str = "param wide = 1 in 0 .. 2\n\
                        fn r() = 0.5 + wide * (1 - exp(-5 * volume.x)) + 0.1 * sin(3 * t)\n\
                        object ball { shape = sphere(p - vec3(cos(t), band(floor(2 * t)), 0), r()) }\n\
                        object box { shape = box(p, vec3(r())) }";

    #[test]
    fn an_overflow_of_a_frame_is_the_same_number_for_both_modes() {
        let scene = compile("test", "min(length(p) - 1, length(p.xy) + exp(100 * t))", &mut no_includes)
            .scene
            .unwrap();
        let world = World::new("test", scene, Vec::new()).unwrap();
        let values = world.hoisted.values(&FrameInputs { time: 5.0, ..Default::default() });
        assert_eq!(values, [f32::MAX]);
    }

    #[test]
    fn what_is_left_gives_the_same_values_and_less_work() {
        let scene = compile("test", TEXT, &mut no_includes).scene.unwrap();
        let world = World::new("test", scene, Vec::new()).unwrap();
        let mut inputs =
            FrameInputs { time: 1.5, volume: [0.25, 0.5], params: vec![1.25], ..Default::default() };
        inputs.bands[3] = 0.75;
        inputs.hoisted = world.hoisted.values(&inputs);
        assert_eq!(inputs.hoisted.len(), 3, "the radius and two coordinates of the ball's place");
        let options = TapeOptions::default();
        let whole = Tape::build(&world.scene.graph, &[world.scene.distance], &options).unwrap();
        let short = Tape::build(&world.graph, &world.roots.distance[1..], &options).unwrap();
        assert!(short.clauses().len() + 8 < whole.clauses().len(), "{short}\n{whole}");
        for step in 0..200 {
            let at = step as f32 * 0.37;
            let point = Point::at(at.sin() * 3.0, at.cos() * 2.0, (1.7 * at).sin());
            assert_eq!(
                PointEvaluator::new(&short, &inputs).at(&point),
                PointEvaluator::new(&whole, &inputs).at(&point)
            );
        }
    }
}
