//! Values that the CPU computes once per frame because they do not depend on the point: camera, lights and planes.

use std::collections::BTreeSet;

use crate::graph::{FrameInputs, Input, NodeId, Point, ScreenInput};
use crate::lang::{Camera, Light, LightKind, Picture, Scene, Sky};
use crate::limits::{LIMITS, Limits};
use crate::tape::{PointEvaluator, Tape, TapeError, TapeOptions};

use super::feedback::Feedback;
use super::planes::Plane;

/// The tapes of the cameras, the lights, the picture and the planes.
#[derive(Debug, Clone)]
pub struct FrameTape {
    camera: Tape,
    cameras: Vec<Tape>,
    lights: Vec<(LightKind, Tape)>,
    nearby: Tape,
    picture: Tape,
    planes: Vec<Tape>,
    /// How frames depend on earlier frames; `None` if they do not.
    pub feedback: Option<Feedback>,
    /// The numbers of the picture and the pointer that the sky and the picture's settings read.
    pub screen_inputs: BTreeSet<ScreenInput>,
}

/// The scene's values in one frame, which may be infinite or NaN. The sky's values are in their ranges.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameValues {
    /// The camera.
    pub camera: Camera<f32>,
    /// The named cameras.
    pub cameras: Vec<Camera<f32>>,
    /// The distance within which objects block ambient light.
    pub reach: f32,
    /// The fraction of light that objects within this distance throw on each other.
    pub bounce: f32,
    /// The settings of the image.
    pub picture: Picture<f32>,
    /// The lights.
    pub lights: Vec<Light<f32>>,
    /// The planes: `[a, b, c, d]` of `a*x + b*y + c*z + d`.
    pub planes: Vec<[f32; 4]>,
}

impl FrameTape {
    pub(super) fn build(scene: &Scene, planes: &[Plane]) -> Result<Self, TapeError> {
        // The limit on outputs is for shaders, which do not run these tapes.
        let limits = Limits { tape_outputs_max: usize::MAX, ..LIMITS };
        let options = TapeOptions { limits, ..TapeOptions::default() };
        let tape = |roots: &[NodeId]| Tape::build(&scene.graph, roots, &options);
        let light = |light: &Light| Ok((light.kind, tape(&light.numbers())?));
        Ok(Self {
            camera: tape(&scene.camera.numbers())?,
            cameras: scene
                .cameras
                .iter()
                .map(|(_, camera)| tape(&camera.numbers()))
                .collect::<Result<_, _>>()?,
            lights: scene.lights.iter().map(light).collect::<Result<_, TapeError>>()?,
            nearby: tape(&[scene.sky.reach, scene.sky.bounce])?,
            picture: tape(&scene.picture.numbers())?,
            planes: planes.iter().map(|plane| tape(&[plane.shape])).collect::<Result<_, _>>()?,
            feedback: Feedback::of(scene)?,
            screen_inputs: screen_inputs(scene)?,
        })
    }

    /// Computes the values of a frame.
    pub fn values(&self, inputs: &FrameInputs) -> FrameValues {
        let values = |tape: &Tape| PointEvaluator::new(tape, inputs).at(&Point::at(0.0, 0.0, 0.0)).to_vec();
        let plane = |tape: &Tape| {
            let mut plane = PointEvaluator::new(tape, inputs);
            let mut at = |x, y, z| plane.at(&Point::at(x, y, z)).first().copied().unwrap_or(0.0);
            let d = at(0.0, 0.0, 0.0);
            [at(1.0, 0.0, 0.0) - d, at(0.0, 1.0, 0.0) - d, at(0.0, 0.0, 1.0) - d, d]
        };
        let [reach, bounce] = *values(&self.nearby).first_chunk().unwrap_or(&[0.0; 2]);
        let sky = Sky { color: [0.0; 3], ambient: [0.0; 3], reach, bounce };
        let sky = sky.in_ranges(|number, range| range.clamp(number));
        FrameValues {
            camera: Camera::of(values(&self.camera)),
            cameras: self.cameras.iter().map(|tape| Camera::of(values(tape))).collect(),
            reach: sky.reach,
            bounce: sky.bounce,
            picture: Picture::of(values(&self.picture)),
            lights: self.lights.iter().map(|(kind, tape)| Light::of(*kind, values(tape))).collect(),
            planes: self.planes.iter().map(plane).collect(),
        }
    }
}

fn screen_inputs(scene: &Scene) -> Result<BTreeSet<ScreenInput>, TapeError> {
    let roots: Vec<NodeId> = scene.sky.color.into_iter().chain(scene.picture.numbers()).collect();
    let of_screen = |input: &Input| match input {
        Input::Screen(input) => Some(*input),
        _ => None,
    };
    Ok(scene.graph.inputs_used(&roots)?.inputs.iter().filter_map(of_screen).collect())
}
