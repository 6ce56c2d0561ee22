//! What happens to a finished picture on its way to screens: a share of its light is taken away, and it is put where it
//! lies in a window.
//!
//! A picture that keeps all of its light and fills its window is copied as it is, byte for byte ([`Renderer::show`]).

use super::{LazyProgram, Renderer, Target, Texel};
use crate::gpu::error::GpuError;
use crate::gpu::gl::Gl;
use crate::gpu::picture_reader::PictureReader;
use crate::gpu::post::Block;
use crate::gpu::program::unit_of;
use crate::gpu::shader_source::{ShaderLibrary, Variant};
use crate::placement::{Area, Map, WHOLE, within};

/// The shaders of this module; tests compile them all.
pub const PLACING_SHADERS: [&str; 2] = ["dim.frag", "place.frag"];

/// See the module.
pub(super) struct Placing {
    dim: LazyProgram,
    place: LazyProgram,
    block: Block,
    /// The share of the light that is left, 0..1.
    gain: f32,
    /// The finished picture with that share.
    pub(super) dimmed: Option<Target>,
    /// Whether [`Renderer`]'s copy without flashes is of what shows now.
    has_copy: bool,
}

impl Placing {
    /// Assembles the shaders.
    ///
    /// # Errors
    /// Missing shader files, or no object left.
    pub(super) fn new(gl: &Gl, library: &ShaderLibrary) -> Result<Self, GpuError> {
        let [dim, place] =
            PLACING_SHADERS.map(|name| move || LazyProgram::new(gl, library, name, &Variant::default()));
        Ok(Self {
            dim: dim()?,
            place: place()?,
            block: Block::new(gl, "PlaceBlock")?,
            gain: 1.0,
            dimmed: None,
            has_copy: false,
        })
    }

    /// The finished picture with less light, if it has less.
    pub(super) fn dimmed(&self) -> Option<&Target> {
        self.dimmed.as_ref()
    }

    /// What shows is no longer what was copied.
    pub(super) fn forget_copy(&mut self) {
        self.has_copy = false;
    }
}

impl Renderer {
    /// Width and height of the picture that shows, in pixels.
    pub fn shape(&self) -> Option<(u32, u32)> {
        self.finished().map(Target::size)
    }

    /// The share of the light that the picture which shows has left, 0..1.
    pub fn gain(&self) -> f32 {
        self.placing.as_ref().map_or(1.0, |placing| placing.gain)
    }

    /// Leaves the picture that was finished last this share of its light, 0..1. It is to be called for each picture,
    /// before its flashes are limited: they are those of what shows. Only a renderer does it that was told to
    /// ([`Renderer::add_dimming`]).
    ///
    /// # Errors
    /// No room for a copy of the picture.
    pub fn dim(&mut self, gain: f32) -> Result<(), GpuError> {
        let Some(mut placing) = self.placing.take() else { return Ok(()) };
        placing.gain = gain.clamp(0.0, 1.0);
        placing.has_copy = false;
        let old = placing.dimmed.take();
        let dimmed = self.dimmed(&placing, old).map(|dimmed| placing.dimmed = dimmed);
        self.placing = Some(placing);
        dimmed?;
        self.gl.check("dimming a picture")
    }

    /// The finished picture with the share of its light, in `room` if it has the same size; none if it keeps all.
    fn dimmed(&self, placing: &Placing, room: Option<Target>) -> Result<Option<Target>, GpuError> {
        let Some(finished) = self.finished().filter(|_| placing.gain < 1.0) else { return Ok(None) };
        let dimmed = match room.filter(|room| room.size() == finished.size()) {
            Some(room) => room,
            None => Target::new(&self.gl, finished.size(), &[Texel::Rgba8], None)?,
        };
        self.prepare_passes();
        finished.bind_color(0, unit_of("picture"));
        self.post.passes().draw_with(&placing.dim, &dimmed, [placing.gain, 0.0])?;
        Ok(Some(dimmed))
    }

    /// Copies the picture to the window's framebuffer of `window` pixels, where `map` says: from places in the window to
    /// places in the picture, both to the right and down as shares. `part` of the picture shows, and black around it.
    ///
    /// # Errors
    /// An error that the driver reports, or no room for a copy without flashes.
    pub fn show_placed(&mut self, window: (u32, u32), map: &Map, part: Area) -> Result<(), GpuError> {
        self.show_in_part(window, WHOLE, map, part)
    }

