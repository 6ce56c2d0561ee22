//! GLSL functions generated from a graph and the table of operators.
//!
//! The generated text relies on declarations in the surrounding shader: `cell_hash` ([`crate::graph::CELL_HASH_GLSL`]),
//! the frame's inputs ([`input_name`]), and, if they are used, `float table_part(float)`, `float
//! table_spectrum(float)`, `float table_waveform(float)`, `float table_history(float, float)`, `float
//! shape_number(float)`, `float shape_distance(float, float)`, `vec4 read_texture(int, float, float)` and the functions of [`crate::graph::levels_glsl`].

use std::collections::{HashMap, HashSet};
use std::fmt::Write as _;

use super::rounds::{Formula, Rounds, Source, Unrolled};
use crate::graph::{Graph, Input, Node, NodeId, Op, ScreenInput};

/// Returns a literal that GLSL parses to the same f32. Negative numbers are put in parentheses.
pub fn literal(value: f32) -> String {
    if value.is_finite() {
        if value.is_sign_negative() { format!("({value:?})") } else { format!("{value:?}") }
    } else {
        format!("uintBitsToFloat(0x{:08X}u)", value.to_bits())
    }
}

/// The name of an input in the generated code. `p` and `n` are arguments of the function; the other names are uniforms.
///
/// `frame_time` is a float. `frame_heard` holds the sound's numbers, `frame_params` the parameters and `frame_hoisted`
/// the values that are computed once per frame, four to a vec4. `frame_levels` holds the levels that scenes read by
/// number, one in the x of each vec4. `camera_position` is a vec4 with the eye in xyz, `frame_screen` one with the
/// picture's size in xy, and `frame_mouse` one with the pointer's position in xy and its button in z.
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
        Input::Sound(input) => packed("frame_heard", input as usize),
        Input::EyeX => "camera_position.x".into(),
        Input::EyeY => "camera_position.y".into(),
        Input::EyeZ => "camera_position.z".into(),
        Input::Screen(input) => match input {
            ScreenInput::Width => "frame_screen.x".into(),
            ScreenInput::Height => "frame_screen.y".into(),
            ScreenInput::MouseX => "frame_mouse.x".into(),
            ScreenInput::MouseY => "frame_mouse.y".into(),
            ScreenInput::MousePressed => "frame_mouse.z".into(),
        },
        Input::Level(level) => format!("frame_levels[{}].x", level.place()),
        Input::Param(index) => packed("frame_params", usize::from(index)),
        Input::Hoisted(index) => packed("frame_hoisted", usize::from(index)),
        // Drawn scenes have hoisted values for their motions, and an export writes numbers.
        Input::Motion(index) => packed("frame_motions", usize::from(index)),
    }
}

pub(super) fn fill(text: &mut String, template: &str, a: &str, b: &str) {
    let mut rest = template;
    while let Some(at) = rest.find('$') {
        text.push_str(&rest[..at]);
        text.push_str(if rest[at..].starts_with("$a") { a } else { b });
        rest = rest.get(at + 2..).unwrap_or("");
    }
    text.push_str(rest);
}

/// The texture reads of a generated function.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sampling {
    /// Textures are read at their finest level: `vec4 read_texture(int, float, float)`.
    None,
    /// Reads with the footprint of a pixel. The function has two more arguments, `vec3 dx, vec3 dy`: the changes of
    /// the position one pixel to the right and one pixel up. It calls `vec4 sample_texture(int, vec2 uv, vec2 dx,
    /// vec2 dy)`.
    AlongPosition,
    /// Like [`Sampling::AlongPosition`], with the changes of the normal.
    AlongNormal,
    /// Like [`Sampling::AlongNormal`] for the sky, whose normal is the ray's direction and whose position is the
    /// picture's pixel. The function has two more arguments, `vec3 px, vec3 py`: the changes of the pixel.
    AlongDirection,
}

/// Returns the reciprocal of a divisor, if both are normal numbers. Drivers may multiply by the reciprocal in any case,
/// because OpenGL allows an error of 2.5 ulp.
fn reciprocal(divisor: f32) -> Option<f32> {
    let reciprocal = Some(divisor).filter(|value| value.is_normal())?.recip();
    reciprocal.is_normal().then_some(reciprocal)
}

/// Returns the number of statements of the function that computes `roots`. The rounds of a loop count once.
pub fn statements(graph: &Graph, roots: &[NodeId]) -> usize {
    let order = graph.order(roots);
    let unrolled = Unrolled::new(graph, &order, roots);
    let saved = unrolled.loops().iter().map(|rounds| rounds.places.len() - rounds.steps.len()).sum::<usize>();
    unrolled.order.len() - saved
}

