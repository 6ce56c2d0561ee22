//! Draws an image by paths of light (`path.frag`). Each pass continues the path of each pixel by one ray. From time to
//! time the pixels' numbers of paths are read, and blocks of pixels that are finished are no longer drawn.

#![expect(unsafe_code, reason = "every OpenGL call is unsafe in glow")]

use std::time::Duration;

use glow::HasContext;
use web_time::Instant;

use super::sampling::Sampling;
use crate::frame::Frame;
use crate::gpu::error::Result;
use crate::gpu::gl::Gl;
use crate::gpu::passes::Passes;
use crate::gpu::path_state::{KeptPaths, PathState};
use crate::gpu::program::{LazyProgram, Program, unit_of};
use crate::gpu::shader_source::{ShaderLibrary, Variant};
use crate::gpu::target::{Target, Texel};
use crate::gpu::tiles::{DrawTimer, Parts, PixelCost, Tile};

/// The shaders that compute an image from paths, and their defines. Tests compile all of them.
pub const PATH_RESULT_SHADERS: [(&str, &[&str]); 4] = [
    ("path_resolve.frag", &[]),
    ("path_filter.frag", &["FIRST"]),
    ("path_filter.frag", &[]),
    ("path_filter.frag", &["LAST"]),
];

/// The programs that compute an image from paths.
pub(super) struct PathResults {
    mean: LazyProgram,
    filter_first: LazyProgram,
    filter: LazyProgram,
    filter_last: LazyProgram,
}

impl PathResults {
    pub(super) fn new(gl: &Gl, library: &ShaderLibrary) -> Result<Self> {
        let [mean, first, middle, last] = PATH_RESULT_SHADERS
            .map(|(name, defines)| LazyProgram::new(gl, library, name, &Variant::of(defines)));
        Ok(Self { mean: mean?, filter_first: first?, filter: middle?, filter_last: last? })
    }
}

/// Passes of the filter; each one doubles its step.
const FILTER_PASSES: u32 = 5;

/// How an image is drawn by paths of light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathOrder {
    /// The largest number of paths of a pixel, 1..=[`PATHS_MAX`].
    pub samples: u32,
    /// Pixels get no more paths when their relative standard error is below this number; 0 for no such limit.
    pub noise: f32,
    /// The number of a pixel's first path. Images with other numbers have other noise.
    pub first: u32,
    /// How paths find light.
    pub sampling: PathSampling,
    /// True to smooth the noise that is left.
    pub is_filtered: bool,
}

/// Largest number of paths of a pixel, for which 32-bit floats count exactly.
pub const PATHS_MAX: u32 = u16::MAX as u32;

/// How paths find light. Images use both ways; tests compare them.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum PathSampling {
    /// Rays towards lights, and rays that meet lights by chance.
    #[default]
    Both,
    /// Only rays towards lights.
    Lights,
    /// Only rays that meet lights by chance.
    Lobes,
}

/// The paths so far.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathProgress {
    /// Fraction of the image's paths that are finished, 0..1. Pixels with little noise need fewer paths.
    pub fraction: f64,
    /// Number of paths.
    pub paths: u64,
}

/// Watches an image by paths, and may keep its paths for another run.
pub trait PathWatcher {
    /// Returns the paths that were kept of the next area of a frame, of this many pixels.
    fn begin(&mut self, frame: &Frame, pixels: usize) -> Option<KeptPaths>;

    /// Is called now and then; `kept` reads the area's paths. After it has returned false, every pixel finishes only
    /// the path that it has begun.
    fn resume(&mut self, progress: PathProgress, kept: &dyn Fn() -> KeptPaths) -> bool;

    /// Is called after the last path of an area, which may be the last area of the frame.
    fn end(&mut self, is_last: bool, kept: &dyn Fn() -> KeptPaths);
}

/// Pixels of an area whose paths are drawn together: their state takes 256 MiB.
const AREA_PIXELS: u32 = 1 << 21;
/// Side of the blocks that are finished together.
const BLOCK: u32 = 32;
/// The numbers of special passes (`path.frag`): the beginning, and the first pass of guides. Other passes have the number 0.
const BEGINNING: f32 = 1.0;
const GUIDES: f32 = 2.0;
/// Passes of guides, each at another place in the pixel.
const GUIDE_PASSES: u32 = 8;
/// Passes between two looks at the numbers of paths.
const LOOK_PASSES: u32 = 16;

