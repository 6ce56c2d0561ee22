//! Draws a frame: one sample per pixel, further samples at edges, then the finished image ([`super::post`]).
//!
//! 1. `scene.frag` traces one sample at each pixel's centre.
//! 2. `edges.frag` marks the pixels whose neighbourhood differs visibly in the stencil.
//! 3. `scene.frag` traces further samples in the marked pixels, each at another position in the pixel.
//!
//! A frame is drawn in parts, in one call or several (`making`). `presenter` brings the finished image to the screen.
//!
//! The same program draws every sample in one GL state, because some drivers compile a program once for each state.
//! Programs belong to scenes, and the renderer draws with any scene's.
//!
//! **Further samples at edges only.** If neighbours show different surfaces (a key in alpha) and visibly different
//! colours, the same program draws more: four in the window (6 to 13 % of the pixels; two while an interpreted scene is
//! being edited), sixteen in stills and videos, which also search for the edges of shadows. `bench --edges` compares
//! them with 64 samples everywhere. A GPU selects these pixels by a stencil, a software renderer lists them
//! (`edge_list`).

mod canvas;
mod fade;
mod flashes;
mod making;
mod painter;
mod placing;
mod presenter;
mod sampling;
mod targets;

use std::time::Duration;

use super::edge_samples::EdgeSamples;
use super::error::GpuError;
pub use super::evaluations::{Counting, Evaluations};
use super::flash_pass::FlashPass;
use super::gl::Gl;
use super::picture_reader::PictureReader;
use super::program::Program;
use super::scene_resources::{SceneNames, SceneResources};
use super::shader_source::ShaderLibrary;
use super::target::Target;
use super::tiles::Costs;
use super::timer::PictureClock;
use crate::frame::Frame;
use crate::frame::block::FrameBlock;
use crate::frame::picture::Picture;
use crate::placement::{Area, Map, Placement, WHOLE};
use crate::view::legend::LegendPicture;
use crate::view::setup::ViewBlock;
use canvas::Canvas;
use making::Product;
pub use making::Progress;
use mariana_field::world::ToneMap;
use painter::Painter;
pub use placing::PLACING_SHADERS;
use placing::Placing;
use presenter::Presenter;
pub use presenter::UPSCALE_SHADER;
pub use sampling::EDGE_SHADER;

/// Draws scenes; holds the targets and the programs that all scenes share.
pub struct Renderer {
    gl: Gl,
    painter: Painter,
    presenter: Presenter,
}

/// The targets of small previews of other scenes ([`Renderer::sketch`]), which are drawn one after the other.
#[derive(Default)]
pub struct Sketch(Canvas);

