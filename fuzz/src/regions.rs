//! Compares region trees with the full tapes.

use mariana_field::graph::{FrameInputs, Point};
use mariana_field::region::{RegionOptions, RegionPlan, Regions};
use mariana_field::tape::{PointEvaluator, Tape};
use mariana_field::world::World;

use super::bytes::hash;
use super::random::Random;
use super::text;

/// Number of points to compare in each frame.
const POINTS: usize = 300;
/// Maximum number of clauses. Longer tapes are skipped: their trees take seconds, which is a known limitation.
const CLAUSES_MAX: usize = 3_000;
/// Rays look up the object only within this distance of a surface.
const OBJECT_REACH: f32 = 0.2;

/// Checks the region tree of a scene text.
pub(crate) fn regions(data: &[u8]) {
    let Some(world) = text::world(data) else { return };
    let mut random = Random(hash(data));
    for _ in 0..2 {
        let inputs = text::frame_of(&world, &mut random);
        check(&world, &inputs, &mut random);
    }
}

/// Checks that a world's region tree gives the same values as its full tapes, bit for bit, and correct bounds.
pub(crate) fn check(world: &World, inputs: &FrameInputs, random: &mut Random) {
    if !world.has_rest {
        return;
    }
    let distance = Tape::new(&world.graph, &world.roots.distance);
    let object = Tape::new(&world.graph, &[world.roots.object]);
    if distance.clauses.len() > CLAUSES_MAX {
        return;
    }
    let plan = RegionPlan::new(world);
    if !plan.runs {
        return;
    }
    let room = if random.below(4) == 0 { 17_000 } else { 1 << 16 };
    let tree = plan.build(inputs, &RegionOptions { texels_max: room, ..RegionOptions::default() });
    assert!(tree.texels.len() <= room.max(plan.whole_texels), "{:?}", tree.stats);
    let (mut whole, mut whole_object) =
        (PointEvaluator::new(&distance, inputs), PointEvaluator::new(&object, inputs));
    for number in 0..POINTS {
        let position = point(&tree, random);
        let penumbra = if number % 3 == 0 { 0.0 } else { 0.05 * number as f32 };
        let asked = Point { position, normal: [penumbra, 0.0, 0.0] };
        let wanted = [whole.at(&asked)[0], whole.at(&asked)[1]];
        let got = tree.distance(position, penumbra, inputs);
        assert!(same(got[0], wanted[0]) && same(got[1], wanted[1]), "{position:?}: {got:?}, not {wanted:?}");
        let Some(cell) = tree.cell_at(position) else { continue };
        assert!(cell.bound <= 0.0 || cell.bound <= wanted[0], "{position:?}: {cell:?}, but {}", wanted[0]);
        if wanted[0] < OBJECT_REACH {
            let wanted = whole_object.at(&Point { position, normal: [0.0; 3] })[0] as u32;
            assert_eq!(tree.object(position, inputs), wanted, "{position:?}");
        }
    }
}

/// Returns a point in the tree's box or slightly outside.
fn point(tree: &Regions, random: &mut Random) -> [f32; 3] {
    std::array::from_fn(|axis| tree.low[axis] + tree.size[axis] * random.between(-0.05, 1.05))
}

/// True if the bits are equal or both are NaN.
pub(crate) fn same(a: f32, b: f32) -> bool {
    a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan()
}
