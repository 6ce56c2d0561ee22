//! The state of the paths of light of an area, which a pass of `path.frag` reads and another one writes.

#![expect(unsafe_code, reason = "every OpenGL call is unsafe in glow")]

use glow::HasContext;

use super::error::Result;
use super::gl::Gl;
use super::object::{Framebuffer, Texture};
use super::program::unit_of;
use super::target::Target;

/// Two states, one of which is the current one.
pub(super) struct PathState {
    gl: Gl,
    states: [(Framebuffer, Texture); 2],
    current: usize,
    pub(super) size: (u32, u32),
}

impl PathState {
    /// Creates a state for `size` pixels.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`] if the size exceeds the driver's limit, [`GpuError::Object`] if the driver has no memory for
    /// it or cannot draw 32-bit floats.
    pub(super) fn new(gl: &Gl, size: (u32, u32)) -> Result<Self> {
        Target::check_size(gl, size)?;
        let states = [state(gl, size)?, state(gl, size)?];
        gl.check("making the state of paths")?;
        Ok(Self { gl: gl.clone(), states, current: 0, size })
    }

    /// Makes draws read the current state and write the other one.
    pub(super) fn bind(&self) {
        self.bind_current("path_state");
        let (framebuffer, _) = &self.states[1 - self.current];
        self.gl.bind_output(Some(framebuffer.native()), self.size);
    }

    /// Makes draws read the current state as the texture `name`.
    pub(super) fn bind_current(&self, name: &str) {
        let (_, texture) = &self.states[self.current];
        self.gl.bind_unit(unit_of(name), glow::TEXTURE_2D_ARRAY, Some(texture.native()));
    }

    /// Makes the written state the current one.
    pub(super) fn swap(&mut self) {
        self.current = 1 - self.current;
    }

    /// Reads the number of finished paths of each pixel, lowest row first, and whether more follow.
    pub(super) fn read(&self) -> Vec<(u32, bool)> {
        let tag = |texel| {
            let tag = Tag::of(texel);
            (tag.paths(), !tag.is_finished())
        };
        self.layer(0).as_chunks::<TEXEL>().0.iter().map(tag).collect()
    }

    /// Reads the current state.
    pub(super) fn kept(&self) -> KeptPaths {
        KeptPaths { layers: std::array::from_fn(|layer| self.layer(layer as u32)) }
    }

    /// Reads the texels of a layer, lowest row first.
    fn layer(&self, layer: u32) -> Vec<u8> {
        let (framebuffer, _) = &self.states[self.current];
        let mut bytes = vec![0; TEXEL * self.size.0 as usize * self.size.1 as usize];
        // SAFETY: `self` owns the framebuffer, and the slice holds exactly its texels in this format.
        unsafe {
            self.gl.bind_framebuffer(glow::READ_FRAMEBUFFER, Some(framebuffer.native()));
            self.gl.read_buffer(glow::COLOR_ATTACHMENT0 + layer);
            self.gl.pixel_store_i32(glow::PACK_ALIGNMENT, 1);
            let pixels = glow::PixelPackData::Slice(Some(&mut bytes));
            let (width, height) = (self.size.0.cast_signed(), self.size.1.cast_signed());
            self.gl.read_pixels(0, 0, width, height, glow::RGBA, glow::FLOAT, pixels);
        }
        bytes
    }

    /// Fills the current state. Paths of another size are ignored.
    pub(super) fn fill(&self, kept: &KeptPaths) {
        self.bind_current("path_state");
        let (target, format, kind) = (glow::TEXTURE_2D_ARRAY, glow::RGBA, glow::FLOAT);
        let [width, height] = [self.size.0, self.size.1].map(u32::cast_signed);
        let length = TEXEL * self.size.0 as usize * self.size.1 as usize;
        for (layer, bytes) in (0..).zip(&kept.layers).filter(|(_, bytes)| bytes.len() == length) {
            let pixels = glow::PixelUnpackData::Slice(Some(bytes));
            // SAFETY: `self` owns the bound texture, and the slice holds exactly the texels of a layer.
            unsafe {
                self.gl.tex_sub_image_3d(target, 0, 0, 0, layer, width, height, 1, format, kind, pixels);
            }
        }
    }
}

