//! Checks if the value of a scene's formula is a distance in practice, by sampling its gradient when the scene is
//! loaded.
//!
//! If the formula's slope is above 1, steps by its value would miss surfaces. If the slope is far below 1 at surfaces,
//! the surfaces would look too thick. In both cases each cell of the tree holds bounds of the gradient
//! (`graph::GradientInterval`: forward accumulation in intervals, with a separate rule for lengths because a square
//! root's slope is unbounded at 0). With these bounds a ray can choose steps that do not pass a surface. Boxes are cut
//! where parts of a formula jump, so that the bounds for noise are those of its smooth parts.

use crate::bounds::Bounds;
use crate::graph::{FrameInputs, Levels, ShapeAtlas, TableData, cell_hash};
use crate::graph::{SoundInput, SoundInputs};
use crate::lang::Param;
use crate::tape::{Dual, GradientBatch, Tape};
use crate::vectors::length;

/// Largest slope of a distance: 1 and an allowance for rounding.
pub(super) const STEEPEST: f32 = 1.01;
/// Up to this fraction of the samples may be steeper. Such samples are at seams of blends, which rays hardly ever meet.
const NON_LIPSCHITZ_FRACTION: f32 = 0.01;
/// Allowance for slopes between the samples: they may be steeper by this factor.
const STEEPEST_ROOM: f32 = 2.0;
/// With fewer samples than this, the steepest slope counts as infinite.
const STEEPEST_SAMPLES_MIN: usize = 64;
/// A value is not a distance if its slope is below this at half of the sampled surface: steps by the value would be far
/// too short, and the points that count as a hit would form a thick layer around the surface.
const FLATTEST: f32 = 0.2;
/// Ratio of successive scales for normalizing a value, and the number of scales: up to 1 / [`FLATTEST`].
const SCALE_STEP: f32 = 1.1;
const SCALES: i32 = 18;
/// The largest power with which a scale grows with the distance from the middle of the bounds.
const POWER_MAX: i32 = 4;
/// Reaches to try, as fractions of the largest reach. An infinite reach leaves the value unchanged.
const REACHES: [f32; 5] = [f32::INFINITY, 1.0, 0.5, 0.25, 0.125];
/// A stronger normalization is used only if it makes the value steeper at surfaces by this factor.
const WORTH: f32 = 1.2;
/// Distances from the camera's target at which the samples of a scene without bounds start, alternately. Samples spread
/// over an infinite scene would hardly meet small objects.
const AROUND: [f32; 4] = [30.0, 10.0, 3.0, 1.0];
/// Number of sampled frames: silence at the start, then random frames.
const FRAMES: usize = 4;
/// Number of entries and rows of random tables: fewer than in music, where neighbouring entries differ less.
const COLUMNS: usize = 106;
const ROWS: usize = 6;
/// Maximum number of points at which a frame's samples start.
const POINTS_MAX: usize = 1024;
const POINTS_MIN: usize = 8;
/// Number of steps from a point towards the surface.
const STEPS: usize = 4;
/// Maximum number of clauses that are evaluated with their gradients: a few ms.
const CLAUSES_MAX: usize = 1 << 18;

/// Samples whose slopes are compared before the count of the steep ones is checked.
const SAMPLES_AT_ONCE: usize = 128;

#[derive(Debug, Clone, Copy)]
struct Sample {
    place: [f32; 3],
    value: f32,
    gradient: [f32; 3],
}

#[derive(Debug, Clone, Default)]
struct Samples {
    outside: Vec<Sample>,
    surface: Vec<Sample>,
}

/// Parameters that turn a value into a value similar to a distance. Zeros stay zeros.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct NormalizedValue {
    pub(super) scale: f32,
    /// The value is divided by this, because polynomials grow steeper away from the middle of the bounds.
    pub(super) growth: Growth,
    /// The unit of an arc tangent that flattens the value away from surfaces. May be infinite.
    pub(super) reach: f32,
    /// True if rays may step by the result, as with a distance.
    pub(super) is_distance: bool,
}

/// A growing divisor: (1 + |p - `middle`|² / `half`²) ^ `power`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Growth {
    pub(super) middle: [f32; 3],
    pub(super) half: f32,
    pub(super) power: i32,
}

impl Growth {
    const NONE: Self = Self { middle: [0.0; 3], half: 1.0, power: 0 };

    /// Returns the growths to try. No growth is tried for a scene without bounds, because it has no size.
    fn all(bounds: Option<&Bounds>) -> Vec<Self> {
        let Some(bounds) = bounds else { return vec![Self::NONE] };
        let (middle, half) = (bounds.middle(), bounds.half());
        (0..=POWER_MAX).map(|power| Self { middle, half, power }).collect()
    }