    /// The same in `area` of the window alone; the rest of it stays as it is.
    ///
    /// # Errors
    /// As [`Renderer::show_placed`].
    pub fn show_in_part(
        &mut self,
        window: (u32, u32),
        [left, top, right, bottom]: Area,
        map: &Map,
        part: Area,
    ) -> Result<(), GpuError> {
        self.copy_without_flashes()?;
        let (Some(picture), Some(placing)) = (self.as_shown(), &self.placing) else { return Ok(()) };
        placing.block.set(&numbers(map, part));
        self.prepare_passes();
        picture.bind_color(0, unit_of("picture"));
        let edge = |share: f64, side: u32| (share * f64::from(side)).round() as i32;
        let (from, to) = (edge(left, window.0), edge(right, window.0));
        let (low, high) = (edge(1.0 - bottom, window.1), edge(1.0 - top, window.1));
        let area = [from, low, to - from, high - low];
        self.post.passes().draw_in_window(&placing.place, window, Some(area))?;
        self.gl.check("showing a frame")
    }

    /// Sends the picture on its way to whoever reads it, as [`Renderer::show_placed`] puts it into a window of the
    /// reader's size, the top row first. False if it was left out, because too many are on their way.
    ///
    /// # Errors
    /// As [`Renderer::show_placed`].
    pub fn send_placed(
        &mut self,
        reader: &mut PictureReader,
        map: &Map,
        part: Area,
    ) -> Result<bool, GpuError> {
        self.copy_without_flashes()?;
        let (Some(picture), Some(placing)) = (self.as_shown(), &self.placing) else { return Ok(false) };
        // OpenGL's first row is the lowest one.
        let over = within([0.0, 1.0, 1.0, 0.0], map);
        placing.block.set(&numbers(&over, part));
        self.prepare_passes();
        picture.bind_color(0, unit_of("picture"));
        self.post.passes().draw_with(&placing.place, reader.target(), [0.0; 2])?;
        let begun = reader.begin();
        self.gl.check("sending a picture").map(|()| begun)
    }

    /// The picture as screens show it, once its flashes are limited in a copy.
    fn as_shown(&self) -> Option<&Target> {
        let limited = self.limited.as_ref().filter(|_| self.is_limited && self.flashes.is_some());
        limited.or(self.bright_as_shown())
    }

    /// The picture with the share of its light that is left, whatever flashes in it.
    pub(super) fn bright_as_shown(&self) -> Option<&Target> {
        self.placing.as_ref().and_then(Placing::dimmed).or(self.finished())
    }

    /// Whether the copy in which flashes are limited is of what shows. Without a window it always is.
    pub(super) fn is_copied(&self) -> bool {
        self.upscale.is_none() || self.placing.as_ref().is_none_or(|placing| placing.has_copy)
    }

    /// Makes the copy of what shows in which flashes are limited, if there is none and they are limited.
    fn copy_without_flashes(&mut self) -> Result<(), GpuError> {
        if self.is_copied() || !self.is_limited {
            return Ok(());
        }
        let room = self.limited.take();
        let (Some(flashes), Some(picture)) = (&self.flashes, self.bright_as_shown()) else { return Ok(()) };
        let copy = match room.filter(|copy| copy.size() == picture.size()) {
            Some(copy) => copy,
            None => Target::new(&self.gl, picture.size(), &[Texel::Rgba8], None)?,
        };
        picture.blit_to(&copy);
        flashes.limit(picture, &copy);
        self.limited = Some(copy);
        if let Some(placing) = &mut self.placing {
            placing.has_copy = true;
        }
        Ok(())
    }
}

/// What the shader is told of a map and of the part that shows: OpenGL counts places from the bottom.
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
    fn the_shader_is_told_the_same_places_from_the_bottom() {
        let placement = Placement {
            crop: Crop::try_from([10.0, 20.0, 0.0, 5.0]).unwrap(),
            flip: Flip::Horizontal,
            corners: Corners::try_from([[0.1, 0.0], [1.0, 0.2], [0.9, 1.0], [0.0, 0.8]]).unwrap(),
        };
        let map = placement.map();
        let told = numbers(&map, placement.part()).map(f64::from);
        for [x, y] in [[0.5, 0.5], [0.2, 0.3], [0.7, 0.9]] {
            let row = |at: usize| told[4 * at] * x + told[4 * at + 1] * (1.0 - y) + told[4 * at + 2];
            let (u, v) = (row(0) / row(2), 1.0 - row(1) / row(2));
            let [x, y] = led(&map, [x, y]).unwrap();
            assert!((u - x).abs() < 1e-5 && (v - y).abs() < 1e-5, "{u}, {v} is not {x}, {y}");
        }
        assert_eq!(
            told[12..].iter().map(|edge| (edge * 100.0).round()).collect::<Vec<_>>(),
            [10.0, 5.0, 100.0, 80.0]
        );
    }
}
