//! The functions of the current OpenGL context, the driver's properties, and its errors.

#![expect(unsafe_code, reason = "every OpenGL call is unsafe in glow")]

use std::cell::Cell;
#[cfg(not(target_family = "wasm"))]
use std::ffi::{CStr, c_void};
use std::rc::Rc;
use std::sync::Arc;
use std::time::Duration;

use glow::HasContext;
use serde::Serialize;

use super::api::Api;
use super::error::{GpuError, Result};
use super::target::Target;
use super::texel_list::texels_in_rows;
use crate::faults::{self, Fault};

/// The functions of the context that is current on this thread. Clones share the context.
///
/// `Gl` is neither `Send` nor `Sync`, so it stays on the context's thread. The `unsafe` calls of this crate rely on the
/// context staying current on that thread. OpenGL objects hold a clone, to free themselves while the context exists.
#[derive(Clone)]
pub struct Gl {
    functions: Arc<glow::Context>,
    context: Rc<ContextState>,
}

struct ContextState {
    info: GlInfo,
    /// The framebuffer that replaces the window's framebuffer; `None` without a replacement.
    window: Cell<Option<glow::Framebuffer>>,
    /// Returns the status of the GPU; `None` if the driver does not report resets.
    reset_status: Option<ResetStatus>,
    /// The time for which the computer had been suspended when this context was created.
    suspended: Duration,
}

// SAFETY: the function may be called only while its context is current.
type ResetStatus = unsafe extern "system" fn() -> u32;

/// The functions that return the status of the GPU: true for OpenGL ES, the extension, and the function's name.
#[cfg(not(target_family = "wasm"))]
const RESET_STATUS: [(bool, &str, &CStr); 4] = [
    (false, "GL_KHR_robustness", c"glGetGraphicsResetStatus"),
    (false, "GL_ARB_robustness", c"glGetGraphicsResetStatusARB"),
    (true, "GL_KHR_robustness", c"glGetGraphicsResetStatusKHR"),
    (true, "GL_EXT_robustness", c"glGetGraphicsResetStatusEXT"),
];

/// GL_PURGED_CONTEXT_RESET_NV: the driver has lost the contents of textures and buffers.
const PURGED_CONTEXT_RESET: u32 = 0x92BB;
/// The error after which a page has lost its context.
const CONTEXT_LOST_WEBGL: u32 = 0x9242;
/// The shortest suspension of the computer that counts. The clocks are not read at exactly the same time.
const SUSPENSION: Duration = Duration::from_secs(1);

/// Properties that the driver reports.
#[derive(Debug, Clone, Serialize)]
pub struct GlInfo {
    /// The interface of the context.
    pub api: Api,
    /// GL_VENDOR.
    pub vendor: String,
    /// GL_RENDERER.
    pub renderer: String,
    /// GL_VERSION.
    pub version: String,
    /// GL_SHADING_LANGUAGE_VERSION.
    pub shading_language: String,
    /// Largest side of a texture, in texels.
    pub texture_side_max: u32,
    /// The longest list of texels that shaders read ([`super::texel_list`]). OpenGL 3.3 guarantees 65,536 texels.
    pub list_texels_max: u32,
    /// Highest anisotropy of texture filters; 1 if the driver does not support it.
    pub anisotropy_max: f32,
    /// True if the driver supports program binaries (GL_ARB_get_program_binary with at least one format).
    pub program_binaries: bool,
    /// True if the driver says whether it has compiled a program (KHR_parallel_shader_compile).
    pub tells_completion: bool,
    /// True for software renderers (llvmpipe and similar). Their GL timers are meaningless.
    pub software: bool,
}

impl GlInfo {
    /// True if the driver measures the GPU's time ([`super::timer`]).
    pub fn has_timers(&self) -> bool {
        self.api == Api::Desktop && !self.software
    }
}

