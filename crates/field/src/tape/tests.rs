//! Tests of tapes: Table 1, exact values, bounds and gradients.

use proptest::prelude::*;

use super::*;
use crate::graph::testing::{build, frame, number, same, steps};
use crate::graph::{Compounds, Interval, Op, Point};
use mariana_testing::thesis::TABLE_1;

fn config(cases: u32) -> ProptestConfig {
    let cases = ProptestConfig::default().cases.max(cases);
    ProptestConfig { cases, failure_persistence: None, ..ProptestConfig::default() }
}

/// max(sqrt(x*x+y*y)-1, 0.5-sqrt(x*x+y*y))
fn ring(graph: &mut Graph) -> NodeId {
    let (x, y) = (graph.input(Input::X), graph.input(Input::Y));
    let (xx, yy) = (graph.mul(x, x), graph.mul(y, y));
    let sum = graph.add(xx, yy);
    let radius = graph.sqrt(sum);
    let (one, half) = (graph.constant(1.0), graph.constant(0.5));
    let (outer, inner) = (graph.sub(radius, one), graph.sub(half, radius));
    graph.max(outer, inner)
}

#[test]
fn table_1_of_the_thesis() {
    let mut graph = Graph::new();
    let root = ring(&mut graph);
    let tape = Tape::new(&graph, &[root]);
    let text = tape.to_string();
    let mut lines = text.lines();
    assert_eq!(
        lines.next().unwrap().split_whitespace().collect::<Vec<_>>(),
        ["opcode", "input_A", "input_B", "output"]
    );
    let rows: Vec<Vec<String>> = lines
        .map(|line| {
            line.replace("slot ", "slot~").split_whitespace().map(|cell| cell.replace('~', " ")).collect()
        })
        .collect();
    assert_eq!(rows, TABLE_1);
    assert_eq!((tape.registers, &tape.outputs[..]), (2, &[Operand::Register(1)][..]));
}

fn point(values: [f32; 6]) -> Point {
    let [x, y, z, nx, ny, nz] = values;
    Point { position: [x, y, z], normal: [nx, ny, nz] }
}

proptest! {
    #![proptest_config(config(1_000))]

    #[test]
    fn tapes_equal_the_graph_bit_for_bit(
        steps in steps(120),
        values in proptest::collection::vec(proptest::array::uniform6(number()), 1..70),
        simplify: bool,
        outputs in 1usize..4,
    ) {
        let mut graph = Graph::new();
        let built = build(&mut graph, &steps, simplify);
        let roots: Vec<NodeId> = built.iter().rev().copied().take(outputs).collect();
        let tape = Tape::new(&graph, &roots);
        let frame = frame();
        let mut evaluator = PointEvaluator::new(&tape, &frame);
        let mut duals = GradientBatch::new(&tape, &frame);
        let columns: [Vec<f32>; 6] = std::array::from_fn(|place| values.iter().map(|v| v[place]).collect());
        let [x, y, z, nx, ny, nz] = &columns;
        let points = Points { position: [x, y, z], normal: Some([nx, ny, nz]) };
        let batch = Batch::new(&tape, &frame).run(points);
        for (row, &values) in values.iter().enumerate() {
            let point = point(values);
            let expected = graph.evaluate(&roots, &point, &frame);
            let found = evaluator.at(&point);
            let [x, y, z] = point.position;
            let without_normal = graph.evaluate(&roots[..1], &Point::at(x, y, z), &frame)[0];
            prop_assert!(same(without_normal, duals.at(point.position).value));
            for place in 0..roots.len() {
                prop_assert!(same(expected[place], found[place]), "{} is not {}\n{tape}", found[place], expected[place]);
                prop_assert!(same(expected[place], batch[place][row]), "batch: {} {}", batch[place][row], expected[place]);
            }
        }
    }

    #[test]
    fn bounds_hold_every_value_of_a_tape(
        steps in steps(40),
        ends in proptest::array::uniform6([number(), number()]),
        along in proptest::collection::vec(proptest::array::uniform6(0.0f32..=1.0), 8),
    ) {
        let mut graph = Graph::new();
        let root = *build(&mut graph, &steps, true).last().unwrap();
        let tape = Tape::new(&graph, &[root]);
        let frame = frame();
        let sides = ends.map(|[a, b]| Interval::new(a.min(b), a.max(b)));
        let bounds = graph.bounds(root, sides, &frame);
        let mut points = PointEvaluator::new(&tape, &frame);
        for along in along {
            let inside = std::array::from_fn(|place| {
                let (side, t): (Interval, f32) = (sides[place], along[place]);
                let value = (side.lo * (1.0 - t) + side.hi * t).max(side.lo).min(side.hi);
                if t < 0.1 || value.is_nan() { side.lo } else { value }
            });
            let value = points.at(&point(inside))[0];
            prop_assert!(bounds.contains(value), "{value:?} is not in {bounds:?} at {inside:?} of {sides:?}\n{tape}");
        }
    }
}

