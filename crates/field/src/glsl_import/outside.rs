//! Values of the uniforms that viewers of shaders define.

use super::parse::{GlslFile, GlslFunction, GlslType};
use crate::graph::{Graph, Input, NodeId, Op, ScreenInput};

/// Width and height in pixels that shapes see as the resolution. A formula of the picture sees the actual size.
const RESOLUTION: [f32; 2] = [1280.0, 720.0];
const FRAMES_PER_SECOND: f32 = 60.0;

/// Returns `len` components of a known uniform; `None` for an unknown one. `in_picture` is true for a formula of the
/// picture, which knows the pixel, the picture's size and the pointer.
pub(super) fn known(graph: &mut Graph, name: &str, len: usize, in_picture: bool) -> Option<Vec<NodeId>> {
    if in_picture && let Some(mut nodes) = of_picture(graph, name) {
        let zero = graph.constant(0.0);
        nodes.resize(len, zero);
        return Some(nodes);
    }
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

/// Returns the components of a uniform that depends on the picture.
fn of_picture(graph: &mut Graph, name: &str) -> Option<Vec<NodeId>> {
    let screen = |graph: &mut Graph, input| graph.input(Input::Screen(input));
    let (width, height) = (screen(graph, ScreenInput::Width), screen(graph, ScreenInput::Height));
    let (x, y) = (screen(graph, ScreenInput::MouseX), screen(graph, ScreenInput::MouseY));
    Some(match name {
        "iResolution" | "resolution" | "u_resolution" | "uResolution" | "RENDERSIZE" => {
            vec![width, height, graph.constant(1.0)]
        }
        "iMouse" | "u_mouse" | "uMouse" => {
            let pressed = screen(graph, ScreenInput::MousePressed);
            vec![x, y, graph.mul(pressed, x), graph.mul(pressed, y)]
        }
        // Viewers that call it so give fractions of the size.
        "mouse" => vec![graph.div(x, width), graph.div(y, height)],
        "gl_FragCoord" | "fragCoord" => {
            vec![graph.input(Input::X), graph.input(Input::Y), graph.constant(0.0), graph.constant(1.0)]
        }
        _ => return None,
    })
}

/// True for a uniform whose value a scene must give.
pub(super) fn is_unknown(name: &str) -> bool {
    known(&mut Graph::new(), name, 1, true).is_none()
}

// Finds the function of a file that is a scene's distance.

/// Names of distance functions, the most common first.
const NAMES: [&str; 24] = [
    "map",
    "scene",
    "de",
    "sdf",
    "getdist",
    "getsdf",
    "distancefield",
    "world",
    "scenesdf",
    "dist",
    "df",
    "field",
    "mapscene",
    "sdscene",
    "distance_field",
    "sceneDist",
    "sdfscene",
    "estimate",
    "distanceestimator",
    "sd",
    "f",
    "distfunc",
    "dstf",
    "d",
];

/// Number of names at the start of [`NAMES`] that no helper function has.
const SURE_NAMES: usize = 9;

/// True if the function's name says that it is the distance to a scene.
pub(super) fn is_distance_for_sure(function: &GlslFunction) -> bool {
    NAMES.iter().take(SURE_NAMES).any(|known| known.eq_ignore_ascii_case(&function.name))
}

/// Returns the function of a point in space that most likely gives the distance to the scene.
pub fn candidate(file: &GlslFile) -> Option<&GlslFunction> {
    let fits = |function: &&GlslFunction| {
        let takes_point =
            matches!(function.parameters.as_slice(), [one] if one.of == Some(GlslType::Vector(3)));
        takes_point && matches!(function.result, Some(GlslType::Float | GlslType::Vector(_)))
    };
    let rank = |function: &&GlslFunction| {
        let name = function.name.to_lowercase();
        NAMES.iter().position(|known| known.eq_ignore_ascii_case(&name))
    };
    let named =
        file.functions().iter().filter(fits).filter_map(|function| Some((rank(&function)?, function)));
    named.min_by_key(|(rank, _)| *rank).map(|(_, function)| function)
}
