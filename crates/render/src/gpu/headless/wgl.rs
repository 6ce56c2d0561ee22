//! Contexts of WGL, with a hidden window. Tried only under Wine.
//!
//! WGL needs a window for its functions, its pixel formats and its contexts. The window is never shown, and nothing
//! draws into it.

#![expect(unsafe_code, reason = "WGL and OpenGL are C interfaces")]

use std::num::{NonZeroIsize, NonZeroU32};
use std::ptr::{null, null_mut};

use glutin::api::wgl::context::PossiblyCurrentContext;
use glutin::api::wgl::display::Display;
use glutin::api::wgl::surface::Surface;
use glutin::config::{ConfigSurfaceTypes, ConfigTemplateBuilder};
use glutin::context::NotCurrentGlContext;
use glutin::display::GlDisplay;
use glutin::error::{Error, ErrorKind};
use glutin::surface::{SurfaceAttributesBuilder, WindowSurface};
use raw_window_handle::{RawDisplayHandle, RawWindowHandle, Win32WindowHandle, WindowsDisplayHandle};
use windows_sys::Win32::Foundation::HWND;
use windows_sys::Win32::System::LibraryLoader::GetModuleHandleW;
use windows_sys::Win32::UI::WindowsAndMessaging::{
    CS_OWNDC, CreateWindowExW, DefWindowProcW, DestroyWindow, RegisterClassExW, WNDCLASSEXW, WS_POPUP,
};
use windows_sys::core::w;

use super::no_context;
use crate::gpu::api::Api;
use crate::gpu::error::Result;
use crate::gpu::gl::Gl;

pub(super) const KIND: &str = "WGL with a hidden window";

/// A current context with its window. The fields are dropped in this order.
pub(super) struct Current {
    _context: PossiblyCurrentContext,
    _surface: Surface<WindowSurface>,
    _window: HiddenWindow,
}

pub(super) fn open(apis: &[Api], log_debug: bool) -> Result<(Gl, Current)> {
    let window = HiddenWindow::open().map_err(|error| no_context(&error))?;
    let (display, current) = current_context(window, apis).map_err(|error| no_context(&error))?;
    Ok((Gl::load(|name| display.get_proc_address(name), log_debug)?, current))
}

fn current_context(window: HiddenWindow, apis: &[Api]) -> Result<(Display, Current), Error> {
    let handle = RawWindowHandle::Win32(window.handle);
    let side = NonZeroU32::MIN;
    // SAFETY: the window exists as long as `Current`, and the configuration comes from `display`.
    unsafe {
        let display = Display::new(RawDisplayHandle::Windows(WindowsDisplayHandle::new()), Some(handle))?;
        let template = ConfigTemplateBuilder::new()
            .with_surface_type(ConfigSurfaceTypes::WINDOW)
            .compatible_with_native_window(handle)
            .build();
        let config = display.find_configs(template)?.next();
        let config = config.ok_or_else(|| Error::from(ErrorKind::BadConfig))?;
        let context = Api::create_context(apis, &display, &config, Some(handle))?;
        let attributes = SurfaceAttributesBuilder::<WindowSurface>::new().build(handle, side, side);
        let surface = display.create_window_surface(&config, &attributes)?;
        let context = context.make_current(&surface)?;
        Ok((display, Current { _context: context, _surface: surface, _window: window }))
    }
}

struct HiddenWindow {
    window: HWND,
    handle: Win32WindowHandle,
}

impl HiddenWindow {
    fn open() -> std::io::Result<Self> {
        let name = w!("Mariana without a window");
        // SAFETY: the name ends with a zero; the class is a plain value, copied by the system, with the system's own
        // procedure.
        let (instance, window) = unsafe {
            let instance = GetModuleHandleW(null());
            let class = WNDCLASSEXW {
                cbSize: size_of::<WNDCLASSEXW>() as u32,
                style: CS_OWNDC,
                lpfnWndProc: Some(DefWindowProcW),
                hInstance: instance,
                lpszClassName: name,
                ..Default::default()
            };
            // If the class is registered already, this call fails, and the next call uses the class.
            RegisterClassExW(&class);
            let window = CreateWindowExW(
                0,
                name,
                name,
                WS_POPUP,
                0,
                0,
                1,
                1,
                null_mut(),
                null_mut(),
                instance,
                null(),
            );
            (instance, window)
        };
        let hwnd = NonZeroIsize::new(window as isize).ok_or_else(std::io::Error::last_os_error)?;
        let mut handle = Win32WindowHandle::new(hwnd);
        handle.hinstance = NonZeroIsize::new(instance as isize);
        Ok(Self { window, handle })
    }
}

impl Drop for HiddenWindow {
    fn drop(&mut self) {
        // SAFETY: `self` owns the window, on the thread that opened it: `Gl` and the context stay on one thread.
        unsafe { DestroyWindow(self.window) };
    }
}
