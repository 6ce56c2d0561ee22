//! Writes items as GLSL 4.50 in the form that naga takes, and maps each word to its position in the user's text.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use super::isf::{Inputs, Slider};
use super::items::{Global, Item, Origin, brackets_length, closing, matching};
use super::outside::{self, Channel};
use super::tokens::{Kind, Token};
use crate::lang::{Diagnostic, Span};

/// The text for naga.
#[derive(Debug)]
pub(super) struct Written {
    pub text: String,
    /// For each word: its offset in the text, its place in the user's text, and the index of its item.
    places: Vec<(u32, Span, usize)>,
    /// Offset of the first item.
    own_from: u32,
}

impl Written {
    /// True for an offset in the text of an item, not in a declaration that this module adds.
    pub(super) fn is_own(&self, offset: u32) -> bool {
        offset >= self.own_from
    }

    /// Returns the place in the user's text and the item of an offset in the text.
    pub(super) fn source(&self, offset: u32) -> Option<(Span, usize)> {
        let index = self.places.partition_point(|(start, ..)| *start <= offset).checked_sub(1)?;
        let (_, place, item) = self.places.get(index)?;
        Some((*place, *item))
    }

    /// Returns the place in the user's text of a range of the text.
    pub(super) fn source_range(&self, range: Span) -> Span {
        let place = |offset| self.source(offset).map_or(Span::default(), |(place, _)| place);
        place(range.start).to(place(range.end.saturating_sub(1).max(range.start)))
    }

    fn push(&mut self, token: &Token<'_>, item: usize) {
        self.places.push((self.text.len() as u32, token.place(), item));
        self.text.push_str(token.text);
        self.text.push(if token.is(";") || token.is("}") { '\n' } else { ' ' });
    }

    fn extend<'t, 'a: 't>(&mut self, tokens: impl IntoIterator<Item = &'t Token<'a>>, item: usize) {
        for token in tokens {
            self.push(token, item);
        }
    }
}

/// The functions that read textures, under the names that naga sees.
const TEXTURES: &str = "\
vec4 glsl_texture(int s, float p) { return vec4(0.0); }
vec4 glsl_texture(int s, float p, float b) { return vec4(0.0); }
vec4 glsl_texture(int s, vec2 p) { return vec4(0.0); }
vec4 glsl_texture(int s, vec2 p, float b) { return vec4(0.0); }
vec4 glsl_texture(int s, vec3 p) { return vec4(0.0); }
vec4 glsl_texture(int s, vec3 p, float b) { return vec4(0.0); }
vec4 glsl_texture(int s, vec2 p, vec2 dx, vec2 dy) { return vec4(0.0); }
vec4 glsl_texel(int s, int p, int l) { return vec4(0.0); }
vec4 glsl_texel(int s, ivec2 p, int l) { return vec4(0.0); }
vec4 glsl_texel(int s, ivec3 p, int l) { return vec4(0.0); }
ivec2 glsl_texture_size(int s, int l) { return ivec2(256); }
";

/// Functions of GLSL that naga lacks, or has with other operands, by name.
const MISSING: [(&str, &str); 5] = [
    ("normalize", "float normalize(float a) { return sign(a); }\n"),
    ("dot", "float dot(float a, float b) { return a * b; }\n"),
    ("ldexp", "float ldexp(float a, int power) { return a * exp2(float(power)); }\n"),
    (
        "modf",
        "float modf(float a, out float whole) { whole = trunc(a); return a - whole; }
vec2 modf(vec2 a, out vec2 whole) { whole = trunc(a); return a - whole; }
vec3 modf(vec3 a, out vec3 whole) { whole = trunc(a); return a - whole; }
vec4 modf(vec4 a, out vec4 whole) { whole = trunc(a); return a - whole; }
",
    ),
    (
        "matrixCompMult",
        "mat2 matrixCompMult(mat2 a, mat2 b) { return mat2(a[0] * b[0], a[1] * b[1]); }
mat3 matrixCompMult(mat3 a, mat3 b) { return mat3(a[0] * b[0], a[1] * b[1], a[2] * b[2]); }
mat4 matrixCompMult(mat4 a, mat4 b) { return mat4(a[0] * b[0], a[1] * b[1], a[2] * b[2], a[3] * b[3]); }
",
    ),
];

