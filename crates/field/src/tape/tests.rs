//! Tests of tapes: Table 1, clause words, exact values, bounds, gradients and limits.

use proptest::prelude::*;

use super::*;
use crate::graph::testing::{build, frame, number, same, steps};
use crate::graph::{Compounds, Interval, Point};
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

fn tape_of(graph: &Graph, roots: &[NodeId], registers: usize) -> Tape {
    Tape::build(graph, roots, &TapeOptions { registers, ..TapeOptions::default() }).unwrap()
}

#[test]
fn table_1_of_the_thesis() {
    let mut graph = Graph::new();
    let root = ring(&mut graph);
    for registers in [2, 256] {
        let tape = tape_of(&graph, &[root], registers);
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
        assert_eq!((tape.registers(), tape.memory(), tape.outputs()), (2, 0, &[1][..]));
    }
}

#[test]
fn words_match_the_table_in_the_module_documentation() {
    let mut graph = Graph::new();
    let root = ring(&mut graph);
    let tape = tape_of(&graph, &[root], 256);
    let words: Vec<u32> = tape.clauses().iter().map(|clause| clause.word()).collect();
    // Bytes from the highest: input_b, input_a, output, opcode.
    let expected = [
        0x00_00_00_08, // X
        0x00_00_01_09, // Y
        0x00_00_00_18, // SQUARE = 24
        0x00_01_01_18,
        0x01_00_01_40, // ADD = 64
        0x00_01_01_19, // SQRT = 25
        0x80_01_00_81, // SUB = 65, + 64: register 1 - immediate
        0x01_80_01_C1, // SUB = 65, + 128: immediate - register 1
        0x01_00_01_45, // MAX = 69
    ];
    assert_eq!(words, expected);
    // Texels omit inputs that start in their registers, and put immediates after clauses. END has the output's
    // register.
    let mut texels = Vec::new();
    tape.append_texels(&FrameInputs::default(), Compounds::NONE, &mut texels);
    let [one, half] = [1.0_f32, 0.5].map(f32::to_bits);
    let pairs = [
        [expected[2], 0, expected[3], 0],
        [expected[4], 0, expected[5], 0],
        [expected[6], one, expected[7], half],
        [expected[8], 0, 0x00_01_01_00, 0],
    ];
    assert_eq!(texels, pairs);
    let op = Op::Less;
    for (instruction, word) in [
        (Instruction::Load { output: 7, entry: 0 }, 0x00_80_07_02),
        (Instruction::Store { register: 7, memory: 0x1234 }, 0x12_34_07_03),
        (Instruction::Reload { output: 7, memory: 0x1234 }, 0x12_34_07_04),
        (Instruction::Texture { output: 7, texture: 0, channel: 0, u: 8, v: 9 }, 0x09_08_07_06),
        (Instruction::Input { output: 7, place: 5 }, 0x00_00_07_0D),
        (
            Instruction::Binary { op, output: 7, a: Operand::Register(8), b: Operand::Register(9) },
            0x09_08_07_4A,
        ),
        (
            Instruction::Binary { op, output: 7, a: Operand::Register(8), b: Operand::Immediate(0) },
            0x80_08_07_8A,
        ),
        (
            Instruction::Binary { op, output: 7, a: Operand::Immediate(0), b: Operand::Register(9) },
            0x09_80_07_CA,
        ),
    ] {
        assert_eq!(instruction.word(), word, "{instruction:?}");
        assert_eq!(Instruction::from_word(word), Some(instruction));
    }
}

#[test]
fn every_valid_word_decodes_and_encodes_to_itself() {
    let mut meanings = 0;
    for opcode in 0..=255 {
        let Some(instruction) = Instruction::from_word(u32::from_le_bytes([opcode, 1, 2, 3])) else {
            continue;
        };
        meanings += 1;
        assert_eq!(Instruction::from_word(instruction.word()), Some(instruction));
        assert_eq!(instruction.word().to_le_bytes()[0], opcode);
    }
    let binary = Op::ALL.iter().filter(|op| op.arity() == 2).count();
    assert_eq!(meanings, 4 + 6 + (Op::ALL.len() - binary) + 3 * binary);
}

