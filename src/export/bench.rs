//! Measurements without a window: frame times, CPU time, distance evaluations.

use std::time::{Duration, Instant};

use cpu_time::ProcessTime;
use serde::Serialize;

use super::error::ExportError;
use super::song_features::SongFeatures;
use crate::audio::song::Song;
use crate::frame::Frame;
use crate::gpu::gl::GlInfo;
use crate::gpu::headless::Headless;
use crate::gpu::renderer::{Counting, Evaluations, Renderer};
use crate::gpu::shader_source::ShaderLibrary;
use crate::gpu::timer::GpuTimer;

/// What to measure.
#[derive(Debug, Clone)]
pub struct BenchRequest {
    /// The song that drives the picture.
    pub song: Song,
    /// The moment that is drawn again and again, in seconds.
    pub at: f64,
    /// Width and height in pixels.
    pub size: (u32, u32),
    /// Number of frames that are timed.
    pub frames: usize,
    /// The shaders.
    pub shaders: ShaderLibrary,
}

/// What was measured.
#[derive(Debug, Serialize)]
pub struct BenchReport {
    /// The driver.
    pub gl: GlInfo,
    /// Width and height in pixels.
    pub size: (u32, u32),
    /// The moment, in seconds.
    pub at: f64,
    /// Frames that were timed.
    pub frames: usize,
    /// From the start of the measurement to a finished context, in ms.
    pub context_ms: f64,
    /// From there to compiled shaders and loaded textures, in ms.
    pub shaders_ms: f64,
    /// The first draw, in which drivers compile once more, in ms.
    pub first_draw_ms: f64,
    /// Wall time of a frame, median, in ms.
    pub wall_p50_ms: f64,
    /// Wall time of a frame, 99th percentile, in ms.
    pub wall_p99_ms: f64,
    /// Time that all processor cores together spent for a frame, median, in ms.
    pub cpu_p50_ms: f64,
    /// Time that the GPU spent for a frame, median, in ms; none where its timer tells nothing.
    pub gpu_p50_ms: Option<f64>,
    /// Distance evaluations per pixel by kind of ray.
    pub evaluations_per_pixel: Evaluations,
    /// Those of all kinds.
    pub evaluations_per_pixel_total: f64,
}

/// Measures.
///
/// # Errors
/// The song cannot be decoded or the driver refuses.
pub fn measure(request: &BenchRequest) -> Result<BenchReport, ExportError> {
    let features = SongFeatures::open(&request.song, request.at)?.require(request.at)?;
    let frame = Frame::new(request.at, features, request.size);

    let start = Instant::now();
    let context = Headless::new(false)?;
    let gl = context.gl();
    let context_ms = milliseconds(start.elapsed());
    let start = Instant::now();
    let mut renderer = Renderer::new(gl, &request.shaders, Counting::Off)?;
    let shaders_ms = milliseconds(start.elapsed());
    let start = Instant::now();
    renderer.draw(&frame)?;
    gl.finish();
    let first_draw_ms = milliseconds(start.elapsed());

    let timer = if gl.info().software { None } else { Some(GpuTimer::new(gl)?) };
    let (mut wall, mut cpu, mut gpu) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..request.frames.max(1) {
        let (wall_start, cpu_start) = (Instant::now(), ProcessTime::now());
        let drawn = match &timer {
            Some(timer) => {
                let (drawn, duration) = timer.time(|| renderer.draw(&frame));
                gpu.push(milliseconds(duration));
                drawn
            }
            None => renderer.draw(&frame),
        };
        drawn?;
        gl.finish();
        wall.push(milliseconds(wall_start.elapsed()));
        cpu.push(milliseconds(cpu_start.elapsed()));
    }
    drop(renderer);

    let mut counter = Renderer::new(gl, &request.shaders, Counting::On)?;
    counter.draw(&frame)?;
    let pixels = f64::from(request.size.0) * f64::from(request.size.1);
    let evaluations = counter.evaluations().per_pixel(pixels);
    Ok(BenchReport {
        gl: gl.info().clone(),
        size: request.size,
        at: request.at,
        frames: wall.len(),
        context_ms,
        shaders_ms,
        first_draw_ms,
        wall_p50_ms: percentile(&mut wall, 0.5),
        wall_p99_ms: percentile(&mut wall, 0.99),
        cpu_p50_ms: percentile(&mut cpu, 0.5),
        gpu_p50_ms: (!gpu.is_empty()).then(|| percentile(&mut gpu, 0.5)),
        evaluations_per_pixel: evaluations,
        evaluations_per_pixel_total: evaluations.total(),
    })
}

impl std::fmt::Display for BenchReport {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let per_pixel = &self.evaluations_per_pixel;
        writeln!(f, "{} ({})", self.gl.renderer, self.gl.version)?;
        writeln!(f, "{}x{}, t = {} s, {} frames", self.size.0, self.size.1, self.at, self.frames)?;
        writeln!(f)?;
        writeln!(
            f,
            "start           context {:.0} ms, shaders and textures {:.0} ms, first draw {:.0} ms",
            self.context_ms, self.shaders_ms, self.first_draw_ms
        )?;
        writeln!(f, "frame, wall     p50 {:.2} ms, p99 {:.2} ms", self.wall_p50_ms, self.wall_p99_ms)?;
        writeln!(f, "frame, CPU      p50 {:.2} ms over all cores", self.cpu_p50_ms)?;
        match self.gpu_p50_ms {
            Some(gpu) => writeln!(f, "frame, GPU      p50 {gpu:.2} ms")?,
            None => writeln!(f, "frame, GPU      not measured: a software renderer's timer tells nothing")?,
        }
        writeln!(f)?;
        writeln!(f, "distance evaluations per pixel   {:7.2}", self.evaluations_per_pixel_total)?;
        for (kind, value) in [
            ("primary", per_pixel.primary),
            ("reflection", per_pixel.reflection),
            ("normal", per_pixel.normal),
            ("shadow", per_pixel.shadow),
            ("occlusion", per_pixel.occlusion),
        ] {
            writeln!(f, "  {kind:<30} {value:7.2}")?;
        }
        writeln!(f, "rays at their step cap           {:7.4} %", 100.0 * per_pixel.capped_rays)?;
        write!(f, "pixels with an edge's samples    {:7.2} %", 100.0 * per_pixel.edge_pixels)
    }
}

fn milliseconds(duration: Duration) -> f64 {
    duration.as_secs_f64() * 1000.0
}

/// Nearest-rank percentile; 0 for no values.
fn percentile(values: &mut [f64], share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let rank = (share * values.len() as f64).ceil() as usize;
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
