//! What a program is warmed up with instead of a scene's own pictures and buffers.
//!
//! A context that compiles beside the window shares no object with it (see [`super::program::ReadyProgram`]), so it
//! has stand-ins of its own. They are small, but equal in everything that a driver compiles into a program: Mesa's
//! software renderers make another program for textures whose sides are powers of two, and for those of a single
//! level.

use std::collections::HashMap;

use image::RgbaImage;

use super::error::GpuError;
use super::gl::Gl;
use super::object::Texture;
use super::scene_resources::{SceneBuffers, SceneNames};
use super::texture;
use crate::frame::sound_tables;
use mariana_field::graph::FrameInputs;
use mariana_field::world::World;

/// The properties of a scene's textures that a driver compiles into programs: width and height of a stand-in for
/// each.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SceneShape {
    pictures: Vec<(u32, u32)>,
}

impl SceneShape {
    /// The shape of a world's textures.
    pub fn of(world: &World) -> Self {
        let stand_in = |(width, height): (u32, u32)| (stand_in_side(width), stand_in_side(height));
        Self { pictures: world.pictures.iter().map(|picture| stand_in(picture.dimensions())).collect() }
    }
}

/// The side of a stand-in for a picture with this side: 1, a power of two, or neither, like that side.
fn stand_in_side(side: u32) -> u32 {
    match side {
        0 | 1 => 1,
        side if side.is_power_of_two() => 4,
        _ => 6,
    }
}

/// Pictures and buffers of a context in which scenes are warmed up. They grow by one picture for each kind of size,
/// nine in all.
pub(super) struct StandIns {
    gl: Gl,
    pictures: HashMap<(u32, u32), Texture>,
    buffers: SceneBuffers,
}

impl StandIns {
    /// For the current context.
    ///
    /// # Errors
    /// The driver has no object left.
    pub(super) fn new(gl: &Gl) -> Result<Self, GpuError> {
        let silence = sound_tables::texels(&FrameInputs::default());
        Ok(Self { gl: gl.clone(), pictures: HashMap::new(), buffers: SceneBuffers::new(gl, &silence)? })
    }

    /// What stands in for a scene.
    ///
    /// # Errors
    /// The driver has no object left.
    pub(super) fn names(&mut self, shape: &SceneShape) -> Result<SceneNames, GpuError> {
        let mut pictures = Vec::with_capacity(shape.pictures.len());
        for size in &shape.pictures {
            let texture = match self.pictures.entry(*size) {
                std::collections::hash_map::Entry::Occupied(known) => known.into_mut(),
                std::collections::hash_map::Entry::Vacant(place) => {
                    place.insert(texture::upload(&self.gl, &RgbaImage::new(size.0, size.1))?)
                }
            };
            pictures.push(texture.native());
        }
        Ok(self.buffers.names(pictures))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stand_ins_are_of_the_kind_that_drivers_compile_in() {
        assert_eq!([1, 2, 3, 512, 640].map(stand_in_side), [1, 4, 6, 4, 6]);
    }
}
