//! Draws a frame: one sample per pixel, more samples at edges, then the finished picture ([`super::post`]).
//!
//! 1. `scene.frag` traces one sample at each pixel's centre.
//! 2. `edges.frag` marks in the stencil the pixels whose neighbourhood differs visibly.
//! 3. `scene.frag` again, only there: more samples, each at another place in the pixel.
//!
//! A picture is drawn in parts, in one go or several (`making`). What happens to it on its way to screens stands in
//! `presenter`.
//!
//! The same program draws every sample, so that a driver compiles the scene once. The program belongs to the scene:
//! the renderer draws with any scene's.
//!
//! **Samples where edges are.** Every pixel gets one sample. If neighbours show different surfaces (a key in alpha)
//! and visibly different colours, the same program draws more: four in the window (6 to 13 % of the pixels; two while
//! a scene that is interpreted is being edited), sixteen in stills and videos, which also look for the edges of shadows. `bench --edges` compares them with 64 samples
//! everywhere. On a GPU a stencil selects these pixels. A software renderer computes eight neighbours at once, and
//! those few pixels would cost more than the first samples of all: there they are read back and listed, and their
//! samples are drawn side by side. All samples are drawn in one GL state, because some drivers compile a program once
//! for each state. Textures are filtered by mip levels with exact footprints.

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

/// The targets of the picture and the programs that all scenes share.
pub struct Renderer {
    gl: Gl,
    painter: Painter,
    presenter: Presenter,
}

/// Where small pictures of other scenes are drawn ([`Renderer::sketch`]), one after the other.
#[derive(Default)]
pub struct Sketch(Canvas);

impl Renderer {
    /// Compiles the shaders of `library` that all scenes share. With [`Counting::On`], scenes' programs must be of
    /// the counting variant.
    ///
    /// # Errors
    /// What the driver refuses, with its log.
    pub fn new(gl: &Gl, library: &ShaderLibrary, counting: Counting) -> Result<Self, GpuError> {
        let renderer = Self {
            gl: gl.clone(),
            painter: Painter::new(gl, library, counting)?,
            presenter: Presenter::default(),
        };
        gl.check("setting up the renderer")?;
        Ok(renderer)
    }

    /// The context that it draws in.
    pub fn gl(&self) -> &Gl {
        &self.gl
    }

    /// Prepares what only a window needs: showing pictures that are smaller, and reporting how long they take.
    ///
    /// # Errors
    /// As [`Renderer::new`].
    pub fn prepare_for_window(&mut self, library: &ShaderLibrary) -> Result<(), GpuError> {
        self.presenter.prepare_for_window(&self.gl, library)?;
        self.add_dimming(library)?;
        self.time_pictures()
    }

    /// From now on [`Renderer::dim`] takes effect.
    ///
    /// # Errors
    /// As [`Renderer::new`].
    pub fn add_dimming(&mut self, library: &ShaderLibrary) -> Result<(), GpuError> {
        self.presenter.placing = Some(Placing::new(&self.gl, library)?);
        Ok(())
    }

    /// From now on a GPU's times of pictures are taken, so that their parts become smaller where pixels become dearer.
    /// No other timer may run while one is drawn.
    ///
    /// # Errors
    /// [`GpuError::Object`] if the driver has no query left.
    pub fn time_pictures(&mut self) -> Result<(), GpuError> {
        if !self.gl.info().software {
            self.painter.clock = PictureClock::new(&self.gl)?;
        }
        Ok(())
    }

    /// From now on [`Renderer::limit_flashes`] takes effect.
    ///
    /// # Errors
    /// As [`Renderer::new`].
    pub fn add_flash_limiter(&mut self, library: &ShaderLibrary) -> Result<(), GpuError> {
        self.presenter.flashes.pass = Some(FlashPass::new(&self.gl, library)?);
        Ok(())
    }

    /// [`Renderer::limit_flashes`] has no effect any more.
    pub fn remove_flash_limiter(&mut self) {
        self.presenter.flashes.remove();
    }

