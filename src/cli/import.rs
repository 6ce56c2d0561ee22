//! The subcommands `import` and `export`: scenes from GLSL, and GLSL from scenes.

use std::path::{Path, PathBuf};

use anyhow::bail;
use clap::Args;

use super::common::colors;
use super::files::{is_standard, scene_of};
use crate::atomic_file::{AtomicFile, folder_of};
use crate::export::output::refuse_to_replace;
use crate::export::print::{print_line, print_message};
use crate::scenes::{ShaderError, is_copy, is_shader_file, read_shader, scene_of_shader};
use mariana_field::glsl_export::{MADE_BY, left_out, shadertoy};
use mariana_field::glsl_import::Shown;
use mariana_field::lang::{Diagnostic, Sources};

#[derive(Args)]
pub(super) struct ImportArguments {
    /// The GLSL file
    #[arg(value_name = "FILE.glsl")]
    shader: PathBuf,
    /// The scene to write, which must not exist yet; a GLSL file in another folder is copied to its folder. '-' prints
    /// the scene [default: the name of the GLSL file with the ending .scene]
    #[arg(short, long, value_name = "FILE.scene")]
    output: Option<PathBuf>,
    /// What to show of a shader that draws a picture and has a distance function: its own picture, or the distance as
    /// an object in the light of a scene
    #[arg(long = "as", value_name = "WHAT", default_value = "picture", value_parser = ["picture", "shape"])]
    shown: String,
}

#[derive(Args)]
pub(super) struct ExportArguments {
    /// A file, the name of a shipped scene, or a formula
    #[arg(value_name = "SCENE-OR-FORMULA", allow_hyphen_values = true)]
    scene: String,
    /// Write GLSL; this is the only format so far
    #[arg(long, required = true)]
    glsl: bool,
    /// Add a mainImage that draws the scene in Shadertoy
    #[arg(long)]
    main_image: bool,
    /// The file to write; only an earlier export is replaced; '-' is standard output
    #[arg(short, long, value_name = "FILE", default_value = "-")]
    output: PathBuf,
}

pub(super) fn run_import(arguments: &ImportArguments) -> anyhow::Result<()> {
    let shader = &arguments.shader;
    let read = read_shader(shader)?;
    let name = shader.file_name().and_then(|name| name.to_str()).unwrap_or("");
    let shown = if arguments.shown == "shape" { Shown::Shape } else { Shown::Picture };
    let around = scene_of_shader(shader, &read, shown).map_err(|error| match &error {
        ShaderError::NoScene { problem, .. } => underlined(shader, &read.text, problem),
        _ => error.into(),
    })?;
    let scene = around.text(name);
    let output = arguments.output.clone().unwrap_or_else(|| shader.with_extension("scene"));
    if is_shader_file(&output) {
        bail!("{} is called like a shader: give the scene a name such as my.scene", output.display());
    }
    if is_standard(&output) {
        print_line(scene.trim_end())?;
    } else {
        refuse_to_replace(&output, None)?;
        copy_beside(shader, &read.whole.text, &output, name)?;
        AtomicFile::create(&output)?.write(scene.as_bytes())?;
        print_line(&format!("{}: check it with `mariana check`, show it with `mariana`", output.display()))?;
    }
    around.notes().iter().for_each(|note| print_message(note));
    Ok(())
}

/// Reports a shader that cannot become a scene, with the marked text.
fn underlined(shader: &Path, text: &str, problem: &Diagnostic) -> anyhow::Error {
    let mut sources = Sources::default();
    sources.add(shader.file_name().and_then(|name| name.to_str()).unwrap_or(""), text);
    let text = problem.render(&sources, colors(&std::io::stderr()));
    anyhow::anyhow!("{} cannot become a scene\n{}", shader.display(), text.trim_end())
}

/// Copies the GLSL into the folder of the scene, because a scene reads only its own folder.
fn copy_beside(shader: &Path, text: &str, scene: &Path, name: &str) -> anyhow::Result<()> {
    let to = folder_of(scene);
    if folder_of(shader).canonicalize().ok() == to.canonicalize().ok() {
        return Ok(());
    }
    let copy = to.join(name);
    if is_copy(&copy, text) {
        return Ok(());
    }
    if copy.exists() {
        bail!("{} exists and differs from {}: rename one of them", copy.display(), shader.display());
    }
    Ok(AtomicFile::create(&copy)?.write(text.as_bytes())?)
}

pub(super) fn run_export(arguments: &ExportArguments) -> anyhow::Result<()> {
    let scene = scene_of(&arguments.scene)?.baked()?;
    let text = shadertoy(&scene, arguments.main_image);
    if is_standard(&arguments.output) {
        print_line(text.trim_end())?;
    } else {
        refuse_to_replace(&arguments.output, Some(MADE_BY))?;
        AtomicFile::create(&arguments.output)?.write(text.as_bytes())?;
        print_line(&arguments.output.display().to_string())?;
    }
    for sentence in left_out(&scene) {
        print_message(&format!("left out: {sentence}"));
    }
    Ok(())
}
