use super::super::{Fault, compile, no_includes};
use super::broken;

/// Texts with mistakes, each with its first message, the text that the message underlines, and a part of the hint.
const MISTAKES: &[(&str, &str, &str, &str)] = &[
    // Words and signs.
    ("1 @ 2", "the character `@` is not part of the language", "@", "leave it out"),
    ("x − 1", "the character `−` is not part of the language", "−", "`-`"),
    ("x²", "the character `²` is not part of the language", "²", "`x^2`"),
    ("volume[0]", "the character `[` is not part of the language", "[", "`volume.x`"),
    ("2x", "a number runs into a name", "2x", "`2 * x`"),
    ("1.0f", "a number runs into a name", "1.0f", "write `1.0`"),
    ("1e999", "this number is too large", "1e999", "3.4e38"),
    ("x /* y", "this comment is never closed", "/*", "`*/`"),
    ("texture(\"a, p.xy)", "this text is never closed", "\"a, p.xy)", "end it"),
    // Places in the picture.
    (
        "sphere(p, pixel.x)",
        "a shape cannot depend on `pixel`, which is a place in the picture",
        "pixel",
        "the point `p`",
    ),
    (
        "let r = resolution.x\nsphere(p, r)",
        "`r` depends on the picture's size or the pointer, which have no value in a shape",
        "r",
        "`picture`",
    ),
    (
        "camera { fov = mouse.x }\nx",
        "`mouse` depends on the picture's size or the pointer, which have no value in the camera",
        "mouse",
        "`picture`",
    ),
    (
        "picture { grain = pixel.x }\nx",
        "`grain` cannot depend on `pixel`, which is a place in the picture",
        "pixel",
        "only `warp`",
    ),
    (
        "sky { let a = pixel.y  ambient = vec3(a) }",
        "`ambient` cannot depend on `pixel`, which is a place in the picture",
        "ambient",
        "the sky's colour alone",
    ),
    (
        "picture { let a = pixel.y  decay = a }\nx",
        "`decay` cannot depend on `pixel`, which is a place in the picture",
        "decay",
        "`warp` alone",
    ),
    // Feedback.
    ("sphere(p, previous(p.xy).x)", "a shape cannot read images", "previous(p.xy)", "materials and the sky"),
    (
        "picture { warp = previous(vec2(0)).xy }\nx",
        "the picture cannot read images",
        "previous(vec2(0))",
        "materials",
    ),
    (
        "sky { color = previous(direction) }",
        "`previous` takes a vec2 as its position, not a vec3",
        "direction",
        "`pixel / resolution`",
    ),
    ("sky { color = previous() }", "`previous` takes 1 argument, but gets 0", "previous()", "`previous(uv)`"),
    (
        "sky { color = backbuffer }",
        "there is no `backbuffer` here",
        "backbuffer",
        "`previous(pixel / resolution)`",
    ),
    (
        "picture { warp = 0.5 }\nx",
        "`warp` must be a vec2, but this is a number",
        "0.5",
        "`pixel / resolution",
    ),
    ("picture { memory = -1 }\nx", "`memory` is no number of seconds", "memory", "from 0 to 10"),
    // Expressions.
    ("1 +", "expected an expression, found the end of the text", "", ""),
    ("sphere(p 1)", "expected `,` or `)`, found a number", "1", ""),
    ("(x, y)", "expected `)`, found `,`", ",", "`vec2(…)`"),
    ("x = 1", "expected an operator or the end of the expression, found `=`", "=", "`==`"),
    ("+x", "an expression cannot begin with `+`", "+", "leave it out"),
    ("x > 0 ? 1 : 2", "there is no operator `?`", "?", "`if a then b else c`"),
    ("if x > 0 then 1", "expected `else`, found the end of the text", "", "in both cases"),
    (
        "if x > 0 { 1 } else { 2 }",
        "expected `then` after the condition, found `{`",
        "{",
        "`if a then b else c`",
    ),
    (
        "union(for i of 0..3: x)",
        "expected `in` after the loop's variable, found `of`",
        "of",
        "`union(for i in 0..32: expression)`",
    ),
    (
        "{ let a = 1 while a < 9 { a += 1 } a }",
        "a loop needs a maximum number of iterations",
        "while",
        "while condition",
    ),
    (
        "{ let a = 1 for (int i = 0; i < 8; i++) { a += 1 } a }",
        "expected the loop's variable, found `(`",
        "(",
        "`for i in 0..8",
    ),
    ("{ let a = 1; a++; a }", "there is no `++`", "a++", "`a += 1`"),
    (
        "{ let a = 1 if x > 0 { a = 2 3 } a }",
        "expected `}` after the statements, found a number",
        "3",
        "no result",
    ),
    (
        "union(for (int i = 0))",
        "expected the loop's variable, found `(`",
        "(",
        "`union(for i in 0..32: expression)`",
    ),
    ("{ let a = 1 }", "expected the block's result, found `}`", "}", "last expression"),
    ("{ a = 1  a }", "a block declares its names with `let`, but `a` is not declared", "a", "`let a = …`"),
    (
        "{ p.xz += 1  p.y }",
        "`p` is an input, which has the same value everywhere in the text",
        "p",
        "`let p = p`",
    ),
    ("{ let a = 1  a = p  x }", "`a` is a number, so it cannot become a vec3", "a = p", "`let a = vec3(0)`"),
    ("{ let q = p  q.xx = p.xy  x }", "`.xx` sets the component `x` twice", "q.xx = p.xy", ""),
    ("{ let q = p  q.w = 1  x }", "a vec3 has no component `w`", "q.w = 1", ""),
    ("{ let q = p  q.xg = 1  x }", "`.xg` does not name components", "q.xg = 1", "`xyzw`"),
    ("{ let q = p  q.xy = p  x }", "`.xy` needs 2 numbers, but gets a vec3", "q.xy = p", ""),
    (
        "{ let a = 1  let b = { a = 2  a }  b }",
        "`a` belongs to an outer block, which a value in braces cannot change",
        "a = 2",
        "`a = if a then b else c`",
    ),
    ("{ let a = 1  break  a }", "there is no loop here that `break` could end", "break", "`for i in 0..8"),
    (
        "{ let a = 1  for i in 0..2 { a = if x > 0 then { break  2 } else 3 }  a }",
        "there is no loop here that `break` could end",
        "break",
        "`for i in 0..8",
    ),
    ("{ let a = 1  if a { a = 2 }  a }", "`if` needs a condition, but this is a number", "a", "`a > 0`"),
    (
        "{ let a = 1 for i in 0..x { a += 1 } a }",
        "the largest number of iterations is not known",
        "x",
        "`param rounds = 8 in 1 .. 12`",
    ),
    (
        "fn f(a) = (near = a, near = 2)\nf(x).near",
        "the record has two values called `near`",
        "(near = a, near = 2)",
        "another name",
    ),
    (
        "(near = x, index = 1).far",
        "the record has no value `far`",
        "(near = x, index = 1).far",
        "`.near`, `.index`",
    ),
    (
        "(near = x, index = 1) + 1",
        "`+` cannot combine a record and a number",
        "(near = x, index = 1) + 1",
        "",
    ),
    ("(mat2(1) * p).x", "`*` cannot combine a mat2 and a vec3", "mat2(1) * p", "a mat3 a vec3"),
    (
        "(mat2(1, 2, 3) * p.xy).x",
        "`mat2` needs 2 columns, or 4 numbers in the order of the columns",
        "mat2(1, 2, 3)",
        "mat2(a, b)",
    ),
    ("inverse(p).x", "`inverse` takes a matrix, not a vec3", "inverse(p)", ""),
    ("fn f(p) { return p.x }\nf(p)", "there is no `return`", "return", "last expression"),
    ("fn f(p) { float a = 1; a }\nf(p)", "a declaration does not begin with a type", "float", "`let a = …`"),
    ("float f(vec3 p) { 1 }", "a declaration does not begin with a type", "float", "`fn f(p) { … }`"),
    ("fn f(vec3 p) = p.x\nf(p)", "a parameter's type follows its name", "vec3", "`p: vec3`"),
    ("fn f(p: vec5) = p.x\nf(p)", "there is no type `vec5`", "vec5", "`vec2`"),
    ("x)", "expected an operator or the end of the expression, found `)`", ")", ""),
    // Items.
    ("objct a { shape = x }", "`objct` is not a keyword", "objct", "`object`"),
    ("object { shape = x }", "expected a name, found `{`", "{", ""),
    ("object a { shape x }", "expected a field, as in `name = value`, found `shape`", "shape", ""),
    ("object a { shape = x, }", "expected the end of the expression, found `,`", ",", "`;`"),
    ("object a { shape = x", "expected `}`, found the end of the text", "", ""),
    ("param a = 1 in 2\nx", "expected `..` and the parameter's largest value, found `x`", "x", "0.1 .. 3"),
    ("let if = 1\nx", "expected a name after `let`, found `if`", "if", "reserved"),
    ("include shapes\nx", "expected a file's name in quotes, found `shapes`", "shapes", "`include "),
    // Names.
    (
        "smoth_union(x, y, 1)",
        "there is no function `smoth_union`",
        "smoth_union",
        "did you mean `smooth_union`?",
    ),
    ("zebra(x)", "there is no function `zebra`", "zebra", ""),
    ("lerp(x, y, 1)", "there is no function `lerp`", "lerp", "`mix(a, b, share)`"),
    ("mat3(1)", "a shape must be a number, but this is a matrix", "mat3(1)", ""),
    ("x(1)", "there is no function `x`", "x", "multiply"),
    ("volum.x", "there is no `volum` here", "volum", "did you mean `volume`?"),
    ("sphere", "there is no `sphere` here", "sphere", "call it"),
    ("iTime", "there is no `iTime` here", "iTime", "`t`"),
    ("let melt = 1\nx + mlet", "there is no `mlet` here", "mlet", "did you mean `melt`?"),
    ("fn f(p) = zz\nx", "there is no `zz` here", "zz", ""),
    ("let a = zz\nx", "there is no `zz` here", "zz", ""),
    ("fn f(p) = x\nfn f(q) = y\nf(p)", "two functions are called `f`", "f", "another name"),
    ("let a = 1\nparam a = 2\nx", "two values are called `a`", "a", "another name"),
    ("let t = 1\nx", "the name `t` is taken by an input", "t", "another name"),
    (
        "fn f(a) = g(a)\nfn g(a) = f(a)\nf(x)",
        "these names depend on each other in a circle: `f` → `g` → `f`",
        "f(a)",
        "`for`",
    ),
    ("fn f(a) = f(a)\nx", "`f` uses itself", "f(a)", "`for`"),
    (
        "let a = b\nlet b = a\na",
        "these names depend on each other in a circle: `a` → `b` → `a`",
        "a",
        "`for`",
    ),
    // Types.
    ("p.xy + p", "`+` needs vectors of the same size, not a vec2 and a vec3", "p.xy + p", "`p.xz`"),
    ("min(p.xy, p).x", "`min` needs vectors of the same size, not a vec2 and a vec3", "min(p.xy, p)", ""),
    (
        "mix(p, p.xy, 0).x",
        "`mix` needs vectors of the same size, not a vec3 and a vec2 and a number",
        "mix(p, p.xy, 0)",
        "",
    ),
    ("p.xyw.x", "a vec3 has no component `w`", "p.xyw", ""),
    ("p.xg", "`.xg` does not name components", "p.xg", "`xyzw`"),
    ("vec3(1, 2).x", "`vec3` needs 3 numbers, but gets 2", "vec3(1, 2)", ""),
    ("sin(1, 2)", "`sin` takes 1 argument, but gets 2", "sin(1, 2)", "`sin(a)`"),
    ("atan()", "`atan` takes 1 to 2 arguments, but gets 0", "atan()", ""),
    ("box(p)", "`box` takes 2 arguments, but gets 1", "box(p)", "`box(p: vec3, size: vec3)`"),
    ("sphere(p, p)", "`sphere` takes a number as `radius`, not a vec3", "p", "`sphere(p, radius: number)`"),
    ("box(p.xy, 1)", "`box` takes a vec3 as `p`, not a vec2", "p.xy", ""),
    ("union()", "`union` needs at least one value", "union()", ""),
    (
        "smooth_union(1)",
        "`smooth_union` needs shapes followed by the radius of the blend",
        "smooth_union(1)",
        "radius",
    ),
    ("if x then 1 else 2", "`if` needs a condition, but this is a number", "x", "`a > 0`"),
    (
        "if x > 0 then p else 1 > 2",
        "both results of `if` must have the same type, not a vec3 and a condition",
        "if x > 0 then p else 1 > 2",
        "",
    ),
    ("(x > 0) + 1", "`+` cannot combine a condition and a number", "(x > 0) + 1", "`if a then 1 else 0`"),
    ("if 0 < x < 1 then 1 else 2", "`<` cannot combine a condition and a number", "0 < x < 1", "`&&`"),
    ("if p > 0 then 1 else 2", "`>` compares numbers, not vectors", "p > 0", "components"),
    ("sin(x > 0)", "`sin` works on numbers and vectors, but this is a condition", "x > 0", ""),
    ("-(x > 0)", "`-` works on numbers and vectors, but this is a condition", "-(x > 0)", ""),
    ("x / 0", "this divides by zero", "x / 0", "`if`"),
    ("p", "a shape must be a number, but this is a vec3", "p", "`length(…)`"),
    // Loops.
    (
        "for i in 0..3: x",
        "a loop has many values, but a single one is needed here",
        "for i in 0..3: x",
        "`union(for …)`",
    ),
    ("vec3(for i in 0..3: i).x", "`vec3` cannot take a loop as an argument", "for i in 0..3: i", "`union`"),
    ("union(for i in 0..x: y)", "a loop's bounds must be constants", "x", "whole numbers"),
    (
        "union(for i in 0..2.5: y)",
        "a loop's bounds must be whole numbers up to 1000000, but this is 2.5",
        "2.5",
        "",
    ),
    (
        "union(for i in 3..3: y)",
        "this loop has no iterations, so `union` has no values",
        "union(for i in 3..3: y)",
        "`for i in a..b` runs from a to b - 1",
    ),
    (
        "smooth_union(for i in 0..0: y, 0.3)",
        "this loop has no iterations, so `smooth_union` has no values",
        "smooth_union(for i in 0..0: y, 0.3)",
        "`union(1000, for …)`",
    ),
    ("sum(for i in -1..3: 1 / i)", "this divides by zero", "1 / i", "`if`"),
    // Inputs.
    ("band(32)", "there is no band 32", "band(32)", "0 to 31"),
    ("band(0.5)", "there is no band 0.5", "band(0.5)", "0 to 31"),
    ("chroma(12)", "there is no pitch class 12", "chroma(12)", "11 for B"),
    ("note(88)", "there is no note 88", "note(88)", "87 for C8"),
    ("width(-1)", "there is no band -1", "width(-1)", "0 to 31"),
    ("chroma(p)", "`chroma` takes a number, not a vec3", "chroma(p)", ""),
    (
        "length(p - eye) - 1",
        "a shape cannot depend on the camera, so `eye` has no value here",
        "eye",
        "materials",
    ),
    ("n.x", "`n` depends on a surface's normal, which has no value in a shape", "n", "materials"),
    (
        "camera { position = p }\nx",
        "the camera is the same at all points, so `p` has no value here",
        "p",
        "shapes",
    ),
    (
        "light a { position = x }\nx",
        "a light is the same at all points, so `x` has no value here",
        "x",
        "shapes",
    ),
    ("sky { color = y }\nx", "the sky is the same at all points, so `y` has no value here", "y", "shapes"),
    (
        "direction.x",
        "`direction` depends on a ray's direction, which has no value in a shape",
        "direction",
        "sky",
    ),
    ("texture(\"a.png\", p.xy).r", "a shape cannot read images", "texture(\"a.png\", p.xy)", "materials"),
    (
        "param a = t\nx",
        "a parameter is fixed before the music plays, so `t` has no value here",
        "t",
        "write a number",
    ),
    ("let a = n.x\na", "`a` depends on a surface's normal, which has no value in a shape", "a", ""),
    // Sections.
    ("param a = 5 in 1 .. 2\nx", "the default of `a`, 5, is outside its range 1 .. 2", "5", "widen"),
    (
        "param a = 5 in 6 .. 2\nx",
        "the range of `a` is empty: 6 is not below 2",
        "6 .. 2",
        "smaller number first",
    ),
    ("object a { color = 1 }", "an object has no field `color`", "color", "`shape`"),
    ("object a { shap = x }", "an object has no field `shap`", "shap", "did you mean `shape`?"),
    ("object a { shape = x shape = y }", "`shape` is set twice", "shape", ""),
    ("object a { }", "the object `a` has no shape", "object a", ""),
    ("object a { shape = p }", "`shape` must be a number, but this is a vec3", "p", ""),
    (
        "object a { shape = x material = wod } material wood { }",
        "there is no material `wod`",
        "wod",
        "did you mean `wood`?",
    ),
    ("object a { shape = x material = 1 }", "`material` must be the name of a material", "1", ""),
    ("material a { color = p.xy }\nx", "`color` must be a vec3, but this is a vec2", "p.xy", ""),
    ("material a { } material a { }\nx", "two materials are called `a`", "a", ""),
    ("light a { color = 1 }\nx", "the light `a` has no position or direction", "light a", "`position"),
    (
        "light a { position = 1 direction = 2 }\nx",
        "the light `a` has both a position and a direction",
        "direction",
        "sun",
    ),
    ("camera { }\ncamera { }\nx", "the scene has a second block `camera`", "camera", ""),
    ("picture { }\npicture { }\nx", "the scene has a second block `picture`", "picture", ""),
    (
        "picture { exposre = 1 }\nx",
        "the picture has no field `exposre`",
        "exposre",
        "did you mean `exposure`?",
    ),
    (
        "picture { bloom = x }\nx",
        "the picture is the same at all points, so `x` has no value here",
        "x",
        "shapes",
    ),
    ("picture { tone_map = agz }\nx", "there is no tone map `agz`", "agz", "did you mean `agx`?"),
    ("picture { tone_map = filmic }\nx", "there is no tone map `filmic`", "filmic", "`reinhard`"),
    ("picture { tone_map = 2 }\nx", "a tone map must be given by its name", "2", "`aces`"),
    ("sky a { }\nx", "expected `{`, found `a`", "a", "no names"),
    ("camera a { }\ncamera a { }\nx", "two cameras are called `a`", "a", "another name"),
    ("camera { fov = 1 .. 2 }\nx", "`fov` is one value, not a range", "2", "leave out"),
    // The block `about`.
    ("about { title = 3 }\nx", "`title` must be a text", "3", "quotes"),
    ("about { mood = \"calm\" }\nx", "the block `about` has no field `mood`", "mood", "`moods`?"),
    ("about { energy = 0.5 }\nx", "`energy` must be a range", "0.5", "0.2 .. 0.6"),
    (
        "about { energy = 0.8 .. 0.2 }\nx",
        "`energy` must be a range within 0 .. 1, but this is 0.8 .. 0.2",
        "0.8 .. 0.2",
        "the smaller number first",
    ),
    ("about { enter = flash }\nx", "there is no transition `flash`", "flash", "`melt`"),
    ("about { }\nabout { }\nx", "the scene has a second block `about`", "about", "leave one of them out"),
    ("x\ny", "this is a second expression for the scene's shape", "y", "`union(a, b)`"),
    ("# nothing", "the scene has no shape", "", "`length(p) - 1`"),
    ("", "the scene has no shape", "", ""),
    // Files.
    (
        "material m { color = texture(\"../a.png\", p.xy).rgb }\nx",
        "a scene cannot read anything outside its own folder",
        "\"../a.png\"",
        "",
    ),
    (
        "material m { color = texture(p, p.xy).rgb }\nx",
        "`texture` takes a file's name in quotes, not a vec3",
        "p",
        "",
    ),
    (
        "material m { color = texture(\"a\", p).rgb }\nx",
        "`texture` takes a vec2 as its position, not a vec3",
        "p",
        "",
    ),
    ("include \"/etc/passwd\"\nx", "a scene cannot read absolute paths", "\"/etc/passwd\"", ""),
    (
        "include \"a\"\nx",
        "`a` cannot be included: only a scene that is a file can include other files",
        "\"a\"",
        "",
    ),
];

