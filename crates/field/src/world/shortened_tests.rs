//! Tests that a shortened program gives the same values in its cell as the whole program.

use std::sync::Arc;

use proptest::prelude::*;

use super::*;
use crate::graph::{Compounds, LevelList, Point, SoundInput, SoundInputs, testing};
use crate::region::Surfaces;
use crate::region::{RegionOptions, RegionPlan, run_texels};
use crate::world::testing::{SPEAKERS, world_of};
use crate::world::{ShortenOptions, ShortenRequest};

/// Runs a program as `run_program` in the shaders does. Returns its outputs and the number of texels of its tape.
fn run(texels: &[[u32; 4]], place: usize, over: Over, at: &Point, frame: &FrameInputs) -> (Vec<f32>, usize) {
    let inputs: [f32; 6] = std::array::from_fn(|i| if i < 3 { at.position[i] } else { at.normal[i - 3] });
    let asked = if over == Over::Points { at.position } else { at.normal };
    let grid = texels.as_flattened()[place] as usize;
    let [low, scale] =
        [texels[grid], texels[grid + 1]].map(|texel| [0, 1, 2].map(|i| f32::from_bits(texel[i])));
    let cell = if texels[grid][3] == 0 { 0 } else { Grid { low, scale }.cell_of(asked) };
    let program = texels[grid + 2..].as_flattened()[cell] as usize;
    let head = texels[program];
    let mut samples = Vec::new();
    let mut registers = [0.0; 256];
    let mut own = |first: usize, samples: &[f32]| {
        registers = [0.0; 256];
        registers[..6].copy_from_slice(&inputs);
        let two = run_texels(&texels[first..], &mut registers, samples, frame);
        (two, registers)
    };
    for number in 0..head[3] as usize {
        let [picture, first, ..] = texels[program + 1 + number];
        let ([u, v], _) = own(first as usize, &samples);
        samples.extend((0..4).map(|channel| frame.texture(picture as u16, channel, u, v)));
    }
    let first = program + 1 + head[3] as usize;
    let (_, registers) = own(first, &samples);
    let end = texels[first..].iter().position(|texel| texel[2] & 255 == 0).unwrap();
    let outputs = head[..3].iter().flat_map(|word| word.to_le_bytes());
    (outputs.map(|register| registers[usize::from(register)] + 0.0).collect(), end + 1)
}

/// Returns a point in a box around the origin or, for some numbers, far outside. Its normal has length 1.
fn point(number: u32, reach: f32) -> Point {
    let place = |step: f64| (f64::from(number) * step + 0.5).fract() as f32 * 2.0 - 1.0;
    let reach = if number.is_multiple_of(8) { 30.0 * reach } else { reach };
    let position = [place(0.754_877_67), place(0.569_840_3), place(0.438_579_22)].map(|place| place * reach);
    let (up, turn) = (place(0.819_172_5), 3.1 * place(0.671_043_6));
    let side = (1.0 - up * up).sqrt();
    Point { position, normal: [side * turn.cos(), up, side * turn.sin()] }
}

fn frame_of(world: &World, time: f32, loud: f32) -> FrameInputs {
    let mut frame = FrameInputs {
        time,
        sound: SoundInputs::with(&[(SoundInput::VolumeLeft, 0.3 * loud), (SoundInput::Bass, loud)]),
        params: world.scene.params.iter().map(|param| param.default).collect(),
        ..Default::default()
    };
    for (band, value) in frame.levels.of_mut(LevelList::Band).iter_mut().enumerate() {
        *value = loud * (0.5 + 0.5 * (band as f32 * 1.7 + time).sin());
    }
    frame.hoisted = world.hoisted.values(&frame);
    frame
}

