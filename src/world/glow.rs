//! What objects that shine give to what is near them.
//!
//! Whatever hides a part of the sky from a surface sends its own light from there instead: the shader finds out how
//! much is hidden when it asks for ambient occlusion, and asks here for the light of the object that hides it.

use crate::graph::{Graph, GraphError, Input, Node, NodeId, Op};
use crate::lang::Scene;

/// The normal's component that holds the number of an object instead.
const OBJECT: Input = Input::NX;

/// The emission of an object near a point, in red, green and blue, as a function of the point and, in place of the
/// normal's x, the object's number. Where an emission depends on the normal it is that of a surface that faces up. None
/// where nothing shines.
///
/// # Errors
/// What [`Graph::check`] says.
pub(super) fn glow(scene: &mut Scene) -> Result<Option<[NodeId; 3]>, GraphError> {
    let zero = scene.graph.constant(0.0);
    let shines = |emission: [NodeId; 3]| emission != [zero; 3];
    let objects = scene.objects.iter().enumerate();
    let shining: Vec<(usize, [NodeId; 3])> = objects
        .filter_map(|(number, object)| Some((number, scene.materials.get(object.material)?.emission)))
        .filter(|(_, emission)| shines(*emission))
        .collect();
    if shining.is_empty() {
        return Ok(None);
    }
    let roots: Vec<NodeId> = shining.iter().flat_map(|(_, emission)| *emission).collect();
    let facing_up = without_normals(&mut scene.graph, &roots)?;
    let graph = &mut scene.graph;
    let object = graph.input(OBJECT);
    let half = graph.constant(0.5);
    let mut light = [zero; 3];
    for ((number, _), emission) in shining.iter().zip(facing_up.as_chunks::<3>().0) {
        let number = graph.constant(*number as f32);
        let off = graph.sub(object, number);
        let off = graph.unary(Op::Abs, off);
        let is_it = graph.binary(Op::Less, off, half);
        light = [0, 1, 2].map(|part| graph.select(is_it, emission[part], light[part]));
    }
    graph.check()?;
    Ok(Some(light))
}

/// The expressions with (0, 1, 0) for the normal.
fn without_normals(graph: &mut Graph, roots: &[NodeId]) -> Result<Vec<NodeId>, GraphError> {
    let mut moved = vec![NodeId::default(); graph.len()];
    for id in graph.order(roots)?.nodes {
        let at = |id: NodeId| moved[id.index()];
        let copy = match graph.node(id) {
            Node::Input(Input::NX | Input::NZ) => graph.constant(0.0),
            Node::Input(Input::NY) => graph.constant(1.0),
            Node::Constant(_) | Node::Input(_) => id,
            Node::Unary(op, a) => graph.unary(op, at(a)),
            Node::Binary(op, a, b) => graph.binary(op, at(a), at(b)),
            Node::Texture { texture, channel, u, v } => graph.texture(texture, channel, at(u), at(v)),
        };
        moved[id.index()] = copy;
    }
    Ok(roots.iter().map(|root| moved[root.index()]).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::{FrameInputs, Point};
    use crate::lang::{compile, no_includes};

    #[test]
    fn each_object_gives_its_own_emission_and_what_is_dark_gives_none() {
        let text = "material a { emission = vec3(p.x, 2, n.y) }\nmaterial dark { color = 1 }\n\
                    object first { shape = sphere(p, 1) material = dark }\n\
                    object second { shape = box(p, 1) material = a }";
        let mut scene = compile("test", text, &mut no_includes).scene.unwrap();
        let light = glow(&mut scene).unwrap().unwrap();
        let at = |object: f32| {
            let point = Point { position: [5.0, 0.0, 0.0], normal: [object, 0.3, 0.3] };
            scene.graph.evaluate(&light, &point, &FrameInputs::default()).unwrap()
        };
        assert_eq!(at(0.0), [0.0; 3]);
        assert_eq!(at(1.0), [5.0, 2.0, 1.0]);
        let mut dark = compile("test", "sphere(p, 1)", &mut no_includes).scene.unwrap();
        assert_eq!(glow(&mut dark).unwrap(), None);
    }
}
