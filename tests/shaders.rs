//! Every shader variant before three judges: naga, glslang and the driver. And each judge before broken shaders.

#![allow(clippy::unwrap_used, clippy::expect_used)]

mod support;

use mariana::gpu::error::GpuError;
use mariana::gpu::headless::Headless;
use mariana::gpu::program::{Program, VERTEX_SHADER};
use mariana::gpu::renderer::SHADER_VARIANTS;
use mariana::gpu::shader_source::{DRIVER_PREAMBLE, ShaderLibrary};
use support::glsl::{Stage, check_with_glslang, check_with_naga};
use support::shader_folder::{changed_shaders, shader_folder, shader_names, shader_text};

/// All shaders of the program, the vertex shader first.
fn variants() -> impl Iterator<Item = (&'static str, &'static [&'static str])> {
    std::iter::once((VERTEX_SHADER, [].as_slice())).chain(SHADER_VARIANTS)
}

/// Fails with everything that `judge` says against the shipped variants.
fn judge_variants(judge: fn(Stage, &str) -> Result<(), String>) {
    let library = ShaderLibrary::embedded();
    let mut refused = String::new();
    for (name, defines) in variants() {
        let text = library.assemble(name, DRIVER_PREAMBLE, defines).unwrap();
        if let Err(complaint) = judge(Stage::of(name), &text) {
            refused.push_str(&format!("\n{name} {defines:?}:\n{complaint}"));
        }
    }
    assert!(refused.is_empty(), "{refused}");
}

#[test]
fn naga_takes_every_variant() {
    judge_variants(check_with_naga);
}

#[test]
fn glslang_takes_every_variant() {
    judge_variants(check_with_glslang);
}

#[test]
fn the_driver_links_every_variant() {
    let context = Headless::new(false).unwrap();
    for (name, defines) in SHADER_VARIANTS {
        if let Err(error) = Program::link(context.gl(), &ShaderLibrary::embedded(), name, defines) {
            panic!("{name} {defines:?}: {error}");
        }
    }
    context.gl().check("linking the shaders").unwrap();
}

/// A shader file with an error put in before its last line that is a lone `}`, and the number of the error's line.
fn broken(file: &str) -> (String, usize) {
    let text = shader_text(file);
    let end = text.lines().enumerate().filter(|(_, line)| *line == "}").last();
    let (end, _) = end.unwrap_or_else(|| panic!("{file} has no function"));
    let mut lines: Vec<&str> = text.lines().collect();
    lines.insert(end, "    float broken = no_such_name;");
    (lines.join("\n"), end + 1)
}

/// Whether `log` names `line` of `file`.
fn names_line(log: &str, file: &str, line: usize) -> bool {
    let place = format!("{file}:{line}");
    log.match_indices(&place)
        .any(|(at, _)| !log[at + place.len()..].starts_with(|c: char| c.is_ascii_digit()))
}

#[test]
fn every_judge_refuses_a_broken_shader_and_names_the_line_of_its_file() {
    let context = Headless::new(false).unwrap();
    for file in ["scene.frag", "light.glsl", "tone_map.glsl"] {
        let (text, line) = broken(file);
        let (_folder, library) = changed_shaders(&[(file, &text)]);

        let whole = library.assemble("scene.frag", DRIVER_PREAMBLE, &[]).unwrap();
        let naga = check_with_naga(Stage::Fragment, &whole).unwrap_err();
        assert!(naga.contains("float broken = no_such_name;"), "naga on {file}: {naga}");
        let glslang = check_with_glslang(Stage::Fragment, &whole).unwrap_err();
        assert!(glslang.contains("|     float broken = no_such_name;"), "glslang on {file}: {glslang}");

        match Program::link(context.gl(), &library, "scene.frag", &[]) {
            Err(GpuError::Compile { name, log }) => {
                assert_eq!(name, "scene.frag");
                assert!(names_line(&log, file, line), "{file}, line {line}: {log}");
                assert!(log.contains("no_such_name"), "{file}: {log}");
            }
            Err(other) => panic!("{file}: {other}"),
            Ok(_) => panic!("the driver takes a broken {file}"),
        }
    }
    context.gl().check("refusing broken shaders").unwrap();
}

#[test]
fn a_texture_without_a_fixed_unit_is_refused() {
    let text = format!("{}\nuniform sampler2D unknown;\n", shader_text("edges.frag"));
    let (_folder, library) = changed_shaders(&[("edges.frag", &text)]);
    let whole = library.assemble("edges.frag", DRIVER_PREAMBLE, &[]).unwrap();
    let complaint = check_with_naga(Stage::Fragment, &whole).unwrap_err();
    assert!(complaint.contains("'unknown'"), "{complaint}");
}

#[test]
fn no_shader_file_is_dead() {
    for dead in shader_names() {
        let (folder, library) = changed_shaders(&[]);
        std::fs::remove_file(folder.path().join(&dead)).unwrap();
        let missed =
            variants().any(|(name, defines)| library.assemble(name, DRIVER_PREAMBLE, defines).is_err());
        assert!(missed, "no shader variant uses shaders/{dead}: delete it");
    }
}

#[test]
fn the_embedded_shaders_are_those_of_the_folder() {
    let mut files: Vec<String> = std::fs::read_dir(shader_folder())
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter(|name| name != "README.md")
        .collect();
    files.sort();
    assert_eq!(shader_names(), files);
    let on_disk = ShaderLibrary::on_disk(&shader_folder());
    for (name, defines) in variants() {
        let embedded = ShaderLibrary::embedded().assemble(name, "", defines).unwrap();
        assert_eq!(embedded, on_disk.assemble(name, "", defines).unwrap(), "{name}");
    }
}