/// The start of the names of functions that this module writes.
pub(super) const BROKEN: &str = "glsl_broken_";
/// A function that gives globals their values.
pub(super) const START: &str = "glsl_start_";

/// A function that returns the colour of a pixel. Scenes call it by the name [`IMAGE_IN_SCENES`].
pub(super) const IMAGE: &str = "glsl_image";
/// The name of the function that draws, in scenes.
pub(super) const IMAGE_IN_SCENES: &str = "mainImage";

/// Functions that draw a picture. A scene has its own camera and light.
pub(super) const DRAWING: [&str; 6] = ["main", "mainImage", "mainVR", "mainSound", "mainCubemap", "mainFull"];

/// The globals of a file that come from outside or from its drawing functions.
#[derive(Debug, Default)]
pub(super) struct Globals {
    /// Names of globals that the GLSL does not set itself.
    pub outside: HashMap<String, Origin>,
    /// Globals without a value, in the order of the text.
    pub unset: BTreeSet<String>,
    /// Globals from outside that have a value too, with the indices of their items.
    pub with_values: BTreeMap<String, usize>,
    /// Globals that read textures, with their channels.
    pub samplers: BTreeMap<String, Channel>,
    /// The inputs of an ISF shader that a user sets.
    pub sliders: Vec<Slider>,
    /// True for an ISF shader. Its alpha blends the colour with black.
    pub is_isf: bool,
    /// True if the file has a function that draws a picture, such as `mainImage`.
    pub has_drawing: bool,
}

/// The items of a file, and their globals.
pub(super) struct ShaderItems<'a> {
    items: Vec<Item<'a>>,
    pub globals: Globals,
    /// Statements of drawing functions that may set globals.
    sets: Vec<Vec<Token<'a>>>,
    given: Vec<String>,
    /// The function that returns the colour of a pixel, and the index of the function that it calls.
    image: Option<(String, usize)>,
}

impl<'a> ShaderItems<'a> {
    pub(super) fn new(items: Vec<Item<'a>>, inputs: Inputs) -> Self {
        let Inputs { sliders, is_isf, channels, .. } = inputs;
        let mut globals = Globals { sliders, is_isf, ..Globals::default() };
        let mut declared = BTreeSet::new();
        for (index, item) in items.iter().enumerate() {
            if let Item::Global(global) = item {
                let name = global.name.text;
                declared.insert(name);
                if is_sampler(global.of.text) {
                    globals.samplers.insert(name.to_owned(), outside::channel(name));
                }
                if matches!(global.origin, Origin::Uniform | Origin::Varying) {
                    globals.outside.insert(name.to_owned(), global.origin);
                    if !global.value.is_empty() {
                        globals.with_values.insert(name.to_owned(), index);
                    }
                } else if global.value.is_empty() {
                    globals.unset.insert(name.to_owned());
                }
            }
        }
        let image = image(&items);
        let mut used = BTreeSet::new();
        let mut sets = Vec::new();
        for (index, item) in items.iter().enumerate() {
            match item {
                Item::Function { name, header, body } if DRAWING.contains(&name.text) => {
                    globals.has_drawing = true;
                    sets.extend(settings(body, &globals.unset));
                    if image.as_ref().is_some_and(|(_, drawing)| *drawing == index) {
                        let is_parameter = |word: &&str| header.iter().any(|token| token.is(word));
                        used.extend(body.iter().map(|token| token.text).filter(|word| !is_parameter(word)));
                    }
                }
                Item::Function { header, body, .. } => {
                    used.extend(header.iter().chain(body).map(|token| token.text));
                }
                Item::Global(global) => used.extend(global.value.iter().map(|token| token.text)),
                Item::Plain(_) => {}
            }
        }
        used.extend(sets.iter().flatten().map(|token| token.text));
        if image.as_ref().is_some_and(|(text, _)| text.contains("gl_FragCoord")) {
            used.extend(["gl_FragCoord", "gl_FragColor"]);
        }
        let defines = |name: &str| {
            items.iter().any(|item| matches!(item, Item::Function { name: own, .. } if own.is(name)))
        };
        let missing = MISSING.iter().filter(|(name, _)| used.contains(name) && !defines(name));
        let mut given: Vec<String> = missing.map(|(_, text)| (*text).to_owned()).collect();
        for (name, of) in outside::given() {
            if used.contains(name) && !declared.contains(name) && !defines(name) {
                let (of, array) = of.split_at(of.find('[').unwrap_or(of.len()));
                given.push(format!("{} {name}{array};\n", renamed(of, false)));
                globals.outside.insert(name.to_owned(), Origin::Uniform);
                if is_sampler(of) {
                    globals.samplers.insert(name.to_owned(), outside::channel(name));
                }
            }
        }
        globals.samplers.extend(channels);
        Self { items, globals, sets, given, image }
    }

