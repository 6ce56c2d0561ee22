//! Pictures as mipmapped textures.

#![expect(unsafe_code, reason = "every OpenGL call is unsafe in glow")]

use glow::HasContext;
use image::RgbaImage;

use super::error::GpuError;
use super::gl::Gl;
use super::object::Texture;
use crate::srgb;

/// Texture anisotropy on a GPU: enough for floors at grazing angles and for cabinet sides, at little cost.
const ANISOTROPY: f32 = 8.0;
/// The same on a software renderer: Mesa's llvmpipe walks the whole footprint of a texel, including lanes without a
/// hit, and was seen not to return from it.
const ANISOTROPY_SOFTWARE: f32 = 1.0;

/// The picture's texels as 16-bit floats in linear light. By tables: this is done between two frames.
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

/// The bits of the nearest 16-bit float; halfway between two, of the even one. `value` is 0 or within 2^-14..=1.
fn half_bits(value: f32) -> u16 {
    /// Bits of a mantissa that a 16-bit float has no room for.
    const DROPPED: u32 = 13;
    /// The difference of the exponents' biases, in its place.
    const BIAS: u32 = (127 - 15) << 10;
    let bits = value.to_bits();
    let rounded = (bits + (1 << (DROPPED - 1)) - 1 + ((bits >> DROPPED) & 1)) >> DROPPED;
    rounded.saturating_sub(BIAS) as u16
}

/// GL_TEXTURE_MAX_ANISOTROPY, which core GL has only since 4.6.
const TEXTURE_MAX_ANISOTROPY: u32 = 0x84FE;

/// Uploads an sRGB picture: sampled in linear light, with all mip levels, trilinear and anisotropic, repeated beyond
/// 0..1. A software renderer gets it as 16-bit floats in linear light: it would convert eight texels for every
/// one that it samples, which was a fifth of a frame.
///
/// # Errors
/// [`GpuError::TooLarge`] beyond the driver's texture size; [`GpuError::Object`] if it has no object left.
pub fn upload(gl: &Gl, picture: &RgbaImage) -> Result<Texture, GpuError> {
    let (width, height) = picture.dimensions();
    let limit = gl.info().texture_side_max;
    if width > limit || height > limit {
        return Err(GpuError::TooLarge { width, height, limit });
    }
    let texture = Texture::new(gl)?;
    let software = gl.info().software;
    let wanted = if software { ANISOTROPY_SOFTWARE } else { ANISOTROPY };
    let texels = if software { linear_texels(picture) } else { picture.as_raw().clone() };
    let (format, kind) =
        if software { (glow::RGBA16F, glow::HALF_FLOAT) } else { (glow::SRGB8_ALPHA8, glow::UNSIGNED_BYTE) };
    let anisotropy = wanted.min(gl.info().anisotropy_max);
    // SAFETY: the texture is ours, and the slice holds width * height RGBA texels.
    unsafe {
        gl.bind_texture(glow::TEXTURE_2D, Some(texture.native()));
        gl.pixel_store_i32(glow::UNPACK_ALIGNMENT, 1);
        gl.tex_image_2d(
            glow::TEXTURE_2D,
            0,
            format.cast_signed(),
            width.cast_signed(),
            height.cast_signed(),
            0,
            glow::RGBA,
            kind,
            glow::PixelUnpackData::Slice(Some(&texels)),
        );
        gl.generate_mipmap(glow::TEXTURE_2D);
        let parameters = [
            (glow::TEXTURE_MIN_FILTER, glow::LINEAR_MIPMAP_LINEAR),
            (glow::TEXTURE_MAG_FILTER, glow::LINEAR),
            (glow::TEXTURE_WRAP_S, glow::REPEAT),
            (glow::TEXTURE_WRAP_T, glow::REPEAT),
        ];
        for (name, value) in parameters {
            gl.tex_parameter_i32(glow::TEXTURE_2D, name, value.cast_signed());
        }
        if anisotropy > 1.0 {
            gl.tex_parameter_f32(glow::TEXTURE_2D, TEXTURE_MAX_ANISOTROPY, anisotropy);
        }
    }
    gl.check("uploading a texture")?;
    Ok(texture)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texels_are_the_nearest_16_bit_floats_of_their_light() {
        assert_eq!([0.0, 1.0, 0.5, 0.25].map(half_bits), [0, 0x3c00, 0x3800, 0x3400]);
        // Between two of them the nearest, and from the middle the even one.
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
}