/// Writes a function that computes the roots: `float name(vec3 p, vec3 n)` for one root, else `void name(vec3 p, vec3
/// n, out float r0, out float r1, ..)`. The function has a temporary per node, in the order of evaluation; equal rounds
/// become a loop (`rounds.rs`). With a [`Sampling`] other than `None`, functions `name_uv0` .. for texture coordinates
/// precede it.
pub fn function(graph: &Graph, roots: &[NodeId], name: &str, sampling: Sampling) -> String {
    let order = graph.order(roots);
    let neighbours = match sampling {
        Sampling::None => None,
        Sampling::AlongPosition => Some(["p + dx, n", "p + dy, n"]),
        Sampling::AlongNormal => Some(["p, n + dx", "p, n + dy"]),
        Sampling::AlongDirection => Some(["p + px, n + dx", "p + py, n + dy"]),
    };
    let arguments = match sampling {
        Sampling::None => "vec3 p, vec3 n",
        Sampling::AlongPosition | Sampling::AlongNormal => "vec3 p, vec3 n, vec3 dx, vec3 dy",
        Sampling::AlongDirection => "vec3 p, vec3 n, vec3 dx, vec3 dy, vec3 px, vec3 py",
    };
    let mut writer = Writer::new(graph, String::with_capacity(order.len() * 32 + 256));
    if neighbours.is_some() {
        writer.coordinates(&order, name);
    }
    let single = roots.len() == 1 && neighbours.is_none();
    writer.head(name, arguments, (!single).then_some(roots.len()), neighbours);
    writer.statements(&order, roots);
    writer.results(roots, single);
    writer.text
}

/// Writes the statements of a function. Writing to a String cannot fail, so the results of `write!` are ignored.
struct Writer<'a> {
    graph: &'a Graph,
    text: String,
    coordinates: Vec<(NodeId, NodeId)>,
    sampled: Vec<(u16, NodeId, NodeId)>,
    /// The sums of squares found so far. Their square roots need no guard against negative numbers.
    squares: HashSet<NodeId>,
    /// The variables of loops that hold values after the loop.
    kept: HashMap<NodeId, String>,
}

/// An operand in the text.
struct Operand {
    text: String,
    /// The value of a constant.
    number: Option<f32>,
    is_square: bool,
}

impl<'a> Writer<'a> {
    fn new(graph: &'a Graph, text: String) -> Self {
        Self {
            graph,
            text,
            coordinates: Vec::new(),
            sampled: Vec::new(),
            squares: HashSet::new(),
            kept: HashMap::new(),
        }
    }

    fn coordinates(&mut self, order: &[NodeId], name: &str) {
        for id in order {
            if let Node::Texture { u, v, .. } = self.graph.node(*id)
                && !self.coordinates.contains(&(u, v))
            {
                let name = format!("{name}_uv{}", self.coordinates.len());
                self.text.push_str(&function(self.graph, &[u, v], &name, Sampling::None));
                self.coordinates.push((u, v));
            }
        }
    }

    /// Writes the signature, with `results` out parameters or a return value, and the texture coordinates of the
    /// neighbouring pixels.
    fn head(&mut self, name: &str, arguments: &str, results: Option<usize>, neighbours: Option<[&str; 2]>) {
        let text = &mut self.text;
        match results {
            None => {
                let _ = writeln!(text, "float {name}({arguments}) {{");
            }
            Some(results) => {
                let _ = write!(text, "void {name}({arguments}");
                for place in 0..results {
                    let _ = write!(text, ", out float r{place}");
                }
                text.push_str(") {\n");
            }
        }
        for place in 0..self.coordinates.len() {
            for (neighbour, at) in ["x", "y"].into_iter().zip(neighbours.into_iter().flatten()) {
                let _ = writeln!(
                    text,
                    "    vec2 d{neighbour}{place};\n    {name}_uv{place}({at}, d{neighbour}{place}.x, \
                     d{neighbour}{place}.y);"
                );
            }
        }
    }

    fn operand(&self, id: NodeId) -> String {
        match self.graph.node(id) {
            Node::Constant(value) => literal(value),
            Node::Input(input) => input_name(input),
            _ => self.kept.get(&id).cloned().unwrap_or_else(|| format!("v{}", id.index())),
        }
    }

    fn operand_of(&self, id: NodeId) -> Operand {
        Operand {
            text: self.operand(id),
            number: self.graph.as_constant(id),
            is_square: self.squares.contains(&id),
        }
    }

    fn statements(&mut self, order: &[NodeId], roots: &[NodeId]) {
        let unrolled = Unrolled::new(self.graph, order, roots);
        let loops = unrolled.loops();
        if loops.is_empty() {
            order.iter().for_each(|id| self.statement(*id));
            return;
        }
        let mut written = 0;
        for rounds in &loops {
            let before = unrolled.order.get(written..rounds.places.start).unwrap_or_default();
            before.iter().for_each(|id| self.statement(*id));
            self.rounds(rounds);
            written = rounds.places.end;
        }
        let rest = unrolled.order.get(written..).unwrap_or_default();
        rest.iter().for_each(|id| self.statement(*id));
    }

