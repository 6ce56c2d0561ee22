//! Draws a frame: one sample per pixel, further samples at edges, then the finished image ([`super::post`]).
//!
//! 1. `scene.frag` traces one sample at each pixel's centre.
//! 2. `edges.frag` marks in the stencil each pixel whose neighbourhood differs visibly.
//! 3. `scene.frag` traces further samples in the marked pixels, at different positions in the pixel.
//!
//! A frame is drawn in parts, in one call or several (`making`). `presenter` brings the finished image to the screen.
//!
//! The same program draws every sample in one GL state, because some drivers compile a program once for each state.
//! Programs belong to scenes, and the renderer draws with the program of any scene.
//!
//! **Further samples at edges only.** If neighbouring pixels show different surfaces (alpha holds a key of the surface)
//! and visibly different colours, the same program draws further samples there. The window gets four (in 6 to 13 % of
//! the pixels), or two if frames are late or while an interpreted scene is being edited. Stills and videos get sixteen,
//! also at the edges of shadows. `bench --edges` compares the results with 64 samples everywhere. A GPU selects the
//! pixels by a stencil; a software renderer lists them (`edge_list`).

mod canvas;
mod making;
mod painter;
mod path_picture;
mod paths;
mod placing;
mod presenter;
mod sampling;
mod targets;

use std::time::Duration;

use super::edge_samples::EdgeSamples;
use super::error::Result;
pub use super::evaluations::{Counting, Evaluations};
use super::feedback;
pub use super::feedback::FeedbackRequest;
use super::flash_pass::FlashPass;
use super::gl::Gl;
use super::media::MediaTargets;
use super::picture_reader::PictureReader;
use super::program::{LazyProgram, Program, unit_of};
use super::scene_resources::{SceneNames, SceneResources};
use super::shader_source::{ShaderLibrary, Variant};
use super::target::{Target, Texel};
use super::tiles::Costs;
use super::timer::PictureClock;
use crate::frame::Frame;
use crate::frame::block::FrameBlock;
use crate::frame::picture::Picture;
use crate::frame::projection::Stereo;
use crate::placement::{Area, Map, Placement};
use crate::view::legend::LegendPicture;
use crate::view::setup::ViewBlock;
pub(super) use canvas::Canvas;
pub use making::Progress;
use making::{Product, Tools, rehearse_passes};
use mariana_field::world::ToneMap;
use painter::Painter;
pub use path_picture::PathPicture;
pub use paths::{PATH_RESULT_SHADERS, PATHS_MAX, PathOrder, PathProgress, PathSampling, PathWatcher};
pub use placing::PLACING_SHADERS;
use placing::Placing;
pub use presenter::UPSCALE_SHADER;
use presenter::{Fade, Flashes, Presenter};
pub use sampling::EDGE_SHADER;

/// Size of the warm-up image: large enough for several levels of bloom. Software renderers compile separate variants
/// for powers of two, so no side of the image or of its bloom levels is a power of two.
const WARM_UP_SIZE: (u32, u32) = (90, 54);

/// Samples of a reference image along each side of a pixel.
const REFERENCE_SIDE: u32 = 8;

/// Draws scenes. Holds the targets and the programs that all scenes share.
pub struct Renderer {
    gl: Gl,
    painter: Painter,
    presenter: Presenter,
}

/// Targets for small previews of other scenes ([`Renderer::sketch`]). The previews are drawn one after the other.
#[derive(Default)]
pub struct Sketch(Canvas);

impl Renderer {
    /// Compiles the shaders that all scenes share. With [`Counting::On`], the programs of scenes must also count.
    ///
    /// # Errors
    /// Fails with the driver's log if the driver rejects a shader.
    pub fn new(gl: &Gl, library: &ShaderLibrary, counting: Counting) -> Result<Self> {
        let renderer = Self {
            gl: gl.clone(),
            painter: Painter::new(gl, library, counting)?,
            presenter: Presenter::default(),
        };
        gl.check("setting up the renderer")?;
        Ok(renderer)
    }

    /// The context of the renderer.
    pub fn gl(&self) -> &Gl {
        &self.gl
    }

