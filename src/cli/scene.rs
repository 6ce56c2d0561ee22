//! The subcommands `tape` and `eval`, which work on the distance of a scene.

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Args;

use super::common::SetArguments;
use super::files::{is_standard, scene_of};
use crate::export::painter::{held_of, require_inputs};
use crate::export::print::print_line;
use mariana_field::graph::{FrameInputs, Point};
use mariana_field::lang::Scene;
use mariana_field::region::{ListedClause, RegionOptions, RegionPlan};
use mariana_field::tape::{PointEvaluator, Tape};
use mariana_field::world::World;

#[derive(Args)]
pub(super) struct TapeArguments {
    /// A file, the name of a shipped scene, or a formula
    #[arg(value_name = "SCENE-OR-FORMULA", allow_hyphen_values = true)]
    scene: String,
    /// Print the distance as GLSL instead
    #[arg(long, conflicts_with = "dot")]
    glsl: bool,
    /// Print the expression graph in Graphviz's DOT language instead
    #[arg(long)]
    dot: bool,
    /// Print the short tape of the cell around this point, with the bounds of each clause
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_point, allow_hyphen_values = true, conflicts_with_all = ["glsl", "dot"])]
    at: Option<[f32; 3]>,
}

#[derive(Args)]
pub(super) struct EvalArguments {
    /// A file, the name of a shipped scene, or a formula
    #[arg(value_name = "SCENE-OR-FORMULA", allow_hyphen_values = true)]
    scene: String,
    /// A point at which to evaluate; can be given more than once
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_point, allow_hyphen_values = true, required_unless_present = "points")]
    at: Vec<[f32; 3]>,
    /// A file with one point per line: x,y,z; '-' is standard input
    #[arg(long, value_name = "FILE", conflicts_with = "at")]
    points: Option<PathBuf>,
    #[command(flatten)]
    set: SetArguments,
}

pub(super) fn run_tape(arguments: &TapeArguments) -> anyhow::Result<()> {
    let source = scene_of(&arguments.scene)?;
    let scene = source.baked()?;
    let root = scene.distance;
    let text = if let Some(point) = arguments.at {
        tape_of_cell(&source.name(), scene, point)?
    } else if arguments.glsl {
        mariana_field::tape::glsl::function(
            &scene.graph,
            &[root],
            "scene_distance",
            mariana_field::tape::glsl::Sampling::None,
        )
    } else if arguments.dot {
        scene.graph.to_dot(root)
    } else {
        Tape::new(&scene.graph, &[root]).to_string()
    };
    Ok(print_line(text.trim_end())?)
}

fn silent_frame(scene: &Scene) -> FrameInputs {
    let params = scene.params.iter().map(|param| param.default).collect();
    FrameInputs { params, shapes: scene.atlas.clone(), ..FrameInputs::default() }
}

/// Describes the cell of a point in the tree of a silent frame, and lists its tape.
fn tape_of_cell(name: &str, scene: Scene, point: [f32; 3]) -> anyhow::Result<String> {
    let mut frame = silent_frame(&scene);
    let world = World::new(name, scene, Vec::new())?;
    frame.hoisted = world.hoisted.values(&frame);
    let tree = RegionPlan::new(&world).build(&frame, &RegionOptions::default());
    let Some(cell) = tree.cell_at(point) else {
        anyhow::bail!("the point is outside of the tree: choose a point near the shape");
    };
    let clauses = tree.listing(&cell, &frame);
    let corner = |[x, y, z]: [f32; 3]| format!("({x}, {y}, {z})");
    let surface = match cell.bound > 0.0 {
        true => format!("no surface is nearer than {}", cell.bound),
        false => "a surface may be inside".to_owned(),
    };
    let mut text = format!(
        "cell {} to {}: {surface}\n{} of {} clauses; slots 0, 1 and 2 hold x, y and z\n",
        corner(cell.low),
        corner(cell.high),
        clauses.len(),
        tree.clauses_of(tree.whole_tape)
    );
    let row = |operator: &str, operands: &str, output: &str, bounds: &str| {
        format!("{operator:<14} {operands:<30} {output:<8} {bounds}\n")
    };
    text += &row("opcode", "inputs", "output", "bounds in the cell");
    for ListedClause { operator, operands, output, bounds } in clauses {
        let bounds = match bounds.is_any() {
            true => "any value".to_owned(),
            false => format!("{} .. {}", bounds.lo, bounds.hi),
        };
        text += &row(operator, &operands.join(", "), &format!("slot {output}"), &bounds);
    }
    Ok(text)
}

pub(super) fn run_eval(arguments: &EvalArguments) -> anyhow::Result<()> {
    let scene = scene_of(&arguments.scene)?.baked()?;
    let mut frame = silent_frame(&scene);
    let set = &arguments.set.set;
    require_inputs(&[&scene], set)?;
    held_of(&scene, set)?.apply(&mut frame);
    let tape = Tape::new(&scene.graph, &[scene.distance]);
    let mut evaluator = PointEvaluator::new(&tape, &frame);
    let mut print = |[x, y, z]: [f32; 3]| {
        let value = evaluator.at(&Point::at(x, y, z)).first().copied().unwrap_or(0.0);
        print_line(&value.to_string())
    };
    for point in &arguments.at {
        print(*point)?;
    }
    if let Some(path) = &arguments.points {
        for_each_point(path, |point| Ok(print(point)?))?;
    }
    Ok(())
}

fn for_each_point(path: &Path, mut take: impl FnMut([f32; 3]) -> anyhow::Result<()>) -> anyhow::Result<()> {
    let (name, file): (String, Box<dyn BufRead>) = if is_standard(path) {
        ("standard input".into(), Box::new(std::io::stdin().lock()))
    } else {
        let file = std::fs::File::open(path)
            .with_context(|| format!("the points in {} cannot be read: check the path", path.display()))?;
        (path.display().to_string(), Box::new(BufReader::new(file)))
    };
    for (index, line) in file.lines().enumerate() {
        let place = || format!("{name}:{}", index + 1);
        let line = line.with_context(|| format!("{}: the line cannot be read as text", place()))?;
        if !line.trim().is_empty() {
            take(parse_point(&line).map_err(|reason| anyhow::anyhow!("{}: {reason}", place()))?)?;
        }
    }
    Ok(())
}

fn parse_point(text: &str) -> Result<[f32; 3], String> {
    let numbers: Result<Vec<f32>, _> = text.split(',').map(|number| number.trim().parse()).collect();
    let point = numbers.ok().and_then(|numbers| <[f32; 3]>::try_from(numbers).ok());
    point.ok_or_else(|| format!("'{}' is not a point: write three numbers as x,y,z", text.trim()))
}
