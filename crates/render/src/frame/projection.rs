//! Projections: the rays of pictures that are not flat, or have two eyes. `shaders/camera_ray.glsl` computes the same
//! rays.

use std::f64::consts::FRAC_PI_2;

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::camera::Camera;

/// The surface onto which a picture is projected.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum ProjectionKind {
    /// A plane: the picture of a common camera.
    #[default]
    Flat,
    /// The whole sphere, equirectangular.
    Sphere,
    /// A hemisphere as a disc whose radius is proportional to the angle: a dome master.
    Dome,
    /// The hemisphere in front, equirectangular.
    Vr180,
}

/// The arrangement of the pictures of two eyes. Each picture has half of the pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Stereo {
    /// One eye.
    #[default]
    None,
    /// The left eye's picture on the left.
    SideBySide,
    /// The left eye's picture above.
    OverUnder,
}

/// A projection. The default is flat, for one eye.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Projection {
    /// The surface.
    pub kind: ProjectionKind,
    /// The arrangement of two eyes.
    pub stereo: Stereo,
    /// Distance of the eyes in the scene's units.
    pub eye_distance: f64,
    /// Height of the camera's target in a dome, in degrees above the front rim: 90 is the zenith.
    pub dome_tilt: f64,
}

impl Default for Projection {
    fn default() -> Self {
        Self {
            kind: ProjectionKind::Flat,
            stereo: Stereo::None,
            eye_distance: Self::EYE_DISTANCE,
            dome_tilt: Self::DOME_TILT,
        }
    }
}

/// A ray of the eye.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EyeRay {
    /// Its start.
    pub origin: DVec3,
    /// Its direction, of unit length.
    pub direction: DVec3,
}