    fn statement(&mut self, id: NodeId) {
        match self.graph.node(id) {
            Node::Constant(_) | Node::Input(_) => {}
            Node::Unary(op, a) => self.operation(id, op, &[self.operand_of(a), self.operand_of(a)]),
            Node::Binary(op, a, b) => self.operation(id, op, &[self.operand_of(a), self.operand_of(b)]),
            Node::Texture { texture, channel, u, v } => {
                let place = self.sample(texture, u, v);
                let channel = ["x", "y", "z", "w"][usize::from(channel & 3)];
                let _ = writeln!(self.text, "    float v{} = s{place}.{channel};", id.index());
            }
        }
    }

    fn operation(&mut self, id: NodeId, op: Op, [a, b]: &[Operand; 2]) {
        if op == Op::Square || op == Op::Add && a.is_square && b.is_square {
            self.squares.insert(id);
        }
        let factor = b.number.filter(|_| op == Op::Div).and_then(reciprocal).map(literal);
        let never_zero = op.arity() == 2 && b.number.is_some_and(f32::is_normal);
        let template = match op {
            Op::Sqrt if a.is_square => "sqrt($a)",
            Op::Div if factor.is_some() => "($a * $b)",
            _ if never_zero => op.glsl_by_constant(),
            _ => op.glsl(),
        };
        let _ = write!(self.text, "    float v{} = ", id.index());
        fill(&mut self.text, template, &a.text, factor.as_ref().unwrap_or(&b.text));
        self.text.push_str(";\n");
    }

    /// Writes a loop. Values that the next round or a later statement reads are in variables outside of the loop.
    fn rounds(&mut self, rounds: &Rounds) {
        let kept_name = |offset: usize| format!("k{}", rounds.steps[offset].id.index());
        for (offset, step) in rounds.steps.iter().enumerate().filter(|(_, step)| step.is_kept) {
            let _ = writeln!(self.text, "    float {} = {};", kept_name(offset), self.operand(step.before));
        }
        let list_name = |list: usize| format!("l{}_{list}", rounds.places.start);
        for (list, numbers) in rounds.lists.iter().enumerate() {
            let numbers: Vec<String> = numbers.iter().map(|number| literal(*number)).collect();
            let (name, count) = (list_name(list), numbers.len());
            let _ =
                writeln!(self.text, "    float {name}[{count}] = float[{count}]({});", numbers.join(", "));
        }
        let _ = writeln!(self.text, "    for (int i = 0; i < {}; ++i) {{", rounds.count);
        if let Some(condition) = rounds.steps.len().checked_sub(1).filter(|_| rounds.ends_early) {
            let _ = writeln!(self.text, "    if ({} != 0.0) break;", kept_name(condition));
        }
        for step in rounds.steps.iter().filter(|step| step.is_computed) {
            let unknown = |text: String| Operand { text, number: None, is_square: false };
            let operand = |source: Source| match source {
                Source::Here(of) => self.operand_of(rounds.steps[of].id),
                Source::Fixed(id) => self.operand_of(id),
                Source::Before(of) => unknown(kept_name(of)),
                Source::Known(value) => Operand { number: Some(value), ..unknown(literal(value)) },
                Source::Counted { first, step } => {
                    unknown(format!("({} + {} * float(i))", literal(first), literal(step)))
                }
                Source::Listed(list) => unknown(format!("{}[i]", list_name(list))),
            };
            match step.formula {
                Formula::Operation(op, operands) => {
                    let operands = operands.map(operand);
                    self.operation(step.id, op, &operands);
                }
                Formula::Copy(source) => {
                    let source = operand(source).text;
                    let _ = writeln!(self.text, "    float v{} = {source};", step.id.index());
                }
            }
        }
        for (offset, step) in rounds.steps.iter().enumerate().filter(|(_, step)| step.is_kept) {
            let _ = writeln!(self.text, "    {} = v{};", kept_name(offset), step.id.index());
            self.kept.insert(step.last, kept_name(offset));
            if self.squares.contains(&step.id) {
                self.squares.insert(step.last);
            }
        }
        self.text.push_str("    }\n");
    }

    /// Returns the number of a texture sample, which reads all four channels at once.
    fn sample(&mut self, texture: u16, u: NodeId, v: NodeId) -> usize {
        if let Some(place) = self.sampled.iter().position(|&known| known == (texture, u, v)) {
            return place;
        }
        let place = self.sampled.len();
        self.sampled.push((texture, u, v));
        let (u_name, v_name) = (self.operand(u), self.operand(v));
        let _ = match self.coordinates.iter().position(|&known| known == (u, v)) {
            Some(at) => writeln!(
                self.text,
                "    vec2 c{place} = vec2({u_name}, {v_name});\n    vec4 s{place} = \
                 sample_texture({texture}, c{place}, dx{at} - c{place}, dy{at} - c{place});"
            ),
            None => {
                writeln!(self.text, "    vec4 s{place} = read_texture({texture}, {u_name}, {v_name});")
            }
        };
        place
    }

    fn results(&mut self, roots: &[NodeId], single: bool) {
        for (place, root) in roots.iter().enumerate() {
            let result = self.operand(*root);
            let _ = if single {
                writeln!(self.text, "    return {result};")
            } else {
                writeln!(self.text, "    r{place} = {result};")
            };
        }
        self.text.push_str("}\n");
    }
}
