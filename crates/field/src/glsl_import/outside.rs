//! The names that viewers of shaders define, and their meanings in a scene.

use super::items::Origin;
use super::parse::{GlslFile, GlslFunction, GlslType};
use crate::graph::{Graph, Input, NodeId, Op, ScreenInput, SoundInput};
use crate::lang::reserved_words;

/// Width and height in pixels that shapes see as the resolution. A formula of the picture sees the actual size.
const RESOLUTION: [f32; 2] = [1280.0, 720.0];
const FRAMES_PER_SECOND: f32 = 60.0;

/// The meaning of a name of a viewer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Meaning {
    Time,
    Frame,
    /// The same number always.
    Number(f32),
    /// Width and height in pixels, and 1.
    Size,
    /// Shadertoy's pointer: its pixel while the button is held, else 0.
    HeldPointer,
    /// The pixel under the pointer.
    Pointer,
    /// The pointer as fractions of the size.
    PointerShare,
    Pixel,
    /// The pixel as fractions of the size.
    Share,
    /// The input of KodeLife's shaders: position, normal and fractions of the size.
    Vertex,
    /// The pixel from the centre, in heights of the picture.
    Surface,
    SurfaceSize,
    /// The level of the sound, 0..255.
    Volume,
    Channel(Channel),
}

/// The source of a sampler.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Channel {
    /// A picture, or what the reads tell.
    Unknown,
    Picture,
    /// A table of random numbers.
    Noise,
    /// Shadertoy's texture of the sound: a row of the spectrum and one of the waveform.
    Rows,
    /// The spectrum, linear in decibels. As a vector: bass, mid and treble.
    Spectrum,
    /// The spectrum, linear in amplitude.
    Amplitudes,
    /// Amplitudes that are added up over time.
    Sums,
    Waveform,
    LastFrame,
}

use Meaning::{
    Channel as Sampler, Frame, HeldPointer, Number, Pixel, Pointer, PointerShare, Share, Size, Surface,
    SurfaceSize, Time, Vertex, Volume,
};

/// Names with the type by which a viewer declares them unasked, and their meaning. Names without a type have a meaning
/// only where the shader declares them. A row may list several names.
const NAMES: [(&str, &str, Meaning); 34] = [
    ("iTime iGlobalTime time u_time uTime fGlobalTime TIME", "float", Time),
    ("Time globalTime u_Time utime t", "", Time),
    ("iFrame FRAMEINDEX u_frame", "int", Frame),
    ("iTimeDelta TIMEDELTA fFrameTime u_delta", "float", Number(1.0 / FRAMES_PER_SECOND)),
    ("iFrameRate", "float", Number(FRAMES_PER_SECOND)),
    ("iSampleRate", "float", Number(44_100.0)),
    ("iResolution", "vec3", Size),
    ("resolution u_resolution uResolution v2Resolution RENDERSIZE", "vec2", Size),
    ("Resolution iRes uRes u_res uRESOLUTION screenSize u_screenSize canvasSize", "", Size),
    ("iChannelResolution", "vec3[4]", Size),
    ("iMouse", "vec4", HeldPointer),
    ("u_mouse uMouse", "vec2", Pointer),
    ("mouse", "vec2", PointerShare),
    ("gl_FragCoord", "vec4", Pixel),
    ("fragCoord", "vec2", Pixel),
    ("isf_FragNormCoord vv_FragNormCoord", "vec2", Share),
    ("vertTexCoord vUV", "", Share),
    ("inData", "", Vertex),
    ("surfacePosition", "vec2", Surface),
    ("surfaceSize", "vec2", SurfaceSize),
    ("volume", "float", Volume),
    ("iDate DATE u_date date", "vec4", Number(0.0)),
    ("iChannelTime", "float[4]", Time),
    ("gl_FragColor fragColor", "vec4", Number(0.0)),
    ("gl_FragDepth", "float", Number(0.0)),
    ("mouseButtons", "", Number(0.0)),
    ("PASSINDEX pass", "int", Number(0.0)),
    ("iChannel0 iChannel1 iChannel2 iChannel3", "sampler2D", Sampler(Channel::Unknown)),
    ("texNoise", "sampler2D", Sampler(Channel::Noise)),
    ("spectrum", "sampler2D", Sampler(Channel::Spectrum)),
    ("samples", "sampler2D", Sampler(Channel::Waveform)),
    ("texFFT texFFTSmoothed", "sampler1D", Sampler(Channel::Amplitudes)),
    ("texFFTIntegrated", "sampler1D", Sampler(Channel::Sums)),
    (
        "backbuffer texPreviousFrame prevFrame PrevFrame u_backbuffer u_doubleBuffer0",
        "sampler2D",
        Sampler(Channel::LastFrame),
    ),
];

