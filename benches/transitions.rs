//! Compares the cost of transitions with the cost of their two scenes. The CPU time of each frame of a two-second
//! transition, including the region tree, is divided by the sum of both scenes' medians.
//!
//! `cargo bench --bench transitions` measures the transition from each shipped scene to the next, with every kind of
//! blend; `-- speakers:heart` measures one pair. It does not use criterion, for the same reasons as `drawing`, and
//! because it also reports the longest frame.

#![allow(clippy::unwrap_used)]

use std::sync::Arc;

use cpu_time::ProcessTime;
use mariana::demo_track::DEMO_TRACK;
use mariana::export::song_features::SongFeatures;
use mariana::frame::held_inputs::HeldInputs;
use mariana::frame::{Frame, FrameOptions};
use mariana::gpu::gl::Gl;
use mariana::gpu::headless::Headless;
use mariana::gpu::program::Program;
use mariana::gpu::renderer::{Counting, Renderer};
use mariana::gpu::scene_program::{Mode, link_scene, variant_of};
use mariana::gpu::scene_resources::SceneResources;
use mariana::gpu::shader_source::ShaderLibrary;
use mariana::scenes::{ReadyScene, SceneSource, shipped_names};
use mariana_field::world::{Alignment, BlendKind};
use mariana_music::Sound;

const SIZE: (u32, u32) = (320, 180);
/// Time in the demo track at which transitions start, and their duration, in seconds.
const START: f64 = 20.0;
const SECONDS: f64 = 2.0;
/// Number of measured frames of a transition. The first and last frame are left out: each shows only one scene.
const FRAMES: usize = 24;

struct Model {
    resources: SceneResources,
    program: Program,
}

impl Model {
    fn of(gl: &Gl, library: &ShaderLibrary, ready: ReadyScene) -> Self {
        let ReadyScene { world, buffers, plan, .. } = ready;
        let variant = variant_of(&world, &buffers, &plan, Mode::Compiled, gl.info(), Counting::Off).unwrap();
        let program = link_scene(gl, library, &variant).unwrap();
        let resources = SceneResources::upload(gl, None, world, buffers, plan).unwrap();
        resources.set_cells(true, Mode::Compiled);
        Self { resources, program }
    }

    fn draw(&self, renderer: &mut Renderer, (time, sound): (f64, &Sound), params: &[f32]) -> f64 {
        let held = HeldInputs::default();
        let frame_options = FrameOptions { params, held: &held, camera: None };
        let frame = Frame::staged(self.resources.world(), time, sound.clone(), SIZE, &frame_options);
        let start = ProcessTime::now();
        let built = self.resources.region_maker().build(&frame, self.resources.region_request(&frame));
        self.resources.upload_regions(Arc::new(built));
        renderer.draw(&frame, &self.resources, &self.program).unwrap();
        renderer.gl().finish();
        start.elapsed().as_secs_f64() * 1000.0
    }
}

fn median(times: &[f64]) -> f64 {
    let mut times = times.to_vec();
    times.sort_by(f64::total_cmp);
    times.get(times.len() / 2).copied().unwrap_or(0.0)
}

/// The pairs given on the command line; by default, each shipped scene paired with the next.
fn pairs() -> Vec<(String, String)> {
    let named: Vec<(String, String)> = std::env::args()
        .filter_map(|arg| arg.split_once(':').map(|(from, to)| (from.to_owned(), to.to_owned())))
        .collect();
    if !named.is_empty() {
        return named;
    }
    let names = shipped_names();
    let next = names.iter().cycle().skip(1);
    names.iter().zip(next).map(|(from, to)| (from.clone(), to.clone())).collect()
}

fn main() {
    let context = Headless::new(false).unwrap();
    let (gl, library) = (context.gl(), ShaderLibrary::embedded());
    let mut renderer = Renderer::new(gl, &library, Counting::Off).unwrap();
    let mut song = SongFeatures::open(&DEMO_TRACK, START).unwrap();
    let moments: Vec<(f64, f32, Sound)> = (1..=FRAMES)
        .map(|frame| {
            let fraction = frame as f64 / (FRAMES + 1) as f64;
            let time = START + SECONDS * fraction;
            (time, fraction as f32, song.require(time).unwrap())
        })
        .collect();
    println!("{:30} {:>6} {:>9} {:>11} {:>11}", "pair", "kind", "sum, ms", "median/sum", "longest/sum");
    let mut worst: Vec<f64> = Vec::new();
    for (from, to) in pairs() {
        let [a, b] = [&from, &to].map(|name| SceneSource::Shipped(name.clone()).ready().unwrap());
        let pure = [&a, &b].map(|ready| Model::of(gl, &library, ready.clone()));
        for (kind, name, _) in BlendKind::ALL {
            let camera = |ready: &ReadyScene| {
                let frame_options = FrameOptions { params: &[], held: &HeldInputs::default(), camera: None };
                Frame::staged(&ready.world, START, moments[0].2.clone(), SIZE, &frame_options).values.camera
            };
            let blended = match a.blended(&b, kind, &Alignment::of(&camera(&a), &camera(&b)), 0.5) {
                Ok(blended) => Model::of(gl, &library, blended),
                Err(error) => {
                    println!("{from} into {to}: {error}");
                    continue;
                }
            };
            let mut times = [const { Vec::new() }; 3];
            for (number, (time, fraction, sound)) in moments.iter().enumerate() {
                let both = [&a, &b].into_iter().flat_map(|ready| &ready.world.scene.params);
                let params: Vec<f32> = both.map(|param| param.default).chain([*fraction]).collect();
                let models = [(&pure[0], &[][..]), (&pure[1], &[]), (&blended, &params)];
                for ((model, params), times) in models.into_iter().zip(&mut times) {
                    // Draw the first moment twice: a driver does one-time work during the first draw.
                    if number == 0 {
                        model.draw(&mut renderer, (*time, sound), params);
                    }
                    times.push(model.draw(&mut renderer, (*time, sound), params));
                }
            }
            let sum = median(&times[0]) + median(&times[1]);
            let longest = times[2].iter().copied().fold(0.0, f64::max);
            println!(
                "{:30} {name:>6} {sum:9.1} {:11.2} {:11.2}",
                format!("{from} into {to}"),
                median(&times[2]) / sum,
                longest / sum
            );
            worst.push(longest / sum);
        }
    }
    worst.sort_by(f64::total_cmp);
    println!("longest frame / sum: median {:.2}, worst {:.2}", median(&worst), worst.last().unwrap());
}
