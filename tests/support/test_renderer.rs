//! A headless renderer with a scene, and audio features for its frames.

use std::sync::Arc;

use image::RgbaImage;
use mariana::frame::Frame;
use mariana::frame::picture::Picture;
use mariana::frame::projection::Stereo;
use mariana::gpu::api::Api;
use mariana::gpu::error::GpuError;
use mariana::gpu::gl::GlInfo;
use mariana::gpu::headless::Headless;
use mariana::gpu::program::Program;
use mariana::gpu::renderer::{Counting, Renderer};
use mariana::gpu::scene_program::{Mode, link_scene, variant_of};
use mariana::gpu::scene_resources::SceneResources;
use mariana::gpu::shader_source::{ShaderLibrary, Variant};
use mariana::scenes::{ReadyScene, SceneSource};
use mariana_field::world::World;
use mariana_music::{Features, HISTORY_POINTS, SPECTRUM_POINTS, Sound, Tables, WAVEFORM_POINTS};

/// The speakers of the thesis. [`super::oracle`] contains the same scene, written by hand in GLSL.
pub(crate) fn speakers() -> SceneSource {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/oracle/speakers.scene");
    SceneSource::find(path).unwrap()
}

pub(crate) fn ready(scene: &SceneSource) -> ReadyScene {
    scene.ready().unwrap_or_else(|error| panic!("{}: {error}", scene.name()))
}

/// An imaginary driver of OpenGL whose limits are the minimum limits of OpenGL 3.3.
pub(crate) fn driver(software: bool) -> GlInfo {
    driver_of(Api::Desktop, software)
}

pub(crate) fn driver_of(api: Api, software: bool) -> GlInfo {
    GlInfo {
        api,
        vendor: String::new(),
        renderer: String::new(),
        version: String::new(),
        shading_language: String::new(),
        texture_side_max: 1024,
        list_texels_max: 65_536,
        anisotropy_max: 1.0,
        program_binaries: false,
        tells_completion: false,
        software,
    }
}

pub(crate) struct TestRenderer {
    // Field order matters: these fields are dropped before their context.
    pub renderer: Renderer,
    pub program: Program,
    pub resources: SceneResources,
    /// Changes the settings of the frame's `picture` block, such as its exposure.
    pub adjust: fn(&mut Picture),
    /// The number of images so far.
    drawn: u64,
    pub context: Headless,
}

impl TestRenderer {
    pub(crate) fn new() -> Self {
        Self::of(&speakers(), Mode::Compiled, Counting::Off)
    }

    /// Creates a renderer for `scene` in `mode`. With [`Counting::On`], the program counts evaluations.
    pub(crate) fn of(scene: &SceneSource, mode: Mode, counting: Counting) -> Self {
        Self::of_ready(ready(scene), mode, counting)
    }

    pub(crate) fn of_ready(scene: ReadyScene, mode: Mode, counting: Counting) -> Self {
        Self::in_context(Headless::new(false).unwrap(), scene, mode, counting)
    }

    pub(crate) fn in_context(context: Headless, scene: ReadyScene, mode: Mode, counting: Counting) -> Self {
        let ReadyScene { world, buffers, plan, .. } = scene;
        let gl = context.gl();
        let renderer =
            Renderer::new(gl, &ShaderLibrary::embedded(), counting).unwrap_or_else(|error| panic!("{error}"));
        let variant = variant_of(&world, &buffers, &plan, mode, gl.info(), counting)
            .unwrap_or_else(|error| panic!("{}, {mode}: {error}", world.name));
        let program = link(&context, &ShaderLibrary::embedded(), &variant);
        let resources = SceneResources::upload(gl, None, world, buffers, plan).unwrap();
        Self { renderer, program, resources, adjust: |_| {}, drawn: 0, context }
    }

    pub(crate) fn program_of(&self, mode: Mode, counting: Counting) -> Program {
        let (world, buffers, plan) = (self.world(), self.resources.buffers(), self.resources.plan());
        let variant = variant_of(world, buffers, plan, mode, self.context.gl().info(), counting)
            .unwrap_or_else(|error| panic!("{}, {mode}: {error}", world.name));
        self.link(&ShaderLibrary::embedded(), &variant)
    }

    pub(crate) fn link(&self, library: &ShaderLibrary, variant: &Variant) -> Program {
        link(&self.context, library, variant)
    }