/// Returns the areas of an image: bands of whole rows, the lowest first.
pub(super) fn areas(size: (u32, u32)) -> Vec<Tile> {
    let (width, height) = size;
    let rows = (AREA_PIXELS / width.max(1)).max(1);
    let area = |y: u32| Tile { x: 0, y, width, height: rows.min(height - y) };
    (0..height).step_by(rows as usize).map(area).collect()
}

/// The paths of an area so far.
pub(super) struct PathRun {
    pub(super) state: PathState,
    /// The areas of the next pass, and those with unfinished pixels at the last look.
    parts: Vec<Tile>,
    unfinished_before: Option<Vec<Tile>>,
    /// The rest of the current pass.
    queue: Option<Parts>,
    passes: u32,
}

impl PathRun {
    pub(super) fn over(state: PathState) -> Self {
        let parts = vec![Tile::whole(state.size)];
        Self { state, parts, unfinished_before: None, queue: None, passes: 0 }
    }

    /// Continues with the paths that were kept after a look. The next passes draw all blocks, so that both states hold
    /// the end of finished ones.
    pub(super) fn resume(&mut self, kept: &KeptPaths) {
        self.state.fill(kept);
        self.passes = LOOK_PASSES;
    }
}

/// The numbers of paths that were read.
pub(super) struct Look {
    pub(super) paths: u64,
    pub(super) is_finished: bool,
}

/// The begin of a call, and the time after which it ends. A call draws at least one part.
pub(super) type Patience = (Instant, Duration);

/// Waits until the end.
pub(super) fn endless() -> Patience {
    (Instant::now(), Duration::MAX)
}

/// An area that is being drawn.
pub(super) struct PathArea<'a> {
    pub(super) sampling: &'a Sampling,
    pub(super) passes: &'a Passes,
    pub(super) program: &'a Program,
    pub(super) order: PathOrder,
    pub(super) area: Tile,
}

impl PathArea<'_> {
    /// Draws the paths of the area. `go_on` returns false to let every pixel finish only the path that it has begun.
    /// Returns the number of paths.
    pub(super) fn draw(
        &self,
        run: &mut PathRun,
        cost: &mut PixelCost,
        go_on: &mut dyn FnMut(PathProgress, &PathState) -> bool,
    ) -> u64 {
        let mut most = self.order.samples.clamp(1, PATHS_MAX);
        let wanted = (u64::from(most) * self.area.pixels()) as f64;
        loop {
            match self.resume(run, cost, most, endless()) {
                Some(Look { paths, is_finished: true }) => return paths,
                Some(Look { paths, .. })
                    if !go_on(PathProgress { fraction: paths as f64 / wanted, paths }, &run.state) =>
                {
                    most = 1;
                }
                _ => {}
            }
        }
    }

    /// Continues the paths of the area, at most until the numbers of paths are read again. `most` is the largest number
    /// of paths of a pixel. Returns `None` if the patience ended before.
    pub(super) fn resume(
        &self,
        run: &mut PathRun,
        cost: &mut PixelCost,
        most: u32,
        patience: Patience,
    ) -> Option<Look> {
        loop {
            let kind = if run.passes == 0 { BEGINNING } else { 0.0 };
            if !self.draw_pass(run, cost, most, kind, patience) {
                return None;
            }
            if run.passes.is_multiple_of(LOOK_PASSES) {
                break;
            }
        }
        let pixels = run.state.read();
        let paths = pixels.iter().map(|(paths, _)| u64::from(*paths)).sum();
        let unfinished = unfinished_blocks(&pixels, run.state.size);
        let is_finished = unfinished.is_empty();
        // A block that has just finished is drawn once more, so that both states hold its end.
        if let Some(before) = run.unfinished_before.replace(unfinished) {
            run.parts = before;
        }
        Some(Look { paths, is_finished })
    }

    /// Continues a pass. Returns true when it is finished.
    fn draw_pass(
        &self,
        run: &mut PathRun,
        cost: &mut PixelCost,
        most: u32,
        kind: f32,
        patience: Patience,
    ) -> bool {
        let (begun, patience) = patience;
        let PathOrder { noise, first, sampling, .. } = self.order;
        let (x, y) = (self.area.x as f32, self.area.y as f32);
        let numbers = [x, y, first as f32, f32::from(sampling as u8), most as f32, noise, kind, 0.0];
        let gl = &self.sampling.gl;
        run.state.bind();
        self.program.bind();
        let mut queue =
            run.queue.take().unwrap_or_else(|| Parts::of(run.parts.clone(), run.state.size, *cost));
        let mut is_finished = true;
        while let Some(part) = queue.next(*cost) {
            let timer = DrawTimer::start(gl.info().software);
            let [x, y, width, height] = [part.x, part.y, part.width, part.height].map(u32::cast_signed);
            // SAFETY: sets state of the current context.
            unsafe {
                gl.enable(glow::SCISSOR_TEST);
                gl.scissor(x, y, width, height);
            }
            self.sampling.draw_paths(numbers);
            gl.finish();
            queue.record(part, timer.stop(), cost);
            if begun.elapsed() >= patience {
                is_finished = false;
                break;
            }
        }
        // SAFETY: sets state of the current context.
        unsafe { gl.disable(glow::SCISSOR_TEST) }
        if !is_finished {
            run.queue = Some(queue);
            return false;
        }
        cost.finish_picture();
        run.state.swap();
        run.passes += 1;
        true
    }

    /// Draws what the area's pixels show, which guides the filter. Returns true when it is finished; it is then the state
    /// of `guides`.
    pub(super) fn guide(&self, guides: &mut PathRun, cost: &mut PixelCost, patience: Patience) -> bool {
        while guides.passes < GUIDE_PASSES {
            if !self.draw_pass(guides, cost, 1, GUIDES + guides.passes as f32, patience) {
                return false;
            }
        }
        true
    }

    /// Writes the light of the paths to the area of `light`, smoothed if there are guides.
    pub(super) fn resolve(
        &self,
        state: &PathState,
        guides: Option<&PathState>,
        programs: &PathResults,
        light: &Target,
    ) -> Result<()> {
        let gl = &self.sampling.gl;
        let corner = [self.area.x as f32, self.area.y as f32];
        let Tile { x, y, width, height } = self.area;
        let area = [x, y, width, height].map(u32::cast_signed);
        state.bind_current("path_state");
        let Some(guides) = guides else {
            return self.passes.draw_within(&programs.mean, light, corner, area);
        };
        guides.bind_current("path_guides");
        let target = || Target::new(gl, state.size, &[Texel::Rgba32F], None);
        let (mut from, mut to) = (target()?, target()?);
        self.passes.draw(&programs.filter_first, &from)?;
        for pass in 0..FILTER_PASSES {
            from.bind_color(0, unit_of("path_light"));
            self.passes.draw_with(&programs.filter, &to, [(1 << pass) as f32, 0.0])?;
            std::mem::swap(&mut from, &mut to);
        }
        from.bind_color(0, unit_of("path_light"));
        self.passes.draw_within(&programs.filter_last, light, corner, area)
    }
}

