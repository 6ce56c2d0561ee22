//! The subcommand `check`: prints the mistakes of scenes, or their cost and warnings.

use std::path::Path;

use anyhow::{Context, bail};
use clap::Args;
use serde::Serialize;

use super::common::colors;
use super::files::scene_of;
use crate::export::print::{counted, print_line, print_message};
use crate::gpu::scene_program::{SCENE_SHADER, compiled_variant_of};
use crate::gpu::{Counting, ShaderLibrary};
use crate::moving_textures::description;
use crate::scenes::{FoundMistakes, SceneError, SceneSource, TextureCache, TextureSource};
use mariana_field::graph::{Graph, Input, Node, NodeId, Op, PartInput};
use mariana_field::lang::{
    Diagnostic, Light, Material, Medium, Scene, Sources, Span, Swarm, TextureRef, render_all,
};
use mariana_field::ray_probe::ray_faults;
use mariana_field::region::RegionPlan;
use mariana_field::tape::Tape;
use mariana_field::world::World;

#[derive(Args)]
pub(super) struct CheckArguments {
    /// Scenes: files, names of shipped scenes, formulas, or '-' for standard input
    #[arg(required = true, value_name = "SCENE")]
    scenes: Vec<String>,
    /// Print one JSON object per line and mistake: file, line, column, end, severity, message, hint
    #[arg(long)]
    json: bool,
}

pub(super) fn run(arguments: &CheckArguments) -> anyhow::Result<()> {
    if arguments.json {
        return run_json(&arguments.scenes);
    }
    let (mut wrong, mut unreadable) = (0, 0);
    for argument in &arguments.scenes {
        let checked = scene_of(argument).and_then(|source| {
            let (scene, FoundMistakes { diagnostics, sources }) = compile(&source)?;
            let (name, cost) = (source.name(), cost(&scene));
            let words = moving(&scene).map(|(_, found)| found.unwrap_or_else(|grey| grey));
            let moving: String = words.map(|words| format!("\n  {words}")).collect();
            let world = drawable(&source, scene)?;
            let warnings = render_all(&warnings(diagnostics, &world), &sources, colors(&std::io::stdout()));
            let warnings = warnings.trim_end();
            let line = if warnings.is_empty() { "" } else { "\n" };
            let remembers = remembers(&world);
            Ok(format!("{name}: {cost}{}{remembers}{moving}{line}{warnings}", advice(&world)))
        });
        match checked {
            Ok(line) => print_line(&line)?,
            Err(error) => match error.downcast_ref() {
                Some(SceneError::Mistakes { found, .. }) => {
                    print_line(found.render(colors(&std::io::stdout())).trim_end())?;
                    wrong += 1;
                }
                _ if arguments.scenes.len() == 1 => return Err(error),
                _ => {
                    print_message(&format!("{error:#}"));
                    unreadable += 1;
                }
            },
        }
    }
    match (wrong, unreadable) {
        (0, 0) => Ok(()),
        (0, _) => bail!("{unreadable} of {} scenes cannot be checked: see above", arguments.scenes.len()),
        (_, _) => refused(wrong, "underlined above"),
    }
}

fn refused(scenes: usize, shown: &str) -> anyhow::Result<()> {
    match scenes {
        1 => bail!("a scene has mistakes: correct what is {shown}"),
        _ => bail!("{scenes} scenes have mistakes: correct what is {shown}"),
    }
}

/// Prints each mistake as a JSON object. For a scene that cannot be read, prints one mistake at the first character.
fn run_json(scenes: &[String]) -> anyhow::Result<()> {
    let mut wrong = 0;
    for argument in scenes {
        let mistakes = scene_of(argument).and_then(|source| {
            let Err(error) = print_warnings(&source) else { return Ok(Vec::new()) };
            let Some(SceneError::Mistakes { name, found }) = error.downcast_ref() else { return Err(error) };
            let named = |one| {
                let mistake = mistake(one, &found.sources, &source);
                if mistake.file == *name { Mistake { file: argument.clone(), ..mistake } } else { mistake }
            };
            Ok(found.diagnostics.iter().map(named).collect())
        });
        let mistakes = mistakes.unwrap_or_else(|error| {
            let (start, message) = (Position { line: 1, column: 1 }, format!("{error:#}"));
            let file = argument.clone();
            vec![Mistake { file, start, end: start, severity: "error", message, hint: None }]
        });
        for mistake in &mistakes {
            print_line(&serde_json::to_string(mistake)?)?;
        }
        wrong += usize::from(!mistakes.is_empty());
    }
    if wrong == 0 { Ok(()) } else { refused(wrong, "listed") }
}

/// Prints each warning about a scene as a JSON object.
fn print_warnings(source: &SceneSource) -> anyhow::Result<()> {
    let (scene, FoundMistakes { diagnostics, sources }) = compile(source)?;
    let grey: Vec<Diagnostic> = grey(&scene).collect();
    let world = drawable(source, scene)?;
    for one in grey.iter().chain(&warnings(diagnostics, &world)).chain(&world.warning()) {
        let warning = Mistake { severity: "warning", ..mistake(one, &sources, source) };
        print_line(&serde_json::to_string(&warning)?)?;
    }
    Ok(())
}

