//! The kinds of lights.

use super::super::diagnostic::Diagnostic;
use super::super::scene::LightKind;
use super::super::source::Span;
use super::super::value::Value;
use super::scene::SceneBuilder;
use super::sections::Values;

impl SceneBuilder<'_> {
    /// Returns the kind of a light, determined by the fields that are set. Reports invalid combinations of fields.
    pub(super) fn light_kind(&mut self, name: &str, span: Span, values: &Values) -> Option<LightKind> {
        let given = |field: &str| values.given(field).map(|(_, span)| span);
        let wrong = match (given("position"), given("direction"), given("right"), given("up")) {
            (Some(_), None, None, None) => return Some(LightKind::Lamp),
            (None, Some(_), None, None) => {
                self.warn_of_rising_light(values);
                return Some(LightKind::Sun);
            }
            (Some(_), None, Some(_), Some(_)) => return Some(LightKind::Panel),
            (Some(_), Some(second), ..) => {
                let both = Diagnostic::new(
                    second,
                    format!("the light `{name}` has both a position and a direction"),
                );
                let hint = "a lamp has a `position`; a light at infinity, such as the sun, has a `direction`";
                both.hint(hint)
            }
            (None, Some(_), Some(side), _) | (None, Some(_), _, Some(side)) => {
                let sun = Diagnostic::new(side, format!("the light `{name}` has both a direction and sides"));
                sun.hint("a panel has a `position`, its centre, and shines towards cross(right, up)")
            }
            (_, _, Some(side), None) | (_, _, None, Some(side)) => {
                let half =
                    Diagnostic::new(side, format!("the panel `{name}` has only one of `right` and `up`"));
                half.hint(
                    "set both: the vectors from the centre to the middle of the right and of the upper side",
                )
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

    /// Notes a sun whose light always rises, which leaves floors and the tops of objects dark.
    fn warn_of_rising_light(&mut self, values: &Values) {
        if let Some((Value::Vector(direction), span)) = values.given("direction")
            && direction.len() == 3
            && self.lowering.known(direction.part(1)).is_some_and(|y| y > 0.0)
        {
            self.parts.rising.push(span);
        }
    }

    /// Warns if the light of all lights rises. One such light among others may be intended.
    pub(super) fn warn_of_light_from_below(&mut self) {
        if self.parts.rising.len() < self.parts.lights.len() {
            return;
        }
        for span in std::mem::take(&mut self.parts.rising) {
            let warning = Diagnostic::warning(span, "this sun shines from below");
            self.lowering.reports.diagnostics.warn(warning.hint(
                "`direction` is the direction in which the light travels: for a sun in the sky, its y is negative",
            ));
        }
    }
}