#[test]
fn gradients_match_known_ones() {
    let mut g = Graph::new();
    let p = [Input::X, Input::Y, Input::Z].map(|input| g.input(input));
    let length = g.length(&p);
    let one = g.constant(1.0);
    let sphere = g.sub(length, one);
    let sines = p.map(|v| g.unary(Op::Sin, v));
    let cosines = p.map(|v| g.unary(Op::Cos, v));
    let gyroid = g.dot(&sines, &[cosines[1], cosines[2], cosines[0]]);
    let frame = FrameInputs::default();
    let tapes = [sphere, gyroid].map(|root| Tape::new(&g, &[root]));
    let mut evaluators = tapes.each_ref().map(|tape| GradientBatch::new(tape, &frame));
    for [x, y, z] in [[1.0f32, 2.0, 2.0], [-0.3, 0.4, 1.2], [3.0, -4.0, 0.0]] {
        let found = evaluators.each_mut().map(|evaluator| evaluator.at([x, y, z]));
        let r = (x * x + y * y + z * z).sqrt();
        let (sin, cos) = ([x, y, z].map(f32::sin), [x, y, z].map(f32::cos));
        let expected = [
            [x / r, y / r, z / r],
            [
                cos[0] * cos[1] - sin[2] * sin[0],
                cos[1] * cos[2] - sin[0] * sin[1],
                cos[2] * cos[0] - sin[1] * sin[2],
            ],
        ];
        for (found, expected) in found.iter().zip(expected) {
            for axis in 0..3 {
                assert!((found.gradient[axis] - expected[axis]).abs() < 1e-5, "{found:?} {expected:?}");
            }
        }
    }
}

fn with_constants(count: usize) -> Tape {
    let mut graph = Graph::new();
    let x = graph.input(Input::X);
    let mut sum = x;
    for i in 0..count {
        let constant = graph.constant(1.5 + i as f32);
        let product = graph.mul(x, constant);
        sum = graph.max(sum, product);
    }
    let tape = Tape::new(&graph, &[sum]);
    let frame = FrameInputs::default();
    let found = PointEvaluator::new(&tape, &frame).at(&Point::at(2.0, 0.0, 0.0))[0];
    assert_eq!(found, 2.0 * (0.5 + count as f32));
    tape
}

#[test]
fn any_number_of_constants() {
    for count in [256, 257, 70_000] {
        let tape = with_constants(count);
        assert_eq!((tape.table.len(), tape.registers), (count, 3));
    }
}

#[test]
fn deep_expressions_need_no_stack_and_few_registers() {
    let mut graph = Graph::new();
    let x = graph.input(Input::X);
    let (mut left, mut right) = (x, x);
    for i in 0..100_000 {
        let offset = graph.constant(i as f32 + 0.5);
        let leaf = graph.sub(x, offset);
        left = graph.min(left, leaf);
        let inner = graph.unary(Op::Sin, right);
        let leaf = graph.add(x, offset);
        right = graph.binary(Op::Atan2, leaf, inner);
    }
    let tape = Tape::new(&graph, &[left, right]);
    assert!(
        tape.clauses.len() >= 400_000 && tape.registers <= 8,
        "{} {}",
        tape.clauses.len(),
        tape.registers
    );
    let frame = FrameInputs::default();
    let point = Point::at(0.25, 0.0, 0.0);
    let expected = graph.evaluate(&[left, right], &point, &frame);
    assert_eq!(PointEvaluator::new(&tape, &frame).at(&point), expected);
    assert!(glsl::function(&graph, &[left], "deep", glsl::Sampling::None).lines().count() > 200_000);
}

#[test]
fn constants_and_inputs_of_the_frame_can_be_roots() {
    let mut graph = Graph::new();
    let (two, t, x) = (graph.constant(2.0), graph.input(Input::T), graph.input(Input::X));
    let sine = graph.unary(Op::Sin, t);
    let roots = [two, t, x, sine, two];
    let tape = Tape::new(&graph, &roots);
    let frame = frame();
    let found = PointEvaluator::new(&tape, &frame).at(&Point::at(9.0, 0.0, 0.0)).to_vec();
    assert_eq!(found, [2.0, 12.5, 9.0, 12.5f32.sin(), 2.0]);
}

