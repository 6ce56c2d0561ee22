//! Checks that the CPU evaluator, both forms of the interpreter's shader and the compiled shader compute the same
//! numbers.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::collections::{BTreeMap, BTreeSet};

use crate::support::apart::apart;
use crate::support::expression::{Random, frame, random_expression, spread, tables_glsl};
use crate::support::glsl::{Stage, check_with_glslang};
use mariana::gpu::headless::Headless;
use mariana_field::graph::{
    CELL_HASH_GLSL, Compound, Compounds, FrameInputs, Graph, Input, Node, NodeId, Op, Point,
};
use mariana_field::region::{Encoder, Formula, REGISTERS_MAX};
use mariana_field::tape::interpreter::Variant;
use mariana_field::tape::{PointEvaluator, Tape, glsl};
use mariana_testing::probe::{List, drawn};

const HEAD: &str = "#version 330 core
layout(location = 0) out vec4 color;
uniform samplerBuffer points;
uniform samplerBuffer normals;
uniform samplerBuffer programs;
uniform usamplerBuffer regions;
";
const LISTS: &str = include_str!("../../shaders/texel_lists.glsl");

/// Maximum number of registers of a region's tape.
const REGION_REGISTERS: usize = 128;

struct PointReader {
    context: Headless,
}

#[derive(Clone)]
struct Programs {
    texels: Vec<[u32; 4]>,
    /// The first texel of each tape, as a float: floats represent integers exactly below 2^24.
    starts: Vec<f32>,
    regional: Vec<bool>,
    variant: Variant,
    /// The registers of the last tape's outputs.
    outputs: Vec<u8>,
}

impl Programs {
    /// Writes a tape for each list of roots.
    fn new(graph: &Graph, tapes: &[&[NodeId]], frame: &FrameInputs, every_case: bool) -> Self {
        let mut encoder = Encoder::new(Compounds::ALL, REGISTERS_MAX);
        let (mut texels, mut starts, mut regional) = (Vec::new(), Vec::new(), Vec::new());
        let (mut operators, mut samples) = (BTreeSet::new(), 0);
        for roots in tapes {
            let used = graph.inputs_used(roots);
            let textures = used.textures.last().map_or(0, |last| usize::from(*last) + 1);
            let formula = Formula::new(graph, roots, Input::OF_POINT.len(), textures);
            let first = texels.len();
            formula.tape(&mut encoder).append(frame, &mut texels);
            let words = texels[first..].as_flattened().iter().step_by(2);
            let highest = words.map(|word| word >> 8 & 255).max();
            // A region's inputs are x, y, z and one more number.
            let of_surface = used.inputs.contains(&Input::NY) || used.inputs.contains(&Input::NZ);
            regional.push(!of_surface && textures == 0 && highest < Some(REGION_REGISTERS as u32));
            starts.push(first as f32);
            samples = samples.max(textures);
            operators.extend(graph.order(roots).into_iter().filter_map(|id| match graph.node(id) {
                Node::Unary(op, _) | Node::Binary(op, ..) => Some(op),
                _ => None,
            }));
        }
        let (compounds, registers) = (Compounds::ALL, encoder.registers.max(12).next_power_of_two());
        let variant = Variant { operators, compounds, registers, samples, textures: 0, every_case };
        Self { texels, starts, regional, variant, outputs: encoder.outputs }
    }

    fn text(&self, main: &str) -> String {
        let interpreter = include_str!("../../shaders/interpreter.glsl");
        let interpreter = interpreter.replace("#include \"texel_lists.glsl\"", LISTS).replace(
            "#include \"operators.glsl\"",
            &self.variant.text(
                &self.variant.operators,
                self.variant.compounds,
                self.variant.registers.min(REGION_REGISTERS),
            ),
        );
        let rounds = include_str!("../../shaders/rounds.glsl");
        format!("{HEAD}{CELL_HASH_GLSL}{rounds}{}{interpreter}{main}", tables_glsl())
    }
}

