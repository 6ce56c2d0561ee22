//! Draws scenes without a window, on a context of its own.

use super::alpha::Coverage;
use super::earlier_sound::EarlierSound;
use super::error::{ExportError, refuse};
use super::exact_textures::ExactTextures;
use super::fingerprint::Fingerprint;
use super::path_store::SharedStore;
use super::paths::{PathChoice, PathDrawing, PathWatch};
use super::song_features::SongFeatures;
use crate::config::SdfChoice;
use crate::frame::Frame;
use crate::frame::held_inputs::{HeldInputs, Setting, input_names};
use crate::frame::projection::Projection;
use crate::gpu::scene_program::{
    COMPILED_BY_ITSELF_MAX, as_coverage, as_views, drawing_variant_of, link_scene, path_texts, projected,
    variant_of, without_sky,
};
use crate::gpu::{
    CellUse, Counting, EdgeSamples, GlInfo, GpuError, Headless, Interpreter, Mode, Program, Renderer,
    SceneResources, ShaderLibrary,
};
use crate::scenes::{ReadyScene, SceneSource};
use crate::view::ViewChoice;
use crate::view::legend::LegendPainter;
use crate::view::setup::ViewSetup;
use mariana_field::graph::SoundInput;
use mariana_field::lang::Scene;
use mariana_field::region::RegionPlan;
use mariana_field::world::{TapeBuffers, ToneMap, World};
use mariana_music::Sound;

/// A scene, and the options of drawing it.
#[derive(Debug, Clone)]
pub struct SceneChoice {
    /// The scene.
    pub source: SceneSource,
    /// Interpreted mode, compiled mode, or the faster of these modes.
    pub sdf: SdfChoice,
    /// The shaders.
    pub shaders: ShaderLibrary,
    /// Use of the tree of cells.
    pub cells: CellUse,
    /// A diagnostic view, whose colours show the renderer's internal values; `None` draws the image.
    pub view: Option<ViewChoice>,
    /// True to leave the sky transparent.
    pub alpha: bool,
    /// The number of further samples at edges.
    pub edges: EdgeSamples,
    /// Tone map; `None` uses the scene's own.
    pub tone_map: Option<ToneMap>,
    /// The projection.
    pub projection: Projection,
    /// Light by paths; `None` for the raster.
    pub paths: Option<PathChoice>,
    /// True to log the driver's debug messages.
    pub verbose: bool,
}

impl From<SceneSource> for SceneChoice {
    fn from(source: SceneSource) -> Self {
        Self {
            source,
            sdf: SdfChoice::default(),
            shaders: ShaderLibrary::embedded(),
            cells: CellUse::default(),
            view: None,
            alpha: false,
            edges: EdgeSamples::Sixteen,
            tone_map: None,
            projection: Projection::default(),
            paths: None,
            verbose: false,
        }
    }
}

pub(super) struct HeadlessRenderer {
    pub(super) renderer: Renderer,
    pub(super) view: Option<(ViewChoice, LegendPainter)>,
    coverage: Option<Coverage>,
    textures: ExactTextures,
    projection: Projection,
    earlier: Option<EarlierSound>,
    paths: Option<PathDrawing>,
    /// True if images of later moments follow.
    pub(crate) is_video: bool,
    /// True after the first image.
    has_drawn: bool,
    // The last field, so that the context is dropped after the objects that use it.
    context: Headless,
}

pub(super) struct Model {
    program: Program,
    coverage: Option<Program>,
    /// The program of paths, and the hash of all that the scene brings to them.
    paths: Option<(Program, u64)>,
    resources: SceneResources,
    pub(super) mode: Mode,
}

impl HeadlessRenderer {
    pub(super) fn open(choice: &SceneChoice) -> Result<Self, ExportError> {
        let context = Headless::new(choice.verbose)?;
        let mut renderer = Renderer::new(context.gl(), &choice.shaders, Counting::Off)?;
        renderer.set_tone_map(choice.tone_map);
        renderer.set_edge_samples(choice.edges);
        renderer.time_pictures()?;
        let view = choice.view.map(|view| (view, LegendPainter::default()));
        let coverage = choice.alpha.then(Coverage::default);
        Ok(Self {
            renderer,
            view,
            coverage,
            textures: ExactTextures::default(),
            earlier: None,
            projection: choice.projection,
            paths: choice.paths.map(PathDrawing::of),
            is_video: false,
            has_drawn: false,
            context,
        })
    }