    pub(crate) fn world(&self) -> &World {
        self.resources.world()
    }

    pub(crate) fn frame(&self, time: f64, sound: impl Into<Sound>, size: (u32, u32)) -> Frame {
        let mut frame = Frame::new(self.world(), time, sound, size);
        (self.adjust)(&mut frame.picture);
        frame
    }

    /// Draws the frame at `time` seconds.
    pub(crate) fn picture(&mut self, time: f64, sound: impl Into<Sound>, size: (u32, u32)) -> RgbaImage {
        self.try_picture(time, sound, size).unwrap_or_else(|error| panic!("{size:?} at {time} s: {error}"))
    }

    pub(crate) fn try_picture(
        &mut self,
        time: f64,
        sound: impl Into<Sound>,
        size: (u32, u32),
    ) -> Result<RgbaImage, GpuError> {
        let sound = sound.into();
        self.feed_back(time, &sound, size)?;
        let frame = self.frame(time, sound, size);
        self.of_frame(&frame)
    }

    /// Draws the frames of feedback before a moment, as if its sound had lasted for ever.
    fn feed_back(&mut self, time: f64, sound: &Sound, size: (u32, u32)) -> Result<(), GpuError> {
        // Another sound is another song.
        self.drawn += 1;
        while let Some(request) =
            self.renderer.feedback_before(&self.resources, self.drawn, time, (size, Stereo::None), false)
        {
            let mut frame = self.frame(request.time, sound.clone(), size);
            frame.size = request.size;
            self.renderer.draw_feedback(&request, &frame, &self.resources, &self.program)?;
        }
        self.renderer.show_feedback(&self.resources, time)
    }

    pub(crate) fn of_frame(&mut self, frame: &Frame) -> Result<RgbaImage, GpuError> {
        self.renderer.draw(frame, &self.resources, &self.program)?;
        let (bytes, (width, height)) = (self.renderer.read(), frame.size);
        Ok(RgbaImage::from_raw(width, height, bytes).expect("a finished image has four bytes per pixel"))
    }
}

fn link(context: &Headless, library: &ShaderLibrary, variant: &Variant) -> Program {
    link_scene(context.gl(), library, variant).unwrap_or_else(|error| panic!("{error}"))
}

pub(crate) fn silence() -> Features {
    Features::default()
}

/// Loud music with much bass and less treble, a little louder on the left.
pub(crate) fn loud_music() -> Features {
    let bands = std::array::from_fn(|i| {
        let slope = 0.95 - 0.018 * i as f32;
        slope * (0.75 + 0.25 * (1.7 * i as f32).sin())
    });
    let (bass, mid, treble) = (0.8, 0.55, 0.3);
    let rhythm = Features { beat: 0.6, tempo: 120.0, phase: 0.3, bass_drive: 2.5, ..Features::default() };
    let volumes = Features { volume: [0.28, 0.22], volume_mid: 0.25, volume_side: 0.06, ..rhythm };
    Features { bands, bass, mid, treble, peak_hz: 110.0, ..volumes }
}

/// Loud music with curves: a hilly, drifting spectrum and a waveform.
pub(crate) fn loud_sound() -> Sound {
    let points = |count: usize, of: &dyn Fn(f32) -> f32| -> Arc<[f32]> {
        (0..count).map(|index| of(index as f32 / (count - 1) as f32)).collect()
    };
    let height = |u: f32, row: f32| (0.8 - 0.5 * u) * (0.6 + 0.4 * (25.0 * u + 0.21 * row).sin());
    let rows = (0..240).flat_map(|row| {
        (0..HISTORY_POINTS).map(move |column| height(column as f32 / (HISTORY_POINTS - 1) as f32, row as f32))
    });
    let tables = Tables {
        spectrum: Some(points(SPECTRUM_POINTS, &|u| height(u, 0.4))),
        waveform: Some(points(WAVEFORM_POINTS, &|u| 0.7 * (19.0 * u).sin() - 0.2 * (83.0 * u).cos())),
        history: Some(rows.collect()),
        history_offset: 1.4,
        history_span: 234.375,
    };
    Sound { features: loud_music(), tables, ..Sound::default() }
}

pub(crate) fn soft_music() -> Features {
    let loud = loud_music();
    Features { volume: loud.volume.map(|v| 0.3 * v), bands: loud.bands.map(|b| 0.6 * b), ..loud }
}
