//! Dims finished images and places them in windows.

use crate::gpu::error::Result;
use crate::gpu::gl::Gl;
use crate::gpu::passes::{Block, Passes};
use crate::gpu::program::{LazyProgram, unit_of};
use crate::gpu::shader_source::{ShaderLibrary, Variant};
use crate::gpu::target::{Target, Texel};
use crate::placement::{Area, Map, within};

/// The shaders of this module. Tests compile all of them.
pub const PLACING_SHADERS: [&str; 2] = ["dim.frag", "place.frag"];

pub(super) struct Placing {
    dim: LazyProgram,
    place: LazyProgram,
    block: Block,
    pub(super) gain: f32,
    /// The dimmed image; `None` at full brightness.
    pub(super) dimmed: Option<Target>,
}

impl Placing {
    pub(super) fn new(gl: &Gl, library: &ShaderLibrary) -> Result<Self> {
        let [dim, place] =
            PLACING_SHADERS.map(|name| move || LazyProgram::new(gl, library, name, &Variant::default()));
        let block = Block::new(gl, "PlaceBlock")?;
        Ok(Self { dim: dim()?, place: place()?, block, gain: 1.0, dimmed: None })
    }

    pub(super) fn dim(&mut self, passes: &Passes, finished: Option<&Target>, gain: f32) -> Result<()> {
        self.gain = gain.clamp(0.0, 1.0);
        let room = self.dimmed.take();
        let Some(finished) = finished.filter(|_| self.gain < 1.0) else { return Ok(()) };
        let room = room.filter(|room| room.size() == finished.size());
        let made = || Target::new(&passes.gl, finished.size(), &[Texel::Rgba8], None);
        let dimmed = room.map_or_else(made, Ok)?;
        passes.prepare();
        finished.bind_color(0, unit_of("picture"));
        passes.draw_with(&self.dim, &dimmed, [self.gain, 0.0])?;
        self.dimmed = Some(dimmed);
        Ok(())
    }

    /// Draws a part of an image into an area of the window's framebuffer. `map` maps window positions to the image.
    pub(super) fn place(
        &self,
        passes: &Passes,
        picture: &Target,
        window: (u32, u32),
        area: Area,
        map: &Map,
        part: Area,
    ) -> Result<()> {
        self.block.set(&numbers(map, part));
        picture.bind_color(0, unit_of("picture"));
        let [left, top, right, bottom] = area;
        let edge = |fraction: f64, side: u32| (fraction * f64::from(side)).round() as i32;
        let (from, to) = (edge(left, window.0), edge(right, window.0));
        let (low, high) = (edge(1.0 - bottom, window.1), edge(1.0 - top, window.1));
        passes.draw_in_window(&self.place, window, Some([from, low, to - from, high - low]))
    }

    /// Draws a part of an image into a target, top row first.
    pub(super) fn place_in(
        &self,
        passes: &Passes,
        picture: &Target,
        target: &Target,
        map: &Map,
        part: Area,
    ) -> Result<()> {
        // OpenGL's first row is the lowest row.
        self.block.set(&numbers(&within([0.0, 1.0, 1.0, 0.0], map), part));
        passes.prepare();
        picture.bind_color(0, unit_of("picture"));
        passes.draw_with(&self.place, target, [0.0; 2])
    }
}

/// Packs a map and the visible part for the shader. OpenGL counts positions from the bottom.
fn numbers(map: &Map, [left, top, right, bottom]: Area) -> [f32; 16] {
    let [across, down, depth] = *map;
    let down: [f64; 3] = std::array::from_fn(|i| depth[i] - down[i]);
    let upwards = |[x, y, one]: [f64; 3]| [x, -y, one + y, 0.0];
    let part = [left, 1.0 - bottom, right, 1.0 - top];
    let all = [upwards(across), upwards(down), upwards(depth), part];
    let mut numbers = [0.0; 16];
    for (number, value) in numbers.iter_mut().zip(all.as_flattened()) {
        *number = *value as f32;
    }
    numbers
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::placement::{Corners, Crop, Flip, Placement, led};

    #[test]
    fn the_shader_gets_the_same_positions_from_the_bottom() {
        let placement = Placement {
            crop: Crop::try_from([10.0, 20.0, 0.0, 5.0]).unwrap(),
            flip: Flip::Horizontal,
            corners: Corners::try_from([[0.1, 0.0], [1.0, 0.2], [0.9, 1.0], [0.0, 0.8]]).unwrap(),
        };
        let map = placement.map();
        let reported = numbers(&map, placement.part()).map(f64::from);
        for [x, y] in [[0.5, 0.5], [0.2, 0.3], [0.7, 0.9]] {
            let row =
                |at: usize| reported[4 * at] * x + reported[4 * at + 1] * (1.0 - y) + reported[4 * at + 2];
            let (u, v) = (row(0) / row(2), 1.0 - row(1) / row(2));
            let [x, y] = led(&map, [x, y]).unwrap();
            assert!((u - x).abs() < 1e-5 && (v - y).abs() < 1e-5, "{u}, {v} is not {x}, {y}");
        }
        assert_eq!(
            reported[12..].iter().map(|edge| (edge * 100.0).round()).collect::<Vec<_>>(),
            [10.0, 5.0, 100.0, 80.0]
        );
    }
}
