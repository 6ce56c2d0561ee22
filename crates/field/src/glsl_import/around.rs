//! Writes a scene around the distance function of a GLSL file.

use std::fmt::Write as _;
use std::sync::Arc;

use super::Result;
use super::calls::{Budget, GlslSession, HOW_TO_READ_IMAGES};
use super::isf::Slider;
use super::outside::{candidate, is_distance_for_sure, is_taken};
use super::parse::{GlslFile, GlslFunction, GlslType};
use super::samplers::image_sampler;
use crate::graph::{FrameInputs, Graph, Input, NodeId, Point, Screen, SoundInputs, TableData, TextureReader};
use crate::lang::{Diagnostic, Span, formatted};
use crate::limits::LIMITS;

/// The part of a shader that a scene shows, if the shader draws a picture and has a distance function.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Shown {
    /// The picture that the shader draws.
    #[default]
    Picture,
    /// Its distance, as an object in the light of the scene.
    Shape,
}

/// A scene for a GLSL file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SceneAround {
    /// The text of the scene after the line that includes the file.
    pub(crate) body: String,
    /// For a file of which two scenes can be made: which one this is, and how to get the other one.
    pub choice: Option<String>,
    /// A sentence for each part of the file that the scene leaves out.
    pub left_out: Vec<String>,
}

impl SceneAround {
    /// Returns the formatted text of the scene, which includes the file by the path `include`.
    pub fn text(&self, include: &str) -> String {
        let choice = self.choice.as_ref().map_or(String::new(), |choice| format!("# It {choice}.\n"));
        let text = format!(
            "# Made by `mariana import` from {include}.\n{choice}\ninclude \"{include}\"\n\n{}",
            self.body
        );
        formatted(&text).unwrap_or(text)
    }

    /// Returns a sentence for the choice and for each part that the scene leaves out.
    pub fn notes(&self) -> Vec<String> {
        let choice = self.choice.iter().map(|choice| format!("the scene {choice}"));
        choice.chain(self.left_out.iter().map(|part| format!("left out: {part}"))).collect()
    }
}

/// Half the side of the cube in which the shape is looked for, and the number of samples along a side.
const REACH: f32 = 8.0;
const SAMPLES: usize = 24;
/// Maximum number of materials.
const MATERIALS_MAX: usize = 12;
/// Colours of the materials.
const COLORS: [&str; 6] = [
    "vec3(0.75, 0.72, 0.68)",
    "vec3(0.85, 0.35, 0.2)",
    "vec3(0.2, 0.45, 0.75)",
    "vec3(0.9, 0.7, 0.25)",
    "vec3(0.3, 0.6, 0.35)",
    "vec3(0.55, 0.35, 0.6)",
];

/// Writes a scene that includes a file. Without a picture that a scene can draw, it shows the distance.
///
/// # Errors
/// A file that neither has a function of a point that returns a distance nor draws a picture, or a mistake in that
/// function.
pub fn scene_around(text: &str, shown: Shown) -> Result<SceneAround> {
    scene_around_file(&GlslFile::parse(text, &LIMITS)?, shown)
}

/// Like [`scene_around`], for a file that is already read.
pub(crate) fn scene_around_file(file: &GlslFile, shown: Shown) -> Result<SceneAround> {
    let (shape, picture) = (candidate(file), file.picture());
    let of_shape = || match shape {
        Some(function) => scene_of_shape(file, function),
        None => Err(nothing_found(file)),
    };
    let of_picture =
        picture.filter(|_| shown == Shown::Picture).map(|picture| scene_of_picture(file, picture));
    let (body, is_picture, own) = match of_picture {
        None => (of_shape()?, false, Vec::new()),
        Some(Ok((body, own))) => (body, true, own),
        Some(Err(problem)) => {
            let refused = format!("the shader's own picture: {}", problem.message);
            (of_shape().map_err(|_| problem)?, false, vec![refused])
        }
    };
    let shape = shape.filter(|shape| picture.is_some() && is_distance_for_sure(shape));
    let choice = match (shape, is_picture) {
        (Some(shape), true) => Some(format!(
            "draws the shader's own picture; `mariana import --as shape` makes an object of its distance `{}`",
            shape.name
        )),
        (Some(shape), false) if own.is_empty() => Some(format!(
            "shows the distance `{}` as an object; `mariana import --as picture` draws the shader's own picture",
            shape.name
        )),
        _ => None,
    };
    let all = left_out(file, is_picture);
    let left_out = if is_picture { [all, own] } else { [own, all] }.concat();
    Ok(SceneAround { body, choice, left_out })
}

