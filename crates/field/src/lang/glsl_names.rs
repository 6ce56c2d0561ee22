//! Names of GLSL and of well-known shader collections that mean something else here, or nothing.

/// Functions: the name, and what to write.
const FUNCTIONS: &[(&str, &str)] = &[
    ("atan2", "use `atan(y, x)`, as in GLSL"),
    ("frac", "use `fract(a)`, as in GLSL"),
    ("fmod", "use `mod(a, b)`, as in GLSL"),
    ("lerp", "use `mix(a, b, share)`, as in GLSL"),
    ("rsqrt", "use `inversesqrt(a)`, as in GLSL"),
    ("mul", "to multiply write `a * b`"),
    ("fma", "write `a * b + c`"),
    ("mat4", "write `mat3(…) * p + offset`"),
    ("texture2D", "read an image with `texture(\"file\", uv)`"),
    ("textureLod", "read an image with `texture(\"file\", uv)`"),
    ("texelFetch", "read an image with `texture(\"file\", uv)`"),
    ("lessThan", "compare components: `a.x < b.x`"),
    ("greaterThan", "compare components: `a.x > b.x`"),
    ("any", "join conditions with `||`"),
    ("all", "join conditions with `&&`"),
    ("not", "negate a condition with `!`"),
    ("dFdx", "a formula does not know its neighbours; a material has the normal `n`"),
    ("dFdy", "a formula does not know its neighbours; a material has the normal `n`"),
    ("fwidth", "a formula does not know its neighbours; a material has the normal `n`"),
    ("smin", "use `smooth_union(a, b, radius)`"),
    ("smax", "use `smooth_intersect(a, b, radius)`"),
    ("opU", "use `union(a, b)`"),
    ("opS", "use `subtract(shape, cut)`: the shape comes first"),
    ("opI", "use `intersect(a, b)`"),
    ("opSubtraction", "use `subtract(shape, cut)`: the shape comes first"),
    ("opIntersection", "use `intersect(a, b)`"),
    ("opSmoothSubtraction", "use `smooth_subtract(shape, cut, radius)`: the shape comes first"),
    ("opSmoothIntersection", "use `smooth_intersect(a, b, radius)`"),
    ("opRep", "use `repeat(p, size)`"),
    ("opRepLim", "use `repeat_limited(p, size, count)`"),
    ("opExtrusion", "use `extrude(shape, p.z, half_height)`"),
    ("opRevolution", "use `revolve(p, offset)`"),
    ("opOnion", "use `shell(shape, thickness)`"),
    ("opCheapBend", "use `bend(p, amount)`"),
    ("rot", "use `rotation_2d(angle)`, as in `p.xz *= rotation_2d(t)`"),
    ("rot2D", "use `rotation_2d(angle)`, as in `p.xz *= rotation_2d(t)`"),
    ("rot2", "use `rotation_2d(angle)`, as in `p.xz *= rotation_2d(t)`"),
    ("pR", "use `rotation_2d(angle)`, as in `p.xz *= rotation_2d(t)`"),
    ("sdBox2D", "use `rectangle(p, size)`"),
    ("sdCappedCylinder", "use `cylinder(p, radius, half_height)`"),
    ("snoise", "use `noise(p)`, which is in 0..1"),
    ("cnoise", "use `noise(p)`, which is in 0..1"),
    ("rand", "use `hash(p)`: the same place has the same number, as in `hash(vec3(index, 0, 0))`"),
    ("random", "use `hash(p)`: the same place has the same number, as in `hash(vec3(index, 0, 0))`"),
    ("hash11", "use `hash(vec3(a, 0, 0))`"),
    ("hash21", "use `hash(vec3(p, 0))`"),
    ("hash31", "use `hash(p)`"),
];

/// Values: the name, and what to write.
const VALUES: &[(&str, &str)] = &[
    ("i", "a point of a swarm has the number `index`; a loop names its variable: `for i in 0..8`"),
    ("id", "a point of a swarm has the number `index`"),
    ("time", "the time is `t`"),
    ("iTime", "the time is `t`"),
    ("iGlobalTime", "the time is `t`"),
    ("u_time", "the time is `t`"),
    ("iFrame", "the time is `t`, in seconds"),
    ("normal", "the normal is `n`"),
    ("nor", "the normal is `n`"),
    ("pos", "the point is `p`"),
    ("point", "the point is `p`"),
    ("rd", "the direction of a ray is `direction`, in the sky"),
    ("ro", "the camera's position is `eye`, in materials and the sky"),
    ("bands", "a band is `band(i)`"),
    ("PI", "the number is `pi`"),
    ("M_PI", "the number is `pi`"),
    ("TAU", "the number is `tau`"),
    ("TWO_PI", "the number is `tau`"),
    ("gl_FragCoord", PIXEL),
    ("fragCoord", PIXEL),
    ("iResolution", PIXEL),
    ("u_resolution", PIXEL),
    ("uv", PIXEL),
    ("iMouse", "the pointer is `mouse`, in the sky; in a shape, declare a slider: `param amount = 0.5`"),
    ("backbuffer", PREVIOUS),
    ("texPreviousFrame", PREVIOUS),
    ("prevFrame", PREVIOUS),
    ("iChannel0", "images have names: `texture(\"wood.png\", uv)`"),
];

const PREVIOUS: &str = "the last frame is `previous(pixel / resolution)`, in the sky and in materials";

const PIXEL: &str = "formulas depend on the point `p` instead of a pixel; in the sky, on `pixel` and `resolution` or on the \
                     `direction`";

/// Returns what to write instead of a function that is not known here.
pub(super) fn function(name: &str) -> Option<&'static str> {
    FUNCTIONS.iter().find(|(known, _)| *known == name).map(|(_, hint)| *hint)
}

/// Returns what to write instead of a value that is not known here.
pub(super) fn value(name: &str) -> Option<&'static str> {
    VALUES.iter().find(|(known, _)| *known == name).map(|(_, hint)| *hint)
}

/// Returns the name in this library's style of a shape or operation in the style of Quilez: `round_box` for
/// `sdRoundBox`.
pub(super) fn without_prefix(name: &str) -> Option<String> {
    let bare = ["sd", "op", "ud", "f"].into_iter().find_map(|prefix| name.strip_prefix(prefix))?;
    if !bare.starts_with(|c: char| c.is_ascii_uppercase()) {
        return None;
    }
    let mut own = String::new();
    for c in bare.chars() {
        if c.is_ascii_uppercase() && !own.is_empty() {
            own.push('_');
        }
        own.push(c.to_ascii_lowercase());
    }
    Some(own)
}
