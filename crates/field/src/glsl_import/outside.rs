//! Values of the uniforms that viewers of shaders define.

use crate::graph::{Graph, Input, NodeId, Op};

/// Width and height in pixels that shaders see as the resolution.
const RESOLUTION: [f32; 2] = [1280.0, 720.0];
const FRAMES_PER_SECOND: f32 = 60.0;

/// Returns `len` components of a known uniform; `None` for an unknown one.
pub(super) fn known(graph: &mut Graph, name: &str, len: usize) -> Option<Vec<NodeId>> {
    let mut constants = |values: &[f32]| -> Vec<NodeId> {
        (0..len).map(|index| graph.constant(values.get(index).copied().unwrap_or(0.0))).collect()
    };
    Some(match name {
        "iTime" | "iGlobalTime" | "time" | "u_time" | "uTime" | "Time" | "globalTime" | "u_Time" | "TIME"
        | "utime" => vec![graph.input(Input::T); len],
        "iFrame" | "FRAMEINDEX" => {
            let (time, rate) = (graph.input(Input::T), graph.constant(FRAMES_PER_SECOND));
            let frames = graph.mul(time, rate);
            vec![graph.unary(Op::Floor, frames); len]
        }
        "iResolution" | "resolution" | "u_resolution" | "uResolution" | "RENDERSIZE"
        | "iChannelResolution" => constants(&[RESOLUTION[0], RESOLUTION[1], 1.0]),
        "iTimeDelta" => constants(&[1.0 / FRAMES_PER_SECOND]),
        "iFrameRate" => constants(&[FRAMES_PER_SECOND]),
        "iSampleRate" => constants(&[44_100.0]),
        "iMouse" | "mouse" | "u_mouse" | "uMouse" | "iDate" | "date" | "iChannelTime" => constants(&[]),
        _ if name.starts_with("iChannel") || name.starts_with("gl_FragColor") || name == "fragColor" => {
            constants(&[])
        }
        _ => return None,
    })
}

/// True for a uniform whose value a scene must give.
pub(super) fn is_unknown(name: &str) -> bool {
    known(&mut Graph::new(), name, 1).is_none()
}