    /// Prepares features for windows: enlarging smaller images, dimming, and GPU times.
    ///
    /// # Errors
    /// Same errors as [`Renderer::new`].
    pub fn prepare_for_window(&mut self, library: &ShaderLibrary) -> Result<()> {
        let upscale = LazyProgram::new(&self.gl, library, UPSCALE_SHADER, &Variant::default())?;
        self.presenter.upscale = Some(upscale);
        self.add_dimming(library)?;
        self.time_pictures()
    }

    /// Enables [`Renderer::dim`].
    ///
    /// # Errors
    /// Same errors as [`Renderer::new`].
    pub fn add_dimming(&mut self, library: &ShaderLibrary) -> Result<()> {
        self.presenter.placing = Some(Placing::new(&self.gl, library)?);
        Ok(())
    }

    /// Times the GPU, so that parts of frames shrink when pixels become expensive. While a frame is drawn, no other
    /// timer may run.
    ///
    /// # Errors
    /// [`GpuError::Object`] if the driver cannot create another query.
    pub fn time_pictures(&mut self) -> Result<()> {
        if self.gl.info().has_timers() {
            self.painter.clock = PictureClock::new(&self.gl)?;
        }
        Ok(())
    }

    /// Enables [`Renderer::limit_flashes`].
    ///
    /// # Errors
    /// Same errors as [`Renderer::new`].
    pub fn add_flash_limiter(&mut self, library: &ShaderLibrary) -> Result<()> {
        self.presenter.flashes.pass = Some(FlashPass::new(&self.gl, library)?);
        Ok(())
    }

    /// Disables [`Renderer::limit_flashes`].
    pub fn remove_flash_limiter(&mut self) {
        self.presenter.flashes = Flashes::default();
    }

    /// Overrides the scenes' tone map. `None` ends the override.
    pub fn set_tone_map(&mut self, tone_map: Option<ToneMap>) {
        self.painter.post.tone_map = tone_map;
    }

    /// Sets the number of further samples at edges; the default is four.
    pub fn set_edge_samples(&mut self, samples: EdgeSamples) {
        if self.painter.sampling.edge_samples != samples {
            tracing::debug!("{} further samples at edges", samples.count());
            self.painter.sampling.edge_samples = samples;
            self.painter.canvas.put_targets_away();
        }
    }

    /// Draws an invisible empty image with every pass of a window's first frame, because many drivers finish a program
    /// only at its first draw. Stops when `is_wanted` returns false. Has no effect after the first draw.
    ///
    /// # Errors
    /// Same errors as [`Renderer::draw`].
    pub fn warm_up(&mut self, picture: &Picture, is_wanted: &mut dyn FnMut() -> bool) -> Result<()> {
        let painter = &mut self.painter;
        if painter.canvas.is_empty() {
            painter.need_targets(WARM_UP_SIZE, picture)?;
            let Some(mut targets) = painter.canvas.targets.take() else { return Ok(()) };
            let Painter { sampling, post, .. } = &*painter;
            post.bind_picture(picture, sampling.edge_samples);
            post.passes.prepare();
            rehearse_passes(&Tools { sampling, post, fade: None }, &mut targets, picture)?;
            self.presenter.warm_up(&post.passes, &targets.post.finished, is_wanted)?;
        }
        self.gl.check("drawing an empty image")
    }

    /// Draws `frame` into the renderer's target; [`Renderer::show`] or [`Renderer::read`] outputs it.
    ///
    /// # Errors
    /// Fails if the size exceeds the driver's limit, or if the driver reports an error.
    pub fn draw(&mut self, frame: &Frame, scene: &SceneResources, program: &Program) -> Result<()> {
        self.begin(frame, scene)?;
        self.resume(scene, program, Duration::MAX).map(|_| ())
    }

    /// Begins a frame, which replaces any unfinished frame. [`Renderer::resume`] draws it.
    ///
    /// # Errors
    /// Same errors as [`Renderer::draw`].
    pub fn begin(&mut self, frame: &Frame, scene: &SceneResources) -> Result<()> {
        self.painter.begin(Product::Picture, frame, scene)
    }

