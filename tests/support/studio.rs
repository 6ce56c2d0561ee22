//! A renderer without a window, and sound to show.

use image::RgbaImage;
use mariana::dsp::Features;
use mariana::frame::Frame;
use mariana::gpu::error::GpuError;
use mariana::gpu::headless::Headless;
use mariana::gpu::renderer::{Counting, Renderer};
use mariana::gpu::shader_source::ShaderLibrary;

/// A renderer with its context.
pub struct Studio {
    // Before the context that its objects live in.
    pub renderer: Renderer,
    pub context: Headless,
}

impl Studio {
    /// The shipped shaders.
    pub fn new() -> Self {
        Self::with(&ShaderLibrary::embedded(), Counting::Off)
    }

    /// Other shaders, or the counting variant.
    pub fn with(library: &ShaderLibrary, counting: Counting) -> Self {
        let context = Headless::new(false).unwrap();
        let renderer =
            Renderer::new(context.gl(), library, counting).unwrap_or_else(|error| panic!("{error}"));
        Self { renderer, context }
    }

    /// The finished picture of one moment.
    pub fn picture(&mut self, time: f64, features: Features, size: (u32, u32)) -> RgbaImage {
        self.try_picture(time, features, size).unwrap_or_else(|error| panic!("{size:?} at {time} s: {error}"))
    }

    /// The same, or why there is none.
    pub fn try_picture(
        &mut self,
        time: f64,
        features: Features,
        size: (u32, u32),
    ) -> Result<RgbaImage, GpuError> {
        self.renderer.draw(&Frame::new(time, features, size))?;
        let bytes = self.renderer.read();
        Ok(RgbaImage::from_raw(size.0, size.1, bytes).expect("a finished picture has four bytes a pixel"))
    }
}

/// No sound.
pub fn silence() -> Features {
    Features::default()
}

/// Loud music: much bass, less treble, a little louder on the left.
pub fn loud_music() -> Features {
    let bands = std::array::from_fn(|i| {
        let slope = 0.95 - 0.018 * i as f32;
        slope * (0.75 + 0.25 * (1.7 * i as f32).sin())
    });
    Features { volume: [0.28, 0.22], bands, ..Features::default() }
}

/// Music of medium loudness.
pub fn soft_music() -> Features {
    let loud = loud_music();
    Features { volume: loud.volume.map(|v| 0.3 * v), bands: loud.bands.map(|b| 0.6 * b), ..loud }
}