#[test]
fn every_mistake_is_explained_at_its_location() {
    let mut wrong = Vec::new();
    for (text, message, under, hint) in MISTAKES {
        let compiled = broken(text);
        let first = &compiled.diagnostics[0];
        let found = (first.message.as_str(), compiled.sources.text(first.span));
        if found != (*message, *under) || !first.hint.as_deref().unwrap_or("").contains(hint) {
            wrong.push(format!(
                "{text:?} should say {message:?} of {under:?}, hint {hint:?}\n{}",
                compiled.render(false)
            ));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Habits from GLSL, each with a part of its hint; with an empty hint, the text is accepted.
const HABITS: &[(&str, &str)] = &[
    ("fn f(p) { float d = length(p); d }\nf(p)", "`let d = …`"),
    ("fn f(p) { vec3 q = p; q.x }\nf(p)", "`let q = …`"),
    ("float map(vec3 p) { length(p) }\nmap(p)", "`fn map(p) { … }`"),
    ("fn f(in vec3 p) = p.x\nf(p)", "`fn f(p)`"),
    ("const float SIZE = 2.0;\nlength(p) - SIZE", "`let SIZE = …`"),
    ("uniform float size;\nlength(p) - size", "`param size = 0.5 in 0 .. 1`"),
    ("void mainImage(out vec4 color, in vec2 at) { }\nx", "traces its rays"),
    ("struct Hit { float d; };\nx", "`(near = a, index = b)`"),
    ("#define SIZE 2.0\nlength(p) - SIZE", "`let SIZE = …`"),
    ("#define sq(a) ((a)*(a))\nsq(x) - 1", "`fn sq(a) = …`"),
    ("fn f(p) { return length(p); }\nf(p)", "last expression"),
    ("float(3) - int(x)", ""),
    ("x > 0. ? 1. : 2.", "`if a then b else c`"),
    ("{ let q = p; q.xz += vec2(1); q.x *= 2.; q.x }", ""),
    ("{ let q = p; q.xz *= mat2(0, 1, -1, 0); q.x }", ""),
    ("{ let q = p; q.xz *= rot(t); q.x }", "`rotation_2d(angle)`"),
    ("{ let s = 0.; for (int i = 0; i < 8; i++) { s += 1.; } s }", "`for i in 0..8"),
    ("{ let s = 0.; while (s < 8.) { s += 1.; } s }", "`for i in 0..64 while condition { … }`"),
    ("{ let s = 0.; s++; s }", "`s += 1`"),
    ("{ let s = 1.; if (x > 0.) { s = 2.; } else { s = 3.; } s }", ""),
    ("sdBox(p, vec3(1.))", "`box(p: vec3, size: vec3)`"),
    ("sdRoundBox(p, vec3(1.), 0.1)", "`round_box(p: vec3"),
    ("smin(x, y, 0.5)", "`smooth_union(a, b, radius)`"),
    ("opSmoothUnion(x, y, 0.5)", "`smooth_union(a, b, radius: number)`"),
    ("length(p) - sin(iTime)", "`t`"),
    ("length(p) - gl_FragCoord.x", "`p`"),
    ("length(p) - iResolution.x / iMouse.x", "`direction`"),
    ("length(p) - texture2D(iChannel0, p.xy).r", "`texture(\"file\", uv)`"),
    ("length(p) - 1.0f", "write `1.0`"),
    ("length(max(abs(p) - vec3(1.), 0.)) - .1 // a box", ""),
    ("mod(x, 2.) + fract(y) + mix(x, y, .5) + atan(y, x) + PI", "`pi`"),
    ("volume[0]", "`volume.x`"),
    ("clamp(x, 0., 1.) * inversesqrt(dot(p, p)) * radians(90.)", ""),
    ("{ let m = mat3(1.); (transpose(m) * inverse(m) * p).x }", ""),
];

#[test]
fn habits_from_glsl_are_accepted_or_explained() {
    let mut wrong = Vec::new();
    for (text, hint) in HABITS {
        let compiled = compile("s", text, &mut no_includes);
        let shown = compiled.render(false);
        let found = compiled.diagnostics.first().and_then(|one| one.hint.as_deref());
        let is_right = match hint.is_empty() {
            true => compiled.scene.is_some(),
            false => found.is_some_and(|found| found.contains(hint)),
        };
        if !is_right {
            wrong.push(format!("{text:?}: {hint:?}\n{shown}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn one_mistake_gives_one_message() {
    let many = MISTAKES.iter().map(|row| broken(row.0)).filter(|compiled| compiled.diagnostics.len() > 1);
    let many: Vec<String> = many.map(|compiled| compiled.render(false)).collect();
    assert!(many.is_empty(), "{}", many.join("\n"));
}

#[test]
fn several_mistakes_are_reported_at_once_in_the_order_of_the_text() {
    let text = "param melt = 9 in 0 .. 1\nfn f(q) = sphre(q, 1) + melt\nlet a = (1 + \n\
                object one { shape = f(p)  material = wood }\nobject two { shape = box(p, 1, 2) + b }\ncamera { position = p }";
    let compiled = broken(text);
    let messages: Vec<&str> = compiled.diagnostics.iter().map(|one| one.message.as_str()).collect();
    assert_eq!(
        messages,
        [
            "the default of `melt`, 9, is outside its range 0 .. 1",
            "there is no function `sphre`",
            "expected an expression, found `object`",
            "there is no material `wood`",
            "`box` takes 2 arguments, but gets 3",
            "there is no `b` here",
            "the camera is the same at all points, so `p` has no value here",
        ]
    );
}

#[test]
fn a_diagnostic_has_a_location_an_underline_and_a_hint() {
    let text = "# tab and wide\r\nobject a {\r\n\tshape = /* 音 */ smoth_union(x, y, 1)\r\n}\r\n";
    let expected = "\
error: there is no function `smoth_union`
 --> test.scene:3:18
  |
3 |     shape = /* 音 */ smoth_union(x, y, 1)
  |                      ^^^^^^^^^^^
  = help: did you mean `smooth_union`?
";
    assert_eq!(broken(text).render(false), expected);
    let colored = broken(text).render(true);
    assert!(colored.contains("\x1b[1;31m^^^^^^^^^^^\x1b[0m") && colored.contains("\x1b[1;34m"));
}

#[test]
fn enclosing_calls_are_shown() {
    let text = "fn inner(q) = q + vec2(1)\nfn outer(q) = inner(q).x\n\n\n\n\n\n\n\nouter(p)";
    let expected = "\
error: `+` needs vectors of the same size, not a vec3 and a vec2
  --> test.scene:1:15
   |
 1 | fn inner(q) = q + vec2(1)
   |               ^^^^^^^^^^^
  ::: test.scene:2:15
   |
 2 | fn outer(q) = inner(q).x
   |               -------- `inner` is used here
  ::: test.scene:10:1
   |
10 | outer(p)
   | -------- `outer` is used here
   = help: give both the same number of components, as in `p.xz`
";
    assert_eq!(broken(text).render(false), expected);
}

#[test]
fn long_lines_are_cut_around_the_mistake() {
    let text = format!("{}zz + {}", "x + ".repeat(1000), "y + ".repeat(1000));
    let shown = broken(&format!("{text}1")).render(false);
    let lines: Vec<&str> = shown.lines().collect();
    assert_eq!(lines[1], " --> test.scene:1:4001");
    assert!(lines.iter().all(|line| line.chars().count() < 140), "{shown}");
    let under = lines[4].find('^').unwrap();
    let above: String = lines[3].chars().skip(lines[4][..under].chars().count()).take(2).collect();
    assert_eq!(above, "zz", "{shown}");
}

#[test]
fn a_text_can_have_windows_line_ends_a_mark_and_tabs() {
    let compiled = compile("s", "\u{feff}# a\r\n\tlet a = 1\r\n\r\nlength(p) -\ta\r\n", &mut no_includes);
    assert!(compiled.scene.is_some(), "{}", compiled.render(false));
    let shown = broken("\u{feff}zz").render(false);
    assert!(shown.contains(":1:1\n") && shown.contains("\n1 | zz\n  | ^^\n"), "{shown}");
}

#[test]
fn faults_have_their_kinds() {
    let fault = |text: &str| broken(text).diagnostics[0].fault;
    assert_eq!(fault("1 +"), Fault::Malformed);
    assert_eq!(fault("fn f(a) = f(a)\nx"), Fault::Unsupported);
    assert_eq!(fault(&"(".repeat(1000)), Fault::OverLimit);
}
