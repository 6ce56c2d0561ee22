//! Tests that loops compute what the unrolled expression computes.

use proptest::prelude::*;

use super::rounds::{Formula, Rounds, Source, Unrolled};
use crate::graph::{FrameInputs, Graph, Node, NodeId, Point};
use crate::lang::{compile, no_includes};

/// Runs an expression with its loops, as the generated GLSL does.
struct Machine<'a> {
    graph: &'a Graph,
    point: Point,
    values: Vec<f32>,
    /// Rounds that ran.
    ran: usize,
}

impl Machine<'_> {
    fn value(&self, id: NodeId) -> f32 {
        match self.graph.node(id) {
            Node::Constant(value) => value,
            Node::Input(_) => self.graph.evaluate(&[id], &self.point, &FrameInputs::default())[0],
            _ => self.values[id.index()],
        }
    }

    fn run_node(&mut self, id: NodeId) {
        let frame = FrameInputs::default();
        self.values[id.index()] = match self.graph.node(id) {
            Node::Unary(op, a) => op.value(self.value(a), 0.0, &frame),
            Node::Binary(op, a, b) => op.value(self.value(a), self.value(b), &frame),
            node => panic!("{node:?} has no statement"),
        };
    }

    fn run_loop(&mut self, rounds: &Rounds) {
        let frame = FrameInputs::default();
        let mut kept: Vec<f32> = rounds.steps.iter().map(|step| self.value(step.before)).collect();
        for round in 0..rounds.count {
            if rounds.ends_early && kept[rounds.steps.len() - 1] != 0.0 {
                break;
            }
            self.ran += 1;
            let mut here = vec![f32::NAN; rounds.steps.len()];
            for (offset, step) in rounds.steps.iter().enumerate().filter(|(_, step)| step.is_computed) {
                let read = |source: Source| match source {
                    Source::Here(of) => here[of],
                    Source::Before(of) => {
                        assert!(rounds.steps[of].is_kept, "a value of the round before is not kept");
                        kept[of]
                    }
                    Source::Fixed(id) => self.value(id),
                    Source::Known(value) => value,
                    Source::Counted { first, step } => first + step * round as f32,
                    Source::Listed(list) => rounds.lists[list][round],
                };
                here[offset] = match step.formula {
                    Formula::Operation(op, [a, b]) => op.value(read(a), read(b), &frame),
                    Formula::Copy(source) => read(source),
                };
            }
            for (offset, step) in rounds.steps.iter().enumerate().filter(|(_, step)| step.is_kept) {
                kept[offset] = here[offset];
                self.values[step.last.index()] = here[offset];
            }
        }
        for (offset, step) in rounds.steps.iter().enumerate().filter(|(_, step)| step.is_kept) {
            self.values[step.last.index()] = kept[offset];
        }
    }
}

struct Looped {
    graph: Graph,
    root: NodeId,
    loops: Vec<Rounds>,
}

fn looped(function: &str) -> Looped {
    let text = format!("{function}\nobject it {{ shape = f(p)  trust = 1 }}");
    let compiled = compile("test.scene", &text, &mut no_includes);
    let scene = compiled.scene.as_ref().unwrap_or_else(|| panic!("{}", compiled.render(false)));
    let (graph, root) = (scene.graph.clone(), scene.objects[0].shape);
    let needed = graph.order(&[root]);
    let loops = Unrolled::new(&graph, &needed, &[root]).loops();
    Looped { graph, root, loops }
}

