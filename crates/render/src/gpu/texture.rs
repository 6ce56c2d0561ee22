//! Uploads images as mipmapped textures, and the pictures of moving textures.
//!
//! A moving texture has mip levels only on a GPU, which computes them fast. On a software renderer, computing them for
//! each picture would take longer than a frame, and so would the conversion to linear light.

#![expect(unsafe_code, reason = "every OpenGL call is unsafe in glow")]

use std::borrow::Cow;

use glow::HasContext;
use image::RgbaImage;

use super::error::Result;
use super::gl::Gl;
use super::object::Texture;
use super::target::Target;
use crate::srgb;

/// Texture anisotropy on a GPU: enough for floors at grazing angles and for cabinet sides, at little cost.
const ANISOTROPY: f32 = 8.0;
/// Texture anisotropy on a software renderer. Mesa's llvmpipe takes all samples of a pixel's footprint, even for pixels
/// without a hit, and has been seen to hang while doing so.
const ANISOTROPY_SOFTWARE: f32 = 1.0;

/// Converts an image to 16-bit floats in linear light. Uses tables for speed, because it runs between two frames.
fn linear_texels(picture: &RgbaImage) -> Vec<u8> {
    let light = srgb::linear_of_bytes().map(|light| half_bits(light).to_ne_bytes());
    let alpha: [[u8; 2]; 256] = std::array::from_fn(|byte| half_bits(byte as f32 / 255.0).to_ne_bytes());
    let of = |table: &[[u8; 2]; 256], byte: u8| table.get(usize::from(byte)).copied().unwrap_or_default();
    let mut texels = vec![0; 2 * picture.as_raw().len()];
    let texels_and_pixels = texels.as_chunks_mut::<8>().0.iter_mut().zip(picture.as_raw().as_chunks::<4>().0);
    for (texel, [r, g, b, a]) in texels_and_pixels {
        let [[r0, r1], [g0, g1], [b0, b1]] = [*r, *g, *b].map(|byte| of(&light, byte));
        let [a0, a1] = of(&alpha, *a);
        *texel = [r0, r1, g0, g1, b0, b1, a0, a1];
    }
    texels
}

struct MipLevel {
    size: (u32, u32),
    texels: Vec<[f32; 4]>,
}

impl MipLevel {
    /// The first level below the full image; `None` if the image is a single texel.
    fn below(picture: &RgbaImage) -> Option<Self> {
        let (light, pixels) = (srgb::linear_of_bytes(), picture.as_raw().as_chunks::<4>().0);
        let of = |byte: u8| light.get(usize::from(byte)).copied().unwrap_or_default();
        halved(picture.dimensions(), pixels, |[r, g, b, a]| [of(*r), of(*g), of(*b), f32::from(*a) / 255.0])
    }

    fn next(&self) -> Option<Self> {
        halved(self.size, &self.texels, |texel| *texel)
    }

    fn halves(&self) -> Vec<u8> {
        self.texels.iter().flatten().flat_map(|value| half_bits(*value).to_ne_bytes()).collect()
    }
}

/// Halves width and height, rounded down. Each texel is the mean of the area that it covers. `None` for a single texel.
fn halved<T>(size: (u32, u32), texels: &[T], light: impl Fn(&T) -> [f32; 4]) -> Option<MipLevel> {
    let (width, height) = size;
    if width.max(height) < 2 {
        return None;
    }
    let size = ((width / 2).max(1), (height / 2).max(1));
    let (across, down) = (covered(width, size.0), covered(height, size.1));
    let mut below = Vec::with_capacity(size.0 as usize * size.1 as usize);
    for (top, fractions_down) in &down {
        for (left, fractions_across) in &across {
            let mut mean = [0.0; 4];
            for (row, down) in fractions_down.iter().enumerate() {
                let first = (top + row) * width as usize + left;
                let texels = texels.get(first..).unwrap_or_default();
                for (texel, across) in texels.iter().zip(fractions_across) {
                    let light = light(texel);
                    mean.iter_mut().zip(light).for_each(|(mean, light)| *mean += down * across * light);
                }
            }
            below.push(mean);
        }
    }
    Some(MipLevel { size, texels: below })
}

