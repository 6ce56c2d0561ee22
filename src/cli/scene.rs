//! The subcommands that work on the text of scenes: `check`, `tape` and `eval`.

use mariana_field::graph::{BAND_COUNT, SoundInput};
use std::io::{BufRead, BufReader, IsTerminal};
use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use clap::Args;

use crate::export::print::print_line;
use crate::scenes::SceneSource;
use mariana_field::graph::{FrameInputs, Graph, Input, NodeId, Op, Point};
use mariana_field::lang::{Scene, render_all};
use mariana_field::tape::{PointEvaluator, Tape, TapeOptions};

#[derive(Args)]
pub(super) struct CheckArguments {
    /// Scenes: files, names of shipped ones, or formulas
    #[arg(required = true, value_name = "SCENE")]
    scenes: Vec<String>,
}

#[derive(Args)]
pub(super) struct TapeArguments {
    /// A file, the name of a shipped scene, or a formula
    #[arg(value_name = "SCENE-OR-FORMULA", allow_hyphen_values = true)]
    scene: String,
    /// Print the distance as GLSL instead
    #[arg(long, conflicts_with = "dot")]
    glsl: bool,
    /// Print the expression graph in Graphviz's language instead
    #[arg(long)]
    dot: bool,
}

#[derive(Args)]
pub(super) struct EvalArguments {
    /// A file, the name of a shipped scene, or a formula
    #[arg(value_name = "SCENE-OR-FORMULA", allow_hyphen_values = true)]
    scene: String,
    /// A point at which to evaluate; can be given more than once
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_point, allow_hyphen_values = true, required_unless_present = "points")]
    at: Vec<[f32; 3]>,
    /// A file with one point per line: x,y,z
    #[arg(long, value_name = "FILE", conflicts_with = "at")]
    points: Option<PathBuf>,
    /// An input, such as "t=2", "volume.x=0.3", "band(3)=0.5" or a param of the scene; can be given more than once
    #[arg(long, value_name = "NAME=VALUE")]
    set: Vec<String>,
}

pub(super) fn run_check(arguments: &CheckArguments) -> anyhow::Result<()> {
    let mut wrong = 0;
    for argument in &arguments.scenes {
        let source = SceneSource::find(argument)?;
        match compile(&source)? {
            Ok(scene) => print_line(&format!("{}: {}", source.name(), cost(&scene)?))?,
            Err(diagnostics) => {
                print_line(diagnostics.trim_end())?;
                wrong += 1;
            }
        }
    }
    match wrong {
        0 => Ok(()),
        1 => bail!("a scene has mistakes: correct what is underlined above"),
        _ => bail!("{wrong} scenes have mistakes: correct what is underlined above"),
    }
}

pub(super) fn run_tape(arguments: &TapeArguments) -> anyhow::Result<()> {
    let scene = require(&SceneSource::find(&arguments.scene)?)?;
    let root = scene.distance;
    let text = if arguments.glsl {
        mariana_field::tape::glsl::function(
            &scene.graph,
            &[root],
            "scene_distance",
            mariana_field::tape::glsl::Sampling::None,
        )?
    } else if arguments.dot {
        scene.graph.to_dot(root)?
    } else {
        Tape::build(&scene.graph, &[root], &TapeOptions::default())?.to_string()
    };
    Ok(print_line(text.trim_end())?)
}

