//! Contexts on EGL devices, without a window system.

#![expect(unsafe_code, reason = "EGL and OpenGL are C interfaces")]

use std::sync::{Mutex, PoisonError};

use glutin::api::egl::context::{NotCurrentContext, PossiblyCurrentContext};
use glutin::api::egl::device::Device;
use glutin::api::egl::display::Display;
use glutin::config::{ConfigSurfaceTypes, ConfigTemplateBuilder};
use glutin::display::GlDisplay;
use glutin::error::{Error, ErrorKind};

use super::no_context;
use crate::gpu::api::Api;
use crate::gpu::error::Result;
use crate::gpu::gl::Gl;

pub(super) type Current = PossiblyCurrentContext;
pub(super) const KIND: &str = "EGL without a window";

/// One thread at a time: Mesa's first initialization is not thread-safe (`lp_build_init` in 22.3).
static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

pub(super) fn open(apis: &[Api], log_debug: bool) -> Result<(Gl, Current)> {
    let _alone = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
    let mut devices: Vec<Device> = Device::query_devices().map_err(|error| no_context(&error))?.collect();
    devices.sort_by_key(is_software);
    let mut reasons = Vec::new();
    let mut too_old = None;
    for device in &devices {
        let current = context_on(device, apis)
            .and_then(|(display, context)| Ok((display, context.make_current_surfaceless()?)));
        match current {
            Ok((display, context)) => match Gl::load(|name| display.get_proc_address(name), log_debug) {
                Ok(gl) => return Ok((gl, context)),
                Err(error) => {
                    tracing::info!("skipping a device: {error}");
                    too_old = too_old.or(Some(error));
                }
            },
            Err(error) => reasons.push(error.to_string()),
        }
    }
    if let Some(error) = too_old {
        return Err(error);
    }
    if reasons.is_empty() {
        reasons.push("EGL lists no device".into());
    }
    Err(no_context(&reasons.join("; ")))
}

fn is_software(device: &Device) -> bool {
    device.extensions().contains("EGL_MESA_device_software")
}

/// Creates a software renderer's context on a separate display; it is not current yet. `None` without such a device.
pub(in crate::gpu) fn software_context(api: Api) -> Option<(Display, NotCurrentContext)> {
    let _alone = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
    let mut devices = Device::query_devices().ok()?;
    let device = devices.find(is_software)?;
    let made = context_on(&device, &[api]);
    made.inspect_err(|error| tracing::info!("cannot create a context on the software device: {error}")).ok()
}

fn context_on(device: &Device, apis: &[Api]) -> Result<(Display, NotCurrentContext), Error> {
    // SAFETY: glutin returned the device from the same EGL library.
    context_of(unsafe { Display::with_device(device, None) }?, apis)
}

/// Creates a context on EGL's default display, which `EGL_PLATFORM` or the desktop selects. It is not current yet.
#[cfg(target_os = "linux")]
pub(in crate::gpu) fn default_context() -> Option<(Display, NotCurrentContext)> {
    use raw_window_handle::{OhosDisplayHandle, RawDisplayHandle};

    let _alone = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
    let apis = Api::tried().ok()?;
    // For this platform, glutin requests EGL's default display.
    let handle = RawDisplayHandle::Ohos(OhosDisplayHandle::new());
    // SAFETY: an OHOS display handle contains no pointer that could be invalid.
    let display = unsafe { Display::new(handle) };
    let made = display.and_then(|display| context_of(display, apis));
    made.inspect_err(|error| tracing::info!("cannot create a context on the default display: {error}")).ok()
}

fn context_of(display: Display, apis: &[Api]) -> Result<(Display, NotCurrentContext), Error> {
    let mut first_error = None;
    for (number, api) in apis.iter().enumerate() {
        let template = ConfigTemplateBuilder::new()
            .with_surface_type(ConfigSurfaceTypes::empty())
            .with_api(api.of_configs())
            .build();
        // SAFETY: `display` is alive, and the configuration comes from `display`.
        let made = unsafe {
            let config = display.find_configs(template).map(|mut configs| configs.next());
            config.and_then(|config| {
                let config = config.ok_or_else(|| Error::from(ErrorKind::BadConfig))?;
                Api::create_context(apis.get(number..).unwrap_or_default(), &display, &config, None)
            })
        };
        match made {
            Ok(context) => return Ok((display, context)),
            Err(error) => first_error = first_error.or(Some(error)),
        }
    }
    Err(first_error.unwrap_or_else(|| ErrorKind::BadConfig.into()))
}