/// Returns weights for reducing a side from `above` to `below` texels: for each new texel, the first old texel that it
/// covers, and the weights of all old texels that it covers.
fn covered(above: u32, below: u32) -> Vec<(usize, Vec<f32>)> {
    let length = f64::from(above) / f64::from(below);
    let of = |texel: u32| {
        let (begin, end) = (f64::from(texel) * length, f64::from(texel + 1) * length);
        let fraction = |at: u32| end.min(f64::from(at) + 1.0) - begin.max(f64::from(at));
        let (first, last) = (begin.floor() as u32, (end.ceil() as u32).min(above));
        let fractions = (first..last).map(|at| (fraction(at) / length) as f32);
        (first as usize, fractions.filter(|fraction| *fraction > 1e-6).collect())
    };
    (0..below).map(of).collect()
}

/// The bits of the nearest 16-bit float, ties to even. `value` must be within 0..=1. For values below 2^-14 the result
/// may be too small.
fn half_bits(value: f32) -> u16 {
    /// Mantissa bits that a 16-bit float lacks.
    const DROPPED: u32 = 13;
    /// The difference of the exponents' biases, shifted to the exponent.
    const BIAS: u32 = (127 - 15) << 10;
    let bits = value.to_bits();
    let rounded = (bits + (1 << (DROPPED - 1)) - 1 + ((bits >> DROPPED) & 1)) >> DROPPED;
    rounded.saturating_sub(BIAS) as u16
}

/// GL_TEXTURE_MAX_ANISOTROPY, which is part of core OpenGL only since 4.6.
const TEXTURE_MAX_ANISOTROPY: u32 = 0x84FE;

/// Uploads an sRGB image with all mip levels. Shaders sample it in linear light, with trilinear and anisotropic
/// filtering, and the image repeats beyond 0..1. Software renderers get 16-bit floats in linear light. With sRGB texels
/// they would convert eight texels per sample, which took a fifth of a frame. If the texture `moves`, this is its first
/// picture.
///
/// # Errors
/// [`TooLarge`](super::error::GpuError::TooLarge) if the image exceeds the driver's texture size;
/// [`Object`](super::error::GpuError::Object) if the driver cannot create another object.
pub fn upload(gl: &Gl, picture: &RgbaImage, moves: bool) -> Result<Texture> {
    Target::check_size(gl, picture.dimensions())?;
    let (levels, texture) = (levels_of(gl, moves), Texture::new(gl)?);
    let wanted = if gl.info().software { ANISOTROPY_SOFTWARE } else { ANISOTROPY };
    let anisotropy = wanted.min(gl.info().anisotropy_max);
    let smaller = if levels == Levels::Missing { glow::LINEAR } else { glow::LINEAR_MIPMAP_LINEAR };
    // SAFETY: the texture was just created in the current context.
    unsafe {
        gl.bind_texture(glow::TEXTURE_2D, Some(texture.native()));
        fill(gl, picture, levels, false);
        let parameters = [
            (glow::TEXTURE_MIN_FILTER, smaller),
            (glow::TEXTURE_MAG_FILTER, glow::LINEAR),
            (glow::TEXTURE_WRAP_S, glow::REPEAT),
            (glow::TEXTURE_WRAP_T, glow::REPEAT),
        ];
        for (name, value) in parameters {
            gl.tex_parameter_i32(glow::TEXTURE_2D, name, value.cast_signed());
        }
        if levels == Levels::Missing {
            gl.tex_parameter_i32(glow::TEXTURE_2D, glow::TEXTURE_MAX_LEVEL, 0);
        }
        if anisotropy > 1.0 {
            gl.tex_parameter_f32(glow::TEXTURE_2D, TEXTURE_MAX_ANISOTROPY, anisotropy);
        }
    }
    gl.check("uploading a texture")?;
    Ok(texture)
}

/// Replaces the picture of a moving texture. `same_size` is true if the last picture had the same size.
///
/// # Errors
/// Fails like [`upload`].
pub fn replace(gl: &Gl, texture: &Texture, picture: &RgbaImage, same_size: bool) -> Result<()> {
    Target::check_size(gl, picture.dimensions())?;
    // SAFETY: the texture exists in the current context.
    unsafe { gl.bind_texture(glow::TEXTURE_2D, Some(texture.native())) };
    fill(gl, picture, levels_of(gl, true), same_size);
    gl.check("uploading a picture")
}

/// The mip levels below the full image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Levels {
    /// The driver generates them.
    Generated,
    /// Computed here: llvmpipe would compile a shader before it generates them, and the first frame would wait for it.
    Computed,
    /// There are none.
    Missing,
}

fn levels_of(gl: &Gl, moves: bool) -> Levels {
    match gl.info().software {
        true if moves => Levels::Missing,
        true => Levels::Computed,
        false => Levels::Generated,
    }
}

