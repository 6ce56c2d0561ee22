//! `mariana bench --all`: measures all shipped scenes.

use serde::Serialize;

use super::{BenchReport, BenchRequest, ModeReport, measure};
use crate::gpu::gl::GlInfo;
use crate::scenes::{SceneSource, shipped_names};

/// Results of all scenes.
#[derive(Debug, Serialize)]
pub struct AllReport {
    /// The program's version.
    pub version: &'static str,
    /// The driver; `None` if no scene was measured.
    pub gl: Option<GlInfo>,
    /// Width and height in pixels.
    pub size: (u32, u32),
    /// The moment, in seconds.
    pub at: f64,
    /// Requested number of frames in each row.
    pub frames: usize,
    /// The scenes, sorted by name.
    pub scenes: Vec<SceneEntry>,
}

/// The result of a scene, or the error.
#[derive(Debug, Serialize)]
pub struct SceneEntry {
    /// Name of the scene.
    pub scene: String,
    /// The result; `None` after an error.
    pub report: Option<BenchReport>,
    /// The error's message.
    pub error: Option<String>,
}

/// Measures the shipped scenes whose names contain a part in `only`, or all if there are no parts. Each one replaces
/// the scene of `request`. A scene that fails becomes an entry with an error. Calls `progress` before each scene with
/// its name, its number from 1, and the number of scenes.
pub fn measure_all(
    request: &BenchRequest,
    only: &[String],
    progress: &mut dyn FnMut(&str, usize, usize),
) -> AllReport {
    let is_wanted = |name: &String| only.is_empty() || only.iter().any(|part| name.contains(part));
    let names: Vec<String> = shipped_names().into_iter().filter(is_wanted).collect();
    let count = names.len();
    let entry = |(number, scene): (usize, String)| {
        progress(&scene, number, count);
        let mut each = request.clone();
        each.scene.source = SceneSource::Shipped(scene.clone());
        let (report, error) = match measure(&each) {
            Ok(report) => (Some(report), None),
            Err(error) => (None, Some(error.to_string())),
        };
        SceneEntry { scene, report, error }
    };
    let scenes: Vec<SceneEntry> = (1..).zip(names).map(entry).collect();
    AllReport {
        version: env!("CARGO_PKG_VERSION"),
        gl: scenes.iter().find_map(|entry| entry.report.as_ref()).map(|report| report.gl.clone()),
        size: request.size,
        at: request.at,
        frames: request.frames,
        scenes,
    }
}

type Column = (&'static str, fn(&ModeReport) -> String);

const COLUMNS: [Column; 9] = [
    ("CPU ms", |row| format!("{:.2}", row.cpu_p50_ms)),
    ("GPU ms", |row| row.gpu_p50_ms.map_or_else(|| "-".to_owned(), |ms| format!("{ms:.2}"))),
    ("evaluations", |row| format!("{:.1}", row.evaluations_per_pixel_total)),
    ("clauses", |row| format!("{:.1}", row.evaluations_per_pixel.clauses)),
    ("tree ms", |row| format!("{:.2}", row.build_ms)),
    ("next ms", |row| format!("{:.2}", row.next_build_ms)),
    ("cells", |row| row.tree.cells.to_string()),
    ("KiB", |row| (row.tree.bytes / 1024).to_string()),
    ("made ms", |row| format!("{:.0}", row.shader_ms + row.first_draw_ms)),
];

impl std::fmt::Display for AllReport {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if let Some(gl) = &self.gl {
            writeln!(f, "{} ({})", gl.renderer, gl.version)?;
        }
        let (width, height) = self.size;
        writeln!(
            f,
            "{width}x{height}, t = {} s, {} frames in each row; medians, counts per pixel",
            self.at, self.frames
        )?;
        writeln!(
            f,
            "tree: building the first tree; next: the tree of the next frame, which reuses unchanged cells"
        )?;
        writeln!(f, "made: linking the program and drawing once")?;
        write!(f, "\n{:<14}{:<13}{:<8}", "scene", "mode", "tree")?;
        for (title, _) in COLUMNS {
            write!(f, "{title:>12}")?;
        }
        for SceneEntry { scene, report, error } in &self.scenes {
            if let Some(error) = error {
                write!(f, "\n{scene:<14}{error}")?;
            }
            let Some(report) = report else { continue };
            for row in &report.modes {
                let tree = if row.regions { "on" } else { "off" };
                write!(f, "\n{scene:<14}{:<13}{tree:<8}", row.mode.to_string())?;
                for (_, value) in COLUMNS {
                    write!(f, "{:>12}", value(row))?;
                }
            }
            for note in &report.notes {
                write!(f, "\n{scene:<14}{note}")?;
            }
        }
        Ok(())
    }
}
