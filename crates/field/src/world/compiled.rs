//! A world as GLSL for the driver's compiler: the functions that `shaders/README.md` requires of a scene.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use naga::front::glsl::{Frontend, Options};
use naga::valid::{Capabilities, ValidationFlags, Validator};

use super::feedback::Feedback;
use super::hoist::Hoisted;
use super::motions::Motions;
use super::planes::Plane;
use super::{World, WorldError};
use crate::graph::{
    CELL_HASH_GLSL, FrameInputs, Input, LEVEL_COUNT, Node, NodeId, ScreenInput, SoundInput, levels_glsl,
};
use crate::lang::{
    Camera, Light, LightKind, Material, Picture, SURFACE_NUMBERS, Scene, Sky, material_members,
};
use crate::limits::LIMITS;
use crate::tape::glsl::{self, Sampling};

/// A function of the compiled program.
pub(super) struct CompiledFunction {
    name: String,
    pub(super) roots: Vec<NodeId>,
    sampling: Sampling,
}

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
        let generated = self.generated_functions();
        validate(&generated).map_err(|reason| WorldError::Refused { scene: self.name.clone(), reason })?;
        Ok(generated + &self.contract())
    }

    /// The functions of the compiled program.
    pub(super) fn functions(&self) -> Vec<CompiledFunction> {
        let roots = &self.roots;
        let function = |name: &str, roots: &[NodeId], sampling: Sampling| CompiledFunction {
            name: name.to_owned(),
            roots: roots.to_vec(),
            sampling,
        };
        let mut functions = vec![
            function("rest_distance", &roots.distance, Sampling::None),
            function("rest_surface", &[roots.distance[1], roots.object], Sampling::None),
            function("sky", &roots.sky, Sampling::AlongDirection),
            function("ambient", &roots.ambient, Sampling::AlongNormal),
            function("glow", &roots.glow, Sampling::AlongPosition),
        ];
        functions.extend(roots.medium.iter().map(|medium| function("medium", medium, Sampling::None)));
        let materials = roots.materials.iter().enumerate();
        functions.extend(materials.map(|(index, material)| {
            let numbers = &material[..self.material_numbers()];
            function(&format!("material_{index}"), numbers, Sampling::AlongPosition)
        }));
        functions
    }

    fn generated_functions(&self) -> String {
        let graph = &self.graph;
        let functions = self.functions();
        let written = functions.iter().map(|of| glsl::function(graph, &of.roots, &of.name, of.sampling));
        let written = written.collect();
        let all: Vec<NodeId> = functions.into_iter().flat_map(|of| of.roots).collect();
        let inputs = graph.order(&all).into_iter().filter_map(|id| match graph.node(id) {
            Node::Input(input) if input.of_point().is_none() => Some(input),
            _ => None,
        });
        with_copies(written, inputs)
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
        let sole = match self.graph.node(self.roots.object) {
            Node::Constant(number) => number,
            _ => -1.0,
        };
        let _ = writeln!(text, "const float SOLE_OBJECT = {sole:?};");
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

// Values that the CPU computes once per frame because they do not depend on the point: camera, lights and planes.

/// The numbers of the cameras, the lights, the picture and the planes, and those with inertia.
#[derive(Debug, Clone)]
pub struct FrameTape {
    /// The sky's reach and bounce, then the numbers of the camera, of the named cameras, of the picture and of the
    /// lights.
    numbers: Hoisted,
    cameras: usize,
    lights: Vec<LightKind>,
    planes: Hoisted,
    /// How frames depend on earlier frames; `None` if they do not.
    pub feedback: Option<Feedback>,
    /// The numbers with inertia.
    pub motions: Motions,
    /// The numbers of the picture and the pointer that the sky and the picture's settings read.
    pub screen_inputs: BTreeSet<ScreenInput>,
}

/// The scene's values in one frame, which may be infinite or NaN. The sky's values are in their ranges.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameValues {
    /// The camera.
    pub camera: Camera<f32>,
    /// The named cameras.
    pub cameras: Vec<Camera<f32>>,
    /// The distance within which objects block ambient light.
    pub reach: f32,
    /// The fraction of light that objects within this distance throw on each other.
    pub bounce: f32,
    /// The settings of the image.
    pub picture: Picture<f32>,
    /// The lights.
    pub lights: Vec<Light<f32>>,
    /// The planes: `[a, b, c, d]` of `a*x + b*y + c*z + d`.
    pub planes: Vec<[f32; 4]>,
}

