//! Checks every shader variant with naga, glslang and the driver. Also checks the errors that these compilers report
//! for broken shaders.
//!
//! naga's GLSL front end supports neither OpenGL ES nor texture buffers (`usamplerBuffer`, `samplerBuffer`). The text for
//! naga replaces the region lookups by a function. Only glslang and the driver check the interpreter's variants.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use crate::support::glsl::{Stage, check_with_glslang, check_with_naga};
use crate::support::shader_folder::{changed_shaders, shader_folder, shader_names, shader_text};
use crate::support::test_renderer::{driver, driver_of, ready, speakers};
use mariana::frame::projection::{Projection, ProjectionKind};
use mariana::gpu::api::Api;
use mariana::gpu::error::GpuError;
use mariana::gpu::flash_pass::{FLASH_SHADERS, LIMIT_SHADERS};
use mariana::gpu::headless::Headless;
use mariana::gpu::media::{MEDIA_FILTER_SHADER, media_filter_variant};
use mariana::gpu::post::POST_SHADERS;
use mariana::gpu::program::{Program, VERTEX_SHADER};
use mariana::gpu::renderer::{Counting, EDGE_SHADER, PATH_RESULT_SHADERS, PLACING_SHADERS, UPSCALE_SHADER};
use mariana::gpu::samplers::SAMPLERS_SHADER;
use mariana::gpu::scene_program::{
    Mode, PATH_SHADER, SCENE_SHADER, as_coverage, as_paths, as_views, projected, variant_of, without_cells,
    without_sky,
};
use mariana::gpu::shader_source::{ShaderLibrary, ShaderSourceError, Variant, driver_preamble};
use mariana::scenes::{ReadyScene, SceneSource};

/// A plane and a traced part, without textures. The shader omits the code for all other features.
const FORMULA: &str = "min(y, sqrt(x*x + (y-1)*(y-1) + (z-6)*(z-6)) - 1)";

/// A non-Lipschitz scene, for which the shader uses bounds of the gradient.
const NON_LIPSCHITZ: &str = "sin(x)*cos(y) + sin(y)*cos(z) + sin(z)*cos(x)";

const EVERYTHING: &str = "material m { color = 0.5  reflect = 0.5  blur = 0.3  emission = vec3(0.1) }\n\
                          object ball { shape = sphere(p, 1)  material = m }\n\
                          medium fog { density = 0.1 + 0.05 * noise(p)  shape = abs(y) - 2 }\n\
                          light panel { position = vec3(0, 3, 0)  right = vec3(1, 0, 0)  up = vec3(0, 0, 1) }\n\
                          camera { aperture = 0.05 }";

/// Defines of the scene shader's variants. At least one case must use each define.
const DEFINES: [&str; 13] = [
    "PATHS",
    "MEDIA",
    "NON_LIPSCHITZ",
    "BLUR",
    "LENS",
    "GLOW",
    "PANELS",
    "MIRRORS",
    "VIEWS",
    "COUNT_EVALUATIONS",
    "NO_SKY",
    "COVERAGE",
    "PROJECTED",
];

struct Case {
    name: String,
    file: &'static str,
    variant: Variant,
    /// True if the shader reads lists of texels other than the region tree.
    interpreted: bool,
    /// True for a software renderer.
    software: bool,
}

impl Case {
    fn text(&self, library: &ShaderLibrary) -> Result<String, ShaderSourceError> {
        self.text_for(Api::Desktop, library)
    }

    fn text_for(&self, api: Api, library: &ShaderLibrary) -> Result<String, ShaderSourceError> {
        library.assemble(self.file, &driver_preamble(&driver_of(api, self.software)), &self.variant)
    }
}

fn changed_case(mut case: Case, change: fn(Variant) -> Variant) -> Case {
    case.variant = change(case.variant);
    case.name.push_str(&format!(", {:?}", case.variant.defines.last()));
    case
}

fn of_a_dome(variant: Variant) -> Variant {
    projected(variant, &Projection { kind: ProjectionKind::Dome, ..Projection::default() })
}

fn scene_case(scene: &SceneSource, mode: Mode, software: bool, counting: Counting) -> Case {
    let ReadyScene { world, buffers, plan, .. } = ready(scene);
    let variant = variant_of(&world, &buffers, &plan, mode, &driver(software), counting).unwrap();
    let place = if software { "a processor" } else { "a GPU" };
    let name = format!("{SCENE_SHADER} of {}, {mode} for {place}, counting {counting:?}", scene.name());
    Case { name, file: SCENE_SHADER, variant, interpreted: mode == Mode::Interpreted, software }
}

