//! Lights: their places and their fields.

use super::super::diagnostic::Diagnostic;
use super::super::scene::{Light, LightPlace};
use super::super::source::Span;
use super::Lowering;
use super::sections::Values;

impl Lowering<'_> {
    pub(super) fn light(&mut self, name: String, span: Span, values: &Values) -> Option<Light> {
        let (zero, one) = (self.constant(0.0), self.constant(1.0));
        let white = self.vector([1.0; 3]);
        let place = self.light_place(&name, span, values)?;
        Some(Light {
            name,
            place,
            color: self.vector_of(values, "color", white),
            radius: self.number_of(values, "radius", zero),
            range: self.number_of(values, "range", zero),
            shadow: self.number_of(values, "shadow", one),
        })
    }

    fn light_place(&mut self, name: &str, span: Span, values: &Values) -> Option<LightPlace> {
        let given = |field: &str| values.given(field).map(|(_, span)| span);
        let origin = self.vector([0.0; 3]);
        let (position, direction) = (given("position"), given("direction"));
        let wrong = match (position, direction, given("right"), given("up")) {
            (Some(_), None, None, None) => {
                return Some(LightPlace::At(self.vector_of(values, "position", origin)));
            }
            (None, Some(_), None, None) => {
                return Some(LightPlace::Towards(self.vector_of(values, "direction", origin)));
            }
            (Some(_), None, Some(_), Some(_)) => {
                return Some(LightPlace::Panel {
                    at: self.vector_of(values, "position", origin),
                    right: self.vector_of(values, "right", origin),
                    up: self.vector_of(values, "up", origin),
                });
            }
            (Some(_), Some(second), ..) => {
                let both = Diagnostic::new(
                    second,
                    format!("the light `{name}` has both a position and a direction"),
                );
                let hint = "a lamp has a `position`; what is infinitely far away, such as the sun, has a `direction`";
                both.hint(hint)
            }
            (None, Some(_), Some(side), _) | (None, Some(_), _, Some(side)) => {
                let sun = Diagnostic::new(side, format!("the light `{name}` has both a direction and sides"));
                sun.hint("a panel has a `position` in its middle; it shines to the side of cross(right, up)")
            }
            (_, _, Some(side), None) | (_, _, None, Some(side)) => {
                let half = Diagnostic::new(side, format!("the panel `{name}` has only one side"));
                half.hint("a panel needs `right` and `up`: half of each side, as a vector")
            }
            (None, None, ..) if values.broken => return None,
            (None, None, ..) => {
                let missing =
                    Diagnostic::new(span, format!("the light `{name}` has no position or direction"));
                missing.hint("write `position = vec3(…)` for a lamp or `direction = vec3(…)` for a sun")
            }
        };
        self.report(wrong);
        None
    }
}
