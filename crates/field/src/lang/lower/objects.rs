//! Objects, and the field `melt`, which merges an object with the previous one.
//!
//! Melting happens entirely in this module: the merged object has one shape and one material, and shaders need no
//! code for it.

use super::super::diagnostic::Diagnostic;
use super::super::material::Material;
use super::super::scene::Object;
use super::super::source::Span;
use super::super::value::Value;
use super::scene::SceneBuilder;
use super::sections::Values;
use crate::graph::{Graph, NodeId};

impl SceneBuilder<'_> {
    pub(super) fn object(&mut self, name: String, span: Span, values: &Values) {
        let material = match (values.material, values.given("material")) {
            (Some(index), _) => index,
            (None, Some(_)) => return,
            (None, None) => self.default_material(),
        };
        let shape = match values.given("shape") {
            Some((Value::Vector(shape), _)) => shape.first(),
            Some(_) => return,
            None if values.broken => return,
            None => {
                let missing = Diagnostic::new(span, format!("the object `{name}` has no shape"));
                self.lowering
                    .reports
                    .add(missing.hint("write `shape = sphere(p, 1)`, or any other distance"));
                return;
            }
        };
        let trust = values.given("trust").map(|_| self.lowering.number_of(values, "trust", shape));
        let shape = trust.map_or(shape, |trust| self.lowering.graph.mul(shape, trust));
        let bound = values.given("bound").map(|_| self.lowering.number_of(values, "bound", shape));
        let object = Object { name, span, shape, bound, material, trusted: trust.is_some() };
        let Some((_, melts)) = values.given("melt") else { return self.add_object(object) };
        let radius = self.lowering.number_of(values, "melt", shape);
        match self.parts.objects.pop() {
            Some(before) => {
                if let Some(both) = self.melted(before, object, radius) {
                    self.parts.objects.push(both);
                }
            }
            None => {
                let alone = Diagnostic::new(
                    melts,
                    format!("the object `{}` has no previous object to melt into", object.name),
                );
                self.lowering
                    .reports
                    .add(alone.hint("declare another object before it, or leave out `melt`"));
            }
        }
    }

    /// Blends the shapes, and mixes the materials where the distances to both shapes differ by less than `radius`.
    /// Where they are equal, half of each material is used.
    fn melted(&mut self, a: Object, b: Object, radius: NodeId) -> Option<Object> {
        let tiny = self.lowering.constant(1e-4);
        let radius = self.lowering.graph.max(radius, tiny);
        let shape = self.lowering.library_number("smooth_union", &[a.shape, b.shape, radius])?;
        let bound = match (a.bound, b.bound) {
            (Some(a), Some(b)) => Some(self.lowering.graph.min(a, b)),
            (a, b) => a.or(b),
        };
        let material = if a.material == b.material {
            a.material
        } else {
            let max = self.lowering.limits.scene_materials_max;
            if self.parts.materials.len() >= max {
                let message =
                    format!("the scene has more than {max} materials, including mixtures made by `melt`");
                self.lowering.reports.stop(b.span, message, "use one material whose fields depend on `p`");
                return None;
            }
            let difference = self.lowering.graph.sub(a.shape, b.shape);
            let fraction = self.lowering.graph.div(difference, radius);
            let (zero, half, one) =
                (self.lowering.constant(0.0), self.lowering.constant(0.5), self.lowering.constant(1.0));
            let fraction = self.lowering.graph.mul(fraction, half);
            let fraction = self.lowering.graph.add(fraction, half);
            let fraction = self.lowering.graph.clamp(fraction, zero, one);
            let (one, other) = (self.parts.materials.get(a.material)?, self.parts.materials.get(b.material)?);
            let mixed = mixed(&mut self.lowering.graph, one, other, fraction);
            self.lowering.origins.of_mixture(self.parts.materials.len(), [a.material, b.material]);
            self.parts.materials.push(mixed);
            self.parts.materials.len() - 1
        };
        let name = format!("{} and {}", a.name, b.name);
        Some(Object { name, span: a.span, shape, bound, material, trusted: a.trusted || b.trusted })
    }
}

/// Mixes two materials. At fraction 0 the result is the first material.
fn mixed(graph: &mut Graph, a: &Material, b: &Material, fraction: NodeId) -> Material {
    let both: Vec<_> = a.numbers().into_iter().zip(b.numbers()).collect();
    let mixed = both.into_iter().map(|(a, b)| graph.mix(a, b, fraction));
    Material::of(format!("{} and {}", a.name, b.name), mixed)
}
