//! A frame's camera: placed by the scene's expressions and adapted to the window.

use glam::{DQuat, DVec3};

use super::orbit_controls::OrbitControls;
use mariana_field::lang;

/// A pinhole camera. Its axes are orthonormal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Position of the eye.
    pub position: DVec3,
    /// Axis to the right of the image.
    pub right: DVec3,
    /// Axis upwards in the image.
    pub up: DVec3,
    /// Axis into the image.
    pub forward: DVec3,
    /// Tangents of half the field of view, horizontal and vertical.
    pub tan_half: (f64, f64),
    /// Distance to the target.
    pub to_target: f64,
    /// Distance by which the eye steps back, so that all of the scene is in view.
    pub stepped_back: f64,
}

/// The vertical field of view in degrees if a scene's is not finite.
const FOV: f32 = 85.0;
/// Tangent of half of the largest vertical field of view for showing more in a narrow image: wider ones distort too much.
const WIDENED_MAX: f64 = 1.2;
/// Coordinates are clamped to this range.
const PLACE_MAX: f64 = 1e7;

impl Camera {
    /// The camera that a scene requests, for an image of `aspect` (width over height).
    ///
    /// If the image at the target would be narrower than the scene's `keep`, the eye steps back along its line of
    /// sight. If it is still narrower than in a square image, the field of view widens to show as much, but to at most
    /// 100 degrees. Values that are not finite count as 0; the scene's field of view is clamped to 1..170 degrees.
    pub fn of(asked: &lang::Camera<f32>, aspect: f64) -> Self {
        Self::by_hand(asked, aspect, &OrbitControls::OFF)
    }

    /// Like [`Camera::of`], then moved by the user.
    pub fn by_hand(asked: &lang::Camera<f32>, aspect: f64, orbit: &OrbitControls) -> Self {
        let target = place(asked.target);
        let mut eye = place(asked.position);
        let fov = asked.clone().in_ranges(|number, range| range.clamp(number)).fov;
        let fov = if asked.fov.is_finite() { fov } else { FOV };
        let tan = (0.5 * f64::from(fov).to_radians()).tan();
        let away = eye - target;
        let seen = 2.0 * away.length() * (tan * aspect);
        let keep = f64::from(asked.keep);
        // Width at the target, relative to a square image's.
        let mut shown = aspect;
        if keep.is_finite() && keep > seen && seen > 0.0 {
            eye = target + away * (keep / seen);
            shown *= keep / seen;
        }
        let tan = tan.max((tan / shown).min(WIDENED_MAX));
        let tan_half = (tan * aspect, tan);
        let (eye, forward) = orbit.place(eye, target);
        let to_target = (target - eye).length();
        let stepped_back = to_target - away.length();
        // If the camera looks straight up or down, any horizontal direction can point to the right.
        let level = DVec3::Y.cross(forward).normalize_or(DVec3::X);
        let roll = if asked.roll.is_finite() { f64::from(asked.roll) } else { 0.0 };
        let right = DQuat::from_axis_angle(forward, roll) * level;
        let up = forward.cross(right);
        Self { position: eye, right, up, forward, tan_half, to_target, stepped_back }
    }

    /// Projects `point` into the image; each axis is -1..1 from edge to edge. `None` if `point` is behind the eye.
    pub fn project(&self, point: DVec3) -> Option<(f64, f64)> {
        let offset = point - self.position;
        let depth = offset.dot(self.forward);
        (depth > 1e-6).then(|| {
            let (x, y) = (offset.dot(self.right) / depth, offset.dot(self.up) / depth);
            (x / self.tan_half.0, y / self.tan_half.1)
        })
    }
}

