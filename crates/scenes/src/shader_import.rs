//! Makes scenes of shaders in a folder of scenes, without replacing any file.

use mariana_files::reading::{TextError, read_text};
use std::path::{Path, PathBuf};

use mariana_field::glsl_import::{SceneAround, Shown, Whole, scene_around, whole};
use mariana_field::lang::{Diagnostic, Sources, is_glsl};
use mariana_field::limits::LIMITS as FIELD_LIMITS;
use mariana_files::atomic_file::{AtomicFile, Unwritable};
use mariana_files::file_names::{numbered, plain_name};

use crate::folder::{ENDING, Folder};

/// Maximum number of shaders of one name that are compared with an imported one.
const SAME_NAMES_MAX: usize = 1_000;

/// A shader that cannot become a scene. Each message names the file, the reason and a remedy.
#[derive(Debug, thiserror::Error)]
pub enum ShaderError {
    /// The name does not end like that of a shader.
    #[error("{} is not called like a GLSL file: rename it to end in .glsl or .frag", .0.display())]
    NoShader(PathBuf),
    /// The file is not a readable text.
    #[error("{} {problem}", .path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The reason.
        problem: TextError,
    },
    /// No scene can be made of the text.
    #[error("{} cannot become a scene: {}", .path.display(), sentence(.text, .problem))]
    NoScene {
        /// The file.
        path: PathBuf,
        /// The text.
        text: String,
        /// The reason.
        problem: Box<Diagnostic>,
    },
    /// The folder of the scenes cannot be written.
    #[error(transparent)]
    Unwritable(#[from] Unwritable),
}

fn sentence(text: &str, problem: &Diagnostic) -> String {
    let mut sources = Sources::default();
    sources.add("shader", text);
    let line = match sources.place(problem.span.start) {
        Some(place) if !problem.span.is_empty() => format!("line {}: ", place.line),
        _ => String::new(),
    };
    let hint = problem.hint.as_ref().map_or(String::new(), |hint| format!("; {hint}"));
    format!("{line}{}{hint}", problem.message)
}

/// A scene that was made of a shader.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ImportedShader {
    /// The file of the scene.
    pub scene: PathBuf,
    /// Sentences about the parts of the shader that the scene shows or leaves out.
    pub notes: Vec<String>,
}

/// The text of a shader.
#[derive(Debug)]
pub struct Shader {
    /// The text of the file.
    pub text: String,
    /// The text with those of the files that it includes.
    pub whole: Whole,
}

/// True if the path has the ending of a GLSL file.
pub fn is_shader_file(path: &Path) -> bool {
    path.file_name().and_then(|name| name.to_str()).is_some_and(is_glsl)
}

/// True if the file holds this text. A pipe does not, because reading it would wait for a writer.
pub fn is_copy(file: &Path, text: &str) -> bool {
    file.is_file() && std::fs::read_to_string(file).is_ok_and(|own| own == text)
}

/// Reads the text of a shader, and the files that it includes from its folder.
///
/// # Errors
/// A path that is not called like a GLSL file, or a file that cannot be read, is too large or is not text.
pub fn read_shader(path: &Path) -> Result<Shader, ShaderError> {
    if !is_shader_file(path) {
        return Err(ShaderError::NoShader(path.to_owned()));
    }
    let max = FIELD_LIMITS.scene_bytes_max;
    let text =
        read_text(path, max).map_err(|problem| ShaderError::File { path: path.to_owned(), problem })?;
    let folder = Folder::of(path);
    let whole = whole(&text, &mut |file| folder.text(file, max).ok());
    Ok(Shader { text, whole })
}

/// Writes a scene around a shader.
///
/// # Errors
/// A shader that cannot become a scene.
pub fn scene_of_shader(path: &Path, shader: &Shader, shown: Shown) -> Result<SceneAround, ShaderError> {
    scene_around(&shader.whole.text, shown).map_err(|problem| ShaderError::NoScene {
        path: path.to_owned(),
        text: shader.text.clone(),
        problem: Box::new(Diagnostic { span: shader.whole.place(problem.span), ..problem }),
    })
}

