//! An integer hash and periodic gradient noise (after Perlin 1985), the same on every run.

fn scramble(mut x: u32) -> u32 {
    x = (x ^ (x >> 16)).wrapping_mul(0x9E37_79B1);
    x = (x ^ (x >> 15)).wrapping_mul(0x85EB_CA77);
    x = (x ^ (x >> 13)).wrapping_mul(0xC2B2_AE3D);
    x ^ (x >> 16)
}

fn hash(x: i32, y: i32, seed: u32) -> u32 {
    scramble((x as u32) ^ scramble((y as u32) ^ scramble(seed)))
}

/// Returns a number in 0..1 for the lattice point (`x`, `y`).
pub fn random(x: i32, y: i32, seed: u32) -> f32 {
    (hash(x, y, seed) >> 8) as f32 / (1 << 24) as f32
}

/// Returns a Hermite step from 0 at `a` to 1 at `b`. `a` may be greater than `b`.
pub fn smoothstep(a: f32, b: f32, x: f32) -> f32 {
    let t = ((x - a) / (b - a)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

pub fn mix(a: f32, b: f32, t: f32) -> f32 {
    a + (b - a) * t
}

pub fn mix3(a: [f32; 3], b: [f32; 3], t: f32) -> [f32; 3] {
    [mix(a[0], b[0], t), mix(a[1], b[1], t), mix(a[2], b[2], t)]
}

/// Gradient noise in about -1..1, periodic with `period` lattice cells along x and y.
pub fn gradient(x: f32, y: f32, period: [i32; 2], seed: u32) -> f32 {
    let (x0, y0) = (x.floor(), y.floor());
    let (fx, fy) = (x - x0, y - y0);
    let corner = |dx: i32, dy: i32| {
        let h = hash((x0 as i32 + dx).rem_euclid(period[0]), (y0 as i32 + dy).rem_euclid(period[1]), seed);
        let gx = (h & 0xFFFF) as f32 / 32767.5 - 1.0;
        let gy = (h >> 16) as f32 / 32767.5 - 1.0;
        gx * (fx - dx as f32) + gy * (fy - dy as f32)
    };
    let fade = |t: f32| t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
    let (u, v) = (fade(fx), fade(fy));
    1.5 * mix(mix(corner(0, 0), corner(1, 0), u), mix(corner(0, 1), corner(1, 1), u), v)
}

/// Sums `octaves` of [`gradient`], each twice as fine and half as strong as the previous octave.
pub fn turbulence(x: f32, y: f32, period: [i32; 2], octaves: u32, seed: u32) -> f32 {
    let mut sum = 0.0;
    let mut weight = 1.0;
    for octave in 0..octaves {
        let scale = 1 << octave;
        let s = scale as f32;
        let wrap = [period[0] * scale, period[1] * scale];
        sum += weight * gradient(x * s, y * s, wrap, seed.wrapping_add(octave * 131));
        weight *= 0.5;
    }
    sum
}

/// [`turbulence`] that does not repeat within an image.
pub fn free_turbulence(x: f32, y: f32, octaves: u32, seed: u32) -> f32 {
    turbulence(x, y, [1 << 16; 2], octaves, seed)
}