/// Returns a warning for each texture that will be grey.
fn grey(scene: &Scene) -> impl Iterator<Item = Diagnostic> {
    moving(scene).filter_map(|(texture, found)| Some(Diagnostic::warning(texture.span, found.err()?)))
}

/// Columns and rows of the rays that look for faults: about half a second on a slow computer.
const RAYS: (usize, usize) = (48, 27);

/// Rays are followed only if the distance has at most this many texels, of two clauses each. Shipped scenes have fewer
/// than 1,000; the tree of 100,000 takes minutes.
const RAYS_TEXELS_MAX: usize = 8192;

/// Returns the warnings about a text, and about the rays of the scene's camera at its first frame.
fn warnings(mut texts: Vec<Diagnostic>, world: &World) -> Vec<Diagnostic> {
    texts.extend(world.feedback_warning());
    let plan = RegionPlan::new(world);
    if plan.whole_texels > RAYS_TEXELS_MAX {
        let message = "the distance is too long: no rays are followed, and the first frame may take minutes";
        let place = world.scene.objects.first().map_or(Span::default(), |object| object.span);
        let long = Diagnostic::warning(place, message);
        texts.push(long.hint("use fewer parts, or loops with fewer rounds"));
    } else if plan.runs {
        texts.extend(ray_faults(world, 0.0, RAYS.0, RAYS.1).warnings(world));
    }
    texts
}

#[derive(Serialize)]
struct Mistake {
    /// Path relative to the current folder.
    file: String,
    #[serde(flatten)]
    start: Position,
    /// The position after the mistake's last character.
    end: Position,
    severity: &'static str,
    message: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    hint: Option<String>,
}

/// A position in a text: line and column in characters, both from 1.
#[derive(Clone, Copy, Serialize)]
struct Position {
    line: usize,
    column: usize,
}

fn mistake(one: &Diagnostic, sources: &Sources, scene: &SceneSource) -> Mistake {
    let place = sources.place(one.span.start);
    let position = |offset: u32| {
        let place = sources.place(offset);
        place.map_or(Position { line: 1, column: 1 }, |place| Position {
            line: place.line,
            column: place.column,
        })
    };
    let name = place.map_or_else(|| scene.name(), |place| place.file.name.clone());
    // Names of included files are relative to the scene's folder.
    let included = scene.file().filter(|file| name != file.display().to_string()).and_then(Path::parent);
    Mistake {
        file: included.map_or(name.clone(), |folder| folder.join(&name).display().to_string()),
        start: position(one.span.start),
        end: position(one.span.end),
        severity: "error",
        message: one.message.clone(),
        hint: one.hint.clone(),
    }
}

/// Compiles a scene. Returns its warnings too. Missing texture files are mistakes.
fn compile(source: &SceneSource) -> Result<(Scene, FoundMistakes), SceneError> {
    let (scene, _, warnings) = source.with_pictures(source.compile()?, &mut TextureCache::default())?;
    Ok((scene, warnings))
}

/// Returns the scene's world. Fails if no window can draw the world, because the tape does not fit the interpreter
/// and the compiled program is too long.
fn drawable(source: &SceneSource, scene: Scene) -> anyhow::Result<World> {
    let world = World::new(&source.name(), scene, Vec::new())?;
    if !RegionPlan::new(&world).runs || !world.tape_buffers().runs {
        let variant = compiled_variant_of(&world, Counting::Off)?;
        ShaderLibrary::embedded().assemble(SCENE_SHADER, "", &variant).with_context(|| {
            format!(
                "{} cannot be drawn: it needs more than 256 registers, so it must be compiled, and the compiled \
                 program is too long: use fewer parts",
                source.name()
            )
        })?;
    }
    Ok(world)
}

/// The videos, cameras and covers of a scene: what was found, or the reason why the texture will be grey.
fn moving(scene: &Scene) -> impl Iterator<Item = (&TextureRef, Result<String, String>)> {
    scene.textures.iter().filter_map(|texture| {
        let source = TextureSource::of(texture)?;
        Some((texture, description(&source).map_err(|error| error.to_string())))
    })
}

fn cost(scene: &Scene) -> String {
    let tape = Tape::new(&scene.graph, &[scene.distance]);
    let constants = tape
        .table
        .iter()
        .filter(|entry| matches!(entry, mariana_field::tape::TableEntry::Constant(_)))
        .count();
    format!(
        "{}, {}, {} for the distance; {}; listens to {}",
        counted(tape.clauses.len(), "clause"),
        counted(constants, "constant"),
        counted(tape.registers, "register"),
        parts(scene),
        inputs(scene, &scene.graph, &expressions(scene))
    )
}

