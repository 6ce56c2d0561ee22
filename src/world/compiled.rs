//! A world as GLSL that the driver compiles: the functions that `shaders/README.md` asks of a scene.

use std::fmt::Write as _;

use super::validate::validate;
use super::{MATERIAL_OUTPUTS, World, WorldError};
use crate::tape::glsl::{self, Sampling};

impl World {
    /// The scene's functions as GLSL, validated by naga.
    ///
    /// # Errors
    /// A graph over its limit; text that naga refuses, which is a fault of the generator.
    pub fn compiled_glsl(&self) -> Result<String, WorldError> {
        let generated = self.generated_functions()?;
        validate(&generated).map_err(|reason| WorldError::Refused { scene: self.name.clone(), reason })?;
        Ok(generated + &self.contract())
    }

    /// A function for each set of roots.
    fn generated_functions(&self) -> Result<String, WorldError> {
        let graph = &self.graph;
        let roots = &self.roots;
        let materials = roots.materials.iter().enumerate();
        let functions = [
            glsl::function(graph, &roots.distance, "rest_distance", Sampling::None),
            glsl::function(graph, &[roots.object], "rest_object", Sampling::None),
            glsl::function(graph, &roots.sky, "sky", Sampling::AlongNormal),
            glsl::function(graph, &roots.ambient, "ambient", Sampling::AlongNormal),
        ]
        .into_iter()
        .chain(materials.map(|(index, material)| {
            glsl::function(graph, material, &format!("material_{index}"), Sampling::AlongPosition)
        }));
        let functions: Result<Vec<String>, _> = functions.collect();
        functions
            .map(|functions| functions.concat())
            .map_err(|source| WorldError::Graph { scene: self.name.clone(), source })
    }

    /// What the renderer's shaders call.
    fn contract(&self) -> String {
        let mut text = String::from(
            "vec2 scene_distance(vec3 p, float penumbra) {\n    vec2 d;\n    \
             rest_distance(p, vec3(penumbra, 0.0, 0.0), d.x, d.y);\n    return d;\n}\n\
             vec4 scene_estimates(vec4 x, vec4 y, vec4 z) {\n    vec4 estimates;\n    \
             for (int i = 0; i < 4; i++) {\n        \
             estimates[i] = scene_distance(vec3(x[i], y[i], z[i]), 0.0).y;\n    }\n    return estimates;\n}\n\
             int scene_object(vec3 p) {\n    return int(rest_object(p, vec3(0.0)) + 0.5);\n}\n",
        );
        for (name, function) in [("sky_color", "sky"), ("sky_ambient", "ambient")] {
            let _ = write!(
                text,
                "vec3 {name}(vec3 direction, vec3 dx, vec3 dy) {{\n    vec3 color;\n    {function}(vec3(0.0), \
                 direction, dx, dy, color.r, color.g, color.b);\n    return color;\n}}\n"
            );
        }
        text.push_str(
            "Material scene_material(int object, vec3 p, vec3 n, vec3 dx, vec3 dy) {\n    Material m;\n    ",
        );
        let members: Vec<String> = MATERIAL_OUTPUTS.iter().map(|output| format!("m.{output}")).collect();
        let members = members.join(", ");
        for material in 0..self.roots.materials.len() {
            let objects = self.scene.objects.iter().enumerate();
            let of_it: Vec<String> = objects
                .filter(|(_, object)| object.material == material)
                .map(|(index, _)| format!("object == {index}"))
                .collect();
            let last = material + 1 == self.roots.materials.len();
            match (of_it.is_empty(), last) {
                (true, false) => continue,
                (_, true) => text.push_str("{\n"),
                (false, false) => {
                    let _ = writeln!(text, "if ({}) {{", of_it.join(" || "));
                }
            }
            let _ = write!(text, "        material_{material}(p, n, dx, dy, {members});\n    }}");
            text.push_str(if last { "\n" } else { " else " });
        }
        text.push_str("    return m;\n}\n");
        text
    }
}