fn cases() -> Vec<Case> {
    let plain = [VERTEX_SHADER, LIMIT_SHADERS.1, EDGE_SHADER, UPSCALE_SHADER, SAMPLERS_SHADER];
    let plain = plain.into_iter().chain(PLACING_SHADERS).map(|file| (file, &[][..]));
    let own = plain.chain(FLASH_SHADERS).chain(POST_SHADERS).chain(PATH_RESULT_SHADERS);
    let mut cases: Vec<Case> = own
        .map(|(file, defines)| {
            let name = format!("{file} {defines:?}");
            let interpreted = file == "trails.frag";
            Case { name, file, variant: Variant::of(defines), interpreted, software: true }
        })
        .collect();
    cases.push(Case {
        name: MEDIA_FILTER_SHADER.into(),
        file: MEDIA_FILTER_SHADER,
        variant: media_filter_variant(),
        interpreted: false,
        software: true,
    });
    for counting in [Counting::Off, Counting::On] {
        for scene in [speakers(), SceneSource::Formula(FORMULA.into())] {
            cases.push(scene_case(&scene, Mode::Compiled, false, counting));
        }
        for software in [false, true] {
            cases.push(scene_case(&speakers(), Mode::Interpreted, software, counting));
        }
    }
    for mode in [Mode::Compiled, Mode::Interpreted] {
        cases.push(changed_case(scene_case(&speakers(), mode, true, Counting::On), as_views));
        for text in [NON_LIPSCHITZ, EVERYTHING] {
            let scene = SceneSource::Formula(text.into());
            cases.push(scene_case(&scene, mode, false, Counting::Off));
            cases.push(scene_case(&scene, mode, true, Counting::On));
            let views = changed_case(scene_case(&scene, mode, true, Counting::On), as_views);
            cases.push(changed_case(views, of_a_dome));
            cases.push(changed_case(scene_case(&scene, mode, true, Counting::On), as_views));
            if mode == Mode::Compiled && text != NON_LIPSCHITZ {
                cases.push(changed_case(scene_case(&scene, mode, false, Counting::Off), without_cells));
                cases.push(changed_case(scene_case(&scene, mode, true, Counting::On), without_cells));
            }
            for software in [false, true] {
                let paths = changed_case(scene_case(&scene, mode, software, Counting::Off), as_paths);
                cases.push(Case { file: PATH_SHADER, ..paths });
            }
            for change in [without_sky, as_coverage, of_a_dome] {
                cases.push(changed_case(scene_case(&scene, mode, true, Counting::Off), change));
            }
        }
    }
    cases
}

fn judge_cases(
    cases: impl IntoIterator<Item = Case>,
    api: Api,
    judge: fn(Stage, &str) -> Result<(), String>,
) {
    let library = ShaderLibrary::embedded();
    let mut refused = String::new();
    for case in cases {
        let (name, file) = (&case.name, case.file);
        let text = case.text_for(api, &library).unwrap();
        if let Err(complaint) = judge(Stage::of(file), &text) {
            refused.push_str(&format!("\n{name}:\n{complaint}"));
        }
    }
    assert!(refused.is_empty(), "{refused}");
}

#[test]
fn every_define_is_in_some_case_in_both_modes() {
    for interpreted in [false, true] {
        let of_mode = cases().into_iter().filter(|case| case.interpreted == interpreted);
        let given: Vec<String> = of_mode.flat_map(|case| case.variant.defines).collect();
        // `NO_CELLS` applies to compiled scenes only, because interpreted scenes always have code for cells.
        let of_compiled = (!interpreted).then_some("NO_CELLS");
        for define in DEFINES.into_iter().chain(of_compiled) {
            assert!(
                given.iter().any(|given| given.split(' ').next() == Some(define)),
                "no case defines {define}, interpreted: {interpreted}"
            );
        }
    }
}

#[test]
fn naga_accepts_every_variant_without_tapes() {
    let cases = cases().into_iter().filter(|case| !case.interpreted);
    judge_cases(cases, Api::Desktop, check_with_naga);
}

#[test]
fn glslang_accepts_every_variant() {
    for api in [Api::Desktop, Api::Embedded] {
        judge_cases(cases(), api, check_with_glslang);
    }
}

/// Fails unless glslang accepts the scene's shaders for OpenGL ES.
pub(super) fn check_embedded_shaders(scene: &SceneSource) {
    let cases = [(Mode::Compiled, false), (Mode::Interpreted, false), (Mode::Interpreted, true)]
        .map(|(mode, software)| scene_case(scene, mode, software, Counting::Off));
    judge_cases(cases, Api::Embedded, check_with_glslang);
}

