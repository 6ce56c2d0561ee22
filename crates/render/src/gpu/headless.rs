//! An OpenGL context without a visible window, drawing into framebuffers only.
//!
//! Stills, videos, tests and measurements draw with such a context. `Renderer` works the same with and without a
//! window. Each system has its own way to such a context:
//!
//! | system | context |
//! |---|---|
//! | Linux and other Unix systems | EGL on a device, without a window system (`egl`) |
//! | Windows | WGL with a hidden window (`wgl`); tried only under Wine |
//! | macOS | CGL without a view (`cgl`); not yet tried on hardware |

#[cfg(target_os = "macos")]
mod cgl;
#[cfg(all(unix, not(target_os = "macos")))]
mod egl;
#[cfg(windows)]
mod wgl;

#[cfg(target_os = "macos")]
use cgl as system;
#[cfg(all(unix, not(target_os = "macos")))]
use egl as system;
#[cfg(windows)]
use wgl as system;

#[cfg(target_os = "linux")]
pub(super) use egl::default_context;
#[cfg(all(unix, not(target_os = "macos")))]
pub(super) use egl::software_context;

use super::api::Api;
use super::error::GpuError;
use super::gl::Gl;

/// A current context without a visible window. Drop everything made from [`Headless::gl`] before the context.
pub struct Headless {
    gl: Gl,
    _context: system::Current,
}

impl Headless {
    /// The kind of context on this system.
    pub const KIND: &str = system::KIND;

    /// The functions of the context.
    pub fn gl(&self) -> &Gl {
        &self.gl
    }

    /// Creates a context of OpenGL 3.3 or else of OpenGL ES 3.0, and makes it current. If there are several devices,
    /// takes the first suitable one, hardware first.
    ///
    /// # Errors
    /// [`GpuError::NoHeadlessContext`] with the system's errors, or [`GpuError::TooOld`] if all contexts are too old.
    pub fn new(log_debug: bool) -> Result<Self, GpuError> {
        Self::with(Api::tried()?, log_debug)
    }

    /// Like [`Headless::new`], with the first of these interfaces that the system has.
    ///
    /// # Errors
    /// Same errors as [`Headless::new`].
    pub fn with(apis: &[Api], log_debug: bool) -> Result<Self, GpuError> {
        let (gl, context) = system::open(apis, log_debug)?;
        Ok(Self { gl, _context: context })
    }
}

fn no_context(reason: &dyn std::fmt::Display) -> GpuError {
    GpuError::NoHeadlessContext { reason: reason.to_string() }
}
