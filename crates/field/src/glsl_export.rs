//! A scene as GLSL that can be pasted into Shadertoy.
//!
//! The time becomes `iTime`, parameters become constants of the same name, and the sound is silent. Textures are grey.
//! [`left_out`] lists what a scene loses.

use std::fmt::Write as _;

use crate::graph::{CELL_HASH_GLSL, FrameInputs, Graph, Input, Node, NodeId, Op};
use crate::lang::{Material, Scene};
use crate::tape::glsl::{Sampling, function, input_name, literal};
use crate::world::Motions;

/// The beginning of all GLSL that is made here.
pub const MADE_BY: &str = "// Made by `mariana export`.";

/// Functions that the generated code may call, each with its text.
const HELPERS: [(&str, &str); 8] = [
    ("cell_hash(", CELL_HASH_GLSL),
    ("table_part(", "float table_part(float a) { return 0.0; }\n"),
    ("table_spectrum(", "float table_spectrum(float a) { return 0.0; }\n"),
    ("table_waveform(", "float table_waveform(float a) { return 0.0; }\n"),
    ("table_history(", "float table_history(float a, float b) { return 0.0; }\n"),
    ("shape_number(", "float shape_number(float a) { return 0.0; }\n"),
    ("shape_distance(", "float shape_distance(float a, float b) { return 1.0; }\n"),
    ("read_texture(", "vec4 read_texture(int i, float u, float v) { return vec4(0.5, 0.5, 0.5, 1.0); }\n"),
];

/// A camera, a light and a sphere tracer around `map` and `map_color`.
const MAIN_IMAGE: &str = "\
void mainImage(out vec4 fragColor, in vec2 fragCoord) {
    vec2 uv = (2.0 * fragCoord - iResolution.xy) / min(iResolution.x, iResolution.y);
    vec3 forward = normalize(target - eye);
    vec3 right = normalize(cross(vec3(0.0, 1.0, 0.0), forward));
    vec3 ray = normalize(forward + tan(0.5 * fov) * (uv.x * right + uv.y * cross(forward, right)));
    float along = 0.0;
    for (int i = 0; i < 256; i++) {
        float d = map(eye + along * ray);
        if (abs(d) < 0.0005 * (1.0 + along) || along > 100.0) break;
        along += d;
    }
    vec3 color = mix(vec3(0.02, 0.03, 0.06), vec3(0.2, 0.25, 0.35), exp(-4.0 * abs(ray.y)));
    if (along < 100.0) {
        vec3 p = eye + along * ray;
        vec2 e = vec2(0.0005, -0.0005);
        vec3 n = normalize(e.xyy * map(p + e.xyy) + e.yyx * map(p + e.yyx) + e.yxy * map(p + e.yxy) + e.xxx * map(p + e.xxx));
        vec3 sun = normalize(vec3(-0.5, 0.8, -0.6));
        color = map_color(p, n) * (max(dot(n, sun), 0.0) + 0.25 + 0.15 * n.y);
    }
    fragColor = vec4(pow(clamp(color, 0.0, 1.0), vec3(1.0 / 2.2)), 1.0);
}
";

/// Returns the parts of a scene that its GLSL leaves out, in words.
pub fn left_out(scene: &Scene) -> Vec<&'static str> {
    let some = |value: &NodeId| scene.graph.as_constant(*value).is_none_or(|value| value > 0.0);
    let any = |of: fn(&Material) -> Vec<NodeId>| scene.materials.iter().any(|one| of(one).iter().any(some));
    let parts = [
        (!scene.textures.is_empty(), "textures, which are grey"),
        (!scene.shapes.is_empty(), "texts and pictures as shapes"),
        (!scene.media.is_empty(), "media"),
        (!scene.swarms.is_empty(), "swarms"),
        (any(|one| vec![one.glass, one.translucent]), "light through glass and translucent bodies"),
        (any(|one| one.emission.to_vec()), "emitted light"),
        (any(|one| vec![one.reflect, one.metalness, one.coat, one.velvet]), "mirrors and shine"),
        (scene.has_own_sky, "the sky, which has other colours"),
        (some(&scene.picture.decay), "trails"),
    ];
    parts.into_iter().filter_map(|(is_lost, what)| is_lost.then_some(what)).collect()
}

