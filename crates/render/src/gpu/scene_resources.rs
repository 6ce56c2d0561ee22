//! What a scene keeps on the GPU in addition to its program: its pictures, its tapes and its regions.

#![expect(unsafe_code, reason = "every OpenGL call is unsafe in glow")]

use std::cell::{Cell, RefCell};
use std::rc::Rc;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use glow::HasContext;
use image::RgbaImage;

use super::cell_use::CellUse;
use super::error::GpuError;
use super::gl::Gl;
use super::object::Texture;
use super::program::unit_of;
use super::scene_program::{Interpreter, Mode};
use super::texture;
use super::texture_buffer::{BufferTexel, TextureBuffer};
use super::tiles::Costs;
use crate::frame::Frame;
use crate::frame::block::RegionTree;
use crate::frame::sound_tables;
use crate::limits::LIMITS;
use crate::view::setup::Drawn;
use mariana_field::graph::FrameInputs;
use mariana_field::region::{Part, RegionKey, RegionOptions, RegionPlan, Regions, Surfaces};
use mariana_field::world::{
    ShortPrograms, ShortenOptions, ShortenRequest, TapeBuffers, World, WorthShortening,
};

/// A world, uploaded.
pub struct SceneResources {
    world: Arc<World>,
    buffers: Arc<TapeBuffers>,
    /// The world's pictures; scenes that are loaded one after the other share those that both read.
    pictures: Vec<Rc<Texture>>,
    on_gpu: SceneBuffers,
    /// Whether the driver has room for the tape.
    is_interpretable: bool,
    plan: Arc<RegionPlan>,
    /// Whether any expression reads the sound's tables.
    hears_tables: bool,
    texels_max: usize,
    /// What its pixels cost.
    costs: Costs,
    /// Whether empty space is skipped.
    with_cells: Cell<bool>,
    /// Whether programs of materials and light are shortened.
    shortens: Cell<bool>,
    /// Which of them.
    worth: RefCell<WorthShortening>,
    /// Those that were uploaded last.
    uploaded: RefCell<Option<Arc<BuiltRegions>>>,
}

/// Grid spacing of the places of the eye for which trees are built.
const CENTER_STEP: f32 = 8.0;

/// What regions were built for: equal requests give equal trees.
#[derive(Debug, Clone, PartialEq)]
pub struct RegionRequest {
    /// What the distance reads.
    pub key: RegionKey,
    /// How the tree is built.
    pub options: RegionOptions,
    /// Which programs of materials and light are shortened, and what they read.
    pub programs: ShortenRequest,
}

/// Regions, and what they were built for.
#[derive(Debug)]
pub struct BuiltRegions {
    /// What they were built for.
    pub request: RegionRequest,
    /// The tree.
    pub regions: Arc<Regions>,
    /// The programs of materials and light.
    pub programs: ShortPrograms,
    /// How long it took.
    pub time: Duration,
    /// How long the tree took, times the threads that built it; what it was for the last one where that was taken over.
    work: Duration,
}

/// What builds the regions of a scene's frames, on any thread.
#[derive(Debug, Clone)]
pub struct RegionMaker {
    /// Its tree.
    pub plan: Arc<RegionPlan>,
    /// Its programs.
    pub buffers: Arc<TapeBuffers>,
    /// The last regions: their tree need not be built again where only numbers of materials and light have changed.
    pub last: Option<Arc<BuiltRegions>>,
}

impl RegionRequest {
    /// What the tree of a frame is built for, with whole programs.
    pub fn of(plan: &RegionPlan, frame: &Frame, options: RegionOptions) -> Self {
        Self { key: plan.key(&frame.inputs), options, programs: ShortenRequest::default() }
    }

    /// Whether the trees are equal.
    fn has_tree_of(&self, other: &Self) -> bool {
        self.key == other.key && self.options == other.options
    }

    /// Whether a picture can be drawn with what was built for `other`.
    fn is_served_by(&self, other: &Self) -> bool {
        self.has_tree_of(other) && self.programs.is_served_by(&other.programs)
    }
}

impl RegionMaker {
    /// Builds the regions of a frame.
    pub fn build(&self, frame: &Frame, request: RegionRequest) -> BuiltRegions {
        self.build_while(frame, request, &|| true)
    }

