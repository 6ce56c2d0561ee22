//! Tests of the graph's guarantees: exactness, soundness, sharing, limits, depth.

use proptest::prelude::*;

use super::testing::{SPECIALS, Step, build, frame, number, same, steps};
use super::*;

/// Returns the number of cases per property; `PROPTEST_CASES` raises this number for a long run.
fn config() -> ProptestConfig {
    let cases = ProptestConfig::default().cases.max(2_000);
    ProptestConfig { cases, failure_persistence: None, ..ProptestConfig::default() }
}

fn point(values: [f32; 6]) -> Point {
    let [x, y, z, nx, ny, nz] = values;
    Point { position: [x, y, z], normal: [nx, ny, nz] }
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn simplification_is_exact(steps in steps(40), values in proptest::array::uniform6(number())) {
        let frame = frame();
        let point = point(values);
        let mut simplified = Graph::new();
        let roots = build(&mut simplified, &steps, true);
        let mut raw = Graph::new();
        let raw_roots = build(&mut raw, &steps, false);
        let expected = raw.evaluate(&raw_roots, &point, &frame);
        let found = simplified.evaluate(&roots, &point, &frame);
        for (place, (&expected, &found)) in expected.iter().zip(&found).enumerate() {
            prop_assert!(same(expected, found), "step {place} {:?}: {expected:?} became {found:?}", steps[place]);
        }
    }

    #[test]
    fn bounds_hold_every_value(
        number_of_op in any::<u8>(), a in [number(), number()], b in [number(), number()],
        along in proptest::array::uniform8((0.0f32..=1.0, 0.0f32..=1.0)),
    ) {
        let op = Op::ALL[usize::from(number_of_op) % Op::ALL.len()];
        let frame = frame();
        let interval = |[p, q]: [f32; 2]| Interval::new(p.min(q), p.max(q));
        let (a, b) = (interval(a), interval(b));
        let bounds = op.bounds(a, b, &frame);
        let inside = |i: Interval, t: f32| {
            if t < 0.1 { i.lo } else if t > 0.9 { i.hi } else if i.contains(0.0) && t < 0.2 { 0.0 }
            else { (i.lo * (1.0 - t) + i.hi * t).clamp(i.lo, i.hi) }
        };
        if a.is_any() || b.is_any() {
            return Ok(());
        }
        for (s, t) in along {
            let (x, y) = (inside(a, s), inside(b, t));
            if x.is_nan() || y.is_nan() {
                continue;
            }
            let value = op.value(x, y, &frame);
            prop_assert!(bounds.contains(value), "{} of {x:?}, {y:?} is {value:?}, not in {bounds:?}", op.name());
            let (by_a, by_b) = op.slope_bounds(a, b, bounds, &frame);
            let chosen = match (by_a.lo == 1.0, by_b.lo == 1.0, by_b.hi == 0.0) {
                _ if !op.chooses() => continue,
                (true, ..) => x,
                (_, true, _) => y,
                (.., true) => 0.0,
                _ => continue,
            };
            prop_assert!(value == chosen, "{} of {a:?}, {b:?} chose {chosen:?}, not {value:?}", op.name());
        }
    }
}

#[test]
fn every_pair_of_operators_is_simplified_exactly() {
    let frame = frame();
    let points: Vec<Point> = [
        [0.7, -1.3, 2.9],
        [-0.1, 0.1, -0.1],
        [1.0, 1.0, -1.0],
        [3.3, 0.0, 8_388_609.0],
        [f32::INFINITY, -2.5, 0.3],
        [1e-20, 1e38, f32::NAN],
        [f32::NAN, 0.9, f32::NEG_INFINITY],
    ]
    .map(|[x, y, z]| Point::at(x, y, z))
    .to_vec();
    let constants = [0.0, 1.0, -1.0, 2.0, 3.0, -0.3, f32::INFINITY, f32::NAN].map(Step::Constant);
    let (x, y, z) = (Step::Input(0), Step::Input(1), Step::Input(2));
    let count = Op::ALL.len() as u8;
    for (outer, inner) in (0..count).flat_map(|outer| (0..count).map(move |inner| (outer, inner))) {
        let op = Step::Operator;
        let mut arrangements = vec![
            vec![x, y, z, op(inner, 2, 1), op(outer, 0, 1)],
            vec![x, y, z, op(inner, 2, 1), op(outer, 1, 0)],
            vec![x, y, op(inner, 1, 0), op(outer, 0, 1)],
            vec![x, y, op(inner, 1, 0), op(outer, 2, 0)],
            vec![x, y, op(inner, 1, 1), op(inner, 1, 1), op(outer, 1, 0)],
            vec![x, op(inner, 0, 0), op(outer, 0, 0)],
        ];
        for (place, &c) in constants.iter().enumerate() {
            let d = constants[(place * 3 + 1) % constants.len()];
            arrangements.push(vec![x, c, op(inner, 1, 0), d, op(outer, 1, 0)]);
            arrangements.push(vec![x, c, op(inner, 0, 1), d, op(outer, 0, 1)]);
        }
        for steps in arrangements {
            let (mut simplified, mut raw) = (Graph::new(), Graph::new());
            let roots = build(&mut simplified, &steps, true);
            let raw_roots = build(&mut raw, &steps, false);
            for point in &points {
                let expected = raw.evaluate(&raw_roots, point, &frame);
                let found = simplified.evaluate(&roots, point, &frame);
                for (expected, found) in expected.into_iter().zip(found) {
                    assert!(same(expected, found), "{steps:?} at {point:?}: {expected:?} became {found:?}");
                }
            }
        }
    }
}

