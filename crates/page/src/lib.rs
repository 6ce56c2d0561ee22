//! Mariana as a web page: the same scenes, music analysis and renderer as WebAssembly, drawn with WebGL 2.
//!
//! ```text
//! web/studio.js: sound, controls, text ─► Studio ─► hearing: samples ─► sound of a moment ─┐
//!                                                ─► shown: text ─► world ─► program ───────┴► renderer ─► canvas
//!                                                ─► show_player: song ─► scenes of a moment ┘
//! ```
//!
//! `scripts/site` builds the page. Everything runs on the page's thread: the browser gives a page no threads unless
//! its server sends special headers, and the page must work from any server.

#![cfg(target_family = "wasm")]

mod hearing;
mod show_player;
mod shown;

use mariana_assets::DEMO_TRACK;
use mariana_music::SongStructure;
use mariana_render::gpu::edge_samples::EdgeSamples;
use mariana_render::gpu::renderer::Counting;
use mariana_render::gpu::scene_program::Mode;
use mariana_render::gpu::shader_source::ShaderLibrary;
use mariana_render::{Gl, GpuError, Renderer};
use mariana_scenes::{SceneSource, shipped_names};
use mariana_stage::PreparedShow;
use wasm_bindgen::prelude::wasm_bindgen;
use web_sys::{WebGl2RenderingContext, console};
use web_time::Instant;

use hearing::Hearing;
use show_player::{Cards, ShowPlayer};
use shown::{Coming, Shown};

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

/// Seconds in which the last picture of a scene fades out.
const FADE_SECONDS: f32 = 1.0;

