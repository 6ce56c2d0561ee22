//! `mariana bench`: measures times, evaluations and clauses without a window, for each mode with and without regions.

mod all;
mod report;

use std::rc::Rc;
use std::sync::Arc;
use std::time::{Duration, Instant};

pub use all::{AllReport, measure_all};
use cpu_time::ProcessTime;
pub use report::{BenchReport, EdgeReport, ModeReport};

use super::error::ExportError;
use super::painter::SceneChoice;
use super::song_features::SongFeatures;
use crate::config::SdfChoice;
use crate::frame::Frame;
use crate::gpu::scene_program::{drawing_variant_of, link_scene, variant_of};
use crate::gpu::timer::GpuTimer;
use crate::gpu::{
    BuiltRegions, CellUse, Counting, EdgeSamples, Evaluations, Gl, Headless, Interpreter, Mode, Program,
    RegionMaker, Renderer, SceneResources, Variant,
};
use crate::scenes::ReadyScene;
use mariana_music::{Gain, Sound};
use mariana_player::song::Song;

/// Options of a measurement.
#[derive(Debug, Clone)]
pub struct BenchRequest {
    /// The song that drives the scene.
    pub song: Song,
    /// The moment that is drawn repeatedly, in seconds.
    pub at: f64,
    /// Width and height in pixels.
    pub size: (u32, u32),
    /// Number of frames to time in each row.
    pub frames: usize,
    /// Automatic gain.
    pub gain: Gain,
    /// The scene; `auto` measures both modes.
    pub scene: SceneChoice,
    /// True to measure both with and without regions; false to measure only what the field `scene` selects.
    pub both: bool,
    /// True to measure the quality of edges too, which is slow.
    pub edges: bool,
}

/// Runs the measurement. Rows are drawn alternately, frame by frame, so that load on the machine affects all rows.
///
/// # Errors
/// Fails if the song cannot be decoded, the scene has mistakes, or the driver reports an error.
pub fn measure(request: &BenchRequest) -> Result<BenchReport, ExportError> {
    let mut song = SongFeatures::open_with(&request.song, request.at, request.gain)?;
    let mut sound = song.require(request.at)?;
    let start = Instant::now();
    let ready = request.scene.source.ready()?;
    let scene_ms = milliseconds(start.elapsed());
    song.know_for(&ready.world.scene.graph);
    sound = song.placed(request.at, sound);
    let frame = Frame::new(&ready.world, request.at, sound.clone(), request.size);
    let following = following_frames(request, &ready, &mut song, &sound)?;

    let start = Instant::now();
    let context = Headless::new(request.scene.verbose)?;
    let gl = context.gl();
    let context_ms = milliseconds(start.elapsed());
    let resources =
        SceneResources::upload(gl, None, ready.world.clone(), ready.buffers.clone(), ready.plan.clone())?;
    let bench = Bench { request, gl, ready, resources, frame, following };
    let (modes, notes) = bench.modes();
    let mut renderer = Renderer::new(gl, &request.scene.shaders, Counting::Off)?;
    let mut runs: Vec<Measurement> = Vec::new();
    for mode in modes {
        bench.start_runs(&mut renderer, mode, &mut runs)?;
    }
    bench.time(&mut renderer, &mut runs)?;
    let edges = match runs.first() {
        Some(run) if request.edges => measure_edges(&mut renderer, &bench.resources, run, &bench.frame)?,
        _ => Vec::new(),
    };
    drop(renderer);

    Ok(BenchReport {
        gl: gl.info().clone(),
        scene: bench.ready.world.name.clone(),
        clauses: bench.ready.buffers.cost,
        size: request.size,
        at: request.at,
        frames: request.frames.max(1),
        context_ms,
        scene_ms,
        modes: bench.count(runs)?,
        edges,
        notes,
    })
}

fn following_frames(
    request: &BenchRequest,
    ready: &ReadyScene,
    song: &mut SongFeatures,
    sound: &Sound,
) -> Result<Vec<Frame>, ExportError> {
    let mut following = Vec::with_capacity(BUILDS);
    for number in 1..=BUILDS {
        let at = request.at + number as f64 * FRAME_SECONDS;
        if let Some(next) = song.sound_at(at)? {
            let next = Sound { song: sound.song, ..next };
            following.push(Frame::new(&ready.world, at, next, request.size));
        }
    }
    Ok(following)
}