impl PointReader {
    /// Draws a pixel for each point (columns) and each normal (rows). Returns the pixels row by row, the first normal
    /// first.
    fn draw(
        &self,
        text: &str,
        points: &[[f32; 3]],
        normals: &[[f32; 3]],
        programs: Option<&Programs>,
    ) -> Vec<[f32; 4]> {
        let size = (points.len() as u32, normals.len() as u32);
        let [points, normals] = [points, normals]
            .map(|vectors| vectors.iter().map(|v| [v[0], v[1], v[2], 0.0]).collect::<Vec<_>>());
        let mut lists = vec![("points", List::Vectors(&points)), ("normals", List::Vectors(&normals))];
        if let Some(programs) = programs {
            let words = List::Words(&programs.texels);
            lists.extend([
                ("tape", words),
                ("regions", words),
                ("programs", List::Numbers(&programs.starts)),
            ]);
        }
        drawn(self.context.gl(), text, size, &lists)
    }
}

struct Row {
    op: Op,
    relative: f32,
    /// The maximum absolute error, which is allowed in addition to the relative error.
    absolute: f32,
    /// True for operands to which the bounds apply. The comments at the rows give the reasons for exceptions.
    trusted: fn(f32, f32) -> bool,
}

/// Operators whose result is not exact for all operands. GLSL neither defines min, max and clamp of NaN nor bounds most
/// errors of transcendental functions. These bounds are a little larger than the errors of Mesa's llvmpipe.
const ROWS: &[Row] = &[
    Row { op: Op::Exp, relative: 3e-6, absolute: 0.0, trusted: any },
    Row { op: Op::Exp2, relative: 3e-6, absolute: 0.0, trusted: any },
    Row { op: Op::Log, relative: 1e-6, absolute: 5e-7, trusted: any },
    Row { op: Op::Log2, relative: 1e-6, absolute: 5e-7, trusted: any },
    // Drivers reduce large angles in f32, or not at all.
    Row { op: Op::Sin, relative: 1e-6, absolute: 1e-6, trusted: angle },
    Row { op: Op::Cos, relative: 1e-6, absolute: 1e-6, trusted: angle },
    Row { op: Op::Tan, relative: 1e-5, absolute: 1e-6, trusted: angle },
    // llvmpipe uses polynomials. It clamps NaN to -1, unlike [`Op`].
    Row { op: Op::Asin, relative: 3e-5, absolute: 0.0, trusted: number },
    Row { op: Op::Acos, relative: 3e-5, absolute: 0.0, trusted: number },
    // llvmpipe returns 0 for NaN.
    Row { op: Op::Atan, relative: 3e-5, absolute: 0.0, trusted: number },
    Row { op: Op::Atan2, relative: 3e-5, absolute: 0.0, trusted: numbers },
    // llvmpipe computes these from exponentials, with an absolute error near 0.
    Row { op: Op::Sinh, relative: 3e-6, absolute: 1e-7, trusted: any },
    Row { op: Op::Cosh, relative: 3e-6, absolute: 0.0, trusted: any },
    Row { op: Op::Tanh, relative: 3e-6, absolute: 1e-7, trusted: number },
    // The CPU sums the weights of a cubic in a different order.
    Row { op: Op::Spectrum, relative: 0.0, absolute: 1e-6, trusted: any },
    Row { op: Op::Waveform, relative: 0.0, absolute: 1e-6, trusted: any },
    Row { op: Op::History, relative: 0.0, absolute: 1e-6, trusted: any },
    Row { op: Op::Shape, relative: 0.0, absolute: 1e-6, trusted: any },
    Row { op: Op::Div, relative: 3e-7, absolute: 0.0, trusted: any },
    // A driver flushes a subnormal quotient to 0, so the floor of a negative quotient is 0 instead of -1.
    Row { op: Op::Mod, relative: 3e-7, absolute: 0.0, trusted: quotient },
    // llvmpipe computes this from the logarithm, so the exponent multiplies the error. It returns NaN for infinities.
    Row { op: Op::Pow, relative: 1e-5, absolute: 0.0, trusted: finite },
    // llvmpipe clamps NaN to the smallest cell.
    Row { op: Op::Hash, relative: 0.0, absolute: 0.0, trusted: numbers },
    // A driver flushes a subnormal square to 0.
    Row { op: Op::SquareAdd, relative: 0.0, absolute: 0.0, trusted: square },
    Row { op: Op::OutsideAdd, relative: 0.0, absolute: 0.0, trusted: square },
    Row { op: Op::Length, relative: 0.0, absolute: 0.0, trusted: square },
];

fn any(_: f32, _: f32) -> bool {
    true
}

fn number(a: f32, _: f32) -> bool {
    !a.is_nan()
}

