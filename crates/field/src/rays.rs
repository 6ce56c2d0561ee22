//! Constants of ray tracing, shared by the shaders (as defines) and by tests that trace the same rays on the CPU.

use std::ops::Range;

macro_rules! rays {
    ($($(#[doc = $doc:literal])+ $name:ident: $kind:ty = $value:literal;)+) => {
        $($(#[doc = $doc])+ pub const $name: $kind = $value;)+

        /// Returns the constants as `NAME value`, for defines in GLSL.
        pub fn defines() -> impl Iterator<Item = String> {
            let vector = |[x, y, z, w]: [f32; 4]| format!("vec4({x:?}, {y:?}, {z:?}, {w:?})");
            let probes = [
                format!("PROBE_FRACTIONS {}", vector(PROBE_FRACTIONS)),
                format!("PROBE_WEIGHTS {}", vector(PROBE_WEIGHTS)),
            ];
            [$(format!(concat!(stringify!($name), " {:?}"), $name)),+].into_iter().chain(probes)
        }
    };
}

rays! {
    /// Maximum number of evaluations along a ray through a distance field.
    STEPS_MAX: u32 = 128;
    /// A ray hits when the distance is below this fraction of the pixel cone's radius.
    HIT_FRACTION: f32 = 0.25;
    /// Growth of the hit fraction per step beyond [`STEPS_MANY`], so that a ray that creeps along a surface hits it.
    HIT_FRACTION_GROWTH: f32 = 0.03;
    /// Number of steps after which the hit fraction grows.
    STEPS_MANY: u32 = 32;
    /// Length of rays in a scene without bounds.
    FAR: f32 = 1000.0;
    /// Maximum number of evaluations along a ray through a formula that is not a distance field.
    NON_LIPSCHITZ_STEPS_MAX: u32 = 512;
    /// After this many evaluations, [`non_lipschitz_step`] makes steps long enough to reach the ray's end.
    NON_LIPSCHITZ_STEPS_MANY: u32 = 64;
    /// Nearer to the eye than this, pixel cones keep their radius at this distance. With thinner cones, a ray would
    /// take so many small steps near the eye that it would run out of evaluations.
    NON_LIPSCHITZ_NEAR: f32 = 0.1;
    /// Maximum number of rounds that narrow down the point where a formula changes its sign.
    CLOSINGS_MAX: u32 = 6;
    /// The smallest step in [`non_lipschitz_step`], as a fraction of the pixel cone's radius: thinner details are
    /// invisible.
    NON_LIPSCHITZ_STEP_MIN: f32 = 0.5;
    /// Growth of [`NON_LIPSCHITZ_STEP_MIN`] with each step, so that a ray that grazes a surface reaches its end.
    NON_LIPSCHITZ_STEP_GROWTH: f32 = 0.04;
    /// Precision with which a change of sign is located, as a fraction of the pixel cone's radius.
    CLOSE_ENOUGH: f32 = 0.05;
    /// Number of cells along each axis of the tree's root.
    ROOT_SIDE: f32 = 16.0;
    /// Maximum number of texels that are read to find a cell: one in the root, one in a brick, one in a brick of a brick.
    REGION_LEVELS: u32 = 3;
    /// The object number of a cell that holds several objects.
    SEVERAL: u32 = 255;
    /// Maximum number of cells that a ray passes through without an evaluation.
    SKIPS_MAX: u32 = 1024;
    /// [`past`] moves a point on a ray by this length, plus this fraction of the distance travelled.
    PAST_FACE: f32 = 4e-7;
    /// Rays look up their cell this far ahead, in units of root cells, so that no ray gets stuck at a cell's face.
    AHEAD: f32 = 1e-5;
    /// Shortest step of a shadow ray.
    SHADOW_STEP_MIN: f32 = 0.03;
    /// Longest step of a shadow ray through a penumbra. Longer steps would be visible there. Far from surfaces, a step may
    /// be half the distance; outside of the penumbra, it reaches up to the penumbra.
    SHADOW_STEP_MAX: f32 = 0.6;
    /// Start of a shadow ray. It is not 0, so that the ray does not hit the surface that it leaves.
    SHADOW_START: f32 = 0.02;
    /// Minimum sharpness of a penumbra: a light's distance divided by its radius.
    SHARPNESS_MIN: f32 = 2.0;
    /// Maximum sharpness of a penumbra.
    SHARPNESS_MAX: f32 = 64.0;
    /// A penumbra that is larger than all others. With it, the distance leaves out objects of glass.
    WITHOUT_GLASS: f32 = 1e9;
    /// Media that are denser than this count as media of this density. They are opaque either way.
    DENSEST: f32 = 1e4;
    /// Length of shadow rays towards an infinitely distant light.
    SUN_DISTANCE: f32 = 1000.0;
    /// This fraction of the largest coordinate of the ray's start is added to [`AHEAD`].
    AHEAD_OF_FAR: f32 = 5e-7;
}

/// Heights of the probes of ambient occlusion, as fractions of its reach.
pub const PROBE_FRACTIONS: [f32; 4] = [0.0625, 0.25, 0.5625, 1.0];
/// Weights of the probes; only their proportions matter.
pub const PROBE_WEIGHTS: [f32; 4] = [1.0, 0.8, 0.64, 0.512];

/// Returns the fraction of the pixel cone's radius below which a distance is a hit. `step` starts at 0.
pub fn hit_fraction(step: u32) -> f32 {
    HIT_FRACTION + HIT_FRACTION_GROWTH * step.saturating_sub(STEPS_MANY) as f32
}

/// Returns the length of a ray's step at `t` through a formula that is not a distance field. The ray ends at `end`, and
/// has taken `step` steps. `value`, the formula's value at `t`, falls by at most `slope` per unit of length until the
/// ray leaves its cell at `t + leaves`. `radius` is the radius of the pixel's cone at `t`, or at [`NON_LIPSCHITZ_NEAR`]
/// if `t` is less.
///
/// No step passes a surface, unless the smallest step is longer than the distance to the surface. From
/// [`NON_LIPSCHITZ_STEPS_MANY`] steps on, the smallest step grows so that the remaining steps reach the end.
pub fn non_lipschitz_step(
    step: u32,
    value: f32,
    slope: f32,
    leaves: f32,
    along: Range<f32>,
    radius: f32,
) -> f32 {
    let (t, end) = (along.start, along.end);
    let left = NON_LIPSCHITZ_STEPS_MAX.saturating_sub(step).max(1);
    let from = t.max(NON_LIPSCHITZ_NEAR);
    let even = from * ((end / from).powf(1.0 / left as f32) - 1.0);
    let fine = (NON_LIPSCHITZ_STEP_MIN + NON_LIPSCHITZ_STEP_GROWTH * step as f32) * radius;
    let least = if step < NON_LIPSCHITZ_STEPS_MANY { fine } else { fine.max(even) };
    let safe = if slope > 0.0 { value / slope } else { FAR };
    safe.min(leaves).max(least)
}

/// Returns a point on the ray slightly beyond `t`.
pub fn past(t: f32) -> f32 {
    t * (1.0 + PAST_FACE) + PAST_FACE
}

#[cfg(test)]
mod tests {
    #[test]
    fn defines_are_glsl_literals() {
        let all: Vec<String> = super::defines().collect();
        for define in ["STEPS_MAX 128", "FAR 1000.0", "PAST_FACE 4e-7", "SEVERAL 255"] {
            assert!(all.iter().any(|one| one == define), "{define} is not in {all:?}");
        }
    }
}