pub(super) fn run_eval(arguments: &EvalArguments) -> anyhow::Result<()> {
    let scene = require(&SceneSource::find(&arguments.scene)?)?;
    let mut frame = FrameInputs {
        params: scene.params.iter().map(|param| param.default).collect(),
        ..Default::default()
    };
    for setting in &arguments.set {
        set_input(&scene, &mut frame, setting)?;
    }
    let tape = Tape::build(&scene.graph, &[scene.distance], &TapeOptions::default())?;
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

/// The scene, or its diagnostics as text.
fn compile(source: &SceneSource) -> anyhow::Result<Result<Scene, String>> {
    let compiled = source.compile()?;
    let colored = std::io::stdout().is_terminal();
    let diagnostics = compiled.render(colored);
    let Some(scene) = compiled.scene else { return Ok(Err(diagnostics)) };
    // Missing pictures are mistakes too.
    match source.textures(&scene) {
        Ok(_) => Ok(Ok(scene)),
        Err(wrong) => Ok(Err(render_all(&wrong, &compiled.sources, colored))),
    }
}

/// The scene; its diagnostics are an error.
fn require(source: &SceneSource) -> anyhow::Result<Scene> {
    let compiled = source.compile()?;
    let diagnostics = compiled.render(std::io::stderr().is_terminal());
    compiled.scene.ok_or_else(|| {
        anyhow::anyhow!(
            "{} has mistakes: correct what is underlined\n{}",
            source.name(),
            diagnostics.trim_end()
        )
    })
}

/// What a scene costs, and what it listens to.
fn cost(scene: &Scene) -> anyhow::Result<String> {
    let tape = Tape::build(&scene.graph, &[scene.distance], &TapeOptions::default())?;
    let mut roots = vec![scene.distance];
    roots.extend(scene.objects.iter().filter_map(|object| object.bound));
    for material in &scene.materials {
        roots.extend(material.numbers());
    }
    let constants = tape
        .table()
        .iter()
        .filter(|entry| matches!(entry, mariana_field::tape::TableEntry::Constant(_)))
        .count();
    Ok(format!(
        "{} clauses, {constants} constants, {} registers for the distance; {}, {}, {}; listens to {}",
        tape.clauses().len(),
        tape.registers(),
        count(scene.objects.len(), "object"),
        count(scene.materials.len(), "material"),
        count(scene.lights.len(), "light"),
        inputs(scene, &scene.graph, &roots)?
    ))
}

fn count(number: usize, what: &str) -> String {
    if number == 1 { format!("1 {what}") } else { format!("{number} {what}s") }
}

/// The inputs that the roots read, other than the point, as the language writes them.
fn inputs(scene: &Scene, graph: &Graph, roots: &[NodeId]) -> anyhow::Result<String> {
    let used = graph.inputs_used(roots)?;
    let mut names: Vec<String> = used
        .inputs
        .iter()
        .filter(|input| input.of_point().is_none())
        .map(|input| name_of(scene, *input))
        .collect();
    // Tables that are read at a computed index.
    names.extend(used.tables.iter().map(|table| match table {
        Op::Band => "bands".to_owned(),
        other => other.name().to_lowercase(),
    }));
    names.dedup();
    Ok(if names.is_empty() { "nothing".into() } else { names.join(", ") })
}

/// An input as the language writes it.
fn name_of(scene: &Scene, input: Input) -> String {
    match input {
        Input::Param(number) => scene
            .params
            .get(usize::from(number))
            .map_or_else(|| input.to_string().to_lowercase(), |param| param.name.clone()),
        _ => input.to_string().to_lowercase(),
    }
}

/// Sets one input by `name=value`.
fn set_input(scene: &Scene, frame: &mut FrameInputs, setting: &str) -> anyhow::Result<()> {
    let (name, value) =
        setting.split_once('=').with_context(|| format!("--set '{setting}': write it as NAME=VALUE"))?;
    let name = name.trim();
    let value: f32 =
        value.trim().parse().with_context(|| format!("--set '{setting}': '{value}' is not a number"))?;
    let band = name.strip_prefix("band(").and_then(|rest| rest.strip_suffix(')'));
    let place = match (name, SoundInput::named(name)) {
        ("t", _) => Some(&mut frame.time),
        (_, Some(input)) => Some(&mut frame.sound[input]),
        _ => match band {
            Some(number) => number.parse().ok().and_then(|number: usize| frame.bands.get_mut(number)),
            None => scene
                .params
                .iter()
                .position(|param| param.name == name)
                .and_then(|number| frame.params.get_mut(number)),
        },
    };
    let known = || {
        let sounds: Vec<&str> = SoundInput::ALL.into_iter().map(SoundInput::name).collect();
        format!("t, {}, band(0) to band({}), and the scene's params", sounds.join(", "), BAND_COUNT - 1)
    };
    *place.with_context(|| {
        format!("--set '{setting}': there is no input '{name}'; the inputs are {}", known())
    })? = value;
    Ok(())
}

/// Hands on each point of a file.
fn for_each_point(path: &Path, mut take: impl FnMut([f32; 3]) -> anyhow::Result<()>) -> anyhow::Result<()> {
    let file = std::fs::File::open(path)
        .with_context(|| format!("the points in {} cannot be read: check the path", path.display()))?;
    for (index, line) in BufReader::new(file).lines().enumerate() {
        let place = || format!("{}:{}", path.display(), index + 1);
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
