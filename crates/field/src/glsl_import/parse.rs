//! Parses prepared text with naga. A function that naga refuses is replaced by a function that reports the mistake
//! when a scene calls it, so that one function does not spoil a file.

use std::collections::{BTreeMap, HashMap};

use naga::front::glsl::{Error, ErrorKind, ExpectedToken, Frontend, Options, TokenValue};
use naga::{Function, Handle, Module, ScalarKind, ShaderStage, Type, TypeInner};

use super::Result;
use super::isf::Inputs;
use super::items::{self, Origin, shortened};
use super::outside::{self, Channel};
use super::preprocess::{PRELUDE, preprocess};
use super::quiet::catch_quietly;
use super::rewrite::{BROKEN, DRAWING, Globals, IMAGE, IMAGE_IN_SCENES, START, ShaderItems, Written};
use super::tokens::tokenize;
use crate::lang::{Diagnostic, Span, nearest};
use crate::limits::Limits;

/// The type of a parameter or result that scenes know.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GlslType {
    /// A `float`.
    Float,
    /// An `int` or `uint`.
    Whole,
    /// A `bool`.
    Bool,
    /// A `vec2`, `vec3` or `vec4`.
    Vector(u8),
}

/// A parameter of a GLSL function.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GlslParameter {
    /// The name; may be empty.
    pub name: String,
    /// The type; `None` if a scene has no such values.
    pub of: Option<GlslType>,
}

/// A function that a GLSL file defines.
#[derive(Debug, Clone)]
pub struct GlslFunction {
    /// The name.
    pub name: String,
    /// The parameters.
    pub parameters: Vec<GlslParameter>,
    /// The type of the result; `None` for `void` and for types that scenes lack.
    pub result: Option<GlslType>,
    /// The bytes of the GLSL text at which the function begins.
    pub place: Span,
    /// True for the function that returns the colour of a pixel of the picture.
    pub is_picture: bool,
    pub(super) handle: Handle<Function>,
}

impl GlslFunction {
    /// True if a scene has values of the types of all parameters and of the result.
    pub fn is_callable(&self) -> bool {
        self.result.is_some() && self.parameters.iter().all(|parameter| parameter.of.is_some())
    }
}

impl std::fmt::Display for GlslFunction {
    /// Writes the name and the parameters with their types, as the scene language writes them.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}(", self.name)?;
        for (index, parameter) in self.parameters.iter().enumerate() {
            let of = match parameter.of {
                Some(GlslType::Float) => "number",
                Some(GlslType::Whole) => "whole number",
                Some(GlslType::Bool) => "bool",
                Some(GlslType::Vector(2)) => "vec2",
                Some(GlslType::Vector(3)) => "vec3",
                Some(GlslType::Vector(_)) => "vec4",
                None => "a type of GLSL",
            };
            write!(f, "{}{}: {of}", if index > 0 { ", " } else { "" }, parameter.name)?;
        }
        f.write_str(")")
    }
}

/// The meaning of a function that `rewrite` adds.
#[derive(Debug, Clone, Copy)]
pub(super) enum Special {
    Texture,
    Texel,
    TextureSize,
    Broken(usize),
}

/// A parsed GLSL file.
#[derive(Debug)]
pub struct GlslFile {
    pub(super) module: Module,
    pub(super) written: Written,
    pub(super) problems: Vec<Diagnostic>,
    pub(super) globals: Globals,
    /// Functions that give globals their values, in the order of the text.
    pub(super) starts: Vec<Handle<Function>>,
    pub(super) special: HashMap<Handle<Function>, Special>,
    functions: Vec<GlslFunction>,
}

impl GlslFile {
    /// Parses a GLSL text.
    ///
    /// # Errors
    /// The first problem outside the bodies of functions. Problems in a function's body are errors of its calls
    /// ([`GlslFile::problem_of`]).
    pub fn parse(text: &str, limits: &Limits) -> Result<Self> {
        let max = limits.scene_bytes_max;
        if text.len() > max {
            let message = format!("the GLSL is larger than {max} bytes");
            return Err(Diagnostic::over_limit(Span::default(), message).hint("split it into several files"));
        }
        let inputs = Inputs::of(text)?;
        let before = format!("{PRELUDE}{}", inputs.declarations);
        let mut tokens = tokenize(&before, limits.scene_tokens_max)?;
        tokens.iter_mut().for_each(|token| (token.start, token.end) = (0, 0));
        tokens.extend(tokenize(text, limits.scene_tokens_max)?);
        let expanded = preprocess(&tokens, limits.scene_tokens_max)?;
        let mut program = ShaderItems::new(items::split(&expanded)?, inputs);
        let (mut broken, mut problems) = (BTreeMap::new(), Vec::new());
        let mut bytes = 0;
        for _ in 0..ROUNDS_MAX {
            let written = program.write(&broken, &problems);
            bytes += written.text.len();
            if bytes > BYTES_MAX.max(written.text.len()) {
                break;
            }
            let errors = match read(&written.text) {
                Ok(module) => {
                    program.globals.with_values.retain(|_, item| !broken.contains_key(item));
                    return Ok(Self::of(module, written, problems, program));
                }
                Err(errors) => errors,
            };
            let known = broken.len();
            for error in &errors {
                let (problem, item) = problem_of(error, &written, &program);
                match item {
                    Some(item) if program.may_break(item) => {
                        broken.entry(item).or_insert_with(|| {
                            problems.push(problem);
                            problems.len() - 1
                        });
                    }
                    _ => return Err(problem),
                }
            }
            if broken.len() == known {
                break;
            }
        }
        let message = format!("more than {ROUNDS_MAX} functions of the GLSL have mistakes");
        let first = problems.into_iter().next();
        Err(first.unwrap_or_else(|| Diagnostic::over_limit(Span::default(), message)))
    }

