//! The material of a surface, one row for each field (see `fields`). The struct in the shaders, and the code that
//! fills the struct in each mode, are generated from the rows.

use std::fmt::Write;

use super::builtin::uses::{EYE, FRAME, NORMAL, POINT, TEXTURE};
use super::fields::DefaultValue::Each;
use super::fields::{Holds, MaterialRange, section};
use crate::limits::LIMITS;

const SURFACE: u16 = POINT | NORMAL | TEXTURE | FRAME | EYE;

section! {
    /// The material of a surface: functions of point, normal and frame (R⁶ → R³ in Abt 2022, section 3.2).
    Material {
        /// The name; `default` for the material of objects that set no material.
        name: String,
    }
    color: Vector = Each(0.8), SURFACE, Reflectance, "diffuse reflectance, or the metal's colour, 0..1";
    roughness: Number = Each(0.5), SURFACE, Fraction, "0 polished .. 1 matt";
    metalness: Number = Each(0.0), SURFACE, Fraction, "0 insulator .. 1 metal";
    emission: Vector = Each(0.0), SURFACE, Light, "emitted light";
    reflect: Number = Each(0.0), SURFACE, Fraction,
        "fraction of light mirrored at normal incidence, 0..1: the ray continues in the mirrored direction";
    coat: Number = Each(0.0), SURFACE, Fraction, "strength of a clear coat, 0..1";
    haze: Number = Each(0.0), SURFACE, Fraction,
        "fraction of the surface's light replaced by the sky, 0..1: for objects that fade into the distance";
    blur: Number = Each(0.0), SURFACE, Fraction,
        "roughness of the mirror, 0 sharp .. 1 matt: the square root of GGX's alpha, as roughness is for lights";
}

const _: () = assert!(
    Material::NUMBERS <= LIMITS.tape_outputs_max,
    "a material has more numbers than a tape has outputs"
);
const _: () = {
    let mut field = 0;
    while field < Material::FIELDS.len() {
        assert!(Material::FIELDS[field].range.is_some(), "every field of a material needs a range");
        field += 1;
    }
};

/// Returns GLSL for the fields: the struct, a function that clamps its members to their ranges, and a macro that reads
/// the members from the result of an interpreted program. In the macro, each component of `head` holds four numbers.
pub fn material_glsl() -> String {
    let (mut members, mut ranges, mut read) = (String::new(), Vec::new(), Vec::new());
    let mut number = 0;
    for field in Material::FIELDS {
        let parts = field.holds.parts();
        let kind = if field.holds == Holds::Vector { "vec3" } else { "float" };
        let _ = writeln!(members, "    {kind} {};    // {}", field.name, field.doc);
        let value = format!("m.{}", field.name);
        ranges.push(match field.range {
            Some(MaterialRange::Fraction) => format!("fraction_of({value})"),
            Some(MaterialRange::Light) => format!("light_of({value})"),
            Some(MaterialRange::Reflectance) => format!("min(light_of({value}), vec3(1.0))"),
            None => value,
        });
        let place =
            |number: usize| format!("READ(head.{}, {})", ["x", "y", "z", "w"][number / 4], number % 4);
        let places: Vec<String> = (number..number + parts).map(place).collect();
        number += parts;
        read.push(format!("{kind}({})", places.join(", ")));
    }
    format!(
        "struct Material {{\n{members}}};\n\n\
         // Clamps a formula's values to their ranges; a NaN becomes 0.\n\
         float fraction_of(float value) {{\n    return value > 0.0 ? min(value, 1.0) : 0.0;\n}}\n\
         vec3 light_of(vec3 value) {{\n    return vec3(value.r > 0.0 ? min(value.r, 1e6) : 0.0, \
         value.g > 0.0 ? min(value.g, 1e6) : 0.0,\n                value.b > 0.0 ? min(value.b, 1e6) : 0.0);\n}}\n\
         Material within_ranges(Material m) {{\n    return Material({});\n}}\n\n\
         // The material in these outputs of the interpreter's program.\n\
         #define READ_MATERIAL(head) Material({})\n",
        ranges.join(", "),
        read.join(", ")
    )
}

/// Returns the members of a material `name` in the shaders' struct, one per number.
pub(crate) fn material_members(name: &str) -> Vec<String> {
    let members = Material::FIELDS.iter().flat_map(|field| {
        let parts: &[&str] = if field.holds == Holds::Vector { &[".r", ".g", ".b"] } else { &[""] };
        parts.iter().map(move |part| format!("{name}.{}{part}", field.name))
    });
    members.collect()
}
