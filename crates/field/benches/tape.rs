//! Measures how fast the CPU builds graphs, builds tapes and runs tapes. Throughput counts clauses; for runs, clauses
//! times points.

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use mariana_field::graph::{FrameInputs, Graph, Input, NodeId, Point};
use mariana_field::lang::compile;
use mariana_field::tape::{Batch, GradientBatch, PointEvaluator, Points, Tape};

fn scene(graph: &mut Graph, count: usize) -> NodeId {
    let p = [Input::X, Input::Y, Input::Z].map(|input| graph.input(input));
    let zero = graph.constant(0.0);
    let mut shapes = Vec::with_capacity(count * 2);
    for i in 0..count {
        let at = [i % 7, i / 7 % 7, i / 49].map(|cell| cell as f32 * 1.25 - 4.0 + i as f32 * 1e-3);
        let centre = at.map(|v| graph.constant(v));
        let q: [NodeId; 3] = std::array::from_fn(|axis| graph.sub(p[axis], centre[axis]));
        let half = graph.constant(0.25 + i as f32 * 1e-4);
        let d = q.map(|q| {
            let far = graph.abs(q);
            graph.sub(far, half)
        });
        let outside = d.map(|d| graph.max(d, zero));
        let outside = graph.length(&outside);
        let deepest = graph.max(d[1], d[2]);
        let deepest = graph.max(d[0], deepest);
        let inside = graph.min(deepest, zero);
        shapes.push(graph.add(outside, inside));
        if i % 2 == 0 {
            let length = graph.length(&q);
            shapes.push(graph.sub(length, half));
        }
    }
    while shapes.len() > 1 {
        shapes = shapes
            .chunks(2)
            .map(|pair| if let [a, b] = pair { graph.min(*a, *b) } else { pair[0] })
            .collect();
    }
    shapes[0]
}

/// A `map` of 300 lines: shapes, rotations, a loop and blends.
fn shader() -> String {
    let mut text = String::from(
        "mat2 rot(float a) { float c = cos(a), s = sin(a); return mat2(c, -s, s, c); }\n\
         float box(vec3 p, vec3 b) { vec3 q = abs(p) - b; return length(max(q, 0.0)) + min(max(q.x, max(q.y, q.z)), 0.0); }\n\
         vec2 opU(vec2 a, vec2 b) { return a.x < b.x ? a : b; }\n\
         vec2 map(vec3 p) {\nvec2 res = vec2(p.y + 1.0, 0.0);\n",
    );
    for part in 0..59 {
        let at = part as f32 * 0.37;
        text.push_str(&format!(
            "vec3 q{part} = p - vec3({at:.2}, 0.5, {:.2});\nq{part}.xz *= rot(iTime + {at:.2});\n\
             for (int i = 0; i < 3; i++) q{part}.xy = abs(q{part}.xy) - 0.1 * float(i);\n\
             float d{part} = box(q{part}, vec3(0.2, 0.3, {:.2}));\nres = opU(res, vec2(d{part}, {part}.0));\n",
            at * 0.5,
            0.1 + at * 0.01
        ));
    }
    text + "return res;\n}\n"
}

/// From the text of a scene that includes GLSL to its tape.
fn glsl(c: &mut Criterion) {
    let text = shader();
    let scene = "include \"a.glsl\"\nobject a { shape = map(p).x }";
    c.bench_function("glsl_of_300_lines", |b| {
        b.iter(|| {
            let compiled = compile("bench", scene, &mut |_| Ok(text.clone()));
            let scene = compiled.scene?;
            Some(Tape::new(&scene.graph, &[scene.distance]))
        });
    });
}

fn tape(c: &mut Criterion) {
    for count in [40, 400] {
        let mut graph = Graph::new();
        let root = scene(&mut graph, count);
        let tape = Tape::new(&graph, &[root]);
        let clauses = tape.clauses.len() as u64;
        let mut group = c.benchmark_group(format!("tape_{clauses}_clauses"));
        group.throughput(Throughput::Elements(clauses));
        group.bench_function("graph", |b| {
            b.iter(|| {
                let mut graph = Graph::new();
                black_box(scene(&mut graph, count))
            });
        });
        group.bench_function("build", |b| b.iter(|| Tape::new(&graph, &[root])));
        let frame = FrameInputs::default();
        let mut points = PointEvaluator::new(&tape, &frame);
        group.bench_function("point", |b| b.iter(|| points.at(black_box(&Point::at(0.1, 0.2, 0.3)))[0]));
        let mut gradients = GradientBatch::new(&tape, &frame);
        let mut duals = Vec::new();
        group.bench_function("gradients_at_8_points", |b| {
            b.iter(|| gradients.run(black_box(&[[0.1, 0.2, 0.3]; 8]), &mut duals));
        });
        let xs: Vec<f32> = (0..1024).map(|i| i as f32 * 0.01).collect();
        let mut batch = Batch::new(&tape, &frame);
        group.throughput(Throughput::Elements(clauses * xs.len() as u64));
        group.bench_function("batch_of_1024_points", |b| {
            b.iter(|| batch.run(black_box(Points { position: [&xs, &xs, &xs], normal: None })));
        });
    }
}

criterion_group!(benches, glsl, tape);
criterion_main!(benches);
