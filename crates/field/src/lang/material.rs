//! The material of a surface, one row for each field (see `fields`). The struct in the shaders, and the code that
//! fills the struct in each mode, are generated from the rows.

use super::builtin::uses::{EYE, FRAME, NORMAL, POINT, TEXTURE};
use super::fields::DefaultValue::Each;
use super::fields::{DefaultValue, Field, FieldRange, Holds, section};

const SURFACE: u16 = POINT | NORMAL | TEXTURE | FRAME | EYE;

section! {
    /// The material of a surface: functions of point, normal and frame (R⁶ → R³ in Abt 2022, section 3.2).
    Material {
        /// The name; `default` for the material of objects that set no material.
        name: String,
    }
    color: Vector = Each(0.8), SURFACE, FRACTION, "diffuse reflectance, or the metal's colour, 0..1";
    roughness: Number = Each(0.5), SURFACE, FRACTION, "0 polished .. 1 matt";
    metalness: Number = Each(0.0), SURFACE, FRACTION, "0 insulator .. 1 metal";
    emission: Vector = Each(0.0), SURFACE, LIGHT, "emitted light";
    reflect: Number = Each(0.0), SURFACE, FRACTION,
        "fraction of light mirrored at normal incidence, 0..1: the ray continues in the mirrored direction";
    coat: Number = Each(0.0), SURFACE, FRACTION, "strength of a clear coat, 0..1";
    haze: Number = Each(0.0), SURFACE, FRACTION,
        "fraction of the surface's light replaced by the sky, 0..1: for objects that fade into the distance";
    blur: Number = Each(0.0), SURFACE, FRACTION,
        "roughness of the mirror, 0 sharp .. 1 matt: the square root of GGX's alpha, as roughness is for lights";
    glass: Number = Each(0.0), SURFACE, FRACTION,
        "fraction of light that passes through the surface and bends, 0..1; a glass object casts no shadow";
    ior: Number = Each(1.5), SURFACE, INDEX, "refractive index of the glass, 0.3..4: 1.33 water, 1.5 glass, 2.4 diamond";
    absorb: Vector = Each(0.0), SURFACE, LIGHT, "light that the glass absorbs per unit of length";
    translucent: Number = Each(0.0), SURFACE, FRACTION,
        "fraction of diffuse light that comes through the body, 0..1: wax, leaves, skin";
    depth: Number = Each(0.1), SURFACE, LIGHT,
        "length after which 1/e of the light is left in a translucent body";
    film: Number = Each(0.0), SURFACE, LIGHT,
        "thickness of a thin film in nanometres, which colours mirrored light; 0 for none";
    velvet: Number = Each(0.0), SURFACE, FRACTION, "strength of the shine at grazing angles, as of velvet, 0..1";
}

/// Number of the first fields, which every scene's shaders have. The other fields describe how light passes through a
/// body and its layers; shaders have them if a scene uses one ([`SceneFeatures::body`](crate::world::SceneFeatures)).
const SURFACE_FIELDS: usize = 8;

/// Count of the numbers in the first fields. The others follow.
pub(crate) const SURFACE_NUMBERS: usize = {
    let (mut field, mut numbers) = (0, 0);
    while field < SURFACE_FIELDS {
        numbers += Material::FIELDS[field].holds.parts();
        field += 1;
    }
    numbers
};

const _: () = {
    let mut field = 0;
    while field < Material::FIELDS.len() {
        assert!(Material::FIELDS[field].range.is_some(), "every field of a material needs a range");
        let default = &Material::FIELDS[field].default;
        assert!(matches!(default, DefaultValue::Each(_)), "shaders need the default as a number");
        field += 1;
    }
};

/// Returns GLSL for the fields: the struct, the material with all defaults, a function that clamps the members to their
/// ranges, and macros that read the members from the results of interpreted programs, one for each group of fields. In
/// the macros, each component of `head` holds four numbers.
pub fn material_glsl() -> String {
    let groups = [&Material::FIELDS[..SURFACE_FIELDS], &Material::FIELDS[SURFACE_FIELDS..]];
    let lines = |line: fn(&Field) -> String| {
        let [surface, body] = groups.map(|fields| fields.iter().map(line).collect::<String>());
        format!("{surface}#ifdef BODY\n{body}#endif\n")
    };
    let members = lines(|field| format!("    {} {};    // {}\n", glsl_type(field), field.name, field.doc));
    let defaults = lines(|field| match field.default {
        DefaultValue::Each(number) => format!("    m.{} = {}({number:?});\n", field.name, glsl_type(field)),
        _ => String::new(),
    });
    let ranges = lines(|field| {
        let (name, range) = (field.name, field.range.unwrap_or(FieldRange::LIGHT));
        format!("    m.{name} = within(m.{name}, {:?}, {:?});\n", range.least, range.most)
    });
    let [read_surface, read_body] = groups.map(|fields| {
        let mut places =
            (0_usize..).map(|at| format!("READ(head.{}, {})", ["x", "y", "z", "w"][at / 4], at % 4));
        let read = fields.iter().map(|field| {
            let places: Vec<String> = places.by_ref().take(field.holds.parts()).collect();
            format!("m.{} = {}({}); ", field.name, glsl_type(field), places.join(", "))
        });
        read.collect::<String>()
    });
    format!(
        "struct Material {{\n{members}}};\n\n\
         // Clamps a formula's values to their ranges; a NaN becomes the least value.\n\
         float within(float value, float least, float most) {{\n    \
         return value > least ? min(value, most) : least;\n}}\n\
         vec3 within(vec3 value, float least, float most) {{\n    \
         return vec3(within(value.r, least, most), within(value.g, least, most), within(value.b, least, most));\n}}\n\
         vec3 light_of(vec3 value) {{\n    return within(value, {:?}, {:?});\n}}\n\
         Material default_material() {{\n    Material m;\n{defaults}    return m;\n}}\n\n\
         Material within_ranges(Material m) {{\n{ranges}    return m;\n}}\n\n\
         // The fields in these outputs of the interpreter's program.\n\
         #define READ_MATERIAL(m, head) {read_surface}\n#define READ_BODY(m, head) {read_body}\n",
        FieldRange::LIGHT.least,
        FieldRange::LIGHT.most,
    )
}

fn glsl_type(field: &Field) -> &'static str {
    if field.holds == Holds::Vector { "vec3" } else { "float" }
}

/// Returns the members of a material `name` in the shaders' struct, one per number.
pub(crate) fn material_members(name: &str) -> Vec<String> {
    let members = Material::FIELDS.iter().flat_map(|field| {
        let parts: &[&str] = if field.holds == Holds::Vector { &[".r", ".g", ".b"] } else { &[""] };
        parts.iter().map(move |part| format!("{name}.{}{part}", field.name))
    });
    members.collect()
}