/// Returns rows of blocks with pixels whose paths are not all finished.
fn unfinished_blocks(pixels: &[(u32, bool)], size: (u32, u32)) -> Vec<Tile> {
    let (width, height) = size;
    let mut parts: Vec<Tile> = Vec::new();
    for y in (0..height).step_by(BLOCK as usize) {
        let rows = BLOCK.min(height - y);
        for x in (0..width).step_by(BLOCK as usize) {
            let columns = BLOCK.min(width - x);
            let row = |row: u32| {
                let first = row as usize * width as usize + x as usize;
                pixels.get(first..first + columns as usize).unwrap_or_default()
            };
            if !(y..y + rows).flat_map(row).any(|(_, more)| *more) {
                continue;
            }
            match parts.last_mut() {
                Some(last) if last.y == y && last.x + last.width == x => last.width += columns,
                _ => parts.push(Tile { x, y, width: columns, height: rows }),
            }
        }
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn areas_cover_every_row_once() {
        for size in [(1, 1), (1280, 720), (3840, 2160), (16_384, 4096)] {
            let areas = areas(size);
            let mut next = 0;
            for area in &areas {
                assert_eq!((area.x, area.y, area.width), (0, next, size.0));
                assert!(area.pixels() <= u64::from(AREA_PIXELS));
                next += area.height;
            }
            assert_eq!(next, size.1);
        }
        assert_eq!(areas((1280, 720)).len(), 1);
    }

    #[test]
    fn only_blocks_with_unfinished_pixels_are_drawn() {
        let size = (80, 40);
        let mut pixels = vec![(7, false); 80 * 40];
        assert_eq!(unfinished_blocks(&pixels, size), []);
        for (x, y) in [(79, 0), (63, 31), (0, 39)] {
            pixels[y * 80 + x].1 = true;
        }
        let expected =
            [Tile { x: 32, y: 0, width: 48, height: 32 }, Tile { x: 0, y: 32, width: 32, height: 8 }];
        assert_eq!(unfinished_blocks(&pixels, size), expected);
    }
}