/// All expressions of a scene.
fn expressions(scene: &Scene) -> Vec<NodeId> {
    let mut all = vec![scene.distance];
    all.extend(scene.objects.iter().filter_map(|object| object.bound));
    all.extend(scene.materials.iter().flat_map(Material::numbers));
    all.extend(scene.lights.iter().flat_map(Light::numbers));
    all.extend(scene.media.iter().flat_map(Medium::numbers));
    all.extend(scene.swarms.iter().flat_map(Swarm::numbers));
    all.extend(scene.cameras.iter().flat_map(|(_, camera)| camera.numbers()));
    all.extend([scene.camera.numbers(), scene.sky.numbers(), scene.picture.numbers()].concat());
    all
}

fn advice(world: &World) -> String {
    match (world.non_lipschitz, world.slopes.distance_factor) {
        (false, _) => String::new(),
        (true, Some(factor)) => {
            format!("\n  {NO_DISTANCE}: multiply the value by {factor:.2} to make it a distance")
        }
        (true, None) => format!("\n  {NO_DISTANCE}, and no single factor makes it a distance"),
    }
}

/// The cost of feedback.
fn remembers(world: &World) -> String {
    let Some(feedback) = &world.frame_tape.feedback else { return String::new() };
    format!(
        "\n  each frame depends on the last {:.1} s or more, so a still, a jump and the start of a video first draw \
         {} to {} small frames",
        feedback.seconds(),
        feedback.frames,
        2 * feedback.frames
    )
}

const NO_DISTANCE: &str =
    "the shape's value is not a distance, so rays take short steps and the shape's shadows are sharp";

/// Counts the parts of a scene: those that every scene has, and others if there are some.
fn parts(scene: &Scene) -> String {
    let points = scene.swarms.iter().map(|swarm| swarm.points).sum();
    let usual =
        [(scene.objects.len(), "object"), (scene.materials.len(), "material"), (scene.lights.len(), "light")];
    let others = [(scene.media.len(), "medium"), (scene.swarms.len(), "swarm"), (points, "point")];
    let others = others.into_iter().filter(|(number, _)| *number > 0);
    let all = usual.into_iter().chain(others).map(|(number, what)| counted(number, what));
    all.collect::<Vec<_>>().join(", ")
}

/// Returns the names, in the scene language, of the time, the sounds and the parameters that `roots` read.
fn inputs(scene: &Scene, graph: &Graph, roots: &[NodeId]) -> String {
    let used = graph.inputs_used(roots);
    let mut names: Vec<String> = used
        .inputs
        .iter()
        .filter(|input| matches!(input, Input::T | Input::Sound(_) | Input::Level(_) | Input::Param(_)))
        .map(|input| name_of(scene, *input))
        .collect();
    let mut by_index = false;
    for node in graph.order(roots) {
        let Node::Unary(Op::Part, index) = graph.node(node) else { continue };
        let known = graph.as_constant(index).and_then(|index| PartInput::at(PartInput::clamped(index)));
        by_index |= known.is_none();
        names.extend(known.map(|input| input.to_string()));
    }
    // Tables that are read at a computed index are not in the list of inputs.
    let tables = used.tables.iter().filter(|table| match table {
        Op::Part => by_index,
        Op::Shape | Op::ShapeNumber => false,
        _ => true,
    });
    names.extend(tables.map(|table| match table {
        Op::Part => "bands of parts".to_owned(),
        other => other.name().to_lowercase(),
    }));
    names.dedup();
    if names.is_empty() { "nothing".into() } else { names.join(", ") }
}

fn name_of(scene: &Scene, input: Input) -> String {
    let param = match input {
        Input::Param(number) => scene.params.get(usize::from(number)),
        _ => None,
    };
    param.map_or_else(|| input.to_string().to_lowercase(), |param| param.name.clone())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn heard(source: &SceneSource) -> String {
        let Ok((scene, _)) = compile(source) else { panic!("{source:?} has mistakes") };
        cost(&scene).split("listens to ").nth(1).unwrap().to_owned()
    }

    #[test]
    fn a_scene_whose_sky_or_picture_moves_listened_to_nothing() {
        let ink = heard(&SceneSource::Shipped("ink".to_owned()));
        for input in ["t", "bass", "treble", "beat", "waveform", "flow", "whorl"] {
            assert!(ink.split(", ").any(|name| name == input), "{input} in {ink}");
        }
        let ball = "object ball { shape = length(p) - 1 }\n";
        for part in [
            "light lamp { position = vec3(0, 3, 0)  color = vec3(bass) }",
            "medium fog { density = 0.1 * bass }",
            "swarm dust { count = 9  position = vec3(bass, index, 0) }",
            "camera { fov = 40 + bass }",
            "camera far { position = vec3(0, 0, -9 - bass) }",
            "sky { ambient = vec3(bass) }",
            "picture { bloom = 0.1 * bass }",
        ] {
            assert_eq!(heard(&SceneSource::Formula(format!("{ball}{part}"))), "bass", "{part}");
        }
        assert_eq!(heard(&SceneSource::Formula(ball.to_owned())), "nothing");
    }

    #[test]
    fn every_shipped_scene_listens() {
        for name in crate::scenes::shipped_names() {
            let heard = heard(&SceneSource::Shipped(name.clone()));
            assert_ne!(heard, "nothing", "{name}");
        }
    }
}
