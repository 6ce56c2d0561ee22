//! Numbers by which the shaders trace rays, and by which tests follow those rays on the processor. They stand here once:
//! shaders get them as defines, so that a test never judges a tracer that is not shipped.

macro_rules! rays {
    ($($(#[doc = $doc:literal])+ $name:ident: $kind:ty = $value:literal;)+) => {
        $($(#[doc = $doc])+ pub const $name: $kind = $value;)+

        /// Each as `NAME value` in GLSL.
        pub fn defines() -> impl Iterator<Item = String> {
            [$(format!(concat!(stringify!($name), " {:?}"), $name)),+].into_iter()
        }
    };
}

rays! {
    /// Evaluations along a ray through a distance field, at most.
    STEPS_MAX: u32 = 128;
    /// Share of a pixel's cone that counts as the surface.
    HIT_SHARE: f32 = 0.25;
    /// How much that share grows with each step once there were [`STEPS_MANY`]: a ray that creeps along a surface ends
    /// there.
    HIT_SHARE_GROWTH: f32 = 0.03;
    /// From so many steps on they are many.
    STEPS_MANY: u32 = 32;
    /// How far rays go where a scene has no bounds.
    FAR: f32 = 1000.0;
    /// Evaluations along a ray through a formula that is no distance field, at most, grazing ones counted in. (llvmpipe
    /// ends every loop after 65,535 rounds of all loops of a pixel together, those of the tapes included.)
    STEEP_STEPS_MAX: u32 = 512;
    /// Rounds that close in on where the sign of such a formula changed.
    CLOSINGS_MAX: u32 = 6;
    /// Its smallest step, as a share of the radius of the pixel's cone: nothing that is seen is thinner.
    STEEP_STEP_MIN: f32 = 0.5;
    /// How much the smallest step grows with each: a ray that grazes a surface ends.
    STEEP_STEP_GROWTH: f32 = 0.04;
    /// So close to a change of sign is close enough, as a share of the same radius.
    CLOSE_ENOUGH: f32 = 0.05;
    /// Cells of the tree's root to each side.
    ROOT_SIDE: f32 = 16.0;
    /// Texels that are read to find a cell: in the root, in a brick.
    REGION_LEVELS: u32 = 2;
    /// The number in the place of the nearest object where a cell holds several.
    SEVERAL: u32 = 255;
    /// The most cells that a ray passes without an evaluation.
    SKIPS_MAX: u32 = 1024;
    /// A ray takes each step at least so far, and so much of its way.
    PAST_FACE: f32 = 4e-7;
    /// Rays look for their cells so much further on, in root cells, so that none stays at a face.
    AHEAD: f32 = 1e-5;
    /// And by this share of how far off they began.
    AHEAD_OF_FAR: f32 = 5e-7;
}

/// The share of a pixel's cone that counts as the surface at step `step`, from 0.
pub fn hit_share(step: u32) -> f32 {
    HIT_SHARE + HIT_SHARE_GROWTH * step.saturating_sub(STEPS_MANY) as f32
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
