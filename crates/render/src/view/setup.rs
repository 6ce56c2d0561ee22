//! Sets up a view of a frame: computes the shaders' numbers and makes the legend.

use glam::DVec3;

use super::legend::{Legend, Ramp, Scale};
use super::scale::{self, Color, nice, written};
use super::{View, ViewChoice};
use crate::frame::Frame;
use mariana_field::world::World;

/// The block `ViewBlock` of `shaders/view_notes.glsl`.
pub type ViewBlock = [[f32; 4]; 2];

/// Facts about the drawing mode for legends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Drawn {
    /// True if the interpreter draws the scene.
    pub interpreted: bool,
    /// True if space is divided into cells.
    pub cells: bool,
    /// Clauses of the scene's distance.
    pub clauses: usize,
}

/// A view of a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct ViewSetup {
    /// Numbers for the shaders.
    pub block: ViewBlock,
    /// The legend.
    pub legend: Legend,
    /// The view's number, chosen or default; `None` if the view takes no number.
    pub number: Option<f32>,
}

/// Number of steps that is shown in red: the limit of steps in the thesis (Abt 2022, figure 4).
const STEPS_RED: f32 = 100.0;
/// Number of distance evaluations of a pixel that is shown in red.
const RUNS_RED: f32 = 100.0;
/// Approximate number of the slice's lines across the image's height.
const SLICE_LINES: f32 = 40.0;
/// Distance that is shown in black, as a multiple of the distance to the camera's target.
const DEPTH_BLACK: f32 = 1.6;
const OBJECTS_NAMED: usize = 11;

impl ViewSetup {
    /// Sets up a view of a frame of a world.
    pub fn of(choice: ViewChoice, frame: &Frame, world: &World, drawn: Drawn) -> Self {
        let reach = (frame.camera.position - frame.target()).length() as f32;
        let clauses = drawn.clauses.max(1) as f32;
        let own = match choice.view {
            View::Steps => Some(STEPS_RED),
            View::Slice => Some(nice(2.0 * reach * frame.camera.tan_half.1 as f32 / SLICE_LINES)),
            View::Clauses if drawn.interpreted => Some(nice(RUNS_RED * clauses)),
            View::Clauses => Some(RUNS_RED),
            View::Cells => Some(nice(clauses)),
            View::Depth => Some(nice(DEPTH_BLACK * reach)),
            View::Normals | View::Shadow | View::Occlusion | View::Materials => None,
        };
        let number = choice.number.or(own);
        let shown = number.unwrap_or(0.0);
        let counted = || Some(marks(Ramp::Heat, shown, "+"));
        let fraction = || Some(marks(Ramp::Light, 1.0, ""));
        let (text, scale, colors) = match choice.view {
            View::Steps => (STEPS.to_owned(), counted(), vec![]),
            View::Slice => (slice(shown, world), None, named(&SLICE_COLORS)),
            View::Normals => (normals(number), None, named(&NORMAL_COLORS)),
            View::Shadow => {
                let colors = named(&[(scale::FACES_AWAY, "faces away from lights"), NOTHING]);
                ("The fraction of direct light that arrives.".to_owned(), fraction(), colors)
            }
            View::Occlusion => {
                ("The fraction of the ambient light\nthat arrives.".to_owned(), fraction(), named(&[NOTHING]))
            }
            View::Clauses => {
                let text = if drawn.interpreted { INTERPRETED } else { COMPILED };
                (text.to_owned(), counted(), vec![])
            }
            View::Cells if drawn.cells => (CELLS.to_owned(), counted(), named(&CELL_COLORS)),
            View::Cells => (NO_CELLS.to_owned(), None, vec![]),
            View::Materials => ("Objects and their materials.".to_owned(), None, materials(world)),
            View::Depth => {
                let text = "Distance from the eye to the surface,\nin the scene's units.".to_owned();
                (text, Some(marks(Ramp::Dark, shown, "+")), named(&[NOTHING]))
            }
        };
        let row = choice.view.row();
        // The plane of the slice contains the camera's target and faces the camera.
        let normal: DVec3 = frame.camera.forward;
        let offset = -normal.dot(frame.target());
        let [x, y, z] = normal.as_vec3().to_array();
        Self {
            block: [[choice.view as usize as f32, shown, 0.0, 0.0], [x, y, z, offset as f32]],
            legend: Legend { title: row.name, text, scale, colors },
            number: number.filter(|_| row.number.is_some()),
        }
    }
}