/// Returns GLSL with `float map(vec3 p)`, the scene's distance, and `vec3 map_color(vec3 p, vec3 n)`, the colour of
/// the nearest object. With `main_image`, a `mainImage` that draws both follows.
pub fn shadertoy(scene: &Scene, main_image: bool) -> String {
    let mut graph = scene.graph.clone();
    let mut color = [graph.constant(0.8); 3];
    let mut nearest: Option<NodeId> = None;
    for object in &scene.objects {
        let own = scene.materials.get(object.material).map_or(color, |material| material.color);
        match nearest {
            None => (nearest, color) = (Some(object.shape), own),
            Some(before) => {
                let is_nearer = graph.binary(Op::Less, object.shape, before);
                for (part, own) in color.iter_mut().zip(own) {
                    *part = graph.select(is_nearer, own, *part);
                }
                nearest = Some(graph.min(before, object.shape));
            }
        }
    }
    let mut distance = scene.distance;
    for bound in scene.objects.iter().filter_map(|object| object.bound) {
        distance = graph.min(distance, bound);
    }
    let camera = &scene.camera;
    let numbers: Vec<NodeId> =
        camera.position.iter().chain(&camera.target).copied().chain([camera.fov]).collect();
    let mut body = function(&graph, &[distance], "scene_distance", Sampling::None);
    body.push_str(&function(&graph, &color, "scene_color", Sampling::None));
    let mut used = vec![distance];
    used.extend(color);
    if main_image {
        body.push_str(&function(&graph, &numbers, "scene_camera", Sampling::None));
        used.extend(numbers);
    }

    let (body, constants) = with_names(scene, &graph, &used, body);
    let mut text = format!("{MADE_BY} map: distance, map_color: colour of the nearest object.\n");
    for sentence in left_out(scene) {
        let _ = writeln!(text, "// Left out: {sentence}.");
    }
    if main_image || body.contains("camera_position") {
        text.push_str("vec3 camera_position = vec3(0.0, 2.0, -5.0);\n");
    }
    text.push_str(&constants);
    for (call, helper) in HELPERS {
        if body.contains(call) {
            text.push_str(helper);
        }
    }
    if body.contains("level_of_") {
        let list = body.match_indices("level_of_").filter_map(|(at, _)| body.get(at..)?.split('(').next());
        let names: std::collections::BTreeSet<&str> = list.collect();
        for name in names {
            let _ = writeln!(text, "float {name}(float i) {{ return 0.0; }}");
        }
    }
    text.push_str(&body);
    text.push_str("float map(vec3 p) { return scene_distance(p, vec3(0.0)); }\n");
    text.push_str("vec3 map_color(vec3 p, vec3 n) { vec3 c; scene_color(p, n, c.r, c.g, c.b); return c; }\n");
    if main_image {
        let camera = "    vec3 eye, target;\n    float fov;\n    scene_camera(vec3(0.0), vec3(0.0), eye.x, eye.y, eye.z, \
                      target.x, target.y, target.z, fov);\n    fov = radians(fov);\n    camera_position = eye;\n";
        let (head, rest) = MAIN_IMAGE.split_once('\n').unwrap_or((MAIN_IMAGE, ""));
        let _ = write!(text, "{head}\n{camera}{rest}");
    }
    text
}