    /// Begins a frame that only provides light for [`Renderer::keep_light`]. The previous image stays until that call.
    ///
    /// # Errors
    /// Same errors as [`Renderer::draw`].
    pub fn begin_light(&mut self, frame: &Frame, scene: &SceneResources) -> Result<()> {
        self.painter.begin(Product::Light, frame, scene)
    }

    /// Begins a view as [`Renderer::begin`] begins a frame. Draw its legend last ([`Renderer::put_legend`]).
    ///
    /// # Errors
    /// Same errors as [`Renderer::draw`].
    pub fn begin_view(&mut self, frame: &Frame, scene: &SceneResources, view: &ViewBlock) -> Result<()> {
        self.painter.sampling.set_view(view);
        self.painter.begin(Product::View, frame, scene)
    }

    /// Continues the frame for about `patience`, with the same scene and program. [`Duration::MAX`] finishes it.
    ///
    /// # Errors
    /// Same errors as [`Renderer::draw`].
    pub fn resume(
        &mut self,
        scene: &SceneResources,
        program: &Program,
        patience: Duration,
    ) -> Result<Progress> {
        if self.presenter.upscale.is_none() {
            // Discard the time of the last frame, because only windows read it.
            self.painter.clock.drain();
        }
        let is_light =
            self.painter.canvas.making.as_ref().is_none_or(|making| making.product == Product::Light);
        let progress = self.painter.resume(&scene.names(program), program, &scene.costs, patience)?;
        if matches!(progress, Progress::Finished { .. }) && !is_light {
            self.presenter.flashes.is_limited = false;
        }
        Ok(progress)
    }

    /// Returns the next frame of feedback to draw ([`Renderer::draw_feedback`]) before an image at a moment: the number
    /// of the song, and the time in seconds. `picture` is the number of pixels with which the image is shown, and the
    /// arrangement of its eyes. Returns `None` if all frames are drawn, or the scene needs none. Frames of another song
    /// or size are forgotten. `ahead` is true if images of later moments follow.
    pub fn feedback_before(
        &self,
        scene: &SceneResources,
        song: u64,
        time: f64,
        picture: ((u32, u32), Stereo),
        ahead: bool,
    ) -> Option<FeedbackRequest> {
        let (size, stereo) = picture;
        scene.feedback()?.request(song, time, size, stereo, ahead)
    }

    /// Draws a frame of feedback for each group of histories with its own last frame. `frame` is the frame at its
    /// moment and of its size. A frame in progress is lost.
    ///
    /// # Errors
    /// Same errors as [`Renderer::draw`].
    pub fn draw_feedback(
        &mut self,
        request: &FeedbackRequest,
        frame: &Frame,
        scene: &SceneResources,
        program: &Program,
    ) -> Result<()> {
        let painter = &mut self.painter;
        let Some(mut feedback) = scene.feedback() else { return Ok(()) };
        let (groups, mut canvas) = (feedback.groups(request)?, std::mem::take(&mut feedback.canvas));
        drop(feedback);
        let edges = std::mem::replace(&mut painter.sampling.edge_samples, feedback::EDGES);
        let drawn = scene.without_cells(|| {
            groups.iter().try_for_each(|slots| {
                let read = slots.first().copied().unwrap_or_default();
                scene.feedback().iter_mut().for_each(|feedback| feedback.read(read));
                painter.elsewhere(&mut canvas, |painter| {
                    painter.begin_without_trails(Product::Light, frame, scene)?;
                    painter.resume(&scene.names(program), program, &scene.costs, Duration::MAX)?;
                    let Some(targets) = &painter.canvas.targets else { return Ok(()) };
                    let Some(mut feedback) = scene.feedback() else { return Ok(()) };
                    let (passes, trails) = (&painter.post.passes, &painter.post.trails);
                    feedback.keep(passes, trails, frame, &targets.post.light, slots)
                })
            })
        });
        painter.sampling.edge_samples = edges;
        if let Some(mut feedback) = scene.feedback() {
            feedback.canvas = canvas;
            feedback.record_drawn(request);
        }
        drawn
    }

    /// Selects the frame of feedback that images at `time` seconds of the song show.
    ///
    /// # Errors
    /// Same errors as [`Renderer::draw`].
    pub fn show_feedback(&mut self, scene: &SceneResources, time: f64) -> Result<()> {
        let painter = &self.painter;
        let Some(mut feedback) = scene.feedback() else { return Ok(()) };
        painter.post.passes.prepare();
        feedback.show(&painter.post.passes, &painter.post.trails, time)?;
        painter.gl.check("mixing frames of feedback")
    }

