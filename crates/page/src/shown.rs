//! A scene with its program and the values of its sliders.

use mariana_field::world::World;
use mariana_render::Gl;
use mariana_render::GpuError;
use mariana_render::gpu::mode::CellUse;
use mariana_render::gpu::program::Program;
use mariana_render::gpu::scene_program::{Mode, drawing_variant_of, link_scene};
use mariana_render::gpu::scene_resources::SceneResources;
use mariana_render::gpu::shader_source::ShaderLibrary;
use mariana_scenes::ReadyScene;

pub(crate) struct Shown {
    pub(crate) program: Program,
    pub(crate) resources: SceneResources,
    /// The values of the world's parameters.
    params: Vec<f32>,
}

impl Shown {
    pub(crate) fn new(
        gl: &Gl,
        library: &ShaderLibrary,
        ReadyScene { world, buffers, plan, .. }: ReadyScene,
        mode: Mode,
    ) -> Result<Self, GpuError> {
        // A tree that is built on the page's only thread costs more than it saves in a compiled scene.
        let cells = if mode == Mode::Compiled { CellUse::Never } else { CellUse::default() };
        let variant = drawing_variant_of(&world, &buffers, &plan, mode, cells, gl.info())?;
        let program = link_scene(gl, library, &variant)?;
        let params = world.scene.params.iter().map(|param| param.default).collect();
        let resources = SceneResources::upload(gl, world, buffers, plan)?;
        resources.set_cells(resources.uses_cells(cells, mode), mode);
        Ok(Self { program, resources, params })
    }

    pub(crate) fn world(&self) -> &World {
        self.resources.world()
    }

    pub(crate) fn params(&self) -> &[f32] {
        &self.params
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
