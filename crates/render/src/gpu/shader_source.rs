//! Loads shader texts and resolves their includes.
//!
//! A shader is a file in `shaders/`. A line `#include "name.glsl"` includes a file of the same folder by its bare name.
//! Each file is included once per shader, even if several lines name it. The files are embedded in the binary. For
//! editing, `--shaders DIR` reads them from disk instead. This module does not use OpenGL.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use super::api::Api;
pub use super::error::ShaderSourceError;
use super::gl::GlInfo;
use super::texel_list::ROW_BITS;
use crate::flash::rules_glsl;
use crate::limits;
use mariana_field::lang::material_glsl;
use mariana_field::limits::LIMITS as FIELD_LIMITS;
use mariana_shaders::SHADERS;

/// A generated file: the material fields of the shaders, from the table of fields.
const MATERIAL_FIELDS: &str = "material_fields.glsl";

/// A generated file: the constants of the flash limiter, shared with the limiter on the CPU.
const FLASH_RULES: &str = "flash_rules.glsl";

/// The first lines of every shader: the version of GLSL, the precisions and the rows of lists for OpenGL ES, and the
/// define `SOFTWARE` for software renderers.
pub fn driver_preamble(info: &GlInfo) -> String {
    let mut lines = match info.api {
        Api::Desktop => "#version 330 core\n".to_owned(),
        Api::Embedded => {
            let precisions = ["float", "int", "sampler2D", "sampler2DArray", "usampler2D"];
            let precisions = precisions.map(|kind| format!("precision highp {kind};\n")).concat();
            format!("#version 300 es\n{precisions}#define LIST_ROW_BITS {ROW_BITS}\n")
        }
    };
    if info.software {
        lines.push_str("#define SOFTWARE 1\n");
    }
    lines
}

/// A folder of shader files, embedded or on disk.
#[derive(Debug, Clone, Default)]
pub struct ShaderLibrary {
    folder: Option<PathBuf>,
}

impl ShaderLibrary {
    /// The shaders embedded in the binary.
    pub fn embedded() -> Self {
        Self { folder: None }
    }

    /// The shaders of `folder`, which are read again at every [`ShaderLibrary::assemble`].
    pub fn on_disk(folder: &Path) -> Self {
        Self { folder: Some(folder.to_owned()) }
    }

    /// Assembles the text of `name`: `preamble`, the variant's macros, and the file with all includes. Generated files
    /// take precedence. Comments mark where files begin and continue, for [`name_places`]. A `#line` would not suffice,
    /// because Mesa forgets the file of a `#line` at the next `#ifdef`.
    ///
    /// # Errors
    /// Fails if a file is missing or unreadable, an include line has no bare name, or the text is too deep or too long.
    pub fn assemble(
        &self,
        name: &str,
        preamble: &str,
        variant: &Variant,
    ) -> Result<String, ShaderSourceError> {
        let generated = &variant.generated;
        let mut assembly =
            Assembly { library: self, generated, included: HashSet::new(), text: preamble.to_owned() };
        assembly.text.extend(variant.defines.iter().map(|define| format!("#define {define}\n")));
        assembly.append(name, "the program", 0)?;
        Ok(assembly.text)
    }

    fn read(&self, name: &str, asked_by: &str) -> Result<String, ShaderSourceError> {
        match &self.folder {
            Some(folder) => {
                let path = folder.join(name);
                std::fs::read_to_string(&path).map_err(|error| {
                    ShaderSourceError(format!(
                        "the shader file {} cannot be read ({error}): give --shaders a folder that holds every file \
                         of shaders/",
                        path.display()
                    ))
                })
            }
            None => {
                let text = SHADERS.get_file(name).and_then(|file| file.contents_utf8()).map(str::to_owned);
                text.ok_or_else(|| {
                    ShaderSourceError(format!(
                        "there is no shader file '{name}' (included in {asked_by}): correct the name in the #include \
                         line"
                    ))
                })
            }
        }
    }
}