    /// Uploads a scene and links its program. With `auto`, the scene is compiled unless it is very large; the image is
    /// the same either way. A scene whose tape does not fit the driver is compiled, with a warning in the log.
    ///
    /// # Errors
    /// Fails if the driver reports an error.
    pub(super) fn load(&self, choice: &SceneChoice, ready: ReadyScene) -> Result<Model, ExportError> {
        let gl = self.context.gl();
        let ReadyScene { world, buffers, plan, .. } = ready;
        let mode = mode_on(choice.sdf, &buffers, &plan, gl.info());
        let mut variant = match choice.view {
            Some(_) => as_views(variant_of(&world, &buffers, &plan, mode, gl.info(), Counting::On)?),
            None => drawing_variant_of(&world, &buffers, &plan, mode, choice.cells, gl.info())?,
        };
        variant = projected(variant, &choice.projection);
        let mut coverage = None;
        if choice.alpha {
            coverage = Some(link_scene(gl, &choice.shaders, &as_coverage(variant.clone()))?);
            variant = without_sky(variant);
        }
        let program = link_scene(gl, &choice.shaders, &variant)?;
        let paths = choice.paths.map(|_| {
            let texts = path_texts(gl, &choice.shaders, &variant)?;
            let mut scene = Fingerprint::default();
            scene.add(&(&texts, &buffers, &plan));
            world.pictures.iter().for_each(|picture| scene.add_bytes(picture));
            Ok::<_, GpuError>((Program::of(gl, &texts)?, scene.number()))
        });
        let paths = paths.transpose()?;
        let resources = SceneResources::upload(gl, None, world, buffers, plan)?;
        // Diagnostic views show the cells, so they need cells even where cells do not save time.
        let change = match choice.cells {
            CellUse::WhereTheyPay if choice.view.is_some() => CellUse::Always,
            change => change,
        };
        resources.set_cells(resources.uses_cells(change, mode), mode);
        Ok(Model { program, coverage, paths, resources, mode })
    }

    /// Sets the song whose cover the scenes show, and whose earlier sound they remember. Call
    /// [`SongFeatures::know_for`] before this.
    ///
    /// # Errors
    /// Fails if the song cannot be decoded.
    pub(super) fn set_song(&mut self, song: &SongFeatures) -> Result<(), ExportError> {
        self.textures.set_song(song.song.clone(), song.name.clone(), song.lyrics().cloned());
        self.earlier = Some(EarlierSound::of(song)?);
        Ok(())
    }

    /// Draws the frames of feedback that an image at `time` shows. `frame_at` returns the frame at an earlier moment,
    /// in the image's size; without a song, the earlier sound is `sound`. Views show none, because their colours stand
    /// for numbers.
    pub(super) fn feed_back(
        &mut self,
        model: &Model,
        time: f64,
        sound: &Sound,
        size: (u32, u32),
        frame_at: &dyn Fn(f64, Sound) -> Frame,
    ) -> Result<(), ExportError> {
        let Model { program, resources, .. } = model;
        if self.view.is_some() {
            return Ok(());
        }
        let picture = (size, self.projection.stereo);
        while let Some(request) = self.renderer.feedback_before(resources, 0, time, picture, self.is_video) {
            let sound = match &mut self.earlier {
                Some(earlier) => earlier.at(request.time)?,
                None => sound.clone(),
            };
            let frame = frame_at(request.time, sound);
            let mut frame = frame.projected(resources.world(), self.projection);
            frame.size = request.size;
            self.textures.put_into(&mut frame, resources.world());
            self.renderer.draw_feedback(&request, &frame, resources, program)?;
        }
        Ok(self.renderer.show_feedback(resources, time)?)
    }

    pub(super) fn draw(&mut self, model: &Model, frame: Frame) -> Result<(), ExportError> {
        let Model { program, resources, mode, .. } = model;
        if !std::mem::replace(&mut self.has_drawn, true) {
            warn_of_a_camera_inside(resources.world(), &frame);
        }
        let mut frame = frame.projected(resources.world(), self.projection);
        self.textures.put_into(&mut frame, resources.world());
        if let Some((coverage, program)) = self.coverage.as_mut().zip(model.coverage.as_ref()) {
            coverage.draw(&mut self.renderer, &mut frame, resources, program)?;
        }
        if let Some((drawing, (program, scene))) = self.paths.as_mut().zip(model.paths.as_ref()) {
            drawing.scene = *scene;
            let done = self.renderer.draw_paths(&frame, resources, program, drawing.order(), drawing)?;
            let pixels = f64::from(frame.size.0) * f64::from(frame.size.1);
            tracing::info!("{:.1} paths for each pixel", done.paths as f64 / pixels.max(1.0));
            return Ok(());
        }
        let Some((view, legends)) = &mut self.view else {
            return Ok(self.renderer.draw(&frame, resources, program)?);
        };
        let setup = ViewSetup::of(*view, &frame, resources.world(), resources.drawn(*mode));
        let legend = legends.picture(setup.legend, frame.size);
        Ok(self.renderer.draw_view(&frame, resources, program, &setup.block, legend.as_deref())?)
    }

