//! Mariana as a web page: the same scenes, music analysis and renderer as WebAssembly, drawn with WebGL 2.
//!
//! ```text
//! web/studio.js: sound, controls, text ─► Studio ─► hearing: samples ─► sound of a moment ─┐
//!                                                ─► shown: text ─► world ─► program ───────┴► renderer ─► canvas
//! ```
//!
//! `scripts/site` builds the page. Everything runs on the page's thread: the browser gives a page no threads unless
//! its server sends special headers, and the page must work from any server.

#![cfg(target_family = "wasm")]

mod hearing;
mod shown;

use mariana_assets::DEMO_TRACK;
use mariana_render::gpu::edge_samples::EdgeSamples;
use mariana_render::gpu::renderer::Counting;
use mariana_render::gpu::scene_program::Mode;
use mariana_render::gpu::shader_source::ShaderLibrary;
use mariana_render::{Frame, Gl, Renderer};
use mariana_scenes::{SceneSource, shipped_names};
use wasm_bindgen::prelude::wasm_bindgen;
use web_sys::{WebGl2RenderingContext, console};
use web_time::Instant;

use hearing::Hearing;
use shown::Shown;

/// The sample rate of the silence before the first sound.
const SILENT_RATE: u32 = 48_000;

/// Sends panics to the browser's console.
#[wasm_bindgen(start)]
pub fn start() {
    std::panic::set_hook(Box::new(|panic| console::error_1(&panic.to_string().into())));
}

/// The demo track: a file of Ogg Vorbis.
#[wasm_bindgen]
pub fn demo_track() -> Vec<u8> {
    DEMO_TRACK.to_vec()
}

/// The names of the shipped scenes.
#[wasm_bindgen]
pub fn scene_names() -> Vec<String> {
    shipped_names()
}

/// The text of a shipped scene; empty for an unknown name.
#[wasm_bindgen]
pub fn scene_text(name: &str) -> String {
    SceneSource::Shipped(name.to_owned()).text().map_or_else(|_| String::new(), |text| text.into_owned())
}

/// A scene that moves to music in a canvas.
#[wasm_bindgen]
pub struct Studio {
    gl: Gl,
    library: ShaderLibrary,
    renderer: Renderer,
    shown: Option<Shown>,
    hearing: Hearing,
    /// When the last frame was shown.
    last: Option<Instant>,
}

#[wasm_bindgen]
impl Studio {
    /// Prepares to draw into a canvas.
    ///
    /// # Errors
    /// Fails if the browser's WebGL lacks what the shaders need.
    #[wasm_bindgen(constructor)]
    pub fn new(context: WebGl2RenderingContext) -> Result<Self, String> {
        let gl =
            Gl::in_page(glow::Context::from_webgl2_context(context)).map_err(|error| error.to_string())?;
        let library = ShaderLibrary::embedded();
        let opened = || {
            let mut renderer = Renderer::new(&gl, &library, Counting::Off)?;
            renderer.prepare_for_window(&library)?;
            renderer.add_flash_limiter(&library)?;
            renderer.set_edge_samples(EdgeSamples::Two);
            Ok::<_, mariana_render::GpuError>(renderer)
        };
        let renderer = opened().map_err(|error| error.to_string())?;
        Ok(Self { gl, library, renderer, shown: None, hearing: Hearing::new(SILENT_RATE, false), last: None })
    }

    /// Shows the scene with this text from the next frame on. The scene has the includes and textures of the
    /// shipped scene `name`. The values of sliders with the same names stay.
    ///
    /// # Errors
    /// Fails if the text has mistakes, with all of them, or if the browser refuses the program. The last scene stays.
    pub fn load(&mut self, name: &str, text: &str, interpreted: bool) -> Result<(), String> {
        let mode = if interpreted { Mode::Interpreted } else { Mode::Compiled };
        let ready =
            SceneSource::Shipped(name.to_owned()).ready_as(text).map_err(|error| error.to_string())?;
        let mut shown =
            Shown::new(&self.gl, &self.library, ready, mode).map_err(|error| error.to_string())?;
        if let Some(last) = &self.shown {
            shown.keep_values_of(last);
        }
        self.shown = Some(shown);
        Ok(())
    }

    /// The names of the scene's sliders.
    pub fn slider_names(&self) -> Vec<String> {
        self.shown.iter().flat_map(Shown::slider_names).collect()
    }

    /// Value, minimum and maximum of each slider.
    pub fn slider_values(&self) -> Vec<f32> {
        self.shown.iter().flat_map(Shown::slider_values).collect()
    }

    /// Sets a slider of the scene, within its range.
    pub fn turn(&mut self, name: &str, value: f32) {
        if let Some(shown) = &mut self.shown {
            shown.turn(name, value);
        }
    }

    /// Sets the number of further samples at edges to 2, 4 or 16.
    pub fn set_edge_samples(&mut self, count: u32) {
        self.renderer.set_edge_samples(match count {
            0..=2 => EdgeSamples::Two,
            3..=4 => EdgeSamples::Four,
            _ => EdgeSamples::Sixteen,
        });
    }

    /// Begins a song, or live input if `live`, of `rate` samples per second.
    pub fn begin_sound(&mut self, rate: u32, live: bool) {
        self.hearing = Hearing::new(rate, live);
    }

    /// Continues the sound at this sample of the song.
    pub fn seek(&mut self, sample: f64) {
        self.hearing.seek(sample as u64);
    }

    /// Hears the next samples of both channels.
    pub fn push_samples(&mut self, left: &[f32], right: &[f32]) {
        self.hearing.push(left, right);
    }

    /// Hears the next samples of the whole song, from its start, to find its beats and sections.
    pub fn push_song(&mut self, left: &[f32], right: &[f32]) {
        self.hearing.push_song(left, right);
    }

    /// Finishes the analysis of the whole song.
    pub fn finish_song(&mut self) {
        self.hearing.finish_song();
    }

    /// Draws the frame at `time` seconds of the sound into the canvas of `width` and `height` pixels.
    ///
    /// # Errors
    /// Fails with the browser's error.
    pub fn draw(&mut self, time: f64, width: u32, height: u32) -> Result<(), String> {
        let Some(shown) = &self.shown else { return Ok(()) };
        let size = (width.max(1), height.max(1));
        // Flashes are limited in the time of the viewer, also after a seek.
        let now = Instant::now();
        let passed = self.last.replace(now).map_or(0.0, |last| (now - last).as_secs_f64());
        let sound = self.hearing.now(time);
        let frame = |time, sound| Frame::with_params(shown.world(), time, sound, size, shown.params());
        let draw = || {
            let shown_frame = frame(time, sound);
            let picture = (size, shown_frame.projection.stereo);
            while let Some(request) = self.renderer.feedback_before(&shown.resources, 0, time, picture, true)
            {
                let mut earlier = frame(request.time, self.hearing.at(request.time));
                earlier.size = request.size;
                self.renderer.draw_feedback(&request, &earlier, &shown.resources, &shown.program)?;
            }
            self.renderer.show_feedback(&shown.resources, time)?;
            self.renderer.draw(&shown_frame, &shown.resources, &shown.program)?;
            self.renderer.limit_flashes(passed)?;
            self.renderer.show(size)
        };
        draw().map_err(|error: mariana_render::GpuError| error.to_string())
    }
}
