//! Orbit controls: the user turns and zooms the view around the point that the scene's camera looks at.
//!
//! They apply on top of the scene's camera, which may keep moving. `eye` in materials and the sky follows the controls.
//! Regions, bounds, planes and the formulas of the camera path ignore the controls.

use glam::DVec3;

/// A rotation around the camera's target and a change of the distance to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OrbitControls {
    /// Rotation around the vertical in degrees; positive values move the eye to the left.
    yaw: f32,
    pitch: f32,
    zoom: f32,
}

/// Degrees per drag of one image height.
const TURN: f64 = 180.0;
/// Largest angle from the horizon in degrees. It keeps the eye away from the poles.
const PITCH_MAX: f64 = 0.49 * 180.0;
/// Each notch of the wheel multiplies the distance by e to this power.
const NOTCH: f64 = 0.12;
const ZOOM: (f64, f64) = (1.0 / 64.0, 64.0);
/// Pointer movements of this size or more are ignored.
const WAY_MAX: f64 = 1e6;
const REACH_MAX: f64 = 1e7;

impl Default for OrbitControls {
    fn default() -> Self {
        Self::OFF
    }
}

impl OrbitControls {
    /// The scene's own camera, unchanged.
    pub const OFF: Self = Self { yaw: 0.0, pitch: 0.0, zoom: 1.0 };

    /// Rotates by a pointer movement to the right and downwards, in image heights, as if the user dragged the target.
    /// `own` is the pitch of the scene's camera ([`OrbitControls::pitch_of`]).
    pub fn drag(&mut self, right: f64, down: f64, own: f64) {
        if !(right.abs() < WAY_MAX && down.abs() < WAY_MAX) {
            return;
        }
        self.yaw = ((f64::from(self.yaw) + TURN * right) % 360.0) as f32;
        let own = own.to_degrees().clamp(-PITCH_MAX, PITCH_MAX);
        let pitch = f64::from(self.pitch) + TURN * down;
        self.pitch = pitch.clamp(-PITCH_MAX - own, PITCH_MAX - own) as f32;
    }

    /// Zooms in by this many notches of a wheel.
    pub fn zoom(&mut self, notches: f64) {
        if notches.is_finite() {
            let zoom = f64::from(self.zoom) * (-NOTCH * notches).exp();
            self.zoom = zoom.clamp(ZOOM.0, ZOOM.1) as f32;
        }
    }

    /// Yaw and pitch in degrees, and the factor of the distance.
    pub fn turns(&self) -> [f32; 3] {
        [self.yaw, self.pitch, self.zoom]
    }

    /// Controls from [`OrbitControls::turns`], clamped to their ranges. Numbers that are not finite have no effect.
    pub fn of_turns([yaw, pitch, zoom]: [f32; 3]) -> Self {
        let turn = |turn: f32| if turn.is_finite() { turn % 360.0 } else { 0.0 };
        let zoom = if zoom.is_finite() { zoom.clamp(ZOOM.0 as f32, ZOOM.1 as f32) } else { 1.0 };
        Self { yaw: turn(yaw), pitch: turn(pitch).clamp(-180.0, 180.0), zoom }
    }

    /// The angle in radians by which a camera is above its target.
    pub fn pitch_of(eye: DVec3, target: DVec3) -> f64 {
        (eye - target).normalize_or(DVec3::NEG_Z).y.clamp(-1.0, 1.0).asin()
    }

