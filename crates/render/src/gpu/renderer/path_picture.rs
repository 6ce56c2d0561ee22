//! Images by paths of light: drawn in one call for stills and videos, or in several calls for a window, which shows the
//! image while it gets better.

use std::time::Duration;

use web_time::Instant;

use super::Renderer;
use super::making::{Making, Product, Tools};
use super::painter::Painter;
use super::paths::{
    Look, PATHS_MAX, PathArea, PathOrder, PathProgress, PathRun, PathSampling, PathWatcher, areas, endless,
};
use super::targets::Targets;
use crate::frame::Frame;
use crate::frame::block::FrameBlock;
use crate::frame::picture::Picture;
use crate::gpu::error::Result;
use crate::gpu::path_state::PathState;
use crate::gpu::program::Program;
use crate::gpu::scene_resources::{SceneNames, SceneResources};
use crate::gpu::tiles::{PixelCost, Tile};

/// An image that several calls draw ([`super::Renderer::refine`]).
pub struct PathPicture {
    frame: Frame,
    order: PathOrder,
    run: PathRun,
    guides: Option<PathRun>,
    cost: PixelCost,
    /// The number of paths of the shown image.
    shown: u64,
}

impl PathPicture {
    /// The number of pixels of the image.
    pub fn pixels(&self) -> u64 {
        Tile::whole(self.frame.size).pixels()
    }
}

impl Renderer {
    /// Draws `frame` by paths of light, with a program of [`crate::gpu::scene_program::path_texts`]. The lens and the
    /// media are part of the paths.
    ///
    /// # Errors
    /// Same errors as [`Renderer::draw`].
    pub fn draw_paths(
        &mut self,
        frame: &Frame,
        scene: &SceneResources,
        program: &Program,
        order: PathOrder,
        watcher: &mut dyn PathWatcher,
    ) -> Result<PathProgress> {
        let painter = &mut self.painter;
        let Some(targets) = painter.prepare_paths(frame, scene, program)? else {
            return Ok(PathProgress { fraction: 0.0, paths: 0 });
        };
        let mut cost = scene.costs.of(program);
        let mut paths = 0;
        let areas = areas(frame.size);
        let mut state = None;
        for (number, area) in areas.iter().copied().enumerate() {
            let size = (area.width, area.height);
            let own = state.take().filter(|state: &PathState| state.size == size);
            let own = own.map_or_else(|| PathState::new(&painter.gl, size), Ok)?;
            let mut run = PathRun::over(own);
            if let Some(kept) = watcher.begin(frame, area.pixels() as usize) {
                run.resume(&kept);
            }
            scene.names(program).bind(&painter.gl);
            let (sampling, passes) = (&painter.sampling, &painter.post.passes);
            let drawing = PathArea { sampling, passes, program, order, area };
            paths += drawing.draw(&mut run, &mut cost, &mut |so_far, state| {
                let fraction = (number as f64 + so_far.fraction) / areas.len() as f64;
                watcher.resume(PathProgress { fraction, paths: paths + so_far.paths }, &|| state.kept())
            });
            watcher.end(number + 1 == areas.len(), &|| run.state.kept());
            let mut guides = painter.guides(order, size)?;
            guides.iter_mut().for_each(|guides| {
                drawing.guide(guides, &mut cost, endless());
            });
            let guides = guides.as_ref().map(|guides| &guides.state);
            drawing.resolve(&run.state, guides, &painter.path_results, &targets.post.light)?;
            state = Some(run.state);
        }
        scene.costs.keep(program, cost);
        painter.finish_paths(frame, scene, targets)?;
        Ok(PathProgress { fraction: 1.0, paths })
    }

    /// Begins an image by paths of light that [`Renderer::refine`] draws.
    ///
    /// # Errors
    /// Fails if the driver has no memory for the paths of an image of this size.
    pub fn begin_paths(&self, frame: Frame, order: PathOrder) -> Result<PathPicture> {
        let run = self.painter.run(frame.size)?;
        let guides = self.painter.guides(order, frame.size)?;
        Ok(PathPicture { frame, order, run, guides, cost: PixelCost::default(), shown: 0 })
    }

