//! Measures the CPU time from a scene's text to the interpreter's program, as after an edit. Compares this time with
//! fidget's, on one thread and without JIT. Earlier work of Keeter, fidget's author, is the basis of the tape. Run this
//! with `cargo bench --features peer --bench language`. The feature is off by default: fidget compiles slowly.
//!
//! Both sides begin with a text in memory and end with the program of their interpreter:
//!
//! - **mariana** lexes, parses and checks the text, expands functions, merges common subexpressions, allocates a tape
//!   to 256 registers and writes it as words. A text is a whole scene, so the default material, light, camera and sky
//!   are also built.
//! - **fidget**: `Context::from_text` (one instruction per line: no precedence, types or functions; constants in f64;
//!   common subexpressions merged), then `VmFunction::new`, a tape of 255 registers.
//!
//! Throughput counts the lines of fidget's text or, for scenes without such a text, the clauses of the tape. A formula
//! has fewer lines than fidget's text; the row `lets` has one `let` for each of fidget's lines.

#![allow(clippy::expect_used)]

use std::fmt::Write;
use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use fidget::context::Context;
use fidget::eval::MathFunction;
use fidget::vm::{VmFunction, VmShape};
use mariana_field::graph::{Compounds, FrameInputs, Point};
use mariana_field::lang::{compile, no_includes};
use mariana_field::region::{Encoder, Formula, REGISTERS_MAX};
use mariana_field::tape::{PointEvaluator, Tape};

fn tape(text: &str) -> Tape {
    let scene = compile("bench.scene", text, &mut no_includes).scene.expect("the text is a scene");
    Tape::new(&scene.graph, &[scene.distance])
}

/// Returns the program for the distance in the scene `text`, as the texels that the interpreter shader reads.
fn words(text: &str) -> Vec<[u32; 4]> {
    let scene = compile("bench.scene", text, &mut no_includes).scene.expect("the text is a scene");
    let formula = Formula::new(&scene.graph, &[scene.distance], 3, 0);
    let mut texels = Vec::new();
    let tape = formula.tape(&mut Encoder::new(Compounds::NONE, REGISTERS_MAX));
    tape.append(&FrameInputs::default(), &mut texels);
    texels
}

fn fidget_tape(text: &str) -> VmFunction {
    let (context, root) = Context::from_text(text.as_bytes()).expect("fidget reads the text");
    VmFunction::new(&context, &[root]).expect("it has a tape")
}

