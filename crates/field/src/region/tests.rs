use crate::graph::{LevelList, SoundInput, SoundInputs};
use proptest::prelude::*;

use super::read::{Clause, Computes};
use super::*;
use crate::graph::{Input, Point, testing};
use crate::tape::{PointEvaluator, Tape, opcode};
use crate::world::testing::{SPEAKERS, world_of};

pub(super) fn inputs_of(world: &World, time: f32, loud: f32) -> FrameInputs {
    let mut inputs = FrameInputs {
        time,
        sound: SoundInputs::with(&[
            (SoundInput::VolumeLeft, 0.3 * loud),
            (SoundInput::VolumeRight, 0.2 * loud),
        ]),
        params: world.scene.params.iter().map(|param| param.default).collect(),
        ..Default::default()
    };
    for (band, value) in inputs.levels.of_mut(LevelList::Band).iter_mut().enumerate() {
        *value = loud * (0.5 + 0.5 * (band as f32 * 1.7 + time).sin());
    }
    inputs.hoisted = world.hoisted.values(&inputs);
    inputs
}

/// Returns a point, determined by `number`, in the box of one of the tree's roots or slightly outside.
pub(super) fn point(regions: &Regions, number: u32) -> [f32; 3] {
    let places = [0.754_877_67, 0.569_840_3, 0.438_579_22_f64];
    let times = ROOT_GROWTH.pow(number % regions.roots.max(1) as u32) as f32;
    std::array::from_fn(|axis| {
        let fraction = (f64::from(number) * places[axis] + 0.5).fract() as f32;
        regions.low[axis] + regions.size[axis] * (0.5 + times * (fraction * 1.1 - 0.55))
    })
}

/// Compares cells with the world's own tapes at many points. Returns the mean length of the tapes that were run.
pub(super) fn assert_regions_are_right(world: &World, inputs: &FrameInputs, points: u32) -> f64 {
    let plan = RegionPlan::new(world);
    let options = RegionOptions { texels_max: 1 << 22, ..Default::default() };
    let regions = plan.build(inputs, &options);
    let tape = Tape::new(&world.graph, &world.roots.distance);
    let object = Tape::new(&world.graph, &[world.roots.object]);
    let (mut whole, mut whole_object) =
        (PointEvaluator::new(&tape, inputs), PointEvaluator::new(&object, inputs));
    let (mut texels, mut asked_near) = (0.0, 0.0);
    for number in 0..points {
        let at = point(&regions, number);
        let penumbra = if number % 3 == 0 { 0.0 } else { 0.01 * number as f32 };
        let asked = Point { position: at, normal: [penumbra, 0.0, 0.0] };
        let wanted = [whole.at(&asked)[0], whole.at(&asked)[1]];
        let got = regions.distance(at, penumbra, inputs);
        assert_eq!(got.map(f32::to_bits), wanted.map(f32::to_bits), "{at:?} {got:?} {wanted:?}");
        let cell = regions.cell_at(at);
        if let Some(cell) = cell {
            assert!(cell.bound <= 0.0 || cell.bound <= wanted[0], "{at:?}: {cell:?}, but {}", wanted[0]);
            if wanted[0] < 0.2 {
                let wanted = whole_object.at(&Point { position: at, normal: [0.0; 3] })[0] as u32;
                assert_eq!(regions.object(at, inputs), wanted, "{at:?}");
            }
            if cell.bound < 0.1 {
                let tape = &regions.texels[cell.tape as usize..];
                texels += 1.0 + tape.iter().position(|texel| texel[2] & 255 == 0).unwrap_or(0) as f64;
                asked_near += 1.0;
            }
        }
    }
    texels / f64::max(asked_near, 1.0)
}

#[test]
fn a_tree_of_a_long_program_ends_soon_after_it_is_cancelled() {
    let ripples = "sum(for i in 0..600: sin(p.x * sin(i) + p.y * cos(i) + i))";
    let world = world_of(&format!("object foam {{ shape = length(p) - 3 + 0.001 * {ripples} }}"));
    let (plan, inputs) = (RegionPlan::new(&world), inputs_of(&world, 0.0, 1.0));
    let asked = std::cell::Cell::new(0);
    let is_wanted = || asked.replace(asked.get() + 1) < 3;
    let options = RegionOptions { texels_max: 1 << 22, ..Default::default() };
    let tree = plan.build_in_parts(None, &inputs, &options, 1, |parts| {
        parts.iter_mut().for_each(|part| part.build_while(&is_wanted));
    });
    assert!(asked.get() > 3 && tree.stats.passes <= 4, "{} questions, {:?}", asked.get(), tree.stats);
}