#[test]
fn opengl_es_rejects_what_only_opengl_has() {
    for body in ["uniform samplerBuffer list;\nvoid main() {}", "void main() { float x = 1; }"] {
        let of = |api| check_with_glslang(Stage::Fragment, &(driver_preamble(&driver_of(api, false)) + body));
        assert_eq!(of(Api::Desktop), Ok(()), "{body}");
        assert!(of(Api::Embedded).is_err(), "{body}");
    }
}

#[test]
fn the_driver_links_every_variant() {
    let context = Headless::new(false).unwrap();
    for Case { name, file, variant, .. } in cases().iter().filter(|case| case.file.ends_with(".frag")) {
        if let Err(error) = Program::link(context.gl(), &ShaderLibrary::embedded(), file, variant) {
            panic!("{name}: {error}");
        }
    }
    context.gl().check("linking the shaders").unwrap();
}

/// Inserts an error before the last line of a shader file that is a lone `}`. Also returns the error's line number.
fn broken(file: &str) -> (String, usize) {
    let text = shader_text(file);
    let end = text.lines().enumerate().filter(|(_, line)| *line == "}").last();
    let (end, _) = end.unwrap_or_else(|| panic!("{file} has no function"));
    let mut lines: Vec<&str> = text.lines().collect();
    lines.insert(end, "    float broken = no_such_name;");
    (lines.join("\n"), end + 1)
}

fn names_line(log: &str, file: &str, line: usize) -> bool {
    let place = format!("{file}:{line}");
    log.match_indices(&place)
        .any(|(at, _)| !log[at + place.len()..].starts_with(|c: char| c.is_ascii_digit()))
}

#[test]
fn broken_shaders_are_rejected_with_file_and_line() {
    let context = Headless::new(false).unwrap();
    let software = context.gl().info().software;
    for (file, mode) in [
        ("scene.frag", Mode::Compiled),
        ("light.glsl", Mode::Compiled),
        ("sample_light.glsl", Mode::Compiled),
        ("interpreter.glsl", Mode::Interpreted),
    ] {
        let (text, line) = broken(file);
        let (_folder, library) = changed_shaders(&[(file, &text)]);
        let case = scene_case(&speakers(), mode, software, Counting::Off);

        let whole = case.text(&library).unwrap();
        if !case.interpreted {
            let naga = check_with_naga(Stage::Fragment, &whole).unwrap_err();
            assert!(naga.contains("float broken = no_such_name;"), "naga on {file}: {naga}");
        }
        let glslang = check_with_glslang(Stage::Fragment, &whole).unwrap_err();
        assert!(glslang.contains("|     float broken = no_such_name;"), "glslang on {file}: {glslang}");

        match Program::link(context.gl(), &library, "scene.frag", &case.variant) {
            Err(GpuError::Compile { name, log }) => {
                assert_eq!(name, "scene.frag");
                assert!(names_line(&log, file, line), "{file}, line {line}: {log}");
                assert!(log.contains("no_such_name"), "{file}: {log}");
            }
            Err(other) => panic!("{file}: {other}"),
            Ok(_) => panic!("the driver accepts a broken {file}"),
        }
    }
    context.gl().check("refusing broken shaders").unwrap();
}

#[test]
fn a_texture_without_a_fixed_unit_is_refused() {
    let text = format!("{}\nuniform sampler2D unknown;\n", shader_text("edges.frag"));
    let (_folder, library) = changed_shaders(&[("edges.frag", &text)]);
    let whole = library.assemble("edges.frag", &driver_preamble(&driver(true)), &Variant::default()).unwrap();
    let complaint = check_with_naga(Stage::Fragment, &whole).unwrap_err();
    assert!(complaint.contains("'unknown'"), "{complaint}");
}

#[test]
fn every_shader_file_is_used() {
    let cases = cases();
    for dead in shader_names() {
        let (folder, library) = changed_shaders(&[]);
        std::fs::remove_file(folder.path().join(&dead)).unwrap();
        let missed = cases.iter().any(|case| case.text(&library).is_err());
        assert!(missed, "no shader variant uses shaders/{dead}: delete it");
    }
}

#[test]
fn the_embedded_shaders_match_the_folder() {
    let on_disk = ShaderLibrary::on_disk(&shader_folder());
    for Case { name, file, variant, .. } in cases() {
        let embedded = ShaderLibrary::embedded().assemble(file, "", &variant).unwrap();
        assert_eq!(embedded, on_disk.assemble(file, "", &variant).unwrap(), "{name}");
    }
}
