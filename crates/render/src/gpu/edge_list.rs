//! A list of the pixels at edges. Further samples of the listed pixels are drawn side by side, without gaps.
//!
//! A software renderer runs a shader for eight neighbouring pixels at once. Further samples of 13 % of the pixels, if
//! these are scattered, would therefore cost more than the first samples of all pixels. A separate target avoids this:
//! it holds the samples, in a block for each pixel. On a software renderer, reading the marks back takes no time. A GPU
//! would have to wait, so GPUs use the stencil.
//!
//! Tried: sorting the list by surface. The time changed by less than 3 %, because samples at edges run 2.4 times as
//! many clauses as others, whatever their neighbours. Tried: reusing the light of a first sample of the same surface.
//! It saved 18 % of the clauses and lost 2 dB, but saved no time on llvmpipe, where eight neighbours wait for the
//! slowest. Waiting for the slowest makes frames at most 7 % (wave_tank) to 23 % (speakers) longer; a loop in which no
//! pixel waits could not gain much more.

#![expect(unsafe_code, reason = "every OpenGL call is unsafe in glow")]

use glow::HasContext;

use super::edge_samples::EdgeSamples;
use super::error::Result;
use super::gl::Gl;
use super::object::Texture;
use super::program::unit_of;
use super::target::{Target, Texel};
use super::tiles::Tile;

/// Side of a square in pixels. Pixels are listed square by square, so that pixels drawn together show similar surfaces.
const TILE: usize = 8;

pub(super) struct EdgeList {
    gl: Gl,
    size: (u32, u32),
    texels: Vec<Texel>,
    /// Width and height of a block, in texels.
    block: (u32, u32),
    rows_max: u32,
    /// 255 at edges.
    pub(super) marks: Target,
    /// For each block of samples, its pixel.
    pixels: Texture,
    /// For each pixel, the number of its block of samples, from 1; 0 for pixels without further samples.
    squares: Texture,
    /// The samples, in one block per pixel. The target grows when more room is needed.
    pub(super) samples: Target,
}

impl EdgeList {
    pub(super) fn new(gl: &Gl, size: (u32, u32), texels: &[Texel], samples: EdgeSamples) -> Result<Self> {
        let (block, side_max) = (samples.block(), gl.info().texture_side_max);
        let row = size.0.min(side_max / block.0).max(1);
        let pixels = u64::from(size.0) * u64::from(size.1);
        let rows = u32::try_from(pixels.div_ceil(u64::from(row))).unwrap_or(u32::MAX);
        let rows_max = rows.min(side_max / block.1).max(1);
        let mut list = Self {
            gl: gl.clone(),
            size,
            texels: texels.to_vec(),
            block,
            rows_max,
            marks: Target::new(gl, size, &[Texel::R8], None)?,
            pixels: index_texture(gl, (no_power_of_two(row), no_power_of_two(rows_max)), 4)?,
            squares: index_texture(gl, size, 2)?,
            samples: Target::new(gl, (1, 1), texels, None)?,
        };
        list.reserve(size.1 / 4)?;
        Ok(list)
    }

    fn row(&self) -> u32 {
        self.size.0.min(self.gl.info().texture_side_max / self.block.0).max(1)
    }

    /// Reserves this many rows of blocks, or as many as the driver allows. Pixels beyond the last row get no samples.
    fn reserve(&mut self, rows: u32) -> Result<()> {
        let rows = rows.clamp(1, self.rows_max);
        if self.samples.size().1 < self.block.1 * rows {
            let side_max = self.gl.info().texture_side_max;
            let side = |side| no_power_of_two(side).min(side_max);
            let size = (side(self.block.0 * self.row()), side(self.block.1 * rows));
            self.samples = Target::new(&self.gl, size, &self.texels, None)?;
        }
        Ok(())
    }