    /// Uses this tone map from now on, whatever scenes say; none means as they say.
    pub fn set_tone_map(&mut self, tone_map: Option<ToneMap>) {
        self.painter.post.set_tone_map(tone_map);
    }

    /// From now on pixels at edges get this many samples; the default is four.
    pub fn set_edge_samples(&mut self, samples: EdgeSamples) {
        self.painter.set_edge_samples(samples);
    }

    /// Draws an empty picture that nobody sees with every pass that a scene's first picture in a window takes, made as
    /// `picture` says, for as long as that `is_wanted`; what the limiter of flashes takes comes last. Many drivers finish a
    /// program only when it first draws. Nothing happens once something was drawn.
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
        self.gl.check("drawing an empty picture")
    }

    /// Draws `frame` of a scene with one of its programs into the renderer's own target; [`Renderer::show`] or
    /// [`Renderer::read`] brings it out.
    ///
    /// # Errors
    /// A size beyond the driver's, or an error that the driver reports.
    pub fn draw(&mut self, frame: &Frame, scene: &SceneResources, program: &Program) -> Result<(), GpuError> {
        self.begin(frame, scene)?;
        self.go_on(scene, program, Duration::MAX).map(|_| ())
    }

    /// Begins a picture in place of any that was not finished; [`Renderer::go_on`] draws it.
    ///
    /// # Errors
    /// As [`Renderer::draw`].
    pub fn begin(&mut self, frame: &Frame, scene: &SceneResources) -> Result<(), GpuError> {
        self.painter.begin(Product::Picture, frame, scene)
    }

    /// Begins a picture of which only the light is wanted, for [`Renderer::keep_light`]; what was finished before is shown
    /// until the next picture is finished.
    ///
    /// # Errors
    /// As [`Renderer::draw`].
    pub fn begin_light(&mut self, frame: &Frame, scene: &SceneResources) -> Result<(), GpuError> {
        self.painter.begin(Product::Light, frame, scene)
    }

    /// Begins a view as [`Renderer::begin`] begins a picture. Its legend is put over it at the end.
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

    /// Continues the picture that was begun, in the same scene and with one program, for about `patience`; until the
    /// picture is finished if that is [`Duration::MAX`].
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
            // Nobody else asks for the time of the last picture.
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

    /// Draws a picture of `size` pixels from a frame's blocks and what is bound for its scene.
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
    /// colours are the screen's: no pass of the picture changes them, and no pixel is a mean of several samples.
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

    /// Draws a view from a frame's block and what is bound for its scene, without a legend.
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

    /// Puts a legend over the view that was finished.
    ///
    /// # Errors
    /// An error that the driver reports.
    pub fn put_legend(&mut self, legend: Option<&LegendPicture>) -> Result<(), GpuError> {
        if let (Some(targets), Some(legend)) = (&self.painter.canvas.targets, legend) {
            targets.post.finished().put_rgba8((legend.margin, legend.margin), legend.size, &legend.rgba);
        }
        self.gl.check("drawing a legend")
    }

    /// Draws `frame` with a regular grid of 64 samples in each pixel, the reference for other pictures. Slow.
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

    /// Draws a small picture that nobody sees, so that the driver has nothing left to make when the scene is shown,
    /// and the costs of its pixels are known: many drivers finish a program only at its first draw, and separately in each
    /// context. What was finished last stays. A picture that is being drawn would be lost.
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

    /// Draws a picture that nobody sees here, and sends it on its way to `reader`. What was finished last stays. A picture
    /// that is being drawn would be lost. False if it was left out, because too many are on their way.
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

    /// Keeps the light of the picture that was finished last, to be mixed into the next ones. Returns whether there
    /// is any: a view has none, nor has a picture whose targets have gone.
    ///
    /// # Errors
    /// No room for it.
    pub fn keep_light(&mut self) -> Result<bool, GpuError> {
        self.painter.keep_light()
    }

    /// The light of the picture that was finished last, exposed and linear: four numbers per pixel, the top row first.
    /// Empty for a view.
    ///
    /// # Errors
    /// No room for it.
    pub fn read_light(&self) -> Result<Vec<f32>, GpuError> {
        Ok(self.painter.exposed(None)?.map_or_else(Vec::new, |light| light.read_rgba32f(0)))
    }

    /// From now on this share of finished pictures, 0..1, is the light that was kept. Without a share it is
    /// forgotten.
    pub fn set_fade(&mut self, fraction: Option<f32>) {
        self.painter.set_fade(fraction);
    }

    /// Width and height of the picture that shows, in pixels.
    pub fn shape(&self) -> Option<(u32, u32)> {
        self.painter.finished().map(Target::size)
    }

    /// The share of the light that the picture which shows has left, 0..1.
    pub fn gain(&self) -> f32 {
        self.presenter.placing.as_ref().map_or(1.0, Placing::gain)
    }

    /// Leaves the picture that was finished last this share of its light, 0..1. It is to be called for each picture,
    /// before its flashes are limited: they are those of what shows. Only a renderer does it that was told to
    /// ([`Renderer::add_dimming`]).
    ///
    /// # Errors
    /// No room for a copy of the picture.
    pub fn dim(&mut self, gain: f32) -> Result<(), GpuError> {
        self.presenter.dim(self.painter.passes(), self.painter.finished(), gain)?;
        self.gl.check("dimming a picture")
    }

    /// Dims what flashes too often in the picture that was drawn last, which is shown `seconds` after the one before.
    ///
    /// # Errors
    /// No room for a copy of the picture, which all but windows need.
    pub fn limit_flashes(&mut self, seconds: f64) -> Result<(), GpuError> {
        self.presenter.limit_flashes(&self.gl, self.painter.finished(), seconds)?;
        self.gl.check("limiting flashes")
    }

    /// What comes next is not compared with what was drawn before, because the user changed from one to the other by
    /// hand.
    pub fn forget_flashes(&mut self) {
        self.presenter.flashes.pass.iter_mut().for_each(FlashPass::forget);
    }

    /// How long the GPU took for one of the last pictures that were drawn in one go, if that has become known since
    /// the last call; never on a software renderer.
    pub fn gpu_time(&mut self) -> Option<Duration> {
        self.painter.clock.take()
    }

    /// Copies the finished picture to the window's framebuffer of `window` pixels, enlarged if that has more.
    ///
    /// # Errors
    /// An error that the driver reports.
    pub fn show(&self, window: (u32, u32)) -> Result<(), GpuError> {
        self.presenter.show(self.painter.passes(), self.painter.finished(), window)?;
        self.gl.check("showing a frame")
    }

    /// Copies the picture to the window's framebuffer of `window` pixels, where `map` says: from places in the window to
    /// places in the picture, both to the right and down as shares. `part` of the picture shows, and black around it.
    ///
    /// # Errors
    /// An error that the driver reports, or no room for a copy without flashes.
    pub fn show_placed(&mut self, window: (u32, u32), map: &Map, part: Area) -> Result<(), GpuError> {
        self.show_in_part(window, WHOLE, map, part)
    }

    /// The same in `area` of the window alone; the rest of it stays as it is.
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

    /// Sends the picture on its way to whoever reads it, as [`Renderer::show_placed`] puts it into a window of the
    /// reader's size, the top row first. False if it was left out, because too many are on their way.
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
        self.gl.check("sending a picture").map(|()| sent)
    }

    /// The finished picture, its flashes limited, four bytes per pixel, the top row first. Empty before the first draw.
    pub fn read(&self) -> Vec<u8> {
        self.presenter.read(self.painter.finished())
    }

    /// Distance evaluations of the last picture; zero without [`Counting::On`].
    pub fn evaluations(&self) -> Evaluations {
        let targets = self.painter.canvas.targets.as_ref().filter(|_| self.painter.counting == Counting::On);
        targets.map_or_else(Evaluations::default, |targets| {
            targets.evaluations(self.painter.sampling.edge_samples)
        })
    }

    /// Pixels that got the samples of an edge in the last picture.
    pub fn edge_pixels(&self) -> f64 {
        let targets = self.painter.canvas.targets.as_ref();
        targets.map_or(0.0, |targets| targets.edge_pixels(self.painter.sampling.edge_samples))
    }
}
