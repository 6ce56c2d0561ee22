use proptest::prelude::*;

use super::*;
use crate::graph::Point;
use crate::tape::{PointEvaluator, Tape, TapeOptions};
use crate::world::testing::{SPEAKERS, world_of};

/// A frame of a world with some sound.
fn inputs_of(world: &World, time: f32, loud: f32) -> FrameInputs {
    let mut inputs = FrameInputs {
        time,
        volume: [0.3 * loud, 0.2 * loud],
        params: world.scene.params.iter().map(|param| param.default).collect(),
        ..Default::default()
    };
    for (band, value) in inputs.bands.iter_mut().enumerate() {
        *value = loud * (0.5 + 0.5 * (band as f32 * 1.7 + time).sin());
    }
    inputs.hoisted = world.hoisted.values(&inputs);
    inputs
}

/// Points spread over the tree's box and a little around it, the same for the same number.
fn point(regions: &Regions, number: u32) -> [f32; 3] {
    let places = [0.754_877_67, 0.569_840_3, 0.438_579_22_f64];
    std::array::from_fn(|axis| {
        let share = (f64::from(number) * places[axis] + 0.5).fract() as f32;
        regions.low[axis] + regions.size[axis] * (share * 1.1 - 0.05)
    })
}

/// Compares cells' tapes, bounds and objects with the world's own tapes at many points. Returns the mean length of the
/// tapes that were run.
fn assert_regions_are_right(world: &World, inputs: &FrameInputs, points: u32) -> f64 {
    let plan = RegionPlan::new(world);
    let options = RegionOptions { texels_max: 1 << 22, ..Default::default() };
    let regions = plan.build(inputs, &options);
    let tape = Tape::build(&world.graph, &world.roots.distance, &TapeOptions::default()).unwrap();
    let object = Tape::build(&world.graph, &[world.roots.object], &TapeOptions::default()).unwrap();
    let (mut whole, mut whole_object) =
        (PointEvaluator::new(&tape, inputs), PointEvaluator::new(&object, inputs));
    let mut texels = 0.0;
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
            let tape = &regions.texels[cell.tape as usize..];
            texels += 1.0 + tape.iter().position(|texel| texel[2] & 255 == 0).unwrap_or(0) as f64;
        }
    }
    texels / f64::from(points)
}

#[test]
fn the_speakers_are_the_same_in_every_cell() {
    let world = world_of(SPEAKERS);
    for (time, loud) in [(0.0, 0.0), (31.0, 0.6), (77.0, 1.0)] {
        let mean = assert_regions_are_right(&world, &inputs_of(&world, time, loud), 60_000);
        assert!(mean < 16.0, "{mean} texels for a tape");
    }
}

#[test]
#[ignore = "prints figures"]
fn figures() {
    let world = world_of(SPEAKERS);
    let inputs = inputs_of(&world, 31.0, 0.6);
    let plan = RegionPlan::new(&world);
    let regions = plan.build(&inputs, &RegionOptions { texels_max: 1 << 22, ..Default::default() });
    println!("{:?} {:?} {:?}", regions.low, regions.size, regions.stats);
    let start = std::time::Instant::now();
    for _ in 0..100 {
        std::hint::black_box(
            plan.build(&inputs, &RegionOptions { texels_max: 1 << 22, ..Default::default() }),
        );
    }
    println!("{:?}", start.elapsed() / 100);
}

/// Of a distance that is none each cell with a surface tells how steep it may be.
#[test]
fn cells_hold_the_slopes_in_them() {
    for text in [
        "sin(x)*cos(y)+sin(y)*cos(z)+sin(z)*cos(x)",
        "x^2+y^2-z^2-1-volume.x",
        "max(x^4+y^4+z^4-band(2), length(p)-2)",
        "y-2*noise_2d(0.2*p.xz+t)",
    ] {
        let world = world_of(text);
        assert!(world.steep, "{text}");
        let inputs = inputs_of(&world, 3.5, 0.8);
        let options = RegionOptions { cells: false, texels_max: 1 << 22, center: [0.3; 3] };
        let regions = RegionPlan::new(&world).build(&inputs, &options);
        let tape = Tape::build(&world.graph, &world.roots.distance[..1], &TapeOptions::default()).unwrap();
        let mut gradients = crate::tape::GradientEvaluator::new(&tape, &inputs);
        let (mut seen, mut slack) = (0, 0.0);
        for number in 0..20_000 {
            let at = point(&regions, number);
            let Some(cell) = regions.cell_at(at).filter(|cell| cell.bound <= 0.0) else { continue };
            let found = gradients.at(&Point::at(at[0], at[1], at[2]))[0];
            // Solid all through: no surface, no slope.
            if cell.slopes == [crate::graph::Interval::point(0.0); 3] && found.value < 0.0 {
                continue;
            }
            seen += 1;
            for (bounds, slope) in cell.slopes.iter().zip(found.gradient) {
                assert!(bounds.contains(slope), "{text} at {at:?}: {slope} is not in {bounds:?}");
                slack += bounds.hi - bounds.lo;
            }
        }
        assert!(seen > 100, "{text}: {seen} points near surfaces");
        let slack = slack / (3 * seen) as f32;
        assert!(slack < 6.0, "{text}: bounds are {slack} wide");
    }
}