pub(super) fn place(values: [f32; 3]) -> DVec3 {
    let finite =
        |value: f32| if value.is_finite() { f64::from(value).clamp(-PLACE_MAX, PLACE_MAX) } else { 0.0 };
    DVec3::from_array(values.map(finite))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Frame;
    use crate::frame::testing::{SPEAKERS, world_of};
    use mariana_music::Features;
    use proptest::prelude::*;

    #[test]
    fn both_speakers_are_in_view_at_every_window_shape() {
        let world = world_of(SPEAKERS);
        for shape in (-16..=16).map(|tenth| 10_f64.powf(f64::from(tenth) / 10.0)) {
            let size =
                if shape < 1.0 { (100, (100.0 / shape) as u32) } else { ((100.0 * shape) as u32, 100) };
            for time in (0..200).map(|second| f64::from(second) * 3.0) {
                let camera = Frame::new(&world, time, Features::default(), size).camera;
                for corner in 0..8 {
                    let pick =
                        |bit: u32, low: f64, high: f64| if corner >> bit & 1 == 0 { low } else { high };
                    let point = DVec3::new(pick(0, -7.2, 7.2), pick(1, 0.0, 6.4), pick(2, 7.8, 12.2));
                    let seen = camera.project(point);
                    assert!(
                        seen.is_some_and(|(x, y)| x.abs() <= 0.99 && y.abs() <= 0.99),
                        "{point} is at {seen:?}, {time} s, {size:?}"
                    );
                }
                assert!(camera.position.y > 0.5, "the eye is below the floor");
            }
        }
    }

    proptest! {
        #[test]
        fn the_axes_are_orthonormal_for_every_input(
            position in prop::array::uniform3(any::<f32>()),
            target in prop::array::uniform3(any::<f32>()),
            [fov, roll, keep] in prop::array::uniform3(any::<f32>()),
            shape in -4.0..4.2f64,
        ) {
            let asked = lang::Camera { position, target, fov, roll, keep, ..lang::Camera::of([]) };
            let camera = Camera::of(&asked, 10f64.powf(shape));
            for axis in [camera.right, camera.up, camera.forward] {
                prop_assert!((axis.length() - 1.0).abs() < 1e-6, "{camera:?}");
            }
            prop_assert!(camera.right.dot(camera.up).abs() < 1e-6);
            prop_assert!(camera.up.cross(camera.right).dot(camera.forward).abs() > 0.999);
            prop_assert!(camera.position.is_finite());
        }
    }

    #[test]
    fn a_narrow_image_cut_the_sides_of_the_subject() {
        let asked =
            lang::Camera { position: [0.0; 3], target: [0.0, 0.0, 4.0], fov: 45.0, ..lang::Camera::of([]) };
        let width = |camera: &Camera| 2.0 * camera.to_target * camera.tan_half.0;
        let square = Camera::of(&asked, 1.0);
        for aspect in [0.5625, 0.99] {
            let narrow = Camera::of(&asked, aspect);
            assert!((width(&narrow) - width(&square)).abs() < 1e-9, "{aspect}: {narrow:?}");
            assert_eq!((narrow.position, narrow.tan_half.0), (square.position, narrow.tan_half.1 * aspect));
            // A larger `keep` needs no wider view.
            let kept = Camera::of(&lang::Camera { keep: 8.0, ..asked.clone() }, aspect);
            assert!((width(&kept) - 8.0).abs() < 1e-6 && kept.tan_half.1 == square.tan_half.1, "{kept:?}");
        }
        assert_eq!(Camera::of(&asked, 2.0).tan_half, (2.0 * square.tan_half.1, square.tan_half.1));
        assert_eq!(Camera::of(&asked, 0.1).tan_half.1, WIDENED_MAX);
        let wide = lang::Camera { fov: 120.0, ..asked };
        assert_eq!(Camera::of(&wide, 0.5).tan_half.1, Camera::of(&wide, 2.0).tan_half.1);
    }

    #[test]
    fn the_image_is_not_mirrored_and_rolls_clockwise() {
        let asked = lang::Camera { target: [0.0, 0.0, 1.0], fov: 60.0, ..lang::Camera::of([]) };
        let camera = Camera::of(&asked, 1.6);
        let (right, _) = camera.project(DVec3::new(0.5, 0.0, 1.0)).unwrap();
        let (_, high) = camera.project(DVec3::new(0.0, 0.5, 1.0)).unwrap();
        assert!(right > 0.0 && high > 0.0);
        let rolled = Camera::of(&lang::Camera { roll: 0.5, ..asked }, 1.6);
        let (turned, _) = rolled.project(DVec3::new(0.0, 0.5, 1.0)).unwrap();
        assert!(turned > 0.0, "{turned}");
    }
}
