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

/// The picture's texels as 32-bit floats in linear light.
fn linear_texels(picture: &RgbaImage) -> Vec<u8> {
    let table = srgb::linear_of_bytes();
    let light = |byte: u8| table.get(usize::from(byte)).copied().unwrap_or(0.0);
    let texels = picture.pixels().map(|pixel| {
        let [r, g, b, a] = pixel.0;
        [light(r), light(g), light(b), f32::from(a) / 255.0]
    });
    texels.flatten().flat_map(f32::to_ne_bytes).collect()
}

/// GL_TEXTURE_MAX_ANISOTROPY, which core GL has only since 4.6.
const TEXTURE_MAX_ANISOTROPY: u32 = 0x84FE;

/// Uploads an sRGB picture: sampled in linear light, with all mip levels, trilinear and anisotropic, repeated beyond
/// 0..1. A software renderer gets it as 16-bit floats in linear light: it would convert eight texels for every one
/// that it samples, which took a fifth of a frame.
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
        if software { (glow::RGBA16F, glow::FLOAT) } else { (glow::SRGB8_ALPHA8, glow::UNSIGNED_BYTE) };
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
