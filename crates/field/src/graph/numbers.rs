//! Scalar functions with which `op.rs` defines the operators on the CPU. Unlike GLSL's functions, they are defined for
//! all operands.

/// Smallest operand of a logarithm, and smallest base of a power: the smallest normal f32. GPUs flush smaller numbers
/// to 0.
pub const SMALLEST: f32 = f32::MIN_POSITIVE;
/// TANH clamps its operand to this magnitude, where tanh is 1 in f32. In some drivers, much larger operands overflow.
pub const TANH_MAX: f32 = 10.0;
/// Largest f32 below 2^31. Cell numbers are clamped to this limit before they become integers.
pub const CELL_MAX: f32 = 2_147_483_520.0;

#[inline(always)]
pub(super) fn truth(condition: bool) -> f32 {
    if condition { 1.0 } else { 0.0 }
}

#[inline(always)]
pub(super) fn round(a: f32) -> f32 {
    (a + 0.5).floor()
}

#[inline(always)]
pub(super) fn sqrt(a: f32) -> f32 {
    if a > 0.0 { a.sqrt() } else { 0.0 }
}

/// `a` clamped to -1..1, 0 for a NaN.
#[inline(always)]
pub(super) fn unit(a: f32) -> f32 {
    if a.is_nan() { 0.0 } else { a.clamp(-1.0, 1.0) }
}

#[inline(always)]
pub(super) fn arc_slope(a: f32) -> f32 {
    if a.abs() < 1.0 { (1.0 - a * a).sqrt().recip() } else { 0.0 }
}

#[inline(always)]
pub(super) fn length_slopes(a: f32, r: f32) -> (f32, f32) {
    let by_sum = 0.5 / r;
    let by_a = 2.0 * a * by_sum;
    (if by_a.is_nan() { 0.0 } else { by_a }, by_sum)
}

#[inline(always)]
pub(super) fn tanh(a: f32) -> f32 {
    if a.is_nan() { 0.0 } else { a.clamp(-TANH_MAX, TANH_MAX).tanh() }
}

#[inline(always)]
pub(super) fn div(a: f32, b: f32) -> f32 {
    if b == 0.0 { 0.0 } else { a / b }
}

#[inline(always)]
pub(super) fn modulo(a: f32, b: f32) -> f32 {
    if b == 0.0 { a } else { a - b * (a / b).floor() }
}

#[inline(always)]
pub(super) fn pow(a: f32, b: f32) -> f32 {
    if a >= SMALLEST { a.powf(b) } else { truth(b == 0.0) }
}

#[inline(always)]
pub(super) fn atan2(a: f32, b: f32) -> f32 {
    if a == 0.0 { if b < 0.0 { std::f32::consts::PI } else { 0.0 } } else { a.atan2(b) }
}

/// Returns a pseudo-random number in 0..1, a multiple of 2^-24, for the cell (floor(a), floor(b)).
///
/// The cell's numbers become 32-bit integers (clamped to ±[`CELL_MAX`]; 0 for a NaN). Integer operations mix them, so
/// every machine computes the same bits. The upper 24 bits are the result. For more dimensions, chain calls:
/// `cell_hash(cell_hash(x, y) * 16777216, z)` loses no bits.
#[inline(always)]
pub fn cell_hash(a: f32, b: f32) -> f32 {
    let whole = |v: f32| (v.floor().clamp(-CELL_MAX, CELL_MAX) as i32) as u32;
    let mut h = whole(a).wrapping_mul(0x9E37_79B1) ^ whole(b).wrapping_mul(0x85EB_CA77).rotate_left(13);
    h ^= h >> 16;
    h = h.wrapping_mul(0x7FEB_352D);
    h ^= h >> 15;
    h = h.wrapping_mul(0x846C_A68B);
    h ^= h >> 16;
    (h >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// GLSL source of [`cell_hash`].
pub const CELL_HASH_GLSL: &str = "\
float cell_hash(float a, float b) {
    uint i = uint(int(clamp(floor(a), -2147483520.0, 2147483520.0))) * 0x9E3779B1u;
    uint j = uint(int(clamp(floor(b), -2147483520.0, 2147483520.0))) * 0x85EBCA77u;
    uint h = i ^ ((j << 13) | (j >> 19));
    h ^= h >> 16;
    h *= 0x7FEB352Du;
    h ^= h >> 15;
    h *= 0x846CA68Bu;
    h ^= h >> 16;
    return float(h >> 8) * 5.9604644775390625e-8;
}
";