impl Looped {
    /// Compares the loops with the unrolled expression at a point. Returns the number of rounds that ran.
    fn check(&self, [x, y, z]: [f32; 3]) -> usize {
        let point = Point::at(x, y, z);
        let expected = self.graph.evaluate(&[self.root], &point, &FrameInputs::default())[0];
        let values = vec![f32::NAN; self.graph.len()];
        let mut machine = Machine { graph: &self.graph, point, values, ran: 0 };
        let needed = self.graph.order(&[self.root]);
        let unrolled = Unrolled::new(&self.graph, &needed, &[self.root]);
        let mut written = 0;
        for rounds in &self.loops {
            unrolled.order[written..rounds.places.start].iter().for_each(|id| machine.run_node(*id));
            machine.run_loop(rounds);
            written = rounds.places.end;
        }
        unrolled.order[written..].iter().for_each(|id| machine.run_node(*id));
        let found = machine.value(self.root) + 0.0;
        assert!(
            found.to_bits() == expected.to_bits() || found.is_nan() && expected.is_nan(),
            "{found} instead of {expected} at {x}, {y}, {z}"
        );
        machine.ran
    }
}

fn points() -> impl Strategy<Value = Vec<[f32; 3]>> {
    proptest::collection::vec(proptest::array::uniform3(-2.0f32..2.0), 24)
}

const JULIA: &str = "fn f(p) {
  let z = vec4(p, 0)  let slope = 1
  for i in 0..10 while dot(z, z) < 16 {
    slope *= 2 * length(z)
    z = vec4(z.x^2 - dot(z.yzw, z.yzw), 2 * z.x * z.yzw) + vec4(-0.2, 0.6, 0.2, 0.2)
  }
  0.25 * log(dot(z, z)) * length(z) / slope
}";

const BOX_FOLD: &str = "fn f(p) {
  let z = p  let slope = 1
  for i in 0..9 {
    z = 2 * clamp(z, -1, 1) - z
    let k = clamp(1 / dot(z, z), 1, 4)
    z = 2 * k * z + p
    slope = 2 * k * slope + 1
  }
  length(z) / slope
}";

#[test]
fn a_fractal_is_a_loop_that_ends_where_its_points_escape() {
    let julia = looped(JULIA);
    let [rounds] = &julia.loops[..] else { panic!("{} loops", julia.loops.len()) };
    assert!(rounds.ends_early && rounds.count >= 7, "{} rounds", rounds.count);
    let computed = rounds.steps.iter().filter(|step| step.is_computed).count();
    assert!(
        computed < rounds.steps.len(),
        "the choices between the old and the new value are still computed"
    );
    assert_eq!(julia.check([5.0, 5.0, 5.0]), 0);
    assert_eq!(julia.check([0.0, 0.1, 0.0]), rounds.count);

    let fold = looped(BOX_FOLD);
    let [rounds] = &fold.loops[..] else { panic!("{} loops", fold.loops.len()) };
    assert!(!rounds.ends_early && rounds.count >= 7, "{} rounds", rounds.count);
}

/// A picture of 128 steps through a cloud had more nodes than were searched: its shader was too long for drivers.
#[test]
fn a_long_march_with_numbers_for_each_round_is_a_loop() {
    let march = looped(
        "fn cloud(q) = sum(for k in 1..7: sin(q.x * 1.7^k) * cos(q.y * 1.9^k + q.z) / 2^k)
        fn f(p) {
          let seen = 0
          for i in 0..128 {
            let q = p * (1.017 + i / 50)
            if length(q) > 9 { break }
            seen += (1 - seen) * clamp(cloud(q), 0, 1) * exp(-0.013 * i)
          }
          seen
        }",
    );
    let needed = march.graph.order(&[march.root]).len();
    let [rounds] = &march.loops[..] else { panic!("{} loops", march.loops.len()) };
    assert!(needed > 8192 && rounds.count > 120 && rounds.lists.len() == 2, "{needed}, {}", rounds.count);
    march.check([0.3, -0.2, 0.5]);
    march.check([5.0, 1.0, 0.0]);
}

