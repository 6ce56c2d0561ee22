//! A frame as the numbers of the shaders' `FrameBlock` (std140: all members are vec4, see
//! `shaders/frame_block.glsl`).

use super::Frame;
use crate::dsp::BAND_COUNT;

/// Number of vec4 in the block.
pub const FRAME_BLOCK_VECTORS: usize = 6 + BAND_COUNT / 4;

/// The block of one frame.
pub type FrameBlock = [[f32; 4]; FRAME_BLOCK_VECTORS];

impl Frame {
    /// Packs the frame for the shaders. Every number is finite.
    pub fn block(&self) -> FrameBlock {
        let (width, height) = (f64::from(self.size.0), f64::from(self.size.1));
        let camera = &self.camera;
        let (right, up) = (camera.right * camera.tan_half.0, camera.up * camera.tan_half.1);
        // Half the width of a pixel at distance 1: the radius of its cone.
        let pixel_radius = camera.tan_half.1 / height;
        let volume = self.features.volume;
        let mut block = [[0.0; 4]; FRAME_BLOCK_VECTORS];
        let head = [
            [width, height, 1.0 / width, 1.0 / height],
            [camera.position.x, camera.position.y, camera.position.z, pixel_radius],
            [right.x, right.y, right.z, self.time],
            [up.x, up.y, up.z, 0.0],
            [camera.forward.x, camera.forward.y, camera.forward.z, 0.0],
            [f64::from(volume[0]), f64::from(volume[1]), 0.0, 0.0],
        ];
        for (to, from) in block.iter_mut().zip(head) {
            *to = from.map(|value| finite(value as f32));
        }
        let (_, bands) = block.split_at_mut(head.len());
        for (to, from) in bands.as_flattened_mut().iter_mut().zip(self.features.bands) {
            *to = finite(from);
        }
        block
    }
}

/// Nothing non-finite reaches a shader.
fn finite(value: f32) -> f32 {
    if value.is_finite() { value } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dsp::Features;

    #[test]
    fn bands_and_volumes_arrive_in_order_and_nothing_is_non_finite() {
        let mut features = Features::default();
        for (index, band) in features.bands.iter_mut().enumerate() {
            *band = index as f32 / 32.0;
        }
        features.bands[7] = f32::NAN;
        features.volume = [0.25, f32::INFINITY];
        let block = Frame::new(f64::NAN, features, (0, 7)).block();
        assert!(block.as_flattened().iter().all(|value| value.is_finite()));
        assert_eq!(block[5], [0.25, 0.0, 0.0, 0.0]);
        assert_eq!(block[6], [0.0, 1.0 / 32.0, 2.0 / 32.0, 3.0 / 32.0]);
        assert_eq!(block[7][3], 0.0);
        assert_eq!(block[FRAME_BLOCK_VECTORS - 1][3], 31.0 / 32.0);
        assert_eq!(block[0], [1.0, 7.0, 1.0, 1.0 / 7.0]);
    }
}