fn nothing_found(file: &GlslFile) -> Diagnostic {
    let names: Vec<&str> = file.functions().iter().map(|function| function.name.as_str()).take(8).collect();
    let found = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
    let draws = if file.picture().is_some() { "" } else { ", and none draws a picture" };
    Diagnostic::unsupported(
        Span::default(),
        format!("no function of this file looks like the distance of a scene{draws}"),
    )
    .hint(format!("call it `map`, take one vec3, and return a float or a vec2; functions found: {found}"))
}

/// Lines with values for inputs from outside.
fn uniforms(file: &GlslFile) -> String {
    let mut scene = String::new();
    let mut sliders = 0..LIMITS.scene_params_max;
    for slider in file.globals.sliders.iter().filter(|slider| !is_taken(&slider.name)) {
        let Slider { name, values, range: [least, most], is_smooth } = slider;
        let _ = match values.as_slice() {
            [value] if *is_smooth && sliders.next().is_some() => {
                writeln!(scene, "param {name} = {value} in {least} .. {most}")
            }
            [value] => writeln!(scene, "let {name} = {value}  # {least} .. {most}"),
            values => {
                let values: Vec<String> = values.iter().map(f64::to_string).collect();
                writeln!(scene, "let {name} = vec{}({})", values.len(), values.join(", "))
            }
        };
    }
    for picture in file.pictures() {
        let _ = writeln!(scene, "let {picture} = \"cover\"  # or the file of an image or a video");
    }
    for (uniform, len) in file.open_uniforms().into_iter().filter(|(name, _)| !is_taken(name)) {
        let _ = match len {
            1 if sliders.next().is_some() => writeln!(scene, "param {uniform} = 1 in 0 .. 2"),
            1 => writeln!(scene, "let {uniform} = 1"),
            len => writeln!(scene, "let {uniform} = vec{len}(0.5)"),
        };
    }
    scene
}

/// Images that differ from place to place, to see whether a picture does.
#[derive(Debug)]
struct Slopes;

impl TextureReader for Slopes {
    fn read(&self, texture: u16, channel: u8, u: f32, v: f32) -> f32 {
        let place = 7.3 * u + 3.1 * v + 0.3 * f32::from(channel);
        if texture == 0 { 0.0 } else { place.rem_euclid(1.0) }
    }
}

/// Returns a scene that is only sky, and the parts of the shader that it leaves out. A shader computes colours of the
/// screen, but a sky is light.
fn scene_of_picture(file: &GlslFile, picture: &GlslFunction) -> Result<(String, Vec<String>)> {
    let mut graph = Graph::new();
    let pixel = [Input::X, Input::Y].map(|input| graph.input(input)).to_vec();
    let mut session = GlslSession::of_picture();
    session.last_frame = Some(0);
    let colour = executed(&mut graph, &mut session, file, picture, pixel)?;
    let sky = match file.globals.is_isf {
        true => format!("let c = {}(pixel)  color = srgb(c.rgb * clamp(c.a, 0, 1))", picture.name),
        false => format!("color = srgb({}(pixel).rgb)", picture.name),
    };
    let rest = "picture { tone_map = none  bloom = 0  grain = 0 }";
    let scene = format!("{}\nsky {{ {sky} }}\n\n{rest}\n", uniforms(file));
    let is_flat = is_flat(&graph, &colour);
    if is_flat && !session.pictures.is_empty() {
        let names: Vec<&str> = session.pictures.iter().map(String::as_str).collect();
        let message =
            format!("without the pictures of `{}` this shader draws one colour", names.join("`, `"));
        return Err(Diagnostic::unsupported(picture.place, message).hint(HOW_TO_READ_IMAGES));
    }
    let mut left_out: Vec<String> = session.left_out().into_iter().map(|problem| problem.message).collect();
    if is_flat {
        left_out.push("everything but one colour: the picture is the same at all pixels".to_owned());
    }
    Ok((scene, left_out))
}

/// The number of nodes that are evaluated to see whether a picture has one colour.
const FLAT_NODES: usize = 1 << 23;
/// The largest number of moments and places at which it is evaluated.
const FLAT_SAMPLES: usize = 4096;