/// The formats of 16-bit floats.
const FLOATS: (u32, u32, u32) = (glow::RGBA16F, glow::RGBA, glow::HALF_FLOAT);

/// Uploads the texels of the bound texture.
fn fill(gl: &Gl, picture: &RgbaImage, levels: Levels, same_size: bool) {
    let (texels, texel) = match levels {
        Levels::Computed => (Cow::Owned(linear_texels(picture)), FLOATS),
        _ => (Cow::Borrowed(picture.as_raw()), (glow::SRGB8_ALPHA8, glow::RGBA, glow::UNSIGNED_BYTE)),
    };
    let (width, height) = picture.dimensions();
    // SAFETY: the caller has bound a texture in the current context, and `texels` holds width * height RGBA texels of
    // `kind`.
    unsafe {
        if same_size {
            gl.replace_area(texel, [0, 0, width, height], &texels);
        } else {
            gl.store_level(0, texel, (width, height), Some(&texels));
        }
        match levels {
            Levels::Generated => gl.generate_mipmap(glow::TEXTURE_2D),
            Levels::Computed => upload_levels(gl, picture),
            Levels::Missing => {}
        }
    }
}

/// Uploads the lower mip levels of the bound texture.
fn upload_levels(gl: &Gl, picture: &RgbaImage) {
    let levels = std::iter::successors(MipLevel::below(picture), MipLevel::next);
    for (number, level) in (1..).zip(levels) {
        // SAFETY: the caller has bound the texture, and the slice holds all RGBA texels of the level.
        unsafe { gl.store_level(number, FLOATS, level.size, Some(&level.halves())) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texels_are_the_nearest_16_bit_floats_of_their_light() {
        assert_eq!([0.0, 1.0, 0.5, 0.25].map(half_bits), [0, 0x3c00, 0x3800, 0x3400]);
        let between = |sixteenths: f32| half_bits(0.5 + sixteenths / 16.0 / 2048.0);
        assert_eq!([7.0, 8.0, 9.0, 24.0].map(between), [0x3800, 0x3800, 0x3801, 0x3802]);
        assert_eq!(half_bits(1.0 - f32::EPSILON), 0x3c00);
        let picture = RgbaImage::from_raw(2, 1, vec![0, 255, 188, 255, 255, 0, 0, 0]).unwrap_or_default();
        let texels = linear_texels(&picture);
        let halves: Vec<u16> =
            texels.as_chunks::<2>().0.iter().map(|bytes| u16::from_ne_bytes(*bytes)).collect();
        let middle = half_bits(srgb::linear_of_bytes()[188]);
        assert_eq!(halves, [0, 0x3c00, middle, 0x3c00, 0x3c00, 0, 0, 0]);
    }

    #[test]
    fn each_mip_level_keeps_the_mean_light() {
        for (width, height) in [(8, 8), (7, 5), (1, 6), (640, 3)] {
            let bytes = (0..4 * width * height).map(|place| (place * 37 % 256) as u8).collect();
            let picture = RgbaImage::from_raw(width, height, bytes).unwrap_or_default();
            let mean = |texels: &[[f32; 4]]| texels.iter().flatten().sum::<f32>() / texels.len() as f32;
            let light = srgb::linear_of_bytes();
            let pixels: Vec<[f32; 4]> = picture
                .pixels()
                .map(|pixel| {
                    let [r, g, b, a] = pixel.0;
                    [
                        light[usize::from(r)],
                        light[usize::from(g)],
                        light[usize::from(b)],
                        f32::from(a) / 255.0,
                    ]
                })
                .collect();
            let levels: Vec<MipLevel> =
                std::iter::successors(MipLevel::below(&picture), MipLevel::next).collect();
            assert_eq!(levels.last().map(|level| level.size), Some((1, 1)));
            assert_eq!(levels.len(), width.max(height).ilog2() as usize);
            for level in &levels {
                assert_eq!(level.texels.len(), level.size.0 as usize * level.size.1 as usize);
                let (found, expected) = (mean(&level.texels), mean(&pixels));
                assert!((found - expected).abs() < 1e-4, "{:?}: {found}, {expected}", level.size);
            }
        }
        let picture = RgbaImage::from_raw(3, 1, [[0; 4], [255; 4], [0; 4]].concat()).unwrap_or_default();
        let level = MipLevel::below(&picture).map(|level| level.texels);
        assert_eq!(level, Some(vec![[1.0 / 3.0; 4]]));
    }
}