#[test]
fn the_speakers_are_the_same_in_every_cell() {
    let world = world_of(SPEAKERS);
    for (time, loud) in [(0.0, 0.0), (31.0, 0.6), (77.0, 1.0)] {
        let mean = assert_regions_are_right(&world, &inputs_of(&world, time, loud), 60_000);
        assert!(mean < 16.0, "{mean} texels for a tape");
    }
}

pub(super) const MANY: &str = "
fn place(i) = vec3(5 * sin(12.9898 * i), 3 + 3 * sin(78.233 * i), 5 * sin(37.719 * i))
object boxes { shape = union(for i in 0..60: box(p - place(i), vec3(0.2 + 0.1 * sin(i), 0.3, 0.25))) }
object balls { shape = smooth_union(for i in 0..20: sphere(p - place(i + 1000), 0.4 + 0.2 * band(0)), 0.3) }
";

#[test]
fn many_shapes_are_the_same_in_every_cell() {
    let world = world_of(MANY);
    let mean = assert_regions_are_right(&world, &inputs_of(&world, 3.0, 0.7), 40_000);
    assert!(mean < 60.0, "{mean} texels for a tape");
}

/// A lattice of balls and bars in cells of size 4, up to 22 from the eye at the centre. Each node has its own size.
pub(super) const LATTICE: &str = "
fn node(p) = round(p / 4)
object frame {
  shape = if length(p) < 22 then lattice(p) else 100
  bound = if length(p) < 22 then others(p) else 100
}
fn lattice(p) {
  let q = p - 4 * node(p)
  let a = abs(q)
  let ball = length(q) - 0.4 - 0.4 * hash(node(p)) * band(0)
  smooth_union(ball, min(length(a.xy), length(a.yz), length(a.zx)) - 0.07, 0.3)
}
fn others(p) {
  let a = abs(p - 4 * node(p))
  sqrt(dot(a, a) + 4 * (4 - 2 * max(a.x, a.y, a.z))) - 0.9
}
";

/// Regression: rays beyond 33 units from the eye ran the whole tape, which was 70 % of all clauses over a sea.
#[test]
fn far_rays_of_a_scene_without_bounds_run_short_tapes() {
    let world = world_of(
        "object sea { shape = y + 0.1 * sin(x) }\n\
         object posts { shape = union(for i in 0..40: capped_cylinder(p - vec3(50 * i - 900, 0, 3 * i * i - 900), 3, 2)) }",
    );
    assert!(world.bounds.is_none());
    let inputs = inputs_of(&world, 0.0, 0.5);
    assert_regions_are_right(&world, &inputs, 40_000);
    let tree = RegionPlan::new(&world).build(&inputs, &RegionOptions::default());
    let reach = crate::rays::FAR;
    let corner = tree.cell_at([reach, reach, reach]).expect("a cell where rays end");
    assert!(corner.bound > 500.0, "{corner:?}");
    for at in [[40.0, 0.0, 90.0], [-500.0, 0.0, 300.0], [700.0, 0.0, -700.0]] {
        let cell = tree.cell_at(at).expect("a cell");
        assert!(tree.clauses_of(cell.tape) * 3 < tree.clauses_of(tree.whole_tape), "{cell:?}");
    }
}

/// A cell once had 301 of 300 clauses: the clause after an empty one was listed, but not counted.
#[test]
fn the_listed_clauses_of_a_cell_are_the_counted_ones() {
    let world = world_of(SPEAKERS);
    let inputs = inputs_of(&world, 3.0, 0.7);
    let tree = RegionPlan::new(&world).build(&inputs, &RegionOptions::default());
    for at in [[0.0, 2.0, 6.0], [0.0, 1.0, 10.0], [-4.0, 3.0, 9.0], [4.0, 5.0, 9.0], [5.0, 1.0, 12.0]] {
        let cell = tree.cell_at(at).expect("a cell");
        assert_eq!(tree.listing(&cell, &inputs).len() as u64, tree.clauses_of(cell.tape), "{at:?}");
    }
}