    /// Lists the marked pixels. `beams` holds the distance up to which each pixel's beam meets no surface. Returns the
    /// areas of the target into which samples must be drawn.
    pub(super) fn prepare(&mut self, beams: &[f32]) -> Result<Vec<Tile>> {
        let marks = self.marks.read_red();
        let listed = listed_pixels(&marks, self.size);
        let row = self.row() as usize;
        self.reserve(u32::try_from(listed.len().div_ceil(row)).unwrap_or(u32::MAX))?;
        let rows = (self.samples.size().1 / self.block.1).min(self.rows_max);
        let room = row * rows as usize;
        let listed = listed.get(..room).unwrap_or(&listed);

        let width = self.size.0 as usize;
        let mut squares = vec![[0_u16; 2]; width * self.size.1 as usize];
        for (number, [x, y]) in listed.iter().enumerate() {
            if let Some(square) = squares.get_mut(usize::from(*y) * width + usize::from(*x)) {
                *square = [number % row + 1, number / row + 1].map(|place| place as u16);
            }
        }
        let with_beam = |[x, y]: &[u16; 2]| {
            let bits = beams.get(usize::from(*y) * width + usize::from(*x)).map_or(0, |free| free.to_bits());
            [*x, *y, (bits >> 16) as u16, bits as u16]
        };
        let mut pixels: Vec<[u16; 4]> = listed.iter().map(with_beam).collect();
        pixels.resize(listed.len().next_multiple_of(row), [0; 4]);
        self.upload(&self.squares, self.size, &squares);
        self.upload(&self.pixels, (row as u32, (pixels.len() / row) as u32), &pixels);

        self.samples.bind();
        // SAFETY: clears the target bound above, which may hold old counts, in the current context.
        unsafe { self.gl.clear(glow::COLOR_BUFFER_BIT) }
        let (rows, rest) = ((listed.len() / row) as u32, (listed.len() % row) as u32);
        let (across, down) = self.block;
        Ok(vec![
            Tile { x: 0, y: 0, width: across * row as u32, height: down * rows },
            Tile { x: 0, y: down * rows, width: across * rest, height: down },
        ])
    }

    /// Binds the list for the scene's shader. Bind it for every sample: llvmpipe compiles once per kind of texture.
    pub(super) fn bind_pixels(&self) {
        self.bind(&self.pixels, "edge_pixels");
    }

    pub(super) fn bind_samples(&self) {
        self.samples.bind_color(0, unit_of("extra_samples"));
        self.bind(&self.squares, "edge_squares");
    }

    fn bind(&self, texture: &Texture, name: &str) {
        self.gl.bind_unit(unit_of(name), glow::TEXTURE_2D, Some(texture.native()));
    }

    fn upload<const N: usize>(&self, texture: &Texture, size: (u32, u32), texels: &[[u16; N]]) {
        let bytes = bytemuck::cast_slice(texels.as_flattened());
        self.bind(texture, "edge_pixels");
        // SAFETY: the texture of this list is bound, and `texels` has as many texels as `size`.
        unsafe { self.gl.replace_area(index_formats(N), [0, 0, size.0, size.1], bytes) }
    }
}

/// Rounds powers of two up: software renderers would compile an extra variant for them, which delays a show.
fn no_power_of_two(side: u32) -> u32 {
    if side.is_power_of_two() { side + 1 } else { side }
}

fn index_formats(numbers: usize) -> (u32, u32, u32) {
    match numbers {
        2 => (glow::RG16UI, glow::RG_INTEGER, glow::UNSIGNED_SHORT),
        _ => (glow::RGBA16UI, glow::RGBA_INTEGER, glow::UNSIGNED_SHORT),
    }
}

fn index_texture(gl: &Gl, size: (u32, u32), numbers: usize) -> Result<Texture> {
    let texture = Texture::new(gl)?;
    // SAFETY: allocates storage for a texture that was just created in the current context; passes no data.
    unsafe {
        gl.bind_texture(glow::TEXTURE_2D, Some(texture.native()));
        gl.store_level(0, index_formats(numbers), size, None);
    }
    gl.filter(glow::TEXTURE_2D, glow::NEAREST);
    Ok(texture)
}

/// The positions of the marks, x and y, tile by tile.
fn listed_pixels(marks: &[u8], size: (u32, u32)) -> Vec<[u16; 2]> {
    let (width, height) = (size.0 as usize, size.1 as usize);
    let mut listed = Vec::new();
    for top in (0..height).step_by(TILE) {
        for left in (0..width).step_by(TILE) {
            for y in top..height.min(top + TILE) {
                let row = y * width;
                let marks = marks.get(row + left..row + width.min(left + TILE)).unwrap_or(&[]);
                let marked = marks.iter().zip(left..).filter(|(mark, _)| **mark != 0);
                listed.extend(marked.map(|(_, x)| [x as u16, y as u16]));
            }
        }
    }
    listed
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_mark_is_listed_once_and_neighbours_stay_together() {
        let size = (21, 10);
        let mut marks = vec![0; 210];
        let marked = [(0, 0), (20, 0), (1, 7), (0, 8), (20, 9), (8, 3)];
        for (x, y) in marked {
            marks[y * 21 + x] = 255;
        }
        let listed = listed_pixels(&marks, size);
        assert_eq!(listed, [[0, 0], [1, 7], [8, 3], [20, 0], [0, 8], [20, 9]]);
        assert!(listed_pixels(&[], (0, 0)).is_empty());
    }
}