const ROOMS: &str = "
fn room(p) = clamp(round(p.x / 4), -2, 2)
fn wave(q, i) = sin(i * length(q - vec2(i, 2)) - t) / (1 + length(q))
material lamp { color = vec3(1) emission = vec3(0.2 + band(3), room(p) + 3, 1) * smoothstep(2, 1, abs(p.y)) }
material floor {
  let lit  = smoothstep(3, 2, max(abs(p.x), abs(p.z)))
  color    = mix(vec3(0.2), vec3(0.5, 0.4, noise(3 * p)), lit)
  emission = lit * vec3(sum(for i in 1..9: wave(p.xz, i)), 0.1, 0.3) * (1 + volume.x)
  roughness = if n.y > 0.9 then 0.2 else 0.7
}
material wall { color = if p.x < -2 then vec3(0.1) else if p.x > 5 then vec3(noise(p)) else vec3(0.3, 0.2, fract(p.z)) }
object lamps { shape = sphere(vec3(p.x - 4 * room(p), p.y - 1, p.z), 0.4) material = lamp }
object wall { shape = box(p - vec3(0, 1, 4), vec3(10, 2, 0.2)) material = wall }
object floor { shape = p.y material = floor }
sky {
  let up = max(direction.y, 0)
  color = mix(vec3(0.1, 0.2, noise_2d(9 * direction.xz / (0.1 + up))) , vec3(0.02), smoothstep(0.01, -0.01, direction.y))
  ambient = vec3(0.1 + 0.1 * direction.y)
}
";

fn shortened(buffers: &TapeBuffers, frame: &FrameInputs, options: &ShortenOptions<'_>) -> ShortPrograms {
    buffers.shorten(frame, &buffers.worth_shortening().request(buffers, frame), options)
}

fn whole_texels(buffers: &TapeBuffers, frame: &FrameInputs) -> Vec<[u32; 4]> {
    buffers.texels(frame, &ShortPrograms::default())
}

/// Compares the shortened and whole programs of a world at many points. Returns the mean length of the tapes that were
/// run, as a fraction of the whole tapes.
fn assert_the_same(world: &World, frame: &FrameInputs, options: &ShortenOptions<'_>) -> f64 {
    let buffers = world.tape_buffers();
    let texels = buffers.texels(frame, &shortened(&buffers, frame, options));
    assert_these_are_the_same(world, frame, &texels)
}

fn assert_these_are_the_same(world: &World, frame: &FrameInputs, short: &[[u32; 4]]) -> f64 {
    let whole = whole_texels(&world.tape_buffers(), frame);
    let materials = world.scene.objects.iter().enumerate();
    let materials =
        materials.map(|(object, its)| (4 + object, Over::Points, world.roots.materials[its.material].len()));
    let light = [(0, Over::Directions, 3), (1, Over::Directions, 3), (2, Over::Points, 4)];
    let places = light.into_iter().chain(materials);
    let (mut ran, mut whole_ran) = (0, 0);
    for (place, over, outputs) in places {
        for number in 0..4_000 {
            let at = point(number, 8.0);
            let at = if place == 0 { Point { position: [0.0; 3], ..at } } else { at };
            let (wanted, length) = run(&whole, place, over, &at, frame);
            let (got, shorter) = run(short, place, over, &at, frame);
            for (got, wanted) in got.iter().zip(&wanted).take(outputs) {
                assert!(testing::same(*got, *wanted), "{place} at {at:?}: {got} and not {wanted}");
            }
            assert!(shorter <= length, "{place} at {at:?}: {shorter} texels and not {length}");
            (ran, whole_ran) = (ran + shorter, whole_ran + length);
        }
    }
    ran as f64 / whole_ran as f64
}

#[test]
fn materials_and_light_are_the_same_in_every_cell() {
    for (text, fraction_max) in [(ROOMS, 0.6), (SPEAKERS, 1.0)] {
        let world = world_of(text);
        for (time, loud) in [(0.0, 0.0), (31.0, 0.6)] {
            let frame = frame_of(&world, time, loud);
            let fraction = assert_the_same(&world, &frame, &ShortenOptions::default());
            assert!(fraction < fraction_max, "{fraction} of the texels were run");
        }
    }
}