/// A scene, or a show of scenes, that moves to music in a canvas.
#[wasm_bindgen]
pub struct Studio {
    gl: Gl,
    library: ShaderLibrary,
    renderer: Renderer,
    /// The chosen scene and its name.
    chosen: Option<(String, Shown)>,
    /// The next chosen scene, whose program the browser compiles.
    coming: Option<(String, Coming)>,
    /// The show that chooses the scenes, if any.
    show: Option<ShowPlayer>,
    cards: Cards,
    hearing: Hearing,
    /// When the last frame was shown.
    last: Option<Instant>,
    /// True if the show drew the last frame.
    was_show: bool,
    /// When the last picture of another scene began to fade out.
    fading: Option<Instant>,
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
            renderer.add_dimming(&library)?;
            renderer.set_edge_samples(EdgeSamples::Two);
            Ok::<_, GpuError>(renderer)
        };
        let renderer = opened().map_err(|error| error.to_string())?;
        Ok(Self {
            gl,
            library,
            renderer,
            chosen: None,
            coming: None,
            show: None,
            cards: Cards::default(),
            hearing: Hearing::new(SILENT_RATE, false),
            last: None,
            was_show: false,
            fading: None,
        })
    }

    /// Chooses the scene with this text. Its frames come once the browser has compiled it; until then the last scene or
    /// the show stays. The scene has the includes and textures of the shipped scene `name`. The values of sliders with the
    /// same names stay.
    ///
    /// # Errors
    /// Fails if the text has mistakes, with all of them, or if the scene is too large for a page.
    pub fn load(&mut self, name: &str, text: &str, interpreted: bool) -> Result<(), String> {
        let mode = if interpreted { Mode::Interpreted } else { Mode::Compiled };
        let ready =
            SceneSource::Shipped(name.to_owned()).ready_as(text).map_err(|error| error.to_string())?;
        let coming = Coming::begin(&self.gl, &self.library, ready, mode)?;
        self.coming = Some((name.to_owned(), coming));
        Ok(())
    }

    /// True until the chosen scene is received, and until the show has the scenes of `time` seconds and of its next change.
    pub fn is_loading(&self, time: f64) -> bool {
        self.coming.is_some() || self.show.as_ref().is_some_and(|show| show.is_preparing(time))
    }

    /// Shows the chosen scene if the browser has compiled it, or keeps it `behind` the show. Returns true if it is new.
    ///
    /// # Errors
    /// Fails if the browser refuses the program. The last scene stays.
    pub fn receive_scene(&mut self, behind: bool) -> Result<bool, String> {
        if !self.coming.as_ref().is_some_and(|(_, coming)| coming.is_compiled()) {
            return Ok(false);
        }
        let Some((name, coming)) = self.coming.take() else { return Ok(false) };
        let mut shown = coming.finish().map_err(|error| error.to_string())?;
        let is_another = self.chosen.as_ref().is_none_or(|(last, _)| *last != name);
        if let Some((_, last)) = &self.chosen {
            shown.keep_values_of(last);
        }
        if !behind {
            let was_show = self.show.take().is_some();
            if is_another || was_show {
                self.begin_fade();
            }
            self.was_show = false;
        }
        self.chosen = Some((name, shown));
        Ok(true)
    }

    /// Lets the last picture fade out.
    fn begin_fade(&mut self) {
        let is_kept = self.last.is_some() && self.renderer.keep_light().unwrap_or_default();
        self.fading = is_kept.then(Instant::now);
    }

    /// The names of the scene's sliders.
    pub fn slider_names(&self) -> Vec<String> {
        self.chosen.iter().flat_map(|(_, shown)| shown.slider_names()).collect()
    }

    /// Value, minimum and maximum of each slider.
    pub fn slider_values(&self) -> Vec<f32> {
        self.chosen.iter().flat_map(|(_, shown)| shown.slider_values()).collect()
    }

    /// Sets a slider of the scene, within its range.
    pub fn turn(&mut self, name: &str, value: f32) {
        if let Some((_, shown)) = &mut self.chosen {
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

    /// Begins a song, or live input if `live`, of `rate` samples per second. The chosen scene shows it.
    pub fn begin_sound(&mut self, rate: u32, live: bool) {
        self.hearing = Hearing::new(rate, live);
        self.show = None;
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

    /// Uses the beats and sections of the whole song that `mariana page` has found, as JSON.
    ///
    /// # Errors
    /// Fails if the text is from another version.
    pub fn know_song(&mut self, json: &str) -> Result<(), String> {
        self.hearing.know_song(serde_json::from_str(json).map_err(|error| error.to_string())?);
        Ok(())
    }

    /// Reads what the director must know about the next shipped scene. Returns false if none is left.
    pub fn read_next_card(&mut self) -> bool {
        self.cards.read_next()
    }

    /// Lets the director choose the scenes of the song that is known. Returns false without a song.
    pub fn follow_song(&mut self) -> bool {
        let show = self.hearing.song().and_then(|song| self.cards.directed(song));
        self.show = show.map(ShowPlayer::new);
        self.show.is_some()
    }

    /// Plays a show from its text. `names` and `texts` are its scenes that are not shipped.
    ///
    /// # Errors
    /// Fails with the mistakes of the show.
    pub fn follow_show(&mut self, show: &str, names: Vec<String>, texts: Vec<String>) -> Result<(), String> {
        let find =
            |name: &str| match names.iter().position(|own| own == name).and_then(|place| texts.get(place)) {
                Some(text) => Ok(SceneSource::Formula(text.clone())),
                None => SceneSource::find(name),
            };
        let unknown = SongStructure::default();
        let song = self.hearing.song().unwrap_or(&unknown);
        let (show, _) = PreparedShow::of_text("show", show, song, find).map_err(|error| error.to_string())?;
        self.show = Some(ShowPlayer::new(show));
        Ok(())
    }

    /// The name of the shipped scene that a show draws at `time` seconds, or of the chosen scene; empty for other scenes.
    pub fn scene_name(&self, time: f64) -> String {
        match &self.show {
            Some(show) => match show.scene_at(time) {
                Some(SceneSource::Shipped(name)) => name.clone(),
                _ => String::new(),
            },
            None => self.chosen.as_ref().map(|(name, _)| name.clone()).unwrap_or_default(),
        }
    }

    /// The text of the scene that a show draws at `time` seconds; empty without a show.
    pub fn scene_text_at(&self, time: f64) -> String {
        let source = self.show.as_ref().and_then(|show| show.scene_at(time));
        source.and_then(|source| source.text().ok()).map_or_else(String::new, |text| text.into_owned())
    }

    /// Draws the frame at `time` seconds of the sound into the canvas of `width` and `height` pixels.
    ///
    /// # Errors
    /// Fails with the browser's error.
    pub fn draw(&mut self, time: f64, width: u32, height: u32) -> Result<(), String> {
        let size = (width.max(1), height.max(1));
        // Flashes are limited in the time of the viewer, also after a seek.
        let now = Instant::now();
        let passed = self.last.map_or(0.0, |last| (now - last).as_secs_f64());
        self.hearing.begin_frame(time);
        let mut is_show = false;
        if let Some(show) = &mut self.show {
            show.prepare(&self.gl, &self.library, time);
            show.replace_late_blends(time);
            is_show = show.can_draw();
        }
        if is_show && !self.was_show {
            self.begin_fade();
        }
        let fade = self.fading.map(|begun| 1.0 - (now - begun).as_secs_f32() / FADE_SECONDS);
        let fade = fade.filter(|fade| *fade > 0.0);
        let Self { renderer, show, chosen, hearing, .. } = self;
        let (layers, brightness) = match (show.as_ref().filter(|_| is_show), chosen) {
            (Some(show), _) => show.layers(time, size),
            (None, Some((_, shown))) => (vec![shown.layer(time, size)], 1.0),
            (None, None) => return Ok(()),
        };
        let mut draw = || {
            renderer.set_fade(fade);
            layers.iter().try_for_each(|layer| layer.draw(renderer, hearing))?;
            renderer.dim(brightness)?;
            renderer.limit_flashes(passed)?;
            renderer.show(size)
        };
        draw().map_err(|error: GpuError| error.to_string())?;
        if layers.len() > 1 || fade.is_none() {
            self.fading = None;
            self.renderer.set_fade(None);
        }
        (self.last, self.was_show) = (Some(now), is_show);
        Ok(())
    }
}