    /// Draws a scene mixed with the last frame, whose light has the weight `fraction` (0..1). Views are not mixed,
    /// because their colours stand for numbers.
    pub(super) fn draw_over(
        &mut self,
        model: &Model,
        frame: Frame,
        fraction: f32,
    ) -> Result<(), ExportError> {
        if self.view.is_none() {
            self.renderer.keep_light()?;
            self.renderer.set_fade(Some(fraction));
        }
        let drawn = self.draw(model, frame);
        self.renderer.set_fade(None);
        drawn
    }

    /// Sets the number of the exposure that is drawn next.
    pub(super) fn begin_exposure(&mut self, number: usize, count: usize) {
        self.paths.iter_mut().for_each(|paths| paths.exposure = (number, count));
    }

    /// Reports the progress of an image by paths to `watch`, and keeps the paths in `store`.
    pub(super) fn watch_paths(&mut self, watch: PathWatch, store: Option<SharedStore>) {
        if let Some(store) = &store {
            store.borrow_mut().know_driver(self.context.gl().info());
        }
        if let Some(paths) = &mut self.paths {
            (paths.watch, paths.store) = (watch, store);
        }
    }

    /// Adds the last frame, which is exposure `number` of `count`, to the mean of the exposures. After the last one, the
    /// last frame is the mean. Views have no mean.
    pub(super) fn expose(&mut self, number: usize, count: usize) -> Result<(), ExportError> {
        if count > 1 && self.view.is_none() {
            self.renderer.add_exposure(number)?;
            if number + 1 == count {
                self.renderer.finish_exposures()?;
            }
        }
        Ok(())
    }

    /// Returns the last frame as RGBA bytes, top row first; premultiplied if it is transparent.
    pub(super) fn read(&self) -> Vec<u8> {
        let mut rgba = self.renderer.read();
        if let Some(coverage) = &self.coverage {
            coverage.put_into(&mut rgba);
        }
        rgba
    }
}

impl Model {
    pub(super) fn world(&self) -> &World {
        self.resources.world()
    }
}

fn warn_of_a_camera_inside(world: &World, frame: &Frame) {
    let eye = frame.camera.position.to_array().map(|part| part as f32);
    if let Some(object) = world.object_around(eye, &frame.inputs) {
        tracing::warn!(
            "at {:.2} s the camera is inside of the object `{}` of {}, and sees nothing else: move the camera's \
             `position` out of it",
            frame.inputs.time,
            object.name,
            world.name
        );
    }
}

/// Returns the values at which `set` holds inputs of `scene`. Ignores inputs that the scene does not have.
///
/// # Errors
/// Fails if a value is outside its input's range.
pub fn held_of(scene: &Scene, set: &[Setting]) -> Result<HeldInputs, ExportError> {
    let mut held = HeldInputs::default();
    for setting in set {
        held.hold(scene, setting).map_err(ExportError::Refused)?;
    }
    Ok(held)
}

/// Refuses settings of inputs that none of the scenes has, and values outside an input's range.
///
/// # Errors
/// Fails if all scenes lack an input, or if a value is outside its range.
pub fn require_inputs(scenes: &[&Scene], set: &[Setting]) -> Result<(), ExportError> {
    for setting in set {
        let mut known = false;
        for scene in scenes {
            known |= HeldInputs::default().hold(scene, setting).map_err(ExportError::Refused)?;
        }
        if !known {
            let (name, inputs) = (&setting.name, input_names(scenes));
            let dotted = format!("{name}.");
            let sides = SoundInput::ALL.map(SoundInput::name);
            let sides: Vec<&str> = sides.into_iter().filter(|side| side.starts_with(&dotted)).collect();
            if !sides.is_empty() {
                let sides = sides.join(" or ");
                return refuse(format!(
                    "'{name}' is a value of the sound with several numbers: give --set one of them, {sides}"
                ));
            }
            return refuse(format!("no input is called '{name}': choose one of {inputs} for --set"));
        }
    }
    Ok(())
}

/// Returns the mode in which a scene is drawn on a driver.
pub fn mode_on(choice: SdfChoice, buffers: &TapeBuffers, plan: &RegionPlan, driver: &GlInfo) -> Mode {
    match (choice, Interpreter::fits(buffers, plan, driver)) {
        (SdfChoice::Interpreted, Ok(())) => Mode::Interpreted,
        (SdfChoice::Auto, Ok(())) if buffers.cost.compiled > COMPILED_BY_ITSELF_MAX => Mode::Interpreted,
        (SdfChoice::Interpreted, Err(error)) => {
            tracing::warn!("{error}");
            Mode::Compiled
        }
        (SdfChoice::Compiled | SdfChoice::Auto, _) => Mode::Compiled,
    }
}