/// The macros and generated files of one variant of a shader.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Variant {
    /// Macros, each as `NAME` or `NAME VALUE`.
    pub defines: Vec<String>,
    /// Names and texts of the files that are generated for a scene.
    pub generated: Vec<(String, String)>,
}

impl Variant {
    /// A variant with macros only.
    pub fn of(defines: &[&str]) -> Self {
        Self { defines: defines.iter().map(|define| (*define).to_owned()).collect(), generated: Vec::new() }
    }
}

struct Assembly<'a> {
    library: &'a ShaderLibrary,
    generated: &'a [(String, String)],
    included: HashSet<String>,
    text: String,
}

impl Assembly<'_> {
    fn append(&mut self, name: &str, asked_by: &str, depth: usize) -> Result<(), ShaderSourceError> {
        if depth > FIELD_LIMITS.include_depth_max {
            let limit = FIELD_LIMITS.include_depth_max;
            return Err(ShaderSourceError(format!(
                "{name}: shader includes are nested deeper than {limit}: remove some"
            )));
        }
        if !self.included.insert(name.to_owned()) {
            return Ok(());
        }
        let generated = self.generated.iter().find(|(generated, _)| generated == name);
        let source = match generated {
            Some((_, text)) => text.clone(),
            None if name == MATERIAL_FIELDS => material_glsl(),
            None if name == FLASH_RULES => rules_glsl(),
            None => self.library.read(name, asked_by)?,
        };
        self.mark(name, 1);
        for (index, line) in source.lines().enumerate() {
            if let Some(rest) = line.trim_start().strip_prefix("#include") {
                let place = format!("{name}:{}", index + 1);
                let bare = bare_name(rest).ok_or_else(|| {
                    ShaderSourceError(format!(
                        "{place}: write the include as #include \"name.glsl\", with a file name and no folder"
                    ))
                })?;
                self.append(bare, &place, depth + 1)?;
                self.mark(name, index + 2);
            } else {
                self.text.push_str(line);
                self.text.push('\n');
            }
            if self.text.len() > limits::SHADER_BYTES_MAX {
                let limit = limits::SHADER_BYTES_MAX;
                return Err(ShaderSourceError(format!(
                    "{name}: the shader with its includes is longer than {limit} bytes: remove some of them"
                )));
            }
        }
        Ok(())
    }

    fn mark(&mut self, file: &str, line: usize) {
        self.text.push_str(&format!("{PLACE_MARK}{file}:{line}\n"));
    }
}

/// Starts a comment with the file and line of the following text.
const PLACE_MARK: &str = "//@ ";

/// The origin of line number `line` (from 1) of an assembled text, as `name:line`.
fn place_at(text: &str, line: usize) -> Option<String> {
    let before: Vec<&str> = text.lines().take(line.checked_sub(1)?).collect();
    let mark = before.iter().rposition(|line| line.starts_with(PLACE_MARK))?;
    let (file, first) = before.get(mark)?.strip_prefix(PLACE_MARK)?.rsplit_once(':')?;
    Some(format!("{file}:{}", first.parse::<usize>().ok()? + before.len() - mark - 1))
}

/// Replaces line numbers of an assembled `text` in a driver's `log` by file names and their line numbers. Drivers write
/// `0:12(3): ...`, `0(12) : ...` or `ERROR: 0:12: ...`.
pub fn name_places(log: &str, text: &str) -> String {
    let named = |line: &str| {
        let (_, rest) = line.strip_prefix("ERROR: ").unwrap_or(line).split_once([':', '('])?;
        let (number, rest) = rest.split_at(rest.find(|c: char| !c.is_ascii_digit())?);
        let place = place_at(text, number.parse().ok()?)?;
        Some(format!("{place}{}", rest.trim_start_matches(')')))
    };
    let lines = log.trim().lines().map(|line| named(line).unwrap_or_else(|| line.to_owned()));
    lines.collect::<Vec<_>>().join("\n")
}