#[test]
fn cells_that_differ_in_little_share_a_tape() {
    let world = world_of(LATTICE);
    let inputs = inputs_of(&world, 3.0, 0.7);
    assert_regions_are_right(&world, &inputs, 20_000);
    let stats = RegionPlan::new(&world)
        .build(&inputs, &RegionOptions { texels_max: 1 << 22, ..Default::default() })
        .stats;
    // There would be twice as many tapes if cells did not share tapes that have a few steps more than they need.
    assert!(stats.cells > 100_000 && stats.tapes < 9_000, "{stats:?}");
}

#[test]
fn the_tree_of_a_fractal_took_two_hundred_milliseconds_without_shorter_tapes() {
    let world = world_of(include_str!("../../../../assets/scenes/mandelbulb.scene"));
    let options = RegionOptions { texels_max: 1 << 22, ..Default::default() };
    let stats = RegionPlan::new(&world).build(&inputs_of(&world, 20.0, 1.0), &options).stats;
    assert!((300..1200).contains(&stats.passes), "{stats:?}");
}

#[test]
fn cells_that_look_small_are_not_divided() {
    let world = world_of(LATTICE);
    assert!(world.bounds.is_some());
    let inputs = inputs_of(&world, 3.0, 0.7);
    let plan = RegionPlan::new(&world);
    let everywhere = RegionOptions { texels_max: 1 << 22, ..Default::default() };
    let around = RegionOptions { eye: Some([-18.0, 0.0, 0.0]), ..everywhere };
    let [everywhere, around] = [everywhere, around].map(|options| plan.build(&inputs, &options));
    let side = |tree: &Regions, at: [f32; 3]| tree.cell_at(at).map_or(0.0, |cell| cell.high[0] - cell.low[0]);
    let (mut near, mut far) = (0, 0);
    for number in 0..20_000 {
        let at = point(&around, number);
        assert_eq!(around.distance(at, 0.1, &inputs), everywhere.distance(at, 0.1, &inputs), "{at:?}");
        let [here, there] = [&around, &everywhere].map(|tree| side(tree, at));
        if at[0] < -9.0 && at[1].abs() < 9.0 && at[2].abs() < 9.0 {
            assert_eq!(here, there, "{at:?}");
            near += 1;
        }
        far += usize::from(here > there);
    }
    assert!(near > 300 && far > 300, "{near} {far}");
}

#[test]
fn a_tree_without_room_is_right_and_says_so() {
    let world = world_of(MANY);
    let inputs = inputs_of(&world, 3.0, 0.7);
    let plan = RegionPlan::new(&world);
    let room = plan.build(&inputs, &RegionOptions { texels_max: 1 << 22, ..Default::default() });
    let narrow = RegionOptions { texels_max: 17_000, ..Default::default() };
    let tree = plan.build(&inputs, &narrow);
    assert!(tree.texels.len() <= narrow.texels_max && tree.stats.overflowed > 0, "{:?}", tree.stats);
    assert_eq!(room.stats.overflowed, 0);
    for number in 0..5_000 {
        let at = point(&tree, number);
        assert_eq!(tree.distance(at, 0.1, &inputs), room.distance(at, 0.1, &inputs), "{at:?}");
        assert_eq!(tree.object(at, &inputs), room.object(at, &inputs), "{at:?}");
    }
}