/// An expression as a list of instructions. Each has a name, the indices of its operands, and a value for constants.
#[derive(Default)]
struct Lines(Vec<(&'static str, Vec<usize>, f64)>);

impl Lines {
    fn constant(&mut self, value: f64) -> usize {
        self.0.push(("const", Vec::new(), value));
        self.0.len() - 1
    }

    fn op(&mut self, name: &'static str, operands: &[usize]) -> usize {
        self.0.push((name, operands.to_vec(), 0.0));
        self.0.len() - 1
    }

    fn instructions(&self) -> String {
        let mut text = String::new();
        for (place, (name, operands, value)) in self.0.iter().enumerate() {
            let _ = write!(text, "_{place:x} {name}");
            for operand in operands {
                let _ = write!(text, " _{operand:x}");
            }
            text += &if *name == "const" { format!(" {value:.3}\n") } else { "\n".to_owned() };
        }
        text
    }

    fn lets(&self) -> String {
        let mut text = String::new();
        for (place, (name, operands, value)) in self.0.iter().enumerate() {
            let name_of = |which: usize| format!("_{:x}", operands[which]);
            let right = match *name {
                "const" => format!("{value:.3}"),
                "var-x" => "x".to_owned(),
                "var-y" => "y".to_owned(),
                "var-z" => "z".to_owned(),
                "add" => format!("{} + {}", name_of(0), name_of(1)),
                "sub" => format!("{} - {}", name_of(0), name_of(1)),
                "mul" => format!("{} * {}", name_of(0), name_of(1)),
                "square" => format!("{} ^ 2", name_of(0)),
                "min" | "max" => format!("{name}({}, {})", name_of(0), name_of(1)),
                _ => format!("{name}({})", name_of(0)),
            };
            let _ = writeln!(text, "let _{place:x} = {right}");
        }
        text + &format!("_{:x}\n", self.0.len() - 1)
    }
}

/// Returns the plane y = 0 and a ball, as instructions and as the text in section 4.4 of the thesis.
fn plane_and_ball() -> (Lines, String) {
    let mut lines = Lines::default();
    let [x, y, z] = ["var-x", "var-y", "var-z"].map(|name| lines.op(name, &[]));
    let [one, six] = [1.0, 6.0].map(|value| lines.constant(value));
    let (up, ahead) = (lines.op("sub", &[y, one]), lines.op("sub", &[z, six]));
    let [a, b, c] = [x, up, ahead].map(|side| lines.op("square", &[side]));
    let sum = lines.op("add", &[a, b]);
    let sum = lines.op("add", &[sum, c]);
    let length = lines.op("sqrt", &[sum]);
    let ball = lines.op("sub", &[length, one]);
    lines.op("min", &[y, ball]);
    (lines, "min(y, sqrt(x*x+(y-1)*(y-1)+(z-6)*(z-6))-1)".to_owned())
}

fn boxes_and_balls(count: usize) -> (Lines, String) {
    let mut lines = Lines::default();
    let mut shapes = Vec::new();
    let p = ["var-x", "var-y", "var-z"].map(|name| lines.op(name, &[]));
    let zero = lines.constant(0.0);
    let mut union = None;
    for i in 0..count {
        let centre = [7, 13, 29].map(|step| (i * step % 997) as f64 * 0.037 - 15.0);
        let size = [0.2, 0.3, 0.4].map(|least| least + i as f64 * 0.001);
        let q: [usize; 3] = std::array::from_fn(|axis| {
            let at = lines.constant(centre[axis]);
            lines.op("sub", &[p[axis], at])
        });
        let length = |lines: &mut Lines, v: [usize; 3]| {
            let [a, b, c] = v.map(|side| lines.op("square", &[side]));
            let sum = lines.op("add", &[a, b]);
            let sum = lines.op("add", &[sum, c]);
            lines.op("sqrt", &[sum])
        };
        let [x, y, z] = centre.map(|value| format!("{value:.3}"));
        let [width, height, depth] = size.map(|value| format!("{value:.3}"));
        let shape = if i % 2 == 0 {
            shapes.push(format!("box(p - vec3({x}, {y}, {z}), vec3({width}, {height}, {depth}))"));
            let d: [usize; 3] = std::array::from_fn(|axis| {
                let (side, half) = (lines.op("abs", &[q[axis]]), lines.constant(size[axis]));
                lines.op("sub", &[side, half])
            });
            let outside = d.map(|side| lines.op("max", &[side, zero]));
            let outside = length(&mut lines, outside);
            let inside = lines.op("max", &[d[0], d[1]]);
            let inside = lines.op("max", &[inside, d[2]]);
            let inside = lines.op("min", &[inside, zero]);
            lines.op("add", &[outside, inside])
        } else {
            shapes.push(format!("sphere(p - vec3({x}, {y}, {z}), {width})"));
            let (length, radius) = (length(&mut lines, q), lines.constant(size[0]));
            lines.op("sub", &[length, radius])
        };
        union = Some(union.map_or(shape, |union| lines.op("min", &[union, shape])));
    }
    (lines, format!("union({})", shapes.join(",\n")))
}

/// Returns a formula of `count` balls without common subexpressions.
fn balls(count: usize) -> String {
    let ball = |i: usize| {
        let [x, y, z] = [7, 13, 29].map(|step| (i * step % 997) as f64 * 0.037 - 15.0);
        format!("length(p - vec3({x:.3}, {y:.3}, {z:.3})) - {:.3}", 0.2 + i as f64 * 0.001)
    };
    format!("union({})", (0..count).map(ball).collect::<Vec<_>>().join(",\n"))
}

fn assert_same(text: &str, instructions: &str) {
    let (tape, frame) = (tape(text), FrameInputs::default());
    let mut ours = PointEvaluator::new(&tape, &frame);
    let (context, root) = Context::from_text(instructions.as_bytes()).expect("fidget reads the text");
    let shape = VmShape::new(&context, root).expect("it has a tape");
    let (theirs, mut evaluator) = (shape.point_tape(Default::default()), VmShape::new_point_eval());
    for i in 0..200 {
        let [x, y, z] = [11, 17, 23].map(|step| (i * step % 199) as f32 * 0.1 - 10.0);
        let a = ours.at(&Point::at(x, y, z))[0];
        let (b, _) = evaluator.eval(&theirs, x, y, z).expect("it has three variables");
        assert!((a - b).abs() < 1e-4, "{a} and {b} at {x} {y} {z}");
    }
}

fn text_to_words(criterion: &mut Criterion) {
    // Free a large block, so that glibc keeps freed pages as it does in the program. Otherwise each iteration would get
    // new pages from the system.
    drop(black_box(vec![1_u8; 16 << 20]));
    let mut group = criterion.benchmark_group("text_to_words");
    // The second expression has about as many lines as fidget's largest model.
    let both = [("plane and ball", plane_and_ball()), ("boxes and balls", boxes_and_balls(358))];
    for (name, (lines, formula)) in &both {
        let (instructions, lets) = (lines.instructions(), lines.lets());
        group.throughput(Throughput::Elements(lines.0.len() as u64));
        for (side, text) in [("mariana, formula", formula), ("mariana, lets", &lets)] {
            assert_same(text, &instructions);
            println!("{name}, {side}: {} lines, {} clauses", lines.0.len(), tape(text).clauses.len());
            group.bench_function(BenchmarkId::new(side, name), |bencher| {
                bencher.iter(|| words(black_box(text)));
            });
        }
        group.bench_function(BenchmarkId::new("fidget", name), |bencher| {
            bencher.iter(|| fidget_tape(black_box(&instructions)));
        });
    }
    let speakers = include_str!("../../../assets/scenes/speakers.scene").to_owned();
    let [thousand, ten_thousand] = [1_000, 10_000].map(|count| boxes_and_balls(count).1);
    let texts = [
        ("speakers", speakers),
        ("786 balls", balls(786)),
        ("1,000 boxes and balls", thousand),
        ("10,000 boxes and balls", ten_thousand),
    ];
    for (name, text) in texts {
        group.throughput(Throughput::Elements(tape(&text).clauses.len() as u64));
        group.bench_function(BenchmarkId::new("mariana", name), |bencher| {
            bencher.iter(|| words(black_box(&text)));
        });
    }
    group.finish();
}

criterion_group!(benches, text_to_words);
criterion_main!(benches);
