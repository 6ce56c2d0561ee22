//! Sources of scenes: shipped scenes, scene files, and formulas from the command line.
//!
//! ```
//! use mariana_scenes::SceneSource;
//!
//! let source = SceneSource::find("smooth_union(sphere(p, 1), box(p, vec3(2, 0.1, 2)), 0.3)")?;
//! assert_eq!(source.ready()?.world.scene.objects.len(), 1);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A [`Loader`] compiles scenes on a thread, and compiles a scene again when its files or [`Drafts`] change.
//! [`probing`] finds the object at a point of an image. [`thumbnails`] draws previews in separate processes.
//!
//! A scene can read only its own folder. Includes and textures come from that folder, and shipped textures replace
//! missing textures. Links are resolved first, so that a link cannot lead out of the folder.

mod drafts;
mod error;
mod folder;
pub mod limits;
mod loader;
mod order;
pub mod probing;
mod shader_import;
mod shapes;
mod sources;
pub mod thumbnails;
mod world;

use mariana_files::reading::{TextError, read_text};
use std::borrow::Cow;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::sync::Arc;

pub use drafts::{DraftTexts, Drafts, Findings, Mistake, NumberEdits};
pub use error::{FoundMistakes, SceneError};
pub use loader::{Loaded, Loader};
pub use order::SceneList;
pub use shader_import::{
    ImportedShader, ShaderError, import_shader, is_copy, is_shader_file, read_shader, scene_of_shader,
};
pub use sources::{TextureSource, VIDEO_ENDINGS};
pub use world::{NEUTRAL, ReadyScene, SceneBlend, SeenScene, TextureCache, camera_number};

use folder::{ENDING, Folder};
use mariana_assets::SCENES;
use mariana_field::lang::{self, Compiled, is_shader};
use mariana_field::limits::LIMITS as FIELD_LIMITS;

/// The source of a scene, which can be compiled repeatedly.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum SceneSource {
    /// Name of a shipped scene.
    Shipped(String),
    /// A scene file.
    File(PathBuf),
    /// The text of a formula in `x`, `y`, `z`, or of a whole scene.
    Formula(String),
    /// A transition between two scenes. The source's text is the text of the incoming scene.
    Blend(Arc<SceneBlend>),
}

impl SceneSource {
    /// Interprets a command line argument: an existing file or a path that ends in `.scene`, the name of a
    /// shipped scene, or otherwise a formula.
    ///
    /// # Errors
    /// [`SceneError::Unknown`] if a single word is not a file and not a shipped scene; [`SceneError::Shader`] for a
    /// file of GLSL.
    pub fn find(argument: &(impl AsRef<OsStr> + ?Sized)) -> Result<Self, SceneError> {
        let path = Path::new(argument);
        if is_shader_file(path) {
            return Err(SceneError::Shader(path.to_owned()));
        }
        if path.exists() || is_scene_file(path) {
            return Ok(Self::File(path.to_owned()));
        }
        // Names and formulas are UTF-8; any other argument can only be a missing file.
        let Some(argument) = path.to_str() else { return Ok(Self::File(path.to_owned())) };
        if shipped(argument).is_some() {
            return Ok(Self::Shipped(argument.to_owned()));
        }
        let starts_as_name = argument.starts_with(|c: char| c.is_alphabetic() || c == '_');
        let word = starts_as_name && argument.chars().all(|c| c.is_alphanumeric() || "_-".contains(c));
        let known = lang::inputs().any(|(name, _)| name == argument);
        if word && !known {
            return Err(unknown(argument));
        }
        Ok(Self::Formula(argument.to_owned()))
    }

    /// Returns the name in messages.
    pub fn name(&self) -> String {
        match self {
            Self::Shipped(name) => format!("{name}.{ENDING}"),
            Self::File(path) => path.display().to_string(),
            Self::Formula(_) => "formula".to_owned(),
            Self::Blend(blend) => format!("{} into {}", blend.from.source.name(), blend.to.source.name()),
        }
    }

    /// Returns the scene's main file, if it has one.
    pub fn file(&self) -> Option<&Path> {
        match self {
            Self::File(path) => Some(path),
            Self::Shipped(_) | Self::Formula(_) => None,
            Self::Blend(blend) => blend.to.source.file(),
        }
    }

    /// Returns every file that the scene depends on: its main file, includes and textures, including unreadable
    /// files. Empty if the scene is not a file. `compiled` is `None` if the main file could not be read.
    pub fn files(&self, compiled: Option<&Compiled>) -> Vec<PathBuf> {
        let Self::File(path) = self else { return Vec::new() };
        let folder = Folder::of(path);
        let mut files = vec![path.clone()];
        if let Some(compiled) = compiled {
            files.extend(compiled.includes_asked.iter().map(|name| folder.path(name)));
            let textures = compiled.scene.iter().flat_map(|scene| &scene.textures);
            let files_of = textures.filter(|one| TextureSource::of(one).is_none_or(|of| of.is_file()));
            files.extend(files_of.map(|texture| folder.path(&texture.name)));
            let shapes = compiled.scene.iter().flat_map(|scene| &scene.shapes);
            files.extend(shapes.filter_map(shapes::file_of).map(|name| folder.path(name)));
        }
        files
    }