    /// Draws an image of `size` pixels, or a view without a legend, from a frame's blocks and the bound objects of a
    /// scene.
    ///
    /// # Errors
    /// Same errors as [`Renderer::draw`].
    pub fn draw_block(
        &mut self,
        size: (u32, u32),
        block: &FrameBlock,
        picture: &Picture,
        scene: &SceneNames,
        program: &Program,
        view: Option<&ViewBlock>,
    ) -> Result<()> {
        view.into_iter().for_each(|view| self.painter.sampling.set_view(view));
        let product = if view.is_some() { Product::View } else { Product::Picture };
        self.painter.begin_block(product, size, block, picture)?;
        self.painter.resume(scene, program, &Costs::default(), Duration::MAX).map(|_| ())
    }

    /// Draws a view of `frame` with a program of [`super::scene_program::as_views`], then the view's legend. The
    /// program writes screen colours: post-processing is skipped, and each pixel has one sample.
    ///
    /// # Errors
    /// Same errors as [`Renderer::draw`].
    pub fn draw_view(
        &mut self,
        frame: &Frame,
        scene: &SceneResources,
        program: &Program,
        view: &ViewBlock,
        legend: Option<&LegendPicture>,
    ) -> Result<()> {
        self.begin_view(frame, scene, view)?;
        self.resume(scene, program, Duration::MAX)?;
        self.put_legend(legend)
    }

    /// Draws a legend over the finished view.
    ///
    /// # Errors
    /// Fails if the driver reports an error.
    pub fn put_legend(&mut self, legend: Option<&LegendPicture>) -> Result<()> {
        if let (Some(targets), Some(legend)) = (&self.painter.canvas.targets, legend) {
            targets.post.finished.put_rgba8((legend.margin, legend.margin), legend.size, &legend.rgba);
        }
        self.gl.check("drawing a legend")
    }

    /// Draws `frame` with a regular grid of 64 samples per pixel, as a reference for other images. Slow.
    ///
    /// # Errors
    /// Same errors as [`Renderer::draw`].
    pub fn draw_reference(&mut self, frame: &Frame, scene: &SceneResources, program: &Program) -> Result<()> {
        self.draw(frame, scene, program)?;
        let painter = &self.painter;
        let Some(targets) = &painter.canvas.targets else { return Ok(()) };
        scene.names(program).bind(&painter.gl);
        let sum = Target::new(&painter.gl, targets.first.size(), &[Texel::Rgba32F], None)?;
        sum.bind();
        targets.media.iter().for_each(MediaTargets::bind_mean);
        painter.sampling.draw_grid(program, REFERENCE_SIDE);
        sum.bind_color(0, unit_of("extra_samples"));
        painter.post.resolve_all(&targets.post)?;
        painter.post.finish(&targets.post, &frame.picture, &targets.first, None)?;
        painter.gl.check("drawing a reference")
    }

    /// Draws a small invisible image, so that the driver compiles everything for this context and the cost of pixels is
    /// known. The finished image stays. A frame in progress is lost.
    ///
    /// # Errors
    /// Same errors as [`Renderer::draw`].
    pub fn rehearse(&mut self, frame: &Frame, scene: &SceneResources, program: &Program) -> Result<()> {
        self.painter.elsewhere(&mut Canvas::default(), |painter| {
            // The driver may compile during this draw, so do not record its time as the scene's cost.
            painter.draw(frame, scene, program, &Costs::default())?;
            painter.fade = painter.exposed(None)?.map(|light| Fade { light, fraction: 0.5 });
            painter.draw(frame, scene, program, &scene.costs)
        })
    }

