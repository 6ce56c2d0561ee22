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
        let number = |own: f32| choice.number.unwrap_or(own);
        let legend = Legend { title: choice.view.row().name.to_owned(), ..Legend::default() };
        let (number, legend) = match choice.view {
            View::Steps => with(number(STEPS_RED), |red| steps(legend, red)),
            View::Slice => {
                let height = 2.0 * reach * frame.camera.tan_half.1 as f32;
                with(number(nice(height / SLICE_LINES)), |spacing| slice(legend, spacing, world))
            }
            View::Normals => (choice.number, normals(legend, choice.number)),
            View::Shadow => (None, shadow(legend)),
            View::Occlusion => (None, occlusion(legend)),
            View::Clauses => {
                let each =
                    if drawn.interpreted { nice(RUNS_RED * drawn.clauses.max(1) as f32) } else { RUNS_RED };
                with(number(each), |red| clauses(legend, red, drawn))
            }
            View::Cells => with(nice(drawn.clauses.max(1) as f32), |red| cells(legend, red, drawn)),
            View::Materials => (None, materials(legend, world)),
            View::Depth => with(number(nice(DEPTH_BLACK * reach)), |black| depth(legend, black)),
        };
        // The plane of the slice contains the camera's target and faces the camera.
        let normal: DVec3 = frame.camera.forward;
        let offset = -normal.dot(frame.target());
        let [x, y, z] = normal.as_vec3().to_array();
        let view = choice.view as usize as f32;
        Self {
            block: [[view, number.unwrap_or(0.0), 0.0, 0.0], [x, y, z, offset as f32]],
            legend,
            number: number.filter(|_| choice.view.row().number.is_some()),
        }
    }
}

fn with(number: f32, legend: impl FnOnce(f32) -> Legend) -> (Option<f32>, Legend) {
    (Some(number), legend(number))
}

fn nothing() -> (Color, String) {
    (scale::NOTHING, "no surface".to_owned())
}

fn marks(ramp: Ramp, full: f32, unit: &str) -> Scale {
    let quarters = (0..=4_u8).map(|quarter| {
        let fraction = f32::from(quarter) / 4.0;
        let number = written(fraction * full);
        (fraction, if quarter == 4 { format!("{number}{unit}") } else { number })
    });
    Scale { ramp, ticks: quarters.collect() }
}

fn steps(legend: Legend, number: f32) -> Legend {
    let lines =
        ["Steps of the ray from the eye: evaluations", "of the distance. Skipped cells take no steps."];
    Legend { lines: lines.map(str::to_owned).to_vec(), scale: Some(marks(Ramp::Heat, number, "+")), ..legend }
}

fn slice(legend: Legend, spacing: f32, world: &World) -> Legend {
    let what = if world.non_lipschitz { "Values of the formula" } else { "Distances to the nearest surface" };
    Legend {
        lines: vec![
            format!("{what} on a plane through the"),
            "camera's target. Surfaces in front are faint.".to_owned(),
            format!("A line every {}, a bold one every {}.", written(spacing), written(5.0 * spacing)),
        ],
        colors: vec![
            (scale::OUTSIDE, "outside".to_owned()),
            (scale::INSIDE, "inside".to_owned()),
            (scale::ZERO, "the surface: 0".to_owned()),
        ],
        ..legend
    }
}

fn normals(legend: Legend, number: Option<f32>) -> Legend {
    let length = match number {
        Some(number) => format!("by finite differences over {}", written(number)),
        None => "by finite differences over 0.6 pixel radii".to_owned(),
    };
    let axis = |place: usize, sign: f32| -> Color {
        std::array::from_fn(|axis| if axis == place { 0.5 + 0.5 * sign } else { 0.5 })
    };
    let names = [("right", "left"), ("up", "down"), ("away", "near")];
    let colors = names.iter().enumerate().flat_map(|(place, (plus, minus))| {
        let letter = ["x", "y", "z"][place];
        [(axis(place, 1.0), format!("+{letter} {plus}")), (axis(place, -1.0), format!("-{letter} {minus}"))]
    });
    let colors = colors.chain([nothing()]).collect();
    let lines = vec!["Normals of the surfaces,".to_owned(), length];
    Legend { lines, colors, ..legend }
}

fn shadow(legend: Legend) -> Legend {
    Legend {
        lines: vec!["The fraction of direct light that arrives.".to_owned()],
        scale: Some(marks(Ramp::Light, 1.0, "")),
        colors: vec![(scale::FACES_AWAY, "faces away from lights".to_owned()), nothing()],
        ..legend
    }
}

fn occlusion(legend: Legend) -> Legend {
    Legend {
        lines: vec!["The fraction of the ambient light".to_owned(), "that arrives.".to_owned()],
        scale: Some(marks(Ramp::Light, 1.0, "")),
        colors: vec![nothing()],
        ..legend
    }
}

fn clauses(legend: Legend, number: f32, drawn: Drawn) -> Legend {
    let lines = if drawn.interpreted {
        ["Clauses that the interpreter runs for a pixel:", "rays, normals, shadows, occlusion, materials."]
    } else {
        ["Compiled: no clauses are interpreted. Colours", "count the pixel's distance evaluations."]
    };
    Legend { lines: lines.map(str::to_owned).to_vec(), scale: Some(marks(Ramp::Heat, number, "+")), ..legend }
}

fn cells(legend: Legend, number: f32, drawn: Drawn) -> Legend {
    if !drawn.cells {
        let lines =
            ["Regions are off: one tape applies everywhere.", "Key R, or --regions on, divides space."];
        return Legend { lines: lines.map(str::to_owned).to_vec(), ..legend };
    }
    let lines = [
        "Cells at the surfaces. Colours count the",
        "clauses of a cell's tape. Lines are faces of",
        "cells, bold lines faces of the root's cells.",
    ];
    Legend {
        lines: lines.map(str::to_owned).to_vec(),
        scale: Some(marks(Ramp::Heat, number, "+")),
        colors: vec![
            (scale::EMPTY_CELL, "a cell without a traced surface".to_owned()),
            (scale::NO_CELL, "outside the tree".to_owned()),
            nothing(),
        ],
        ..legend
    }
}

fn materials(legend: Legend, world: &World) -> Legend {
    let objects = &world.scene.objects;
    let name = |index: usize| {
        let object = objects.get(index)?;
        let material = world.scene.materials.get(object.material).map(|material| material.name.as_str());
        Some(match material {
            Some(material) if material != object.name && !material.is_empty() => {
                format!("{}: {material}", object.name)
            }
            _ => object.name.clone(),
        })
    };
    let named = objects.len().min(OBJECTS_NAMED);
    let mut colors: Vec<(Color, String)> =
        (0..named).filter_map(|index| Some((scale::of_object(index), name(index)?))).collect();
    if objects.len() > named {
        colors.push((scale::of_object(named), format!("and {} more", objects.len() - named)));
    }
    colors.push(nothing());
    Legend { lines: vec!["Objects and their materials.".to_owned()], colors, ..legend }
}

fn depth(legend: Legend, number: f32) -> Legend {
    Legend {
        lines: vec!["Distance from the eye to the surface,".to_owned(), "in the scene's units.".to_owned()],
        scale: Some(marks(Ramp::Dark, number, "+")),
        colors: vec![nothing()],
        ..legend
    }
}