/// Returns what a name of a viewer means.
pub(crate) fn meaning(name: &str) -> Option<Meaning> {
    let known = NAMES.iter().find(|(names, ..)| names.split(' ').any(|known| known == name));
    known.map(|(.., meaning)| *meaning)
}

/// True for a name that a scene cannot declare.
pub(super) fn is_taken(name: &str) -> bool {
    let names = ["p", "x", "y", "z", "n", "t", "pi", "tau", "eye", "direction", "volume", "pixel"];
    level(name).is_some() || names.contains(&name) || reserved_words().any(|word| word == name)
}

/// The sound input of that name, which no value of a scene hides.
fn level(name: &str) -> Option<SoundInput> {
    SoundInput::named(name).filter(|input| !input.may_be_hidden())
}

/// True for a uniform whose value a scene must give.
pub(super) fn is_open(name: &str) -> bool {
    meaning(name).is_none() && level(name).is_none()
}

/// Returns what a sampler of that name reads.
pub(super) fn channel(name: &str) -> Channel {
    match meaning(name) {
        Some(Sampler(channel)) => channel,
        _ => Channel::Unknown,
    }
}

/// True for a name that depends on the pixel.
pub(super) fn is_of_pixel(name: &str) -> bool {
    matches!(meaning(name), Some(Pixel | Share | Surface | Vertex))
}

/// The names that viewers declare unasked, each with its type.
pub(super) fn given() -> impl Iterator<Item = (&'static str, &'static str)> {
    let declared = NAMES.iter().filter(|(_, of, _)| !of.is_empty());
    declared.flat_map(|(names, of, _)| names.split(' ').map(move |name| (name, *of)))
}

/// Returns `len` components of a known value from outside; `None` for an unknown one. `in_picture` is true for a
/// formula of the picture, which knows the pixel, the picture's size and the pointer.
pub(super) fn known(
    graph: &mut Graph,
    name: &str,
    len: usize,
    origin: Origin,
    in_picture: bool,
) -> Option<Vec<NodeId>> {
    // Two numbers from an earlier stage of a shader that fills the picture are the place in it.
    let place = (origin == Origin::Varying && len == 2).then_some(Share);
    let Some(meaning) = meaning(name).or(place) else {
        // Many name a level of the sound as scenes do.
        if let Some(level) = level(name).filter(|_| len == 1) {
            return Some(vec![graph.input(Input::Sound(level))]);
        }
        let value = graph.constant(if len == 1 { 1.0 } else { 0.5 });
        return (is_taken(name) && origin == Origin::Uniform).then(|| vec![value; len]);
    };
    if in_picture && let Some(mut nodes) = of_picture(graph, meaning) {
        let zero = graph.constant(0.0);
        nodes.resize(len, zero);
        return Some(nodes);
    }
    let mut constants = |values: &[f32]| -> Vec<NodeId> {
        (0..len).map(|index| graph.constant(values.get(index).copied().unwrap_or(0.0))).collect()
    };
    Some(match meaning {
        Time => vec![graph.input(Input::T); len],
        Frame => {
            let time = graph.input(Input::T);
            vec![graph.unary(Op::Floor, time * FRAMES_PER_SECOND); len]
        }
        Size => constants(&[RESOLUTION[0], RESOLUTION[1], 1.0]),
        Number(number) => constants(&[number]),
        HeldPointer | Pointer | PointerShare => constants(&[]),
        Volume => {
            let [bass, mid, treble] = levels(graph);
            vec![graph.mul(bass + mid + treble, 255.0 / 3.0); len]
        }
        Sampler(Channel::Spectrum) if len == 3 => levels(graph).to_vec(),
        _ => return None,
    })
}