fn state(gl: &Gl, size: (u32, u32)) -> Result<(Framebuffer, Texture)> {
    let (framebuffer, texture) = (Framebuffer::new(gl)?, Texture::new(gl)?);
    // SAFETY: both names were just created in the current context, and no data is passed.
    unsafe {
        let target = glow::TEXTURE_2D_ARRAY;
        gl.bind_texture(target, Some(texture.native()));
        let [width, height, layers] = [size.0, size.1, LAYERS as u32].map(u32::cast_signed);
        let none = glow::PixelUnpackData::Slice(None);
        let (stored, format, kind) = (glow::RGBA32F.cast_signed(), glow::RGBA, glow::FLOAT);
        gl.tex_image_3d(target, 0, stored, width, height, layers, 0, format, kind, none);
        gl.filter(target, glow::NEAREST);
        gl.bind_framebuffer(glow::FRAMEBUFFER, Some(framebuffer.native()));
        let attachments: Vec<u32> = (0..LAYERS as u32).map(|layer| glow::COLOR_ATTACHMENT0 + layer).collect();
        for (layer, attachment) in (0..).zip(&attachments) {
            let texture = Some(texture.native());
            gl.framebuffer_texture_layer(glow::FRAMEBUFFER, *attachment, texture, 0, layer);
        }
        gl.draw_buffers(&attachments);
    }
    gl.check_framebuffer("the state of paths", &size)?;
    Ok((framebuffer, texture))
}

// The paths of an area as bytes, from which another run continues them bit for bit.

/// The layers of a state, each with a texel of four 32-bit floats for a pixel: see `shaders/path_state.glsl`.
pub(super) const LAYERS: usize = 4;
/// Bytes of a texel.
pub(super) const TEXEL: usize = 16;
/// Bytes of a packed pixel, at most.
pub const PIXEL_BYTES_MAX: usize = LAYERS * TEXEL;
/// Paths are numbered in multiples of this number (`path_state.glsl`).
const RAYS_MAX: u32 = 255;
/// The number of the next ray in a pixel whose paths are all finished.
const FINISHED: u32 = RAYS_MAX - 1;
/// Tags are whole numbers below this one, which 32-bit floats represent exactly.
const TAGS: f32 = 16_777_216.0;

type Texel = [u8; TEXEL];

/// The tag of a pixel: the number of its finished paths, and the number of its next ray.
#[derive(Clone, Copy)]
pub(super) struct Tag(u32);

impl Tag {
    /// Reads the tag in a texel of the first layer.
    pub(super) fn of(texel: &Texel) -> Self {
        let [.., a, b, c, d] = *texel;
        Self(f32::from_ne_bytes([a, b, c, d]) as u32)
    }

    pub(super) fn paths(self) -> u32 {
        self.0 / RAYS_MAX
    }

    pub(super) fn is_finished(self) -> bool {
        self.0 % RAYS_MAX == FINISHED
    }
}

/// The state of the paths of an area.
pub struct KeptPaths {
    /// The texels of each layer, lowest row first.
    pub(super) layers: [Vec<u8>; LAYERS],
}

impl KeptPaths {
    /// Packs the paths. A pixel without further paths takes 20 bytes, any other pixel 64.
    pub fn bytes(&self) -> Vec<u8> {
        let [origins, directions, throughputs, sums] =
            self.layers.each_ref().map(|layer| layer.as_chunks::<TEXEL>().0);
        let mut bytes = Vec::with_capacity(origins.len() * PIXEL_BYTES_MAX);
        for (((origin, direction), throughput), sum) in
            origins.iter().zip(directions).zip(throughputs).zip(sums)
        {
            let [place @ .., a, b, c, d] = origin;
            bytes.extend([a, b, c, d]);
            bytes.extend(sum);
            if !Tag::of(origin).is_finished() {
                bytes.extend(place);
                bytes.extend(direction);
                bytes.extend(throughput);
            }
        }
        bytes
    }

