//! Tests of the compilers in the background.

use glutin::config::GetGlConfig;

use super::*;
use crate::gpu::headless::{Headless, software_context};

/// Two compilers got the same display from EGL, and drew on it at the same time.
#[test]
fn a_software_renderer_has_one_compiler() {
    let info = Headless::new(false).unwrap().gl().info().clone();
    let (_display, window) = software_context(info.api).unwrap();
    let config = Config::Egl(window.config());
    let count =
        |software: bool| WorkerContext::beside_window(&config, &GlInfo { software, ..info.clone() }, 2).len();
    assert_eq!((count(true), count(false)), (1, 2));
}