fn numbers(a: f32, b: f32) -> bool {
    !a.is_nan() && !b.is_nan()
}

fn finite(a: f32, b: f32) -> bool {
    a.is_finite() && b.is_finite()
}

fn quotient(a: f32, b: f32) -> bool {
    (a / b).is_normal() || a == 0.0 || b == 0.0
}

fn square(a: f32, _: f32) -> bool {
    !(a * a).is_subnormal()
}

fn angle(a: f32, _: f32) -> bool {
    a.abs() <= 100.0 || !a.is_finite()
}

fn tolerance(op: Op) -> (f32, f32) {
    ROWS.iter().find(|row| row.op == op).map_or((0.0, 0.0), |row| (row.relative, row.absolute))
}

/// Runs a tape in both ways: as a tape for materials and light, and as the tape of a region.
const RUN: &str = "
void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    int program = int(texelFetch(programs, pixel.y).x);
    vec3 p = texelFetch(points, pixel.x).xyz;
    vec3 n = texelFetch(normals, pixel.y).xyz;
    color = vec4(run_tape(program, p, n), run_region(program, p, n.x));
}
";

fn compiled_text(graph: &Graph, roots: &[NodeId]) -> String {
    let mut text = format!("{HEAD}{CELL_HASH_GLSL}{}", tables_glsl());
    let mut main = String::from(
        "void main() {\n    ivec2 pixel = ivec2(gl_FragCoord.xy);\n    vec3 p = texelFetch(points, pixel.x).xyz;\n    vec3 n = texelFetch(normals, pixel.y).xyz;\n    float r = 0.0;\n",
    );
    for (place, root) in roots.iter().enumerate() {
        text += &glsl::function(graph, &[*root], &format!("compiled_{place}"), glsl::Sampling::None);
        main += &format!("    if (pixel.y == {place}) r = compiled_{place}(p, n);\n");
    }
    text + &main + "    color = vec4(r, 0.0, 0.0, 0.0);\n}\n"
}

/// The interpreter's results for expressions of one graph. Rows are expressions, columns are points.
struct Interpreted {
    values: Vec<[f32; 4]>,
    regional: Vec<bool>,
    columns: usize,
}

impl Interpreted {
    /// The results at a row and a column, each with the name of the GLSL function that computed it.
    fn at(&self, row: usize, column: usize) -> impl Iterator<Item = (&'static str, f32)> {
        let [tape, _, region, _] = self.values[row * self.columns + column];
        let region = self.regional[row].then_some(("run_region", region));
        [("run_tape", tape)].into_iter().chain(region)
    }
}

fn run(
    point_reader: &PointReader,
    graph: &Graph,
    roots: &[NodeId],
    every_case: bool,
    points: &[[f32; 3]],
    normals: &[[f32; 3]],
) -> Interpreted {
    let tapes: Vec<&[NodeId]> = roots.chunks(1).collect();
    let programs = Programs::new(graph, &tapes, &frame(), every_case);
    let values = point_reader.draw(&programs.text(RUN), points, normals, Some(&programs));
    Interpreted { values, regional: programs.regional, columns: points.len() }
}

/// Flushes subnormal numbers and -0 to 0, as a driver may.
fn flushed(value: f32) -> f32 {
    if value.is_normal() || !value.is_finite() { value } else { 0.0 }
}

fn close(got: f32, right: f32, relative: f32, absolute: f32) -> bool {
    got == right
        || got.is_nan() && right.is_nan()
        || (got - right).abs() <= relative * right.abs() + absolute && got.is_finite()
}

fn operands() -> Vec<f32> {
    let mut numbers =
        vec![0.0, 1.0, 0.5, 2.0, 3.0, 31.5, 100.0, 1e4, 1e20, 1e-20, 3e38, 1.2e-38, f32::INFINITY];
    // These numbers are critical for rounding to integers.
    numbers.extend([0.49999997, 8_388_609.0, 16_777_216.0]);
    let mut random = Random(7);
    numbers.extend((0..16).map(|_| random.between(0.0, 1.0)));
    numbers.extend((0..24).map(|_| random.between(0.0, 10.0)));
    let negative: Vec<f32> = numbers.iter().map(|v| -v).collect();
    numbers.extend(negative);
    numbers.push(f32::NAN);
    numbers
}

