//! Tests of the symbolic execution of GLSL.

mod agreement;
mod bad_input;
mod constructs;
mod generated;
mod witness;
mod witness_math;

use super::{Budget, GlslFile, GlslFunction, GlslSession, GlslType};
use crate::graph::{FrameInputs, Graph, Input, NodeId, Point};
use crate::lang::Diagnostic;
use crate::limits::LIMITS;

fn parsed(text: &str) -> GlslFile {
    GlslFile::parse(text, &LIMITS).unwrap_or_else(|problem| panic!("{problem:?}\n{text}"))
}

fn budget() -> Budget {
    Budget { steps: LIMITS.scene_expansion_max, rounds_max: LIMITS.scene_loop_max, memory_max: 1 << 16 }
}

/// Executes a function whose parameters are components of the point, in order and then from the start.
fn executed(file: &GlslFile, function: &GlslFunction) -> Result<(Graph, Vec<NodeId>), Diagnostic> {
    let mut graph = Graph::new();
    let point = [Input::X, Input::Y, Input::Z].map(|input| graph.input(input));
    let mut rest = point.iter().cycle();
    let arguments: Vec<Vec<NodeId>> = function
        .parameters
        .iter()
        .map(|parameter| rest.by_ref().take(width(parameter.of)).copied().collect())
        .collect();
    let nodes = GlslSession::default().call(file, function, &arguments, &mut graph, &mut budget(), &[])?;
    Ok((graph, nodes))
}

fn width(of: Option<GlslType>) -> usize {
    match of {
        Some(GlslType::Vector(size)) => usize::from(size),
        _ => 1,
    }
}

/// Evaluates nodes at points.
fn values(graph: &Graph, nodes: &[NodeId], points: &[[f32; 3]]) -> Vec<Vec<f32>> {
    let frame = FrameInputs::default();
    let order = graph.order(nodes);
    points.iter().map(|&[x, y, z]| graph.evaluate_in(&order, nodes, &Point::at(x, y, z), &frame)).collect()
}

/// Points in a cube, from a generator with a fixed start.
fn points(count: usize) -> Vec<[f32; 3]> {
    let mut state = 0x2545_F491_4F6C_DD1D_u64;
    let mut next = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 40) as f32 / (1 << 24) as f32 * 3.0 - 1.5
    };
    (0..count).map(|_| [next(), next(), next()]).collect()
}