    /// The same, for as long as somebody wants them. Unusable if they were given up.
    pub fn build_while(
        &self,
        frame: &Frame,
        request: RegionRequest,
        is_wanted: &(dyn Fn() -> bool + Sync),
    ) -> BuiltRegions {
        let start = Instant::now();
        let same = self.last.as_ref().filter(|last| last.request.has_tree_of(&request));
        let before = self.last.as_ref().map(|last| &*last.regions);
        let (regions, work) = same.map_or_else(
            || {
                let is_quick = self.last.as_ref().is_none_or(|last| last.work < QUICK_TREE);
                let is_small = self.plan.whole_texels() < SMALL_TAPE && is_quick;
                let parts = if is_small { 1 } else { processors() };
                let run = |parts: &mut [Part]| build_side_by_side(parts, is_wanted);
                let built = self.plan.build_in_parts((before, &frame.inputs), &request.options, parts, run);
                (Arc::new(built), start.elapsed() * parts as u32)
            },
            |last| (last.regions.clone(), last.work),
        );
        let surfaces = Surfaces {
            regions: &regions,
            planes: &frame.values.planes,
            // As far as GLOW_PROBE in occlusion.glsl, and a little more.
            around: 0.26 * frame.values.reach.max(0.0) + 1e-3,
        };
        let RegionOptions { texels_max, center, .. } = request.options;
        let options = ShortenOptions { texels_max, center, surfaces: Some(surfaces) };
        let programs = if is_wanted() {
            self.buffers.shorten(&frame.inputs, &request.programs, &options)
        } else {
            ShortPrograms::default()
        };
        BuiltRegions { regions, programs, time: start.elapsed(), work, request }
    }
}

/// For a scene of fewer clauses, building the tree takes less time than starting a thread ..
const SMALL_TAPE: usize = 64;
/// .. unless the last one took longer than this.
const QUICK_TREE: Duration = Duration::from_millis(3);
/// Most threads that build a tree: each has tapes of its own.
const THREADS_MAX: usize = 4;

/// How many threads are useful.
fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, |count| count.get().min(THREADS_MAX))
}

/// Builds each part on a thread of its own; the first, and those for which there is no thread, on this one.
fn build_side_by_side(parts: &mut [Part], is_wanted: &(dyn Fn() -> bool + Sync)) {
    let Some((first, others)) = parts.split_first_mut() else { return };
    std::thread::scope(|scope| {
        let mut left = Vec::new();
        for part in others {
            let part = Arc::new(Mutex::new(part));
            let its = part.clone();
            let work = move || its.lock().unwrap_or_else(PoisonError::into_inner).build_while(is_wanted);
            if std::thread::Builder::new().name("regions".into()).spawn_scoped(scope, work).is_err() {
                left.push(part);
            }
        }
        first.build_while(is_wanted);
        for part in left {
            part.lock().unwrap_or_else(PoisonError::into_inner).build_while(is_wanted);
        }
    });
}

impl SceneResources {
    /// Uploads a world's pictures and its tape. A tape for which the driver has no room is left out: such a scene can
    /// only be compiled (see [`Interpreter::fits`]).
    ///
    /// # Errors
    /// What the driver refuses.
    pub fn upload(
        gl: &Gl,
        world: Arc<World>,
        buffers: Arc<TapeBuffers>,
        plan: Arc<RegionPlan>,
    ) -> Result<Self, GpuError> {
        Self::upload_after(None, gl, world, buffers, plan)
    }

    /// The same, without uploading again the pictures that `last` has.
    ///
    /// # Errors
    /// What the driver refuses.
    pub fn upload_after(
        last: Option<&Self>,
        gl: &Gl,
        world: Arc<World>,
        buffers: Arc<TapeBuffers>,
        plan: Arc<RegionPlan>,
    ) -> Result<Self, GpuError> {
        let pictures = world.pictures.iter().map(|picture| {
            let known = last.and_then(|last| {
                last.pictures_with_textures().find(|(known, _)| Arc::ptr_eq(known, picture))
            });
            match known {
                Some((_, texture)) => Ok(texture.clone()),
                None => texture::upload(gl, picture).map(Rc::new),
            }
        });
        let pictures = pictures.collect::<Result<_, _>>()?;
        let on_gpu = SceneBuffers::new(gl, &sound_tables::texels(&FrameInputs::default()))?;
        gl.check("uploading a scene")?;
        Ok(Self {
            hears_tables: sound_tables::are_read_by(&world),
            worth: RefCell::new(buffers.worth_shortening()),
            is_interpretable: Interpreter::fits(&buffers, &plan, gl.info()).is_ok(),
            world,
            buffers,
            pictures,
            on_gpu,
            plan,
            costs: Costs::default(),
            with_cells: Cell::new(true),
            shortens: Cell::new(true),
            uploaded: RefCell::new(None),
            texels_max: LIMITS.region_texels_max.min(gl.info().texture_buffer_texels_max as usize),
        })
    }