    fn divided(&self, sample: &Sample) -> (f32, f32) {
        let off = [0, 1, 2].map(|axis| (sample.place[axis] - self.middle[axis]) / self.half);
        let base = 1.0 + off.iter().map(|part| part * part).sum::<f32>();
        let grown = base.powi(self.power);
        let falls = 2.0 * self.power as f32 * sample.value / (base * self.half);
        let gradient = [0, 1, 2].map(|axis| sample.gradient[axis] - falls * off[axis]);
        (sample.value / grown, length(gradient) / grown)
    }
}

/// The slopes of a world's value (without planes). They matter only if that value is not a distance.
#[derive(Debug, Clone, Copy)]
pub struct Slopes {
    /// Approximately the steepest sampled slope; infinite if there are too few samples.
    pub steepest: f32,
    /// The factor that turns the value into a distance, if a constant factor is enough.
    pub distance_factor: Option<f32>,
    /// The normalization of the value.
    pub(super) tamed: Option<NormalizedValue>,
}

impl Default for Slopes {
    /// Returns the value for a world whose formula is a distance.
    fn default() -> Self {
        Self { steepest: f32::INFINITY, distance_factor: None, tamed: None }
    }
}

/// Normalizes the value of the tape's first output; `None` if the value is a distance. A distance has a slope of at
/// most 1 in nearly all samples, and not much less than 1 at surfaces. `frames` are the frames to sample, each with
/// some boxes; sampled points start in these boxes alternately. A normalized value grows without limit, or up to about
/// `reach` or a fraction of `reach`.
pub(super) fn tamed(
    tape: &Tape,
    frames: impl Iterator<Item = (Vec<Bounds>, FrameInputs)>,
    bounds: Option<&Bounds>,
    reach: f32,
) -> Option<Slopes> {
    let Samples { outside, surface } = samples(tape, frames);
    let slopes: Vec<f32> = outside.iter().map(|sample| length(sample.gradient)).collect();
    let flat = surface.iter().filter(|sample| length(sample.gradient) < FLATTEST).count();
    if !is_no_distance(&slopes, |slope| *slope) && 2 * flat <= surface.len() {
        return None;
    }
    let mut best: Option<(f32, NormalizedValue)> = None;
    let mut factor = None;
    let mut plain = NormalizedValue { scale: 1.0, growth: Growth::NONE, reach, is_distance: false };
    for growth in Growth::all(bounds) {
        let usual = median(surface.iter().map(|sample| growth.divided(sample).1)).unwrap_or(1.0);
        if growth.power == 0 {
            plain.scale = usual;
        }
        let divided: Vec<(f32, f32)> = outside.iter().map(|sample| growth.divided(sample)).collect();
        for reach in REACHES.map(|fraction| fraction * reach) {
            let scales = (0..SCALES).map(|step| usual * SCALE_STEP.powi(step));
            let gentle = scales.take_while(|scale| usual / scale > FLATTEST).find(|scale| {
                !is_no_distance(&divided, |(value, slope)| {
                    let off = value / scale / reach;
                    slope / scale / (1.0 + off * off)
                })
            });
            let Some(scale) = gentle else { continue };
            if growth.power == 0 && reach.is_infinite() {
                factor = Some(1.0 / scale);
            }
            let slope = usual / scale;
            if best.is_none_or(|(so_far, _)| slope > WORTH * so_far) {
                best = Some((slope, NormalizedValue { scale, growth, reach, is_distance: true }));
            }
        }
    }
    let tamed = Some(best.map_or(plain, |(_, tamed)| tamed));
    Some(Slopes { steepest: steepest(slopes), distance_factor: factor, tamed })
}

/// True if too many of the samples are steep. Stops counting as soon as this is known.
fn is_no_distance<T>(samples: &[T], slope: impl Fn(&T) -> f32) -> bool {
    let most = NON_LIPSCHITZ_FRACTION * samples.len() as f32;
    let mut steep = 0;
    samples.chunks(SAMPLES_AT_ONCE).any(|some| {
        steep += some.iter().map(|sample| u32::from(slope(sample) > STEEPEST)).sum::<u32>();
        steep as f32 > most
    })
}

/// Approximately the steepest of the samples' slopes. Ignores the steepest samples, which are at seams of blends, and
/// adds an allowance. Infinite if there are too few samples.
fn steepest(mut slopes: Vec<f32>) -> f32 {
    if slopes.len() < STEEPEST_SAMPLES_MIN {
        return f32::INFINITY;
    }
    slopes.sort_by(f32::total_cmp);
    let usual = slopes.len() - 1 - (NON_LIPSCHITZ_FRACTION * slopes.len() as f32) as usize;
    slopes.get(usual).map_or(f32::INFINITY, |slope| STEEPEST_ROOM * slope)
}

