//! How a picture is made of the scene's light: the numbers of the shaders' `PictureBlock` (see
//! `shaders/picture_block.glsl`).

use crate::world::ToneMap;

/// Number of vec4 in the block.
pub const PICTURE_BLOCK_VECTORS: usize = 2;

/// The block of one frame.
pub type PictureBlock = [[f32; 4]; PICTURE_BLOCK_VECTORS];

/// What happens to the scene's light on its way to the screen. Every number is finite and in its range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Picture {
    /// What light is multiplied by.
    pub exposure: f32,
    /// How light becomes a colour of the screen.
    pub tone_map: ToneMap,
}

impl Default for Picture {
    fn default() -> Self {
        Self { exposure: 1.0, tone_map: ToneMap::default() }
    }
}

impl Picture {
    /// Packs it for the shaders.
    pub fn block(&self) -> PictureBlock {
        [[self.exposure, 0.0, 0.0, 0.0], [0.0; 4]]
    }
}