#[test]
fn every_operator_agrees_on_ordinary_and_extreme_operands() {
    let point_reader = PointReader { context: Headless::new(false).unwrap() };
    let numbers = operands();
    let points: Vec<[f32; 3]> = numbers.iter().flat_map(|a| numbers.iter().map(|b| [*a, *b, 0.0])).collect();
    let mut graph = Graph::new();
    let (x, y) = (graph.input(Input::X), graph.input(Input::Y));
    let node_of = |op: Op| if op.arity() == 1 { Node::Unary(op, x) } else { Node::Binary(op, x, y) };
    let roots: Vec<NodeId> = Op::ALL.iter().map(|op| graph.raw(node_of(*op))).collect();
    let normals = vec![[0.0; 3]; roots.len()];
    let selected = run(&point_reader, &graph, &roots, true, &points, &normals);
    let switched = run(&point_reader, &graph, &roots, false, &points, &normals);
    let compiled = point_reader.draw(&compiled_text(&graph, &roots), &points, &normals, None);

    let (frame, mut wrong, mut trusted) = (frame(), Vec::new(), vec![0; roots.len()]);
    for (row, &op) in Op::ALL.iter().enumerate() {
        let rule = ROWS.iter().find(|row| row.op == op);
        let (relative, absolute) = tolerance(op);
        for (column, &[a, b, _]) in points.iter().enumerate() {
            if rule.is_some_and(|rule| !(rule.trusted)(a, b)) {
                continue;
            }
            trusted[row] += 1;
            let right = flushed(op.value(a, b, &frame));
            let mut check = |name: &str, how: &str, got: f32| {
                if !close(flushed(got), right, relative, absolute) {
                    wrong.push(format!("{}({a:e}, {b:e}) is {right:e}; {how} {name}: {got:e}", op.name()));
                }
            };
            for (values, how) in [(&selected, "selected"), (&switched, "switched")] {
                values.at(row, column).for_each(|(name, got)| check(name, how, got));
            }
            check("compiled", "", compiled[row * points.len() + column][0]);
        }
    }
    assert!(
        wrong.is_empty(),
        "{} wrong values, such as\n{}",
        wrong.len(),
        wrong[..wrong.len().min(40)].join("\n")
    );
    assert!(trusted.iter().all(|count| *count > points.len() / 2), "{trusted:?}");
}

#[test]
fn every_compound_agrees() {
    let point_reader = PointReader { context: Headless::new(false).unwrap() };
    let numbers: Vec<f32> = operands().into_iter().filter(|number| number.abs() <= 100.0).collect();
    let points: Vec<[f32; 3]> = numbers.iter().flat_map(|a| numbers.iter().map(|b| [*a, *b, 0.0])).collect();
    const C: f32 = 0.7;
    let mut graph = Graph::new();
    let (x, y) = (graph.input(Input::X), graph.input(Input::Y));
    let roots: Vec<NodeId> =
        Compound::ALL.iter().map(|compound| compound.nodes(&mut graph, x, y, C)).collect();
    let normals = vec![[0.0; 3]; roots.len()];
    let frame = frame();
    for every_case in [true, false] {
        let found = run(&point_reader, &graph, &roots, every_case, &points, &normals);
        for (row, compound) in Compound::ALL.iter().enumerate() {
            for (column, &[a, b, _]) in points.iter().enumerate() {
                let right = flushed(compound.value(a, b, C, &frame));
                // A compound may subtract a number as large as an operand's square.
                let rounding = 4e-7 * (1.0 + a * a * (1.0 + a.abs()) + b * b);
                let mut kinds = 0;
                for (kind, got) in found.at(row, column) {
                    kinds += 1;
                    assert!(
                        close(flushed(got), right, 1e-6, rounding),
                        "{compound:?}({a:e}, {b:e}) is {right:e}; {kind}, every case {every_case}: {got:e}"
                    );
                }
                assert!(kinds > 0);
            }
        }
    }
}