/// Copies a shader into a folder of scenes and writes a scene around it. If the folder has the same shader and its scene
/// already, that scene is the result, with the user's changes. Creates the folder. Replaces no file.
///
/// # Errors
/// A shader that cannot be read or cannot become a scene, or a folder that cannot be written.
pub fn import_shader(shader: &Path, folder: &Path) -> Result<ImportedShader, ShaderError> {
    let read = read_shader(shader)?;
    let text = &read.whole.text;
    let stem = plain_name(&shader.file_stem().unwrap_or_default().to_string_lossy(), "shader");
    let ending = shader.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let copy = folder.join(format!("{stem}.{ending}"));
    let there = numbered(&copy).take_while(|copy| copy.exists()).take(SAME_NAMES_MAX);
    let there = there.into_iter().find(|copy| is_copy(copy, text));
    if let Some(scene) =
        there.as_ref().map(|copy| copy.with_extension(ENDING)).filter(|scene| scene.is_file())
    {
        return Ok(ImportedShader { scene, notes: Vec::new() });
    }
    // Nothing is written for a shader that cannot become a scene.
    let around = scene_of_shader(shader, &read, Shown::default())?;
    std::fs::create_dir_all(folder).map_err(|error| Unwritable::new(folder, &error))?;
    let copy = match there {
        Some(copy) => copy,
        None => AtomicFile::create(&copy)?.write_beside(text.as_bytes())?,
    };
    let include = copy.file_name().unwrap_or_default().to_string_lossy();
    let scene = around.text(&include);
    let scene = AtomicFile::create(&copy.with_extension(ENDING))?.write_beside(scene.as_bytes())?;
    Ok(ImportedShader { scene, notes: around.notes() })
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::SceneSource;

    const DISC: &str = "void mainImage(out vec4 c, in vec2 f) { c = vec4(f / iResolution.xy, 0.5, 1.0); }";

    fn imported(shader: &Path, folder: &Path) -> PathBuf {
        import_shader(shader, folder).unwrap_or_else(|error| panic!("{error}")).scene
    }

    #[cfg(unix)]
    #[test]
    fn a_shader_included_a_file_outside_of_its_folder_through_a_link() {
        let place = tempfile::tempdir().unwrap();
        let inner = place.path().join("inner");
        fs::create_dir(&inner).unwrap();
        fs::write(place.path().join("secret.glsl"), "float secret = 1.0;").unwrap();
        fs::write(inner.join("near.glsl"), "float near = 1.0;").unwrap();
        std::os::unix::fs::symlink("../secret.glsl", inner.join("link.glsl")).unwrap();
        let shader = inner.join("disc.glsl");
        fs::write(&shader, format!("#include \"link.glsl\"\n#include \"near.glsl\"\n{DISC}")).unwrap();
        let whole = read_shader(&shader).unwrap().whole.text;
        assert!(whole.contains("near = 1.0") && !whole.contains("secret = 1.0"), "{whole}");
    }

    #[test]
    fn a_shader_becomes_a_scene_in_the_folder_once() {
        let place = tempfile::tempdir().unwrap();
        let (shader, scenes) = (place.path().join("disc: 1.FRAG"), place.path().join("own/scenes"));
        fs::write(&shader, DISC).unwrap();
        let first = imported(&shader, &scenes);
        assert_eq!(first, scenes.join("disc_ 1.scene"));
        assert!(SceneSource::File(first.clone()).ready().is_ok());
        fs::write(&first, "sphere(p, 1)").unwrap();
        assert_eq!(imported(&shader, &scenes), first, "the same shader");
        assert_eq!(fs::read_to_string(&first).unwrap(), "sphere(p, 1)");
        fs::write(&shader, DISC.replace("0.5", "0.7")).unwrap();
        let second = imported(&shader, &scenes);
        assert_eq!(second, scenes.join("disc_ 1 2.scene"), "another shader of the same name");
        assert_eq!(imported(&shader, &scenes), second);
        assert!(SceneSource::File(second).ready().is_ok());
        assert_eq!(fs::read_to_string(scenes.join("disc_ 1.frag")).unwrap(), DISC);
        assert_eq!(fs::read_dir(&scenes).unwrap().count(), 4);
    }

    #[test]
    fn the_copy_of_a_shader_holds_what_it_includes_and_its_scene_draws_its_picture() {
        let place = tempfile::tempdir().unwrap();
        let (shader, scenes) = (place.path().join("ball.glsl"), place.path().join("scenes"));
        fs::write(place.path().join("map.glsl"), "float map(vec3 p) { return length(p) - 1.0; }\n").unwrap();
        fs::write(&shader, format!("#include \"map.glsl\"\n{DISC}")).unwrap();
        let imported = import_shader(&shader, &scenes).unwrap();
        assert!(imported.notes[0].contains("--as shape"), "{:?}", imported.notes);
        let ready = SceneSource::File(imported.scene).ready().unwrap();
        assert!(ready.world.scene.objects.is_empty());
        assert!(fs::read_to_string(scenes.join("ball.glsl")).unwrap().starts_with("float map"));
    }

    #[test]
    fn a_shader_that_cannot_become_a_scene_writes_nothing() {
        let place = tempfile::tempdir().unwrap();
        let scenes = place.path().join("scenes");
        let reason = |name: &str, bytes: &[u8]| {
            let shader = place.path().join(name);
            fs::write(&shader, bytes).unwrap();
            import_shader(&shader, &scenes).unwrap_err().to_string()
        };
        let mistake = reason("a.glsl", b"\nvoid mainImage(out vec4 c, in vec2 f) { c = vec4(a); }");
        assert!(
            mistake.contains("a.glsl cannot become a scene: line 2: there is no `a` here; declare"),
            "{mistake}"
        );
        assert!(reason("a.txt", b"").contains("rename it"));
        assert!(reason("b.glsl", b"\xff").contains("byte 0 is not UTF-8"));
        assert!(reason("c.glsl", &vec![b' '; FIELD_LIMITS.scene_bytes_max + 1]).contains("split it"));
        let missing = import_shader(&place.path().join("none.glsl"), &scenes).unwrap_err();
        assert!(matches!(missing, ShaderError::File { problem: TextError::Unreadable(_), .. }), "{missing}");
        fs::create_dir(place.path().join("folder.glsl")).unwrap();
        let folder = import_shader(&place.path().join("folder.glsl"), &scenes).unwrap_err();
        assert!(folder.to_string().contains("not a file"), "{folder}");
        assert!(!scenes.exists());
    }
}
