//! The material of a surface, one row for each field (see `fields`). The struct in the shaders and how each mode fills
//! it follow from the rows, too.

use std::fmt::Write;

use super::builtin::uses::{EYE, FRAME, NORMAL, POINT, TEXTURE};
use super::fields::DefaultValue::Each;
use super::fields::{Holds, MaterialRange, section};
use crate::limits::LIMITS;

/// What a field may depend on.
const SURFACE: u8 = POINT | NORMAL | TEXTURE | FRAME | EYE;

section! {
    /// The material of a surface: functions of point, normal and frame (R⁶ → R³ in Abt 2022, section 3.2).
    Material {
        /// Its name; `default` for the material of objects that name none.
        name: String,
    }
    color: Vector = Each(0.8), SURFACE, Reflectance, "diffuse reflectance, or the metal's colour, 0..1";
    roughness: Number = Each(0.5), SURFACE, Fraction, "0 polished .. 1 matt";
    metalness: Number = Each(0.0), SURFACE, Fraction, "0 insulator .. 1 metal";
    emission: Vector = Each(0.0), SURFACE, Light, "light of its own";
    reflect: Number = Each(0.0), SURFACE, Fraction,
        "share of light that is mirrored when looked at straight on, 0..1: the ray goes on";
    coat: Number = Each(0.0), SURFACE, Fraction, "strength of a clear coat, 0..1";
    haze: Number = Each(0.0), SURFACE, Fraction,
        "share of it that the sky covers, 0..1: for what fades into the distance";
    blur: Number = Each(0.0), SURFACE, Fraction,
        "how rough the mirror is, 0 sharp .. 1 matt: the square root of GGX's alpha, as roughness is for lights";
}

const _: () = assert!(Material::NUMBERS <= LIMITS.tape_outputs_max, "a tape gives no more numbers");
const _: () = {
    let mut field = 0;
    while field < Material::FIELDS.len() {
        assert!(Material::FIELDS[field].range.is_some(), "a field of a material has a range");
        field += 1;
    }
};

/// The fields as the shaders see them: the struct, the function that clamps its members to their ranges, the members
/// as a list of arguments, and how they are read from an interpreted program's result (each part of `head` holds four
/// places).
pub fn material_glsl() -> String {
    let (mut members, mut ranges, mut read) = (String::new(), Vec::new(), Vec::new());
    let mut number = 0;
    for field in Material::FIELDS {
        let parts = field.holds.parts();
        let kind = if field.holds == Holds::Vector { "vec3" } else { "float" };
        let _ = writeln!(members, "    {kind} {};    // {}", field.name, field.doc);
        let value = format!("m.{}", field.name);
        ranges.push(match field.range {
            Some(MaterialRange::Fraction) => format!("share_of({value})"),
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
         // Brings what a formula gave into its ranges; what is no number becomes 0.\n\
         float share_of(float value) {{\n    return value > 0.0 ? min(value, 1.0) : 0.0;\n}}\n\
         vec3 light_of(vec3 value) {{\n    return vec3(value.r > 0.0 ? min(value.r, 1e6) : 0.0, \
         value.g > 0.0 ? min(value.g, 1e6) : 0.0,\n                value.b > 0.0 ? min(value.b, 1e6) : 0.0);\n}}\n\
         Material within_ranges(Material m) {{\n    return Material({});\n}}\n\n\
         // The material that the interpreter's program left at these places.\n\
         #define READ_MATERIAL(head) Material({})\n",
        ranges.join(", "),
        read.join(", ")
    )
}

/// The members of a material `name` in the shaders' struct, one per number.
pub(crate) fn material_members(name: &str) -> Vec<String> {
    let members = Material::FIELDS.iter().flat_map(|field| {
        let parts: &[&str] = if field.holds == Holds::Vector { &[".r", ".g", ".b"] } else { &[""] };
        parts.iter().map(move |part| format!("{name}.{}{part}", field.name))
    });
    members.collect()
}