const STEPS: &str =
    "Steps of the ray from the eye: evaluations\nof the distance. Skipped cells take no steps.";
const INTERPRETED: &str =
    "Clauses that the interpreter runs for a pixel:\nrays, normals, shadows, occlusion, materials.";
const COMPILED: &str =
    "Compiled: no clauses are interpreted. Colours\ncount the pixel's distance evaluations.";
const CELLS: &str = "Cells at the surfaces. Colours count the\nclauses of a cell's tape. Lines are faces of\n\
                     cells, bold lines faces of the root's cells.";
const NO_CELLS: &str =
    "Regions are off: one tape applies everywhere.\nKey R, or --regions on, divides space.";

const NOTHING: (Color, &str) = (scale::NOTHING, "no surface");
const SLICE_COLORS: [(Color, &str); 3] =
    [(scale::OUTSIDE, "outside"), (scale::INSIDE, "inside"), (scale::ZERO, "the surface: 0")];
const CELL_COLORS: [(Color, &str); 3] =
    [(scale::EMPTY_CELL, "a cell without a traced surface"), (scale::NO_CELL, "outside the tree"), NOTHING];
const NORMAL_COLORS: [(Color, &str); 7] = [
    ([1.0, 0.5, 0.5], "+x right"),
    ([0.0, 0.5, 0.5], "-x left"),
    ([0.5, 1.0, 0.5], "+y up"),
    ([0.5, 0.0, 0.5], "-y down"),
    ([0.5, 0.5, 1.0], "+z away"),
    ([0.5, 0.5, 0.0], "-z near"),
    NOTHING,
];

fn named(colors: &[(Color, &str)]) -> Vec<(Color, String)> {
    colors.iter().map(|(color, meaning)| (*color, (*meaning).to_owned())).collect()
}

fn marks(ramp: Ramp, full: f32, unit: &str) -> Scale {
    let quarters = (0..=4_u8).map(|quarter| {
        let fraction = f32::from(quarter) / 4.0;
        let number = written(fraction * full);
        (fraction, if quarter == 4 { format!("{number}{unit}") } else { number })
    });
    Scale { ramp, ticks: quarters.collect() }
}

fn slice(spacing: f32, world: &World) -> String {
    let what = if world.non_lipschitz { "Values of the formula" } else { "Distances to the nearest surface" };
    let (line, bold) = (written(spacing), written(5.0 * spacing));
    format!(
        "{what} on a plane through the\ncamera's target. Surfaces in front are faint.\nA line every {line}, a bold \
         one every {bold}."
    )
}

fn normals(step: Option<f32>) -> String {
    let step = step.map_or("0.6 pixel radii".to_owned(), written);
    format!("Normals of the surfaces,\nby finite differences over {step}")
}

fn materials(world: &World) -> Vec<(Color, String)> {
    let objects = &world.scene.objects;
    let names = objects.iter().take(OBJECTS_NAMED).map(|object| {
        let material = world.scene.materials.get(object.material).map(|material| material.name.as_str());
        match material {
            Some(material) if material != object.name && !material.is_empty() => {
                format!("{}: {material}", object.name)
            }
            _ => object.name.clone(),
        }
    });
    let more = objects.len().checked_sub(OBJECTS_NAMED + 1).map(|more| format!("and {} more", more + 1));
    let colored = names.chain(more).enumerate().map(|(index, name)| (scale::of_object(index), name));
    colored.chain(named(&[NOTHING])).collect()
}
