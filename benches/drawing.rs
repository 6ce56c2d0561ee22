//! Compares the CPU time of two versions of the scene speakers: compiled, and handwritten in GLSL.
//!
//! `cargo bench --bench drawing` prints medians and their ratio. It does not use criterion, for two reasons. It
//! alternates the scenes frame by frame, so that disturbances affect both. And it measures the time of all processor
//! cores, because Mesa draws on all cores.

#![allow(clippy::unwrap_used)]

use cpu_time::ProcessTime;
use mariana::demo_track::DEMO_TRACK;
use mariana::export::song_features::SongFeatures;
use mariana::frame::Frame;
use mariana::gpu::headless::Headless;
use mariana::gpu::renderer::{Counting, Renderer};
use mariana::gpu::scene_program::{Mode, compiled_variant, link_scene, variant_of};
use mariana::gpu::scene_resources::SceneResources;
use mariana::gpu::shader_source::ShaderLibrary;
use mariana::scenes::{ReadyScene, SceneSource};

const BY_HAND: &str = include_str!("../tests/oracle/speakers.glsl");
const SIZE: (u32, u32) = (640, 360);
const ROUNDS: usize = 25;

fn main() {
    let context = Headless::new(false).unwrap();
    let (gl, library) = (context.gl(), ShaderLibrary::embedded());
    let ReadyScene { world, buffers, plan, .. } = SceneSource::Shipped("speakers".into()).ready().unwrap();
    let resources = SceneResources::upload(gl, None, world.clone(), buffers.clone(), plan.clone()).unwrap();
    let mut renderer = Renderer::new(gl, &library, Counting::Off).unwrap();
    let compiled = variant_of(&world, &buffers, &plan, Mode::Compiled, gl.info(), Counting::Off).unwrap();
    let by_hand = compiled_variant(BY_HAND, world.pictures.len(), world.features, Counting::Off);
    let programs = [compiled, by_hand].map(|variant| link_scene(gl, &library, &variant).unwrap());
    for at in [0.0, 30.0, 62.0] {
        let features = SongFeatures::open(&DEMO_TRACK, at).unwrap().require(at).unwrap();
        let frame = Frame::new(&world, at, features, SIZE);
        let mut times = [Vec::new(), Vec::new()];
        for round in 0..=ROUNDS {
            for (program, times) in programs.iter().zip(&mut times) {
                let start = ProcessTime::now();
                renderer.draw(&frame, &resources, program).unwrap();
                gl.finish();
                if round > 0 {
                    times.push(start.elapsed().as_secs_f64() * 1000.0);
                }
            }
        }
        let [compiled, by_hand] = times.map(|mut times| {
            times.sort_by(f64::total_cmp);
            times[times.len() / 2]
        });
        println!(
            "speakers, {}x{}, t = {at} s: compiled {compiled:.1} ms of CPU, by hand {by_hand:.1} ms, ratio {:.3}",
            SIZE.0,
            SIZE.1,
            compiled / by_hand
        );
    }
}
