//! Checks shader text with two strict compilers: glslang and naga.
//!
//! naga reads Vulkan GLSL 4.50, but the renderer uses OpenGL GLSL 3.30. [`vulkan_form`] converts the text line by line,
//! so that the line numbers stay the same:
//!
//! | OpenGL 3.30 | Vulkan 4.50 |
//! |---|---|
//! | `#version 330 core` | `#version 450` |
//! | `layout(std140) uniform Block {` | `layout(std140, set = 0, binding = N) uniform Block {` |
//! | `uniform sampler2D name;` | `uniform texture2D name_texture;` and `uniform sampler name_sampler;` in set 1 |
//! | `uniform usampler2D name;`, `uniform sampler2DArray name;` | the same with `utexture2D`, `texture2DArray` |
//! | `name` as an argument | `sampler2D(name_texture, name_sampler)` |
//! | `gl_VertexID` | `gl_VertexIndex` |
//! | `uniform usamplerBuffer regions;`, which naga does not support | `uvec4 fetch_regions(int texel)` |
//! | `uniform samplerBuffer sound_tables;`, likewise | `vec4 fetch_sound_tables(int texel)` |
//! | `texelFetch(regions, texel)` | `fetch_regions(texel)` |
//!
//! glslang expands the macros first; `TEXEL(regions, texel)` then is a call of `texelFetch`.

use std::io::Write;
use std::process::Command;

use mariana::gpu::program::{TEXTURE_UNITS, UNIFORM_BLOCKS, numbered_textures};
use naga::front::glsl::{Frontend, Options};
use naga::valid::{Capabilities, ValidationFlags, Validator};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Stage {
    Vertex,
    Fragment,
}

impl Stage {
    pub(crate) fn of(file: &str) -> Self {
        match file.rsplit_once('.').map(|(_, extension)| extension) {
            Some("vert") => Self::Vertex,
            Some("frag") => Self::Fragment,
            _ => panic!("{file}: expected the extension .vert or .frag"),
        }
    }
}

/// Runs glslangValidator on `text`. Returns the validator's output; if the validator rejects the text, as an error.
fn run_glslang(stage: Stage, text: &str, options: &[&str]) -> Result<String, String> {
    let suffix = if stage == Stage::Vertex { ".vert" } else { ".frag" };
    let mut file = tempfile::Builder::new().suffix(suffix).tempfile().unwrap();
    file.write_all(text.as_bytes()).unwrap();
    let output =
        Command::new("glslangValidator").args(options).arg(file.path()).output().unwrap_or_else(|error| {
            panic!(
                "cannot run glslangValidator ({error}): install it (Debian: glslang-tools, Fedora: glslang, \
             Arch: glslang, Homebrew: glslang)"
            )
        });
    let printed = String::from_utf8_lossy(&output.stdout).into_owned();
    if output.status.success() {
        return Ok(printed);
    }
    let reported_problems = printed + &String::from_utf8_lossy(&output.stderr);
    Err(with_quoted_lines(text, reported_problems.trim()))
}

/// Checks a whole shader with glslang. The error quotes the rejected lines.
pub(crate) fn check_with_glslang(stage: Stage, text: &str) -> Result<(), String> {
    run_glslang(stage, text, &[]).map(drop)
}

/// Adds the quoted line to each message `ERROR: FILE:LINE: ...` of glslang.
fn with_quoted_lines(text: &str, reported_problems: &str) -> String {
    let mut quoted = String::new();
    for complaint in reported_problems.lines() {
        quoted.push_str(complaint);
        quoted.push('\n');
        let number = complaint.strip_prefix("ERROR: ").and_then(|rest| rest.split(':').nth(1)?.parse().ok());
        let line = number.and_then(|number: usize| text.lines().nth(number.checked_sub(1)?));
        if let Some(line) = line {
            quoted.push_str(&format!("    | {line}\n"));
        }
    }
    quoted
}

/// The file name in naga's messages. The line numbers in the messages count the lines of the text with all includes.
const REWRITTEN: &str = "rewritten, whole shader";

