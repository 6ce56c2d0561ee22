//! How long the GPU itself takes, by GL_TIME_ELAPSED. Software renderers answer nonsense: don't ask them.

#![expect(unsafe_code, reason = "every OpenGL call is unsafe in glow")]

use std::time::Duration;

use glow::HasContext;

use super::error::GpuError;
use super::gl::Gl;
use super::object::Query;

/// A timer of draws.
pub struct GpuTimer {
    gl: Gl,
    query: Query,
}

impl GpuTimer {
    /// A timer in the current context.
    ///
    /// # Errors
    /// [`GpuError::Object`] if the driver has no query left.
    pub fn new(gl: &Gl) -> Result<Self, GpuError> {
        Ok(Self { gl: gl.clone(), query: Query::new(gl)? })
    }

    /// Runs `draws`, waits for the GPU and returns what they returned and how long the GPU took.
    pub fn time<T>(&self, draws: impl FnOnce() -> T) -> (T, Duration) {
        // SAFETY: the query is ours and no other is active; the result is waited for by the driver.
        unsafe {
            self.gl.begin_query(glow::TIME_ELAPSED, self.query.native());
            let result = draws();
            self.gl.end_query(glow::TIME_ELAPSED);
            let nanoseconds = self.gl.get_query_parameter_u64(self.query.native(), glow::QUERY_RESULT);
            (result, Duration::from_nanos(nanoseconds))
        }
    }
}