#[test]
fn end_and_rare_operators_are_second_in_their_texels() {
    let mut graph = Graph::new();
    let mut node = graph.input(Input::X);
    for length in 1..=9 {
        let mut texels = Vec::new();
        let tape = tape_of(&graph, &[node], 256);
        tape.append_texels(&FrameInputs::default(), Compounds::NONE, &mut texels);
        let (last, others) = texels.split_last().unwrap();
        assert_eq!(*last, [0, 0, u32::from(tape.outputs()[0]) << 16, 0]);
        // X starts in its register, so it has no texel. Each of the other clauses has a texel.
        assert_eq!(others.len(), length - 1);
        assert!(others.iter().all(|texel| texel[0] == 0 && texel[2] & 255 == u32::from(Op::Sin.number())));
        node = graph.unary(Op::Sin, node);
    }
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
        registers in prop_oneof![2usize..8, Just(256usize)],
        simplify: bool,
        outputs in 1usize..4,
    ) {
        let mut graph = Graph::new();
        let built = build(&mut graph, &steps, simplify);
        let roots: Vec<NodeId> = built.iter().rev().copied().take(outputs.min(registers)).collect();
        let tape = tape_of(&graph, &roots, registers);
        prop_assert!(tape.registers() <= registers);
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
        let tape = tape_of(&graph, &[root], 8);
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
    for registers in [2, 256] {
        let tapes = [sphere, gyroid].map(|root| tape_of(&g, &[root], registers));
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
    let tape = tape_of(&graph, &[sum], 256);
    let frame = FrameInputs::default();
    let found = PointEvaluator::new(&tape, &frame).at(&Point::at(2.0, 0.0, 0.0))[0];
    assert_eq!(found, 2.0 * (0.5 + count as f32));
    tape
}

#[test]
fn any_number_of_constants() {
    for count in [256, 257, 70_000] {
        let tape = with_constants(count);
        assert_eq!((tape.table().len(), tape.registers()), (count, 3));
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
    let tape = tape_of(&graph, &[left, right], 256);
    assert!(
        tape.clauses().len() >= 400_000 && tape.registers() <= 8,
        "{} {}",
        tape.clauses().len(),
        tape.registers()
    );
    let frame = FrameInputs::default();
    let point = Point::at(0.25, 0.0, 0.0);
    let expected = graph.evaluate(&[left, right], &point, &frame);
    assert_eq!(PointEvaluator::new(&tape, &frame).at(&point), expected);
    assert!(glsl::function(&graph, &[left], "deep", glsl::Sampling::None).lines().count() > 200_000);
}

/// A balanced tree over 2^10 leaves of x, y and z takes one register per level. With fewer registers it spills.
#[test]
fn spilling_uses_memory_only_where_registers_run_out() {
    let mut graph = Graph::new();
    let inputs = [Input::X, Input::Y, Input::Z].map(|input| graph.input(input));
    let mut row: Vec<NodeId> = (0..1024)
        .map(|i| {
            let offset = graph.constant(i as f32);
            let shifted = graph.sub(inputs[i % 3], offset);
            graph.unary(Op::Sin, shifted)
        })
        .collect();
    while row.len() > 1 {
        row = row.chunks(2).map(|pair| graph.binary(Op::Pow, pair[0], pair[1])).collect();
    }
    let frame = FrameInputs::default();
    let point = Point::at(0.1, 0.2, 0.3);
    let expected = graph.evaluate(&row, &point, &frame)[0];
    for (registers, memory) in [(256, 0), (16, 0), (14, 0), (5, 1), (2, 1)] {
        let tape = tape_of(&graph, &row, registers);
        assert!(
            tape.registers() <= registers && (tape.memory() > 0) == (memory > 0),
            "{} {}",
            tape.registers(),
            tape.memory()
        );
        assert!(tape.memory() <= 11);
        // A tree of height h needs h + 1 registers: above that height every node keeps one operand in memory.
        let least = (1 << (11 - registers.min(11))) - 1;
        let reloads = tape.clauses().iter().filter(|i| matches!(i, Instruction::Reload { .. })).count();
        assert!(
            (least..=2 * least + 1).contains(&reloads),
            "{registers} registers: {reloads} reloads, {least} at least"
        );
        assert!(same(PointEvaluator::new(&tape, &frame).at(&point)[0], expected));
    }
}

#[test]
fn constants_and_inputs_of_the_frame_can_be_roots() {
    let mut graph = Graph::new();
    let (two, t, x) = (graph.constant(2.0), graph.input(Input::T), graph.input(Input::X));
    let sine = graph.unary(Op::Sin, t);
    let roots = [two, t, x, sine, two];
    let tape = tape_of(&graph, &roots, 5);
    let frame = frame();
    let found = PointEvaluator::new(&tape, &frame).at(&Point::at(9.0, 0.0, 0.0)).to_vec();
    assert_eq!(found, [2.0, 12.5, 9.0, 12.5f32.sin(), 2.0]);
}

#[test]
fn limits_are_reached() {
    let mut graph = Graph::new();
    let (x, y) = (graph.input(Input::X), graph.input(Input::Y));
    let values: Vec<NodeId> = (0..20)
        .map(|i| {
            let constant = graph.constant(i as f32 + 0.5);
            let sum = graph.add(x, constant);
            graph.binary(Op::Atan2, sum, y)
        })
        .collect();
    let forward = values[1..].iter().fold(values[0], |all, &v| graph.binary(Op::Pow, all, v));
    let backward = values[..19].iter().rev().fold(values[19], |all, &v| graph.binary(Op::Pow, all, v));
    let root = graph.add(forward, backward);
    let options = TapeOptions::default();
    let with =
        |registers: usize, limits: Limits| Tape::build(&graph, &[root], &TapeOptions { registers, limits });
    for count in [0, 1, 257] {
        assert_eq!(with(count, LIMITS), Err(TapeError::RegisterCount(count)));
    }
    let clauses = with(256, LIMITS).unwrap().clauses().len();
    assert!(with(256, Limits { tape_clauses_max: clauses, ..LIMITS }).is_ok());
    let max = clauses - 1;
    assert_eq!(with(256, Limits { tape_clauses_max: max, ..LIMITS }), Err(TapeError::TooManyClauses(max)));
    let memory = with(3, LIMITS).unwrap().memory();
    assert!(memory > 2 && with(3, Limits { tape_memory_max: memory, ..LIMITS }).is_ok());
    let max = memory - 1;
    assert_eq!(with(3, Limits { tape_memory_max: max, ..LIMITS }), Err(TapeError::TooMuchMemory(max)));
    let outputs = |count: usize, options: &TapeOptions| Tape::build(&graph, &values[..count], options);
    let few = TapeOptions { registers: 2, ..options };
    assert!(outputs(2, &few).is_ok());
    assert_eq!(outputs(3, &few), Err(TapeError::TooManyOutputs { count: 3, max: 2 }));
    let mut full = Graph::with_limits(&Limits { graph_nodes_max: 1, ..LIMITS });
    full.constant(1.0);
    let root = full.constant(2.0);
    let error = GraphError::TooManyNodes(1);
    assert_eq!(Tape::build(&full, &[root], &options), Err(TapeError::Graph(error)));
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
    let tape = tape_of(&graph, &[root], 256);
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
        let text = interpreter::Variant::of([&tape], every_case).text(&tape.operators(), Compounds::NONE, 8);
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