impl std::fmt::Display for GlInfo {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        writeln!(f, "interface            {}", self.api)?;
        writeln!(f, "vendor               {}", self.vendor)?;
        writeln!(f, "renderer             {}", self.renderer)?;
        writeln!(f, "version              {}", self.version)?;
        writeln!(f, "shading language     {}", self.shading_language)?;
        writeln!(f, "software renderer    {}", if self.software { "yes" } else { "no" })?;
        writeln!(f, "texture side         {} texels", self.texture_side_max)?;
        writeln!(f, "list of texels       {} texels", self.list_texels_max)?;
        write!(f, "anisotropy           {}", self.anisotropy_max)
    }
}

impl Gl {
    /// Loads the functions of the current context with `loader` and checks that the version is OpenGL 3.3 or newer, or
    /// OpenGL ES 3.0 or newer with 32-bit floats as targets (EXT_color_buffer_float).
    ///
    /// With `log_debug`, the driver's debug output is logged, if the driver has any (KHR_debug).
    ///
    /// # Errors
    /// [`GpuError::TooOld`] for older versions, and for OpenGL ES without this extension.
    #[cfg(not(target_family = "wasm"))]
    pub fn load(mut loader: impl FnMut(&CStr) -> *const c_void, log_debug: bool) -> Result<Self> {
        // SAFETY: the caller has made a context current on this thread, and `loader` returns its functions.
        let mut functions = unsafe { glow::Context::from_loader_function_cstr(&mut loader) };
        if log_debug && functions.supports_debug() {
            // SAFETY: the callback only formats its arguments, and the wrapper of the context owns the callback.
            unsafe {
                functions.enable(glow::DEBUG_OUTPUT);
                functions.debug_message_callback(|_source, kind, id, severity, message| {
                    let kind = if kind == glow::DEBUG_TYPE_ERROR { "error" } else { "note" };
                    match severity {
                        glow::DEBUG_SEVERITY_HIGH => tracing::error!("OpenGL {kind} {id}: {message}"),
                        glow::DEBUG_SEVERITY_MEDIUM => tracing::warn!("OpenGL {kind} {id}: {message}"),
                        _ => tracing::debug!("OpenGL {kind} {id}: {message}"),
                    }
                });
            }
        }
        let reset_status = reset_status_of(&functions, loader);
        Self::new(functions, reset_status)
    }

    /// Takes the functions of a page's WebGL 2 context, which count as OpenGL ES 3.0.
    ///
    /// # Errors
    /// [`GpuError::TooOld`] without 32-bit floats as targets (EXT_color_buffer_float).
    #[cfg(target_family = "wasm")]
    pub fn in_page(functions: glow::Context) -> Result<Self> {
        Self::new(functions, None)
    }