#[test]
fn programs_without_room_are_whole() {
    let world = world_of(ROOMS);
    let frame = frame_of(&world, 3.0, 0.5);
    let buffers = world.tape_buffers();
    let most = buffers.texels_max();
    for texels_max in [0, most, most + 300, most + 1_500] {
        let options = ShortenOptions { texels_max, ..Default::default() };
        let short = shortened(&buffers, &frame, &options);
        assert!(buffers.texels(&frame, &short).len() <= most.max(texels_max));
        assert_the_same(&world, &frame, &options);
    }
}

#[test]
fn programs_are_shortened_where_surfaces_are() {
    let world = world_of(ROOMS);
    let frame = frame_of(&world, 3.0, 0.5);
    let regions = RegionPlan::new(&world).build(&frame, &RegionOptions::default());
    let planes = world.frame_tape.values(&frame).planes;
    let surfaces = Surfaces { regions: &regions, planes: &planes, around: 0.3 };
    let options = ShortenOptions { surfaces: Some(surfaces), ..Default::default() };
    assert_the_same(&world, &frame, &options);
    let buffers = world.tape_buffers();
    let texels = |options: ShortenOptions| buffers.texels(&frame, &shortened(&buffers, &frame, &options));
    let everywhere = texels(ShortenOptions::default());
    let where_asked = texels(options);
    let whole = whole_texels(&buffers, &frame);
    let distance = Tape::new(&world.graph, &world.roots.distance);
    let mut distance = crate::tape::PointEvaluator::new(&distance, &frame);
    // How many tapes are shorter, near surfaces and away from them: first with known surfaces, then with unknown ones.
    let (mut near, mut away) = ([0; 2], [0; 2]);
    for number in 0..40_000 {
        let mut at = point(number, 6.0);
        if number % 3 == 0 {
            at.position[1] = 0.0;
        }
        let height = distance.at(&at)[0].abs().min(at.position[1].abs());
        let counts = if height < 0.25 { &mut near } else { &mut away };
        for place in [2, 4, 5, 6] {
            let length = |texels| run(texels, place, Over::Points, &at, &frame).1;
            let most = length(&whole);
            for (count, texels) in counts.iter_mut().zip([&where_asked, &everywhere]) {
                *count += usize::from(length(texels) < most);
            }
        }
    }
    // A block's tape only has to serve cells near known surfaces, so known surfaces may give more short tapes.
    assert!(near[1] > 1_000 && near[0] >= near[1], "near: {near:?}");
    assert!(away[0] < away[1], "away: {away:?}");
}

const CHANGING: &str = "
fn wave(q, i) = sin(i * length(q - vec2(i, 2)) - t) / (1 + length(q))
material floor {
  let lit  = smoothstep(3, 2, max(abs(p.x), abs(p.z)) - 900 * bass)
  emission = lit * vec3(sum(for i in 1..9: wave(p.xz, i)), 0.1, 0.3)
}
material wall { color = 0.5 + 0.5 * vec3(sum(for i in 1..9: wave(p.xy, i)), noise(p), fract(p.z)) }
object floor { shape = p.y material = floor }
object wall { shape = box(p - vec3(0, 1, 4), vec3(10, 2, 0.2)) material = wall }
";

fn names(request: &ShortenRequest, materials: usize) -> Vec<bool> {
    (0..materials).map(|number| request.key_of(PROGRAMS_OF_LIGHT + number).is_some()).collect()
}

#[test]
fn programs_that_save_little_stay_whole_for_a_while() {
    let world = world_of(CHANGING);
    let buffers = world.tape_buffers();
    let mut worth = buffers.worth_shortening();
    let options = ShortenOptions::default();
    let mut attempts = Vec::new();
    for (number, loud) in [(0, 0.0), (1, 0.0), (2, 1.0), (3, 0.0), (602, 0.0), (603, 0.0)] {
        let frame = frame_of(&world, number as f32, loud);
        while attempts.len() < number {
            attempts.push(Vec::new());
            worth.pass_frame();
        }
        let request = worth.request(&buffers, &frame);
        attempts.push(names(&request, 2));
        let short = buffers.shorten(&frame, &request, &options);
        assert_these_are_the_same(&world, &frame, &buffers.texels(&frame, &short));
        worth.record(&short);
        worth.pass_frame();
    }
    assert_eq!(attempts[0], [true, true], "nothing is known yet");
    assert_eq!(attempts[1], [true, false], "the wall's pattern is everywhere");
    assert_eq!(attempts[2], [true, false]);
    assert_eq!(attempts[3], [false, false], "it was bright everywhere");
    assert_eq!(attempts[602], [true, true], "another chance");
    assert_eq!(attempts[603], [true, false]);
}

