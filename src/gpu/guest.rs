//! Draws of another library in our context: it finds the window's framebuffer, and we find our state again.

#![expect(unsafe_code, reason = "every OpenGL call is unsafe in glow")]

use glow::HasContext;

use super::error::GpuError;
use super::gl::Gl;

impl Gl {
    /// Lets `draws` draw over what is in the window's framebuffer, and brings the state back that the renderer
    /// does not set by itself: OpenGL's defaults, with conversion to sRGB off.
    ///
    /// # Errors
    /// An error that the driver reports, by `draws` or by what was before it.
    pub fn lend_window<T>(&self, doing: &'static str, draws: impl FnOnce() -> T) -> Result<T, GpuError> {
        // SAFETY: the window's framebuffer is always there; plain state.
        unsafe { self.bind_framebuffer(glow::FRAMEBUFFER, None) };
        let drawn = draws();
        self.reset_state();
        self.check(doing)?;
        Ok(drawn)
    }

    fn reset_state(&self) {
        // SAFETY: plain state; nothing is bound that could be gone.
        unsafe {
            for switch in [
                glow::BLEND,
                glow::CULL_FACE,
                glow::DEPTH_TEST,
                glow::FRAMEBUFFER_SRGB,
                glow::SCISSOR_TEST,
                glow::STENCIL_TEST,
            ] {
                self.disable(switch);
            }
            self.blend_equation(glow::FUNC_ADD);
            self.blend_func(glow::ONE, glow::ZERO);
            self.color_mask(true, true, true, true);
            self.pixel_store_i32(glow::UNPACK_ALIGNMENT, 4);
            // The renderer binds its textures to their units at each draw.
            self.active_texture(glow::TEXTURE0);
            self.bind_texture(glow::TEXTURE_2D, None);
            // The vertex array first: the element array's binding belongs to it.
            self.bind_vertex_array(None);
            self.bind_buffer(glow::ARRAY_BUFFER, None);
            self.bind_framebuffer(glow::FRAMEBUFFER, None);
            self.use_program(None);
        }
    }
}