/// A value that was no truth before the loop ended it at once.
#[test]
fn a_number_that_grows_to_one_does_not_end_the_loop() {
    let grows = looped(
        "fn f(p) {
          let z = p  let e = max(p.x, p.y)
          for i in 0..12 {
            let w = abs(z) * 1.7 - vec3(0.5, 0.7, 0.3) + z.zxy * z.yzx
            if e < 0.5 { z = w }
            e = max(e, if dot(z, z) > 9 then 1 else 0)
          }
          length(z)
        }",
    );
    assert!(!grows.loops.is_empty());
    grows.check([0.3, 0.1, 0.2]);
}

#[test]
fn a_condition_that_does_not_keep_every_value_does_not_end_the_loop() {
    // The trap goes on after the point has escaped.
    let trapped = looped(
        "fn f(p) {
          let z = p  let trap = 9  let is_out = 0
          for i in 0..12 {
            let w = abs(z) * 1.7 - vec3(0.5, 0.7, 0.3) + z.zxy * z.yzx
            if is_out < 0.5 { z = w } else { trap = min(trap, length(w)) }
            is_out = max(is_out, if dot(z, z) > 9 then 1 else 0)
          }
          min(trap, length(z))
        }",
    );
    assert!(trapped.loops.iter().all(|rounds| !rounds.ends_early));
    for step in 0..200 {
        let along = step as f32 * 0.01;
        trapped.check([along - 1.0, 0.7 * along, 0.3 - along]);
    }
}

/// A loop with random statements.
fn functions() -> impl Strategy<Value = String> {
    let statement = proptest::sample::select(vec![
        "z = abs(z) * 1.3 - vec3(0.4, 0.2, 0.6)",
        "z = 2 * clamp(z, -1, 1) - z",
        "z.xz = rotate_y(z, 0.7).xz",
        "z = z.yzx",
        "slope = slope * 1.3 + length(z)",
        "trap = min(trap, dot(z, z))",
        "z += p * 0.5",
        "if z.x < z.y { z = z.yxz }",
        "if z.z > 0.5 { slope += i  trap = min(trap, z.x) } else { z = z * 1.1 }",
        "if dot(z, z) > 6 { break }",
        "e = max(e, if dot(z, z) > 9 then 1 else 0)",
        "if e < 0.5 { z = z * 1.1 - z.zxy }",
        "if i > 6 { break }",
        "slope += 0.25 * i",
        "slope = slope * 0.9 + z.x * (1 - 0.07 * i)",
        "let q = z * 0.5  z = q * q - p",
        "trap = max(trap * 0.9, sin(z.x + i))",
    ]);
    let head = proptest::sample::select(vec![
        "for i in 0..9",
        "for i in 1..14",
        "for i in 0..9 while dot(z, z) < 4",
        "for i in 0..9 while trap > 0.01",
        "for i in 0..rounds",
        "let e = max(p.x, p.y)  for i in 0..12",
    ]);
    let result = proptest::sample::select(vec!["length(z) / slope", "trap", "z.x + slope + trap", "slope"]);
    (head, proptest::collection::vec(statement, 1..7), result).prop_map(|(head, body, result)| {
        format!(
            "param rounds = 7 in 3 .. 11\nfn f(p) {{\n  let z = p  let slope = 1  let trap = 10  let e = 0\n  {head} {{\n    {}\n  }}\n  {result}\n}}",
            body.join("\n    ")
        )
    })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn loops_give_the_bits_of_the_unrolled_expression(function in functions(), points in points()) {
        let looped = looped(&function);
        for point in points {
            looped.check(point);
        }
    }
}

#[test]
fn most_random_loops_are_found_again() {
    use proptest::strategy::ValueTree;
    use proptest::test_runner::TestRunner;
    let mut runner = TestRunner::deterministic();
    let (mut found, mut early) = (0, 0);
    for _ in 0..200 {
        let loops = looped(&functions().new_tree(&mut runner).expect("a text").current()).loops;
        found += usize::from(!loops.is_empty());
        early += usize::from(loops.iter().any(|rounds| rounds.ends_early));
    }
    assert!(found > 80 && early > 20, "{found} of 200 have a loop, {early} end early");
}