fn median(numbers: impl Iterator<Item = f32>) -> Option<f32> {
    let mut numbers: Vec<f32> = numbers.collect();
    numbers.sort_by(f32::total_cmp);
    numbers.get(numbers.len() / 2).copied()
}

pub(super) fn around(target: [f32; 3]) -> Vec<Bounds> {
    AROUND.map(|reach| Bounds::around(target, reach)).to_vec()
}

fn samples(tape: &Tape, frames: impl Iterator<Item = (Vec<Bounds>, FrameInputs)>) -> Samples {
    let mut found = Samples::default();
    let affordable = CLAUSES_MAX / (tape.clauses.len().max(1) * (STEPS + 1) * FRAMES);
    let count = affordable.clamp(POINTS_MIN, POINTS_MAX);
    let (mut places, mut duals) = (Vec::with_capacity(count), Vec::with_capacity(count));
    for (frame, (regions, inputs)) in frames.enumerate() {
        let mut gradients = GradientBatch::new(tape, &inputs);
        let points = regions.iter().cycle().take(count).enumerate();
        let mut points: Vec<(&Bounds, [f32; 3])> = points
            .map(|(number, region)| {
                let random = |axis: usize| cell_hash((number + frame * POINTS_MAX) as f32, axis as f32);
                (region, [0, 1, 2].map(|axis| region.low[axis] + random(axis) * region.side(axis)))
            })
            .collect();
        for step in 0..=STEPS {
            places.clear();
            places.extend(points.iter().map(|(_, at)| *at));
            gradients.run(&places, &mut duals);
            let mut duals = duals.iter();
            points.retain_mut(|(region, at)| {
                let next = duals.next().and_then(|dual| found.add(*at, dual, region, step == STEPS));
                *at = next.unwrap_or_default();
                next.is_some()
            });
        }
    }
    found
}

impl Samples {
    /// Adds a sample of a region, if its value has a slope. Returns the next place of Newton's method along the
    /// gradient, if this place is in the region.
    fn add(&mut self, place: [f32; 3], dual: &Dual, region: &Bounds, is_last: bool) -> Option<[f32; 3]> {
        let Dual { value, gradient } = *dual;
        let squared = gradient.iter().map(|part| part * part).sum::<f32>();
        let slope = squared.sqrt();
        if !value.is_finite() || !slope.is_finite() || slope == 0.0 {
            return None;
        }
        let sample = Sample { place, value, gradient };
        let away = value.abs() / slope;
        let size = region.size();
        if value >= 0.0 || away < 1e-2 * size {
            self.outside.push(sample);
        }
        if is_last && away < 1e-3 * size {
            self.surface.push(sample);
        }
        let next = [0, 1, 2].map(|axis| place[axis] - value * gradient[axis] / squared);
        region.hold(next).then_some(next)
    }
}

/// Returns the frames to sample: silence at the start, then random times, sounds and parameters.
pub(super) fn frames(params: &[Param], shapes: &ShapeAtlas) -> impl Iterator<Item = FrameInputs> {
    (0..FRAMES).map(|number| {
        let random = |what: usize| cell_hash(number as f32, 7919.0 + what as f32);
        if number == 0 {
            let params = params.iter().map(|param| param.default).collect();
            return FrameInputs { params, shapes: shapes.clone(), ..FrameInputs::default() };
        }
        let turned = params.iter().enumerate();
        let row = |from: usize, count: usize| (from..from + count).map(random).collect::<Vec<f32>>();
        FrameInputs {
            time: 200.0 * random(0),
            sound: SoundInputs::each(|input| tried(input, random(1 + input as usize))),
            levels: Levels::each(|list, number| {
                let (least, most) = list.range();
                least + (most - least) * random(128 + list.first() + number)
            }),
            params: turned.map(|(i, param)| param.min + (param.max - param.min) * random(64 + i)).collect(),
            spectrum: TableData::row(row(1_000, COLUMNS)),
            waveform: TableData::row(
                row(2_000, COLUMNS).iter().map(|value| 2.0 * value - 1.0).collect::<Vec<f32>>(),
            ),
            history: TableData::rows(row(3_000, ROWS * COLUMNS), COLUMNS),
            shapes: shapes.clone(),
            ..FrameInputs::default()
        }
    })
}

/// Returns a value of the sound: `fraction` times the largest value that music reaches.
fn tried(input: SoundInput, fraction: f32) -> f32 {
    match input {
        // Music is hardly louder than half a full-scale square wave.
        SoundInput::VolumeLeft | SoundInput::VolumeRight | SoundInput::VolumeMid | SoundInput::VolumeSide => {
            0.5 * fraction
        }
        SoundInput::Tempo => 60.0 + 120.0 * fraction,
        _ => input.range().0 + (input.range().1 - input.range().0) * fraction,
    }
}

