//! The folder `shaders/`, changed copies of it, and the numbers that stand in it.

use std::path::{Path, PathBuf};

use glam::DVec3;
use mariana::gpu::shader_source::ShaderLibrary;
use tempfile::TempDir;

/// The folder `shaders/` of the repository.
pub fn shader_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders")
}

/// The names of all shader files, sorted. The folder's README is none.
pub fn shader_names() -> Vec<String> {
    ShaderLibrary::embedded_names().into_iter().filter(|name| name != "README.md").collect()
}

/// The text of one file of `shaders/`.
pub fn shader_text(name: &str) -> String {
    let path = shader_folder().join(name);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// A copy of the shaders in which the files of `replaced` have other texts; it lasts as long as the folder.
pub fn changed_shaders(replaced: &[(&str, &str)]) -> (TempDir, ShaderLibrary) {
    let folder = tempfile::tempdir().unwrap();
    for name in shader_names() {
        let text = replaced.iter().find(|(other, _)| *other == name);
        let text = text.map_or_else(|| shader_text(&name), |(_, text)| (*text).to_owned());
        std::fs::write(folder.path().join(&name), text).unwrap();
    }
    for (name, _) in replaced {
        assert!(folder.path().join(name).exists(), "there is no shader file {name} to replace");
    }
    let library = ShaderLibrary::on_disk(folder.path());
    (folder, library)
}

/// The arguments of `const TYPE NAME = ...;` in a shader file.
fn constant_numbers(file: &str, name: &str) -> Vec<f64> {
    let text = shader_text(file);
    let value = text
        .lines()
        .filter_map(|line| line.trim().strip_prefix("const ")?.split_once(" = "))
        .find(|(declared, _)| declared.split_whitespace().nth(1) == Some(name))
        .and_then(|(_, rest)| rest.split_once(';'))
        .map(|(value, _)| value.trim())
        .unwrap_or_else(|| panic!("{file} has no constant {name}; the tests place their probes by it"));
    let inner = value.split_once('(').map_or(value, |(_, arguments)| arguments.trim_end_matches(')'));
    inner
        .split(',')
        .map(|number| {
            number.trim().parse().unwrap_or_else(|_| panic!("{file}: {name} is {value}, not numbers"))
        })
        .collect()
}

/// `const float NAME = number;` of a shader file.
pub fn constant(file: &str, name: &str) -> f64 {
    let numbers = constant_numbers(file, name);
    assert_eq!(numbers.len(), 1, "{file}: {name} is no single number");
    numbers[0]
}

/// `const vec3 NAME = vec3(x, y, z);` of a shader file.
pub fn vector_constant(file: &str, name: &str) -> DVec3 {
    let numbers = constant_numbers(file, name);
    assert_eq!(numbers.len(), 3, "{file}: {name} is no vector of three numbers");
    DVec3::new(numbers[0], numbers[1], numbers[2])
}
