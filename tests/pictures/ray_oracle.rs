//! Traces rays through the shipped scenes with the scenes' region trees, and compares hits and misses with an oracle.
//! The oracle evaluates the whole ray in 64-bit interval arithmetic with outward rounding, which proves a hit or a
//! miss.
//!
//! `MARIANA_RAYS` sets the number of rays for each scene; use 10,000 for a long run.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use crate::blends::Pair;
use crate::support::expression::Random;
use mariana::scenes::SceneSource;
use mariana_field::graph::{FrameInputs, LevelList, Levels, SHAPE_STEP};
#[allow(dead_code)]
use mariana_field::graph::{SoundInput, SoundInputs};
use mariana_field::rays;
use mariana_field::region::{Cell, RegionOptions, RegionPlan, Regions, gradient};
use mariana_field::tape::{Clause, Instruction, Operand, Tape};
use mariana_field::world::{Alignment, World};

/// The growth of a pixel's cone per unit of distance, for 360 rows and 40 degrees.
const SPREAD: f64 = 0.002;

// --- the oracle -----------------------------------------------------------------------------------------------------

/// Formulas that modellers write. They are neither Lipschitz nor clipped. The first blends rotated parts by the sum of
/// their exponentials. Far away that sum is 0, so the formula is constant there. The second is a polynomial, whose
/// terms cancel each other in any large box.
const OF_MODELLERS: [(&str, &str); 2] = [
    (
        "blend",
        "fn turned(p, i) = vec3(cos(i) * p.x + sin(i) * p.y, cos(i) * p.y - sin(i) * p.x, p.z)
        fn part(p, i) = 1.8 * (length(turned(p, i) * vec3(1, 1.5, 0.7) - vec3(0.6, 0.1, 0.4 * sin(4 * i))) - 0.4)
        object blend { shape = -log(sum(for i in 0..12: exp(-11 * part(p, i)))) / 11 }
        camera { position = vec3(1.5, 1.2, 3.2)  target = vec3(0) }",
    ),
    ("polynomial", "(1.5*x)^4-5*(1.5*x)^2 + (1.5*y)^4-5*(1.5*y)^2 + (1.5*z)^4-5*(1.5*z)^2 + 11.8"),
];

const REPEATING: [&str; 9] =
    ["city", "forest", "lattice", "library", "nave", "rain", "reef", "spiral", "village"];

type Span = (f64, f64);

const ALL: Span = (f64::NEG_INFINITY, f64::INFINITY);

/// Widens an interval by more than any rounding error of 64-bit arithmetic, library functions and 32-bit table entries.
fn out((lo, hi): Span) -> Span {
    if lo.is_nan() || hi.is_nan() {
        return ALL;
    }
    let wide = |v: f64| 1e-12 * v.abs() + 1e-300;
    (lo - wide(lo), hi + wide(hi))
}

fn hull(values: [f64; 4]) -> Span {
    out((
        values.into_iter().fold(f64::INFINITY, f64::min),
        values.into_iter().fold(f64::NEG_INFINITY, f64::max),
    ))
}

fn rising(a: Span, f: impl Fn(f64) -> f64) -> Span {
    out((f(a.0), f(a.1)))
}

fn abs(a: Span) -> Span {
    if a.0 >= 0.0 {
        a
    } else if a.1 <= 0.0 {
        (-a.1, -a.0)
    } else {
        (0.0, a.1.max(-a.0))
    }
}

fn mul(a: Span, b: Span) -> Span {
    let products = [a.0 * b.0, a.0 * b.1, a.1 * b.0, a.1 * b.1];
    if products.iter().any(|v| v.is_nan()) { ALL } else { hull(products) }
}

fn div(a: Span, b: Span) -> Span {
    if b == (0.0, 0.0) {
        (0.0, 0.0)
    } else if b.0 <= 0.0 && b.1 >= 0.0 {
        ALL
    } else {
        mul(a, out((1.0 / b.1, 1.0 / b.0)))
    }
}