    /// Unpacks the paths of an area with this number of pixels. Returns `None` if the bytes are no such paths.
    pub fn of_bytes(mut bytes: &[u8], pixels: usize) -> Option<Self> {
        if bytes.len() > pixels.checked_mul(PIXEL_BYTES_MAX)? {
            return None;
        }
        let mut layers: [Vec<u8>; LAYERS] = Default::default();
        layers.iter_mut().for_each(|layer| layer.reserve(pixels * TEXEL));
        let [origins, directions, throughputs, sums] = &mut layers;
        for _ in 0..pixels {
            let tag: [u8; 4] = taken(&mut bytes)?;
            if !(0.0..TAGS).contains(&f32::from_ne_bytes(tag)) {
                return None;
            }
            sums.extend(taken::<TEXEL>(&mut bytes)?);
            let is_finished = Tag(f32::from_ne_bytes(tag) as u32).is_finished();
            // The next path of a finished pixel begins at the eye.
            let rest = if is_finished { [0; 44] } else { taken(&mut bytes)? };
            let (place, rest) = rest.split_at(12);
            let (direction, throughput) = rest.split_at(TEXEL);
            origins.extend(place);
            origins.extend(tag);
            directions.extend(direction);
            throughputs.extend(throughput);
        }
        bytes.is_empty().then_some(Self { layers })
    }

    /// Lets finished pixels draw another path, after which the limits of the image decide again.
    pub fn reopen(&mut self) {
        let [origins, ..] = &mut self.layers;
        for texel in origins.as_chunks_mut::<TEXEL>().0 {
            let tag = Tag::of(texel);
            if tag.is_finished() {
                let [.., a, b, c, d] = texel;
                [*a, *b, *c, *d] = ((tag.paths() * RAYS_MAX) as f32).to_ne_bytes();
            }
        }
    }
}

fn taken<const N: usize>(bytes: &mut &[u8]) -> Option<[u8; N]> {
    let (first, rest) = bytes.split_first_chunk::<N>()?;
    *bytes = rest;
    Some(*first)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first pixel is within its fourth path, the second one is finished after seven.
    fn paths() -> KeptPaths {
        let texel = |numbers: [f32; 4]| numbers.map(f32::to_ne_bytes).concat();
        let layer = |a: [f32; 4], b: [f32; 4]| [texel(a), texel(b)].concat();
        KeptPaths {
            layers: [
                layer([1.5, -2.0, 3.0, (3 * 255 + 2) as f32], [0.0, 0.0, 0.0, (7 * 255 + 254) as f32]),
                layer([0.1, 0.2, -1.0, 9.0], [0.0; 4]),
                layer([1.0, 0.5, 0.25, 0.7], [0.0; 4]),
                layer([4.0, 5.0, 6.0, 7.0], [8.0, 9.0, 10.0, 11.0]),
            ],
        }
    }

    #[test]
    fn unpacked_paths_have_the_same_bits() {
        let (kept, bytes) = (paths(), paths().bytes());
        assert_eq!(bytes.len(), 64 + 20);
        assert_eq!(KeptPaths::of_bytes(&bytes, 2).unwrap().layers, kept.layers);
    }

    #[test]
    fn bytes_of_another_length_or_with_impossible_tags_are_refused() {
        let bytes = paths().bytes();
        for length in 0..bytes.len() {
            assert!(KeptPaths::of_bytes(&bytes[..length], 2).is_none(), "{length}");
        }
        for pixels in [0, 1, 3, usize::MAX] {
            assert!(KeptPaths::of_bytes(&bytes, pixels).is_none(), "{pixels}");
        }
        assert!(KeptPaths::of_bytes(&[&bytes[..], &[0]].concat(), 2).is_none());
        for tag in [f32::NAN, -1.0, TAGS, f32::INFINITY] {
            let changed = [&tag.to_ne_bytes()[..], &bytes[4..]].concat();
            assert!(KeptPaths::of_bytes(&changed, 2).is_none(), "{tag}");
        }
    }

    #[test]
    fn only_finished_pixels_are_reopened() {
        let mut kept = paths();
        kept.reopen();
        let (origins, before) = (kept.layers[0].as_chunks::<TEXEL>().0, paths());
        assert_eq!(origins[0], before.layers[0][..TEXEL]);
        assert!(!Tag::of(&origins[1]).is_finished());
        assert_eq!(Tag::of(&origins[1]).0, 7 * RAYS_MAX);
    }
}
