//! Values that the CPU computes once per frame because they do not depend on the point: camera, lights and planes.

use crate::graph::{FrameInputs, NodeId, Point};
use crate::lang::{Light, LightPlace, Scene, ToneMap};
use crate::tape::{PointEvaluator, Tape, TapeError, TapeOptions};

use super::planes::Plane;

/// The tapes of the camera, of each light and of the planes.
#[derive(Debug, Clone)]
pub struct FrameTape {
    camera: Tape,
    lights: Vec<(Tape, LightKind)>,
    sky: Tape,
    picture: Tape,
    tone_map: ToneMap,
    planes: Vec<Tape>,
}

/// Where a light's rays come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LightKind {
    /// A point or a ball.
    Lamp,
    /// A direction.
    Sun,
    /// A rectangle.
    Panel,
}

/// A light in one frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LightValues {
    /// Its kind.
    pub kind: LightKind,
    /// Its position; for a sun the direction of its rays.
    pub place: [f32; 3],
    /// Red, green and blue.
    pub color: [f32; 3],
    /// Radius of the shining ball; for a sun the tangent of its half angle.
    pub radius: f32,
    /// Distance at which it has faded to nothing; 0 for no limit.
    pub range: f32,
    /// Share of its light that shadows remove.
    pub shadow: f32,
    /// Half the sides of a panel.
    pub sides: [[f32; 3]; 2],
}

/// How the scene's light becomes the picture in one frame.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PictureValues {
    /// Factor by which light is multiplied.
    pub exposure: f32,
    /// Share of the light that is scattered.
    pub bloom: f32,
    /// Share of the light that is lost in the corners.
    pub vignette: f32,
    /// Strength of the grain, in steps of 1/255.
    pub grain: f32,
    /// Radius of the lens.
    pub aperture: f32,
    /// Distance that is in focus; `None` for that of the target.
    pub focus: Option<f32>,
    /// How light becomes a colour of the screen.
    pub tone_map: ToneMap,
}

/// The scene's values in one frame. They are as the scene computes them and may not even be finite.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FrameValues {
    /// The eye.
    pub position: [f32; 3],
    /// The point it looks at.
    pub target: [f32; 3],
    /// Vertical field of view in degrees.
    pub fov: f32,
    /// Roll around the line of sight in radians.
    pub roll: f32,
    /// Width at the target that stays in the picture.
    pub keep: f32,
    /// Distance within which other things block ambient light.
    pub reach: f32,
    /// How the picture is made.
    pub picture: PictureValues,
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
        let (camera, picture) = (&scene.camera, &scene.picture);
        let ([px, py, pz], [tx, ty, tz]) = (camera.position, camera.target);
        let lights = scene.lights.iter().map(|light| {
            let (kind, roots) = of_light(light);
            Ok((tape(&roots)?, kind))
        });
        Ok(Self {
            camera: tape(&[px, py, pz, tx, ty, tz, camera.fov, camera.roll, camera.keep])?,
            lights: lights.collect::<Result<_, TapeError>>()?,
            sky: tape(&[scene.sky.reach])?,
            picture: tape(
                &[picture.exposure, picture.bloom, picture.vignette, picture.grain, camera.aperture]
                    .into_iter()
                    .chain(camera.focus)
                    .collect::<Vec<_>>(),
            )?,
            tone_map: picture.tone_map,
            planes: planes.iter().map(|plane| tape(&[plane.shape])).collect::<Result<_, _>>()?,
        })
    }

    /// The values in a frame.
    pub fn values(&self, inputs: &FrameInputs) -> FrameValues {
        let origin = Point::at(0.0, 0.0, 0.0);
        let values = |tape: &Tape| PointEvaluator::new(tape, inputs).at(&origin).to_vec();
        let mut frame = FrameValues::default();
        if let [px, py, pz, tx, ty, tz, fov, roll, keep] = *values(&self.camera) {
            (frame.position, frame.target) = ([px, py, pz], [tx, ty, tz]);
            (frame.fov, frame.roll, frame.keep) = (fov, roll, keep);
        }
        frame.reach = values(&self.sky).first().copied().unwrap_or_default();
        if let [exposure, bloom, vignette, grain, aperture, ref focus @ ..] = *values(&self.picture) {
            let (focus, tone_map) = (focus.first().copied(), self.tone_map);
            frame.picture = PictureValues { exposure, bloom, vignette, grain, aperture, focus, tone_map };
        }
        for (tape, kind) in &self.lights {
            if let [x, y, z, r, g, b, radius, range, shadow, ref sides @ ..] = *values(tape) {
                let side = |number: usize| sides.as_chunks().0.get(number).copied().unwrap_or_default();
                frame.lights.push(LightValues {
                    kind: *kind,
                    place: [x, y, z],
                    color: [r, g, b],
                    radius,
                    range,
                    shadow,
                    sides: [side(0), side(1)],
                });
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

/// The kind of a light, and its computed values: place, colour, radius, range, shadow and, for a panel, its half
/// sides.
fn of_light(light: &Light) -> (LightKind, Vec<NodeId>) {
    let (kind, place, sides) = match light.place {
        LightPlace::At(place) => (LightKind::Lamp, place, Vec::new()),
        LightPlace::Towards(direction) => (LightKind::Sun, direction, Vec::new()),
        LightPlace::Panel { at, right, up } => (LightKind::Panel, at, [right, up].concat()),
    };
    let numbers = [light.radius, light.range, light.shadow];
    (kind, place.into_iter().chain(light.color).chain(numbers).chain(sides).collect())
}