fn wave(a: Span, crest: f64, f: impl Fn(f64) -> f64) -> Span {
    use std::f64::consts::{PI, TAU};
    if !(a.1 - a.0 < TAU && a.0.abs() < 1e9) {
        return (-1.0, 1.0);
    }
    let ends = out((f(a.0).min(f(a.1)), f(a.0).max(f(a.1))));
    let reaches = |place: f64| ((a.0 - 1e-6 - place) / TAU).ceil() * TAU + place <= a.1 + 1e-6;
    (if reaches(crest + PI) { -1.0 } else { ends.0 }, if reaches(crest) { 1.0 } else { ends.1 })
}

fn truth(surely: bool, never: bool) -> Span {
    if surely {
        (1.0, 1.0)
    } else if never {
        (0.0, 0.0)
    } else {
        (0.0, 1.0)
    }
}

fn is_whole(v: f64) -> bool {
    v.fract() == 0.0 && v.abs() < 1e9
}

/// Computes an operator on intervals. Supports the operators that the shipped scenes use; returns [`ALL`] for others.
fn operate(name: &str, a: Span, b: Span, frame: &FrameInputs) -> Span {
    let less = |a: Span, b: Span| truth(a.1 < b.0, a.0 >= b.1);
    let are_whole = [a.0, a.1, b.0, b.1].into_iter().all(is_whole);
    match name {
        "NEG" => (-a.1, -a.0),
        "ABS" => abs(a),
        "SQUARE" => rising(abs(a), |v| v * v),
        "SQRT" => rising((a.0.max(0.0), a.1.max(0.0)), f64::sqrt),
        "EXP" => rising(a, f64::exp),
        "LOG" => rising(a, |v| v.max(f64::from(f32::MIN_POSITIVE)).ln()),
        "SIN" => wave(a, std::f64::consts::FRAC_PI_2, f64::sin),
        "COS" => wave(a, 0.0, f64::cos),
        "ATAN" => rising(a, f64::atan),
        "FLOOR" => (a.0.floor(), a.1.floor()),
        "CEIL" => (a.0.ceil(), a.1.ceil()),
        "ROUND" => ((a.0 + 0.5).floor(), (a.1 + 0.5).floor()),
        "SIGN" => (f64::from(a.0 > 0.0) - f64::from(a.0 < 0.0), f64::from(a.1 > 0.0) - f64::from(a.1 < 0.0)),
        "NOT" => truth(a == (0.0, 0.0), a.0 > 0.0 || a.1 < 0.0),
        // Sums, products and remainders of whole numbers are exact. Hashes jump at whole numbers.
        "ADD" if are_whole => (a.0 + b.0, a.1 + b.1),
        "SUB" if are_whole => (a.0 - b.1, a.1 - b.0),
        "MUL" if a.0 == a.1 && b.0 == b.1 && is_whole(a.0 * b.0) => (a.0 * b.0, a.0 * b.0),
        "ADD" => out((a.0 + b.0, a.1 + b.1)),
        "SUB" => out((a.0 - b.1, a.1 - b.0)),
        "MUL" => mul(a, b),
        "DIV" => div(a, b),
        "MIN" => (a.0.min(b.0), a.1.min(b.1)),
        "MAX" => (a.0.max(b.0), a.1.max(b.1)),
        "POW" if a.0 > 1e-30 => hull([a.0.powf(b.0), a.0.powf(b.1), a.1.powf(b.0), a.1.powf(b.1)]),
        "POW" if b.0 > 0.0 => (0.0, out((0.0, a.1.max(0.0).powf(b.0).max(a.1.max(0.0).powf(b.1)))).1),
        "LESS" => less(a, b),
        "LESS_EQUAL" => truth(a.1 <= b.0, a.0 > b.1),
        "STEP" => truth(b.0 >= a.1, b.1 < a.0),
        "MASK" if a == (0.0, 0.0) => (0.0, 0.0),
        "MASK" if a.0 > 0.0 || a.1 < 0.0 => b,
        "MASK" => (b.0.min(0.0), b.1.max(0.0)),
        "HASH" if a.0.floor() == a.1.floor() && b.0.floor() == b.1.floor() => {
            let value = f64::from(mariana_field::graph::cell_hash(a.0 as f32, b.0 as f32));
            (value, value)
        }
        "HASH" => (0.0, 1.0),
        // The result is exact if the interval contains no multiple of b.
        "MOD" if b.0 == b.1 && b.0 > 0.0 => {
            let rounds = (a.0 / b.0).floor();
            if rounds == (a.1 / b.0).floor() && are_whole {
                (a.0 - rounds * b.0, a.1 - rounds * b.0)
            } else if rounds == (a.1 / b.0).floor() {
                out((a.0 - rounds * b.0, a.1 - rounds * b.0))
            } else {
                (0.0, b.0)
            }
        }
        "FRACT" if a.0.floor() == a.1.floor() => out((a.0 - a.0.floor(), a.1 - a.0.floor())),
        "FRACT" => (0.0, 1.0),
        // The angle jumps along the negative b axis.
        "ATAN2" if a.0 > 0.0 || a.1 < 0.0 || b.0 > 0.0 => {
            out(hull([a.0.atan2(b.0), a.0.atan2(b.1), a.1.atan2(b.0), a.1.atan2(b.1)]))
        }
        "ATAN2" => (-3.2, 3.2),
        "SHAPE_NUMBER" if a.0 == a.1 => {
            let number = f64::from(frame.shapes.number(a.0 as f32));
            (number, number)
        }
        "SHAPE" => shape(a, b, frame),
        // The frames of this test have no sound curves and no parts of a song.
        "PART" | "SPECTRUM" | "WAVEFORM" | "HISTORY" => (0.0, 0.0),
        _ => LevelList::named(&name.to_lowercase()).map_or(ALL, |list| level(list, a, frame)),
    }
}

