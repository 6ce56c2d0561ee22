//! The numbers with which the shaders trace rays and with which tests follow those rays on the CPU. They are defined
//! here once, and shaders get them as defines, so that a test always judges the tracer that is shipped.

macro_rules! rays {
    ($($(#[doc = $doc:literal])+ $name:ident: $kind:ty = $value:literal;)+) => {
        $($(#[doc = $doc])+ pub const $name: $kind = $value;)+

        /// Each number as `NAME value` in GLSL.
        pub fn defines() -> impl Iterator<Item = String> {
            [$(format!(concat!(stringify!($name), " {:?}"), $name)),+].into_iter()
        }
    };
}

rays! {
    /// Most evaluations along a ray through a distance field.
    STEPS_MAX: u32 = 128;
    /// Share of a pixel's cone that counts as the surface.
    HIT_FRACTION: f32 = 0.25;
    /// How much that share grows with each step beyond [`STEPS_MANY`], so that a ray that creeps along a surface ends
    /// there.
    HIT_FRACTION_GROWTH: f32 = 0.03;
    /// From this number of steps on, the share grows.
    STEPS_MANY: u32 = 32;
    /// How far rays go where a scene has no bounds.
    FAR: f32 = 1000.0;
    /// Most evaluations along a ray through a formula that is not a distance field, grazing rays included.
    NON_LIPSCHITZ_STEPS_MAX: u32 = 512;
    /// Evaluations after which such a ray takes steps long enough to reach its end with those that are left.
    NON_LIPSCHITZ_STEPS_MANY: u32 = 64;
    /// Pixels' cones count as at least as wide as at this distance from the eye: smaller steps would use up a ray
    /// before it has left the lens.
    NON_LIPSCHITZ_NEAR: f32 = 0.1;
    /// Rounds that close in on the place where the sign of such a formula changes.
    CLOSINGS_MAX: u32 = 6;
    /// The smallest step through such a formula, as a share of the radius of the pixel's cone: nothing visible is
    /// thinner. See [`non_lipschitz_step`].
    NON_LIPSCHITZ_STEP_MIN: f32 = 0.5;
    /// How much the smallest step grows with each step, so that a ray that grazes a surface ends.
    NON_LIPSCHITZ_STEP_GROWTH: f32 = 0.04;
    /// The place of a change of sign is known well enough within this share of the same radius.
    CLOSE_ENOUGH: f32 = 0.05;
    /// Cells of the tree's root along each axis.
    ROOT_SIDE: f32 = 16.0;
    /// Texels that are read to find a cell: one in the root, one in a brick.
    REGION_LEVELS: u32 = 2;
    /// The number that replaces that of the nearest object where a cell holds several.
    SEVERAL: u32 = 255;
    /// The most cells that a ray passes through without an evaluation.
    SKIPS_MAX: u32 = 1024;
    /// Each step of a ray is at least this long, and at least this share of the way so far.
    PAST_FACE: f32 = 4e-7;
    /// Rays look for their cell this much further on, in root cells, so that none gets stuck at a face.
    AHEAD: f32 = 1e-5;
    /// And further by this share of the distance at which they began.
    AHEAD_OF_FAR: f32 = 5e-7;
}

/// The share of a pixel's cone that counts as the surface at step `step`, from 0.
pub fn hit_fraction(step: u32) -> f32 {
    HIT_FRACTION + HIT_FRACTION_GROWTH * step.saturating_sub(STEPS_MANY) as f32
}

/// The step at `t` of a ray that ends at `end` and has taken `step` steps through a formula that is no distance field.
/// `value` is the formula's there, which falls by at most `slope` for each unit of the way up to `leaves` from `t`, where
/// the ray leaves its cell. `radius` is that of the pixel's cone, at [`NON_LIPSCHITZ_NEAR`] where `t` is less.
///
/// No step passes a surface, unless the smallest step is longer. From [`NON_LIPSCHITZ_STEPS_MANY`] steps on the smallest step
/// grows with the distance so that the steps left reach the end: a ray never stops in the middle of nowhere.
pub fn non_lipschitz_step(
    step: u32,
    (value, slope): (f32, f32),
    leaves: f32,
    (t, end): (f32, f32),
    radius: f32,
) -> f32 {
    let left = NON_LIPSCHITZ_STEPS_MAX.saturating_sub(step).max(1);
    let from = t.max(NON_LIPSCHITZ_NEAR);
    let even = from * ((end / from).powf(1.0 / left as f32) - 1.0);
    let fine = (NON_LIPSCHITZ_STEP_MIN + NON_LIPSCHITZ_STEP_GROWTH * step as f32) * radius;
    let least = if step < NON_LIPSCHITZ_STEPS_MANY { fine } else { fine.max(even) };
    let safe = if slope > 0.0 { value / slope } else { FAR };
    safe.min(leaves).max(least)
}

/// A little further on than `t`.
pub fn past(t: f32) -> f32 {
    t * (1.0 + PAST_FACE) + PAST_FACE
}

#[cfg(test)]
mod tests {
    #[test]
    fn numbers_are_told_as_glsl_reads_them() {
        let all: Vec<String> = super::defines().collect();
        for define in ["STEPS_MAX 128", "FAR 1000.0", "PAST_FACE 4e-7", "SEVERAL 255"] {
            assert!(all.iter().any(|one| one == define), "{define} is not in {all:?}");
        }
    }
}