fn levels(graph: &mut Graph) -> [NodeId; 3] {
    [SoundInput::Bass, SoundInput::Mid, SoundInput::Treble].map(|input| graph.input(Input::Sound(input)))
}

/// Returns the components of a value that depends on the picture.
fn of_picture(graph: &mut Graph, meaning: Meaning) -> Option<Vec<NodeId>> {
    let screen = |graph: &mut Graph, input| graph.input(Input::Screen(input));
    let (zero, one) = (graph.constant(0.0), graph.constant(1.0));
    let size = [ScreenInput::Width, ScreenInput::Height].map(|input| screen(graph, input));
    let pointer = [ScreenInput::MouseX, ScreenInput::MouseY].map(|input| screen(graph, input));
    let pixel = [Input::X, Input::Y].map(|input| graph.input(input));
    let of = |graph: &mut Graph, values: [NodeId; 2]| {
        [0, 1].map(|axis| graph.div(values[axis], size[axis])).to_vec()
    };
    Some(match meaning {
        Size => vec![size[0], size[1], one],
        HeldPointer => {
            let pressed = screen(graph, ScreenInput::MousePressed);
            let held = pointer.map(|at| graph.mul(pressed, at));
            [held, held].concat()
        }
        Pointer => pointer.to_vec(),
        PointerShare => of(graph, pointer),
        Pixel => vec![pixel[0], pixel[1], zero, one],
        Share => of(graph, pixel),
        Vertex => {
            let share = of(graph, pixel);
            let position = share.iter().map(|&share| graph.add(share + share, -1.0)).collect();
            [position, vec![zero, one, zero, zero, one], share].concat()
        }
        Surface => {
            let centred = [0, 1].map(|axis| pixel[axis] - size[axis] * 0.5);
            centred.map(|at| graph.div(at, size[1])).to_vec()
        }
        SurfaceSize => vec![graph.div(size[0], size[1]), one],
        _ => return None,
    })
}

// Finds the function of a file that is a scene's distance.

/// Names of distance functions in lower case, the most common first.
const DISTANCES: &str = "map scene de sdf getdist getsdf distancefield world scenesdf dist df field mapscene sdscene \
    distance_field scenedist sdfscene estimate distanceestimator sd f distfunc dstf d";

/// Number of names at the start of [`DISTANCES`] that no helper function has.
const SURE: usize = 9;

fn rank(function: &GlslFunction) -> Option<usize> {
    let name = function.name.to_lowercase();
    DISTANCES.split_ascii_whitespace().position(|known| known == name)
}

/// True if the function's name says that it is the distance to a scene.
pub(super) fn is_distance_for_sure(function: &GlslFunction) -> bool {
    rank(function).is_some_and(|rank| rank < SURE)
}

/// Returns the function of a point in space that most likely gives the distance to the scene.
pub fn candidate(file: &GlslFile) -> Option<&GlslFunction> {
    let fits = |function: &&GlslFunction| {
        let takes_point =
            matches!(function.parameters.as_slice(), [one] if one.of == Some(GlslType::Vector(3)));
        takes_point && matches!(function.result, Some(GlslType::Float | GlslType::Vector(_)))
    };
    let named = file.functions().iter().filter(fits).filter_map(|function| Some((rank(function)?, function)));
    named.min_by_key(|(rank, _)| *rank).map(|(_, function)| function)
}