#[test]
fn a_tree_in_parts_is_the_same_tree() {
    for (text, center) in
        [(MANY, [0.0; 3]), ("object land { shape = (p.y - 0.6 * sin(p.x) * cos(p.z)) * 0.5 }", [3.0; 3])]
    {
        let world = world_of(text);
        let inputs = inputs_of(&world, 3.0, 0.7);
        let plan = RegionPlan::new(&world);
        let options = RegionOptions { texels_max: 1 << 22, center, ..Default::default() };
        let whole = plan.build(&inputs, &options);
        for count in [2, 3] {
            let tree = plan.build_in_parts(None, &inputs, &options, count, |parts| {
                assert_eq!(parts.len(), count);
                parts.iter_mut().rev().for_each(Part::build);
            });
            assert_eq!((tree.stats.cells, tree.stats.passes), (whole.stats.cells, whole.stats.passes));
            for number in 0..3_000 {
                let at = point(&tree, number);
                let known =
                    |tree: &Regions| tree.cell_at(at).map(|cell| (cell.bound, cell.object, cell.slopes));
                assert_eq!(known(&tree), known(&whole), "{at:?}");
                assert_eq!(tree.distance(at, 0.1, &inputs), whole.distance(at, 0.1, &inputs), "{at:?}");
                assert_eq!(tree.object(at, &inputs), whole.object(at, &inputs), "{at:?}");
            }
        }
        let narrow = RegionOptions { texels_max: 17_000, ..options };
        let tree =
            plan.build_in_parts(None, &inputs, &narrow, 2, |parts| parts.iter_mut().for_each(Part::build));
        assert!(tree.texels.len() <= narrow.texels_max, "{:?}", tree.stats);
        for number in 0..3_000 {
            let at = point(&tree, number);
            assert_eq!(tree.distance(at, 0.1, &inputs), whole.distance(at, 0.1, &inputs), "{at:?}");
        }
    }
}

fn registers_of(tree: &Regions, tape: u32) -> usize {
    let mut most = 0;
    for texel in &tree.texels[tape as usize..] {
        for word in [texel[0], texel[2]] {
            let [number, output, a, b] = word.to_le_bytes();
            let bytes = match (number, number & 0xC0) {
                (opcode::END, _) => [0, a, b],
                // LOAD has an immediate. For other clauses, the form determines the operands.
                (opcode::LOAD, _) => [output, 0, 0],
                (_, 0x80) => [output, a, 0],
                (_, 0xC0) => [output, 0, b],
                _ => [output, a, b],
            };
            most = bytes.into_iter().fold(most, |most, byte| most.max(usize::from(byte) + 1));
        }
        if texel[2] & 255 == u32::from(opcode::END) {
            break;
        }
    }
    most
}

#[test]
fn operands_of_history_reads_have_registers() {
    // Each sum keeps one half in a register while it computes the other half, so the program needs many registers.
    fn sum(first: u32, count: u32) -> String {
        match count {
            1 => format!("length(p - vec3({first}, 0.5 * {first}, 2))"),
            _ => format!("({} - {})", sum(first, count / 2), sum(first + count / 2, count / 2)),
        }
    }
    let place = format!("0.01 * {}", sum(0, 64));
    let world = world_of(&format!("p.y - history({place}, 0.1 * p.x)"));
    let plan = RegionPlan::new(&world);
    let (inputs, loud) = (inputs_of(&world, 3.0, 0.0), inputs_of(&world, 3.0, 0.7));
    for inputs in [inputs, loud] {
        for cells in [true, false] {
            let tree =
                plan.build(&inputs, &RegionOptions { cells, texels_max: 1 << 22, ..Default::default() });
            let registers = registers_of(&tree, tree.whole_tape);
            assert!(registers <= plan.variant.registers, "{registers}, but {:?}", plan.variant);
            assert!(registers > 8, "{registers} are rounded up to as many");
        }
    }
}

#[test]
fn an_operator_in_a_branch_of_the_frame_is_in_the_variant() {
    // There are more expressions than can be hoisted, so that the `if` stays in the program.
    let text = "let ball = union(for i in 0..100: sphere(p - vec3(sin(t+i), sin(2*t+i), sin(3*t+i)), 0.1))\n\
                min(ball, if sin(3.1*t+1000) > -0.99 then 0.5*(2.5 - exp(0.3*x)) else 9)";
    let world = world_of(text);
    let plan = RegionPlan::new(&world);
    assert!(plan.variant.operators.contains(&Op::Exp), "{:?}", plan.variant);
    for time in [0.0, 1.0, 5.0] {
        let tree = plan.build(
            &inputs_of(&world, time, 0.5),
            &RegionOptions { texels_max: 1 << 22, ..Default::default() },
        );
        for texel in &tree.texels[tree.whole_tape as usize..][..tree.stats.whole_clauses / 2] {
            for word in [texel[0], texel[2]] {
                if let Some(Clause { computes: Computes::Operator(op), output, .. }) = Clause::of(word) {
                    assert!(plan.variant.operators.contains(&op), "{op:?} at {time} s");
                    assert!(usize::from(output) < plan.variant.registers);
                }
            }
        }
    }
}