    fn pictures_with_textures(&self) -> impl Iterator<Item = (&Arc<RgbaImage>, &Rc<Texture>)> {
        self.world.pictures.iter().zip(&self.pictures)
    }

    /// What the legend of a view says about the scene, drawn in a mode.
    pub fn drawn(&self, mode: Mode) -> Drawn {
        // If the distance is not a signed distance field, there are cells in any case.
        let cells = self.with_cells.get() || self.world.non_lipschitz;
        Drawn { interpreted: mode == Mode::Interpreted, cells, clauses: self.buffers.cost.distance }
    }

    /// The world that was uploaded.
    pub fn world(&self) -> &Arc<World> {
        &self.world
    }

    /// Expects that its pixels cost what those of its last version cost, or a good deal more.
    pub fn expect_costs_of(&self, last: &Self) {
        self.costs.expect(&last.costs);
    }

    /// What its pixels cost.
    pub(super) fn costs(&self) -> &Costs {
        &self.costs
    }

    /// Its programs.
    pub fn buffers(&self) -> &Arc<TapeBuffers> {
        &self.buffers
    }

    /// What builds its regions.
    pub fn plan(&self) -> &Arc<RegionPlan> {
        &self.plan
    }

    /// Whether space is divided into cells for a mode, if that is wanted. A formula that is not a distance cannot do
    /// without them.
    pub fn uses_cells(&self, wish: CellUse, mode: Mode) -> bool {
        wish.divides(&self.world, &self.buffers, mode)
    }

    /// Chooses whether space is divided into cells, of which empty ones are skipped, or the whole tape holds
    /// everywhere.
    /// For the interpreted mode, cells also shorten the programs of materials and light.
    pub fn set_cells(&self, cells: bool, mode: Mode) {
        self.with_cells.set(cells);
        self.shortens.set(cells && mode == Mode::Interpreted);
    }

    /// How the tree of a frame is built.
    pub fn region_options(&self, frame: &Frame) -> RegionOptions {
        // A tree follows an eye among the surfaces, but not at every step.
        let eye = frame.camera.position.as_vec3();
        let near_eye = (CENTER_STEP * (eye / CENTER_STEP).round()).to_array();
        let (center, eye) = match self.world.bounds {
            None => (near_eye, None),
            Some(bounds) => {
                ([0.0; 3], (!self.world.non_lipschitz && bounds.hold(eye.to_array())).then_some(near_eye))
            }
        };
        let (cells, texels_max) = (self.with_cells.get(), self.texels_max);
        RegionOptions { cells, texels_max, center, eye }
    }

    /// What the regions of a frame are built for.
    pub fn region_request(&self, frame: &Frame) -> RegionRequest {
        let options = self.region_options(frame);
        let programs = if self.shortens.get() && self.is_interpretable {
            self.worth.borrow().request(&self.buffers, &frame.inputs)
        } else {
            ShortenRequest::default()
        };
        RegionRequest { programs, ..RegionRequest::of(&self.plan, frame, options) }
    }

    /// What builds the regions of the next frame.
    pub fn region_maker(&self) -> RegionMaker {
        RegionMaker { plan: self.plan.clone(), buffers: self.buffers.clone(), last: self.regions() }
    }

    /// The regions of the last picture.
    pub fn regions(&self) -> Option<Arc<BuiltRegions>> {
        self.uploaded.borrow().clone()
    }

    /// Takes regions that were built elsewhere.
    pub fn take_regions(&self, built: Arc<BuiltRegions>) {
        let last = self.regions();
        if last.as_ref().is_some_and(|last| Arc::ptr_eq(last, &built)) {
            return;
        }
        if !last.is_some_and(|last| Arc::ptr_eq(&last.regions, &built.regions)) {
            self.on_gpu.regions.replace(&bytes_of(&built.regions.texels));
        }
        self.worth.borrow_mut().note(&built.programs);
        *self.uploaded.borrow_mut() = Some(built);
    }