/// Checks a whole OpenGL shader with naga's GLSL front end and validator. The error quotes the rejected line of the
/// converted text.
pub(crate) fn check_with_naga(stage: Stage, text: &str) -> Result<(), String> {
    let expanded = run_glslang(stage, text, &["-E"])?;
    let vulkan = vulkan_form(&expanded)?;
    let naga_stage = match stage {
        Stage::Vertex => naga::ShaderStage::Vertex,
        Stage::Fragment => naga::ShaderStage::Fragment,
    };
    let module = Frontend::default()
        .parse(&Options::from(naga_stage), &vulkan)
        .map_err(|errors| errors.emit_to_string_with_path(&vulkan, REWRITTEN))?;
    Validator::new(ValidationFlags::all(), Capabilities::empty())
        .validate(&module)
        .map_err(|error| error.emit_to_string_with_path(&vulkan, REWRITTEN))?;
    Ok(())
}

/// Converts OpenGL 3.30 text to Vulkan 4.50 text, by the table in the module's documentation. Fails if a uniform
/// block or a texture has no fixed binding, because the renderer would not bind the block or texture.
pub(crate) fn vulkan_form(text: &str) -> Result<String, String> {
    let samplers: Vec<(&str, &str, &str)> = text.lines().filter_map(declared_sampler).collect();
    let mut vulkan = String::new();
    for line in text.lines() {
        let fetching = line
            .replace("texelFetch(regions, ", "fetch_regions(")
            .replace("texelFetch(sound_tables, ", "fetch_sound_tables(");
        let line = fetching.as_str();
        if line.starts_with("uniform usamplerBuffer regions;") {
            vulkan.push_str("uvec4 fetch_regions(int texel) { return uvec4(uint(texel)); }");
        } else if line.starts_with("uniform samplerBuffer sound_tables;") {
            vulkan.push_str("vec4 fetch_sound_tables(int texel) { return vec4(float(texel)); }");
        } else if line.starts_with("#version") {
            vulkan.push_str("#version 450");
        } else if let Some((kind, array, name)) = declared_sampler(line) {
            let unit = unit_of(name)?;
            vulkan.push_str(&format!(
                "layout(set = 1, binding = {}) uniform {kind}texture2D{array} {name}_texture; \
                 layout(set = 1, binding = {}) uniform sampler {name}_sampler;",
                2 * unit,
                2 * unit + 1
            ));
        } else if let Some(name) = declared_block(line) {
            let binding = place_of(&UNIFORM_BLOCKS, name)?;
            vulkan.push_str(&line.replacen("std140", &format!("std140, set = 0, binding = {binding}"), 1));
        } else {
            for token in identifiers_and_rest(line) {
                if let Some((kind, array, _)) = samplers.iter().find(|(.., name)| *name == token) {
                    vulkan.push_str(&format!("{kind}sampler2D{array}({token}_texture, {token}_sampler)"));
                } else if token == "gl_VertexID" {
                    vulkan.push_str("gl_VertexIndex");
                } else {
                    vulkan.push_str(token);
                }
            }
        }
        vulkan.push('\n');
    }
    Ok(vulkan)
}

/// Parses a line `uniform sampler2D name;` or `uniform sampler2DArray name;`. Returns the prefix of `sampler2D` (empty or
/// "u"), its suffix (empty or "Array"), and the name.
fn declared_sampler(line: &str) -> Option<(&str, &str, &str)> {
    let (kind, rest) = line.trim().strip_prefix("uniform ")?.split_once("sampler2D")?;
    let (array, rest) = rest.split_once(' ')?;
    Some((kind, array, rest.split_once(';')?.0.trim()))
}

fn declared_block(line: &str) -> Option<&str> {
    let (layout, rest) = line.split_once("uniform ")?;
    layout.contains("std140").then(|| rest.split('{').next().unwrap_or(rest).trim())
}

fn place_of(places: &[(&str, u32)], name: &str) -> Result<u32, String> {
    let place = places.iter().find(|(known, _)| *known == name);
    place.map(|(_, place)| *place).ok_or_else(|| format!("'{name}' has no fixed binding in the program"))
}

fn unit_of(name: &str) -> Result<u32, String> {
    let numbered = numbered_textures().find(|(known, _)| known == name);
    numbered.map_or_else(|| place_of(&TEXTURE_UNITS, name), |(_, unit)| Ok(unit))
}

/// Splits a line into identifiers (or numbers) and the text between them.
fn identifiers_and_rest(line: &str) -> impl Iterator<Item = &str> {
    let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let mut rest = line;
    std::iter::from_fn(move || {
        let word = is_word(rest.chars().next()?);
        let end = rest.find(|c| is_word(c) != word).unwrap_or(rest.len());
        let (token, after) = rest.split_at(end);
        rest = after;
        Some(token)
    })
}
