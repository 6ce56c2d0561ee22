//! Contexts of CGL, without a view. Not yet tried on hardware.
//!
//! glutin runs parts of its calls on the main thread and waits for them, so only the main thread opens such contexts.

#![expect(unsafe_code, reason = "CGL and OpenGL are C interfaces")]

use glutin::api::cgl::context::PossiblyCurrentContext;
use glutin::api::cgl::display::Display;
use glutin::config::ConfigTemplateBuilder;
use glutin::display::GlDisplay;
use glutin::error::{Error, ErrorKind};
use raw_window_handle::{AppKitDisplayHandle, RawDisplayHandle};

use super::no_context;
use crate::gpu::api::Api;
use crate::gpu::error::Result;
use crate::gpu::gl::Gl;

pub(super) type Current = PossiblyCurrentContext;
pub(super) const KIND: &str = "CGL without a window";

pub(super) fn open(apis: &[Api], log_debug: bool) -> Result<(Gl, Current)> {
    let (display, context) = current_context(apis).map_err(|error| no_context(&error))?;
    Ok((Gl::load(|name| display.get_proc_address(name), log_debug)?, context))
}

fn current_context(apis: &[Api]) -> Result<(Display, Current), Error> {
    // SAFETY: the handle contains no pointer, and the configuration comes from `display`.
    unsafe {
        let display = Display::new(RawDisplayHandle::AppKit(AppKitDisplayHandle::new()))?;
        let template = ConfigTemplateBuilder::new().with_single_buffering(true).build();
        let config = display.find_configs(template)?.next();
        let config = config.ok_or_else(|| Error::from(ErrorKind::BadConfig))?;
        let context = Api::create_context(apis, &display, &config, None)?.make_current_surfaceless()?;
        Ok((display, context))
    }
}