/// Returns a change of `result` that is as large as the operator's rounding error: the bound in [`ROWS`], or two
/// units in the last place for arithmetic, which drivers may fuse and reorder.
fn disturbance(op: Op, a: f32, result: f32) -> f32 {
    const ULPS: f32 = 2.4e-7;
    match op {
        Op::Add | Op::Sub | Op::Mul | Op::Square | Op::Sqrt => ULPS * result.abs(),
        Op::AbsDifference | Op::AbsSub => ULPS * result.abs(),
        // The intermediate result of a fused operator is also rounded.
        Op::SquareDifference | Op::Length => 2.0 * ULPS * result.abs(),
        Op::SquareAdd | Op::OutsideAdd => ULPS * (a * a + result.abs()),
        Op::SqrtSub => ULPS * (a.max(0.0).sqrt() + result.abs()),
        // Drivers may replace the quotient of a tiny number, which has no full precision, by 0.
        Op::Mod if a != 0.0 && a.abs() < 1e-30 => result.abs(),
        // The result may be a small difference of large numbers.
        Op::Fract | Op::Mod => ULPS * a.abs(),
        Op::Spectrum | Op::Waveform | Op::History | Op::Shape => ULPS,
        op => {
            let (relative, absolute) = tolerance(op);
            relative * result.abs() + absolute
        }
    }
}

#[test]
fn random_expressions_agree() {
    // Without its optimizer, llvmpipe compiles these shaders in a third of the time.
    apart!("GALLIVM_PERF" = "nopt");
    const EXPRESSIONS: usize = 2_000;
    const POINTS: usize = 256;
    const PER_SHADER: usize = 50;
    const LARGEST: f32 = 1e38;
    let point_reader = PointReader { context: Headless::new(false).unwrap() };
    let mut random = Random(1);
    let mut graph = Graph::new();
    let roots: Vec<NodeId> = (0..EXPRESSIONS)
        .map(|_| {
            let operators = 1 + random.below(11);
            random_expression(&mut random, &mut graph, operators)
        })
        .collect();
    let points: Vec<[f32; 3]> =
        (0..POINTS).map(|_| std::array::from_fn(|_| random.between(-4.0, 4.0))).collect();
    let normals: Vec<[f32; 3]> =
        roots.iter().map(|_| std::array::from_fn(|_| random.between(-1.0, 1.0))).collect();
    let interpreted = run(&point_reader, &graph, &roots, true, &points, &normals);
    let mut compiled = Vec::new();
    for (roots, normals) in roots.chunks(PER_SHADER).zip(normals.chunks(PER_SHADER)) {
        compiled.extend(point_reader.draw(&compiled_text(&graph, roots), &points, normals, None));
    }

    let frame = frame();
    let (mut wrong, mut counted) = (Vec::new(), 0);
    let mut occurrences: BTreeMap<&str, usize> = Op::ALL.iter().map(|op| (op.name(), 0)).collect();
    for (row, &root) in roots.iter().enumerate() {
        let order = graph.order(&[root]);
        for &id in &order {
            if let Node::Unary(op, _) | Node::Binary(op, _, _) = graph.node(id) {
                *occurrences.entry(op.name()).or_default() += 1;
            }
        }
        let tape = Tape::new(&graph, &[root]);
        let mut evaluator = PointEvaluator::new(&tape, &frame);
        for (column, &position) in points.iter().enumerate() {
            let point = Point { position, normal: normals[row] };
            let right = evaluator.at(&point)[0];
            // Drivers compute powers in parts, which overflow before the result does.
            if !right.is_finite()
                || right.abs() > LARGEST
                || spread(&graph, &order, &point, &frame, disturbance, &mut random) > 1e-4 * right.abs()
            {
                continue;
            }
            counted += 1;
            let mut check = |name: &str, got: f32| {
                if !close(got, right, 1e-4, 1e-30) {
                    wrong.push(format!("expression {row}, {point:?}: {right:e}; {name}: {got:e}"));
                }
            };
            interpreted.at(row, column).for_each(|(name, got)| check(name, got));
            check("compiled", compiled[row * POINTS + column][0]);
        }
    }
    let fraction = counted as f64 / (EXPRESSIONS * POINTS) as f64;
    assert!(
        wrong.is_empty(),
        "{} wrong values, such as\n{}",
        wrong.len(),
        wrong[..wrong.len().min(20)].join("\n")
    );
    assert!(fraction >= 0.9, "only {fraction} of the points count");
    assert!(occurrences.values().all(|count| *count >= 100), "{occurrences:?}");
}