    /// Returns the title. The title of a file is the file's name without folder and extension.
    pub fn title(&self) -> String {
        match self {
            Self::Shipped(name) => name.clone(),
            Self::File(path) => {
                let name = path.file_stem().unwrap_or(path.as_os_str());
                // Titles must fit on one line.
                name.to_string_lossy().replace(char::is_control, " ")
            }
            Self::Formula(_) => "formula".to_owned(),
            Self::Blend(blend) => blend.to.source.title(),
        }
    }

    /// Reads and compiles the scene. Mistakes in the text are part of the result.
    ///
    /// # Errors
    /// Fails if a file cannot be read, is too large, or is not UTF-8.
    pub fn compile(&self) -> Result<Compiled, SceneError> {
        self.compile_following(&mut NumberEdits::default(), &DraftTexts::default())
    }

    /// Compiles the scene. A draft in `drafts` replaces its file. Numbers that `edits` finds changed since the last
    /// version become inputs.
    ///
    /// # Errors
    /// Fails like [`SceneSource::compile`].
    pub fn compile_following(
        &self,
        edits: &mut NumberEdits,
        drafts: &DraftTexts,
    ) -> Result<Compiled, SceneError> {
        Ok(match self.file().and_then(|file| Some((file, drafts.of(file)?))) {
            Some((file, draft)) => self.compile_as(text_of(file, draft)?, edits, drafts),
            None => self.compile_as(&self.text()?, edits, drafts),
        })
    }

    /// Reads the scene's text.
    ///
    /// # Errors
    /// Fails like [`SceneSource::compile`].
    pub fn text(&self) -> Result<Cow<'_, str>, SceneError> {
        match self {
            Self::Formula(text) => Ok(text.into()),
            Self::Shipped(name) => shipped(name).map(Cow::from).ok_or_else(|| unknown(name)),
            Self::File(path) => read(path).map(Cow::from),
            Self::Blend(blend) => blend.to.source.text(),
        }
    }

    fn compile_as(&self, text: &str, edits: &mut NumberEdits, drafts: &DraftTexts) -> Compiled {
        let name = self.name();
        match self {
            // Includes are relative to the working directory.
            Self::Formula(_) => lang::compile(&name, text, &mut including(Folder::of(Path::new("")), drafts)),
            Self::Shipped(_) => {
                let mut include = |path: &str| {
                    let file = SCENES.get_file(path).and_then(|file| file.contents_utf8());
                    file.map(str::to_owned).ok_or_else(|| "no such file is shipped".to_owned())
                };
                lang::compile(&name, text, &mut include)
            }
            Self::Blend(blend) => blend.to.source.compile_as(text, edits, drafts),
            Self::File(path) => {
                let turning = drafts.turning(path);
                let changing = edits.follow(self, text, !turning.is_empty());
                let mut include = including(Folder::of(path), drafts);
                lang::compile_while_changing(&name, text, &mut include, changing, turning)
            }
        }
    }
}

/// Reads the file `name`, which the scene file `scene` includes.
///
/// # Errors
/// Fails with a reason in plain words, also for a file outside of the scene's folder.
pub fn included_text(scene: &Path, name: &str) -> Result<String, String> {
    let text = Folder::of(scene).text(name, FIELD_LIMITS.scene_bytes_max);
    text.map_err(|refusal| refusal.to_string())
}

/// Returns a function that reads an include of a scene in `folder`, or the draft of the include.
fn including(folder: Folder, drafts: &DraftTexts) -> impl FnMut(&str) -> Result<String, String> {
    move |path| {
        let text = match drafts.of(&folder.path(path)) {
            Some(draft) => Folder::text_of(draft.to_vec()),
            None => folder.text(path, FIELD_LIMITS.scene_bytes_max),
        };
        text.map_err(|refusal| refusal.to_string())
    }
}

fn text_of<'a>(file: &Path, draft: &'a [u8]) -> Result<&'a str, SceneError> {
    std::str::from_utf8(draft).map_err(|error| SceneError::File {
        path: file.to_owned(),
        problem: TextError::NotText(error.valid_up_to()),
    })
}

/// True if the path has the extension of scene files.
pub fn is_scene_file(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending == ENDING)
}

/// Returns the lines of the comment at the start of a scene's text: its description. In GLSL, `#` begins no comment.
pub fn first_comment(text: &str) -> impl Iterator<Item = &str> {
    let sign = if is_shader(text) { "//" } else { "#" };
    let lines = text.lines().map(move |line| line.trim().strip_prefix(sign).map(str::trim));
    lines.take_while(Option::is_some).flatten().take_while(|line| !line.is_empty())
}

/// Returns the names of the shipped scenes, sorted.
pub fn shipped_names() -> Vec<String> {
    let mut names: Vec<String> = SCENES
        .files()
        .filter_map(|file| file.path().to_str()?.strip_suffix(&format!(".{ENDING}")).map(str::to_owned))
        .collect();
    names.sort();
    names
}

