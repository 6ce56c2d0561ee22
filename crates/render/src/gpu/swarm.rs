//! Computes the points of swarms on several threads.

use std::ops::Range;

use super::scene_resources::processors;
use mariana_field::graph::FrameInputs;
use mariana_field::world::{POINT_TEXELS_MAX, SwarmPlan, SwarmView};

/// The smallest part of a swarm for which a thread is started.
const SWARM_PART: usize = 4096;

/// Returns the texels of a frame's swarms, at most `texels_max`. Several threads compute the points.
pub(super) fn texels(
    plan: &SwarmPlan,
    inputs: &FrameInputs,
    view: &SwarmView,
    texels_max: usize,
) -> Vec<[f32; 4]> {
    let count = plan.point_count();
    let part = count.div_ceil(processors()).max(SWARM_PART);
    let parts = (0..count).step_by(part).map(|start| start..(start + part).min(count));
    let mut points = std::thread::scope(|scope| {
        let compute = |part: Range<usize>| {
            let own = part.clone();
            let work = move || plan.points(inputs, own);
            (part, std::thread::Builder::new().name("swarm".into()).spawn_scoped(scope, work))
        };
        // This thread computes the first part, and parts whose thread did not start.
        let others: Vec<_> = parts.clone().skip(1).map(compute).collect();
        let mut points: Vec<_> = parts.take(1).flat_map(|part| plan.points(inputs, part)).collect();
        for (part, thread) in others {
            let done = thread.ok().and_then(|thread| thread.join().ok());
            points.extend(done.unwrap_or_else(|| plan.points(inputs, part)));
        }
        points
    });
    points.truncate(texels_max / POINT_TEXELS_MAX);
    plan.texels(&points, inputs, view, texels_max)
}
