//! Traces formulas that are not distances with the gradient's bounds in each cell, as shaders/non_lipschitz.glsl does.
//! Every hit that marching in small steps finds must be found.

use std::collections::HashMap;

use super::testing::GradientIntervals;
use super::{Batch, PointEvaluator, Points, Tape};
use crate::graph::{FrameInputs, Interval, Point};
use crate::lang::{compile, no_includes};
use crate::rays::{
    AHEAD, AHEAD_OF_FAR, CLOSE_ENOUGH, CLOSINGS_MAX, NON_LIPSCHITZ_NEAR, NON_LIPSCHITZ_STEPS_MAX, PAST_FACE,
    ROOT_SIDE, non_lipschitz_step, past,
};

/// Growth of a pixel's cone in an image with 360 rows and a field of view of 40 degrees.
const SPREAD: f32 = 0.002;
/// Cells along each side of the root and of the levels below it.
const SIDES: [usize; 3] = [16, 4, 4];

/// For each formula: its name and text, half the side of the cube of cells, and the distance of the rays' starts.
const FORMULAS: [(&str, &str, f32, f32); 7] = [
    ("gyroid", "sin(x)*cos(y)+sin(y)*cos(z)+sin(z)*cos(x)", 12.0, 0.3),
    ("shell", "abs(sin(x)*cos(y)+sin(y)*cos(z)+sin(z)*cos(x)) - 0.1", 12.0, 0.3),
    ("quadric", "max(x^2+y^2-z^2-1, abs(z)-3)", 4.0, 8.0),
    ("heart", "(x^2+9/4*z^2+y^2-1)^3-x^2*y^3-9/80*z^2*y^3", 1.6, 4.0),
    (
        "barth",
        "max(4*(2.618034*x^2-y^2)*(2.618034*y^2-z^2)*(2.618034*z^2-x^2)-4.236068*(x^2+y^2+z^2-1)^2, length(p)-1.9)",
        2.0,
        5.0,
    ),
    ("terrain", "y + 2 - 2.5*noise_2d(0.5*p.xz) - 0.6*noise_2d(1.7*p.xz)", 16.0, 3.0),
    ("lattice", "cos(x)+cos(y)+cos(z)+0.4", 12.0, 0.3),
];

struct Random(u64);

impl Random {
    fn between(&mut self, low: f32, high: f32) -> f32 {
        // SplitMix64 (Steele 2014).
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (self.0 ^ self.0 >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        low + (high - low) * ((mixed ^ mixed >> 31) >> 40) as f32 / (1u32 << 24) as f32
    }
}

fn tape_of(formula: &str) -> Tape {
    let scene = compile("test", formula, &mut no_includes).scene.unwrap();
    Tape::new(&scene.graph, &[scene.distance])
}

#[derive(Debug, Clone, Copy)]
struct Cell {
    bound: f32,
    gradient: [Interval; 3],
    low: [f32; 3],
    side: f32,
}

/// The cells of a cube. They are divided where a surface may be, and computed when a ray first needs them.
struct Cells<'a> {
    bounds: GradientIntervals<'a>,
    half: f32,
    known: HashMap<(usize, [i32; 3]), Cell>,
}

impl Cells<'_> {
    fn at(&mut self, p: [f32; 3]) -> Option<Cell> {
        if p.iter().any(|v| v.abs() >= self.half || v.is_nan()) {
            return None;
        }
        let mut side = 2.0 * self.half;
        let mut found = None;
        for (level, cells) in SIDES.into_iter().enumerate() {
            side /= cells as f32;
            let place = p.map(|v| ((v + self.half) / side).floor() as i32);
            let cell = *self.known.entry((level, place)).or_insert_with(|| {
                let low = place.map(|place| place as f32 * side - self.half);
                // Enlarge the cell, because rounding may place a point outside of its cell.
                let sides = low.map(|low| Interval::new(low - 1e-5, low + side + 1e-5));
                let gradient_interval = self.bounds.over(sides, [Interval::point(0.0); 3])[0];
                Cell {
                    bound: gradient_interval.value.lo.max(0.0),
                    gradient: gradient_interval.gradient,
                    low,
                    side,
                }
            });
            found = Some(cell);
            if cell.bound > 0.0 {
                break;
            }
        }
        found
    }
}