fn unknown(name: &str) -> SceneError {
    SceneError::Unknown { name: name.to_owned(), shipped: shipped_names().join(", ") }
}

fn shipped(name: &str) -> Option<&'static str> {
    SCENES.get_file(format!("{name}.{ENDING}"))?.contents_utf8()
}

fn read(path: &Path) -> Result<String, SceneError> {
    read_text(path, FIELD_LIMITS.scene_bytes_max)
        .map_err(|problem| SceneError::File { path: path.to_owned(), problem })
}

#[cfg(test)]
mod tests {
    use super::*;
    use mariana_field::lang::render_all;

    #[test]
    fn every_shipped_scene_compiles_without_warnings() {
        assert!(shipped_names().contains(&"speakers".to_owned()));
        for name in shipped_names() {
            let compiled = SceneSource::Shipped(name.clone()).compile().unwrap();
            assert!(compiled.scene.is_some(), "{name}:\n{}", compiled.render(false));
            let warnings = render_all(&compiled.warnings, &compiled.sources, false);
            assert!(warnings.is_empty(), "{name}:\n{warnings}");
        }
    }

    #[test]
    fn an_argument_is_a_file_a_name_or_a_formula() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("own.scene");
        std::fs::write(&file, "sqrt(x*x + y*y + z*z) - 1").unwrap();
        let argument = file.to_str().unwrap();
        assert_eq!(SceneSource::find(argument).unwrap(), SceneSource::File(file.clone()));
        assert_eq!(SceneSource::find("speakers").unwrap(), SceneSource::Shipped("speakers".into()));
        for formula in ["y", "x/2", "min(y, 1)", "-x"] {
            assert_eq!(SceneSource::find(formula).unwrap(), SceneSource::Formula(formula.into()));
        }
        let message = SceneSource::find("speekers").unwrap_err().to_string();
        assert!(message.contains("speekers") && message.contains("speakers"), "{message}");
    }

    #[test]
    fn a_title_is_always_one_line() {
        assert_eq!(SceneSource::File("two\nlines.scene".into()).title(), "two lines");
    }

    #[test]
    fn missing_too_large_and_binary_files_have_separate_errors() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        std::fs::write(path("large.scene"), vec![b' '; FIELD_LIMITS.scene_bytes_max + 1]).unwrap();
        std::fs::write(path("binary.scene"), [b'x', 0xff, 0xfe]).unwrap();
        let error = |name: &str| SceneSource::File(path(name)).compile().unwrap_err();
        let problem = |name: &str| match error(name) {
            SceneError::File { problem, .. } => problem,
            other => panic!("{other}"),
        };
        assert!(matches!(problem("missing.scene"), TextError::Unreadable(_)));
        assert!(matches!(problem("large.scene"), TextError::TooLarge(_)));
        assert!(matches!(problem("binary.scene"), TextError::NotText(1)));
    }

    #[test]
    fn includes_are_read_only_from_the_scenes_folder() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("in")).unwrap();
        std::fs::write(folder.path().join("outside.scene"), "fn ball(p) { length(p) - 1 }").unwrap();
        std::fs::write(folder.path().join("in/part.scene"), "fn ball(p) { length(p) - 1 }").unwrap();
        let compile = |include: &str| {
            let file = folder.path().join("in/main.scene");
            let text = format!("include \"{include}\"\nobject o {{ shape = ball(p) }}\n");
            std::fs::write(&file, text).unwrap();
            SceneSource::File(file).compile().unwrap()
        };
        let good = compile("part.scene");
        assert!(good.scene.is_some(), "{}", good.render(false));
        assert!(compile("../outside.scene").scene.is_none());
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink("../outside.scene", folder.path().join("in/link.scene")).unwrap();
            let refused = compile("link.scene");
            assert!(refused.scene.is_none());
            let message =
                "`link.scene` cannot be included: it is a link that leads out of the scene's folder";
            assert_eq!(refused.diagnostics.first().map(|one| one.message.as_str()), Some(message));
        }
    }

    #[test]
    fn the_files_of_a_scene_include_missing_ones() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let source = SceneSource::File(path("main.scene"));
        assert_eq!(source.files(None), [path("main.scene")]);
        std::fs::write(path("part.scene"), "include \"deep/none.scene\"").unwrap();
        let text = "include \"part.scene\"\nmaterial m { color = texture(\"a.png\", p.xy).rgb }\n\
                    object o { shape = length(p) - 1 material = m }";
        std::fs::write(path("main.scene"), text).unwrap();
        let files = ["main.scene", "part.scene", "deep/none.scene", "a.png"].map(path);
        assert_eq!(source.files(Some(&source.compile().unwrap())), files[..3]);
        std::fs::create_dir(path("deep")).unwrap();
        std::fs::write(path("deep/none.scene"), "").unwrap();
        let compiled = source.compile().unwrap();
        assert_eq!(source.files(Some(&compiled)), files, "{}", compiled.render(false));
        let speakers = SceneSource::Shipped("speakers".into());
        assert!(speakers.files(Some(&speakers.compile().unwrap())).is_empty());
    }
}
