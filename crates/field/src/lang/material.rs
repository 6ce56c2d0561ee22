//! The material of a surface, one row for each field. Everything else about the fields is derived from the rows: the
//! block in the language with its diagnostics and documentation, the outputs of a material's tape and their order,
//! the struct in the shaders, and how each mode fills it.

use std::fmt::Write;

use crate::graph::NodeId;
use crate::lang::scene::Vec3;
use crate::limits::LIMITS;

/// How a field's values are clamped to their range before lighting; a NaN becomes 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MaterialRange {
    /// A share, 0..1.
    Share,
    /// A reflected colour: each part 0..1.
    Reflectance,
    /// Emitted light: each part at least 0, and at most what a half float holds well.
    Light,
}

/// A field of a material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MaterialField {
    /// Its name.
    pub name: &'static str,
    /// How many numbers it holds: 1, or 3 for a vector.
    pub parts: usize,
    /// The value of each number if a material does not set it.
    pub default: f32,
    /// The range of its values.
    pub range: MaterialRange,
    /// Its description for readers.
    pub doc: &'static str,
}

/// One number, or a vector of three.
trait Parts: Sized {
    const PARTS: usize;
    fn take(numbers: &mut impl Iterator<Item = NodeId>) -> Self;
    fn put(self, numbers: &mut Vec<NodeId>);
}

impl Parts for NodeId {
    const PARTS: usize = 1;

    fn take(numbers: &mut impl Iterator<Item = NodeId>) -> Self {
        numbers.next().unwrap_or_default()
    }

    fn put(self, numbers: &mut Vec<NodeId>) {
        numbers.push(self);
    }
}

impl Parts for Vec3 {
    const PARTS: usize = 3;

    fn take(numbers: &mut impl Iterator<Item = NodeId>) -> Self {
        std::array::from_fn(|_| NodeId::take(numbers))
    }

    fn put(self, numbers: &mut Vec<NodeId>) {
        numbers.extend(self);
    }
}

macro_rules! material {
    ($($field:ident: $holds:ty = $default:literal, $range:ident, $doc:literal;)+) => {
        /// The material of a surface: functions of point, normal and frame (R⁶ → R³ in Abt 2022, section 3.2).
        #[derive(Debug, Clone, PartialEq)]
        pub struct Material {
            /// Its name; `default` for the material of objects that name none.
            pub name: String,
            $(#[doc = $doc] pub $field: $holds,)+
        }

        impl Material {
            /// The fields, in the order of [`Material::numbers`].
            pub const FIELDS: &'static [MaterialField] = &[$(MaterialField {
                name: stringify!($field),
                parts: <$holds as Parts>::PARTS,
                default: $default,
                range: MaterialRange::$range,
                doc: $doc,
            },)+];

            /// Every number of the material.
            pub fn numbers(&self) -> Vec<NodeId> {
                let mut numbers = Vec::with_capacity(MATERIAL_NUMBERS);
                $(self.$field.put(&mut numbers);)+
                numbers
            }

            /// The material with these numbers, in the order of [`Material::numbers`].
            pub fn of(name: String, numbers: impl IntoIterator<Item = NodeId>) -> Self {
                let mut numbers = numbers.into_iter();
                Self { name, $($field: Parts::take(&mut numbers),)+ }
            }
        }
    };
}

material! {
    color: Vec3 = 0.8, Reflectance, "diffuse reflectance, or the metal's colour, 0..1";
    roughness: NodeId = 0.5, Share, "0 polished .. 1 matt";
    metalness: NodeId = 0.0, Share, "0 insulator .. 1 metal";
    emission: Vec3 = 0.0, Light, "light of its own";
    reflect: NodeId = 0.0, Share, "share of light that is mirrored when looked at straight on, 0..1: the ray goes on";
    coat: NodeId = 0.0, Share, "strength of a clear coat, 0..1";
    haze: NodeId = 0.0, Share, "share of it that the sky covers, 0..1: for what fades into the distance";
    blur: NodeId = 0.0, Share,
        "how rough the mirror is, 0 sharp .. 1 matt: the square root of GGX's alpha, as roughness is for lights";
}

/// How many numbers a material holds.
pub const MATERIAL_NUMBERS: usize = {
    let (mut sum, mut field) = (0, 0);
    while field < Material::FIELDS.len() {
        sum += Material::FIELDS[field].parts;
        field += 1;
    }
    sum
};

const _: () = assert!(MATERIAL_NUMBERS <= LIMITS.tape_outputs_max, "a tape gives no more numbers");

/// The fields as the shaders see them: the struct, the function that clamps its members to their ranges, the members
/// as a list of arguments, and how they are read from an interpreted program's result (each part of `head` holds four
/// places).
pub fn material_glsl() -> String {
    let (mut members, mut ranges, mut read) = (String::new(), Vec::new(), Vec::new());
    let mut number = 0;
    for field in Material::FIELDS {
        let kind = if field.parts == 3 { "vec3" } else { "float" };
        let _ = writeln!(members, "    {kind} {};    // {}", field.name, field.doc);
        let value = format!("m.{}", field.name);
        ranges.push(match field.range {
            MaterialRange::Share => format!("share_of({value})"),
            MaterialRange::Light => format!("light_of({value})"),
            MaterialRange::Reflectance => format!("min(light_of({value}), vec3(1.0))"),
        });
        let place =
            |number: usize| format!("READ(head.{}, {})", ["x", "y", "z", "w"][number / 4], number % 4);
        let places: Vec<String> = (number..number + field.parts).map(place).collect();
        number += field.parts;
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
        let parts: &[&str] = if field.parts == 3 { &[".r", ".g", ".b"] } else { &[""] };
        parts.iter().map(move |part| format!("{name}.{}{part}", field.name))
    });
    members.collect()
}