    fn of(module: Module, written: Written, problems: Vec<Diagnostic>, program: ShaderItems<'_>) -> Self {
        let (mut functions, mut starts, mut special) = (Vec::new(), Vec::new(), HashMap::new());
        for (handle, function) in module.functions.iter() {
            let name = function.name.clone().unwrap_or_default();
            let added = match name.as_str() {
                "glsl_texture" => Some(Special::Texture),
                "glsl_texel" => Some(Special::Texel),
                "glsl_texture_size" => Some(Special::TextureSize),
                name => name.strip_prefix(BROKEN).and_then(|number| number.parse().ok()).map(Special::Broken),
            };
            let span = range(module.functions.get_span(handle));
            // A scene calls a function that draws by the function that returns the colour.
            let draws = DRAWING.contains(&name.as_str()) || name == "main_";
            if let Some(added) = added {
                special.insert(handle, added);
            } else if name.starts_with(START) {
                starts.push(handle);
            } else if !draws && written.is_own(span.start) {
                let is_picture = name == IMAGE;
                let parameters = function.arguments.iter().map(|argument| GlslParameter {
                    name: argument.name.as_deref().unwrap_or("").replace("glsl_", ""),
                    of: type_of(&module, argument.ty),
                });
                let result = function.result.as_ref().and_then(|result| type_of(&module, result.ty));
                functions.push(GlslFunction {
                    name: if is_picture { IMAGE_IN_SCENES.to_owned() } else { name },
                    parameters: parameters.collect(),
                    result,
                    place: if is_picture { program.image_place() } else { written.source_range(span) },
                    is_picture,
                    handle,
                });
            }
        }
        Self { module, written, problems, globals: program.globals, starts, special, functions }
    }

    /// Returns the functions of the file. A function that draws is there as a function of the pixel that returns its
    /// colour ([`GlslFunction::is_picture`]).
    pub fn functions(&self) -> &[GlslFunction] {
        &self.functions
    }

    /// Returns the mistake in a function's body, if there is one. Calls of the function report it.
    pub fn problem_of(&self, function: &GlslFunction) -> Option<&Diagnostic> {
        let body = &self.module.functions.try_get(function.handle).ok()?.body;
        body.iter().find_map(|statement| {
            let naga::Statement::Call { function, .. } = statement else { return None };
            let Special::Broken(index) = self.special.get(function)? else { return None };
            self.problems.get(*index)
        })
    }

    /// Returns the names of all uniforms. A scene may set them with parameters and lets of the same name.
    pub fn uniforms(&self) -> impl Iterator<Item = &str> {
        let uniforms = self.globals.outside.iter().filter(|(_, origin)| **origin == Origin::Uniform);
        uniforms.map(|(name, _)| name.as_str())
    }

    /// Returns the uniforms that have neither a value in the file nor a meaning in a scene: name and number of
    /// components.
    pub fn open_uniforms(&self) -> Vec<(&str, usize)> {
        let uniforms = self.module.global_variables.iter().filter_map(|(_, global)| {
            let name = global.name.as_deref()?;
            let len = match type_of(&self.module, global.ty)? {
                GlslType::Vector(size) => usize::from(size),
                _ => 1,
            };
            let is_open = self.globals.outside.get(name) == Some(&Origin::Uniform)
                && outside::is_open(name)
                && !self.is_sampler(name)
                && !self.globals.with_values.contains_key(name);
            is_open.then_some((name, len))
        });
        uniforms.collect()
    }

    /// True if a value from outside, such as the time, may differ between frames.
    pub fn reads_frame(&self) -> bool {
        !self.globals.outside.is_empty()
    }

    /// Returns the function that draws the picture.
    pub fn picture(&self) -> Option<&GlslFunction> {
        self.functions.iter().find(|function| function.is_picture)
    }

    /// True if functions of the file may read the pixel without being given it.
    pub fn reads_pixel(&self) -> bool {
        let reads =
            |(name, origin): (&String, &Origin)| *origin == Origin::Varying || outside::is_of_pixel(name);
        self.globals.outside.iter().any(reads)
    }

    /// The samplers of an ISF shader that read an image.
    pub(super) fn pictures(&self) -> impl Iterator<Item = &str> {
        let pictures = self.globals.samplers.iter().filter(|(_, channel)| **channel == Channel::Picture);
        pictures.map(|(name, _)| name.as_str()).filter(|name| !outside::is_taken(name))
    }

