//! An OpenGL context without a window: EGL on a device, drawing into framebuffers only.
//!
//! Stills, videos, tests and measurements draw with such a context and need no window system. `Renderer` works the
//! same with and without a window.

#![expect(unsafe_code, reason = "EGL and OpenGL are C interfaces")]

#[cfg(all(unix, not(target_os = "macos")))]
use std::sync::{Mutex, PoisonError};

use super::error::GpuError;
use super::gl::Gl;

#[cfg(all(unix, not(target_os = "macos")))]
static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

/// A current context without a window. Drop everything made from [`Headless::gl`] before the context.
pub struct Headless {
    gl: Gl,
    #[cfg(all(unix, not(target_os = "macos")))]
    _context: glutin::api::egl::context::PossiblyCurrentContext,
}

impl Headless {
    /// The functions of the context.
    pub fn gl(&self) -> &Gl {
        &self.gl
    }

    /// Creates an OpenGL 3.3 context on the first suitable EGL device, hardware first, and makes it current.
    ///
    /// # Errors
    /// [`GpuError::NoHeadlessContext`] with the errors of all devices, or [`GpuError::TooOld`] if all contexts are
    /// older than OpenGL 3.3.
    #[cfg(all(unix, not(target_os = "macos")))]
    pub fn new(log_debug: bool) -> Result<Self, GpuError> {
        use glutin::api::egl::device::Device;
        // One thread at a time: Mesa's first initialization is not thread-safe (`lp_build_init` in 22.3).
        let _alone = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
        let no_context = |reason: String| GpuError::NoHeadlessContext { reason };
        let mut devices: Vec<Device> =
            Device::query_devices().map_err(|error| no_context(error.to_string()))?.collect();
        devices.sort_by_key(is_software);
        let mut reasons = Vec::new();
        let mut too_old = None;
        for device in &devices {
            let current = context_on(device)
                .and_then(|(display, context)| Ok((display, context.make_current_surfaceless()?)));
            match current {
                Ok((display, context)) => {
                    use glutin::display::GlDisplay;
                    match Gl::load(|name| display.get_proc_address(name), log_debug) {
                        Ok(gl) => return Ok(Self { gl, _context: context }),
                        Err(error) => {
                            tracing::info!("skipping a device: {error}");
                            too_old = too_old.or(Some(error));
                        }
                    }
                }
                Err(error) => reasons.push(error.to_string()),
            }
        }
        if let Some(error) = too_old {
            return Err(error);
        }
        if reasons.is_empty() {
            reasons.push("EGL lists no device".into());
        }
        Err(no_context(reasons.join("; ")))
    }

    /// Fails, because this system is not supported yet.
    ///
    /// # Errors
    /// Always returns [`GpuError::NoHeadlessContext`].
    #[cfg(not(all(unix, not(target_os = "macos"))))]
    pub fn new(_log_debug: bool) -> Result<Self, GpuError> {
        Err(GpuError::NoHeadlessContext { reason: "this system has no EGL devices".into() })
    }
}

#[cfg(all(unix, not(target_os = "macos")))]
fn is_software(device: &glutin::api::egl::device::Device) -> bool {
    device.extensions().contains("EGL_MESA_device_software")
}

/// Creates a software renderer's context on a separate display; it is not current yet. `None` without such a device.
#[cfg(all(unix, not(target_os = "macos")))]
pub(super) fn software_context()
-> Option<(glutin::api::egl::display::Display, glutin::api::egl::context::NotCurrentContext)> {
    let _alone = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
    let mut devices = glutin::api::egl::device::Device::query_devices().ok()?;
    let device = devices.find(is_software)?;
    let made = context_on(&device);
    made.inspect_err(|error| tracing::info!("cannot create a context on the software device: {error}")).ok()
}

#[cfg(all(unix, not(target_os = "macos")))]
fn context_on(
    device: &glutin::api::egl::device::Device,
) -> glutin::error::Result<(glutin::api::egl::display::Display, glutin::api::egl::context::NotCurrentContext)>
{
    // SAFETY: glutin returned the device from the same EGL library.
    context_of(unsafe { glutin::api::egl::display::Display::with_device(device, None) }?)
}

/// Creates a context on EGL's default display, which `EGL_PLATFORM` or the desktop selects. It is not current yet.
#[cfg(target_os = "linux")]
pub(super) fn default_context()
-> Option<(glutin::api::egl::display::Display, glutin::api::egl::context::NotCurrentContext)> {
    use raw_window_handle::{OhosDisplayHandle, RawDisplayHandle};

    let _alone = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
    // For this platform, glutin requests EGL's default display.
    let handle = RawDisplayHandle::Ohos(OhosDisplayHandle::new());
    // SAFETY: an OHOS display handle contains no pointer that could be invalid.
    let display = unsafe { glutin::api::egl::display::Display::new(handle) };
    let made = display.and_then(context_of);
    made.inspect_err(|error| tracing::info!("cannot create a context on the default display: {error}")).ok()
}

#[cfg(all(unix, not(target_os = "macos")))]
fn context_of(
    display: glutin::api::egl::display::Display,
) -> glutin::error::Result<(glutin::api::egl::display::Display, glutin::api::egl::context::NotCurrentContext)>
{
    use glutin::config::{Api, ConfigSurfaceTypes, ConfigTemplateBuilder};
    use glutin::context::{ContextApi, ContextAttributesBuilder, GlProfile, Version};
    use glutin::display::GlDisplay;

    // SAFETY: `display` is alive, the configuration comes from `display`, and the context shares no objects.
    unsafe {
        let template = ConfigTemplateBuilder::new()
            .with_surface_type(ConfigSurfaceTypes::empty())
            .with_api(Api::OPENGL)
            .build();
        let config = display
            .find_configs(template)?
            .next()
            .ok_or_else(|| glutin::error::Error::from(glutin::error::ErrorKind::BadConfig))?;
        let wanted = ContextAttributesBuilder::new()
            .with_profile(GlProfile::Core)
            .with_context_api(ContextApi::OpenGl(Some(Version::new(3, 3))))
            .build(None);
        // An older driver refuses the request without giving its version, which any context can report.
        let any = ContextAttributesBuilder::new()
            .with_profile(GlProfile::Compatibility)
            .with_context_api(ContextApi::OpenGl(Some(Version::new(2, 1))))
            .build(None);
        let context = display
            .create_context(&config, &wanted)
            .or_else(|error| display.create_context(&config, &any).map_err(|_| error))?;
        Ok((display, context))
    }
}