#[test]
fn glsl_is_written_from_the_operators() {
    let mut graph = Graph::new();
    let root = ring(&mut graph);
    let text = glsl::function(&graph, &[root], "distance_to_scene", glsl::Sampling::None);
    let expected = "float distance_to_scene(vec3 p, vec3 n) {
    float v2 = (p.x * p.x);
    float v3 = (p.y * p.y);
    float v4 = (v2 + v3);
    float v5 = sqrt(v4);
    float v8 = (v5 - 1.0);
    float v9 = (0.5 - v5);
    float v10 = max(v8, v9);
    return v10;
}
";
    assert_eq!(text, expected);
    let operators = [Op::Square, Op::Sqrt, Op::Add, Op::Sub, Op::Max];
    let cases =
        [(24, "(a * a)"), (25, "sqrt(max(a, 0.0))"), (64, "(a + b)"), (65, "(a - b)"), (69, "max(a, b)")];
    let [square, root_of, add, subtract, max] = cases.map(|(_, value)| format!("    r = ({value});\n"));
    // END and LOAD give the first operand. Their numbers are smaller than all operators.
    let square = format!("    if (number == 24) {}", square.trim_start());
    let or = "    } else {\n";
    let search = format!(
        "    if (number < 64) {{\n    if (number < 25) {{\n{square}{or}{root_of}    }}\n{or}    if (number < 65) {{\n{add}{or}    \
         if (number < 69) {{\n{subtract}{or}{max}    }}\n    }}\n    }}\n"
    );
    let values: String =
        cases.iter().map(|(number, value)| format!("    float v{number} = ({value});\n")).collect();
    let unary = "mix(mix(a, a, HAS(word, 0, 1)), mix(v24, v25, HAS(word, 0, 0)), HAS(word, 0, 4))";
    let binary = "mix(mix(v64, v65, HAS(word, 0, 0)), v69, HAS(word, 0, 2))";
    let selection = format!("{values}    r = mix({unary}, {binary}, (word & 192u) != 0u);\n");
    for (every_case, expected) in [(false, search), (true, selection)] {
        let operators = operators.into_iter().collect();
        let variant = interpreter::Variant { operators, registers: 8, every_case, ..Default::default() };
        let text = variant.text(&variant.operators, Compounds::NONE, 8);
        assert_eq!(text.matches(&expected).count(), 2, "for materials and for regions: {text}");
    }
    let texel = graph.input(Input::Param(6));
    let texel = graph.texture(2, 1, root, texel);
    let text = glsl::function(&graph, &[texel, root], "colours", glsl::Sampling::None);
    assert!(text.starts_with("void colours(vec3 p, vec3 n, out float r0, out float r1) {"), "{text}");
    assert!(
        text.contains("    vec4 s0 = read_texture(2, v10, frame_params[1].z);\n    float v12 = s0.y;\n"),
        "{text}"
    );
    assert!(text.ends_with("    r0 = v12;\n    r1 = v10;\n}\n"), "{text}");
}

#[test]
fn glsl_guards_divisions_only_if_the_divisor_may_be_zero() {
    let mut graph = Graph::new();
    let (x, y, three) = (graph.input(Input::X), graph.input(Input::Y), graph.constant(3.0));
    let (by_three, by_y) = (graph.div(x, three), graph.div(x, y));
    let text = glsl::function(&graph, &[by_three], "f", glsl::Sampling::None);
    assert!(text.contains(&format!("= (p.x * {:?});", 3.0_f32.recip())), "{text}");
    assert!(
        glsl::function(&graph, &[by_y], "f", glsl::Sampling::None)
            .contains("= (p.y == 0.0 ? 0.0 : p.x / p.y);")
    );
}

#[test]
fn glsl_guards_roots_of_possibly_negative_values() {
    let mut graph = Graph::new();
    let (x, y) = (graph.input(Input::X), graph.input(Input::Y));
    let (xx, yy) = (graph.mul(x, x), graph.mul(y, y));
    let (squares, other) = (graph.add(xx, yy), graph.sub(x, y));
    for (inside, guarded) in [(squares, false), (other, true)] {
        let root = graph.sqrt(inside);
        let text = glsl::function(&graph, &[root], "f", glsl::Sampling::None);
        assert_eq!(text.contains("sqrt(max("), guarded, "{text}");
    }
}

proptest! {
    #[test]
    fn literals_read_back_as_they_were(bits in any::<u32>()) {
        let value = f32::from_bits(bits);
        let text = glsl::literal(value);
        let bare = text.trim_start_matches('(').trim_end_matches(')');
        if value.is_finite() {
            prop_assert_eq!(bare.parse::<f32>().unwrap().to_bits(), bits);
            prop_assert!(bare.contains(['.', 'e']), "{} is no float in GLSL", bare);
            prop_assert_eq!(text.starts_with('('), value.is_sign_negative());
        } else {
            prop_assert_eq!(text, format!("uintBitsToFloat(0x{bits:08X}u)"));
        }
    }
}
