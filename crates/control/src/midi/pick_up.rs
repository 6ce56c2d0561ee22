//! Pick-up of knobs: a knob has no effect until it passes the parameter's value, so that the value never jumps.

/// A knob within this distance of the value picks up the parameter. The distance is a fraction of the range, slightly
/// over one 7-bit step.
const NEAR: f32 = 0.012;

/// The state of one mapping. All values are fractions of the range, 0..1.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct PickUp {
    last: Option<f32>,
    /// The value that the knob set last; `None` until the knob picks up the parameter.
    put: Option<f32>,
}

impl PickUp {
    /// Returns true if a knob that moved to `knob` sets a parameter whose value is `stands`. `way` has the smallest and
    /// the largest value of the movement.
    pub(super) fn takes(&mut self, knob: f32, way: [f32; 2], stands: f32) -> bool {
        let has_hold = self.put.is_some_and(|put| (put - stands).abs() <= NEAR);
        let ends = || way.into_iter().chain([knob]).chain(self.last);
        let passes = ends().any(|end| end <= stands) && ends().any(|end| end >= stands);
        self.last = Some(knob);
        let takes = has_hold || passes || (knob - stands).abs() <= NEAR;
        self.put = takes.then_some(knob);
        takes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_knob_takes_hold_until_another_controller_moves_the_parameter() {
        let mut knob = PickUp::default();
        let mut stands = 0.5;
        let mut turn = |to: f32, stands: &mut f32| {
            let takes = knob.takes(to, [to; 2], *stands);
            if takes {
                *stands = to;
            }
            takes
        };
        assert!(!turn(0.1, &mut stands) && !turn(0.4, &mut stands));
        assert!(turn(0.6, &mut stands), "the knob has passed the value");
        assert!(turn(0.9, &mut stands) && turn(0.2, &mut stands), "and keeps its hold");
        stands = 0.7;
        assert!(!turn(0.25, &mut stands) && !turn(0.6, &mut stands));
        assert!(turn(0.695, &mut stands), "the knob is close enough");
    }

    #[test]
    fn the_first_movement_takes_hold_only_if_close() {
        assert!(PickUp::default().takes(0.505, [0.505; 2], 0.5));
        assert!(!PickUp::default().takes(0.6, [0.6; 2], 0.5));
    }
}