    #[cfg_attr(
        target_family = "wasm",
        expect(
            clippy::arc_with_non_send_sync,
            reason = "other libraries ask for this type, and a page has one thread"
        )
    )]
    fn new(functions: glow::Context, reset_status: Option<ResetStatus>) -> Result<Self> {
        let version = functions.version();
        let least = if version.is_embedded { (3, 0) } else { (3, 3) };
        let is_new = (version.major, version.minor) >= least;
        let lacks_floats = version.is_embedded && !has_extension(&functions, "EXT_color_buffer_float");
        if !is_new || lacks_floats {
            // SAFETY: the context is current on this thread.
            let found = unsafe { functions.get_parameter_string(glow::VERSION) };
            let mut found = found.trim_start_matches("OpenGL ").to_owned();
            if is_new {
                found.push_str(" without EXT_color_buffer_float");
            }
            return Err(GpuError::TooOld(found));
        }
        let (info, window) = (read_info(&functions), Cell::new(None));
        let context = ContextState { info, window, reset_status, suspended: suspended() };
        Ok(Self { functions: Arc::new(functions), context: Rc::new(context) })
    }

    /// Returns the functions, for another library in this context. Like `self`, they must stay on this thread.
    pub fn shared(&self) -> Arc<glow::Context> {
        self.functions.clone()
    }

    /// Redirects all drawing to the window into a target, for contexts without a window. `None` restores the window.
    /// The target must outlive the redirected draws.
    pub fn replace_window(&self, target: Option<&Target>) {
        self.context.window.set(target.map(Target::native));
    }

    pub(super) fn window(&self) -> Option<glow::Framebuffer> {
        self.context.window.get()
    }

    /// Properties that the driver reports.
    pub fn info(&self) -> &GlInfo {
        &self.context.info
    }

    /// Binds a texture to a texture unit.
    pub(super) fn bind_unit(&self, unit: u32, target: u32, texture: Option<glow::Texture>) {
        // SAFETY: for a name that is invalid, the driver reports an error.
        unsafe {
            self.functions.active_texture(glow::TEXTURE0 + unit);
            self.functions.bind_texture(target, texture);
        }
    }

    /// Directs the following draws to the whole framebuffer of `size` pixels.
    pub(super) fn bind_output(&self, framebuffer: Option<glow::Framebuffer>, size: (u32, u32)) {
        // SAFETY: for a name that is invalid, the driver reports an error.
        unsafe {
            self.functions.bind_framebuffer(glow::FRAMEBUFFER, framebuffer);
            self.functions.viewport(0, 0, size.0.cast_signed(), size.1.cast_signed());
        }
    }

    /// Sets the filter of the texture that is bound to `target`.
    pub(super) fn filter(&self, target: u32, filter: u32) {
        for name in [glow::TEXTURE_MIN_FILTER, glow::TEXTURE_MAG_FILTER] {
            // SAFETY: sets a parameter of a texture of the current context.
            unsafe { self.functions.tex_parameter_i32(target, name, filter.cast_signed()) }
        }
    }

    /// Allocates a mip level of the bound 2D texture. `texel` are the stored format, the format and the type of `bytes`.
    ///
    /// # Safety
    /// `bytes` must hold all texels of the level.
    // SAFETY: the duties of the caller are above.
    pub(super) unsafe fn store_level(
        &self,
        level: i32,
        texel: (u32, u32, u32),
        size: (u32, u32),
        bytes: Option<&[u8]>,
    ) {
        let (stored, format, kind) = (texel.0.cast_signed(), texel.1, texel.2);
        let [width, height] = [size.0, size.1].map(u32::cast_signed);
        let (target, texels) = (glow::TEXTURE_2D, glow::PixelUnpackData::Slice(bytes));
        // SAFETY: the caller guarantees the number of bytes.
        unsafe {
            self.functions.pixel_store_i32(glow::UNPACK_ALIGNMENT, 1);
            self.functions.tex_image_2d(target, level, stored, width, height, 0, format, kind, texels);
        }
    }

    /// Replaces an area of the bound 2D texture: `x` and `y`, width and height in texels.
    ///
    /// # Safety
    /// `bytes` must hold all texels of the area, in the format `texel.1` and the type `texel.2`.
    // SAFETY: the duties of the caller are above.
    pub(super) unsafe fn replace_area(&self, texel: (u32, u32, u32), area: [u32; 4], bytes: &[u8]) {
        let [x, y, width, height] = area.map(u32::cast_signed);
        let (target, texels) = (glow::TEXTURE_2D, glow::PixelUnpackData::Slice(Some(bytes)));
        // SAFETY: the caller guarantees the number of bytes.
        unsafe {
            self.functions.pixel_store_i32(glow::UNPACK_ALIGNMENT, 1);
            self.functions.tex_sub_image_2d(target, 0, x, y, width, height, texel.1, texel.2, texels);
        }
    }

    /// Checks that the bound framebuffer is complete. `what` names it in the error, with its parts in `of`.
    pub(super) fn check_framebuffer(&self, what: &'static str, of: &dyn std::fmt::Debug) -> Result<()> {
        // SAFETY: asks the current context.
        match unsafe { self.functions.check_framebuffer_status(glow::FRAMEBUFFER) } {
            glow::FRAMEBUFFER_COMPLETE => Ok(()),
            status => {
                let reason = format!("incomplete ({status:#06x}) with {of:?}");
                Err(GpuError::Object { what, reason })
            }
        }
    }

    /// Turns the conversion to sRGB in framebuffers off. OpenGL ES has no such switch, and converts only in sRGB
    /// framebuffers, which Mariana does not use.
    pub(super) fn store_colors_unchanged(&self) {
        if self.info().api == Api::Desktop {
            // SAFETY: sets state of the current context.
            unsafe { self.functions.disable(glow::FRAMEBUFFER_SRGB) }
        }
    }

    /// Calls `draw` in the state for passes that overwrite one colour attachment. If blending is off, llvmpipe compiles
    /// a pass twice (for tiles inside and at the edge of a triangle), otherwise once. Here llvmpipe therefore blends,
    /// with a function that overwrites: the shared passes compile in 0.70 s, not 0.93 s.
    pub(super) fn replacing<R>(&self, draw: impl FnOnce() -> R) -> R {
        let mixes = self.context.info.software;
        if mixes {
            // SAFETY: sets state of the current context.
            unsafe {
                self.functions.enable(glow::BLEND);
                self.functions.blend_func(glow::ONE, glow::ZERO);
            }
        }
        let result = draw();
        if mixes {
            // SAFETY: sets state of the current context.
            unsafe { self.functions.disable(glow::BLEND) }
        }
        result
    }

    /// Fails if the driver has reported an error since the last check.
    ///
    /// # Errors
    /// Returns [`GpuError::Driver`] with the name of the first error, or [`GpuError::ContextLost`].
    pub fn check(&self, doing: &'static str) -> Result<()> {
        // SAFETY: the context is current on this thread (`Gl` is neither `Send` nor `Sync`).
        let code = unsafe { self.functions.get_error() };
        let code = if faults::strikes(Fault::ContextLost) { glow::CONTEXT_LOST } else { code };
        let what = match code {
            glow::NO_ERROR => return Ok(()),
            glow::INVALID_ENUM => "an invalid enumerant".to_owned(),
            glow::INVALID_VALUE => "an invalid value".to_owned(),
            glow::INVALID_OPERATION => "an invalid operation".to_owned(),
            glow::INVALID_FRAMEBUFFER_OPERATION => "an incomplete framebuffer".to_owned(),
            glow::OUT_OF_MEMORY => "that its memory is used up".to_owned(),
            glow::CONTEXT_LOST | CONTEXT_LOST_WEBGL => return Err(GpuError::ContextLost(doing)),
            other => format!("error {other:#06x}"),
        };
        Err(GpuError::Driver { what, doing })
    }

    /// Like [`Gl::check`], and fails if the GPU was reset or has lost its memory. Call it for each frame, since drivers
    /// may ask the system.
    ///
    /// # Errors
    /// The errors of [`Gl::check`].
    pub fn check_context(&self, doing: &'static str) -> Result<()> {
        self.check(doing)?;
        let ContextState { info, reset_status, suspended: before, .. } = &*self.context;
        // NVIDIA's driver reports this loss only to contexts with an attribute that glutin cannot set.
        let is_purged = info.vendor.starts_with("NVIDIA") && suspended() > *before + SUSPENSION;
        let status = match reset_status {
            _ if is_purged || faults::strikes(Fault::MemoryPurged) => PURGED_CONTEXT_RESET,
            // SAFETY: the function belongs to this context, which is current on this thread.
            Some(reset_status) => unsafe { reset_status() },
            None => glow::NO_ERROR,
        };
        match status {
            glow::NO_ERROR => return Ok(()),
            PURGED_CONTEXT_RESET => {
                tracing::warn!("the GPU has lost its memory while the computer was suspended")
            }
            status => tracing::warn!("the GPU was reset (status {status:#06x})"),
        }
        Err(GpuError::ContextLost(doing))
    }

    /// Waits until the driver has executed all commands.
    pub fn finish(&self) {
        // SAFETY: the context is current on this thread.
        unsafe { self.functions.finish() }
        // Browsers do not wait there, but they wait for pixels.
        #[cfg(target_family = "wasm")]
        // SAFETY: the slice holds the four bytes of a pixel. All readers bind their framebuffer themselves.
        unsafe {
            self.functions.bind_framebuffer(glow::READ_FRAMEBUFFER, None);
            let pixel = glow::PixelPackData::Slice(Some(&mut [0; 4]));
            self.functions.read_pixels(0, 0, 1, 1, glow::RGBA, glow::UNSIGNED_BYTE, pixel);
        }
    }
}