fn exit_of(cell: &Cell, origin: [f32; 3], direction: [f32; 3]) -> f32 {
    let exits = (0..3).map(|axis| {
        let face = cell.low[axis] + if direction[axis] >= 0.0 { cell.side } else { 0.0 };
        (face - origin[axis]) / (direction[axis] + 1e-12_f32.copysign(direction[axis]))
    });
    exits.fold(f32::INFINITY, f32::min)
}

fn slope_towards(gradient: [Interval; 3], direction: [f32; 3]) -> f32 {
    (0..3).map(|axis| (-gradient[axis].lo * direction[axis]).max(-gradient[axis].hi * direction[axis])).sum()
}

#[derive(Debug, Default)]
struct Traced {
    hit: Option<f32>,
    evaluations: usize,
    steps: u32,
    capped: bool,
}

fn trace(
    cells: &mut Cells<'_>,
    points: &mut PointEvaluator<'_>,
    origin: [f32; 3],
    direction: [f32; 3],
    (start, end): (f32, f32),
) -> Traced {
    let mut traced = Traced::default();
    let at = |t: f32| [0, 1, 2].map(|axis| origin[axis] + t * direction[axis]);
    let mut t = start;
    // The interval in which the sign changes: a value above 0 at its start, and not at its end.
    let (mut before, mut above) = (start, f32::NAN);
    let mut behind: Option<(f32, f32)> = None;
    let mut closings = 0;
    let root = 2.0 * cells.half / ROOT_SIDE;
    let farthest = origin.iter().fold(0.0_f32, |most, v| most.max(((v + cells.half) / root).abs()));
    let ahead = root * (AHEAD + AHEAD_OF_FAR * farthest);
    while (traced.evaluations as u32) < NON_LIPSCHITZ_STEPS_MAX {
        traced.steps += 1;
        let looked_at: [f32; 3] = std::array::from_fn(|axis| at(t)[axis] + ahead.copysign(direction[axis]));
        let Some(cell) = cells.at(looked_at) else { return traced };
        if behind.is_none() && cell.bound > 0.0 {
            (before, above) = (t, f32::NAN);
            t = past(exit_of(&cell, origin, direction)).max(t + PAST_FACE);
            continue;
        }
        let [x, y, z] = at(t);
        let value = points.at(&Point::at(x, y, z))[0];
        traced.evaluations += 1;
        let cone = SPREAD * t;
        if value > 0.0 {
            (before, above) = (t, value);
        } else {
            behind = Some((t, value));
        }
        if let Some((far, below)) = behind {
            if above.is_nan() || closings == CLOSINGS_MAX || far - before < CLOSE_ENOUGH * cone {
                traced.hit = Some(far);
                return traced;
            }
            closings += 1;
            // Use the secant's zero, but keep away from both ends, so that both ends move inwards.
            let fraction = (above / (above - below)).clamp(0.1, 0.9);
            t = before + fraction * (far - before);
            continue;
        }
        let slope = slope_towards(cell.gradient, direction);
        let leaves = past(exit_of(&cell, origin, direction)) - t;
        let radius = SPREAD * t.max(NON_LIPSCHITZ_NEAR);
        t += non_lipschitz_step(traced.evaluations as u32, value, slope, leaves, t..end, radius).max(1e-5);
    }
    traced.capped = true;
    traced
}