/// A sum of many products of distinct constants. The products are needed until the end, so many do not fit into the
/// registers of a region. All operations are exact.
fn wide_expression(graph: &mut Graph, terms: usize) -> NodeId {
    let inputs = [Input::X, Input::Y, Input::Z, Input::NX].map(|input| graph.input(input));
    let products: Vec<NodeId> = (0..terms)
        .map(|i| {
            let number = graph.constant(i as f32 * 0.5 - 7.0);
            let product = graph.mul(inputs[i % 4], number);
            graph.max(product, inputs[(i + 1) % 4])
        })
        .collect();
    // Sum the products forwards, then subtract them backwards, so that the first products are needed last.
    let first = products.iter().copied().reduce(|a, b| graph.add(a, b)).unwrap();
    products.iter().rev().copied().fold(first, |a, b| graph.sub(b, a))
}

#[test]
fn any_number_of_registers_gives_the_same_values() {
    let point_reader = PointReader { context: Headless::new(false).unwrap() };
    let mut random = Random(3);
    let points: Vec<[f32; 3]> = (0..32).map(|_| std::array::from_fn(|_| random.between(-2.0, 2.0))).collect();
    let normals = [[0.25, 0.5, -0.75]];
    for terms in [6, 20, 40, 100, 200] {
        let mut graph = Graph::new();
        let root = wide_expression(&mut graph, terms);
        let tape = Tape::new(&graph, &[root]);
        let frame = frame();
        let mut evaluator = PointEvaluator::new(&tape, &frame);
        for every_case in [true, false] {
            let values = run(&point_reader, &graph, &[root], every_case, &points, &normals);
            assert_eq!(values.regional, [terms <= 100]);
            for (column, &position) in points.iter().enumerate() {
                let right = evaluator.at(&Point { position, normal: normals[0] })[0];
                for (name, got) in values.at(0, column) {
                    assert!(
                        close(got, right, 1e-6, 0.0),
                        "{terms} terms, every case {every_case}, {name}: {got} instead of {right}"
                    );
                }
            }
        }
    }
}

#[test]
fn textures_return_samples_and_outputs_are_in_their_registers() {
    let point_reader = PointReader { context: Headless::new(false).unwrap() };
    let mut graph = Graph::new();
    let x = graph.input(Input::X);
    let zero = graph.constant(0.0);
    let mut roots: Vec<NodeId> =
        (0..4).map(|channel| graph.texture(channel + 3, channel as u8, zero, zero)).collect();
    roots.extend((0..8).map(|i| {
        let number = graph.constant(i as f32);
        graph.add(x, number)
    }));
    let programs = |every_case| Programs::new(&graph, &[&roots], &frame(), every_case);
    let registers: Vec<String> = programs(true).outputs.iter().map(u8::to_string).collect();
    let main = format!(
        "void main() {{
    for (int i = 0; i < 4 * SAMPLES; i++) sampled[i] = float(i);
    run_tape(0, vec3(1.0, 2.0, 0.0), vec3(0.0));
    int registers[12] = int[12]({});
    color = vec4(tape_file[registers[int(gl_FragCoord.x)]]);
}}
",
        registers.join(", ")
    );
    for every_case in [true, false] {
        let programs = programs(every_case);
        assert_eq!(programs.variant.samples, 7);
        let values = point_reader.draw(&programs.text(&main), &[[0.0; 3]; 12], &[[0.0; 3]], Some(&programs));
        let mut expected: Vec<f32> = (0..4).map(|channel| (4 * (channel + 3) + channel) as f32).collect();
        expected.extend((0..8).map(|i| 1.0 + i as f32));
        assert_eq!(values, expected.iter().map(|value| [*value; 4]).collect::<Vec<_>>());
    }
}

#[test]
fn glslang_accepts_every_kind_of_interpreter() {
    let mut graph = Graph::new();
    let x = graph.input(Input::X);
    let programs = Programs::new(&graph, &[&[x]], &frame(), true);
    for every_case in [true, false] {
        for (registers, samples) in [(8, 0), (8, 2), (16, 12), (256, 1)] {
            let operators = Op::ALL.iter().copied().collect();
            let compounds = Compounds::ALL;
            let variant = Variant { operators, compounds, registers, samples, textures: 0, every_case };
            let text = Programs { variant: variant.clone(), ..programs.clone() }.text(RUN);
            if let Err(complaint) = check_with_glslang(Stage::Fragment, &text) {
                panic!("{variant:?}: {complaint}");
            }
        }
    }
}