    /// Writes the program. Functions in `broken` keep their header, and their body calls a function whose name tells
    /// the index of the problem.
    pub(super) fn write(&self, broken: &BTreeMap<usize, usize>, problems: &[Diagnostic]) -> Written {
        let mut out = Written { text: String::from("#version 450\n"), places: Vec::new(), own_from: 0 };
        out.text.push_str(TEXTURES);
        for declaration in &self.given {
            out.text.push_str(declaration);
        }
        for index in 0..problems.len() {
            out.text.push_str(&format!("void {BROKEN}{index}() {{ }}\n"));
        }
        out.own_from = out.text.len() as u32;
        for (index, item) in self.items.iter().enumerate() {
            match item {
                Item::Plain(tokens) => out.extend(&in_shape(tokens), index),
                Item::Function { name, .. } if DRAWING.contains(&name.text) && !self.draws_with(index) => {}
                Item::Function { name, header, body } => {
                    out.extend(&in_shape(header), index);
                    match broken.get(&index) {
                        None => out.extend(&in_shape(body), index),
                        Some(problem) => {
                            let of = header.iter().take_while(|token| token.start != name.start);
                            let of: Vec<&str> = of.map(|token| token.text).collect();
                            let of = of.join(" ");
                            let result = if of == "void" {
                                String::new()
                            } else {
                                format!("{of} glsl_result; return glsl_result;")
                            };
                            out.text.push_str(&format!("{{ {BROKEN}{problem}(); {result} }}\n"));
                        }
                    }
                }
                Item::Global(global) => write_global(&mut out, global, index, broken.contains_key(&index)),
            }
        }
        if let Some((text, _)) = &self.image {
            out.text.push_str(text);
        }
        for (number, set) in self.sets.iter().enumerate() {
            let index = self.items.len() + number;
            if !broken.contains_key(&index) {
                out.text.push_str(&format!("void {START}{index}() {{ "));
                out.extend(&in_shape(set), index);
                out.text.push_str("}\n");
            }
        }
        out.text.push_str("void main() { }\n");
        out
    }

    /// True for the function that the scene's `mainImage` calls.
    fn draws_with(&self, index: usize) -> bool {
        self.image.as_ref().is_some_and(|(_, drawing)| *drawing == index)
    }

    /// The span of the name of the function that draws.
    pub(super) fn image_place(&self) -> Span {
        let drawing = self.image.as_ref().and_then(|(_, drawing)| self.name_of(*drawing));
        drawing.map_or(Span::default(), Token::place)
    }

    /// The names of all functions that a function may call.
    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        let name = |index| Some(self.name_of(index)?.text);
        (0..self.items.len()).filter_map(name).filter(|name| !DRAWING.contains(name))
    }

    /// The name of the function with this index.
    pub(super) fn name_of(&self, index: usize) -> Option<&Token<'a>> {
        match self.items.get(index) {
            Some(Item::Function { name, .. }) => Some(name),
            _ => None,
        }
    }

    /// True for an item whose failure leaves the rest of the program usable.
    pub(super) fn may_break(&self, index: usize) -> bool {
        match self.items.get(index) {
            Some(Item::Function { .. }) | None => true,
            Some(Item::Global(global)) => !global.value.is_empty(),
            Some(Item::Plain(_)) => false,
        }
    }
}