#[test]
fn without_cells_there_is_the_whole_tape() {
    let world = world_of(MANY);
    let inputs = inputs_of(&world, 3.0, 0.7);
    let plan = RegionPlan::new(&world);
    let whole = plan.build(&inputs, &RegionOptions { cells: false, ..Default::default() });
    let cells = plan.build(&inputs, &RegionOptions { texels_max: 1 << 22, ..Default::default() });
    assert_eq!((whole.cell_at([0.0; 3]), whole.size, whole.stats.cells), (None, [0.0; 3], 0));
    for number in 0..2_000 {
        let at = point(&cells, number);
        assert_eq!(whole.distance(at, 0.5, &inputs), cells.distance(at, 0.5, &inputs), "{at:?}");
    }
}

#[test]
fn surfaces_are_within_the_bounds_of_the_frame() {
    let world = world_of("object ball { shape = sphere(p - vec3(4 * sin(t), 0, 0), 0.5 + band(3)) }");
    let plan = RegionPlan::new(&world);
    for (time, loud) in [(0.3, 0.0), (1.6, 0.9), (4.5, 0.4)] {
        let inputs = inputs_of(&world, time, loud);
        let tree = plan.build(&inputs, &RegionOptions::default());
        let Bounds { low, high } = tree.bounds.expect("bounds");
        let (middle, radius) = (4.0 * time.sin(), 0.5 + inputs.levels.of(LevelList::Band)[3]);
        assert!(low[0] <= middle - radius && high[0] >= middle + radius, "{low:?} {high:?}");
        assert!(high[0] - low[0] < 3.0 * radius + 1.0, "{low:?} {high:?}: the ball moves through 8 units");
    }
}

#[test]
fn keys_contain_only_inputs_of_the_distance() {
    let world = world_of(
        "object ball { shape = sphere(p, 1 + band(3)) material = m }\nmaterial m { color = vec3(band(4)) }",
    );
    let plan = RegionPlan::new(&world);
    let key = |band: usize| {
        let mut inputs = inputs_of(&world, 0.0, 0.0);
        inputs.levels.of_mut(LevelList::Band)[band] = 0.25;
        inputs.hoisted = world.hoisted.values(&inputs);
        plan.key(&inputs)
    };
    assert_eq!(key(4), key(5));
    assert_ne!(key(3), key(4));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]
    #[test]
    fn random_expressions_are_the_same_in_every_cell(
        steps in testing::steps(60),
        corner in [-8.0f32..8.0, -8.0..8.0, -8.0..8.0],
        side in 0.01f32..12.0,
    ) {
        let mut graph = Graph::new();
        let built = testing::build(&mut graph, &steps, true);
        let from_end = |back: usize| built[built.len().saturating_sub(1 + back)];
        let object = graph.binary(Op::Less, from_end(1), from_end(2));
        let roots = [from_end(0), from_end(3), object];
        let bounds = Bounds { low: corner, high: corner.map(|low| low + side) };
        let plan = RegionPlan::of(&graph, roots, Some(bounds), true, None);
        let frame = FrameInputs { textures: None, ..testing::frame() };
        let tree = plan.build(&frame, &RegionOptions { texels_max: 1 << 20, ..Default::default() });
        for number in 0..600 {
            let at = point(&tree, number);
            let penumbra = if number % 2 == 0 { 0.0 } else { 0.1 * number as f32 };
            let asked = Point { position: at, normal: [penumbra, 0.0, 0.0] };
            let wanted = graph.evaluate(&roots, &asked, &frame);
            let got = tree.distance(at, penumbra, &frame);
            prop_assert!(testing::same(got[0], wanted[0]), "{at:?} bound {} {}", got[0], wanted[0]);
            prop_assert!(testing::same(got[1], wanted[1]), "{at:?} estimate {} {}", got[1], wanted[1]);
            let tape = tree.cell_at(at).map_or(tree.whole_tape, |cell| cell.tape);
            for tape in [tape, tree.whole_tape] {
                prop_assert!(registers_of(&tree, tape) <= plan.variant.registers, "{:?}", plan.variant);
            }
            if let Some(cell) = tree.cell_at(at) {
                let holds = cell.bound <= 0.0 || cell.bound <= wanted[0];
                prop_assert!(holds, "{at:?}: {cell:?}, but {}", wanted[0]);
                // Objects are looked up only near surfaces and without a penumbra.
                if wanted[0] < 0.2 && penumbra == 0.0 {
                    prop_assert_eq!(tree.object(at, &frame), wanted[2] as u32);
                }
            }
        }
    }
}

