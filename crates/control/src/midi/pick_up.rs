//! Knobs that stand elsewhere than what they turn: they take hold when they pass it, so that nothing jumps.

/// A knob this near to what it turns, as a share of the way, has it: a little more than a step of 128.
const NEAR: f32 = 0.012;

/// What is known of one knob and one thing that it turns. All places are shares of the way, 0..1.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct PickUp {
    /// Where the knob was.
    last: Option<f32>,
    /// Where it put what it turns; none while it has no hold of it.
    put: Option<f32>,
}

impl PickUp {
    /// Whether a knob that moved to `knob`, by a way with these ends, turns what stands at `stands`.
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
    fn a_knob_takes_hold_where_it_passes_and_keeps_it_until_another_hand_comes() {
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
        assert!(turn(0.6, &mut stands), "it has passed");
        assert!(turn(0.9, &mut stands) && turn(0.2, &mut stands), "and has hold of it");
        // A slider puts it elsewhere.
        stands = 0.7;
        assert!(!turn(0.25, &mut stands) && !turn(0.6, &mut stands));
        assert!(turn(0.695, &mut stands), "near enough");
    }

    #[test]
    fn the_first_move_takes_hold_only_where_it_is_near() {
        assert!(PickUp::default().takes(0.505, [0.505; 2], 0.5));
        assert!(!PickUp::default().takes(0.6, [0.6; 2], 0.5));
    }
}