    /// Turns and zooms a scene's `eye` around `target`. Returns the new eye and the direction of its view. If `eye` is
    /// at `target`, only the direction changes.
    pub(super) fn place(&self, eye: DVec3, target: DVec3) -> (DVec3, DVec3) {
        let away = eye - target;
        let forward = (-away).normalize_or(DVec3::Z);
        if *self == Self::OFF {
            return (eye, forward);
        }
        let reach = (away.length() * f64::from(self.zoom)).min(REACH_MAX);
        let mut back = -forward;
        if (self.yaw, self.pitch) != (0.0, 0.0) {
            let most = PITCH_MAX.to_radians();
            let yaw = back.x.atan2(back.z) + f64::from(self.yaw).to_radians();
            let pitch = Self::pitch_of(back, DVec3::ZERO) + f64::from(self.pitch).to_radians();
            let pitch = pitch.clamp(-most, most);
            back = DVec3::new(pitch.cos() * yaw.sin(), pitch.sin(), pitch.cos() * yaw.cos());
        }
        (target + reach * back, -back)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::frame::camera::Camera;
    use mariana_field::lang;

    fn asked() -> lang::Camera<f32> {
        lang::Camera {
            position: [1.0, 2.0, -6.0],
            target: [0.5, 1.0, 2.0],
            fov: 50.0,
            ..lang::Camera::of([])
        }
    }

    fn seen(orbit: &OrbitControls, point: DVec3) -> (f64, f64) {
        Camera::by_hand(&asked(), 1.6, orbit).project(point).unwrap()
    }

    #[test]
    fn near_points_follow_the_pointer_and_the_target_stays() {
        let target = DVec3::new(0.5, 1.0, 2.0);
        let near = target + 0.2 * (DVec3::new(1.0, 2.0, -6.0) - target);
        let before = seen(&OrbitControls::OFF, near);
        let mut orbit = OrbitControls::OFF;
        orbit.drag(0.05, 0.0, 0.0);
        assert!(seen(&orbit, near).0 > before.0 + 0.01, "to the right");
        let mut orbit = OrbitControls::OFF;
        orbit.drag(0.0, 0.05, 0.0);
        assert!(seen(&orbit, near).1 < before.1 - 0.01, "down");
        orbit.drag(0.3, 0.1, 0.0);
        orbit.zoom(2.5);
        let (x, y) = seen(&orbit, target);
        assert!(x.abs() < 1e-9 && y.abs() < 1e-9, "the target is at {x}, {y}");
    }

    #[test]
    fn the_wheel_zooms_smoothly_and_within_its_limits() {
        let reach = |orbit: &OrbitControls| {
            (Camera::by_hand(&asked(), 1.6, orbit).position - DVec3::new(0.5, 1.0, 2.0)).length()
        };
        let own = reach(&OrbitControls::OFF);
        let mut orbit = OrbitControls::OFF;
        orbit.zoom(1.0);
        assert!((0.85..0.95).contains(&(reach(&orbit) / own)));
        orbit.zoom(-0.5);
        orbit.zoom(-0.5);
        assert!((reach(&orbit) / own - 1.0).abs() < 1e-9, "back again");
        orbit.zoom(1e9);
        assert!((reach(&orbit) / own - 1.0 / 64.0).abs() < 1e-9);
        orbit.zoom(-1e9);
        assert!((reach(&orbit) / own - 64.0).abs() < 1e-6);
    }

    #[test]
    fn a_drag_beyond_the_pole_returns_without_delay() {
        let eye = DVec3::new(0.0, 3.0, -3.0);
        let own = OrbitControls::pitch_of(eye, DVec3::ZERO);
        let mut orbit = OrbitControls::OFF;
        orbit.drag(0.0, 50.0, own);
        let height =
            |orbit: &OrbitControls| OrbitControls::pitch_of(orbit.place(eye, DVec3::ZERO).0, DVec3::ZERO);
        assert!((height(&orbit).to_degrees() - PITCH_MAX).abs() < 1e-4);
        orbit.drag(0.0, -0.1, own);
        assert!((height(&orbit).to_degrees() - (PITCH_MAX - 0.1 * TURN)).abs() < 1e-4);
    }

    proptest! {
        #[test]
        fn every_input_gives_a_valid_camera(
            position in prop::array::uniform3(any::<f32>()),
            target in prop::array::uniform3(any::<f32>()),
            moves in prop::collection::vec((any::<f64>(), any::<f64>(), any::<f64>()), 0..6),
            same in any::<bool>(),
        ) {
            let target = if same { position } else { target };
            let asked = lang::Camera { position, target, fov: 50.0, ..lang::Camera::of([]) };
            let mut orbit = OrbitControls::OFF;
            for (right, down, notches) in moves {
                orbit.drag(right, down, 0.3);
                orbit.zoom(notches);
            }
            let camera = Camera::by_hand(&asked, 1.6, &orbit);
            prop_assert!(camera.position.is_finite());
            for axis in [camera.right, camera.up, camera.forward] {
                prop_assert!((axis.length() - 1.0).abs() < 1e-6, "{camera:?}");
            }
            prop_assert!(camera.right.dot(camera.up).abs() < 1e-6);
            prop_assert_eq!(Camera::by_hand(&asked, 1.6, &OrbitControls::OFF), Camera::of(&asked, 1.6));
        }
    }
}
