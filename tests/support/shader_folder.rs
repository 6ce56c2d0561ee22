//! The folder `shaders/` and changed copies of it.

use std::path::{Path, PathBuf};

use mariana::gpu::shader_source::ShaderLibrary;
use tempfile::TempDir;

pub(crate) fn shader_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders")
}

pub(crate) fn shader_text(name: &str) -> String {
    let path = shader_folder().join(name);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The names of all shader files.
pub(crate) fn shader_names() -> Vec<String> {
    let files = std::fs::read_dir(shader_folder()).unwrap();
    let names = files.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    names.filter(|name| !["Cargo.toml", "README.md", "lib.rs"].contains(&name.as_str())).collect()
}

/// A copy of the shaders in which the files of `replaced` have new texts. The library is valid while the folder exists.
pub(crate) fn changed_shaders(replaced: &[(&str, &str)]) -> (TempDir, ShaderLibrary) {
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
