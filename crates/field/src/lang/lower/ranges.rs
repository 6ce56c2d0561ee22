//! Warnings of numbers that a field's range excludes, and of fields that need another field.

use super::super::ast::Section;
use super::super::diagnostic::Diagnostic;
use super::super::fields::Field;
use super::super::value::Value;
use super::scene::SceneBuilder;
use super::sections::{Values, fields};
use crate::graph::NodeId;

/// Fields that cannot be seen unless one of others is above 0.
const NEEDS: &[(Section, &str, &[&str])] = &[
    (Section::Material, "film", &["reflect", "metalness"]),
    (Section::Material, "blur", &["reflect", "glass"]),
    (Section::Material, "ior", &["glass"]),
    (Section::Material, "absorb", &["glass"]),
    (Section::Material, "depth", &["translucent"]),
    (Section::Medium, "density", &["density", "emission"]),
    (Section::Medium, "color", &["density"]),
    (Section::Medium, "scatter", &["density"]),
    (Section::Medium, "phase", &["density"]),
    (Section::Swarm, "size", &["size", "glow"]),
    (Section::Swarm, "color", &["size"]),
    (Section::Swarm, "emission", &["size"]),
    (Section::Swarm, "glow", &["reach"]),
    (Section::Swarm, "reach", &["glow"]),
    (Section::Camera, "focus", &["aperture"]),
    (Section::Sky, "bounce", &["reach"]),
];

impl SceneBuilder<'_> {
    /// Warns of constants that are clamped to another value, and of fields without the field that they need.
    ///
    /// Numbers that are being edited are no constants here, and so remain inputs.
    pub(super) fn warn_of_values(&mut self, section: Section, values: &Values) {
        let mut warnings = Vec::new();
        for field in fields(section) {
            let Some((Value::Vector(value), span)) = values.given(field.name) else { continue };
            let name = field.name;
            let clamped = field.range.and_then(|range| {
                let numbers = value.parts().iter().filter_map(|part| self.lowering.graph.as_constant(*part));
                let mut clamped = numbers.map(|number| (number, range.clamp(number)));
                clamped
                    .find(|(number, clamped)| !number.is_nan() && number != clamped)
                    .map(|found| (range, found))
            });
            if let Some((range, (number, clamped))) = clamped {
                let message = format!("`{name}` cannot be {number}: it counts as {clamped}");
                let screen = if field.is_color() && number > 1.0 {
                    "; colours of 0 to 255 become light by `srgb(vec3(255, 0, 0) / 255)`"
                } else {
                    ""
                };
                warnings
                    .push(Diagnostic::warning(span, message).hint(format!("write a number {range}{screen}")));
            }
            for (_, _, needs) in NEEDS.iter().filter(|row| row.0 == section && row.1 == name) {
                if needs.iter().any(|need| self.may_be_positive(section, need, values)) {
                    continue;
                }
                let others = needs.iter().filter(|need| **need != name);
                let all: Vec<String> = others.map(|need| format!("`{need}`")).collect();
                let message = format!("`{name}` shows nothing without {} above 0", all.join(" or "));
                let hint = format!("set {}, or remove `{name}`", all.join(" or "));
                warnings.push(Diagnostic::warning(span, message).hint(hint));
            }
        }
        for warning in warnings {
            self.lowering.reports.diagnostics.warn(warning);
        }
    }

    /// False if all numbers of a field are constants that are not above 0.
    fn may_be_positive(&mut self, section: Section, name: &str, values: &Values) -> bool {
        let field: Vec<Field> = fields(section).iter().filter(|field| field.name == name).copied().collect();
        let numbers: Vec<NodeId> = self.lowering.numbers(&field, values);
        let graph = &self.lowering.graph;
        numbers.into_iter().any(|number| graph.as_constant(number).is_none_or(|number| number > 0.0))
    }
}