struct Bench<'a> {
    request: &'a BenchRequest,
    gl: &'a Gl,
    ready: ReadyScene,
    resources: SceneResources,
    frame: Frame,
    following: Vec<Frame>,
}

impl Bench<'_> {
    fn modes(&self) -> (Vec<Mode>, Vec<String>) {
        let (mut modes, mut notes) = (Vec::new(), Vec::new());
        let sdf = self.request.scene.sdf;
        if sdf != SdfChoice::Compiled {
            match Interpreter::fits(&self.ready.buffers, &self.ready.plan, self.gl.info()) {
                Ok(()) => modes.push(Mode::Interpreted),
                Err(error) => notes.push(error.to_string()),
            }
        }
        if sdf != SdfChoice::Interpreted || modes.is_empty() {
            modes.push(Mode::Compiled);
        }
        (modes, notes)
    }

    fn start_runs(
        &self,
        renderer: &mut Renderer,
        mode: Mode,
        runs: &mut Vec<Measurement>,
    ) -> Result<(), ExportError> {
        let request = self.request;
        let ways: &[bool] =
            if request.both { &[true, false] } else { &[request.scene.cells != CellUse::Never] };
        for &regions in ways {
            // In interpreted mode, the rows with and without regions have the same program.
            let run = self.start_run(renderer, mode, regions, runs.last())?;
            runs.push(run);
        }
        Ok(())
    }

    /// Prepares a row. Reuses the program of the `last` row if the row needs the same variant.
    fn start_run(
        &self,
        renderer: &mut Renderer,
        mode: Mode,
        regions: bool,
        last: Option<&Measurement>,
    ) -> Result<Measurement, ExportError> {
        let (resources, frame, library) = (&self.resources, &self.frame, &self.request.scene.shaders);
        let ReadyScene { world, buffers, plan, .. } = &self.ready;
        let start = Instant::now();
        let cells = if regions { CellUse::Always } else { CellUse::Never };
        let variant = drawing_variant_of(world, buffers, plan, mode, cells, self.gl.info())?;
        let (program, shader_ms) = match last.filter(|last| last.variant == variant) {
            Some(last) => (last.program.clone(), last.shader_ms),
            None => (Rc::new(link_scene(self.gl, library, &variant)?), milliseconds(start.elapsed())),
        };
        let (built, build_ms, next_build_ms) = build(resources, frame, &self.following, regions, mode);
        resources.upload_regions(built.clone());
        let start = Instant::now();
        renderer.draw(frame, resources, &program)?;
        self.gl.finish();
        let first_draw_ms = milliseconds(start.elapsed());
        let (wall, cpu, gpu) = Default::default();
        Ok(Measurement {
            mode,
            regions,
            built,
            build_ms,
            next_build_ms,
            variant,
            program,
            shader_ms,
            first_draw_ms,
            wall,
            cpu,
            gpu,
        })
    }

    fn time(&self, renderer: &mut Renderer, runs: &mut [Measurement]) -> Result<(), ExportError> {
        let (gl, resources, frame) = (self.gl, &self.resources, &self.frame);
        let timer = gl.info().has_timers().then(|| GpuTimer::new(gl)).transpose()?;
        for _ in 0..self.request.frames.max(1) {
            for run in &mut *runs {
                if run.wall.len() >= FRAMES_MIN && run.wall.iter().sum::<f64>() > ROW_MS_MAX {
                    continue;
                }
                resources.set_cells(run.regions, run.mode);
                resources.upload_regions(run.built.clone());
                gl.finish();
                let (wall_start, cpu_start) = (Instant::now(), ProcessTime::now());
                let drawn = match &timer {
                    Some(timer) => {
                        let (drawn, duration) = timer.time(|| renderer.draw(frame, resources, &run.program));
                        run.gpu.push(milliseconds(duration));
                        drawn
                    }
                    None => renderer.draw(frame, resources, &run.program),
                };
                drawn?;
                gl.finish();
                run.wall.push(milliseconds(wall_start.elapsed()));
                run.cpu.push(milliseconds(cpu_start.elapsed()));
            }
        }
        Ok(())
    }

    fn count(&self, runs: Vec<Measurement>) -> Result<Vec<ModeReport>, ExportError> {
        let (gl, library, size) = (self.gl, &self.request.scene.shaders, self.request.size);
        let ReadyScene { world, buffers, plan, .. } = &self.ready;
        let mut counter = Renderer::new(gl, library, Counting::On)?;
        let pixels = f64::from(size.0) * f64::from(size.1);
        let mut reports = Vec::with_capacity(runs.len());
        for mut run in runs {
            let variant = variant_of(world, buffers, plan, run.mode, gl.info(), Counting::On)?;
            let program = link_scene(gl, library, &variant)?;
            self.resources.set_cells(run.regions, run.mode);
            self.resources.upload_regions(run.built.clone());
            counter.draw(&self.frame, &self.resources, &program)?;
            let evaluations = counter.evaluations(pixels);
            reports.push(run.report(evaluations));
        }
        Ok(reports)
    }
}

