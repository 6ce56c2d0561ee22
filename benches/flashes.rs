//! Measures the CPU time, over all cores, that flash limiting takes per frame with this machine's renderer.
//!
//! `cargo bench --bench flashes` prints medians for a calm image and for a strobe. It does not use criterion, for the
//! same reasons as `drawing`.

#![allow(clippy::unwrap_used)]

use cpu_time::ProcessTime;
use mariana::frame::Frame;
use mariana::gpu::headless::Headless;
use mariana::gpu::renderer::{Counting, Renderer};
use mariana::gpu::scene_program::{Mode, link_scene, variant_of};
use mariana::gpu::scene_resources::SceneResources;
use mariana::gpu::shader_source::ShaderLibrary;
use mariana::scenes::{ReadyScene, SceneSource};
use mariana_music::Features;

const WALL: &str = "material paint { color = 0  roughness = 1  emission = 2 * step(0.5, fract(t)) + 0.1 }\n\
                    object wall { shape = 5 - p.z  material = paint }";
const SIZE: (u32, u32) = (640, 360);
const FRAMES: usize = 240;
const FPS: f64 = 60.0;

fn main() {
    let context = Headless::new(false).unwrap();
    let (gl, library) = (context.gl(), ShaderLibrary::embedded());
    let ReadyScene { world, buffers, plan, .. } = SceneSource::Formula(WALL.into()).ready().unwrap();
    let resources = SceneResources::upload(gl, None, world.clone(), buffers.clone(), plan.clone()).unwrap();
    let variant = variant_of(&world, &buffers, &plan, Mode::Compiled, gl.info(), Counting::Off).unwrap();
    let program = link_scene(gl, &library, &variant).unwrap();
    for (name, hz) in [("calm", 0.0), ("a strobe", 10.0)] {
        for window in [true, false] {
            let mut renderer = Renderer::new(gl, &library, Counting::Off).unwrap();
            renderer.add_flash_limiter(&library).unwrap();
            if window {
                renderer.prepare_for_window(&library).unwrap();
            }
            let mut times = Vec::new();
            for number in 0..FRAMES {
                let frame = Frame::new(&world, number as f64 / FPS * hz + 1e-4, Features::SILENCE, SIZE);
                renderer.draw(&frame, &resources, &program).unwrap();
                gl.finish();
                let start = ProcessTime::now();
                renderer.limit_flashes(1.0 / FPS).unwrap();
                gl.finish();
                times.push(start.elapsed().as_secs_f64() * 1000.0);
            }
            // Leave out the first second, in which the limiter never dims.
            let mut times = times.split_off(FPS as usize);
            times.sort_by(f64::total_cmp);
            let place = if window { "decided" } else { "decided and drawn to a copy" };
            println!("{name}, {}x{}: {:.2} ms of CPU, {place}", SIZE.0, SIZE.1, times[times.len() / 2]);
        }
    }
}