#[test]
fn cells_hold_the_slopes_in_them() {
    for (text, widest) in [
        ("sin(x)*cos(y)+sin(y)*cos(z)+sin(z)*cos(x)", 6.0),
        ("x^2+y^2-z^2-1-volume.x", 16.0),
        ("max(x^4+y^4+z^4-band(2), length(p)-2)", 8.0),
        ("y-2*noise_2d(0.2*p.xz+t)", 6.0),
    ] {
        let world = world_of(text);
        assert!(world.non_lipschitz, "{text}");
        let inputs = inputs_of(&world, 3.5, 0.8);
        let options = RegionOptions { cells: false, texels_max: 1 << 22, center: [0.3; 3], eye: None };
        let regions = RegionPlan::new(&world).build(&inputs, &options);
        let tape = Tape::new(&world.graph, &world.roots.distance[..1]);
        let mut gradients = crate::tape::GradientBatch::new(&tape, &inputs);
        let (mut seen, mut close, mut slack) = (0, 0, 0.0);
        for number in 0..60_000 {
            let at = point(&regions, number);
            let Some(cell) = regions.cell_at(at).filter(|cell| cell.bound <= 0.0) else { continue };
            let found = gradients.at(at);
            // A cell that is solid throughout has no surface, so it stores no slopes.
            if cell.slopes == [crate::graph::Interval::point(0.0); 3] && found.value < 0.0 {
                continue;
            }
            seen += 1;
            for (bounds, slope) in cell.slopes.iter().zip(found.gradient) {
                assert!(bounds.contains(slope), "{text} at {at:?}: {slope} is not in {bounds:?}");
                if at.iter().all(|place| place.abs() < 8.0) {
                    slack += bounds.hi - bounds.lo;
                    close += 1;
                }
            }
        }
        assert!(seen > 100 && close > 100, "{text}: {seen} points near surfaces, {close} of them close");
        let slack = slack / close.max(1) as f32;
        assert!(slack < widest, "{text}: bounds are {slack} wide");
    }
}

/// Regression: shared values were kept until their last use, and the frame's numbers took registers like values.
#[test]
fn a_foam_of_many_parts_needed_more_than_256_registers() {
    let plan_of = |center: &str| {
        let world = world_of(&format!("union(for i in 0..799: sphere(p - {center}, 0.1))"));
        let plan = RegionPlan::new(&world);
        (world, plan)
    };
    let numbers = plan_of("vec3(3 * sin(i * 12.9898 + t), 2 + sin(i + 0.7 * t), 3 * sin(i * 37.719 - t))");
    // Each height belongs to two parts, 400 parts apart.
    let shared = plan_of("vec3(3 * sin(i * 12.9898), 2 + sin(t + mod(i, 400)), 3 * sin(i * 37.719))");
    for (world, plan) in [numbers, shared] {
        assert!(plan.runs, "{:?}", plan.variant.registers);
        assert!(!plan.variant.operators.contains(&Op::Sin), "{:?}", plan.variant.operators);
        let inputs = inputs_of(&world, 3.5, 0.8);
        let regions = plan.build(&inputs, &RegionOptions::default());
        for number in 0..500 {
            let at = point(&regions, number);
            let asked = Point::at(at[0], at[1], at[2]);
            let wanted = world.graph.evaluate(&world.roots.distance[..1], &asked, &inputs);
            let got = regions.distance(at, 0.0, &inputs);
            assert!(testing::same(got[0], wanted[0]), "{at:?}: {} instead of {}", got[0], wanted[0]);
        }
        assert!(registers_of(&regions, regions.whole_tape) <= plan.variant.registers);
    }
}

