//! Draws a frame: one sample per pixel, more samples at edges, then the finished picture ([`super::post`]).
//!
//! 1. `scene.frag` traces one sample at each pixel's centre.
//! 2. `edges.frag` marks in the stencil the pixels whose neighbourhood differs visibly.
//! 3. `scene.frag` again, only there: more samples, each at another place in the pixel.
//!
//! A picture is drawn in parts, in one go or several ([`making`]).
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

#![expect(unsafe_code, reason = "every OpenGL call is unsafe in glow")]

mod fade;
mod making;
mod placing;
mod rehearsal;
mod sketch;
mod warm_up;

use std::rc::Rc;
use std::time::Duration;

use glow::HasContext;

use super::edge_list::EdgeList;
use super::edge_samples::EdgeSamples;
use super::error::GpuError;
pub use super::evaluations::Evaluations;
use super::flash_pass::FlashPass;
use super::gl::Gl;
use super::object::VertexArray;
use super::post::{Block, Post, PostTargets};
use super::program::{LazyProgram, Program, unit_of};
use super::samplers::Samplers;
use super::scene_resources::SceneResources;
use super::shader_source::{ShaderLibrary, Variant};
use super::target::{Stencil, Target, Texel};
use super::timer::FrameTimer;
use crate::frame::Frame;
use crate::frame::picture::Picture;
use fade::Fade;
use making::Making;
pub use making::Progress;
use mariana_field::world::ToneMap;
pub use placing::PLACING_SHADERS;
use placing::Placing;
pub use sketch::Sketch;

/// Numbers in the `PassBlock` of `frame_block.glsl`.
const PASS_BLOCK_NUMBERS: usize = 8 + 2 * 16;
/// Samples of a reference picture along each side of a pixel.
const REFERENCE_SIDE: u32 = 8;

/// Which sample a pass draws, as in `frame_block.glsl`.
const FIRST_SAMPLE: f32 = 0.0;
const FURTHER_SAMPLE: f32 = 1.0;
const LISTED_SAMPLES: f32 = 2.0;

/// Enlarges a picture for a window.
pub const UPSCALE_SHADER: &str = "upscale.frag";

/// Marks edges. The other shaders are in [`super::post`] and, those of scenes, in [`super::scene_program`].
pub const EDGE_SHADER: &str = "edges.frag";

/// Whether a renderer counts distance evaluations (slower) or not.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Counting {
    /// Pictures only.
    Off,
    /// Pictures and [`Renderer::evaluations`].
    On,
}

/// The targets of the picture and the programs that all scenes share.
pub struct Renderer {
    gl: Gl,
    edges: LazyProgram,
    /// On a software renderer.
    samplers: Option<Samplers>,
    post: Post,
    frame_block: Block,
    pass_block: Block,
    view_block: Block,
    vertices: VertexArray,
    counting: Counting,
    edge_samples: EdgeSamples,
    targets: Option<Targets>,
    /// Enlarges pictures for a window.
    upscale: Option<LazyProgram>,
    /// Dims pictures and puts them where they lie in a window.
    placing: Option<Placing>,
    flashes: Option<FlashPass>,
    /// Whether the limiter has taken the finished picture.
    is_limited: bool,
    /// A copy of the finished picture with its flashes limited, for reading.
    limited: Option<Target>,
    timer: Option<FrameTimer>,
    /// The picture that is being drawn.
    making: Option<Making>,
    /// The picture whose light the targets hold; none if it is a view's.
    finished_light: Option<Picture>,
    /// What fades away.
    fade: Option<Fade>,
    /// What is shown while a picture of another size is being drawn.
    stands: Option<Target>,
    /// How long the GPU took for the last picture, until it is reported.
    gpu_cost: Option<Duration>,
}

/// What depends on the picture's size.
struct Targets {
    has_lens: bool,
    first: Target,
    edges: Edges,
    post: PostTargets,
}

/// How pixels at edges get more samples.
enum Edges {
    /// With the stencil, all over the picture, summed in a target: on a GPU.
    Stencil(Target),
    /// Side by side: on a software renderer.
    List(EdgeList),
}