impl std::ops::Deref for Gl {
    type Target = glow::Context;

    fn deref(&self) -> &glow::Context {
        &self.functions
    }
}

/// True if the context has an extension. WebGL's names lack the prefix.
fn has_extension(gl: &glow::Context, name: &str) -> bool {
    let all = gl.supported_extensions();
    all.contains(name) || all.contains(&format!("GL_{name}"))
}

/// Returns the function that returns the status of the GPU. Loaders return pointers even for functions that the driver
/// lacks, so the extension decides.
#[cfg(not(target_family = "wasm"))]
fn reset_status_of(
    gl: &glow::Context,
    mut loader: impl FnMut(&CStr) -> *const c_void,
) -> Option<ResetStatus> {
    let extensions = gl.supported_extensions();
    let is_embedded = gl.version().is_embedded;
    let mut known = RESET_STATUS.iter();
    let (.., name) =
        known.find(|(of_es, extension, _)| *of_es == is_embedded && extensions.contains(*extension))?;
    let function = loader(name);
    // SAFETY: the driver has the extension, and in it this function has this signature.
    (!function.is_null()).then(|| unsafe { std::mem::transmute::<*const c_void, ResetStatus>(function) })
}

/// Returns the time for which the computer has been suspended since its start; 0 on systems that do not tell.
fn suspended() -> Duration {
    #[cfg(target_os = "linux")]
    {
        use rustix::time::{ClockId, clock_gettime};
        // In this order, a pause between the two calls makes the difference smaller.
        let [all, awake] = [ClockId::Boottime, ClockId::Monotonic]
            .map(|clock| Duration::try_from(clock_gettime(clock)).unwrap_or_default());
        all.saturating_sub(awake)
    }
    #[cfg(not(target_os = "linux"))]
    Duration::ZERO
}

