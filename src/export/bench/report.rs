//! Results of `mariana bench`, as JSON and as text.

use serde::Serialize;

use crate::gpu::{Evaluations, GlInfo, Mode};
use mariana_field::region::RegionStats;
use mariana_field::world::Cost;

/// Results for one scene.
#[derive(Debug, Serialize)]
pub struct BenchReport {
    /// The driver.
    pub gl: GlInfo,
    /// Name of the scene.
    pub scene: String,
    /// Number of clauses in each of the scene's programs.
    pub clauses: Cost,
    /// Width and height in pixels.
    pub size: (u32, u32),
    /// The moment, in seconds.
    pub at: f64,
    /// Requested number of frames in each row.
    pub frames: usize,
    /// Time to create a GL context, in ms.
    pub context_ms: f64,
    /// Time from the scene's text to tapes and bounds, in ms.
    pub scene_ms: f64,
    /// One row for each measured mode, with and without regions.
    pub modes: Vec<ModeReport>,
    /// Quality of edges for each number of samples; empty unless requested.
    pub edges: Vec<EdgeReport>,
    /// Reasons for missing measurements.
    pub notes: Vec<String>,
}

/// Quality of edges, compared to a regular grid of 64 samples in each pixel.
#[derive(Debug, Serialize)]
pub struct EdgeReport {
    /// Number of additional samples in each pixel at an edge.
    pub samples: usize,
    /// Fraction of the window's width and height that was drawn, 0..1; the image was then enlarged.
    pub scale: f64,
    /// Time of a frame on all processor cores together, median, in ms.
    pub cpu_ms: f64,
    /// Fraction of the pixels that got these samples, 0..1.
    pub fraction: f64,
    /// Peak signal-to-noise ratio of the final image without grain, in dB.
    pub decibels: f64,
}

/// Results of one row.
#[derive(Debug, Serialize)]
pub struct ModeReport {
    /// Interpreted or compiled.
    pub mode: Mode,
    /// True if space was divided into cells.
    pub regions: bool,
    /// Number of timed frames. Slow frames make this number lower than the requested number.
    pub frames: usize,
    /// Median time to build the tree of regions, in ms; if interpreted, also to shorten materials and light.
    pub build_ms: f64,
    /// The same time for the next frames, each of which reuses the previous tree; 0 at the end of the song.
    pub next_build_ms: f64,
    /// Statistics of the tree.
    pub tree: RegionStats,
    /// Time of assembling, compiling and linking the program, in ms.
    pub shader_ms: f64,
    /// Time of the first frame, for which drivers may compile again, in ms.
    pub first_draw_ms: f64,
    /// Wall time of a frame, median, in ms.
    pub wall_p50_ms: f64,
    /// Wall time of a frame, 99th percentile, in ms.
    pub wall_p99_ms: f64,
    /// Time of a frame on all processor cores together, median, in ms.
    pub cpu_p50_ms: f64,
    /// Time of a frame on the GPU, median, in ms; `None` without a timer.
    pub gpu_p50_ms: Option<f64>,
    /// Distance evaluations and clauses per pixel.
    pub evaluations_per_pixel: Evaluations,
    /// Sum of all kinds of evaluations.
    pub evaluations_per_pixel_total: f64,
}

type Row<'a> = (&'a str, &'a dyn Fn(&ModeReport) -> String);

impl std::fmt::Display for BenchReport {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        writeln!(f, "{} ({})", self.gl.renderer, self.gl.version)?;
        writeln!(
            f,
            "{}: {} clauses for the distance, {} in all; {}x{}, t = {} s, {} frames in each row",
            self.scene,
            self.clauses.distance,
            self.clauses.total,
            self.size.0,
            self.size.1,
            self.at,
            self.frames
        )?;
        writeln!(f, "start: scene {:.1} ms, context {:.0} ms", self.scene_ms, self.context_ms)?;
        for note in &self.notes {
            writeln!(f, "{note}")?;
        }
        writeln!(f)?;
        let rows: [Row; 26] = [
            ("", &|row| row.mode.to_string()),
            ("", &|row| if row.regions { "regions" } else { "no regions" }.to_owned()),
            ("tree, ms", &|row| format!("{:.2}", row.build_ms)),
            ("  of the next frame, ms", &|row| format!("{:.2}", row.next_build_ms)),
            ("  cells", &|row| row.tree.cells.to_string()),
            ("  distinct tapes", &|row| row.tree.tapes.to_string()),
            ("  KiB", &|row| (row.tree.bytes / 1024).to_string()),
            ("shader, ms", &|row| format!("{:.0}", row.shader_ms)),
            ("first draw, ms", &|row| format!("{:.0}", row.first_draw_ms)),
            ("frame, wall, p50, ms", &|row| format!("{:.2}", row.wall_p50_ms)),
            ("frame, wall, p99, ms", &|row| format!("{:.2}", row.wall_p99_ms)),
            ("frame, CPU, all cores, p50, ms", &|row| format!("{:.2}", row.cpu_p50_ms)),
            ("frame, GPU, p50, ms", &|row| {
                // Software renderers have no timer.
                row.gpu_p50_ms.map_or_else(|| "-".to_owned(), |gpu| format!("{gpu:.2}"))
            }),
            ("cell lookups per pixel", &|row| format!("{:.2}", row.evaluations_per_pixel.lookups)),
            ("clauses of distances per pixel", &|row| format!("{:.1}", row.evaluations_per_pixel.clauses)),
            ("clauses of materials and light", &|row| {
                format!("{:.1}", row.evaluations_per_pixel.surface_clauses)
            }),
            ("evaluations per pixel", &|row| format!("{:.2}", row.evaluations_per_pixel_total)),
            ("  primary", &|row| format!("{:.2}", row.evaluations_per_pixel.primary)),
            ("  reflection", &|row| format!("{:.2}", row.evaluations_per_pixel.reflection)),
            ("  normal", &|row| format!("{:.2}", row.evaluations_per_pixel.normal)),
            ("  shadow", &|row| format!("{:.2}", row.evaluations_per_pixel.shadow)),
            ("  occlusion", &|row| format!("{:.2}", row.evaluations_per_pixel.occlusion)),
            ("of media", &|row| format!("{:.2}", row.evaluations_per_pixel.media)),
            ("steps through media", &|row| format!("{:.2}", row.evaluations_per_pixel.media_steps)),
            ("steps through swarms", &|row| format!("{:.2}", row.evaluations_per_pixel.swarm_steps)),
            ("rays at their step cap, %", &|row| {
                format!("{:.4}", 100.0 * row.evaluations_per_pixel.capped_rays)
            }),
        ];
        for (title, value) in rows {
            write!(f, "{title:<32}")?;
            for row in &self.modes {
                write!(f, "{:>14}", value(row))?;
            }
            writeln!(f)?;
        }
        let edge = self.modes.first().map_or(0.0, |row| row.evaluations_per_pixel.edge_pixels);
        write!(f, "{:<32}{:>14}", "pixels with edge samples, %", format!("{:.2}", 100.0 * edge))?;
        for EdgeReport { samples, scale, cpu_ms, fraction, decibels } in &self.edges {
            let percent = 100.0 * fraction;
            write!(
                f,
                "\nscale {scale:.2}, {samples:>2} samples at edges, {percent:.2} % of the pixels, {cpu_ms:.1} ms CPU: \
                 {decibels:.2} dB against 64 in all pixels"
            )?;
        }
        Ok(())
    }
}