    /// True for the name of a texture.
    pub fn is_sampler(&self, name: &str) -> bool {
        self.globals.samplers.contains_key(name)
    }

    /// True if functions of the file may read the last frame.
    pub fn reads_last_frame(&self) -> bool {
        self.globals.samplers.values().any(|channel| *channel == Channel::LastFrame)
    }
}

/// Maximum number of attempts to parse a file, each with at least one more function left out.
const ROUNDS_MAX: usize = 96;
/// Maximum number of bytes in all attempts together, so that a large file with many mistakes takes no longer than a
/// few seconds.
const BYTES_MAX: usize = 4 << 20;

/// Runs naga. Its front end may panic on odd text; such a panic becomes an error without a place.
fn read(text: &str) -> Result<Module, Vec<Error>> {
    let options = Options::from(ShaderStage::Fragment);
    match catch_quietly(|| Frontend::default().parse(&options, text)) {
        Some(Ok(module)) => Ok(module),
        Some(Err(errors)) => Err(errors.errors),
        None => {
            let kind = ErrorKind::InternalError("naga cannot read this text");
            Err(vec![Error { kind, meta: naga::Span::UNDEFINED }])
        }
    }
}

pub(super) fn range(span: naga::Span) -> Span {
    span.to_range().map_or(Span::default(), |range| Span::new(range.start as u32, range.end as u32))
}

fn problem_of(error: &Error, written: &Written, program: &ShaderItems<'_>) -> (Diagnostic, Option<usize>) {
    let span = range(error.meta);
    let item = if error.meta.is_defined() { written.source(span.start).map(|found| found.1) } else { None };
    let place = written.source_range(span);
    let problem = match &error.kind {
        ErrorKind::UnknownVariable(name) => {
            Diagnostic::new(place, format!("there is no `{}` here", shortened(name)))
                .hint("declare it in this file, before its use")
        }
        ErrorKind::UnknownField(name) => {
            Diagnostic::new(place, format!("there is no component `{}` here", shortened(name)))
        }
        ErrorKind::VariableAlreadyDeclared(name) => {
            Diagnostic::new(place, format!("`{}` is declared twice", shortened(name)))
                .hint("give one of them another name")
        }
        ErrorKind::NotImplemented(what) | ErrorKind::InternalError(what) => {
            Diagnostic::unsupported(place, format!("this GLSL is not supported: {what}"))
        }
        ErrorKind::EndOfFile => Diagnostic::new(place, "the GLSL ends too early").hint("check the brackets"),
        ErrorKind::SemanticError(text) if text.starts_with("Unknown function '") => {
            let name = text.split('\'').nth(1).unwrap_or("");
            if item.and_then(|item| program.name_of(item)).is_some_and(|own| own.is(name)) {
                Diagnostic::unsupported(place, format!("`{}` calls itself", shortened(name)))
                    .hint("write a loop instead of the recursion")
            } else if ["imageLoad", "imageStore", "imageSize"].contains(&name)
                || name.starts_with("imageAtomic")
            {
                let message = format!("`{}` uses an image to which the shader writes", shortened(name));
                Diagnostic::unsupported(place, message)
                    .hint("a scene keeps the last frame alone: read `backbuffer`")
            } else {
                let message = format!("there is no function `{}` for these arguments", shortened(name));
                match nearest(name, program.names()).filter(|similar| *similar != name) {
                    None => Diagnostic::new(place, message).hint("declare it in this file, before its use"),
                    similar => Diagnostic::new(place, message).did_you_mean(similar),
                }
            }
        }
        ErrorKind::InvalidToken(_, expected) => {
            let found = written.text.get(span.start as usize..span.end as usize).unwrap_or_default();
            let problem = Diagnostic::new(place, format!("`{}` does not belong here", shortened(found)));
            let expects = |token: ExpectedToken| expected.contains(&token);
            if expects(TokenValue::Semicolon.into()) {
                problem.hint("end the statement before it with `;`")
            } else if expects(TokenValue::RightParen.into()) {
                problem.hint("close the bracket before it with `)`")
            } else if expects(ExpectedToken::Eof) {
                problem.hint("begin with a type, such as `float`")
            } else {
                problem
            }
        }
        kind => {
            let message: String = kind.to_string().chars().take(200).collect();
            Diagnostic::new(place, format!("this GLSL has a mistake: {message}"))
        }
    };
    (problem, item)
}

fn type_of(module: &Module, of: Handle<Type>) -> Option<GlslType> {
    Some(match module.types.get_handle(of).ok()?.inner {
        TypeInner::Scalar(scalar) => match scalar.kind {
            ScalarKind::Float => GlslType::Float,
            ScalarKind::Sint | ScalarKind::Uint => GlslType::Whole,
            ScalarKind::Bool => GlslType::Bool,
            _ => return None,
        },
        TypeInner::Vector { size, scalar } if scalar.kind == ScalarKind::Float => {
            GlslType::Vector(size as u8)
        }
        _ => return None,
    })
}
