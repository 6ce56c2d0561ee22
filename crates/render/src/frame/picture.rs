//! Post-processing settings of a frame: the numbers of the shaders' `PictureBlock` (see `shaders/picture_block.glsl`).

use super::camera::Camera;
use mariana_field::lang::FieldRange;
use mariana_field::world::{FrameValues, SceneFeatures, ToneMap};

/// Number of vec4 in the block.
pub const PICTURE_BLOCK_VECTORS: usize = 2;

/// The block of one frame.
pub type PictureBlock = [[f32; 4]; PICTURE_BLOCK_VECTORS];

/// Exposure, bloom, tone mapping and lens of a frame. Every number is finite and in its range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Picture {
    /// Factor applied to the light, 0..1000.
    pub exposure: f32,
    /// Fraction of the light that bloom scatters, 0..1.
    pub bloom: f32,
    /// Fraction of the light that vignetting removes in the corners, 0..1.
    pub vignette: f32,
    /// Strength of the grain in steps of 1/255, 0..16.
    pub grain: f32,
    /// Conversion of light to screen colours.
    pub tone_map: ToneMap,
    /// Fraction of the last frame's light that trails keep, 0..1.
    pub decay: f32,
    /// Radius of the blur of trails in heights of the frame.
    pub blur: f32,
    /// The lens, if the scene's lens can blur at any time.
    pub lens: Option<Lens>,
    /// True if the scene has media, which a separate pass draws.
    pub has_media: bool,
}

/// A thin lens.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lens {
    /// Radius; 0 keeps everything sharp.
    pub radius: f32,
    /// 1 / distance of the points in focus.
    pub nearness: f32,
}

impl Picture {
    /// The settings that a scene requests in a frame. Replaces NaN by the setting's default.
    pub fn of(values: &FrameValues, camera: &Camera, features: SceneFeatures) -> Self {
        let clamp = |number: f32, range: FieldRange| range.clamp(number);
        let picture = values.picture.clone().in_ranges(clamp);
        let aperture = values.camera.clone().in_ranges(clamp).aperture;
        let lens = || {
            let asked = f64::from(values.camera.focus);
            let focus = if asked.is_finite() { asked + camera.stepped_back } else { camera.to_target };
            Lens { radius: unless_nan(aperture, 0.0), nearness: 1.0 / (focus as f32).clamp(FOCUS.0, FOCUS.1) }
        };
        Self {
            exposure: unless_nan(picture.exposure, 1.0),
            bloom: unless_nan(picture.bloom, 0.0),
            vignette: unless_nan(picture.vignette, 0.0),
            grain: unless_nan(picture.grain, 1.0),
            tone_map: ToneMap::numbered(picture.tone_map).unwrap_or_default(),
            decay: unless_nan(picture.decay, 0.0),
            blur: unless_nan(picture.blur, 0.0),
            lens: features.lens.then(lens),
            has_media: features.media,
        }
    }

    /// Packs the settings for the shaders.
    pub fn block(&self) -> PictureBlock {
        let lens = self.lens.unwrap_or(Lens { radius: 0.0, nearness: 0.0 });
        [[self.exposure, self.bloom, self.vignette, self.grain], [lens.radius, lens.nearness, BLUR_MAX, 0.0]]
    }
}

/// Largest radius of a blurred point, in image heights. Larger radii are clamped, to limit the samples needed.
pub const BLUR_MAX: f32 = 0.04;
const FOCUS: (f32, f32) = (1e-3, 1e7);

fn unless_nan(value: f32, otherwise: f32) -> f32 {
    if value.is_nan() { otherwise } else { value }
}

#[cfg(test)]
mod tests {
    use crate::frame::Frame;
    use crate::frame::testing::world_of;
    use mariana_field::world::ToneMap;
    use mariana_music::Features;

    #[test]
    fn a_picture_is_as_the_scene_says_within_its_ranges() {
        let picture = |text: &str| {
            let world = world_of(&format!("length(p) - 1\n{text}"));
            Frame::new(&world, 2.0, Features::default(), (8, 8)).picture
        };
        let base = picture("");
        assert_eq!((base.exposure, base.bloom, base.vignette, base.grain), (1.0, 0.04, 0.0, 1.0));
        assert_eq!((base.tone_map, base.lens), (ToneMap::Agx, None));

        let all = picture("picture { exposure = t  bloom = 9  vignette = -t  grain = 1e9  tone_map = aces }");
        assert_eq!((all.exposure, all.bloom, all.vignette, all.grain), (2.0, 1.0, 0.0, 16.0));
        assert_eq!(all.tone_map, ToneMap::Aces);

        // The difference of two infinities is NaN.
        let nan = "exp(99 * t) - exp(98 * t)";
        let none = picture(&format!("picture {{ exposure = {nan}  bloom = {nan}  grain = {nan} }}"));
        assert_eq!((none.exposure, none.bloom, none.grain), (1.0, 0.0, 1.0));

        let lens = |camera: &str| picture(camera).lens.expect("a lens");
        let eye = "position = vec3(0, 0, -4) target = vec3(0, 0, 1)";
        let to_target = lens(&format!("camera {{ {eye} aperture = 0.1 }}"));
        assert!((to_target.radius - 0.1).abs() < 1e-6 && (to_target.nearness - 0.2).abs() < 1e-6);
        let focused = lens(&format!("camera {{ {eye} aperture = {nan} focus = t }}"));
        assert_eq!((focused.radius, focused.nearness), (0.0, 0.5));
        assert!(lens(&format!("camera {{ {eye} aperture = 1 focus = 0 }}")).nearness <= 1001.0);
    }
}
