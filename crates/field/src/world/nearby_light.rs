//! The light that shining objects give to their surroundings. It is the counterpart of ambient occlusion: an object
//! that hides a part of the sky from a surface sends its own light to the surface instead. Once per surface point, the
//! shader probes a point above the surface and runs one program, which computes the emission and the distance of
//! shining objects nearby. Only scenes with emission have this cost. Apart from this light, only mirrors send light
//! from surface to surface.
//!
//! Shining objects are mixed by weights max(1 - (d / reach)², 0)² / (d² + 1e-6) of their distances d, so that there
//! are no visible seams. A weight is exactly 0 beyond the reach of the light, so a shortened tape leaves out distant
//! objects. Values that are not distances have no reach: their weights are 1 / (d² + 1e-6).
//!
//! Tried: skipping the program if no shining object is within reach. In most scenes nearly every surface has a
//! shining object within reach (in speakers 19 % of the pixels have none, in clockwork 79 %).

use super::media::facing;
use crate::graph::{Graph, NodeId, Op};
use crate::lang::Scene;

/// The least reach, as in the frame's uniforms (`frame_reach`).
const REACH_MIN: f32 = 1e-4;
/// The least sum of the weights, which avoids a division by 0.
const SUM_MIN: f32 = 1e-30;

/// Returns the emission near a point in red, green and blue, and the distance to the nearest shining object; `None` if
/// no object shines. Nearer objects have larger weights, so that there is no visible seam. An emission that depends on
/// the normal is evaluated for a surface that faces up.
pub(super) fn nearby_light(scene: &mut Scene, non_lipschitz: bool) -> Option<[NodeId; 4]> {
    let zero = scene.graph.constant(0.0);
    let objects = scene.objects.iter();
    let shining: Vec<(NodeId, [NodeId; 3])> = objects
        .filter_map(|object| Some((object.shape, scene.materials.get(object.material)?.emission)))
        .filter(|(_, emission)| *emission != [zero; 3])
        .collect();
    let emissions: Vec<NodeId> = shining.iter().flat_map(|(_, emission)| *emission).collect();
    let facing_up = facing(&mut scene.graph, &emissions, [0.0, 1.0, 0.0]);
    let graph = &mut scene.graph;
    let shapes: Vec<NodeId> = shining.iter().map(|(shape, _)| *shape).collect();
    let nearest = shapes.iter().copied().reduce(|a, b| graph.min(a, b))?;
    let reach = graph.max(scene.sky.reach, REACH_MIN);
    // The shader takes no light beyond the reach, so a distance of the reach is as good as a larger one.
    let nearest = if non_lipschitz { nearest } else { graph.min(nearest, reach) };
    let emissions = facing_up.as_chunks::<3>().0;
    let light = match emissions {
        [one] => *one,
        several => {
            let one = graph.constant(1.0);
            let per_square = graph.div(1.0, Op::Square.of(reach));
            let weights: Vec<NodeId> = shapes
                .iter()
                .map(|&shape| {
                    let square = graph.square(shape);
                    let window = if non_lipschitz { one } else { window(graph, square, per_square) };
                    graph.div(window, square + 1e-6)
                })
                .collect();
            let sum = weights.iter().copied().reduce(|a, b| graph.add(a, b)).unwrap_or(one);
            // All weights are 0 beyond the reach.
            let sum = graph.max(sum, SUM_MIN);
            [0, 1, 2].map(|part| {
                let mut light = zero;
                for (emission, &weight) in several.iter().zip(&weights) {
                    light = graph.add(light, emission[part] * weight);
                }
                graph.div(light, sum)
            })
        }
    };
    let [r, g, b] = light;
    Some([r, g, b, nearest])
}

/// Returns max(1 - (d / reach)², 0)², which has no kink at the reach, for the square of d and 1 / reach².
fn window(graph: &mut Graph, square: NodeId, per_square: NodeId) -> NodeId {
    graph.unary(Op::Square, Op::Max.pair(1.0 - square * per_square, 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::{FrameInputs, Point};
    use crate::lang::{compile, no_includes};

    fn glow_at(text: &str, x: f32) -> Option<Vec<f32>> {
        let mut scene = compile("test", text, &mut no_includes).scene.unwrap();
        let roots = nearby_light(&mut scene, false)?;
        let point = Point { position: [x, 0.0, 0.0], normal: [0.3; 3] };
        Some(scene.graph.evaluate(&roots, &point, &FrameInputs::default()))
    }

    #[test]
    fn emissions_mix_by_distance_and_dark_objects_add_none() {
        let text = "material a { emission = vec3(p.x, 2, n.y) }\nmaterial b { emission = vec3(0, 4, 0) }\n\
                    material dark { color = 1 }\n\
                    object first { shape = sphere(p, 9) material = dark }\n\
                    object second { shape = sphere(p - vec3(5, 0, 0), 1) material = a }\n";
        assert_eq!(glow_at(text, 3.0).unwrap(), [3.0, 2.0, 1.0, 1.0]);
        let two = format!("{text}object third {{ shape = sphere(p - vec3(1, 0, 0), 1) material = b }}");
        let halfway = glow_at(&two, 3.0).unwrap();
        assert!((halfway[0] - 1.5).abs() < 1e-3 && (halfway[1] - 3.0).abs() < 1e-3, "{halfway:?}");
        let at_the_third = glow_at(&two, 2.01).unwrap();
        assert!(at_the_third[1] > 3.9 && at_the_third[3] < 0.02, "{at_the_third:?}");
        let beyond_the_reach = glow_at(&format!("{two}\nsky {{ reach = 2 }}"), -9.0).unwrap();
        assert_eq!(beyond_the_reach, [0.0, 0.0, 0.0, 2.0]);
        assert_eq!(glow_at("sphere(p, 1)", 0.0), None);
    }
}
