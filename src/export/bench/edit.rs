//! The time from an edit of a scene to its first interpreted and compiled frames.

use std::time::{Instant, SystemTime};

use super::{BenchRequest, EditReport, Measurement, milliseconds};
use crate::export::error::ExportError;
use crate::frame::Frame;
use crate::gpu::scene_program::{drawing_variant_of, link_scene};
use crate::gpu::{Counting, Interpreter, Mode, Program, Renderer, SceneResources};
use crate::scenes::ReadyScene;
use mariana_music::Sound;

/// Adds a small ball at a new position, so that no driver has cached the scene. Measures the time to the first frames.
///
/// # Errors
/// Fails if the scene is a single formula, cannot be read, or cannot be drawn.
pub(super) fn measure_edit(
    renderer: &mut Renderer,
    request: &BenchRequest,
    before: &SceneResources,
    sound: Sound,
    runs: &[Measurement],
) -> Result<EditReport, ExportError> {
    let gl = renderer.gl().clone();
    let source = &request.scene.source;
    let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
    let height = f64::from(since.subsec_nanos()) * 1e-9;
    let edited = format!(
        "{}\nobject benchmark_edit {{ shape = length(p - vec3(0, {height:.9}, 0)) - 0.01 }}\n",
        source.text()?
    );

    let start = Instant::now();
    let ReadyScene { world, buffers, plan, .. } = source.ready_as(&edited)?;
    let resources = SceneResources::upload(&gl, Some(before), world.clone(), buffers.clone(), plan.clone())?;
    let frame = Frame::new(&world, request.at, sound, request.size);
    let built = resources.region_maker().build(&frame, resources.region_request(&frame));
    resources.upload_regions(built.into());
    let prepared = start.elapsed();
    let mut draw = |program: &Program, start: Instant| {
        renderer.draw(&frame, &resources, program)?;
        gl.finish();
        Ok::<_, ExportError>(milliseconds(prepared + start.elapsed()))
    };
    let (mut interpreted_ms, mut new_interpreter) = (None, false);
    if Interpreter::fits(&buffers, &plan, gl.info()).is_ok() {
        let start = Instant::now();
        let wanted = Interpreter::for_scene(world.features, &buffers, &plan, gl.info());
        let known = runs.iter().find(|run| run.mode == Mode::Interpreted).filter(|_| {
            let (buffers, plan) = (before.buffers(), before.plan());
            Interpreter::for_scene(before.world().features, buffers, plan, gl.info()).covers(&wanted)
        });
        interpreted_ms = Some(match known {
            Some(run) => draw(&run.made.program, start)?,
            None => {
                new_interpreter = true;
                let variant = wanted.variant(Counting::Off);
                draw(&link_scene(&gl, &request.scene.shaders, &variant)?, start)?
            }
        });
    }
    let start = Instant::now();
    let cells = request.scene.cells;
    let variant = drawing_variant_of(&world, &buffers, &plan, Mode::Compiled, cells, gl.info())?;
    let compiled_ms = draw(&link_scene(&gl, &request.scene.shaders, &variant)?, start)?;
    Ok(EditReport { interpreted_ms, new_interpreter, compiled_ms })
}
