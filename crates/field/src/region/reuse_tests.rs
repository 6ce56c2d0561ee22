//! Tests of trees that reuse bricks of the previous frame's tree.

use super::tests::{LATTICE, MANY, inputs_of, point};
use super::*;
use crate::graph::TableData;
use crate::world::testing::{SPEAKERS, world_of};

const NON_LIPSCHITZ: &str = "
object balls {
  shape = union(for i in 0..6: dot(p - vec3(4 * i - 10, 0, 0), p - vec3(4 * i - 10, 0, 0)) - 1 - select(i - 2, 0, band(3)))
}
fn select(i, a, b) = if abs(i) < 0.5 then b else a
";

const HEARS: &str = "
fn ball(i) = sphere(p - vec3(3 * i - 9, 0, 0), 0.8 + (if i < 3 then 0.4 * spectrum(0.5 + 0.01 * p.x) else 0))
union(for i in 0..6: ball(i))
";

fn tapes(tree: &Regions, tape: u32) -> [Vec<[u32; 4]>; 2] {
    let from = |first: u32| {
        let texels = &tree.texels[first as usize..];
        texels[..=texels.iter().position(|texel| texel[2] & 255 == 0).unwrap()].to_vec()
    };
    [from(tape), from(tree.texels[tape as usize - 1][0])]
}

fn assert_same_cells(tree: &Regions, fresh: &Regions, inputs: &FrameInputs, points: u32) {
    let sizes = |tree: &Regions| (tree.low, tree.size, tree.bounds, tree.stats.cells, tree.stats.overflowed);
    assert_eq!(sizes(tree), sizes(fresh));
    assert_eq!(tree.stats.passes + tree.stats.copied, fresh.stats.passes);
    for number in 0..points {
        let at = point(fresh, number);
        let [a, b] = [tree, fresh].map(|tree| tree.cell_at(at));
        let (Some(a), Some(b)) = (a, b) else {
            assert_eq!(a.is_some(), b.is_some(), "{at:?}");
            continue;
        };
        assert_eq!(
            (a.bound, a.object, a.slopes, a.low, a.high),
            (b.bound, b.object, b.slopes, b.low, b.high)
        );
        assert_eq!(tapes(tree, a.tape), tapes(fresh, b.tape), "{at:?}");
        assert_eq!(tree.distance(at, 0.1, inputs), fresh.distance(at, 0.1, inputs), "{at:?}");
        assert_eq!(tree.object(at, inputs), fresh.object(at, inputs), "{at:?}");
    }
}

/// Compares each frame's tree, built after the previous tree, with a fresh tree. Returns the copied fraction of bricks.
fn fraction_copied(text: &str, parts: usize, frames: &[(f32, f32)]) -> f64 {
    let world = world_of(text);
    let plan = RegionPlan::new(&world);
    let options = RegionOptions { texels_max: 1 << 22, ..Default::default() };
    let (mut last, mut copied, mut passes) = (None::<Regions>, 0, 0);
    for (time, loud) in frames {
        let mut inputs = inputs_of(&world, *time, *loud);
        inputs.spectrum = TableData::row([*loud; 64]);
        let run = |parts: &mut [Part]| parts.iter_mut().for_each(Part::build);
        let tree = plan.build_in_parts(last.as_ref(), &inputs, &options, parts, run);
        assert_same_cells(&tree, &plan.build(&inputs, &options), &inputs, 8_000);
        if last.is_some() {
            copied += tree.stats.copied;
            passes += tree.stats.copied + tree.stats.passes;
        }
        last = Some(tree);
    }
    copied as f64 / f64::from(passes as u32)
}

const FRAMES: [(f32, f32); 4] = [(3.0, 0.5), (3.0, 0.52), (3.1, 0.55), (3.1, 0.55)];

#[test]
fn copied_bricks_equal_fresh_ones() {
    for (text, least) in [(SPEAKERS, 0.2), (MANY, 0.2), (NON_LIPSCHITZ, 0.2)] {
        for parts in [1, 3] {
            let fraction = fraction_copied(text, parts, &FRAMES);
            assert!(fraction > least && fraction < 0.95, "{fraction} of {text}");
        }
    }
}

#[test]
fn bricks_that_read_sound_tables_are_not_copied() {
    // Only the table changes. The program's numbers stay the same.
    let fraction = fraction_copied(HEARS, 1, &[(3.0, 0.1), (3.0, 0.9), (3.0, 0.2)]);
    assert!(fraction > 0.1 && fraction < 0.9, "{fraction}");
}

fn build_after(plan: &RegionPlan, last: &Regions, inputs: &FrameInputs, options: &RegionOptions) -> Regions {
    plan.build_in_parts(Some(last), inputs, options, 1, |parts| parts.iter_mut().for_each(Part::build))
}

#[test]
fn full_and_moved_trees_are_safe_sources() {
    let world = world_of(MANY);
    let plan = RegionPlan::new(&world);
    let [one, other] = [(3.0, 0.7), (3.0, 0.72)].map(|(time, loud)| inputs_of(&world, time, loud));
    let wide = RegionOptions { texels_max: 1 << 22, ..Default::default() };
    let narrow = RegionOptions { texels_max: 17_000, ..wide };
    let fresh = plan.build(&other, &wide);
    for [first, then] in [[narrow, wide], [wide, narrow]] {
        let tree = build_after(&plan, &plan.build(&one, &first), &other, &then);
        assert!(tree.texels.len() <= then.texels_max);
        for number in 0..5_000 {
            let at = point(&fresh, number);
            assert_eq!(tree.distance(at, 0.1, &other), fresh.distance(at, 0.1, &other), "{at:?}");
            assert_eq!(tree.object(at, &other), fresh.object(at, &other), "{at:?}");
        }
    }
    let land = world_of(LATTICE);
    let plan = RegionPlan::new(&land);
    let inputs = inputs_of(&land, 3.0, 0.7);
    let around = RegionOptions { eye: Some([-18.0, 0.0, 0.0]), ..wide };
    let tree = build_after(&plan, &plan.build(&inputs, &around), &inputs, &wide);
    assert_same_cells(&tree, &plan.build(&inputs, &wide), &inputs, 5_000);
}