/// Fractions of a window's width and height in which frames are compared: the whole window, and sizes that the window
/// chooses when frames are late.
const EDGE_SCALES: [f64; 5] = [1.0, 0.92, 0.84, 0.77, 0.64];

/// Number of frames for the median of the CPU time of each number of samples.
const EDGE_FRAMES: usize = 3;

/// Compares frames with each number of edge samples, at several sizes, with a reference of 64 samples in every pixel.
fn measure_edges(
    renderer: &mut Renderer,
    resources: &SceneResources,
    run: &Measurement,
    frame: &Frame,
) -> Result<Vec<EdgeReport>, ExportError> {
    resources.set_cells(run.regions, run.mode);
    resources.upload_regions(run.built.clone());
    let mut frame = frame.clone();
    frame.picture.grain = 0.0;
    renderer.draw_reference(&frame, resources, &run.program)?;
    let reference = renderer.read();
    let (gl, (width, height)) = (renderer.gl().clone(), frame.size);
    let mut reports = Vec::new();
    let ways = EDGE_SCALES.into_iter().flat_map(|scale| EdgeSamples::ALL.map(|samples| (scale, samples)));
    for (scale, samples) in ways {
        let scaled = |side: u32| (f64::from(side) * scale).round() as u32;
        let size = (scaled(width), scaled(height));
        // As in a window, the rounded size does not change the aspect.
        let aspect = f64::from(width) / f64::from(height);
        let world = resources.world();
        let frame = frame.clone().resized(world, size).in_window(world, aspect, 1.0);
        renderer.set_edge_samples(samples);
        let mut cpu = Vec::with_capacity(EDGE_FRAMES);
        for _ in 0..EDGE_FRAMES {
            gl.finish();
            let start = ProcessTime::now();
            renderer.draw(&frame, resources, &run.program)?;
            gl.finish();
            cpu.push(milliseconds(start.elapsed()));
        }
        let pixels = f64::from(frame.size.0) * f64::from(frame.size.1);
        let fraction = renderer.edge_pixels() / pixels;
        let enlarged = enlarged(renderer.read(), frame.size, (width, height));
        let decibels = peak_signal_over_noise(&enlarged, &reference);
        reports.push(EdgeReport {
            samples: samples.count(),
            scale,
            fraction,
            cpu_ms: percentile(&mut cpu, 0.5),
            decibels,
        });
    }
    Ok(reports)
}

/// Enlarges an RGBA image as a window does (`upscale.frag`).
fn enlarged(rgba: Vec<u8>, size: (u32, u32), window: (u32, u32)) -> Vec<u8> {
    let Some(image) = image::RgbaImage::from_raw(size.0, size.1, rgba) else { return Vec::new() };
    image::imageops::resize(&image, window.0, window.1, image::imageops::FilterType::CatmullRom).into_raw()
}