    /// Draws an invisible preview for `reader`. Returns `false` if too many previews are pending. A frame in progress
    /// is lost.
    ///
    /// # Errors
    /// Same errors as [`Renderer::draw`].
    pub fn sketch(
        &mut self,
        sketch: &mut Sketch,
        frame: &Frame,
        scene: &SceneResources,
        program: &Program,
        reader: &mut PictureReader,
    ) -> Result<bool> {
        let painter = &mut self.painter;
        let edges = std::mem::replace(&mut painter.sampling.edge_samples, EdgeSamples::Two);
        let sent = painter.elsewhere(&mut sketch.0, |painter| {
            painter.draw(frame, scene, program, &scene.costs)?;
            let (Some(picture), Some(placing)) = (painter.canvas.finished(), &self.presenter.placing) else {
                return Ok(false);
            };
            let whole = Placement::default();
            placing.place_in(&painter.post.passes, picture, &reader.target, &whole.map(), whole.part())?;
            let sent = reader.begin();
            painter.gl.check("sending an image").map(|()| sent)
        });
        painter.sampling.edge_samples = edges;
        sent
    }

    /// Keeps the finished image's light for fades. Returns `false` if the light is missing: for a view, or after the
    /// targets were dropped.
    ///
    /// # Errors
    /// Fails if there is no memory for the light.
    pub fn keep_light(&mut self) -> Result<bool> {
        let painter = &mut self.painter;
        let old = painter.fade.take().map(|fade| fade.light);
        painter.fade = painter.exposed(old)?.map(|light| Fade { light, fraction: 1.0 });
        Ok(painter.fade.is_some())
    }

    /// The exposed linear light of the finished image: four numbers per pixel, top row first. Empty for a view.
    ///
    /// # Errors
    /// Fails if there is no memory for the light.
    pub fn read_light(&self) -> Result<Vec<f32>> {
        Ok(self.painter.exposed(None)?.map_or_else(Vec::new, |light| light.read_rgba32f(0)))
    }

    /// Adds the finished image, after `number` earlier ones, to the mean of several exposures of one frame. Does
    /// nothing for a view.
    ///
    /// # Errors
    /// Fails if there is no memory for the light.
    pub fn add_exposure(&mut self, number: usize) -> Result<()> {
        let painter = &mut self.painter;
        let Some((picture, targets)) = painter.canvas.finished_light() else { return Ok(()) };
        let size = targets.first.size();
        let earlier = painter.mean.take().filter(|mean| number > 0 && mean.size() == size);
        // Whole floats keep the light of still parts exactly.
        let mean = Target::new(&painter.gl, size, &[Texel::Rgba32F], None)?;
        painter.post.passes.prepare();
        painter.post.bind_picture(picture, painter.sampling.edge_samples);
        let fade = painter.fade.as_ref().map(|fade| (&fade.light, fade.fraction));
        let earlier = earlier.as_ref().map(|mean| (mean, 1.0 / (number as f32 + 1.0)));
        painter.post.add_exposure(&targets.post, picture, &targets.first, fade, earlier, &mean)?;
        painter.mean = Some(mean);
        painter.gl.check("adding an exposure")
    }

    /// Replaces the finished image by the mean of the exposures' light.
    ///
    /// # Errors
    /// Fails if the driver reports an error.
    pub fn finish_exposures(&mut self) -> Result<()> {
        let painter = &mut self.painter;
        let (Some((picture, targets)), Some(mean)) = (painter.canvas.finished_light(), painter.mean.take())
        else {
            return Ok(());
        };
        painter.post.passes.prepare();
        painter.post.bind_picture(picture, painter.sampling.edge_samples);
        painter.post.finish_mean(&targets.post, picture, &mean)?;
        painter.gl.check("finishing the exposures")
    }

    /// Sets the fraction, 0..1, of the kept light in the following images. `None` discards the light.
    pub fn set_fade(&mut self, fraction: Option<f32>) {
        match (fraction, &mut self.painter.fade) {
            (Some(fraction), Some(fade)) => fade.fraction = fraction.clamp(0.0, 1.0),
            _ => self.painter.fade = None,
        }
    }

    /// Width and height of the displayed image, in pixels.
    pub fn shape(&self) -> Option<(u32, u32)> {
        self.painter.canvas.finished().map(Target::size)
    }

    /// The brightness of the displayed image, 0..1.
    pub fn gain(&self) -> f32 {
        self.presenter.placing.as_ref().map_or(1.0, |placing| placing.gain)
    }