/// Finds, by small steps, the first point from which the value stays below 0 over a length of `thick`.
fn march(
    batch: &mut Batch<'_>,
    origin: [f32; 3],
    direction: [f32; 3],
    span: (f32, f32),
    count: usize,
) -> Option<(f32, f32)> {
    let step = (span.1 - span.0) / count as f32;
    let way: Vec<f32> = (0..count).map(|i| span.0 + step * i as f32).collect();
    let line = |axis: usize| way.iter().map(|t| origin[axis] + t * direction[axis]).collect::<Vec<f32>>();
    let (x, y, z) = (line(0), line(1), line(2));
    let values = &batch.run(Points { position: [&x, &y, &z], normal: None })[0];
    let first = values.iter().position(|value| *value < 0.0)?;
    let run = values[first..].iter().take_while(|value| **value < 0.0).count();
    Some((way[first], run as f32 * step))
}

fn rays() -> usize {
    std::env::var("MARIANA_RAYS").ok().and_then(|count| count.parse().ok()).unwrap_or(250)
}

#[test]
fn no_hit_is_missed() {
    let frame = FrameInputs::default();
    for (name, formula, half, away) in FORMULAS {
        let tape = tape_of(formula);
        let mut cells = Cells { bounds: GradientIntervals::new(&tape, &frame), half, known: HashMap::new() };
        let mut points = PointEvaluator::new(&tape, &frame);
        let mut batch = Batch::new(&tape, &frame);
        let mut random = Random(7);
        let (mut hits, mut evaluations, mut steps, mut capped, mut worst) = (0, 0, 0, 0, 0);
        let mut traced_rays = 0;
        while traced_rays < rays() {
            let mut direction = [0, 1, 2].map(|_| random.between(-1.0, 1.0));
            let length = direction.iter().map(|v| v * v).sum::<f32>().sqrt();
            if !(0.1..=1.0).contains(&length) {
                continue;
            }
            direction = direction.map(|v| v / length);
            let aim = [0, 1, 2].map(|_| random.between(-0.35, 0.35) * half.min(4.0));
            let origin = [0, 1, 2].map(|axis| aim[axis] - direction[axis] * away);
            let [x, y, z] = origin;
            if points.at(&Point::at(x, y, z))[0] <= 0.05 {
                continue;
            }
            traced_rays += 1;
            let (mut start, mut end) = (0.0_f32, f32::INFINITY);
            for axis in 0..3 {
                let two = [-half, half].map(|face| (face - origin[axis]) / direction[axis]);
                start = start.max(two[0].min(two[1]));
                end = end.min(two[0].max(two[1]));
            }
            let start = start + 1e-4;
            if end - start < 1e-3 {
                continue;
            }
            let traced = trace(&mut cells, &mut points, origin, direction, (start, end));
            evaluations += traced.evaluations;
            worst = worst.max(traced.evaluations);
            steps += traced.steps;
            capped += usize::from(traced.capped);
            hits += usize::from(traced.hit.is_some());
            let marched = march(&mut batch, origin, direction, (start, end - 1e-4), 3_000);
            match (marched, traced.hit) {
                (Some((found, thick)), hit) if thick > SPREAD * found && found > start => {
                    let hit = hit.unwrap_or(f32::INFINITY);
                    let slack = (end - start) / 3_000.0 + SPREAD * found;
                    assert!(
                        hit <= found + slack,
                        "{name}: {hit} instead of {found}, {thick} thick, from {origin:?} to {direction:?}: {traced:?}"
                    );
                }
                _ => {}
            }
            if let Some(hit) = traced.hit {
                let at = [0, 1, 2].map(|axis| origin[axis] + hit * direction[axis]);
                let value = points.at(&Point::at(at[0], at[1], at[2]))[0];
                assert!(value <= 0.0, "{name}: a hit where the value is {value}");
            }
        }
        let per = |count: usize| count as f32 / traced_rays as f32;
        println!(
            "{name}: {} rays, {hits} hits, {:.1} evaluations a ray, at most {worst}, {:.1} steps, {capped} capped, {} cells",
            traced_rays,
            per(evaluations),
            per(steps as usize),
            cells.known.len()
        );
        assert!(capped * 100 <= traced_rays, "{name}: {capped} of {traced_rays} rays used up their steps");
        assert!(hits > 20, "{name}: {hits} hits");
    }
}