#[test]
fn programs_that_were_shortened_with_other_numbers_are_not_run() {
    let world = world_of(CHANGING);
    let buffers = world.tape_buffers();
    let [quiet, loud] = [0.0, 1.0].map(|loud| frame_of(&world, 3.0, loud));
    let short = shortened(&buffers, &quiet, &ShortenOptions::default());
    // The last cells of two grids: of the sky, which reads no number, and of the floor's material.
    let last_cells = |frame| {
        let texels = buffers.texels(frame, &short);
        [0, 4].map(|place| texels[texels.as_flattened()[place] as usize][3])
    };
    assert_eq!(last_cells(&quiet), [SIDE as u32 - 1; 2]);
    assert_eq!(last_cells(&loud), [SIDE as u32 - 1, 0], "the whole material is run");
    let [quiet, loud] = [quiet, loud].map(|frame| buffers.worth_shortening().request(&buffers, &frame));
    assert!(quiet.is_served_by(&quiet) && !loud.is_served_by(&quiet));
    assert!(loud.is_served_by(&ShortenRequest::default()), "whole programs serve");
    assert!(ShortenRequest::default().is_served_by(&quiet), "no shortened program is run");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]
    #[test]
    fn random_programs_are_the_same_in_every_cell(
        steps in testing::steps(80),
        corner in [-8.0f32..8.0, -8.0..8.0, -8.0..8.0],
        side in 0.01f32..12.0,
        directions in any::<bool>(),
    ) {
        let mut graph = Graph::new();
        let built = testing::build(&mut graph, &steps, true);
        let from_end = |back: usize| built[built.len().saturating_sub(1 + back)];
        let roots = [0, 3, 1, 7].map(from_end);
        let over = if directions { Over::Directions } else { Over::Points };
        let mut program = SurfaceTape::new(&graph, &roots, over);
        prop_assume!(program.needs.registers.is_some());
        program.encode(&mut Encoder::new(Compounds::ALL, REGISTERS_MAX));
        let variant = Variant {
            operators: program.needs.operators.clone(),
            compounds: Compounds::ALL,
            registers: REGISTERS_MAX,
            samples: program.textures.len(),
            textures: 0,
            every_case: false,
        };
        let buffers = TapeBuffers {
            medium: None,
            swarm: None,
            software_variant: variant.clone(),
            variant,
            runs: true,
            programs: vec![program],
            of_objects: Vec::new(),
            bounds: Some(Bounds { low: corner, high: corner.map(|low| low + side) }),
            cost: Cost::default(),
        };
        let frame = FrameInputs { textures: testing::frame().textures.as_ref().map(Arc::clone), ..testing::frame() };
        let options = ShortenOptions { texels_max: 1 << 20, ..Default::default() };
        let texels = buffers.texels(&frame, &shortened(&buffers, &frame, &options));
        let whole = whole_texels(&buffers, &frame);
        for number in 0..600 {
            let at = point(number, 10.0);
            let at = if directions { Point { position: [0.0; 3], ..at } } else { at };
            let wanted = run(&whole, 0, over, &at, &frame).0;
            let got = run(&texels, 0, over, &at, &frame).0;
            for (got, wanted) in got.iter().zip(&wanted).take(roots.len()) {
                prop_assert!(testing::same(*got, *wanted), "{at:?}: {got} and not {wanted}");
            }
            for (value, truth) in wanted.iter().zip(graph.evaluate(&roots, &at, &frame)) {
                prop_assert!(testing::same(*value, truth), "{at:?}: {value} and not {truth}");
            }
        }
    }
}