fn level(list: LevelList, index: Span, frame: &FrameInputs) -> Span {
    let number = |v: f64| (v.max(0.0) as usize).min(list.count() - 1);
    let heard =
        frame.levels.of(list)[number(index.0)..=number(index.1)].iter().map(|level| f64::from(*level));
    heard.fold((f64::INFINITY, f64::NEG_INFINITY), |all, level| (all.0.min(level), all.1.max(level)))
}

/// Bounds of a text's or a picture's distance. Its slope is at most 1 per unit of the coordinates of the shape.
fn shape(column: Span, row: Span, frame: &FrameInputs) -> Span {
    let middle = |of: Span| 0.5 * (of.0 + of.1);
    let coarsest = frame.shapes.shapes().map(|shape| f64::from(shape.grid.points_per_unit));
    let slope = f64::from(SHAPE_STEP) / coarsest.fold(f64::INFINITY, f64::min);
    let away = slope * (0.5 * (column.1 - column.0)).hypot(0.5 * (row.1 - row.0));
    let value = f64::from(frame.shapes.at(middle(column) as f32, middle(row) as f32));
    // The coordinates of the middle and the value are rounded to 32 bits.
    let rounding = 1e-6 * (1.0 + slope * (middle(column).abs() + middle(row).abs()) + value.abs());
    (value - away - rounding, value + away + rounding)
}

struct Oracle<'a> {
    tape: &'a Tape,
    table: Vec<f32>,
    frame: &'a FrameInputs,
}