    /// Dims the finished image to this brightness, 0..1. Call it for each image before [`Renderer::limit_flashes`],
    /// which measures the dimmed image. Requires [`Renderer::add_dimming`].
    ///
    /// # Errors
    /// Fails if there is no memory for a copy of the image.
    pub fn dim(&mut self, gain: f32) -> Result<()> {
        self.presenter.dim(&self.painter.post.passes, self.painter.canvas.finished(), gain)?;
        self.gl.check("dimming an image")
    }

    /// Dims excessive flashes in the finished image, which is shown `seconds` after the previous image.
    ///
    /// # Errors
    /// Fails if there is no memory for a copy of the image. Windows need no copy.
    pub fn limit_flashes(&mut self, seconds: f64) -> Result<()> {
        self.presenter.limit_flashes(&self.gl, self.painter.canvas.finished(), seconds)?;
        self.gl.check("limiting flashes")
    }

    /// Makes the flash limiter forget earlier images, because the user has switched to other content.
    pub fn forget_flashes(&mut self) {
        self.presenter.flashes.pass.iter_mut().for_each(FlashPass::forget);
    }

    /// Returns the GPU time of an image drawn in one call, once the time is known. `None` if the driver has no timers
    /// ([`super::gl::GlInfo::has_timers`]).
    pub fn gpu_time(&mut self) -> Option<Duration> {
        self.painter.clock.drain()
    }

    /// Copies the finished image to the window's framebuffer of `window` pixels. Enlarges it if the window is larger.
    ///
    /// # Errors
    /// Fails if the driver reports an error.
    pub fn show(&self, window: (u32, u32)) -> Result<()> {
        self.presenter.show(&self.painter.post.passes, self.painter.canvas.finished(), window)?;
        self.gl.check_context("showing a frame")
    }

    /// Draws the image to `area` of the window's framebuffer, which has `window` pixels; the rest of the window does not
    /// change. `map` maps positions in the area to positions in the image, both as fractions to the right and down. Only
    /// `part` of the image is visible; the rest of the area is black.
    ///
    /// # Errors
    /// Fails if the driver reports an error, or if there is no memory for a copy with limited flashes.
    pub fn show_in_part(&mut self, window: (u32, u32), area: Area, map: &Map, part: Area) -> Result<()> {
        let (passes, finished) = (&self.painter.post.passes, self.painter.canvas.finished());
        if let Some((placing, picture)) = self.presenter.placed(passes, finished)? {
            placing.place(passes, picture, window, area, map, part)?;
        }
        self.gl.check_context("showing a frame")
    }

    /// Sends the image to `reader`, placed as by [`Renderer::show_in_part`] in a window of the reader's size, top row
    /// first. Returns `false` if the image was skipped because too many images are pending.
    ///
    /// # Errors
    /// Same errors as [`Renderer::show_in_part`].
    pub fn send_placed(&mut self, reader: &mut PictureReader, map: &Map, part: Area) -> Result<bool> {
        let (passes, finished) = (&self.painter.post.passes, self.painter.canvas.finished());
        let placed = self.presenter.placed(passes, finished)?;
        if let Some((placing, picture)) = placed {
            placing.place_in(passes, picture, &reader.target, map, part)?;
        }
        let sent = placed.is_some() && reader.begin();
        self.gl.check("sending an image").map(|()| sent)
    }

    /// The finished image with limited flashes, four bytes per pixel, top row first. Empty before the first draw.
    pub fn read(&self) -> Vec<u8> {
        self.presenter.read(self.painter.canvas.finished())
    }

    /// Distance evaluations of the last image, divided by a number of pixels; zero without [`Counting::On`].
    pub fn evaluations(&self, pixels: f64) -> Evaluations {
        let targets = self.painter.canvas.targets.as_ref().filter(|_| self.painter.counting == Counting::On);
        targets.map_or_else(Evaluations::default, |targets| {
            targets.evaluations(self.painter.sampling.edge_samples, pixels)
        })
    }

    /// The number of pixels with further samples in the last image.
    pub fn edge_pixels(&self) -> f64 {
        let targets = self.painter.canvas.targets.as_ref();
        targets.map_or(0.0, |targets| targets.edge_pixels(self.painter.sampling.edge_samples))
    }
}
