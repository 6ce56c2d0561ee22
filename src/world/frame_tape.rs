//! What the processor evaluates once a frame: the camera, the lights and the planes, which do not depend on the point.

use crate::graph::{FrameInputs, NodeId, Point};
use crate::lang::{LightPlace, Scene};
use crate::tape::{PointEvaluator, Tape, TapeError, TapeOptions};

use super::planes::Plane;

/// The tapes of the camera, of each light and of the planes.
#[derive(Debug, Clone)]
pub struct FrameTape {
    camera: Tape,
    lights: Vec<(Tape, bool)>,
    planes: Vec<Tape>,
}

/// A light in one frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LightValues {
    /// Where it is or, if `towards`, the direction of its rays.
    pub place: [f32; 3],
    /// Whether it is infinitely far away.
    pub towards: bool,
    /// Red, green and blue.
    pub color: [f32; 3],
    /// Radius of the ball that shines, or the tangent of its half angle.
    pub radius: f32,
}

/// What the scene says of one frame. Numbers are as the scene gives them: not even finite.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FrameValues {
    /// The eye.
    pub position: [f32; 3],
    /// What it looks at.
    pub target: [f32; 3],
    /// Vertical field of view in degrees.
    pub fov: f32,
    /// Turn around the line of sight in radians.
    pub roll: f32,
    /// Width at the target that stays in the picture.
    pub keep: f32,
    /// The lights.
    pub lights: Vec<LightValues>,
    /// The planes: `[a, b, c, d]` of `a*x + b*y + c*z + d`.
    pub planes: Vec<[f32; 4]>,
}

impl FrameTape {
    /// The tapes of a scene.
    ///
    /// # Errors
    /// See [`TapeError`].
    pub(super) fn build(scene: &Scene, planes: &[Plane]) -> Result<Self, TapeError> {
        let tape = |roots: &[NodeId]| Tape::build(&scene.graph, roots, &TapeOptions::default());
        let camera = &scene.camera;
        let ([px, py, pz], [tx, ty, tz]) = (camera.position, camera.target);
        let lights = scene.lights.iter().map(|light| {
            let (([x, y, z], towards), [r, g, b]) = match light.place {
                LightPlace::At(place) => ((place, false), light.color),
                LightPlace::Towards(direction) => ((direction, true), light.color),
            };
            Ok((tape(&[x, y, z, r, g, b, light.radius])?, towards))
        });
        Ok(Self {
            camera: tape(&[px, py, pz, tx, ty, tz, camera.fov, camera.roll, camera.keep])?,
            lights: lights.collect::<Result<_, TapeError>>()?,
            planes: planes.iter().map(|plane| tape(&[plane.shape])).collect::<Result<_, _>>()?,
        })
    }

    /// What they give in a frame.
    pub fn values(&self, inputs: &FrameInputs) -> FrameValues {
        let origin = Point::at(0.0, 0.0, 0.0);
        let values = |tape: &Tape| PointEvaluator::new(tape, inputs).at(&origin).to_vec();
        let mut frame = FrameValues::default();
        if let [px, py, pz, tx, ty, tz, fov, roll, keep] = *values(&self.camera) {
            (frame.position, frame.target) = ([px, py, pz], [tx, ty, tz]);
            (frame.fov, frame.roll, frame.keep) = (fov, roll, keep);
        }
        for (tape, towards) in &self.lights {
            if let [x, y, z, r, g, b, radius] = *values(tape) {
                let (place, color) = ([x, y, z], [r, g, b]);
                frame.lights.push(LightValues { place, towards: *towards, color, radius });
            }
        }
        for tape in &self.planes {
            let mut plane = PointEvaluator::new(tape, inputs);
            let mut at = |x, y, z| plane.at(&Point::at(x, y, z)).first().copied().unwrap_or(0.0);
            let d = at(0.0, 0.0, 0.0);
            frame.planes.push([at(1.0, 0.0, 0.0) - d, at(0.0, 1.0, 0.0) - d, at(0.0, 0.0, 1.0) - d, d]);
        }
        frame
    }
}
