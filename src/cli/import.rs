//! The subcommands `import` and `export`: scenes from GLSL, and GLSL from scenes.

use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use clap::Args;

use super::common::colors;
use super::files::{is_standard, scene_of};
use super::scene::require;
use crate::atomic_file::AtomicFile;
use crate::export::print::{print_line, tell};
use mariana_field::glsl_export::shadertoy;
use mariana_field::glsl_import::scene_around;
use mariana_field::lang::{Diagnostic, Fault, Sources, Span, formatted, is_glsl};
use mariana_field::limits::LIMITS;

#[derive(Args)]
pub(super) struct ImportArguments {
    /// The GLSL file
    #[arg(value_name = "FILE.glsl")]
    shader: PathBuf,
    /// The scene to write; a GLSL file in another folder is copied beside it. '-' prints the scene [default: the name
    /// of the GLSL file with the ending .scene]
    #[arg(short, long, value_name = "FILE.scene")]
    output: Option<PathBuf>,
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
    /// The file to write; '-' is standard output
    #[arg(short, long, value_name = "FILE", default_value = "-")]
    output: PathBuf,
}

pub(super) fn run_import(arguments: &ImportArguments) -> anyhow::Result<()> {
    let shader = &arguments.shader;
    let name = shader.file_name().and_then(|name| name.to_str()).unwrap_or("");
    if !is_glsl(name) {
        bail!("{} is not called like a GLSL file: rename it to end in .glsl or .frag", shader.display());
    }
    let text = read(shader)?;
    let around = scene_around(&text, name).map_err(|problem| {
        let mut sources = Sources::default();
        sources.add(name, &text);
        let span = Span::new(problem.place.start, problem.place.end);
        let diagnostic = Diagnostic { fault: Fault::Unsupported, ..Diagnostic::new(span, problem.message) };
        let diagnostic = if problem.hint.is_empty() { diagnostic } else { diagnostic.hint(problem.hint) };
        let text = diagnostic.render(&sources, colors(&std::io::stderr()));
        anyhow::anyhow!("{} cannot become a scene\n{}", shader.display(), text.trim_end())
    })?;
    let scene = formatted(&around.text).unwrap_or(around.text);
    let output = arguments.output.clone().unwrap_or_else(|| shader.with_extension("scene"));
    if is_standard(&output) {
        print_line(scene.trim_end())?;
    } else {
        if arguments.output.is_none() && output.exists() {
            bail!("{} exists: name another file with -o, or the same one to replace it", output.display());
        }
        copy_beside(shader, &text, &output, name)?;
        AtomicFile::create(&output)?.write(scene.as_bytes())?;
        print_line(&format!("{}: check it with `mariana check`, show it with `mariana`", output.display()))?;
    }
    for sentence in around.left_out {
        tell(&format!("left out: {sentence}"));
    }
    Ok(())
}

fn read(shader: &Path) -> anyhow::Result<String> {
    let context = || format!("{} cannot be read: check the path", shader.display());
    let max = LIMITS.scene_bytes_max as u64;
    let size = std::fs::metadata(shader).with_context(context)?.len();
    if size > max {
        bail!("{} is larger than {max} bytes: split it", shader.display());
    }
    let bytes = std::fs::read(shader).with_context(context)?;
    String::from_utf8(bytes).map_err(|error| {
        let position = error.utf8_error().valid_up_to();
        anyhow::anyhow!("{} is not text: byte {position} is not UTF-8; save it as UTF-8", shader.display())
    })
}

/// Copies the GLSL into the folder of the scene, which reads nothing outside of its folder.
fn copy_beside(shader: &Path, text: &str, scene: &Path, name: &str) -> anyhow::Result<()> {
    let folder = |path: &Path| match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder.to_owned(),
        _ => PathBuf::from("."),
    };
    let to = folder(scene);
    if folder(shader).canonicalize().ok() == to.canonicalize().ok() {
        return Ok(());
    }
    let copy = to.join(name);
    if std::fs::read_to_string(&copy).is_ok_and(|existing| existing == text) {
        return Ok(());
    }
    if copy.exists() {
        bail!("{} exists and differs from {}: rename one of them", copy.display(), shader.display());
    }
    Ok(AtomicFile::create(&copy)?.write(text.as_bytes())?)
}

pub(super) fn run_export(arguments: &ExportArguments) -> anyhow::Result<()> {
    let scene = require(&scene_of(&arguments.scene)?)?;
    let text = shadertoy(&scene, arguments.main_image)?;
    if is_standard(&arguments.output) {
        print_line(text.trim_end())?;
    } else {
        AtomicFile::create(&arguments.output)?.write(text.as_bytes())?;
        print_line(&arguments.output.display().to_string())?;
    }
    if !scene.textures.is_empty() {
        tell("left out: textures, which are grey");
    }
    Ok(())
}