/// Returns the peak signal-to-noise ratio of two RGBA images, in dB; infinite if the images are equal.
pub fn peak_signal_over_noise(picture: &[u8], reference: &[u8]) -> f64 {
    let pairs = picture.as_chunks::<4>().0.iter().zip(reference.as_chunks::<4>().0);
    let squares = pairs.flat_map(|(a, b)| (0..3).map(|i| f64::from(a[i].abs_diff(b[i])).powi(2)));
    let (sum, count) = squares.fold((0.0, 0.0), |(sum, count), square| (sum + square, count + 1.0));
    10.0 * (255.0 * 255.0 * count / sum).log10()
}

/// A row with at least [`FRAMES_MIN`] frames ends after this total time, in ms.
const ROW_MS_MAX: f64 = 20_000.0;
/// Minimum number of frames in a row.
const FRAMES_MIN: usize = 3;
/// Number of trees built for the median of the build time.
const BUILDS: usize = 9;
const FRAME_SECONDS: f64 = 1.0 / 60.0;

/// Builds the regions of a frame. Returns the regions with two median times in ms: the first for a tree without a
/// predecessor, the second for the `following` frames, each of which reuses the previous tree. Programs of materials
/// and light are not shortened if the first attempt saves little.
fn build(
    resources: &SceneResources,
    frame: &Frame,
    following: &[Frame],
    cells: bool,
    mode: Mode,
) -> (Arc<BuiltRegions>, f64, f64) {
    resources.set_cells(cells, mode);
    let after = |last: Option<Arc<BuiltRegions>>, frame: &Frame| {
        let maker = RegionMaker { last, ..resources.region_maker() };
        Arc::new(maker.build(frame, resources.region_request(frame)))
    };
    resources.upload_regions(after(None, frame));
    let built = after(None, frame);
    let mut times: Vec<f64> = (0..BUILDS).map(|_| milliseconds(after(None, frame).time)).collect();
    let mut last = built.clone();
    let next = |frame| {
        last = after(Some(last.clone()), frame);
        milliseconds(last.time)
    };
    let mut next_times: Vec<f64> = following.iter().map(next).collect();
    (built, percentile(&mut times, 0.5), percentile(&mut next_times, 0.5))
}

struct Measurement {
    mode: Mode,
    regions: bool,
    built: Arc<BuiltRegions>,
    build_ms: f64,
    next_build_ms: f64,
    variant: Variant,
    program: Rc<Program>,
    shader_ms: f64,
    first_draw_ms: f64,
    wall: Vec<f64>,
    cpu: Vec<f64>,
    gpu: Vec<f64>,
}

impl Measurement {
    fn report(&mut self, evaluations: Evaluations) -> ModeReport {
        ModeReport {
            mode: self.mode,
            regions: self.regions,
            frames: self.wall.len(),
            build_ms: self.build_ms,
            next_build_ms: self.next_build_ms,
            tree: self.built.regions.stats,
            shader_ms: self.shader_ms,
            first_draw_ms: self.first_draw_ms,
            wall_p50_ms: percentile(&mut self.wall, 0.5),
            wall_p99_ms: percentile(&mut self.wall, 0.99),
            cpu_p50_ms: percentile(&mut self.cpu, 0.5),
            gpu_p50_ms: (!self.gpu.is_empty()).then(|| percentile(&mut self.gpu, 0.5)),
            evaluations_per_pixel: evaluations,
            evaluations_per_pixel_total: evaluations.total(),
        }
    }
}

fn milliseconds(duration: Duration) -> f64 {
    duration.as_secs_f64() * 1000.0
}

/// Returns the nearest-rank percentile; 0 if there are no values.
fn percentile(values: &mut [f64], fraction: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let rank = (fraction * values.len() as f64).ceil() as usize;
    values.get(rank.saturating_sub(1)).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::percentile;

    #[test]
    fn percentiles_are_nearest_ranks() {
        let mut values = [5.0, 1.0, 4.0, 2.0, 3.0];
        assert_eq!(percentile(&mut values, 0.5), 3.0);
        assert_eq!(percentile(&mut values, 0.99), 5.0);
        assert_eq!(percentile(&mut [], 0.5), 0.0);
    }
}
