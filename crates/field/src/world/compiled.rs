//! A world as GLSL for the driver's compiler: the functions that `shaders/README.md` requires of a scene.

use std::fmt::Write as _;

use super::validate::validate;
use super::{World, WorldError};
use crate::graph::{Input, Node, NodeId};
use crate::lang::{Material, SURFACE_NUMBERS, material_members};
use crate::tape::glsl::{self, Sampling};

impl World {
    /// True if a program compiled for this world also draws `other`, because they differ only in hoisted values.
    pub fn is_compiled_like(&self, other: &Self) -> bool {
        let materials = |world: &Self| -> Vec<usize> {
            world.scene.objects.iter().map(|object| object.material).collect()
        };
        self.graph.is_same(&other.graph)
            && self.roots == other.roots
            && materials(self) == materials(other)
            && self.features == other.features
            && self.non_lipschitz == other.non_lipschitz
            && self.planes.len() == other.planes.len()
            && self.pictures.len() == other.pictures.len()
    }

    /// Returns the scene's functions as GLSL, validated by naga.
    ///
    /// # Errors
    /// Fails if the graph exceeds its limit, or if naga rejects the text, which is a bug in the generator.
    pub fn compiled_glsl(&self) -> Result<String, WorldError> {
        let generated = self.generated_functions()?;
        validate(&generated).map_err(|reason| WorldError::Refused { scene: self.name.clone(), reason })?;
        Ok(generated + &self.contract())
    }

    fn generated_functions(&self) -> Result<String, WorldError> {
        let graph = &self.graph;
        let roots = &self.roots;
        let numbers = self.material_numbers();
        let materials = roots.materials.iter().map(|material| &material[..numbers]).enumerate();
        let functions = [
            glsl::function(graph, &roots.distance, "rest_distance", Sampling::None),
            glsl::function(graph, &[roots.distance[1], roots.object], "rest_surface", Sampling::None),
            glsl::function(graph, &roots.sky, "sky", Sampling::AlongDirection),
            glsl::function(graph, &roots.ambient, "ambient", Sampling::AlongNormal),
            glsl::function(graph, &roots.glow, "glow", Sampling::AlongPosition),
        ]
        .into_iter()
        .chain(roots.medium.iter().map(|medium| glsl::function(graph, medium, "medium", Sampling::None)))
        .chain(materials.map(|(index, material)| {
            glsl::function(graph, material, &format!("material_{index}"), Sampling::AlongPosition)
        }));
        let functions: Result<Vec<String>, _> = functions.collect();
        let error = |source| WorldError::Graph { scene: self.name.clone(), source };
        let functions = functions.map_err(error)?.concat();
        let materials = roots.materials.iter().flat_map(|material| &material[..numbers]).copied();
        let all: Vec<NodeId> = roots.apart_from_materials().chain(materials).collect();
        let nodes = graph.order(&all).map_err(error)?.nodes;
        let inputs = nodes.into_iter().filter_map(|id| match graph.node(id) {
            Node::Input(Input::X | Input::Y | Input::Z | Input::NX | Input::NY | Input::NZ) => None,
            Node::Input(input) => Some(input),
            _ => None,
        });
        Ok(with_copies(functions, inputs))
    }

    /// The count of numbers that the shaders read from a material.
    fn material_numbers(&self) -> usize {
        if self.features.body() { Material::NUMBERS } else { SURFACE_NUMBERS }
    }

    fn contract(&self) -> String {
        let mut text = String::from(
            "vec2 scene_distance(vec3 p, float penumbra) {\n    vec2 d;\n    \
             rest_distance(p, vec3(penumbra, 0.0, 0.0), d.x, d.y);\n    return d;\n}\n\
             float scene_estimate(vec3 p, out float object) {\n    float d;\n    \
             rest_surface(p, vec3(SURFACE_PENUMBRA, 0.0, 0.0), d, object);\n    return d;\n}\n",
        );
        let pixel = "vec3(picture_pixel(), 0.0)";
        let steps = ", vec3(frame_screen.z, 0.0, 0.0), vec3(0.0, frame_screen.w, 0.0)";
        for (name, function, place, steps) in
            [("sky_color", "sky", pixel, steps), ("sky_ambient", "ambient", "vec3(0.0)", "")]
        {
            let _ = write!(
                text,
                "vec3 {name}(vec3 direction, vec3 dx, vec3 dy) {{\n    vec3 color;\n    {function}({place}, \
                 direction, dx, dy{steps}, color.r, color.g, color.b);\n    return color;\n}}\n"
            );
        }
        text.push_str(
            "vec4 scene_glow(vec3 p, vec3 dx, vec3 dy) {\n    vec4 light;\n    glow(p, vec3(0.0), dx, dy, light.r, light.g, \
             light.b, light.a);\n    return light;\n}\n",
        );
        if self.roots.medium.is_some() {
            text.push_str(
                "Medium scene_medium(vec3 p) {\n    Medium m;\n    medium(p, vec3(0.0), m.density, m.scattered.r, \
                 m.scattered.g, m.scattered.b, m.emitted.r, m.emitted.g, m.emitted.b, m.phase);\n    \
                 return m;\n}\n",
            );
        }
        text.push_str(
            "Material scene_material(int object, vec3 p, vec3 n, vec3 dx, vec3 dy) {\n    Material m;\n    ",
        );
        let members = material_members("m")[..self.material_numbers()].join(", ");
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

/// Replaces the frame block's members in the functions by names for these inputs. On llvmpipe the names are
/// copies that `scene_load` makes (see `shaders/frame_block.glsl`). On GPUs the names are the members themselves.
fn with_copies(mut functions: String, inputs: impl Iterator<Item = Input>) -> String {
    let (mut copies, mut names) = (String::new(), String::new());
    let mut load = String::from("void scene_load() {\n");
    for (number, input) in inputs.enumerate() {
        let name = glsl::input_name(input);
        functions = functions.replace(&name, &format!("input_{number}"));
        let _ = writeln!(copies, "float input_{number};");
        let _ = writeln!(names, "#define input_{number} {name}");
        let _ = writeln!(load, "    input_{number} = {name};");
    }
    format!("#ifdef SOFTWARE\n{copies}{load}}}\n#else\n{names}void scene_load() {{}}\n#endif\n{functions}")
}
