//! OpenGL objects as owned types that delete themselves when dropped.

#![expect(unsafe_code, reason = "every OpenGL call is unsafe in glow")]

use glow::HasContext;

use super::error::{GpuError, Result};
use super::gl::Gl;

/// Defines an owned newtype around each kind of GL name, with its constructor and destructor.
macro_rules! owned_objects {
    ($(
        $(#[$doc:meta])*
        $name:ident, $native:ty, $what:literal, $create:ident $(($stage:ident))?, $delete:ident;
    )*) => {$(
        $(#[$doc])*
        pub struct $name {
            gl: Gl,
            native: $native,
        }

        impl $name {
            /// Creates an empty object in the current context.
            ///
            /// # Errors
            /// [`GpuError::Object`] if the driver cannot create another object.
            pub fn new(gl: &Gl $(, $stage: u32)?) -> Result<Self> {
                // SAFETY: the context of `gl` is current on this thread.
                let native = unsafe { gl.$create($($stage)?) };
                let native = native.map_err(|reason| GpuError::Object { what: $what, reason })?;
                Ok(Self { gl: gl.clone(), native })
            }

            /// The OpenGL name of the object; valid while `self` exists.
            pub fn native(&self) -> $native {
                self.native
            }
        }

        impl Drop for $name {
            fn drop(&mut self) {
                // SAFETY: `self` owns the name and deletes it once. In a lost context the driver ignores the call.
                unsafe { self.gl.$delete(self.native) }
            }
        }
    )*};
}

owned_objects! {
    /// A texture.
    Texture, glow::Texture, "a texture", create_texture, delete_texture;
    /// A framebuffer.
    Framebuffer, glow::Framebuffer, "a framebuffer", create_framebuffer, delete_framebuffer;
    /// A renderbuffer.
    Renderbuffer, glow::Renderbuffer, "a renderbuffer", create_renderbuffer, delete_renderbuffer;
    /// A buffer.
    Buffer, glow::Buffer, "a buffer", create_buffer, delete_buffer;
    /// A vertex array. Core profiles require one for every draw.
    VertexArray, glow::VertexArray, "a vertex array", create_vertex_array, delete_vertex_array;
    /// A program, linked or not.
    ProgramObject, glow::Program, "a program", create_program, delete_program;
    /// A query.
    Query, glow::Query, "a query", create_query, delete_query;
    /// A shader of a stage, compiled or not. The driver keeps an attached shader with its program.
    ShaderObject, glow::Shader, "a shader", create_shader(stage), delete_shader;
}
