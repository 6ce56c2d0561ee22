//! The camera: a slow path around the speakers that keeps both in the picture at every window shape.

use glam::DVec3;

/// A pinhole camera. The axes are of unit length and at right angles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// The eye.
    pub position: DVec3,
    /// To the right in the picture.
    pub right: DVec3,
    /// Up in the picture.
    pub up: DVec3,
    /// Into the picture.
    pub forward: DVec3,
    /// Tangents of half the field of view, horizontal and vertical.
    pub tan_half: (f64, f64),
}

/// Tangent of half the vertical field of view: 40 degrees in all.
const TAN_HALF_VERTICAL: f64 = 0.363_970_234;
/// What the camera looks at: between the speakers, a little under their middle, so that the floor shows.
const TARGET: DVec3 = DVec3::new(0.0, 2.75, 10.0);
/// The box that stays in the picture: the speakers with the loudest woofer and the bridge.
pub const SUBJECT: (DVec3, DVec3) = (DVec3::new(-7.2, 0.0, 7.8), DVec3::new(7.2, 6.4, 12.2));
/// How much of the half picture the subject may take: the rest is margin.
const FILL: f64 = 0.9;
/// Farthest that the camera steps back for a tall window, in lengths of its path's distance.
const STEP_BACK_MAX: f64 = 100.0;

impl Camera {
    /// The camera at `time` seconds for a picture of `aspect` (width over height).
    ///
    /// The eye follows the slow curve of the thesis' program, but is aimed; where the subject would leave the
    /// picture it steps back along its line of sight. It is never lower than what it looks at, so that stepping
    /// back does not lead below the floor.
    pub fn around_speakers(time: f64, aspect: f64) -> Self {
        let eye = DVec3::new(
            5.0 * (0.2 * time).sin(),
            3.95 + 1.15 * (0.13 * time + 0.6).sin(),
            -7.5 + 2.0 * (0.1 * time).sin(),
        );
        let away = eye - TARGET;
        let at = |scale: f64| Self::looking_at(TARGET + away * scale, TARGET, aspect);
        if at(1.0).holds_subject() {
            return at(1.0);
        }
        let (mut near, mut far) = (1.0, STEP_BACK_MAX);
        for _ in 0..40 {
            let middle = 0.5 * (near + far);
            if at(middle).holds_subject() { far = middle } else { near = middle }
        }
        at(far)
    }

    /// A camera at `eye` that looks at `target`, upright.
    fn looking_at(eye: DVec3, target: DVec3, aspect: f64) -> Self {
        let forward = (target - eye).normalize_or(DVec3::Z);
        let right = DVec3::Y.cross(forward).normalize_or(DVec3::X);
        let up = forward.cross(right);
        let tan_half = (TAN_HALF_VERTICAL * aspect, TAN_HALF_VERTICAL);
        Self { position: eye, right, up, forward, tan_half }
    }

    /// Where `point` is in the picture, each axis -1..1 from edge to edge; none behind the eye.
    pub fn project(&self, point: DVec3) -> Option<(f64, f64)> {
        let offset = point - self.position;
        let depth = offset.dot(self.forward);
        (depth > 1e-6).then(|| {
            let (x, y) = (offset.dot(self.right) / depth, offset.dot(self.up) / depth);
            (x / self.tan_half.0, y / self.tan_half.1)
        })
    }

    fn holds_subject(&self) -> bool {
        let (low, high) = SUBJECT;
        (0..8).all(|corner| {
            let pick = |bit: u32, low: f64, high: f64| if corner >> bit & 1 == 0 { low } else { high };
            let point = DVec3::new(pick(0, low.x, high.x), pick(1, low.y, high.y), pick(2, low.z, high.z));
            self.project(point).is_some_and(|(x, y)| x.abs() <= FILL && y.abs() <= FILL)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn both_speakers_stay_in_the_picture(time in 0.0..10_000.0f64, shape in -1.6..1.6f64) {
            // Shapes from 1:40 to 40:1.
            let camera = Camera::around_speakers(time, 10f64.powf(shape));
            prop_assert!(camera.holds_subject());
        }

        #[test]
        fn the_axes_are_orthonormal_and_the_eye_is_above_the_floor(time in 0.0..10_000.0f64, shape in -4.0..4.2f64) {
            let camera = Camera::around_speakers(time, 10f64.powf(shape));
            for axis in [camera.right, camera.up, camera.forward] {
                prop_assert!((axis.length() - 1.0).abs() < 1e-9);
            }
            prop_assert!(camera.right.dot(camera.up).abs() < 1e-9);
            prop_assert!(camera.up.cross(camera.right).dot(camera.forward).abs() > 0.999);
            prop_assert!(camera.position.y > 0.5 && camera.position.is_finite());
        }
    }

    #[test]
    fn the_picture_is_not_mirrored() {
        let camera = Camera::around_speakers(0.0, 1.6);
        let (left, _) = camera.project(DVec3::new(-5.0, 3.0, 10.0)).unwrap();
        let (right, _) = camera.project(DVec3::new(5.0, 3.0, 10.0)).unwrap();
        assert!(left < 0.0 && right > 0.0);
        let (_, high) = camera.project(DVec3::new(0.0, 6.0, 10.0)).unwrap();
        assert!(high > 0.0);
    }
}