impl Oracle<'_> {
    fn over(&self, p: [Span; 3]) -> Span {
        let value = |registers: &[Span], operand| match operand {
            Operand::Register(register) => registers[register as usize],
            Operand::Immediate(number) => {
                let value = f64::from(self.table[number as usize]);
                (value, value)
            }
        };
        let mut registers = vec![(0.0, 0.0); self.tape.registers];
        for Clause { instruction, output, operands } in &self.tape.clauses {
            let [a, b] = operands.map(|operand| value(&registers, operand));
            registers[*output as usize] = match *instruction {
                Instruction::Input(place) => p.get(usize::from(place)).copied().unwrap_or((0.0, 0.0)),
                Instruction::Operator(op) => operate(op.name(), a, b, self.frame),
                Instruction::Texture { .. } => continue,
            };
        }
        value(&registers, self.tape.outputs[0])
    }

    /// The interval of the formula's values along a part of a ray, minus `margin` times the distance from the ray's
    /// start.
    fn along(&self, ray: &Ray, part: Span, margin: f64) -> Span {
        let place = |axis: usize| {
            let ends =
                [part.0, part.1].map(|t| f64::from(ray.origin[axis]) + t * f64::from(ray.direction[axis]));
            out((ends[0].min(ends[1]), ends[0].max(ends[1])))
        };
        let (lo, hi) = self.over([place(0), place(1), place(2)]);
        let margin = (margin * part.0, margin * part.1);
        (lo - margin.0.max(margin.1), hi - margin.0.min(margin.1))
    }

    /// Decides if the ray hits a surface. `Some(false)` proves a miss. `Some(true)` proves a hit: the values are
    /// negative on at least half of a pixel. `None` means that the result depends on less than a pixel, or would take
    /// too much work. `margin` is subtracted per unit of distance, for a pixel's cone.
    fn decides(&self, ray: &Ray, span: Span, margin: f64) -> Option<bool> {
        let mut parts = vec![span];
        let (mut sure, mut work) = (true, 0);
        while let Some(part) = parts.pop() {
            work += 1;
            if work > 4_000 {
                return None;
            }
            let (lo, hi) = self.along(ray, part, margin);
            if lo > 0.0 {
                continue;
            }
            let pixel = SPREAD * part.0.max(0.1);
            let length = part.1 - part.0;
            if hi < 0.0 && length >= 0.5 * pixel {
                return Some(true);
            }
            if length < pixel {
                sure = false;
                continue;
            }
            let middle = 0.5 * (part.0 + part.1);
            // The nearer half is pushed last, so it is processed first.
            parts.push((middle, part.1));
            parts.push((part.0, middle));
        }
        sure.then_some(false)
    }
}

// --- tracing as the shaders do it -----------------------------------------------------------------------------------

struct Ray {
    origin: [f32; 3],
    direction: [f32; 3],
}

impl Ray {
    fn at(&self, t: f32) -> [f32; 3] {
        [0, 1, 2].map(|axis| self.origin[axis] + t * self.direction[axis])
    }

    /// The distance at which the ray leaves a cell, slightly behind the cell's face.
    fn exit_of(&self, cell: &Cell) -> f32 {
        let exits = (0..3).map(|axis| {
            let face = if self.direction[axis] >= 0.0 { cell.high[axis] } else { cell.low[axis] };
            (face - self.origin[axis]) / (self.direction[axis] + 1e-12_f32.copysign(self.direction[axis]))
        });
        let t = exits.fold(f32::INFINITY, f32::min);
        rays::past(t)
    }
}

