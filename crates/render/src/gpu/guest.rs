//! Lets another library draw in our context, into the window's framebuffer, and restores our state afterwards.

#![expect(unsafe_code, reason = "every OpenGL call is unsafe in glow")]

use glow::HasContext;

use super::error::Result;
use super::gl::Gl;

/// The capabilities that another library may leave on.
const SWITCHES: [u32; 5] =
    [glow::BLEND, glow::CULL_FACE, glow::DEPTH_TEST, glow::SCISSOR_TEST, glow::STENCIL_TEST];

impl Gl {
    /// Lets `draws` draw over the window's framebuffer, then restores OpenGL's defaults, with conversion to sRGB off.
    ///
    /// # Errors
    /// Fails if the driver reports an error, caused by `draws` or by earlier calls.
    pub fn lend_window<T>(&self, doing: &'static str, draws: impl FnOnce() -> T) -> Result<T> {
        // SAFETY: binds the window's framebuffer, or its replacement, which outlives its use ([`Gl::replace_window`]).
        unsafe { self.bind_framebuffer(glow::FRAMEBUFFER, self.window()) };
        let drawn = draws();
        self.reset_state();
        self.check(doing)?;
        Ok(drawn)
    }

    /// Fills the window's framebuffer of `size` pixels with an sRGB colour, 0..1.
    ///
    /// # Errors
    /// Fails if the driver reports an error.
    pub fn clear_window(&self, size: (u32, u32), [red, green, blue]: [f32; 3]) -> Result<()> {
        self.lend_window("clearing the window", || {
            // SAFETY: sets state and clears the bound framebuffer of the current context.
            unsafe {
                self.viewport(0, 0, size.0.cast_signed(), size.1.cast_signed());
                self.clear_color(red, green, blue, 1.0);
                self.clear(glow::COLOR_BUFFER_BIT);
            }
        })
    }

    fn reset_state(&self) {
        // SAFETY: sets state of the current context; binds no object that could be deleted.
        unsafe {
            for switch in SWITCHES {
                self.disable(switch);
            }
            self.store_colors_unchanged();
            self.blend_equation(glow::FUNC_ADD);
            self.blend_func(glow::ONE, glow::ZERO);
            self.color_mask(true, true, true, true);
            self.pixel_store_i32(glow::UNPACK_ALIGNMENT, 4);
            // The renderer binds its textures for each draw.
            self.active_texture(glow::TEXTURE0);
            self.bind_texture(glow::TEXTURE_2D, None);
            self.bind_vertex_array(None);
            self.bind_buffer(glow::ARRAY_BUFFER, None);
            self.bind_framebuffer(glow::FRAMEBUFFER, self.window());
            self.use_program(None);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::frame::Frame;
    use crate::frame::testing::{SPEAKERS, world_of};
    use crate::gpu::headless::Headless;
    use crate::gpu::object::{Buffer, Texture, VertexArray};
    use crate::gpu::renderer::{Counting, Renderer};
    use crate::gpu::scene_program::{Mode, link_scene, variant_of};
    use crate::gpu::scene_resources::SceneResources;
    use crate::gpu::shader_source::ShaderLibrary;

    #[test]
    fn a_guest_that_changes_all_state_does_not_change_the_image() {
        let context = Headless::new(false).unwrap();
        let gl = context.gl();
        let library = ShaderLibrary::embedded();
        let world = Arc::new(world_of(SPEAKERS));
        let buffers = Arc::new(world.tape_buffers());
        let plan = Arc::new(mariana_field::region::RegionPlan::new(&world));
        let variant = variant_of(&world, &buffers, &plan, Mode::Compiled, gl.info(), Counting::Off).unwrap();
        let program = link_scene(gl, &library, &variant).unwrap();
        let mut renderer = Renderer::new(gl, &library, Counting::Off).unwrap();
        let frame = Frame::new(&world, 1.0, crate::frame::Sound::default(), (64, 36));
        let scene = SceneResources::upload(gl, None, world, buffers, plan).unwrap();
        renderer.draw(&frame, &scene, &program).unwrap();
        let before = renderer.read();
        let (texture, buffer) = (Texture::new(gl).unwrap(), Buffer::new(gl).unwrap());
        let vertices = VertexArray::new(gl).unwrap();
        // SAFETY: sets state of the current context; the names belong to this test.
        gl.lend_window("testing", || unsafe {
            SWITCHES.into_iter().chain([glow::FRAMEBUFFER_SRGB]).for_each(|switch| gl.enable(switch));
            gl.scissor(3, 3, 5, 5);
            gl.blend_equation(glow::FUNC_SUBTRACT);
            gl.blend_func(glow::ZERO, glow::ONE);
            gl.color_mask(false, true, false, false);
            gl.cull_face(glow::FRONT_AND_BACK);
            gl.stencil_func(glow::NEVER, 0, 0xff);
            gl.viewport(1, 2, 3, 4);
            gl.pixel_store_i32(glow::UNPACK_ALIGNMENT, 8);
            gl.bind_texture(glow::TEXTURE_2D, Some(texture.native()));
            gl.bind_vertex_array(Some(vertices.native()));
            gl.bind_buffer(glow::ARRAY_BUFFER, Some(buffer.native()));
        })
        .unwrap();
        // SAFETY: only queries state of the current context.
        unsafe {
            for switch in SWITCHES.into_iter().chain([glow::FRAMEBUFFER_SRGB]) {
                assert!(!gl.is_enabled(switch), "{switch:#06x} is still on");
            }
            for (name, expected) in [
                (glow::BLEND_EQUATION_RGB, glow::FUNC_ADD),
                (glow::BLEND_SRC_RGB, glow::ONE),
                (glow::BLEND_DST_RGB, glow::ZERO),
                (glow::UNPACK_ALIGNMENT, 4),
                (glow::TEXTURE_BINDING_2D, 0),
                (glow::VERTEX_ARRAY_BINDING, 0),
                (glow::ARRAY_BUFFER_BINDING, 0),
                (glow::CURRENT_PROGRAM, 0),
            ] {
                assert_eq!(gl.get_parameter_i32(name).cast_unsigned(), expected, "{name:#06x}");
            }
        }
        renderer.draw(&frame, &scene, &program).unwrap();
        assert!(renderer.read() == before, "the image has changed");
    }
}
