//! What `mariana bench` found out, as JSON and as text.

use serde::Serialize;

use crate::gpu::gl::GlInfo;
use crate::gpu::renderer::Evaluations;
use crate::gpu::scene_program::Mode;
use mariana_field::region::RegionStats;
use mariana_field::world::Cost;

/// What was measured.
#[derive(Debug, Serialize)]
pub struct BenchReport {
    /// The driver.
    pub gl: GlInfo,
    /// The scene.
    pub scene: String,
    /// Clauses of its programs.
    pub clauses: Cost,
    /// Width and height in pixels.
    pub size: (u32, u32),
    /// The moment, in seconds.
    pub at: f64,
    /// Frames that were to be timed in each row.
    pub frames: usize,
    /// From the start of the measurement to a complete context, in ms.
    pub context_ms: f64,
    /// From text to tapes and bounds, in ms.
    pub scene_ms: f64,
    /// A row for each measured mode, with and without regions.
    pub modes: Vec<ModeReport>,
    /// How close edges are to a picture with 64 samples per pixel, by their number of samples; empty unless asked
    /// for.
    pub edges: Vec<EdgeReport>,
    /// How long an edit takes to be seen; none if the scene cannot be edited, which the notes explain.
    pub edit: Option<EditReport>,
    /// Why something was not measured.
    pub notes: Vec<String>,
}

/// How long it takes from a new text of a scene, which no driver has seen, to a picture of it.
#[derive(Debug, Serialize)]
pub struct EditReport {
    /// To the interpreted picture, in ms; none if the tape does not fit the driver.
    pub interpreted_ms: Option<f64>,
    /// Whether another interpreter had to be made for it.
    pub new_interpreter: bool,
    /// To the compiled picture, in ms.
    pub compiled_ms: f64,
}

/// How close pictures are to one with a regular grid of 64 samples in each pixel.
#[derive(Debug, Serialize)]
pub struct EdgeReport {
    /// Further samples of each pixel at an edge.
    pub samples: usize,
    /// Share of the pixels that got these samples, 0..1.
    pub fraction: f64,
    /// Peak signal-to-noise ratio of the finished picture without grain, in dB.
    pub decibels: f64,
}

/// What was measured of one mode.
#[derive(Debug, Serialize)]
pub struct ModeReport {
    /// Interpreted or compiled.
    pub mode: Mode,
    /// Whether space was divided into cells.
    pub regions: bool,
    /// Frames that were timed; fewer than asked for if they took very long.
    pub frames: usize,
    /// Building the tree of regions and, interpreted, shortening materials and light, median, in ms.
    pub build_ms: f64,
    /// The same for the frames that follow, each after the last; 0 if the song ends here.
    pub next_build_ms: f64,
    /// What the tree consists of.
    pub tree: RegionStats,
    /// Assembling, compiling and linking its program, in ms.
    pub shader_ms: f64,
    /// The first draw, at which drivers compile once more, in ms.
    pub first_draw_ms: f64,
    /// The same program made once more, when the driver knows it, in ms.
    pub shader_again_ms: f64,
    /// The first draw of that, in ms.
    pub first_draw_again_ms: f64,
    /// Wall time of a frame, median, in ms.
    pub wall_p50_ms: f64,
    /// Wall time of a frame, 99th percentile, in ms.
    pub wall_p99_ms: f64,
    /// Time that all processor cores together spent on a frame, median, in ms.
    pub cpu_p50_ms: f64,
    /// Time that the GPU spent on a frame, median, in ms; none where its timer reports nothing.
    pub gpu_p50_ms: Option<f64>,
    /// Distance evaluations and clauses per pixel.
    pub evaluations_per_pixel: Evaluations,
    /// Evaluations of all kinds.
    pub evaluations_per_pixel_total: f64,
}

/// A title, and the text of a mode's cell below it.
type Row<'a> = (&'a str, &'a dyn Fn(&ModeReport) -> String);