/// Replaces the names of inputs in the body by `iTime`, constants and numbers. Returns the body and the constants.
fn with_names(scene: &Scene, graph: &Graph, used: &[NodeId], mut body: String) -> (String, String) {
    let mut frame = FrameInputs {
        params: scene.params.iter().map(|param| param.default).collect(),
        ..FrameInputs::default()
    };
    Motions::of(&scene.graph).begin().step(&mut frame, 0.0);
    let mut constants = String::new();
    for id in graph.order(used) {
        let Node::Input(input) = graph.node(id) else { continue };
        let name = input_name(input);
        match input {
            _ if input.of_point().is_some() => {}
            Input::T => body = body.replace(&name, "iTime"),
            Input::EyeX | Input::EyeY | Input::EyeZ => {}
            Input::Param(index) => {
                let param = scene.params.get(usize::from(index));
                let own = param.filter(|param| !param.is_number).map(|param| format!("param_{}", param.name));
                let own = own.unwrap_or_else(|| format!("number_{index}"));
                let value = literal(param.map_or(0.0, |param| param.default));
                let _ = writeln!(constants, "const float {own} = {value};");
                body = body.replace(&name, &own);
            }
            other => body = body.replace(&name, &literal(frame.value(other))),
        }
    }
    (body, constants)
}

#[cfg(test)]
mod tests {
    use super::shadertoy;
    use crate::glsl_import::{GlslFile, candidate};
    use crate::graph::{FrameInputs, Point};
    use crate::lang::{compile, no_includes};
    use crate::limits::LIMITS;

    const SCENE: &str = "param size = 0.7 in 0 .. 2\nlet wobble = 0.1 * sin(3 * t)\n\
        material red { color = vec3(0.8, 0.1, 0.1) * (1 + bass) }\n\
        material floor { color = vec3(0.2) + 0.1 * mod(floor(p.x) + floor(p.z), 2) * cell_hash(p.x, p.z) }\n\
        object ball { shape = sphere(p, size + wobble + band(3))  material = red }\n\
        object floor { shape = y + 1  material = floor }\n";

    #[test]
    fn an_exported_scene_comes_back_with_the_same_distance() {
        let scene = compile("s", SCENE, &mut no_includes).scene.unwrap();
        let text = shadertoy(&scene, true);
        let file = GlslFile::parse(&text, &LIMITS).unwrap_or_else(|problem| panic!("{problem:?}\n{text}"));
        assert_eq!(candidate(&file).map(|function| function.name.as_str()), Some("map"));
        let wanted = "param param_size = 0.7 in 0 .. 2\ninclude \"a.glsl\"\nobject a { shape = map(p) }";
        let back = compile("back", wanted, &mut |_| Ok(text.clone()));
        let back = back.scene.as_ref().unwrap_or_else(|| panic!("{}", back.render(false)));
        let frame = FrameInputs { time: 1.3, params: vec![0.7], ..FrameInputs::default() };
        for at in [[0.0, 0.0, 0.0], [1.0, 2.0, 0.5], [-0.3, -0.9, 0.2], [4.0, 0.1, -2.0]] {
            let point = Point::at(at[0], at[1], at[2]);
            let (a, b) = (
                scene.graph.evaluate(&[scene.distance], &point, &frame)[0],
                back.graph.evaluate(&[back.distance], &point, &frame)[0],
            );
            assert!((a - b).abs() < 1e-5, "at {at:?}: {a}, but {b}\n{text}");
        }
    }

    #[test]
    fn shipped_constructs_are_exported_as_glsl_that_parses() {
        for text in
            ["length(p) - 1", "spectrum(x) + history(x, y) + noise(p) + band(x)", "max(x, cell_hash(x, z))"]
        {
            let scene = compile("s", text, &mut no_includes).scene.unwrap();
            let text = shadertoy(&scene, false);
            let file =
                GlslFile::parse(&text, &LIMITS).unwrap_or_else(|problem| panic!("{problem:?}\n{text}"));
            let broken: Vec<_> =
                file.functions().iter().filter_map(|function| file.problem_of(function)).collect();
            assert_eq!(broken, [] as [&crate::lang::Diagnostic; 0], "{text}");
        }
    }
}