/// True for a picture that has one colour in all samples.
fn is_flat(graph: &Graph, colour: &[NodeId]) -> bool {
    let colour = colour.get(..3).unwrap_or_default();
    let order = graph.order(colour);
    let mut frame = FrameInputs {
        screen: Screen::of_size((320, 180)),
        sound: SoundInputs::each(|input| 0.4 * input.range().1),
        spectrum: TableData::row([0.9, 0.5, 0.7, 0.2]),
        waveform: TableData::row([0.4, -0.2, 0.1, -0.3]),
        textures: Some(Arc::new(Slopes)),
        ..FrameInputs::default()
    };
    let samples = (FLAT_NODES / graph.len().max(1)).clamp(48, FLAT_SAMPLES);
    // Places spread evenly by the plastic number (Roberts 2018, The unreasonable effectiveness of quasirandom sequences).
    let mut colours = (0..samples).map(|index| {
        frame.time = [3.0, 4.7][index % 2];
        let [x, y] = [0.754_877_7, 0.569_840_3].map(|step| (index as f32 * step).fract());
        graph.evaluate_in(&order, colour, &Point::at(320.0 * x, 180.0 * y, 0.0), &frame)
    });
    let first = colours.next();
    colours.all(|colour| Some(colour) == first)
}

fn scene_of_shape(file: &GlslFile, function: &GlslFunction) -> Result<String> {
    let mut graph = Graph::new();
    let point = [Input::X, Input::Y, Input::Z].map(|input| graph.input(input)).to_vec();
    let nodes = executed(&mut graph, &mut GlslSession::default(), file, function, point)?;
    graph.check().map_err(|error| {
        Diagnostic::over_limit(function.place, error.to_string()).hint("shorten its loops")
    })?;
    let (order, frame) = (graph.order(&nodes), FrameInputs::default());
    // An expensive function gets fewer samples, so that an import takes no longer than a second.
    let samples = if order.len() > 4_000 { SAMPLES / 3 } else { SAMPLES };
    let values = |[x, y, z]: [f32; 3]| graph.evaluate_in(&order, &nodes, &Point::at(x, y, z), &frame);
    let Sampled { numbers, eye, target } = sampled(samples, values);
    let name = &function.name;
    let number = format!(
        "  # the number of the material is the second number of {name}\n  let number = {name}(p).y\n"
    );
    let (number, color) = match numbers.len() {
        0 | 1 => (String::new(), COLORS[0].to_owned()),
        _ => (number, choice(&numbers)),
    };
    let distance = if function.result == Some(GlslType::Float) { "" } else { ".x" };
    let [eye, target] = [eye, target].map(|place| place.map(short).join(", "));
    Ok(format!(
        "{}\nmaterial surface {{\n{number}  color = {color}\n  roughness = 0.5\n}}\n\n\
         object shape {{ shape = {name}(p){distance}  material = surface }}\n\n\
         light sun {{ direction = vec3(0.5, -0.8, 0.6)  color = vec3(3, 2.8, 2.5)  radius = 0.02 }}\n\
         camera {{ position = vec3({eye})  target = vec3({target})  fov = 50 }}\n",
        uniforms(file)
    ))
}

/// A sentence for each part of the file that the scene leaves out.
fn left_out(file: &GlslFile, is_picture: bool) -> Vec<String> {
    let mut left_out = Vec::new();
    let listed = |names: Vec<&str>| format!("`{}`", names.get(..6).unwrap_or(&names).join("`, `"));
    if file.globals.has_drawing && !is_picture {
        left_out.push("camera, light and colours of the shader: mainImage and main are not run".to_owned());
        if !file.globals.unset.is_empty() {
            left_out.push(format!(
                "values of {} that its drawing code computes; they start at 0 or the value of a plain assignment",
                listed(file.globals.unset.iter().map(String::as_str).collect())
            ));
        }
    }
    let open: Vec<&str> = file.open_uniforms().into_iter().map(|(name, _)| name).collect();
    if !open.is_empty() {
        left_out
            .push(format!("values of {}, which come from outside: 1 or 0.5 is used instead", listed(open)));
    }
    for function in file.functions() {
        if let Some(problem) = file.problem_of(function) {
            left_out.push(format!("`{}`: {}", function.name, problem.message));
        }
    }
    if !is_picture && !file.globals.samplers.is_empty() {
        left_out.push("textures, except tables of noise".to_owned());
    }
    left_out
}

/// The colour of each material as nested choices of the number.
fn choice(numbers: &[f32]) -> String {
    let mut text = String::new();
    for (index, pair) in numbers.windows(2).enumerate() {
        if let [low, high] = pair {
            let _ = write!(text, "if number < {} then {} else ", short((low + high) / 2.0), color(index));
        }
    }
    text + color(numbers.len() - 1)
}

fn color(index: usize) -> &'static str {
    COLORS.get(index % COLORS.len()).copied().unwrap_or(COLORS[0])
}

/// A number with at most two decimals.
fn short(value: f32) -> String {
    let rounded = (value * 100.0).round() / 100.0;
    format!("{}", if rounded == 0.0 { 0.0 } else { rounded })
}

