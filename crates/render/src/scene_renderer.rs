//! [`SceneRenderer`]: the simplest way to draw a world.

use std::sync::Arc;

use crate::frame::Frame;
use crate::gpu::error::Result;
use crate::gpu::gl::Gl;
use crate::gpu::mode::CellUse;
use crate::gpu::program::Program;
use crate::gpu::renderer::{Counting, Renderer};
use crate::gpu::scene_program::{Mode, drawing_variant_of, link_scene};
use crate::gpu::scene_resources::SceneResources;
use crate::gpu::shader_source::ShaderLibrary;
use mariana_field::region::RegionPlan;
use mariana_field::world::World;
use mariana_music::Sound;

/// Draws one world in one OpenGL context. The context must be current on this thread at every call and outlive this
/// object.
pub struct SceneRenderer {
    renderer: Renderer,
    program: Program,
    resources: SceneResources,
}

impl SceneRenderer {
    /// Uploads a world and compiles its program. Compiling takes tens of milliseconds to several seconds.
    ///
    /// # Errors
    /// Fails if the world exceeds its limits, or with an error of the driver.
    pub fn new(gl: &Gl, world: World) -> Result<Self> {
        let library = ShaderLibrary::embedded();
        let world = Arc::new(world);
        let (buffers, plan) = (Arc::new(world.tape_buffers()), Arc::new(RegionPlan::new(&world)));
        let (mode, cells) = (Mode::Compiled, CellUse::default());
        let variant = drawing_variant_of(&world, &buffers, &plan, mode, cells, gl.info())?;
        let program = link_scene(gl, &library, &variant)?;
        let resources = SceneResources::upload(gl, None, world, buffers, plan)?;
        resources.set_cells(resources.uses_cells(cells, mode), mode);
        Ok(Self { renderer: Renderer::new(gl, &library, Counting::Off)?, program, resources })
    }

    /// Draws an image of `size` pixels: the world at `time` seconds, with the sound that is audible at `time`.
    ///
    /// # Errors
    /// Fails if the size exceeds the driver's limit, or with an error of the driver.
    pub fn draw(&mut self, time: f64, sound: impl Into<Sound>, size: (u32, u32)) -> Result<()> {
        let frame = Frame::new(self.resources.world(), time, sound, size);
        self.draw_frame(&frame)
    }

    /// Draws `frame`. Before the call you can change its inputs, such as camera and parameters.
    ///
    /// # Errors
    /// Same errors as [`SceneRenderer::draw`].
    pub fn draw_frame(&mut self, frame: &Frame) -> Result<()> {
        self.renderer.draw(frame, &self.resources, &self.program)
    }

    /// Copies the image to the default framebuffer of `window` pixels.
    ///
    /// # Errors
    /// Fails with an error of the driver.
    pub fn show(&self, window: (u32, u32)) -> Result<()> {
        self.renderer.show(window)
    }

    /// The image: four bytes of sRGB and alpha per pixel, top row first. Empty before the first draw.
    pub fn read(&self) -> Vec<u8> {
        self.renderer.read()
    }

    /// The world that is drawn.
    pub fn world(&self) -> &World {
        self.resources.world()
    }

    /// The renderer, which can also limit flashes, fade between images, and place images on a screen.
    pub fn renderer(&mut self) -> &mut Renderer {
        &mut self.renderer
    }
}