impl FrameTape {
    pub(super) fn new(scene: &Scene, planes: &[Plane]) -> Self {
        let cameras = std::iter::once(&scene.camera).chain(scene.cameras.iter().map(|(_, camera)| camera));
        let mut numbers = vec![scene.sky.reach, scene.sky.bounce];
        numbers.extend(cameras.flat_map(Camera::numbers));
        numbers.extend(scene.picture.numbers());
        numbers.extend(scene.lights.iter().flat_map(Light::numbers));
        let planes: Vec<NodeId> = planes.iter().map(|plane| plane.shape).collect();
        Self {
            numbers: Hoisted::of(&scene.graph, &numbers),
            cameras: scene.cameras.len(),
            lights: scene.lights.iter().map(|light| light.kind).collect(),
            planes: Hoisted::of(&scene.graph, &planes),
            feedback: Feedback::of(scene),
            motions: Motions::of(&scene.graph),
            screen_inputs: screen_inputs(scene),
        }
    }

    /// Computes the values of a frame.
    pub fn values(&self, inputs: &FrameInputs) -> FrameValues {
        let mut numbers = self.numbers.at([0.0; 3], inputs).into_iter();
        let [reach, bounce] = [(); 2].map(|()| numbers.next().unwrap_or_default());
        let sky = Sky { color: [0.0; 3], ambient: [0.0; 3], reach, bounce };
        let sky = sky.in_ranges(|number, range| range.clamp(number));
        let places = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let [d, a, b, c] = places.map(|place| self.planes.at(place, inputs));
        FrameValues {
            camera: Camera::of(&mut numbers),
            cameras: (0..self.cameras).map(|_| Camera::of(&mut numbers)).collect(),
            reach: sky.reach,
            bounce: sky.bounce,
            picture: Picture::of(&mut numbers),
            lights: self.lights.iter().map(|kind| Light::of(*kind, &mut numbers)).collect(),
            planes: (0..d.len()).map(|i| [a[i] - d[i], b[i] - d[i], c[i] - d[i], d[i]]).collect(),
        }
    }
}

fn screen_inputs(scene: &Scene) -> BTreeSet<ScreenInput> {
    let roots: Vec<NodeId> = scene.sky.color.into_iter().chain(scene.picture.numbers()).collect();
    let of_screen = |input: &Input| match input {
        Input::Screen(input) => Some(*input),
        _ => None,
    };
    scene.graph.inputs_used(&roots).inputs.iter().filter_map(of_screen).collect()
}

// Checks generated GLSL with naga, so that no driver gets invalid text.

/// Returns the declarations that the generated functions need, in a form that naga accepts.
fn surroundings() -> String {
    format!(
        "#version 450\n\
         layout(std140, set = 0, binding = 0) uniform Inputs {{\n    vec4 camera_position;\n    vec4 frame_screen;\n    vec4 frame_mouse;\n    float frame_time;\n    vec4 frame_heard[{}];\n    \
         vec4 frame_levels[{}];\n    vec4 frame_params[{}];\n    vec4 frame_hoisted[{}];\n}};\n\
         {}float table_part(float a) {{ return a; }}\nfloat shape_number(float a) {{ return a; }}\n\
         float shape_distance(float a, float b) {{ return a + b; }}\nfloat table_spectrum(float a) {{ return a; }}\n\
         float table_waveform(float a) {{ return a; }}\nfloat table_history(float a, float b) {{ return a + b; }}\n\
         vec4 read_texture(int i, float u, float v) {{ return vec4(u, v, float(i), 1.0); }}\n\
         vec4 sample_texture(int i, vec2 uv, vec2 dx, vec2 dy) {{ return vec4(uv, dx + dy); }}\n{CELL_HASH_GLSL}\n",
        SoundInput::ALL.len().div_ceil(4),
        LEVEL_COUNT,
        LIMITS.scene_params_max.div_ceil(4),
        LIMITS.hoisted_max.div_ceil(4),
        levels_glsl(),
    )
}

/// Validates generated functions. The error is naga's message.
pub(super) fn validate(functions: &str) -> Result<(), String> {
    let text = surroundings() + functions + "void main() {}\n";
    let module = Frontend::default()
        .parse(&Options::from(naga::ShaderStage::Fragment), &text)
        .map_err(|errors| errors.emit_to_string(&text))?;
    Validator::new(ValidationFlags::all(), Capabilities::empty())
        .validate(&module)
        .map(drop)
        .map_err(|error| error.emit_to_string(&text))
}

#[cfg(test)]
mod tests {
    use super::validate;

    #[test]
    fn invalid_functions_are_rejected_and_quoted() {
        assert_eq!(validate("float f(vec3 p) { return p.x; }\n"), Ok(()));
        let complaint = validate("float f(vec3 p) { return p.x + no_such_name; }\n").unwrap_err();
        assert!(complaint.contains("no_such_name"), "{complaint}");
    }
}