#[test]
fn the_remainder_of_an_infinite_period_was_a_number_in_cells() {
    for period in [f32::INFINITY, 100.0] {
        let mut graph = Graph::new();
        let (y, one) = (graph.input(Input::Y), graph.constant(1.0));
        let period = graph.constant(period);
        let remainder = graph.binary(Op::Mod, y, period);
        let zero = graph.constant(0.0);
        let length = graph.binary(Op::Length, remainder, zero);
        let root = graph.binary(Op::Sub, length, one);
        let roots = [root, root, zero];
        let bounds = Bounds { low: [-1.0, 0.5, -1.0], high: [1.0, 2.5, 1.0] };
        let plan = RegionPlan::of(&graph, roots, Some(bounds), true, None);
        let frame = testing::frame();
        let tree = plan.build(&frame, &RegionOptions::default());
        for number in 0..100 {
            let at = point(&tree, number);
            let wanted = graph.evaluate(&roots, &Point::at(at[0], at[1], at[2]), &frame);
            assert!(testing::same(tree.distance(at, 0.0, &frame)[0], wanted[0]), "{at:?}: {}", wanted[0]);
        }
    }
}

fn texels_of(graph: &Graph, root: crate::graph::NodeId) -> Vec<Texel> {
    let mut encoder = Encoder::new(Compounds::NONE, REGISTERS_MAX);
    let mut texels = Vec::new();
    Formula::new(graph, &[root], 2, 0).tape(&mut encoder).append(&FrameInputs::default(), &mut texels);
    texels
}

#[test]
fn words_match_the_table_in_the_documentation_of_tapes() {
    let mut graph = Graph::new();
    let [x, y] = [Input::X, Input::Y].map(|input| graph.input(input));
    let [one, half] = [1.0, 0.5].map(|number| graph.constant(number));
    let radius = graph.length(&[x, y]);
    let (outer, inner) = (graph.sub(radius, one), graph.sub(half, radius));
    let root = graph.max(outer, inner);
    // Bytes from the highest: input_b, input_a, output, opcode. Immediates follow their clauses.
    let [one, half] = [1.0_f32, 0.5].map(f32::to_bits);
    let expected = [
        [0x00_00_00_18, 0, 0x01_01_01_18, 0], // SQUARE = 24
        [0x01_00_00_40, 0, 0x00_00_00_19, 0], // ADD = 64, SQRT = 25
        // SUB = 65, + 64: register 0 - immediate, and + 128: immediate - register 0.
        [0x80_00_01_81, one, 0x00_80_00_C1, half],
        [0x00_01_00_45, 0, 0x00_00_00_00, 0], // MAX = 69, END
    ];
    assert_eq!(texels_of(&graph, root), expected);
}

#[test]
fn end_and_rare_operators_are_second_in_their_texels() {
    let mut graph = Graph::new();
    let mut node = graph.input(Input::X);
    for length in 0..9 {
        let texels = texels_of(&graph, node);
        let (last, others) = texels.split_last().unwrap();
        assert_eq!(*last, [0; 4]);
        assert_eq!(others.len(), length);
        assert!(others.iter().all(|texel| texel[0] == 0 && texel[2] & 255 == u32::from(Op::Sin.number())));
        node = graph.unary(Op::Sin, node);
    }
}

#[test]
fn a_tape_has_the_numbers_of_each_frame() {
    let mut graph = Graph::new();
    let [x, y, t] = [Input::X, Input::Y, Input::T].map(|input| graph.input(input));
    let (product, sine) = (graph.mul(x, t), graph.unary(Op::Sin, t));
    // A compound computes y + x * -t.
    let difference = graph.sub(y, product);
    let masked = graph.binary(Op::Mask, t, y);
    let sum = graph.add(x, sine);
    let roots = [difference, masked, sine, sum];
    let tape = Formula::new(&graph, &roots, 2, 0).tape(&mut Encoder::new(Compounds::ALL, REGISTERS_MAX));
    for time in [0.0, 1.0, -2.5] {
        let frame = FrameInputs { time, ..Default::default() };
        let mut texels = Vec::new();
        tape.append(&frame, &mut texels);
        let mut registers = [0.0; 256];
        registers[..2].copy_from_slice(&[0.5, 3.0]);
        run_texels(&texels, &mut registers, &[], &frame);
        let got: Vec<f32> = tape.outputs.iter().map(|output| registers[usize::from(*output)] + 0.0).collect();
        assert_eq!(got, graph.evaluate(&roots, &Point::at(0.5, 3.0, 0.0), &frame), "{time} s");
    }
}