#[test]
fn bounds_hold_specials() {
    let frame = frame();
    let ordered = |lo: f32, hi: f32| Interval::new(lo, hi);
    for &op in Op::ALL {
        for lo in SPECIALS {
            for hi in SPECIALS {
                let a = ordered(lo, hi);
                let firsts = SPECIALS.into_iter().filter(|&v| a.contains(v) && (a.is_any() || !v.is_nan()));
                let firsts: Vec<f32> = firsts.collect();
                let others: &[(f32, f32)] = if op.arity() == 1 {
                    &[(0.0, 0.0)]
                } else {
                    &[
                        (0.0, 0.0),
                        (-1.0, 2.0),
                        (0.0, f32::INFINITY),
                        (f32::NEG_INFINITY, f32::INFINITY),
                        (f32::NAN, f32::NAN),
                        (-3.0, -0.0),
                        (1e-45, 1e20),
                        (f32::MIN, f32::MIN_POSITIVE),
                        (2.0, 31.5),
                    ]
                };
                for &(low, high) in others {
                    let b = ordered(low, high);
                    let bounds = op.bounds(a, b, &frame);
                    let swapped = op.bounds(b, a, &frame);
                    for second in
                        SPECIALS.into_iter().filter(|&v| b.contains(v) && (b.is_any() || !v.is_nan()))
                    {
                        for &first in &firsts {
                            let value = op.value(first, second, &frame);
                            assert!(
                                bounds.contains(value),
                                "{op:?} {first:?} {second:?}: {value:?} {bounds:?} {a:?} {b:?}"
                            );
                            if op.arity() == 2 {
                                let value = op.value(second, first, &frame);
                                assert!(
                                    swapped.contains(value),
                                    "{op:?} {second:?} {first:?}: {value:?} {swapped:?}"
                                );
                            }
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn bounds_hold_densely_for_one_operand() {
    let frame = frame();
    let sweep: Vec<f32> = (0..=u32::MAX).step_by(4_099).map(f32::from_bits).filter(|v| !v.is_nan()).collect();
    for &op in Op::ALL.iter().filter(|op| op.arity() == 1) {
        for three in sweep.windows(3) {
            let (lo, hi) = (three[0].min(three[2]), three[0].max(three[2]));
            let bounds = op.bounds(Interval::new(lo, hi), Interval::point(0.0), &frame);
            for &v in three {
                let value = op.value(v, 0.0, &frame);
                assert!(
                    !(lo..=hi).contains(&v) || bounds.contains(value),
                    "{op:?} {v:?}: {value:?} {bounds:?}"
                );
            }
        }
    }
}

#[test]
fn no_operator_distinguishes_zeros() {
    let frame = frame();
    for &op in Op::ALL {
        for other in SPECIALS {
            for (plus, minus) in [
                (op.value(0.0, other, &frame), op.value(-0.0, other, &frame)),
                (op.value(other, 0.0, &frame), op.value(other, -0.0, &frame)),
            ] {
                assert!(same(plus + 0.0, minus + 0.0), "{op:?} with {other:?}: {plus:?} {minus:?}");
            }
        }
    }
}

#[test]
fn no_operator_makes_a_nan_of_finite_numbers() {
    let frame = frame();
    let finite: Vec<f32> = SPECIALS.into_iter().filter(|v| v.is_finite()).collect();
    for &op in Op::ALL {
        for &a in &finite {
            for &b in &finite {
                assert!(!op.value(a, b, &frame).is_nan(), "{op:?} of {a:?} and {b:?}");
            }
        }
    }
}

#[test]
fn properties_hold() {
    let frame = frame();
    for &op in Op::ALL {
        assert_eq!(Op::from_number(op.number()), Some(op));
        for a in SPECIALS {
            for b in SPECIALS {
                let value = op.value(a, b, &frame);
                let has = |property| op.properties().has(property);
                if has(Properties::COMMUTATIVE) {
                    assert!(same(value + 0.0, op.value(b, a, &frame) + 0.0), "{op:?} {a:?} {b:?}");
                }
                if has(Properties::NEVER_NEGATIVE) {
                    assert!(value >= 0.0 || value.is_nan(), "{op:?} {a:?} {b:?}: {value:?}");
                }
                if has(Properties::WHOLE) {
                    assert!(value == value.floor() || value.is_nan(), "{op:?} {a:?} {b:?}: {value:?}");
                }
                if has(Properties::TRUTH) {
                    assert!(value == 0.0 || value == 1.0, "{op:?} {a:?} {b:?}: {value:?}");
                }
            }
        }
    }
}

#[test]
fn slopes_match_differences() {
    let frame = frame();
    let step = 1.0 / 256.0;
    for &op in Op::ALL {
        if op == Op::Hash || op.properties().has(Properties::READS_FRAME) {
            continue;
        }
        for (a, b) in [(0.3, 0.7), (0.7, 0.4), (0.61, 1.7), (0.23, 2.3), (-0.4, 0.6)] {
            let difference = |forward: f32, back: f32| (forward - back) / (2.0 * step);
            let by_a = difference(op.value(a + step, b, &frame), op.value(a - step, b, &frame));
            let by_b = difference(op.value(a, b + step, &frame), op.value(a, b - step, &frame));
            let (slope_a, slope_b) = op.slopes(a, b, op.value(a, b, &frame), &frame);
            let close =
                |slope: f32, difference: f32| (slope - difference).abs() <= 2e-3 * (1.0 + slope.abs());
            assert!(close(slope_a, by_a), "{op:?} at {a}, {b} by a: {slope_a} is not {by_a}");
            assert!(
                op.arity() == 1 || close(slope_b, by_b),
                "{op:?} at {a}, {b} by b: {slope_b} is not {by_b}"
            );
        }
    }
}

#[test]
fn table_slopes_match_differences() {
    let frame = frame();
    for i in 0..15 {
        let (u, v, step) = ((i as f32 + 0.5) / 15.0, 0.4, 1e-3);
        let (by_u, by_v) = frame.history.slopes(u, v);
        let found = (frame.history.at(u + step, v) - frame.history.at(u - step, v)) / (2.0 * step);
        assert!((found - by_u).abs() < 1e-2, "{found} {by_u}");
        let found = (frame.history.at(u, v + step) - frame.history.at(u, v - step)) / (2.0 * step);
        assert!((found - by_v).abs() < 1e-2, "{found} {by_v}");
    }
}

#[test]
fn tables_interpolate_and_clamp() {
    let table = TableData::rows(vec![0.0, 1.0, 2.0, 4.0, 5.0, 6.0, 99.0], 3);
    // Halfway between the middle entries of the rows, 1 and 5: by symmetry the value is 3.
    assert_eq!([table.at(0.5, 0.5), table.at(f32::NAN, 0.5)], [3.0, table.at(0.0, 0.5)]);
    assert_eq!([table.at(-1.0, 0.0), table.at(9.0, 5.0)], [table.at(0.0, 0.0), table.at(1.0, 1.0)]);
    assert!(table.at(0.0, 0.0) < table.at(0.25, 0.0) && table.at(0.25, 0.0) < table.at(0.5, 0.0));
    assert_eq!(TableData::EMPTY.at(0.5, 0.5), 0.0);
    let frame = frame();
    assert_eq!(
        [-5.0, f32::NAN, 31.9, 1e9].map(|index| frame.level(LevelList::Band, index)),
        [0, 0, 31, 31].map(|number| frame.levels.of(LevelList::Band)[number])
    );
}

#[test]
fn many_nodes_with_the_same_newest_operand_are_stored_once() {
    let mut g = Graph::new();
    let numbers: Vec<NodeId> = (0..3_000).map(|number| g.constant(number as f32 + 2.0)).collect();
    let x = g.input(Input::X);
    let mut all = || {
        let sums: Vec<NodeId> =
            numbers.iter().map(|number| g.raw(Node::Binary(Op::Add, *number, x))).collect();
        let roots: Vec<NodeId> = sums.iter().map(|sum| g.sqrt(*sum)).collect();
        ([sums, roots].concat(), g.len())
    };
    let (built, again) = (all(), all());
    assert_eq!(built, again);
    let distinct: std::collections::BTreeSet<NodeId> = built.0.iter().copied().collect();
    assert_eq!(distinct.len(), 6_000);
}

#[test]
fn equal_expressions_are_one_node() {
    let mut graph = Graph::new();
    let (x, y) = (graph.input(Input::X), graph.input(Input::Y));
    let (first, second) = (graph.add(x, y), graph.add(y, x));
    assert_eq!(first, second);
    let before = graph.len();
    for _ in 0..3 {
        let sum = graph.add(x, y);
        graph.sqrt(sum);
    }
    assert_eq!(graph.len(), before + 1);
    let (zero, minus_zero) = (graph.constant(0.0), graph.constant(-0.0));
    assert_eq!(zero, minus_zero);
    let constants: Vec<NodeId> = (0..5_000).map(|i| graph.constant(i as f32 + 0.5)).collect();
    let again: Vec<NodeId> = (0..5_000).map(|i| graph.constant(i as f32 + 0.5)).collect();
    assert_eq!(constants, again);
}

#[test]
fn rules_apply() {
    let mut g = Graph::new();
    let (x, y) = (g.input(Input::X), g.input(Input::Y));
    let (zero, one, two) = (g.constant(0.0), g.constant(1.0), g.constant(2.0));
    let nx = g.neg(x);
    assert_eq!(
        [g.add(x, zero), g.sub(x, zero), g.mul(x, one), g.div(x, one), g.min(x, x), g.neg(nx)],
        [x; 6]
    );
    assert_eq!((g.sub(zero, x), g.div(x, zero)), (nx, zero));
    let (sum, difference, product) = (g.add(x, y), g.sub(y, x), g.mul(x, x));
    assert_eq!(g.node(product), Node::Unary(Op::Square, x));
    assert_eq!(g.add(y, nx), difference);
    assert_eq!(g.add(nx, y), difference);
    assert_eq!(g.sub(y, nx), sum);
    let reverse = g.sub(x, y);
    assert_eq!(g.neg(reverse), difference);
    let half = g.div(x, two);
    assert!(matches!(g.node(half), Node::Binary(Op::Mul, ..)));
    let least = g.min(x, y);
    assert_eq!(g.min(y, least), least);
    let clamped = g.min(x, two);
    assert_eq!(g.min(clamped, one), g.min(x, one));
    assert_eq!(g.select(one, x, y), x);
    assert_eq!(g.select(zero, x, y), y);
    let cube = g.constant(3.0);
    let cube = g.pow(x, cube);
    assert_eq!(g.evaluate(&[cube], &Point::at(-2.0, 0.0, 0.0), &FrameInputs::default()), [-8.0]);
    let (four, four_and_more) = (g.constant(4.0), g.constant(4.6));
    let (band, same_band, input) = (
        g.unary(Op::Band, four),
        g.unary(Op::Band, four_and_more),
        g.input(Input::Level(LevelList::Band.nearest(4.0))),
    );
    assert_eq!([band, same_band], [input; 2]);
}

#[test]
fn select_ignores_the_other_side() {
    let mut g = Graph::new();
    let (x, y, z) = (g.input(Input::X), g.input(Input::Y), g.input(Input::Z));
    let root = g.select(x, y, z);
    for (c, a, b, expected) in [
        (1.0, 5.0, f32::NAN, 5.0),
        (0.0, f32::INFINITY, 7.0, 7.0),
        (f32::NAN, 3.0, 4.0, 3.0),
        (-0.0, 3.0, -0.0, 0.0),
    ] {
        let found = g.evaluate(&[root], &Point::at(c, a, b), &FrameInputs::default());
        assert!(same(found[0], expected), "{c} {a} {b}: {found:?}");
    }
}

#[test]
fn helpers_match_their_definitions() {
    let mut g = Graph::new();
    let (x, y, z) = (g.input(Input::X), g.input(Input::Y), g.input(Input::Z));
    let roots = [
        g.length(&[x, y, z]),
        g.dot(&[x, y], &[y, z]),
        g.mix(x, y, z),
        g.clamp(x, y, z),
        g.smoothstep(x, y, z),
    ];
    let at = |x, y, z| g.evaluate(&roots, &Point::at(x, y, z), &FrameInputs::default());
    assert_eq!(at(2.0, 3.0, 6.0)[..4], [7.0, 24.0, 8.0, 3.0]);
    assert_eq!(at(0.0, 2.0, 1.0)[4], 0.5);
    assert_eq!(at(0.0, 2.0, 0.5)[4], 0.15625);
}

#[test]
fn a_full_graph_returns_an_error() {
    let limits = Limits { graph_nodes_max: 10, ..LIMITS };
    let mut graph = Graph::with_limits(&limits);
    let mut node = graph.input(Input::X);
    for _ in 0..9 {
        node = graph.unary(Op::Sin, node);
    }
    assert_eq!(graph.check(), Ok(()));
    graph.unary(Op::Sin, node);
    let error = GraphError::TooManyNodes(10);
    assert_eq!(graph.check(), Err(error));
    assert!(error.to_string().contains("10"));
}

#[test]
fn a_deep_graph_needs_no_stack() {
    let mut graph = Graph::new();
    let x = graph.input(Input::X);
    let mut node = x;
    for i in 0..100_000 {
        let constant = graph.constant(i as f32);
        let inner = graph.unary(Op::Sin, node);
        node = graph.max(constant, inner);
    }
    assert_eq!(graph.evaluate(&[node], &Point::at(1.0, 0.0, 0.0), &FrameInputs::default()), [99_999.0]);
    assert_eq!(graph.inputs_used(&[node]).inputs.into_iter().collect::<Vec<_>>(), [Input::X]);
    assert_eq!(graph.to_dot(node).lines().count(), 3 + 1 + 6 * 100_000);
}

#[test]
fn dot_names_nodes_and_edges() {
    let mut graph = Graph::new();
    let (x, t) = (graph.input(Input::X), graph.input(Input::T));
    let root = graph.sub(x, t);
    let dot = graph.to_dot(root);
    assert!(dot.starts_with("digraph") && dot.trim_end().ends_with('}'), "{dot}");
    for line in [
        "n0 [label=\"X\"];",
        "n1 [label=\"T\"];",
        "n2 [label=\"SUB\"];",
        "n0 -> n2 [label=\"a\"];",
        "n1 -> n2 [label=\"b\"];",
    ] {
        assert!(dot.contains(line), "{line} is not in {dot}");
    }
}

#[test]
fn inputs_used_include_only_those_of_the_root() {
    let mut g = Graph::new();
    let (x, y, t) = (g.input(Input::X), g.input(Input::Y), g.input(Input::T));
    let spectrum = g.unary(Op::Spectrum, x);
    let texel = g.texture(3, 1, spectrum, t);
    g.add(y, texel);
    let used = g.inputs_used(&[texel]);
    assert_eq!(used.inputs.into_iter().collect::<Vec<_>>(), [Input::X, Input::T]);
    assert_eq!(used.tables.into_iter().collect::<Vec<_>>(), [Op::Spectrum]);
    assert_eq!(used.textures.into_iter().collect::<Vec<_>>(), [3]);
}

#[test]
fn hash_is_spread_evenly() {
    let count = 100 * 100;
    let values: Vec<f64> =
        (0..count).map(|i| f64::from(cell_hash((i % 100) as f32 - 50.0, (i / 100) as f32 - 50.0))).collect();
    let mean = values.iter().sum::<f64>() / f64::from(count);
    let spread = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / f64::from(count);
    let neighbours = values.windows(2).map(|p| (p[0] - mean) * (p[1] - mean)).sum::<f64>() / f64::from(count);
    assert!((mean - 0.5).abs() < 0.01 && (spread - 1.0 / 12.0).abs() < 0.003, "{mean} {spread}");
    assert!(neighbours.abs() < 0.003, "{neighbours}");
    assert_eq!(cell_hash(0.2, 5.9), cell_hash(0.9, 5.0));
    assert!(values.iter().all(|v| (0.0..1.0).contains(v)));
}