    /// The tree of a frame. If it is missing it is built: no picture is drawn with regions of other inputs.
    pub(super) fn tree_of(&self, frame: &Frame) -> RegionTree {
        let request = self.region_request(frame);
        let known = self.regions().filter(|built| request.is_served_by(&built.request));
        let built = known.unwrap_or_else(|| {
            let built = Arc::new(self.region_maker().build(frame, request));
            self.take_regions(built.clone());
            built
        });
        let Regions { low, size, bounds, whole_tape, .. } = *built.regions;
        RegionTree { low, size, bounds, whole_tape }
    }

    /// Uploads the programs and the tables of a frame, whose regions are there already.
    pub(super) fn upload_inputs(&self, frame: &Frame) {
        let inputs = &frame.inputs;
        if self.is_interpretable {
            let regions = self.regions();
            let whole = ShortPrograms::default();
            let short = regions.as_ref().map_or(&whole, |built| &built.programs);
            let texels = self.buffers.texels(inputs, if self.shortens.get() { short } else { &whole });
            self.on_gpu.tape.replace(&bytes_of(&texels));
            self.worth.borrow_mut().pass_frame();
        }
        if self.hears_tables {
            self.on_gpu.sound_tables.replace(&floats_as_bytes(&sound_tables::texels(inputs)));
        }
    }

    /// The driver's names of everything.
    pub fn names(&self) -> SceneNames {
        self.on_gpu.names(self.pictures.iter().map(|picture| picture.native()).collect())
    }
}

/// The texture buffers of a scene.
pub(super) struct SceneBuffers {
    tape: TextureBuffer,
    regions: TextureBuffer,
    sound_tables: TextureBuffer,
}

impl SceneBuffers {
    /// Without a tape and without regions, but with these tables of the sound.
    ///
    /// # Errors
    /// [`GpuError::Object`] if the driver has no object left.
    pub(super) fn new(gl: &Gl, sound: &[[f32; 4]]) -> Result<Self, GpuError> {
        Ok(Self {
            tape: TextureBuffer::new(gl, BufferTexel::Rgba32U, &[0; 16])?,
            regions: TextureBuffer::new(gl, BufferTexel::Rgba32U, &[0; 16])?,
            sound_tables: TextureBuffer::new(gl, BufferTexel::Rgba32F, &floats_as_bytes(sound))?,
        })
    }

    /// What is bound for a scene with these pictures.
    pub(super) fn names(&self, pictures: Vec<glow::NativeTexture>) -> SceneNames {
        SceneNames {
            pictures,
            tape: self.tape.texture(),
            regions: self.regions.texture(),
            sound_tables: self.sound_tables.texture(),
        }
    }
}

/// What is bound for a scene. The names are valid while its [`SceneResources`] live; afterwards they draw something
/// else, or make the driver report an error.
#[derive(Debug, Clone)]
pub struct SceneNames {
    pictures: Vec<glow::NativeTexture>,
    tape: glow::NativeTexture,
    regions: glow::NativeTexture,
    sound_tables: glow::NativeTexture,
}

impl SceneNames {
    /// Binds everything to its units.
    pub(super) fn bind(&self, gl: &Gl) {
        // SAFETY: with names of another scene, or invalid ones, the driver reports an error.
        unsafe {
            for (unit, picture) in (glow::TEXTURE0..).zip(&self.pictures) {
                gl.active_texture(unit);
                gl.bind_texture(glow::TEXTURE_2D, Some(*picture));
            }
            let buffers =
                [("tape", self.tape), ("regions", self.regions), ("sound_tables", self.sound_tables)];
            for (name, buffer) in buffers {
                gl.active_texture(glow::TEXTURE0 + unit_of(name));
                gl.bind_texture(glow::TEXTURE_BUFFER, Some(buffer));
            }
        }
    }
}

/// Texels as the bytes of a texture buffer.
fn bytes_of(texels: &[[u32; 4]]) -> Vec<u8> {
    texels.as_flattened().iter().flat_map(|word| word.to_ne_bytes()).collect()
}

/// Floats as the bytes of a texture buffer.
fn floats_as_bytes(texels: &[[f32; 4]]) -> Vec<u8> {
    texels.as_flattened().iter().flat_map(|value| value.to_ne_bytes()).collect()
}
