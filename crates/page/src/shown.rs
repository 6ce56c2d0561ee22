//! A scene with its program and the values of its sliders.

use std::sync::Arc;
use std::time::Duration;

use mariana_field::world::World;
use mariana_music::{Features, Sound};
use mariana_render::gpu::mode::CellUse;
use mariana_render::gpu::program::{PendingProgram, Program};
use mariana_render::gpu::scene_program::{COMPILED_BY_ITSELF_MAX, Mode, begin_scene, drawing_variant_of};
use mariana_render::gpu::scene_resources::SceneResources;
use mariana_render::gpu::shader_source::ShaderLibrary;
use mariana_render::{Frame, Gl, GpuError, Renderer};
use mariana_scenes::ReadyScene;
use web_time::Instant;

use super::hearing::Hearing;

/// The longest that the first tree of a scene may take: the page cannot answer in the meantime.
const TREE_MAX: Duration = Duration::from_secs(1);

/// A scene on the GPU.
pub(crate) struct Shown {
    program: Program,
    resources: SceneResources,
    /// The values of the world's parameters.
    params: Vec<f32>,
}

/// A scene whose program the browser compiles.
pub(crate) struct Coming {
    program: PendingProgram,
    resources: SceneResources,
}

impl Coming {
    /// Uploads a scene, and begins to compile its program.
    ///
    /// # Errors
    /// Fails with the browser's error, or if the scene is so large that it would keep the page busy.
    pub(crate) fn begin(
        gl: &Gl,
        library: &ShaderLibrary,
        ReadyScene { world, buffers, plan, .. }: ReadyScene,
        mode: Mode,
    ) -> Result<Self, String> {
        let clauses = buffers.cost.compiled;
        if mode == Mode::Compiled && clauses > COMPILED_BY_ITSELF_MAX {
            return Err(format!(
                "its {clauses} clauses are too many for a browser's compiler: interpret it (C)"
            ));
        }
        let said = |error: GpuError| error.to_string();
        // A tree that is built on the page's only thread costs more than it saves in a compiled scene.
        let cells = if mode == Mode::Compiled { CellUse::Never } else { CellUse::default() };
        let variant = drawing_variant_of(&world, &buffers, &plan, mode, cells, gl.info()).map_err(said)?;
        let resources = SceneResources::upload(gl, None, world, buffers, plan).map_err(said)?;
        resources.set_cells(resources.uses_cells(cells, mode), mode);
        if resources.drawn(mode).cells && !has_quick_tree(&resources) {
            let words = "its region tree needs more than a second on this device: use fewer or simpler parts";
            return Err(words.to_owned());
        }
        let program = begin_scene(gl, library, &variant).map_err(said)?;
        Ok(Self { program, resources })
    }

    pub(crate) fn is_compiled(&self) -> bool {
        self.program.is_finished()
    }

    /// Waits for the browser's compiler.
    ///
    /// # Errors
    /// Fails with the browser's error.
    pub(crate) fn finish(self) -> Result<Shown, GpuError> {
        let program = self.program.finish()?;
        let params = self.resources.world().scene.params.iter().map(|param| param.default).collect();
        Ok(Shown { program, resources: self.resources, params })
    }
}

/// Builds the first tree of a scene. Returns false if that takes more than [`TREE_MAX`].
fn has_quick_tree(resources: &SceneResources) -> bool {
    let frame = Frame::new(resources.world(), 0.0, Features::SILENCE, (16, 9));
    let begun = Instant::now();
    let is_quick = || begun.elapsed() < TREE_MAX;
    let built = resources.region_maker().build_while(&frame, resources.region_request(&frame), &is_quick);
    let is_built = is_quick();
    if is_built {
        resources.upload_regions(Arc::new(built));
    }
    is_built
}

/// A frame of a scene in a picture.
pub(crate) struct ShownLayer<'a> {
    pub(crate) shown: &'a Shown,
    /// The moment of the sound, in seconds.
    pub(crate) time: f64,
    /// The weight of the layers below in the mix with this one, 0..1; `None` for the first.
    pub(crate) below: Option<f32>,
    /// Returns the frame of an earlier moment, or of this one.
    pub(crate) frame_at: Box<dyn Fn(f64, Sound) -> Frame + 'a>,
}

impl ShownLayer<'_> {
    /// Draws the layer over the last picture, with the frames that its scene remembers.
    ///
    /// # Errors
    /// Fails with the browser's error.
    pub(crate) fn draw(&self, renderer: &mut Renderer, hearing: &Hearing) -> Result<(), GpuError> {
        let Shown { program, resources, .. } = self.shown;
        let frame = (self.frame_at)(self.time, hearing.at(self.time));
        let picture = (frame.size, frame.projection.stereo);
        while let Some(request) = renderer.feedback_before(resources, 0, self.time, picture, true) {
            let mut earlier = (self.frame_at)(request.time, hearing.at(request.time));
            earlier.size = request.size;
            renderer.draw_feedback(&request, &earlier, resources, program)?;
        }
        renderer.show_feedback(resources, self.time)?;
        if self.below.is_some() {
            renderer.keep_light()?;
            renderer.set_fade(self.below);
        }
        renderer.draw(&frame, resources, program)
    }
}

impl Shown {
    pub(crate) fn world(&self) -> &World {
        self.resources.world()
    }

    /// The scene with the values of its sliders, as the only layer of a picture of `size` pixels.
    pub(crate) fn layer(&self, time: f64, size: (u32, u32)) -> ShownLayer<'_> {
        let frame_at = move |time, sound| Frame::with_params(self.world(), time, sound, size, &self.params);
        ShownLayer { shown: self, time, below: None, frame_at: Box::new(frame_at) }
    }

    /// The index of each parameter with a slider: all but numbers of the text that are inputs while it is edited.
    fn sliders(&self) -> impl Iterator<Item = usize> {
        let params = self.world().scene.params.iter().enumerate();
        params.filter(|(_, param)| !param.is_number).map(|(place, _)| place)
    }

    pub(crate) fn slider_names(&self) -> impl Iterator<Item = String> {
        self.sliders().filter_map(|place| Some(self.world().scene.params.get(place)?.name.clone()))
    }

    /// Value, minimum and maximum of each slider.
    pub(crate) fn slider_values(&self) -> impl Iterator<Item = f32> {
        let values = self.sliders().filter_map(|place| {
            let param = self.world().scene.params.get(place)?;
            Some([*self.params.get(place)?, param.min, param.max])
        });
        values.flatten()
    }

    pub(crate) fn turn(&mut self, name: &str, value: f32) {
        let params = &self.resources.world().scene.params;
        for (param, own) in params.iter().zip(&mut self.params) {
            if param.name == name && value.is_finite() {
                *own = value.clamp(param.min, param.max);
            }
        }
    }

    /// Takes over turned sliders from the last version of the scene.
    pub(crate) fn keep_values_of(&mut self, last: &Self) {
        for (param, value) in last.world().scene.params.iter().zip(&last.params) {
            if *value != param.default {
                self.turn(&param.name, *value);
            }
        }
    }
}