/// Traces a ray. Returns true if the ray hits a surface, and `None` if it reaches the step cap.
fn traced(regions: &Regions, world: &World, inputs: &FrameInputs, ray: &Ray, span: Span) -> Option<bool> {
    let (mut t, end) = (span.0 as f32, span.1 as f32);
    let steps = if world.non_lipschitz { rays::NON_LIPSCHITZ_STEPS_MAX } else { rays::STEPS_MAX };
    for step in 0..steps {
        let radius = SPREAD as f32 * t;
        let reach = if world.non_lipschitz { 0.0 } else { rays::hit_fraction(step) * radius };
        while let Some(cell) = regions.cell_at(ray.at(t)).filter(|cell| cell.bound > reach) {
            let bound = if world.non_lipschitz { 0.0 } else { cell.bound };
            t = (t + bound).max(ray.exit_of(&cell)).max(rays::past(t));
            if t >= end {
                return Some(false);
            }
        }
        if t >= end {
            return Some(false);
        }
        let value = regions.distance(ray.at(t), 0.0, inputs)[0];
        let outside = value > reach;
        if !outside {
            return Some(true);
        }
        t += match regions.cell_at(ray.at(t)) {
            Some(cell) if world.non_lipschitz => {
                let slope = gradient::slope_towards(cell.slopes, ray.direction);
                let radius = SPREAD as f32 * t.max(rays::NON_LIPSCHITZ_NEAR);
                rays::non_lipschitz_step(step, value, slope, ray.exit_of(&cell) - t, t..end, radius).max(1e-5)
            }
            _ => value,
        };
        if t >= end {
            return Some(false);
        }
    }
    None
}

fn inputs_of(world: &World, time: f32) -> FrameInputs {
    let mut inputs = FrameInputs {
        time,
        sound: SoundInputs::with(&[
            (SoundInput::VolumeLeft, 0.2),
            (SoundInput::VolumeRight, 0.3),
            (SoundInput::Bass, 0.4),
            (SoundInput::Mid, 0.3),
            (SoundInput::Treble, 0.2),
            (SoundInput::Beat, 0.5),
            (SoundInput::Tempo, 120.0),
            (SoundInput::Phase, 0.25),
        ]),
        levels: Levels::each(|_, number| 0.4 + 0.4 * (number as f32 + time).sin()),
        params: world.scene.params.iter().map(|param| param.default).collect(),
        shapes: world.scene.atlas.clone(),
        ..Default::default()
    };
    inputs.eye = world.frame_tape.values(&inputs).camera.position;
    inputs.hoisted = world.hoisted.values(&inputs);
    inputs
}

/// Returns the ray, and the part of the ray that may contain surfaces.
fn ray_of(
    world: &World,
    regions: &Regions,
    inputs: &FrameInputs,
    random: &mut Random,
) -> Option<(Ray, Span)> {
    let eye = world.frame_tape.values(inputs).camera.position;
    // Aim from the eye at a random point in the middle of the tree, as rays of pixels do.
    let box_of = world.bounds.map_or((regions.low, regions.size), |bounds| {
        (bounds.low, [0, 1, 2].map(|axis| bounds.high[axis] - bounds.low[axis]))
    });
    let aim = [0, 1, 2].map(|axis| box_of.0[axis] + box_of.1[axis] * random.between(0.2, 0.8));
    let way = [0, 1, 2].map(|axis| aim[axis] - eye[axis]);
    let length = way.iter().map(|v| v * v).sum::<f32>().sqrt();
    let ray = Ray { origin: eye, direction: way.map(|v| v / length) };
    let (mut start, mut end) = (0.01_f32, 200.0_f32);
    for axis in 0..3 {
        let faces = [regions.low[axis] + 1e-3, regions.low[axis] + regions.size[axis] - 1e-3];
        let two = faces.map(|face| (face - ray.origin[axis]) / ray.direction[axis]);
        start = start.max(two[0].min(two[1]));
        end = end.min(two[0].max(two[1]));
    }
    (start < end).then_some((ray, (f64::from(start), f64::from(end))))
}

fn rays_wanted() -> usize {
    std::env::var("MARIANA_RAYS").ok().and_then(|count| count.parse().ok()).unwrap_or(100)
}