fn bare_name(rest: &str) -> Option<&str> {
    let name = rest.trim().strip_prefix('"')?.strip_suffix('"')?;
    let bare = !name.is_empty() && !name.contains(['/', '\\', '"']) && name != "." && name != "..";
    bare.then_some(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn library(files: &[(&str, &str)]) -> (tempfile::TempDir, ShaderLibrary) {
        let folder = tempfile::tempdir().unwrap();
        for (name, text) in files {
            std::fs::write(folder.path().join(name), text).unwrap();
        }
        let library = ShaderLibrary::on_disk(folder.path());
        (folder, library)
    }

    #[test]
    fn a_file_is_included_once_and_lines_keep_their_numbers() {
        let (_folder, library) =
            library(&[("a", "one\n#include \"b\"\n#include \"b\"\nfour"), ("b", "in b\n#include \"a\"")]);
        let text = library.assemble("a", "#version 330 core\n", &Variant::of(&["X 1"])).unwrap();
        let expected =
            "#version 330 core\n#define X 1\n//@ a:1\none\n//@ b:1\nin b\n//@ b:3\n//@ a:3\n//@ a:4\nfour\n";
        assert_eq!(text, expected);
    }

    #[test]
    fn driver_messages_name_files_and_lines() {
        let (_folder, library) = library(&[("a", "one\n#include \"b\"\nthree"), ("b", "in b\nb two")]);
        let text = library.assemble("a", "#version 330 core\n", &Variant::default()).unwrap();
        let line = |wanted: &str| text.lines().position(|line| line == wanted).unwrap() + 1;
        let (two, three) = (line("b two"), line("three"));
        let log =
            format!("0:{two}(3): error: x\n0({three}) : error y\nERROR: 0:{two}: z\nnot a place: w\n\n");
        let expected = "b:2(3): error: x\na:3 : error y\nb:2: z\nnot a place: w";
        assert_eq!(name_places(&log, &text), expected);
    }

    #[test]
    fn an_include_with_a_folder_is_refused_with_its_line() {
        let (_folder, library) = library(&[("a", "one\n#include \"../b\"")]);
        let error = library.assemble("a", "", &Variant::default()).unwrap_err().to_string();
        assert!(error.starts_with("a:2:"), "{error}");
    }

    #[test]
    fn depth_and_length_have_limits() {
        let names: Vec<String> = (0..=FIELD_LIMITS.include_depth_max + 1).map(|i| format!("f{i}")).collect();
        let texts: Vec<String> =
            (0..names.len()).map(|i| format!("#include \"f{}\"", (i + 1).min(names.len() - 1))).collect();
        let files: Vec<(&str, &str)> =
            names.iter().zip(&texts).map(|(name, text)| (name.as_str(), text.as_str())).collect();
        let (_folder, deep) = library(&files);
        let error = deep.assemble("f0", "", &Variant::default()).unwrap_err().to_string();
        assert!(error.contains("includes are nested deeper than"), "{error}");

        let long_text = "// padding\n".repeat(limits::SHADER_BYTES_MAX / 11 + 1);
        let (_folder, long) = library(&[("long", &long_text)]);
        let error = long.assemble("long", "", &Variant::default()).unwrap_err().to_string();
        assert!(error.contains("the shader with its includes is longer than"), "{error}");
    }

    #[test]
    fn a_missing_file_is_named() {
        let error = ShaderLibrary::embedded()
            .assemble("no_such.frag", "", &Variant::default())
            .unwrap_err()
            .to_string();
        assert!(error.contains("no_such.frag"), "{error}");
        let (_folder, library) = library(&[]);
        let error = library.assemble("scene.frag", "", &Variant::default()).unwrap_err().to_string();
        assert!(error.contains("scene.frag"), "{error}");
    }
}