impl BenchReport {
    /// How much more of the CPU's time an interpreted frame takes than a compiled one, with and without regions.
    fn ratios(&self) -> Vec<(&'static str, f64)> {
        let cpu = |mode: Mode, regions: bool| {
            let row = self.modes.iter().find(|row| row.mode == mode && row.regions == regions)?;
            Some(row.cpu_p50_ms.max(1e-9))
        };
        let ways = [("with", true, true), ("without", false, false), ("with over without", true, false)];
        let ratio = |(what, interpreted, compiled)| {
            let slow = cpu(Mode::Interpreted, interpreted)?;
            Some((what, slow / cpu(Mode::Compiled, compiled)?))
        };
        ways.into_iter().filter_map(ratio).collect()
    }
}

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
        let rows: [Row; 25] = [
            ("", &|row| row.mode.to_string()),
            ("", &|row| if row.regions { "regions" } else { "no regions" }.to_owned()),
            ("tree, ms", &|row| format!("{:.2}", row.build_ms)),
            ("  the next frame's, ms", &|row| format!("{:.2}", row.next_build_ms)),
            ("  cells", &|row| row.tree.cells.to_string()),
            ("  distinct tapes", &|row| row.tree.tapes.to_string()),
            ("  KiB", &|row| (row.tree.bytes / 1024).to_string()),
            ("shader, ms", &|row| format!("{:.0}", row.shader_ms)),
            ("first draw, ms", &|row| format!("{:.0}", row.first_draw_ms)),
            ("shader once more, ms", &|row| format!("{:.0}", row.shader_again_ms)),
            ("  its first draw, ms", &|row| format!("{:.0}", row.first_draw_again_ms)),
            ("frame, wall, p50, ms", &|row| format!("{:.2}", row.wall_p50_ms)),
            ("frame, wall, p99, ms", &|row| format!("{:.2}", row.wall_p99_ms)),
            ("frame, CPU, all cores, p50, ms", &|row| format!("{:.2}", row.cpu_p50_ms)),
            ("frame, GPU, p50, ms", &|row| {
                // A software renderer's timer reports nothing.
                row.gpu_p50_ms.map_or_else(|| "-".to_owned(), |gpu| format!("{gpu:.2}"))
            }),
            ("lookups of cells per pixel", &|row| format!("{:.2}", row.evaluations_per_pixel.lookups)),
            ("clauses per pixel", &|row| format!("{:.1}", row.evaluations_per_pixel.clauses)),
            ("  of materials and light", &|row| format!("{:.1}", row.evaluations_per_pixel.surface_clauses)),
            ("evaluations per pixel", &|row| format!("{:.2}", row.evaluations_per_pixel_total)),
            ("  primary", &|row| format!("{:.2}", row.evaluations_per_pixel.primary)),
            ("  reflection", &|row| format!("{:.2}", row.evaluations_per_pixel.reflection)),
            ("  normal", &|row| format!("{:.2}", row.evaluations_per_pixel.normal)),
            ("  shadow", &|row| format!("{:.2}", row.evaluations_per_pixel.shadow)),
            ("  occlusion", &|row| format!("{:.2}", row.evaluations_per_pixel.occlusion)),
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
        write!(f, "{:<32}{:>14}", "pixels with an edge's samples, %", format!("{:.2}", 100.0 * edge))?;
        if let Some(edit) = &self.edit {
            write!(f, "\nan edit: {edit}")?;
        }
        for EdgeReport { samples, fraction, decibels } in &self.edges {
            let percent = 100.0 * fraction;
            write!(
                f,
                "\n{samples} samples at edges, {percent:.2} % of the pixels: {decibels:.2} dB against 64 everywhere"
            )?;
        }
        for (what, ratio) in self.ratios() {
            write!(f, "\ninterpreted over compiled, CPU, {what} regions: {ratio:.2}")?;
        }
        Ok(())
    }
}

impl std::fmt::Display for EditReport {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.interpreted_ms {
            Some(ms) if self.new_interpreter => {
                write!(f, "interpreted after {ms:.0} ms with another interpreter, ")
            }
            Some(ms) => write!(f, "interpreted after {ms:.0} ms, "),
            None => write!(f, "never interpreted, "),
        }?;
        write!(f, "compiled after {:.0} ms", self.compiled_ms)
    }
}
