//! Hoisting: expressions that are constant within a frame are computed once per frame on the CPU.
//!
//! An expression that reads only the frame's inputs (a sine of the time, a curve of the volume) becomes an input of the
//! shaders, [`Input::Hoisted`]. This input is a uniform of the compiled shader or an entry of the interpreter's table,
//! so shaders do not compute it at each point. Up to 256 expressions are hoisted; further ones stay in the shaders.

use super::Roots;
use crate::graph::{FrameInputs, Graph, Input, Node, NodeId, Point};
use crate::limits::LIMITS;

/// Expressions of the frame, in a separate graph.
#[derive(Debug, Clone, Default)]
pub struct Hoisted {
    graph: Graph,
    order: Vec<NodeId>,
    /// In the hoisted expressions, root i computes the value of `Input::Hoisted(i)`.
    roots: Vec<NodeId>,
}

impl Hoisted {
    pub(crate) fn of(graph: &Graph, roots: &[NodeId]) -> Self {
        let mut own = Graph::new();
        let mut moved = vec![NodeId::default(); graph.len()];
        for id in graph.order(roots) {
            copy(graph, id, &mut own, &mut moved);
        }
        let roots: Vec<NodeId> = roots.iter().map(|root| moved[root.index()]).collect();
        Self { order: own.order(&roots), graph: own, roots }
    }

    /// Computes the values at a point of a frame.
    pub(crate) fn at(&self, [x, y, z]: [f32; 3], inputs: &FrameInputs) -> Vec<f32> {
        self.graph.evaluate_in(&self.order, &self.roots, &Point::at(x, y, z), inputs)
    }

    /// Computes the values for a frame. All values are finite.
    pub fn values(&self, inputs: &FrameInputs) -> Vec<f32> {
        // Uniforms and tables must hold the same number: an overflow becomes the largest number, a NaN becomes 0.
        let finite = |value: f32| if value.is_nan() { 0.0 } else { value.clamp(f32::MIN, f32::MAX) };
        self.at([0.0; 3], inputs).into_iter().map(finite).collect()
    }
}

/// Copies a node whose operands have been copied. `moved` holds the copy of each node.
fn copy(from: &Graph, id: NodeId, to: &mut Graph, moved: &mut [NodeId]) {
    moved[id.index()] = to.raw(from.node(id).with_operands(|operand| moved[operand.index()]));
}

/// Hoists the parts of the roots that do not depend on the point. All other nodes stay the same, bit for bit.
pub(super) fn hoist(graph: &Graph, roots: &Roots) -> (Graph, Roots, Hoisted) {
    let all: Vec<NodeId> = roots.all().collect();
    let order = graph.order(&all);
    let mut of_frame = vec![false; graph.len()];
    let mut is_read = vec![false; graph.len()];
    for &id in &order {
        let node = graph.node(id);
        let fixed = |id: NodeId| of_frame[id.index()] || graph.as_constant(id).is_some();
        match node {
            Node::Constant(_) => {}
            Node::Input(input) => of_frame[id.index()] = input.of_point().is_none(),
            Node::Unary(..) | Node::Binary(..) if node.operands().all(fixed) => of_frame[id.index()] = true,
            _ => node.operands().for_each(|operand| is_read[operand.index()] = true),
        }
    }
    for root in &all {
        is_read[root.index()] = true;
    }
    let mut hoisted = Vec::new();
    let mut rest = Graph::new();
    rest.reserve(order.len());
    let mut moved = vec![NodeId::default(); graph.len()];
    // Shaders know no motions, so these come first: there are fewer of them than places.
    let is_motion = |id: NodeId| matches!(graph.node(id), Node::Input(Input::Motion(_)));
    let (motions, others): (Vec<NodeId>, Vec<NodeId>) = order.into_iter().partition(|id| is_motion(*id));
    for id in motions.into_iter().chain(others) {
        let hoistable = of_frame[id.index()] && is_read[id.index()];
        let computed = !matches!(graph.node(id), Node::Constant(_) | Node::Input(_)) || is_motion(id);
        if hoistable && computed && hoisted.len() < LIMITS.hoisted_max {
            moved[id.index()] = rest.input(Input::Hoisted(hoisted.len() as u16));
            hoisted.push(id);
        } else if !is_motion(id) {
            copy(graph, id, &mut rest, &mut moved);
        }
    }
    (rest, roots.map(|id| moved[id.index()]), Hoisted::of(graph, &hoisted))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::{LevelList, SoundInput, SoundInputs};
    use crate::lang::{compile, no_includes};
    use crate::tape::{PointEvaluator, Tape};
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
    fn hoisting_keeps_values_and_shortens_tapes() {
        let scene = compile("test", TEXT, &mut no_includes).scene.unwrap();
        let world = World::new("test", scene, Vec::new()).unwrap();
        let mut inputs = FrameInputs {
            time: 1.5,
            sound: SoundInputs::with(&[(SoundInput::VolumeLeft, 0.25), (SoundInput::VolumeRight, 0.5)]),
            params: vec![1.25],
            ..Default::default()
        };
        inputs.levels.of_mut(LevelList::Band)[3] = 0.75;
        inputs.hoisted = world.hoisted.values(&inputs);
        assert_eq!(inputs.hoisted.len(), 3, "the radius and two coordinates of the ball's place");
        let whole = Tape::new(&world.scene.graph, &[world.scene.distance]);
        let short = Tape::new(&world.graph, &world.roots.distance[1..]);
        assert!(short.clauses.len() + 8 < whole.clauses.len(), "{short}\n{whole}");
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