/// Findings from samples of the function.
struct Sampled {
    /// The numbers of materials, rising.
    numbers: Vec<f32>,
    eye: [f32; 3],
    target: [f32; 3],
}

/// Executes a function of one vector with the values that the scene gives to uniforms.
fn executed(
    graph: &mut Graph,
    session: &mut GlslSession,
    file: &GlslFile,
    function: &GlslFunction,
    argument: Vec<NodeId>,
) -> Result<Vec<NodeId>> {
    let mut budget = Budget {
        steps: LIMITS.scene_expansion_max,
        rounds_max: LIMITS.scene_loop_max,
        memory_max: LIMITS.scene_tokens_max,
    };
    let (one, half) = (graph.constant(1.0), graph.constant(0.5));
    let open = file.open_uniforms().into_iter();
    let open = open.map(|(name, len)| (name.to_owned(), if len == 1 { vec![one] } else { vec![half; len] }));
    let image =
        |(name, texture): (&str, u16)| (name.to_owned(), vec![graph.constant(image_sampler(texture))]);
    let given: Vec<(String, Vec<NodeId>)> = open.chain(file.pictures().zip(1..).map(image)).collect();
    session.call(file, function, &[argument], graph, &mut budget, &given)
}

/// Looks for the shape on a grid with `samples` points along a side, and places the camera in free space around it.
/// `values` returns the function's numbers at a point.
fn sampled(samples: usize, values: impl Fn([f32; 3]) -> Vec<f32>) -> Sampled {
    let distance = |values: &[f32]| values.first().copied().unwrap_or(0.0);
    let step = 2.0 * REACH / (samples - 1) as f32;
    let place = |index: usize| index as f32 * step - REACH;
    let mut numbers: Vec<f32> = Vec::new();
    let (mut sum, mut squares, mut count) = ([0.0_f32; 3], 0.0_f32, 0.0_f32);
    for index in 0..samples * samples * samples {
        let at = [index % samples, index / samples % samples, index / samples / samples].map(place);
        let values = values(at);
        if let Some(number) = values.get(1).filter(|number| number.is_finite()) {
            let number = (number * 100.0).round() / 100.0;
            if !numbers.contains(&number) && numbers.len() <= 4 * MATERIALS_MAX {
                numbers.push(number);
            }
        }
        // A floor is everywhere, so what is near the origin counts more.
        if distance(&values).abs() < step {
            let weight = 1.0 / (1.0 + at.iter().map(|x| x * x).sum::<f32>());
            for (sum, x) in sum.iter_mut().zip(at) {
                *sum += weight * x;
            }
            squares += weight * at.iter().map(|x| x * x).sum::<f32>();
            count += weight;
        }
    }
    // A second number with many values is no number of a material.
    if numbers.len() > MATERIALS_MAX {
        numbers.clear();
    }
    numbers.sort_by(f32::total_cmp);
    let target = sum.map(|sum| if count > 0.0 { sum / count } else { 0.0 });
    let spread = squares / count.max(f32::MIN_POSITIVE) - target.iter().map(|x| x * x).sum::<f32>();
    let away = (2.0 * spread.max(0.0).sqrt() + 1.5).clamp(1.5, 7.0);
    Sampled { numbers, eye: eye(|at| distance(&values(at)), target, away), target }
}

/// A place in free space with a free view of the target, about `wanted` away from it.
fn eye(distance: impl Fn([f32; 3]) -> f32, target: [f32; 3], wanted: f32) -> [f32; 3] {
    let (mut best, mut best_score) = ([0.0, 2.0, -5.0], f32::NEG_INFINITY);
    for away in [1.0, 0.7, 1.4, 0.4, 0.25, 0.12].map(|share| share * wanted) {
        for turn in 0..8 {
            let angle = turn as f32 * std::f32::consts::FRAC_PI_4 + 0.5;
            let direction = [angle.sin() * 0.9, 0.42, -angle.cos() * 0.9];
            let at: [f32; 3] = std::array::from_fn(|axis| target[axis] + away * direction[axis]);
            // Free space on the way to the target.
            let is_blocked = |part: usize| {
                let share = part as f32 / 8.0;
                let place = std::array::from_fn(|axis| at[axis] + (target[axis] - at[axis]) * share);
                distance(place) < 0.02
            };
            let free = (0..8).take_while(|part| !is_blocked(*part)).count();
            if free < 2 {
                continue;
            }
            let score = free as f32 - (away - wanted).abs() * 3.0 / wanted - turn as f32 * 0.01;
            if score > best_score {
                (best, best_score) = (at, score);
            }
        }
    }
    best
}