impl Renderer {
    /// Compiles the shaders that all scenes share. With [`Counting::On`], scenes' programs must count too.
    ///
    /// # Errors
    /// The driver's log, for a rejected shader.
    pub fn new(gl: &Gl, library: &ShaderLibrary, counting: Counting) -> Result<Self, GpuError> {
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
    /// As [`Renderer::new`].
    pub fn prepare_for_window(&mut self, library: &ShaderLibrary) -> Result<(), GpuError> {
        self.presenter.prepare_for_window(&self.gl, library)?;
        self.add_dimming(library)?;
        self.time_pictures()
    }

    /// Enables [`Renderer::dim`].
    ///
    /// # Errors
    /// As [`Renderer::new`].
    pub fn add_dimming(&mut self, library: &ShaderLibrary) -> Result<(), GpuError> {
        self.presenter.placing = Some(Placing::new(&self.gl, library)?);
        Ok(())
    }

    /// Times the GPU, so that parts shrink when pixels become expensive. Use no other timer while a frame is drawn.
    ///
    /// # Errors
    /// [`GpuError::Object`] if the driver has no query left.
    pub fn time_pictures(&mut self) -> Result<(), GpuError> {
        if !self.gl.info().software {
            self.painter.clock = PictureClock::new(&self.gl)?;
        }
        Ok(())
    }

    /// Enables [`Renderer::limit_flashes`].
    ///
    /// # Errors
    /// As [`Renderer::new`].
    pub fn add_flash_limiter(&mut self, library: &ShaderLibrary) -> Result<(), GpuError> {
        self.presenter.flashes.pass = Some(FlashPass::new(&self.gl, library)?);
        Ok(())
    }

    /// Disables [`Renderer::limit_flashes`].
    pub fn remove_flash_limiter(&mut self) {
        self.presenter.flashes.remove();
    }

    /// Overrides the scenes' tone map; `None` restores it.
    pub fn set_tone_map(&mut self, tone_map: Option<ToneMap>) {
        self.painter.post.set_tone_map(tone_map);
    }

    /// Sets the number of further samples at edges; the default is four.
    pub fn set_edge_samples(&mut self, samples: EdgeSamples) {
        self.painter.set_edge_samples(samples);
    }

    /// Draws an invisible empty image with every pass of a window's first frame while `is_wanted` returns true, because
    /// many drivers finish a program only at its first draw. Has no effect after the first draw.
    ///
    /// # Errors
    /// As [`Renderer::draw`].
    pub fn warm_up(
        &mut self,
        picture: &Picture,
        is_wanted: &mut dyn FnMut() -> bool,
    ) -> Result<(), GpuError> {
        if let Some(targets) = self.painter.warm_up(picture)? {
            self.presenter.warm_up(self.painter.passes(), targets.post.finished(), is_wanted)?;
        }
        self.gl.check("drawing an empty image")
    }

    /// Draws `frame` into the renderer's target; [`Renderer::show`] or [`Renderer::read`] outputs it.
    ///
    /// # Errors
    /// A size over the driver's limit, or an error that the driver reports.
    pub fn draw(&mut self, frame: &Frame, scene: &SceneResources, program: &Program) -> Result<(), GpuError> {
        self.begin(frame, scene)?;
        self.go_on(scene, program, Duration::MAX).map(|_| ())
    }

    /// Begins a frame, which replaces any unfinished one. [`Renderer::go_on`] draws it.
    ///
    /// # Errors
    /// As [`Renderer::draw`].
    pub fn begin(&mut self, frame: &Frame, scene: &SceneResources) -> Result<(), GpuError> {
        self.painter.begin(Product::Picture, frame, scene)
    }

    /// Begins a frame that only provides light for [`Renderer::keep_light`]. The previous image stays until then.
    ///
    /// # Errors
    /// As [`Renderer::draw`].
    pub fn begin_light(&mut self, frame: &Frame, scene: &SceneResources) -> Result<(), GpuError> {
        self.painter.begin(Product::Light, frame, scene)
    }

    /// Begins a view as [`Renderer::begin`] begins a frame. Draw its legend last ([`Renderer::put_legend`]).
    ///
    /// # Errors
    /// As [`Renderer::draw`].
    pub fn begin_view(
        &mut self,
        frame: &Frame,
        scene: &SceneResources,
        view: &ViewBlock,
    ) -> Result<(), GpuError> {
        self.painter.sampling.set_view(view);
        self.painter.begin(Product::View, frame, scene)
    }

    /// Continues the frame for about `patience`, with the same scene and program. [`Duration::MAX`] finishes it.
    ///
    /// # Errors
    /// As [`Renderer::draw`].
    pub fn go_on(
        &mut self,
        scene: &SceneResources,
        program: &Program,
        patience: Duration,
    ) -> Result<Progress, GpuError> {
        if !self.presenter.is_for_window() {
            // Without a window, nothing else reads the time of the last frame.
            self.painter.clock.take();
        }
        let is_light =
            self.painter.canvas.making.as_ref().is_none_or(|making| making.product == Product::Light);
        let progress = self.painter.go_on(&scene.names(), (program, scene.costs()), patience)?;
        if matches!(progress, Progress::Finished { .. }) && !is_light {
            self.presenter.flashes.expect_another();
        }
        Ok(progress)
    }

    /// Draws an image of `size` pixels from a frame's blocks and the bound objects of a scene.
    ///
    /// # Errors
    /// As [`Renderer::draw`].
    pub fn draw_block(
        &mut self,
        size: (u32, u32),
        blocks: (&FrameBlock, &Picture),
        scene: &SceneNames,
        program: &Program,
    ) -> Result<(), GpuError> {
        self.painter.begin_block(Product::Picture, size, blocks)?;
        self.painter.go_on(scene, (program, &Costs::default()), Duration::MAX).map(|_| ())
    }

    /// Draws a view of `frame` with a program of [`super::scene_program::as_views`], and its legend over it. Its
    /// colours are those of the screen: no post-processing changes them, and each pixel has one sample.
    ///
    /// # Errors
    /// As [`Renderer::draw`].
    pub fn draw_view(
        &mut self,
        frame: &Frame,
        scene: &SceneResources,
        program: &Program,
        (view, legend): (&ViewBlock, Option<&LegendPicture>),
    ) -> Result<(), GpuError> {
        self.begin_view(frame, scene, view)?;
        self.go_on(scene, program, Duration::MAX)?;
        self.put_legend(legend)
    }

    /// Draws a view from a frame's block and the bound objects of a scene, without a legend.
    ///
    /// # Errors
    /// As [`Renderer::draw`].
    pub fn draw_view_block(
        &mut self,
        size: (u32, u32),
        blocks: (&FrameBlock, &Picture),
        scene: &SceneNames,
        program: &Program,
        view: &ViewBlock,
    ) -> Result<(), GpuError> {
        self.painter.sampling.set_view(view);
        self.painter.begin_block(Product::View, size, blocks)?;
        self.painter.go_on(scene, (program, &Costs::default()), Duration::MAX).map(|_| ())
    }

    /// Draws a legend over the finished view.
    ///
    /// # Errors
    /// An error that the driver reports.
    pub fn put_legend(&mut self, legend: Option<&LegendPicture>) -> Result<(), GpuError> {
        if let (Some(targets), Some(legend)) = (&self.painter.canvas.targets, legend) {
            targets.post.finished().put_rgba8((legend.margin, legend.margin), legend.size, &legend.rgba);
        }
        self.gl.check("drawing a legend")
    }

    /// Draws `frame` with a regular grid of 64 samples per pixel, as a reference for other images. Slow.
    ///
    /// # Errors
    /// As [`Renderer::draw`].
    pub fn draw_reference(
        &mut self,
        frame: &Frame,
        scene: &SceneResources,
        program: &Program,
    ) -> Result<(), GpuError> {
        self.draw(frame, scene, program)?;
        self.painter.draw_reference(&frame.picture, &scene.names(), program)
    }

    /// Draws a small invisible image, so that the driver compiles everything for this context and the cost of pixels is
    /// known. The finished image stays; a frame in progress is lost.
    ///
    /// # Errors
    /// As [`Renderer::draw`].
    pub fn rehearse(
        &mut self,
        frame: &Frame,
        scene: &SceneResources,
        program: &Program,
    ) -> Result<(), GpuError> {
        self.painter.rehearse(frame, scene, program)
    }

    /// Draws an invisible preview for `reader`; `false` if too many are pending. A frame in progress is lost.
    ///
    /// # Errors
    /// As [`Renderer::draw`].
    pub fn sketch(
        &mut self,
        sketch: &mut Sketch,
        frame: &Frame,
        (scene, program): (&SceneResources, &Program),
        reader: &mut PictureReader,
    ) -> Result<bool, GpuError> {
        let placing = self.presenter.placing.as_ref();
        self.painter.sketch(&mut sketch.0, (frame, scene, program), |passes, picture| {
            let Some(placing) = placing else { return Ok(false) };
            let whole = Placement::default();
            placing.place_in(passes, picture, reader.target(), (&whole.map(), whole.part()))?;
            Ok(reader.begin())
        })
    }

    /// Keeps the finished image's light for fades. `false` if there is none: for a view, or after dropping targets.
    ///
    /// # Errors
    /// No memory for the light.
    pub fn keep_light(&mut self) -> Result<bool, GpuError> {
        self.painter.keep_light()
    }

    /// The exposed linear light of the finished image: four numbers per pixel, top row first. Empty for a view.
    ///
    /// # Errors
    /// No memory for the light.
    pub fn read_light(&self) -> Result<Vec<f32>, GpuError> {
        Ok(self.painter.exposed(None)?.map_or_else(Vec::new, |light| light.read_rgba32f(0)))
    }

    /// Sets the fraction, 0..1, of the kept light in further finished images. `None` discards the light.
    pub fn set_fade(&mut self, fraction: Option<f32>) {
        self.painter.set_fade(fraction);
    }

    /// Width and height of the displayed image, in pixels.
    pub fn shape(&self) -> Option<(u32, u32)> {
        self.painter.finished().map(Target::size)
    }

    /// The brightness of the displayed image, 0..1.
    pub fn gain(&self) -> f32 {
        self.presenter.placing.as_ref().map_or(1.0, Placing::gain)
    }

    /// Dims the finished image to this brightness, 0..1. Call it for each image before [`Renderer::limit_flashes`],
    /// which measures the dimmed one. Requires [`Renderer::add_dimming`].
    ///
    /// # Errors
    /// No memory for a copy of the image.
    pub fn dim(&mut self, gain: f32) -> Result<(), GpuError> {
        self.presenter.dim(self.painter.passes(), self.painter.finished(), gain)?;
        self.gl.check("dimming an image")
    }

    /// Dims excessive flashes in the finished image, which is shown `seconds` after the previous one.
    ///
    /// # Errors
    /// No memory for a copy of the image; windows need no copy.
    pub fn limit_flashes(&mut self, seconds: f64) -> Result<(), GpuError> {
        self.presenter.limit_flashes(&self.gl, self.painter.finished(), seconds)?;
        self.gl.check("limiting flashes")
    }

    /// Makes the flash limiter forget earlier images, because the user has switched to other content.
    pub fn forget_flashes(&mut self) {
        self.presenter.flashes.pass.iter_mut().for_each(FlashPass::forget);
    }

    /// The GPU time of an image drawn in one call, if newly known. Always `None` on a software renderer.
    pub fn gpu_time(&mut self) -> Option<Duration> {
        self.painter.clock.take()
    }

    /// Copies the finished image to the window's framebuffer of `window` pixels, enlarged if the window is larger.
    ///
    /// # Errors
    /// An error that the driver reports.
    pub fn show(&self, window: (u32, u32)) -> Result<(), GpuError> {
        self.presenter.show(self.painter.passes(), self.painter.finished(), window)?;
        self.gl.check("showing a frame")
    }

    /// Draws the image to the window's framebuffer of `window` pixels. `map` maps positions in the window to positions
    /// in the image, both as fractions to the right and down. Only `part` of the image is visible; the rest is black.
    ///
    /// # Errors
    /// An error that the driver reports, or no memory for a copy with limited flashes.
    pub fn show_placed(&mut self, window: (u32, u32), map: &Map, part: Area) -> Result<(), GpuError> {
        self.show_in_part(window, WHOLE, map, part)
    }

    /// Like [`Renderer::show_placed`], in `area` of the window only; the rest of the window does not change.
    ///
    /// # Errors
    /// As [`Renderer::show_placed`].
    pub fn show_in_part(
        &mut self,
        window: (u32, u32),
        area: Area,
        map: &Map,
        part: Area,
    ) -> Result<(), GpuError> {
        let (passes, finished) = (self.painter.passes(), self.painter.finished());
        self.presenter.show_in_part(passes, finished, (window, area), (map, part))?;
        self.gl.check("showing a frame")
    }

    /// Sends the image to `reader`, placed as by [`Renderer::show_placed`] in a window of the reader's size, top row
    /// first. Returns `false` if it was skipped because too many are pending.
    ///
    /// # Errors
    /// As [`Renderer::show_placed`].
    pub fn send_placed(
        &mut self,
        reader: &mut PictureReader,
        map: &Map,
        part: Area,
    ) -> Result<bool, GpuError> {
        let finished = self.painter.finished();
        let sent = self.presenter.send(self.painter.passes(), finished, reader, (map, part))?;
        self.gl.check("sending an image").map(|()| sent)
    }

    /// The finished image with limited flashes, four bytes per pixel, top row first. Empty before the first draw.
    pub fn read(&self) -> Vec<u8> {
        self.presenter.read(self.painter.finished())
    }

    /// Distance evaluations of the last image; zero without [`Counting::On`].
    pub fn evaluations(&self) -> Evaluations {
        let targets = self.painter.canvas.targets.as_ref().filter(|_| self.painter.counting == Counting::On);
        targets.map_or_else(Evaluations::default, |targets| {
            targets.evaluations(self.painter.sampling.edge_samples)
        })
    }

    /// The number of pixels with further samples in the last image.
    pub fn edge_pixels(&self) -> f64 {
        let targets = self.painter.canvas.targets.as_ref();
        targets.map_or(0.0, |targets| targets.edge_pixels(self.painter.sampling.edge_samples))
    }
}
