//! GLSL from the graph, by the table of operators.
//!
//! The text relies on what the shader around it declares: `cell_hash` ([`crate::graph::CELL_HASH_GLSL`]), the
//! frame's inputs ([`input_name`]), and, where they are used, `float table_band(float)`, `float
//! table_spectrum(float)`, `float table_waveform(float)`, `float table_history(float, float)` and `vec4
//! read_texture(int, float, float)`.

use std::fmt::Write as _;

use crate::graph::{Graph, GraphError, Input, Node, NodeId};

/// A literal that is the same f32 when it is read back. Negative ones stand in parentheses.
pub fn literal(value: f32) -> String {
    if value.is_finite() {
        if value.is_sign_negative() { format!("({value:?})") } else { format!("{value:?}") }
    } else {
        format!("uintBitsToFloat(0x{:08X}u)", value.to_bits())
    }
}

/// The name of an input in the generated code: `p` and `n` are the function's arguments, the rest are
/// uniforms.
///
/// `frame_time`, `frame_tempo`, `frame_phase` are floats, `frame_volume` a vec2, `frame_sound` a vec4 (bass,
/// mid, treble, beat), `frame_bands` eight vec4, `frame_params` vec4 as many as there are parameters, divided
/// by four.
pub fn input_name(input: Input) -> String {
    let packed =
        |name: &str, index: usize| format!("{name}[{}].{}", index / 4, ["x", "y", "z", "w"][index % 4]);
    match input {
        Input::X => "p.x".into(),
        Input::Y => "p.y".into(),
        Input::Z => "p.z".into(),
        Input::NX => "n.x".into(),
        Input::NY => "n.y".into(),
        Input::NZ => "n.z".into(),
        Input::T => "frame_time".into(),
        Input::VolumeLeft => "frame_volume.x".into(),
        Input::VolumeRight => "frame_volume.y".into(),
        Input::Bass => "frame_sound.x".into(),
        Input::Mid => "frame_sound.y".into(),
        Input::Treble => "frame_sound.z".into(),
        Input::Beat => "frame_sound.w".into(),
        Input::Tempo => "frame_tempo".into(),
        Input::Phase => "frame_phase".into(),
        Input::Band(index) => packed("frame_bands", usize::from(index)),
        Input::Param(index) => packed("frame_params", usize::from(index)),
    }
}

/// Writes an operator's template with its operands put in.
pub(super) fn fill(text: &mut String, template: &str, a: &str, b: &str) {
    let mut rest = template;
    while let Some(at) = rest.find('$') {
        text.push_str(&rest[..at]);
        text.push_str(if rest[at..].starts_with("$a") { a } else { b });
        rest = rest.get(at + 2..).unwrap_or("");
    }
    text.push_str(rest);
}

/// A function that computes the roots: `float name(vec3 p, vec3 n)` for one root, else `void name(vec3 p,
/// vec3 n, out float r0, out float r1, ..)`. One temporary per node, in the order of evaluation.
///
/// # Errors
/// What [`Graph::check`] says.
pub fn function(graph: &Graph, roots: &[NodeId], name: &str) -> Result<String, GraphError> {
    let order = graph.order(roots)?.nodes;
    let mut text = String::with_capacity(order.len() * 32 + 256);
    // Writing to a String cannot fail.
    if let [_] = roots {
        let _ = writeln!(text, "float {name}(vec3 p, vec3 n) {{");
    } else {
        let _ = write!(text, "void {name}(vec3 p, vec3 n");
        for place in 0..roots.len() {
            let _ = write!(text, ", out float r{place}");
        }
        text.push_str(") {\n");
    }
    let operand = |id: NodeId| match graph.node(id) {
        Node::Constant(value) => literal(value),
        Node::Input(input) => input_name(input),
        _ => format!("v{}", id.index()),
    };
    for id in order {
        let (template, a, b) = match graph.node(id) {
            Node::Constant(_) | Node::Input(_) => continue,
            Node::Unary(op, a) => (op.glsl(), operand(a), String::new()),
            Node::Binary(op, a, b) => {
                let never_zero = graph.as_constant(b).is_some_and(f32::is_normal);
                (if never_zero { op.glsl_by_constant() } else { op.glsl() }, operand(a), operand(b))
            }
            Node::Texture { texture, channel, u, v } => {
                let channel = ["x", "y", "z", "w"][usize::from(channel & 3)];
                let _ = writeln!(
                    text,
                    "    float v{} = read_texture({texture}, {}, {}).{channel};",
                    id.index(),
                    operand(u),
                    operand(v)
                );
                continue;
            }
        };
        let _ = write!(text, "    float v{} = ", id.index());
        fill(&mut text, template, &a, &b);
        text.push_str(";\n");
    }
    if let [root] = roots {
        let _ = writeln!(text, "    return {};", operand(*root));
    } else {
        for (place, root) in roots.iter().enumerate() {
            let _ = writeln!(text, "    r{place} = {};", operand(*root));
        }
    }
    text.push_str("}\n");
    Ok(text)
}
