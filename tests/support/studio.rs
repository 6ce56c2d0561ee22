//! A renderer without a window, a scene on it, and sound to show.

use image::RgbaImage;
use mariana::dsp::Features;
use mariana::frame::Frame;
use mariana::gpu::error::GpuError;
use mariana::gpu::gl::GlInfo;
use mariana::gpu::headless::Headless;
use mariana::gpu::program::Program;
use mariana::gpu::renderer::{Counting, Renderer};
use mariana::gpu::scene_program::{Mode, link_scene, variant_of};
use mariana::gpu::scene_resources::SceneResources;
use mariana::gpu::shader_source::{ShaderLibrary, Variant};
use mariana::scenes::{ReadyScene, SceneSource};
use mariana::world::World;

/// The scene that is shown without being told otherwise.
pub fn speakers() -> SceneSource {
    SceneSource::Shipped("speakers".into())
}

/// A scene ready to be drawn; fails with what is wrong with it.
pub fn ready(scene: &SceneSource) -> ReadyScene {
    scene.ready().unwrap_or_else(|error| panic!("{}: {error}", scene.name()))
}

/// A driver that nobody has, with no more than OpenGL 3.3 promises.
pub fn driver(software: bool) -> GlInfo {
    GlInfo {
        vendor: String::new(),
        renderer: String::new(),
        version: String::new(),
        shading_language: String::new(),
        texture_side_max: 1024,
        texture_buffer_texels_max: 65_536,
        anisotropy_max: 1.0,
        software,
    }
}

/// A renderer with its context, a scene, and a program that draws it.
pub struct Studio {
    // Before the context that their objects live in.
    pub renderer: Renderer,
    pub program: Program,
    pub resources: SceneResources,
    pub context: Headless,
}

impl Studio {
    /// The shipped speakers, compiled.
    pub fn new() -> Self {
        Self::of(&speakers(), Mode::Compiled, Counting::Off)
    }

    /// Another scene and mode, or the counting variant.
    pub fn of(scene: &SceneSource, mode: Mode, counting: Counting) -> Self {
        let ReadyScene { world, buffers, plan } = ready(scene);
        let context = Headless::new(false).unwrap();
        let gl = context.gl();
        let renderer =
            Renderer::new(gl, &ShaderLibrary::embedded(), counting).unwrap_or_else(|error| panic!("{error}"));
        let variant = variant_of(&world, &buffers, &plan, mode, gl.info(), counting)
            .unwrap_or_else(|error| panic!("{}, {mode}: {error}", scene.name()));
        let program = link(&context, &ShaderLibrary::embedded(), &variant);
        let resources = SceneResources::upload(gl, world, buffers, plan).unwrap();
        Self { renderer, program, resources, context }
    }

    /// The program of the scene in a mode, for [`Studio::program`].
    pub fn program_of(&self, mode: Mode, counting: Counting) -> Program {
        let (world, buffers, plan) = (self.world(), self.resources.buffers(), self.resources.plan());
        let variant = variant_of(world, buffers, plan, mode, self.context.gl().info(), counting)
            .unwrap_or_else(|error| panic!("{}, {mode}: {error}", world.name));
        self.link(&ShaderLibrary::embedded(), &variant)
    }

    /// A program in the studio's context.
    pub fn link(&self, library: &ShaderLibrary, variant: &Variant) -> Program {
        link(&self.context, library, variant)
    }

    /// The scene.
    pub fn world(&self) -> &World {
        self.resources.world()
    }

    /// The frame of one moment.
    pub fn frame(&self, time: f64, features: Features, size: (u32, u32)) -> Frame {
        Frame::new(self.world(), time, features, size)
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
        let frame = self.frame(time, features, size);
        self.renderer.draw(&frame, &self.resources, &self.program)?;
        let bytes = self.renderer.read();
        Ok(RgbaImage::from_raw(size.0, size.1, bytes).expect("a finished picture has four bytes a pixel"))
    }
}

fn link(context: &Headless, library: &ShaderLibrary, variant: &Variant) -> Program {
    link_scene(context.gl(), library, variant).unwrap_or_else(|error| panic!("{error}"))
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