impl ProjectionKind {
    /// All kinds with the names of their constants in the shaders, numbered from 0.
    const ALL: [(Self, &'static str); 4] =
        [(Self::Flat, "FLAT"), (Self::Sphere, "SPHERE"), (Self::Dome, "DOME"), (Self::Vr180, "VR180")];

    /// Default width and height of one eye's picture, in pixels.
    pub fn default_size(self) -> (u32, u32) {
        match self {
            Self::Flat => (1280, 720),
            Self::Sphere => (3840, 1920),
            Self::Dome => (2048, 2048),
            Self::Vr180 => (1920, 1920),
        }
    }
}

impl Stereo {
    const ALL: [(Self, &'static str); 3] =
        [(Self::None, "NONE"), (Self::SideBySide, "SIDE_BY_SIDE"), (Self::OverUnder, "OVER_UNDER")];

    /// The columns and rows of the eyes' pictures.
    pub(crate) fn pictures(self) -> (u32, u32) {
        match self {
            Self::None => (1, 1),
            Self::SideBySide => (2, 1),
            Self::OverUnder => (1, 2),
        }
    }
}

/// The defines of a program that draws every projection.
pub fn projection_defines() -> impl Iterator<Item = String> {
    let kinds = ProjectionKind::ALL.iter().map(|(kind, name)| (*kind as u8, format!("PROJECTION_{name}")));
    let stereos = Stereo::ALL.iter().map(|(stereo, name)| (*stereo as u8, format!("STEREO_{name}")));
    let numbers = kinds.chain(stereos).map(|(number, name)| format!("{name} {:?}", f32::from(number)));
    std::iter::once("PROJECTED 1".to_owned()).chain(numbers)
}

impl Projection {
    /// The default distance of the eyes: a person's, in scenes whose unit is a metre.
    pub const EYE_DISTANCE: f64 = 0.064;
    /// The default height of the camera's target in a dome: where an audience looks without effort.
    pub const DOME_TILT: f64 = 45.0;

    /// True if programs without the projection's defines draw the picture.
    pub fn is_plain(&self) -> bool {
        self.kind == ProjectionKind::Flat && self.stereo == Stereo::None
    }

    /// The default size of the picture of all eyes, in pixels.
    pub fn default_size(&self) -> (u32, u32) {
        let ((width, height), (columns, rows)) = (self.kind.default_size(), self.stereo.pictures());
        (width * columns, height * rows)
    }

    /// The size of one eye's picture within a picture of `size`, in pixels.
    pub fn eye_size(&self, size: (u32, u32)) -> (f64, f64) {
        let (columns, rows) = self.stereo.pictures();
        (f64::from(size.0) / f64::from(columns), f64::from(size.1) / f64::from(rows))
    }

    /// The camera's axes to the right, upwards and forward, as the picture has them.
    pub(super) fn axes(&self, camera: &Camera) -> [DVec3; 3] {
        let Camera { right, up, forward, .. } = *camera;
        match self.kind {
            ProjectionKind::Flat => [right * camera.tan_half.0, up * camera.tan_half.1, forward],
            // Headsets keep the horizon level, so these pictures have the camera's heading, without its pitch and roll.
            ProjectionKind::Sphere | ProjectionKind::Vr180 => {
                let right = DVec3::Y.cross(forward).normalize_or(right);
                [right, DVec3::Y, right.cross(DVec3::Y)]
            }
            // The zenith is in the middle and the front at the lower edge.
            ProjectionKind::Dome => {
                let (sin, cos) = self.dome_tilt.to_radians().sin_cos();
                [right, up * sin - forward * cos, forward * sin + up * cos]
            }
        }
    }

    /// Half a pixel's width at distance 1, for a picture of `size` pixels.
    pub fn pixel_radius(&self, camera: &Camera, size: (u32, u32)) -> f64 {
        let (width, height) = self.eye_size(size);
        match self.kind {
            ProjectionKind::Flat => camera.tan_half.1 / height,
            ProjectionKind::Sphere => (2.0 * FRAC_PI_2 / width).max(FRAC_PI_2 / height),
            ProjectionKind::Dome | ProjectionKind::Vr180 => FRAC_PI_2 / width.min(height),
        }
    }

    /// The axes and the projection's vector of the shaders' frame block.
    pub(super) fn packed(&self, camera: &Camera) -> ([DVec3; 3], [f64; 4]) {
        let half = if self.stereo == Stereo::None { 0.0 } else { 0.5 * self.eye_distance };
        let numbers = [
            f64::from(self.kind as u8),
            f64::from(self.stereo as u8),
            half,
            camera.to_target.max(1e-6).recip(),
        ];
        (self.axes(camera), numbers)
    }

    /// The ray through a point of a picture of `size` pixels. `at` is in pixels from the upper left corner. `None`
    /// outside of a dome's circle.
    pub fn ray(&self, camera: &Camera, size: (u32, u32), at: (f64, f64)) -> Option<EyeRay> {
        let (width, height) = self.eye_size(size);
        let (x, y) = (at.0, f64::from(size.1) - at.1);
        let (left, below, side) = match self.stereo {
            Stereo::None => (0.0, 0.0, 0.0),
            Stereo::SideBySide if x < width => (0.0, 0.0, -1.0),
            Stereo::SideBySide => (width, 0.0, 1.0),
            Stereo::OverUnder if y < height => (0.0, 0.0, 1.0),
            Stereo::OverUnder => (0.0, height, -1.0),
        };
        let least = width.min(height);
        let sides = if self.kind == ProjectionKind::Dome { (least, least) } else { (width, height) };
        let place = ((2.0 * (x - left) - width) / sides.0, (2.0 * (y - below) - height) / sides.1);
        let ([right, up, forward], [_, _, half, nearness]) = self.packed(camera);
        let eye = side * half;
        let (direction, across) = match self.kind {
            ProjectionKind::Flat => {
                let direction = forward + place.0 * right + place.1 * up - eye * nearness * camera.right;
                (direction.normalize(), camera.right)
            }
            ProjectionKind::Dome => {
                let radius = place.0.hypot(place.1);
                if radius > 1.0 {
                    return None;
                }
                let (sin, cos) = (FRAC_PI_2 * radius).sin_cos();
                let away = (place.0 * right + place.1 * up).normalize_or_zero();
                (sin * away + cos * forward, right)
            }
            ProjectionKind::Sphere | ProjectionKind::Vr180 => {
                let half_width = if self.kind == ProjectionKind::Sphere { 2.0 } else { 1.0 } * FRAC_PI_2;
                let (sin, cos) = (half_width * place.0).sin_cos();
                let (rise, level) = (FRAC_PI_2 * place.1).sin_cos();
                let across =
                    if self.kind == ProjectionKind::Sphere { cos * right - sin * forward } else { right };
                (level * (sin * right + cos * forward) + rise * up, across)
            }
        };
        Some(EyeRay { origin: camera.position + eye * across, direction })
    }

    /// Width over height of one eye's picture.
    pub(super) fn aspect(&self, size: (u32, u32)) -> f64 {
        let (width, height) = self.eye_size(size);
        width / height
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Frame;
    use crate::frame::testing::world_of;
    use mariana_field::lang;
    use mariana_music::Features;

    fn camera() -> Camera {
        let asked = lang::Camera { target: [0.0, 0.0, 4.0], fov: 60.0, ..lang::Camera::of([]) };
        Camera::of(&asked, 1.0)
    }

    fn direction(projection: &Projection, at: (f64, f64)) -> DVec3 {
        projection.ray(&camera(), (200, 100), at).unwrap().direction
    }

    #[test]
    fn a_sphere_has_the_target_in_the_middle_and_the_right_on_the_right() {
        let sphere = Projection { kind: ProjectionKind::Sphere, ..Projection::default() };
        for (at, expected) in [
            ((100.0, 50.0), DVec3::Z),
            ((150.0, 50.0), DVec3::X),
            ((50.0, 50.0), -DVec3::X),
            ((0.0, 50.0), -DVec3::Z),
            ((100.0, 0.0), DVec3::Y),
            ((30.0, 100.0), -DVec3::Y),
        ] {
            assert!((direction(&sphere, at) - expected).length() < 1e-9, "{at:?}");
        }
    }

    #[test]
    fn the_front_of_a_dome_is_at_its_lower_edge() {
        let dome = |dome_tilt| Projection { kind: ProjectionKind::Dome, dome_tilt, ..Projection::default() };
        for (tilt, at, expected) in [
            (0.0, (100.0, 50.0), DVec3::Y),
            (0.0, (100.0, 100.0), DVec3::Z),
            (0.0, (150.0, 50.0), DVec3::X),
            (45.0, (100.0, 75.0), DVec3::Z),
            (90.0, (100.0, 50.0), DVec3::Z),
            (90.0, (100.0, 0.0), DVec3::Y),
        ] {
            assert!((direction(&dome(tilt), at) - expected).length() < 1e-9, "{tilt} {at:?}");
        }
        assert_eq!(dome(0.0).ray(&camera(), (200, 100), (20.0, 50.0)), None);
    }

    #[test]
    fn eyes_are_apart_across_the_line_of_sight() {
        let stereo = |kind, stereo| Projection { kind, stereo, eye_distance: 0.5, ..Projection::default() };
        let ray = |projection: Projection, at| projection.ray(&camera(), (200, 200), at).unwrap();
        // Straight ahead, behind, and ahead again for eyes side by side.
        let sphere = stereo(ProjectionKind::Sphere, Stereo::OverUnder);
        assert!((ray(sphere, (100.0, 50.0)).origin - camera().position + 0.25 * DVec3::X).length() < 1e-9);
        assert!((ray(sphere, (100.0, 150.0)).origin - camera().position - 0.25 * DVec3::X).length() < 1e-9);
        assert!((ray(sphere, (200.0, 50.0)).origin - camera().position - 0.25 * DVec3::X).length() < 1e-9);
        let flat = stereo(ProjectionKind::Flat, Stereo::SideBySide);
        for middle in [50.0, 150.0] {
            let EyeRay { origin, direction } = ray(flat, (middle, 100.0));
            let met = origin + direction * (4.0 / direction.z);
            assert!((met - DVec3::new(0.0, 0.0, 4.0)).length() < 1e-9, "both eyes look at the target");
        }
    }

    #[test]
    fn a_camera_that_sees_everything_does_not_step_back() {
        let world =
            world_of("length(p) - 1\ncamera { position = vec3(0, 0, -4)  target = vec3(0)  keep = 50 }");
        let flat = Frame::new(&world, 0.0, Features::default(), (64, 32));
        assert!(flat.camera.position.z < -10.0);
        let sphere = Projection { kind: ProjectionKind::Sphere, ..Projection::default() };
        let frame = flat.projected(&world, sphere);
        assert_eq!(frame.camera.position.z, -4.0);
        assert_eq!(frame.inputs.eye[2], -4.0);
    }

    #[test]
    fn a_pixel_is_never_wider_than_its_cone() {
        let kinds = ProjectionKind::ALL.map(|(kind, _)| kind).into_iter().skip(1);
        for projection in kinds.map(|kind| Projection { kind, ..Projection::default() }) {
            for size in [(64, 32), (64, 64), (96, 20)] {
                let radius = projection.pixel_radius(&camera(), size);
                for (x, y) in (0..size.0 - 1).flat_map(|x| (0..size.1 - 1).map(move |y| (x, y))) {
                    let ray = |right: u32, down: u32| {
                        let at = (f64::from(x + right) + 0.5, f64::from(y + down) + 0.5);
                        projection.ray(&camera(), size, at).map(|ray| ray.direction)
                    };
                    let Some(own) = ray(0, 0) else { continue };
                    for next in [ray(1, 0), ray(0, 1)].into_iter().flatten() {
                        assert!((next - own).length() <= 2.0 * radius + 1e-9, "{projection:?} {x} {y}");
                    }
                }
            }
        }
    }
}