/// Fails if a traced ray hits a surface that does not exist, or misses a surface. Returns the number of rays that the
/// oracle decided, and the number of rays that reached the step cap.
fn check_rays(name: &str, world: &World, rays: usize) -> (usize, usize) {
    let tape = Tape::new(&world.graph, &world.roots.distance[..1]);
    let plan = RegionPlan::new(world);
    let mut random = Random(11);
    // Each time needs a region tree, so a test with few rays uses a single time.
    let moments = if rays < 1_000 { 1 } else { 4 };
    let (mut hits, mut misses, mut open, mut capped) = (0, 0, 0, 0);
    for moment in 0..moments {
        let inputs = inputs_of(world, 3.0 + 17.0 * moment as f32);
        let center = world.frame_tape.values(&inputs).camera.position;
        let eye = world.bounds.is_some_and(|bounds| bounds.hold(center)).then_some(center);
        let regions = plan.build(&inputs, &RegionOptions { cells: true, texels_max: 1 << 22, center, eye });
        let oracle = Oracle { tape: &tape, table: tape.table_values(&inputs), frame: &inputs };
        for _ in 0..rays / moments {
            let Some((ray, span)) = ray_of(world, &regions, &inputs, &mut random) else { continue };
            let Some(found) = traced(&regions, world, &inputs, &ray, span) else {
                capped += 1;
                continue;
            };
            // In a distance field, a hit counts within a pixel's cone. In a non-Lipschitz field only the sign counts.
            let pixels = if world.non_lipschitz { 0.0 } else { 4.0 * SPREAD };
            let wrong = if found {
                oracle.decides(&ray, span, pixels) == Some(false)
            } else {
                oracle.decides(&ray, span, if world.non_lipschitz { 0.0 } else { -SPREAD }) == Some(true)
            };
            assert!(
                !wrong,
                "{name}: traced {found}, which is wrong from {:?} to {:?} in {span:?}",
                ray.origin, ray.direction
            );
            match oracle.decides(&ray, span, 0.0) {
                Some(true) => hits += 1,
                Some(false) => misses += 1,
                None => open += 1,
            }
        }
    }
    println!("{name}: {hits} proven hits, {misses} proven misses, {open} undecided, {capped} capped");
    (hits + misses, capped)
}

/// Fails unless rays through the scene hit and miss as the oracle proves.
fn check_scene(name: &str, source: &SceneSource) {
    let compiled = source.compile().unwrap();
    let world = World::new(name, compiled.scene.unwrap(), Vec::new()).unwrap();
    // Planes are solved exactly.
    if !world.has_rest {
        return;
    }
    let rays = rays_wanted();
    let (decided, capped) = check_rays(name, &world, rays);
    // If space repeats, long parts of a ray have wide intervals, so the oracle decides fewer rays.
    let least = if REPEATING.contains(&name) { rays / 4 } else { rays / 2 };
    assert!(decided > least, "{name}: {decided}");
    let most = if matches!(source, SceneSource::Shipped(_)) { rays / 20 } else { 0 };
    assert!(capped <= most, "{name}: {capped} rays reached the step cap");
}

/// Like [`check_scene`], for a shipped scene.
pub(super) fn check_hits(name: &str) {
    check_scene(name, &SceneSource::Shipped(name.to_owned()));
}

#[test]
fn hits_and_misses_match_the_oracle() {
    for (name, text) in OF_MODELLERS {
        check_scene(name, &SceneSource::Formula(text.to_owned()));
    }
}

#[test]
fn hits_and_misses_in_blends_match_the_oracle() {
    let world = |name: &str| {
        let compiled = SceneSource::Shipped(name.to_owned()).compile().unwrap();
        World::new(name, compiled.scene.unwrap(), Vec::new()).unwrap()
    };
    for Pair { from, to, kind, fraction } in Pair::drawn(8) {
        let (from, to) = (world(&from), world(&to));
        let camera = |world: &World| world.frame_tape.values(&inputs_of(world, 3.0)).camera;
        let alignment = Alignment::of(&camera(&from), &camera(&to));
        let world = World::blend(&from, &to, kind, &alignment, fraction).unwrap();
        check_rays(&format!("{} at {fraction}", world.name), &world, 40);
    }
}
