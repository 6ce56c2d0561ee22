//! Names of GLSL and of well-known shader collections that mean something else here, or nothing.

use crate::glsl_import::{Channel, Meaning, meaning};

/// Functions: their names, and what to write.
const FUNCTIONS: &[(&str, &str)] = &[
    ("atan2", "use `atan(y, x)`, as in GLSL"),
    ("frac", "use `fract(a)`, as in GLSL"),
    ("fmod", "use `mod(a, b)`, as in GLSL"),
    ("lerp", "use `mix(a, b, share)`, as in GLSL"),
    ("rsqrt", "use `inversesqrt(a)`, as in GLSL"),
    ("mul", "to multiply write `a * b`"),
    ("fma", "write `a * b + c`"),
    ("mat4", "write `mat3(…) * p + offset`"),
    ("texture2D textureLod texelFetch", "read an image with `texture(\"file\", uv)`"),
    ("lessThan", "compare components: `a.x < b.x`"),
    ("greaterThan", "compare components: `a.x > b.x`"),
    ("any", "join conditions with `||`"),
    ("all", "join conditions with `&&`"),
    ("not", "negate a condition with `!`"),
    ("dFdx dFdy fwidth", "a formula does not know its neighbours; a material has the normal `n`"),
    ("smin", "use `smooth_union(a, b, radius)`"),
    ("smax opSmoothIntersection", "use `smooth_intersect(a, b, radius)`"),
    ("opU", "use `union(a, b)`"),
    ("opS opSubtraction", "use `subtract(shape, cut)`: the shape comes first"),
    ("opI opIntersection", "use `intersect(a, b)`"),
    ("opSmoothSubtraction", "use `smooth_subtract(shape, cut, radius)`: the shape comes first"),
    ("opRep", "use `repeat(p, size)`"),
    ("opRepLim", "use `repeat_limited(p, size, count)`"),
    ("opExtrusion", "use `extrude(shape, p.z, half_height)`"),
    ("opRevolution", "use `revolve(p, offset)`"),
    ("opOnion", "use `shell(shape, thickness)`"),
    ("opCheapBend", "use `bend(p, amount)`"),
    ("rot rot2D rot2 pR", "use `rotation_2d(angle)`, as in `p.xz *= rotation_2d(t)`"),
    ("sdBox2D", "use `rectangle(p, size)`"),
    ("sdCappedCylinder", "use `cylinder(p, radius, half_height)`"),
    ("snoise cnoise", "use `noise(p)`, which is in 0..1"),
    ("rand random", "use `hash(p)`: the same place has the same number, as in `hash(vec3(index, 0, 0))`"),
    ("hash11", "use `hash(vec3(a, 0, 0))`"),
    ("hash21", "use `hash(vec3(p, 0))`"),
    ("hash31", "use `hash(p)`"),
];

/// Values: their names, and what to write.
const VALUES: &[(&str, &str)] = &[
    ("i", "a point of a swarm has the number `index`; a loop names its variable: `for i in 0..8`"),
    ("id", "a point of a swarm has the number `index`"),
    ("normal nor", "the normal is `n`"),
    ("pos point", "the point is `p`"),
    ("rd", "the direction of a ray is `direction`, in the sky"),
    ("ro", "the camera's position is `eye`, in materials and the sky"),
    ("bands", "a band is `band(i)`"),
    ("PI M_PI", "the number is `pi`"),
    ("TAU TWO_PI", "the number is `tau`"),
    ("uv", PIXEL),
];

const PREVIOUS: &str = "the last frame is `previous(pixel / resolution)`, in the sky and in materials";

const PIXEL: &str = "formulas depend on the point `p` instead of a pixel; in the sky, on `pixel` and `resolution` or on the \
                     `direction`";

fn hint_of(table: &'static [(&str, &str)], name: &str) -> Option<&'static str> {
    let row = table.iter().find(|(names, _)| names.split(' ').any(|known| known == name));
    row.map(|(_, hint)| *hint)
}

/// Returns what to write instead of a function that is not known here.
pub(super) fn function(name: &str) -> Option<&'static str> {
    hint_of(FUNCTIONS, name)
}

/// Returns what to write instead of a value that is not known here.
pub(super) fn value(name: &str) -> Option<&'static str> {
    hint_of(VALUES, name).or_else(|| {
        Some(match meaning(name)? {
            Meaning::Time | Meaning::Frame => "the time is `t`, in seconds",
            Meaning::HeldPointer | Meaning::Pointer | Meaning::PointerShare => {
                "the pointer is `mouse`, in the sky; in a shape, declare a slider: `param amount = 0.5`"
            }
            Meaning::Channel(Channel::LastFrame) => PREVIOUS,
            Meaning::Channel(Channel::Unknown | Channel::Picture | Channel::Noise) => {
                "images have names: `texture(\"wood.png\", uv)`"
            }
            Meaning::Channel(_) => "the sound is `spectrum(u)` and `waveform(u)`",
            Meaning::Size | Meaning::Pixel | Meaning::Share | Meaning::Surface => PIXEL,
            _ => return None,
        })
    })
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
