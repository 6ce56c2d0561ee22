//! Placeholder textures and lists for warming up a program.
//!
//! A context that compiles in parallel does not share the window's objects ([`super::program::ReadyProgram`]). It uses
//! small placeholders, which have all properties of the scene's objects that drivers compile into a program. For
//! example, Mesa's software renderers compile separate variants for sides that are powers of two, and for textures with
//! a single level.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::sync::Arc;

use image::RgbaImage;

use super::error::Result;
use super::feedback;
use super::gl::Gl;
use super::object::Texture;
use super::scene_resources::{SceneLists, SceneNames};
use super::target::Target;
use super::texture;
use crate::frame::sound_tables;
use mariana_field::graph::FrameInputs;
use mariana_field::lang::TextureRef;
use mariana_field::world::World;

/// The sizes of the placeholders for a scene's textures. They have the properties that drivers compile into programs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SceneShape {
    pictures: Vec<StandIn>,
}

impl SceneShape {
    /// The shape of a world's textures.
    pub fn of(world: &World) -> Self {
        let stand_in = |(picture, texture): (&Arc<RgbaImage>, &TextureRef)| StandIn {
            size: (stand_in_side(picture.width()), stand_in_side(picture.height())),
            kind: match texture {
                texture if texture.is_last_frame() => Kind::LastFrame,
                texture if texture.moves.is_some() => Kind::Moving,
                _ => Kind::Image,
            },
        };
        Self { pictures: world.pictures.iter().zip(&world.scene.textures).map(stand_in).collect() }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
struct StandIn {
    size: (u32, u32),
    kind: Kind,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum Kind {
    Image,
    Moving,
    LastFrame,
}

fn stand_in_side(side: u32) -> u32 {
    match side {
        0 | 1 => 1,
        side if side.is_power_of_two() => 4,
        _ => 6,
    }
}

/// The placeholders of a context that warms up scenes. It has at most 19 textures: sides are 1, 4 or 6, and
/// a texture may move; and the last frame.
pub(super) struct StandIns {
    gl: Gl,
    last_frame: Option<Target>,
    pictures: HashMap<StandIn, Texture>,
    lists: SceneLists,
}

impl StandIns {
    pub(super) fn new(gl: &Gl) -> Result<Self> {
        let silence = sound_tables::texels(&FrameInputs::default());
        Ok(Self {
            gl: gl.clone(),
            last_frame: None,
            pictures: HashMap::new(),
            lists: SceneLists::new(gl, &silence)?,
        })
    }

    pub(super) fn names(&mut self, shape: &SceneShape) -> Result<SceneNames> {
        let mut pictures = Vec::with_capacity(shape.pictures.len());
        for stand_in in &shape.pictures {
            if stand_in.kind == Kind::LastFrame {
                let target = match self.last_frame.take() {
                    Some(target) => target,
                    None => feedback::black(&self.gl)?,
                };
                pictures.extend(self.last_frame.insert(target).texture());
                continue;
            }
            let texture = match self.pictures.entry(*stand_in) {
                Entry::Occupied(known) => known.into_mut(),
                Entry::Vacant(place) => {
                    let picture = RgbaImage::new(stand_in.size.0, stand_in.size.1);
                    place.insert(texture::upload(&self.gl, &picture, stand_in.kind == Kind::Moving)?)
                }
            };
            pictures.push(texture.native());
        }
        Ok(self.lists.names(pictures))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stand_ins_agree_in_the_properties_that_drivers_compile() {
        assert_eq!([1, 2, 3, 512, 640].map(stand_in_side), [1, 4, 6, 4, 6]);
    }
}