/// Writes the function that returns the colour of a pixel: the result of `mainImage`, or what `main` draws. `None` for a
/// file without such a function.
fn image(items: &[Item<'_>]) -> Option<(String, usize)> {
    let mut main = None;
    for (index, item) in items.iter().enumerate() {
        let Item::Function { name, header, .. } = item else { continue };
        let words =
            || header.iter().filter(|token| token.is_word() && !token.is("in")).map(|token| token.text);
        if name.is("mainImage") && words().next() == Some("void") {
            let types: Vec<&str> = words().skip(2).collect();
            if matches!(types.as_slice(), ["out" | "inout", "vec4", _, "vec2", _]) {
                let call = "vec4 glsl_color = vec4(0.0, 0.0, 0.0, 1.0); mainImage(glsl_color, glsl_pixel); return glsl_color;";
                return Some((format!("vec4 {IMAGE}(vec2 glsl_pixel) {{ {call} }}\n"), index));
            }
        }
        if name.is("main") && words().next() == Some("void") {
            main = Some(index);
        }
    }
    let output = items.iter().find_map(|item| match item {
        Item::Global(global) if global.origin == Origin::Output && global.of.is("vec4") => {
            Some(global.name.text)
        }
        _ => None,
    });
    let output = output.unwrap_or("gl_FragColor");
    let call = format!("gl_FragCoord = vec4(glsl_pixel, 0.0, 1.0); main_(); return {output};");
    main.map(|index| (format!("vec4 {IMAGE}(vec2 glsl_pixel) {{ {call} }}\n"), index))
}

fn write_global(out: &mut Written, global: &Global<'_>, index: usize, broken: bool) {
    let is_whole = matches!(global.of.text, "int" | "uint" | "bool");
    let array = sizes(&global.array, &global.value);
    let semicolon = global.name.made(";", Kind::Sign);
    let declare = |out: &mut Written, name: Token<'_>| {
        out.extend(&in_shape(&[global.of, name]), index);
        out.extend(&array, index);
        out.push(&name.made("=", Kind::Sign), index);
        out.extend(&in_shape(&global.value), index);
        out.push(&semicolon, index);
    };
    let is_set = !global.value.is_empty() && !broken;
    if global.origin == Origin::Const && is_whole && array.is_empty() && is_set {
        out.push(&global.of.made("const", Kind::Word), index);
        return declare(out, global.name);
    }
    out.extend(&in_shape(&[global.of, global.name]), index);
    out.extend(&array, index);
    out.push(&semicolon, index);
    if is_set {
        out.text.push_str(&format!("void {START}{index}() {{ "));
        declare(out, global.name.made("glsl_value", Kind::Word));
        out.extend(&in_shape(&[global.name]), index);
        out.text.push_str("= glsl_value; }\n");
    }
}

/// Sizes of arrays as text, for arrays without a written size. An array without values has one.
const SIZES: &str = "1 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25 26 27 28 29 30 31 32 33 34 35 \
    36 37 38 39 40 41 42 43 44 45 46 47 48 49 50 51 52 53 54 55 56 57 58 59 60 61 62 63 64";

/// Number of values of an array's constructor or list.
fn values(tokens: &[Token<'_>]) -> usize {
    let Some(open) = tokens.iter().position(|token| token.is("(") || token.is("{")) else { return 0 };
    let inside = tokens.get(open..).unwrap_or_default();
    let inside = inside.get(1..matching(inside).saturating_sub(1)).unwrap_or_default();
    let (mut count, mut rest) = (usize::from(!inside.is_empty()), inside);
    while let Some(at) = closing(rest, |token| token.is(",")) {
        count += 1;
        rest = rest.get(at + 1..).unwrap_or_default();
    }
    count
}

/// Statements `name = …;` directly in a drawing function's body that set a global that has no other value.
fn settings<'a>(body: &[Token<'a>], unset: &BTreeSet<String>) -> Vec<Vec<Token<'a>>> {
    let mut found: BTreeMap<&str, Vec<Token<'a>>> = BTreeMap::new();
    let mut rest = body.get(1..body.len().saturating_sub(1)).unwrap_or_default();
    while !rest.is_empty() {
        let length = closing(rest, |token| token.is(";")).map_or(rest.len(), |at| at + 1);
        let statement = rest.get(..length).unwrap_or_default();
        if let [name, equals, ..] = statement
            && equals.is("=")
            && unset.contains(name.text)
        {
            found.entry(name.text).or_insert_with(|| statement.to_vec());
        }
        rest = rest.get(length..).unwrap_or_default();
    }
    found.into_values().collect()
}