/// GL_MAX_TEXTURE_MAX_ANISOTROPY, which is part of core OpenGL only since 4.6.
const MAX_ANISOTROPY: u32 = 0x84FF;

fn read_info(gl: &glow::Context) -> GlInfo {
    // SAFETY: the context is current, and each of these names queries a single value.
    unsafe {
        let renderer = gl.get_parameter_string(glow::RENDERER);
        let lower = renderer.to_lowercase();
        let version = gl.version();
        let api = if version.is_embedded { Api::Embedded } else { Api::Desktop };
        let gives_binaries = !cfg!(target_family = "wasm")
            && (version.is_embedded
                || (version.major, version.minor) >= (4, 1)
                || has_extension(gl, "ARB_get_program_binary"));
        let anisotropic = ["EXT_texture_filter_anisotropic", "ARB_texture_filter_anisotropic"]
            .iter()
            .any(|name| has_extension(gl, name));
        let texture_side_max = gl.get_parameter_i32(glow::MAX_TEXTURE_SIZE).max(0).cast_unsigned();
        GlInfo {
            api,
            vendor: gl.get_parameter_string(glow::VENDOR),
            version: gl.get_parameter_string(glow::VERSION),
            shading_language: gl.get_parameter_string(glow::SHADING_LANGUAGE_VERSION),
            texture_side_max,
            list_texels_max: match api {
                Api::Desktop => gl.get_parameter_i32(glow::MAX_TEXTURE_BUFFER_SIZE).max(0).cast_unsigned(),
                Api::Embedded => texels_in_rows(texture_side_max),
            },
            anisotropy_max: if anisotropic { gl.get_parameter_f32(MAX_ANISOTROPY).max(1.0) } else { 1.0 },
            program_binaries: gives_binaries && gl.get_parameter_i32(glow::NUM_PROGRAM_BINARY_FORMATS) > 0,
            software: ["llvmpipe", "softpipe", "swrast", "software rasterizer"]
                .iter()
                .any(|s| lower.contains(s)),
            // Only the web page asks: the program compiles on threads.
            tells_completion: cfg!(target_family = "wasm")
                && has_extension(gl, "KHR_parallel_shader_compile"),
            renderer,
        }
    }
}
