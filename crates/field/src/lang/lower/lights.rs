//! Lights: what kind of light the fields say.

use super::super::diagnostic::Diagnostic;
use super::super::scene::LightKind;
use super::super::source::Span;
use super::scene::SceneBuilder;
use super::sections::Values;

impl SceneBuilder<'_> {
    /// The kind of a light, by which of its fields are given.
    pub(super) fn light_kind(&mut self, name: &str, span: Span, values: &Values) -> Option<LightKind> {
        let given = |field: &str| values.given(field).map(|(_, span)| span);
        let wrong = match (given("position"), given("direction"), given("right"), given("up")) {
            (Some(_), None, None, None) => return Some(LightKind::Lamp),
            (None, Some(_), None, None) => return Some(LightKind::Sun),
            (Some(_), None, Some(_), Some(_)) => return Some(LightKind::Panel),
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
        self.lowering.reports.add(wrong);
        None
    }
}