/// Renames what naga reads otherwise than GLSL for the web does, and writes the sizes of arrays as naga takes them.
fn in_shape<'a>(tokens: &[Token<'a>]) -> Vec<Token<'a>> {
    let tokens = &apart(tokens);
    let mut out = Vec::with_capacity(tokens.len());
    let mut at = 0;
    while let Some(token) = tokens.get(at) {
        let called = tokens.get(at + 1).is_some_and(|next| next.is("("));
        out.push(token.made(renamed(token.text, called), token.kind));
        at += 1;
        // `type name[…]` declares an array.
        let declares = at > 1
            && token.is_word()
            && tokens.get(at - 2).is_some_and(|of| of.is_word() && !of.is("return") && !of.is("else"));
        let rest = tokens.get(at..).unwrap_or_default();
        let length = if declares { brackets_length(rest) } else { 0 };
        if length > 0 {
            let value = rest.get(length..).filter(|after| after.first().is_some_and(|token| token.is("=")));
            out.extend(sizes(rest.get(..length).unwrap_or_default(), value.unwrap_or_default()));
            at += length;
        }
    }
    out
}

/// Declares arrays one by one: in `float a[2], b` naga takes b for an array.
fn apart<'a>(tokens: &[Token<'a>]) -> Vec<Token<'a>> {
    let mut out = Vec::with_capacity(tokens.len());
    let mut at = 0;
    while let Some(token) = tokens.get(at) {
        let begins = at.checked_sub(1).and_then(|before| tokens.get(before));
        let begins = begins.is_none_or(|before| matches!(before.text, ";" | "{" | "}"));
        let rest = tokens.get(at..).unwrap_or_default();
        let declares = begins
            && token.is_word()
            && !matches!(token.text, "return" | "else" | "case" | "struct")
            && rest.get(1).is_some_and(Token::is_word);
        let length = if declares { closing(rest, |token| token.is(";")) } else { None };
        let statement = length.and_then(|length| rest.get(1..length)).unwrap_or_default();
        let mut names = Vec::new();
        let mut left = statement;
        while !left.is_empty() {
            let length = closing(left, |token| token.is(",")).unwrap_or(left.len());
            names.push(left.get(..length).unwrap_or_default());
            left = left.get(length + 1..).unwrap_or_default();
        }
        if names.len() > 1 && names.iter().any(|name| name.get(1).is_some_and(|token| token.is("["))) {
            for name in names {
                out.push(*token);
                out.extend_from_slice(name);
                out.push(token.made(";", Kind::Sign));
            }
            at += 1 + statement.len() + 1;
        } else {
            out.push(*token);
            at += 1;
        }
    }
    out
}

/// The brackets of a declared array. naga takes the last size for the outermost one, and needs a size.
fn sizes<'a>(brackets: &[Token<'a>], value: &[Token<'a>]) -> Vec<Token<'a>> {
    let mut groups = Vec::new();
    let mut rest = brackets;
    while !rest.is_empty() {
        let (group, others) = rest.split_at(matching(rest).min(rest.len()));
        rest = others;
        match group {
            [open, close] => {
                let size = SIZES.split(' ').nth(values(value)).unwrap_or("1");
                groups.push(vec![*open, open.made(size, Kind::Number), *close]);
            }
            group => groups.push(in_shape(group)),
        }
    }
    groups.into_iter().rev().flatten().collect()
}

/// Names that naga reserves, with the sign that makes them free.
const RESERVED: &str = "sample_ buffer_ shared_ smooth_ flat_ centroid_ restrict_ readonly_ writeonly_ sampler_ \
    invariant_ texture_ main_";

/// True for a type of textures.
pub(super) fn is_sampler(of: &str) -> bool {
    let kind = |sign: &&str| {
        let of = of.strip_prefix(sign)?;
        of.strip_prefix("sampler").or_else(|| of.strip_prefix("image"))
    };
    let kind = ["", "i", "u"].iter().find_map(kind);
    kind.is_some_and(|kind| matches!(kind, "1D" | "2D" | "3D" | "Cube" | "2DRect" | "2DArray" | "Buffer"))
}

/// Functions that read a texture at a place.
const TEXTURE_READS: &str = "texture texture2D texture2DLod texture2DLodEXT textureLod textureLodEXT textureGrad \
    texture2DGradEXT textureCube textureCubeLod texture3D texture2DBias";

fn renamed(name: &str, called: bool) -> &str {
    match name {
        name if called && TEXTURE_READS.split(' ').any(|read| read == name) => "glsl_texture",
        "texelFetch" if called => "glsl_texel",
        "textureSize" if called => "glsl_texture_size",
        of if is_sampler(of) => "int",
        name => RESERVED.split(' ').find(|word| word.strip_suffix('_') == Some(name)).unwrap_or(name),
    }
}