    /// Continues an image by paths of light for about `patience`, with the same scene and a program of
    /// [`crate::gpu::scene_program::as_paths`]. Returns the progress if the image has become better; its fraction is 1 at
    /// the end. The previous image stays until the first paths are finished.
    ///
    /// # Errors
    /// Same errors as [`Renderer::draw`].
    pub fn refine(
        &mut self,
        picture: &mut PathPicture,
        scene: &SceneResources,
        program: &Program,
        patience: Duration,
    ) -> Result<Option<PathProgress>> {
        let (painter, patience) = (&mut self.painter, (Instant::now(), patience));
        let PathPicture { frame, order, run, guides, cost, shown } = picture;
        let Some(targets) = painter.prepare_paths(frame, scene, program)? else { return Ok(None) };
        let area = Tile::whole(frame.size);
        let (sampling, passes) = (&painter.sampling, &painter.post.passes);
        let drawing = PathArea { sampling, passes, program, order: *order, area };
        let most = order.samples.clamp(1, PATHS_MAX);
        let is_guided = guides.as_mut().is_none_or(|guides| drawing.guide(guides, cost, patience));
        let look = if is_guided { drawing.resume(run, cost, most, patience) } else { None };
        // Another image is worth its filter if it has many more paths.
        let look = look.filter(|look| look.is_finished || 4 * look.paths >= 5 * *shown);
        let Some(Look { paths, is_finished }) = look.filter(|look| look.paths > 0) else {
            painter.canvas.targets = Some(targets);
            painter.gl.check("drawing paths")?;
            return Ok(None);
        };
        let guides = guides.as_ref().map(|guides| &guides.state);
        drawing.resolve(&run.state, guides, &painter.path_results, &targets.post.light)?;
        *shown = paths;
        painter.finish_paths(frame, scene, targets)?;
        self.presenter.flashes.is_limited = false;
        let fraction = paths as f64 / (u64::from(most) * area.pixels()) as f64;
        Ok(Some(PathProgress { fraction: if is_finished { 1.0 } else { fraction.min(0.999) }, paths }))
    }

    /// Draws a few paths of light from a frame's blocks and the bound objects of a scene. The image is of no use.
    ///
    /// # Errors
    /// Same errors as [`Renderer::draw`].
    pub fn draw_path_block(
        &mut self,
        size: (u32, u32),
        block: &FrameBlock,
        picture: &Picture,
        scene: &SceneNames,
        program: &Program,
    ) -> Result<()> {
        let painter = &mut self.painter;
        painter.begin_block(Product::Light, size, block, picture)?;
        painter.canvas.making = None;
        painter.post.passes.prepare();
        if let Some(targets) = &painter.canvas.targets {
            painter.sampling.settle_samplers(&targets.first)?;
        }
        scene.bind(&painter.gl);
        let sampling = PathSampling::Both;
        let order = PathOrder { samples: 1, noise: 0.0, first: 0, sampling, is_filtered: false };
        let (sampling, passes, area) = (&painter.sampling, &painter.post.passes, Tile::whole(size));
        let drawing = PathArea { sampling, passes, program, order, area };
        drawing.draw(&mut painter.run(size)?, &mut PixelCost::default(), &mut |_, _| false);
        painter.gl.check("drawing paths")
    }
}

impl Painter {
    fn run(&self, size: (u32, u32)) -> Result<PathRun> {
        PathState::new(&self.gl, size).map(PathRun::over)
    }

    fn guides(&self, order: PathOrder, size: (u32, u32)) -> Result<Option<PathRun>> {
        order.is_filtered.then(|| self.run(size)).transpose()
    }

    /// Sets everything that the paths of a frame read. Returns the targets of the image, or `None` without targets.
    fn prepare_paths(
        &mut self,
        frame: &Frame,
        scene: &SceneResources,
        program: &Program,
    ) -> Result<Option<Targets>> {
        let block = scene.block_of(frame);
        scene.upload_inputs(frame)?;
        self.need_targets(frame.size, &of_paths(frame))?;
        let Some(targets) = self.canvas.targets.take() else { return Ok(None) };
        self.sampling.set_frame(&block);
        self.post.bind_picture(&frame.picture, self.sampling.edge_samples);
        self.post.passes.prepare();
        self.sampling.settle_samplers(&targets.first)?;
        scene.names(program).bind(&self.gl);
        Ok(Some(targets))
    }

    /// Finishes the image of the light of paths.
    fn finish_paths(&mut self, frame: &Frame, scene: &SceneResources, mut targets: Targets) -> Result<()> {
        let picture = of_paths(frame);
        let mut making = Making::new(picture, Product::Picture);
        making.trails = scene.feedback().and_then(|feedback| feedback.trails(frame));
        self.post.bind_picture(&picture, self.sampling.edge_samples);
        let tools = Tools { sampling: &self.sampling, post: &self.post, fade: self.fade.as_ref() };
        making.finish_resolved(&tools, &mut targets)?;
        self.canvas.targets = Some(targets);
        self.canvas.finish(&making);
        self.gl.check("drawing paths")
    }
}

/// The image of a frame by paths, which contain the lens and the media.
fn of_paths(frame: &Frame) -> Picture {
    Picture { lens: None, has_media: false, ..frame.picture }
}