impl Edges {
    fn samples(&self) -> &Target {
        match self {
            Edges::Stencil(sum) => sum,
            Edges::List(list) => list.samples(),
        }
    }
}

impl Renderer {
    /// Compiles the shaders of `library` that all scenes share. With [`Counting::On`], scenes' programs must be of
    /// the counting variant.
    ///
    /// # Errors
    /// What the driver refuses, with its log.
    pub fn new(gl: &Gl, library: &ShaderLibrary, counting: Counting) -> Result<Self, GpuError> {
        let renderer = Self {
            gl: gl.clone(),
            edges: LazyProgram::new(gl, library, EDGE_SHADER, &Variant::default())?,
            samplers: gl.info().software.then(|| Samplers::new(gl, library)).transpose()?,
            post: Post::new(gl, library)?,
            frame_block: Block::new(gl, "FrameBlock")?,
            pass_block: Block::new(gl, "PassBlock")?,
            view_block: Block::new(gl, "ViewBlock")?,
            vertices: VertexArray::new(gl)?,
            counting,
            edge_samples: EdgeSamples::Four,
            targets: None,
            upscale: None,
            placing: None,
            flashes: None,
            is_limited: false,
            limited: None,
            timer: None,
            making: None,
            finished_light: None,
            fade: None,
            stands: None,
            gpu_cost: None,
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
        self.upscale = Some(LazyProgram::new(&self.gl, library, UPSCALE_SHADER, &Variant::default())?);
        self.add_dimming(library)?;
        self.time_pictures()
    }

    /// From now on [`Renderer::dim`] takes effect.
    ///
    /// # Errors
    /// As [`Renderer::new`].
    pub fn add_dimming(&mut self, library: &ShaderLibrary) -> Result<(), GpuError> {
        self.placing = Some(Placing::new(&self.gl, library)?);
        Ok(())
    }

    /// From now on a GPU's times of pictures are taken, so that their parts become smaller where pixels become dearer.
    /// No other timer may run while one is drawn.
    ///
    /// # Errors
    /// [`GpuError::Object`] if the driver has no query left.
    pub fn time_pictures(&mut self) -> Result<(), GpuError> {
        if !self.gl.info().software {
            self.timer = Some(FrameTimer::new(&self.gl)?);
        }
        Ok(())
    }

    /// From now on [`Renderer::limit_flashes`] takes effect.
    ///
    /// # Errors
    /// As [`Renderer::new`].
    pub fn add_flash_limiter(&mut self, library: &ShaderLibrary) -> Result<(), GpuError> {
        self.flashes = Some(FlashPass::new(&self.gl, library)?);
        Ok(())
    }

    /// [`Renderer::limit_flashes`] has no effect any more.
    pub fn remove_flash_limiter(&mut self) {
        self.flashes = None;
        self.is_limited = false;
    }

    /// Uses this tone map from now on, whatever scenes say; none means as they say.
    pub fn set_tone_map(&mut self, tone_map: Option<ToneMap>) {
        self.post.set_tone_map(tone_map);
    }

    /// From now on pixels at edges get this many samples; the default is four.
    pub fn set_edge_samples(&mut self, samples: EdgeSamples) {
        if self.edge_samples != samples {
            tracing::debug!("{} further samples at edges", samples.count());
            self.edge_samples = samples;
            self.put_targets_away();
        }
    }

    /// Dims what flashes too often in the picture that was drawn last, which is shown `seconds` after the one before.
    ///
    /// # Errors
    /// No room for a copy of the picture, which all but windows need.
    pub fn limit_flashes(&mut self, seconds: f64) -> Result<(), GpuError> {
        let finished = self.stands.as_ref().or(self.targets.as_ref().map(|targets| targets.post.finished()));
        let dimmed = self.placing.as_ref().and_then(Placing::dimmed);
        if let (Some(flashes), Some(finished)) = (&mut self.flashes, dimmed.or(finished)) {
            flashes.take(finished, seconds);
            if self.upscale.is_none() {
                let copy = match self.limited.take().filter(|copy| copy.size() == finished.size()) {
                    Some(copy) => copy,
                    None => Target::new(&self.gl, finished.size(), &[Texel::Rgba8], None)?,
                };
                finished.blit_to(&copy);
                flashes.limit(finished, &copy);
                self.limited = Some(copy);
            }
            self.is_limited = true;
        }
        self.placing.iter_mut().for_each(Placing::forget_copy);
        self.gl.check("limiting flashes")
    }

    /// What comes next is not compared with what was drawn before, because the user changed from one to the other by
    /// hand.
    pub fn forget_flashes(&mut self) {
        if let Some(flashes) = &mut self.flashes {
            flashes.forget();
        }
    }

    /// How long the GPU took for one of the last pictures that were drawn in one go, if that has become known since
    /// the last call; never on a software renderer.
    pub fn gpu_time(&mut self) -> Option<Duration> {
        let time = self.timer.as_mut()?.take();
        self.gpu_cost = time.or(self.gpu_cost);
        time
    }

    /// The finished picture that is shown.
    fn finished(&self) -> Option<&Target> {
        self.stands.as_ref().or(self.targets.as_ref().map(|targets| targets.post.finished()))
    }

    /// The state in which passes begin.
    fn reset_state(&self) {
        // SAFETY: plain state.
        unsafe {
            let gl = &*self.gl;
            gl.disable(glow::DEPTH_TEST);
            gl.disable(glow::CULL_FACE);
            gl.disable(glow::SCISSOR_TEST);
            gl.disable(glow::FRAMEBUFFER_SRGB);

            gl.clear_color(0.0, 0.0, 0.0, 0.0);
            gl.disable(glow::STENCIL_TEST);
            gl.disable(glow::BLEND);
        }
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
        let Some(targets) = &self.targets else { return Ok(()) };
        scene.names().bind(&self.gl);
        let sum = Target::new(&self.gl, targets.first.size(), &[Texel::Rgba32F], None)?;
        sum.bind();
        // SAFETY: plain state.
        unsafe { self.gl.clear(glow::COLOR_BUFFER_BIT) }
        self.prepare_samples(program);
        for number in 0..REFERENCE_SIDE * REFERENCE_SIDE {
            let place = [number % REFERENCE_SIDE, number / REFERENCE_SIDE];
            let place = place.map(|at| (at as f32 + 0.5) / REFERENCE_SIDE as f32 - 0.5);
            self.draw_sample(place, number as f32, FURTHER_SAMPLE, 0.0);
            self.gl.finish();
        }
        // SAFETY: plain state.
        unsafe { self.gl.disable(glow::BLEND) }
        sum.bind_color(0, unit_of("extra_samples"));
        self.post.resolve_all(&targets.post)?;
        self.post.finish(&targets.post, &frame.picture, &targets.first, None)?;
        self.gl.check("drawing a reference")
    }

    /// Copies the finished picture to the window's framebuffer of `window` pixels, enlarged if that has more.
    ///
    /// # Errors
    /// An error that the driver reports.
    pub fn show(&self, window: (u32, u32)) -> Result<(), GpuError> {
        let Some(picture) = self.bright_as_shown() else { return Ok(()) };
        match &self.upscale {
            Some(upscale) if picture.size() != window => self.enlarge(upscale, picture, window, None)?,
            _ => picture.blit_to_window(window),
        }
        if let Some(flashes) = self.flashes.as_ref().filter(|_| self.is_limited) {
            flashes.limit_in_window(picture, window);
        }
        self.gl.check("showing a frame")
    }

    /// Draws a picture, enlarged, over the window's framebuffer of `window` pixels, or only in an area of it.
    fn enlarge(
        &self,
        upscale: &LazyProgram,
        picture: &Target,
        window: (u32, u32),
        area: Option<[i32; 4]>,
    ) -> Result<(), GpuError> {
        picture.bind_color(0, unit_of("picture"));
        // SAFETY: the vertex array is ours.
        unsafe { self.gl.bind_vertex_array(Some(self.vertices.native())) }
        self.post.passes().draw_in_window(upscale, window, area)
    }

    /// The finished picture, its flashes limited, four bytes per pixel, the top row first. Empty before the first draw.
    pub fn read(&self) -> Vec<u8> {
        let limited = self.limited.as_ref().filter(|_| self.is_limited && self.is_copied());
        limited.or(self.bright_as_shown()).map_or_else(Vec::new, |picture| picture.read_rgba8(0))
    }

    /// Distance evaluations of the last picture; zero without [`Counting::On`].
    pub fn evaluations(&self) -> Evaluations {
        let mut sum = Evaluations::default();
        let Some(targets) = self.targets.as_ref().filter(|_| self.counting == Counting::On) else {
            return sum;
        };
        for target in [&targets.first, targets.edges.samples()] {
            let (kinds, more) = (target.read_rgba32f(1), target.read_rgba32f(2));
            for texel in kinds.as_chunks::<4>().0 {
                let [primary, reflection, normal, shadow] = texel.map(f64::from);
                sum.primary += primary;
                sum.reflection += reflection;
                sum.normal += normal;
                sum.shadow += shadow;
            }
            for texel in more.as_chunks::<4>().0 {
                sum.occlusion += f64::from(texel[0]);
                sum.capped_rays += f64::from(texel[1]);
                sum.clauses += f64::from(texel[2]);
                sum.lookups += f64::from(texel[3]);
            }
            for texel in target.read_rgba32f(3).as_chunks::<4>().0 {
                sum.surface_clauses += f64::from(texel[0]);
            }
        }
        sum.edge_pixels = self.edge_pixels();
        sum
    }

    /// Pixels that got the samples of an edge in the last picture.
    pub fn edge_pixels(&self) -> f64 {
        let Some(targets) = &self.targets else { return 0.0 };
        let samples = targets.edges.samples().read_rgba32f(0);
        let texels = samples.as_chunks::<4>().0.iter().filter(|texel| texel[3] > 0.0).count() as f64;
        match &targets.edges {
            Edges::Stencil(_) => texels,
            Edges::List(_) => texels / self.edge_samples.count() as f64,
        }
    }

    /// Makes targets of `size` pixels. If the size is refused, the last picture stays.
    fn need_targets(&mut self, size: (u32, u32), has_lens: bool) -> Result<(), GpuError> {
        let fits = |targets: &Targets| targets.first.size() == size && targets.has_lens == has_lens;
        if !self.targets.as_ref().is_some_and(fits) {
            Target::check_size(&self.gl, size)?;
            self.put_targets_away();
            self.targets = Some(Targets::new(&self.gl, size, has_lens, self.edge_samples, self.counting)?);
        }
        Ok(())
    }

    /// Makes room for other targets. The last picture is shown until the next one is finished.
    fn put_targets_away(&mut self) {
        (self.making, self.finished_light) = (None, None);
        if let Some(targets) = self.targets.take()
            && self.stands.is_none()
        {
            self.stands = Some(targets.post.into_finished());
        }
    }
}

impl Targets {
    fn new(
        gl: &Gl,
        size: (u32, u32),
        has_lens: bool,
        samples: EdgeSamples,
        counting: Counting,
    ) -> Result<Self, GpuError> {
        // Counts are written in place of what a lens needs: such pictures are not looked at.
        let texels: &[Texel] = match (counting, has_lens) {
            (Counting::On, _) => &[Texel::Rgba16F, Texel::Rgba32F, Texel::Rgba32F, Texel::Rgba32F],
            (Counting::Off, true) => &[Texel::Rgba16F, Texel::R16F],
            (Counting::Off, false) => &[Texel::Rgba16F],
        };
        let mut texels = texels.to_vec();
        if gl.info().software {
            // How far the beams of first samples are free (shaders/sphere_tracing.glsl).
            texels.push(Texel::R32F);
        }
        Target::check_size(gl, size)?;
        let (stencil, edges) = if gl.info().software {
            (None, Edges::List(EdgeList::new(gl, size, &texels, samples)?))
        } else {
            let stencil = Rc::new(Stencil::new(gl, size)?);
            (Some(stencil.clone()), Edges::Stencil(Target::new(gl, size, &texels, Some(stencil))?))
        };
        Ok(Self {
            has_lens,
            first: Target::new(gl, size, &texels, stencil)?,
            edges,
            post: PostTargets::new(gl, size, has_lens && counting == Counting::Off, size)?,
        })
    }
}
