//! Contexts of the interfaces, for windows and without windows.

#![expect(unsafe_code, reason = "glutin's functions that create contexts are unsafe")]

use glutin::config::Api as ConfigApi;
use glutin::context::{ContextApi, ContextAttributesBuilder, GlProfile, Robustness, Version};
use glutin::display::GlDisplay;
use glutin::error::{Error, ErrorKind};
use raw_window_handle::RawWindowHandle;

use super::Api;
use crate::gpu::error::{GpuError, Result};

/// The variable that chooses the interface.
const VARIABLE: &str = "MARIANA_GL";

impl Api {
    /// The interfaces to try, in this order. With `MARIANA_GL=es`, only OpenGL ES is tried.
    ///
    /// # Errors
    /// [`GpuError::UnknownApi`] if the variable has another value.
    pub fn tried() -> Result<&'static [Self]> {
        match std::env::var_os(VARIABLE) {
            Some(value) if value == "es" => Ok(&[Self::Embedded]),
            Some(value) if !value.is_empty() => {
                Err(GpuError::UnknownApi(value.to_string_lossy().into_owned()))
            }
            _ => Ok(&[Self::Desktop, Self::Embedded]),
        }
    }

    /// The interface that pixel formats must support.
    pub fn of_configs(self) -> ConfigApi {
        match self {
            Self::Desktop => ConfigApi::OPENGL,
            Self::Embedded => ConfigApi::GLES3,
        }
    }

    /// Creates a context of this interface. The context is robust if the driver has robust contexts: then the driver
    /// reports resets of the GPU ([`crate::gpu::gl::Gl::check_context`]). It shares no objects and is not current.
    ///
    /// # Safety
    /// `config` comes from `display`, and the window exists as long as the context.
    ///
    /// # Errors
    /// The driver's error.
    // SAFETY: the duties of the caller are above.
    pub unsafe fn create<D: GlDisplay>(
        self,
        display: &D,
        config: &D::Config,
        window: Option<RawWindowHandle>,
    ) -> Result<D::NotCurrentContext, Error> {
        let create = |robustness| {
            let attributes = ContextAttributesBuilder::new().with_robustness(robustness);
            let attributes = match self {
                Self::Desktop => attributes
                    .with_profile(GlProfile::Core)
                    .with_context_api(ContextApi::OpenGl(Some(Version::new(3, 3)))),
                Self::Embedded => attributes.with_context_api(ContextApi::Gles(Some(Version::new(3, 0)))),
            };
            // SAFETY: the caller keeps the window and passes a config of `display`.
            unsafe { display.create_context(config, &attributes.build(window)) }
        };
        create(Robustness::RobustLoseContextOnReset).or_else(|_| create(Robustness::NotRobust))
    }

    /// Creates a context with the first of `apis` that the driver supports, as [`Api::create`] does. If the driver
    /// supports none, the context has an older version, which [`crate::gpu::gl::Gl::load`] reports.
    ///
    /// # Safety
    /// `config` comes from `display`, and the window exists as long as the context.
    ///
    /// # Errors
    /// The driver's error for the first interface.
    // SAFETY: the duties of the caller are above.
    pub unsafe fn create_context<D: GlDisplay>(
        apis: &[Self],
        display: &D,
        config: &D::Config,
        window: Option<RawWindowHandle>,
    ) -> Result<D::NotCurrentContext, Error> {
        let mut first_error = None;
        for api in apis {
            // SAFETY: the caller keeps the window and passes a config of `display`.
            match unsafe { api.create(display, config, window) } {
                Ok(context) => return Ok(context),
                Err(error) => first_error = first_error.or(Some(error)),
            }
        }
        let first_error = first_error.unwrap_or_else(|| ErrorKind::BadConfig.into());
        if !apis.contains(&Self::Desktop) {
            return Err(first_error);
        }
        // A driver that refuses a request does not give its version, which any context can report.
        let any = ContextAttributesBuilder::new()
            .with_profile(GlProfile::Compatibility)
            .with_context_api(ContextApi::OpenGl(Some(Version::new(2, 1))))
            .build(window);
        // SAFETY: as above.
        unsafe { display.create_context(config, &any) }.map_err(|_| first_error)
    }
}
