//! Transparent images of a scene without its sky, for compositing.
//!
//! Bytes are premultiplied until the file is written: laid over black, they give the image with a black sky. Alpha is
//! the fraction of the pixel that objects cover. Where a glow reaches beyond the objects, alpha is the largest colour
//! channel, because a smaller alpha could not store the glow.

use super::error::{ExportError, refuse};
use crate::frame::Frame;
use crate::frame::picture::Picture;
use crate::gpu::{Program, Renderer, SceneResources};
use crate::scenes::ReadyScene;

/// `sample_light.glsl` gives bright samples less weight. At this low exposure, all samples have almost equal weight.
const EXPOSURE: f32 = 0.01;

pub(super) fn require_no_sky(ready: &ReadyScene, scene: &str) -> Result<(), ExportError> {
    match ready.world.scene.has_own_sky {
        true => refuse(format!(
            "--alpha leaves out the sky, but the scene {scene} draws its own: remove the `color` of its `sky`"
        )),
        false => Ok(()),
    }
}

#[derive(Default)]
pub(super) struct Coverage {
    /// The covered fraction of each pixel in the last frame, 0..1.
    fractions: Vec<f32>,
}

impl Coverage {
    /// Draws the coverage of `frame` with a program of [`crate::gpu::scene_program::as_coverage`] and stores the
    /// result. Turns off grain in `frame`, because grain should cover the whole composed image.
    pub(super) fn draw(
        &mut self,
        renderer: &mut Renderer,
        frame: &mut Frame,
        resources: &SceneResources,
        program: &Program,
    ) -> Result<(), ExportError> {
        frame.picture.grain = 0.0;
        let mut covering = frame.clone();
        covering.picture =
            Picture { exposure: EXPOSURE, bloom: 0.0, vignette: 0.0, decay: 0.0, ..frame.picture };
        renderer.draw(&covering, resources, program)?;
        let light = renderer.read_light()?;
        self.fractions = light.as_chunks::<4>().0.iter().map(|[fraction, ..]| fraction / EXPOSURE).collect();
        Ok(())
    }

    pub(super) fn put_into(&self, rgba: &mut [u8]) {
        for ([r, g, b, alpha], fraction) in rgba.as_chunks_mut::<4>().0.iter_mut().zip(&self.fractions) {
            let covered = (255.0 * fraction.clamp(0.0, 1.0)).round() as u8;
            *alpha = covered.max(*r).max(*g).max(*b);
        }
    }
}

/// Converts premultiplied colours to straight colours, which image files store.
pub(super) fn straight(premultiplied: &[u8]) -> Vec<u8> {
    let of = |[r, g, b, alpha]: [u8; 4]| {
        let (half, whole) = (u32::from(alpha) / 2, u32::from(alpha).max(1));
        let color = |byte: u8| ((u32::from(byte) * 255 + half) / whole).min(255) as u8;
        [color(r), color(g), color(b), alpha]
    };
    premultiplied.as_chunks::<4>().0.iter().flat_map(|pixel| of(*pixel)).collect()
}

#[cfg(test)]
mod tests {
    use super::straight;

    #[test]
    fn straight_colours_over_black_are_what_they_were() {
        for alpha in 0..=255_u8 {
            for color in 0..=alpha {
                let [straight, _, _, kept] = straight(&[color, 0, 0, alpha])[..] else { unreachable!() };
                let over_black = f64::from(straight) * f64::from(kept) / 255.0;
                assert!((over_black - f64::from(color)).abs() <= 0.5, "{color} of {alpha}: {over_black}");
            }
        }
        assert_eq!(straight(&[7, 8, 9, 255]), [7, 8, 9, 255]);
    }
}