#[cfg(test)]
mod tests {
    use crate::lang::SHAPES;
    use crate::world::testing::world_of;

    #[test]
    fn shapes_and_their_combinations_are_distances() {
        let two = "sphere(p, 1), box(p - vec3(1, 0.3, 0), 0.8)";
        let made = ["union", "intersect", "subtract"].map(|name| format!("{name}({two})"));
        let smooth = ["smooth_union", "smooth_intersect", "smooth_subtract", "chamfer_union", "morph"];
        let made = made.into_iter().chain(smooth.map(|name| format!("{name}({two}, 0.4)")));
        let moved = [
            "box(repeat(rotate_y(p, t), 4), 1)",
            "torus(polar_repeat(p, 5) - vec3(3, 0, 0), 0.7, 0.2)",
            "sphere(scale(p, 2), 1) * 2",
            "box(repeat_limited(p, vec3(3, 0, 3), 2), 1)",
            "box(twist(p, 0.5), vec3(0.5, 2, 0.5)) / 1.4",
            "box(elongate(p, vec3(1, 0, 0)), 0.5)",
            "displace(sphere(p, 1), 0.1*noise(4*p), 1.04)",
            "displace(sphere(p, 1), 0.1*sin(10*x)*sin(10*y)*sin(10*z), 1.73)",
            "0.5*(length(p) - 1)",
        ];
        let shapes = SHAPES.iter().map(|(call, _)| (*call).to_owned());
        for text in shapes.chain(made).chain(moved.map(str::to_owned)) {
            assert!(!world_of(&text).non_lipschitz, "{text}");
        }
    }

    #[test]
    fn the_first_shipped_scenes_are_distances() {
        for text in [
            crate::world::testing::SPEAKERS,
            include_str!("../../../../assets/scenes/metaballs.scene"),
            include_str!("../../../../assets/scenes/first_steps.scene"),
        ] {
            assert!(!world_of(text).non_lipschitz, "{text}");
        }
    }

    #[test]
    fn a_factor_turns_evenly_steep_values_into_distances() {
        for (text, least, most) in [("3*(length(p)-1)", 0.28, 0.34), ("y-0.5*sin(x)", 0.8, 0.95)] {
            let factor = world_of(text).slopes.distance_factor.unwrap();
            assert!((least..most).contains(&factor), "{text}: {factor}");
            assert!(!world_of(&format!("{factor} * ({text})")).non_lipschitz, "{text} times {factor}");
        }
        assert_eq!(world_of("length(p)-1").slopes.distance_factor, None);
    }

    #[test]
    fn other_formulas_are_not() {
        for text in [
            "x^2+y^2-z^2-1",
            "x^2+y^2+z^2-1",
            "sin(x)*cos(y)+sin(y)*cos(z)+sin(z)*cos(x)",
            "abs(sin(x)*cos(y)+sin(y)*cos(z)+sin(z)*cos(x)) - 0.1",
            "(x^2+9/4*z^2+y^2-1)^3-x^2*y^3-9/80*z^2*y^3",
            "4*(2.618034*x^2-y^2)*(2.618034*y^2-z^2)*(2.618034*z^2-x^2)-4.236068*(x^2+y^2+z^2-1)^2",
            "y-2*noise_2d(p.xz)",
            "y-0.5*sin(x)",
            "0.02*(length(p)-1)",
            "3*(length(p)-1)",
            // A small object beside an infinite one. Far from both, the value is constant.
            "min(length(p.xy - vec2(0, 15)) - 0.2, -log(exp(-60*(length(p)-0.3)) + exp(-60*(length(p.xz)-0.2+abs(y))))/30)",
        ] {
            assert!(world_of(text).non_lipschitz, "{text}");
        }
    }

    #[test]
    fn only_shapes_that_the_scene_does_not_trust_are_checked() {
        let steep = |name: &str, trust: &str| {
            format!("object {name} {{ shape = 5 * (length(p - vec3(0, 0, 4)) - 1){trust} }}\n")
        };
        assert!(world_of(&steep("a", "")).non_lipschitz);
        assert!(!world_of(&steep("a", "  trust = 1")).non_lipschitz);
        let both = steep("a", "  trust = 1") + &steep("b", "").replace("- vec3", "+ vec3");
        assert!(world_of(&both).non_lipschitz, "the other object is steep");
        let both = steep("a", "  trust = 1") + "object b { shape = sphere(p, 1) }";
        assert!(!world_of(&both).non_lipschitz);
    }
}
