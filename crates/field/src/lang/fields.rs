//! The fields of a scene's sections, one row for each.
//!
//! `section!` defines a section from its rows: the documented struct, the block in the language with its diagnostics,
//! the default values, and the order of the section's numbers on a tape. Other code reads the values from the struct.

use std::fmt;

use super::builtin::uses;
use crate::limits::FEEDBACK_DECAY_MAX;

/// A field of a section.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Field {
    /// The name in the language.
    pub name: &'static str,
    /// The type of the value.
    pub holds: Holds,
    /// The value if a scene does not set it.
    pub default: DefaultValue,
    /// The inputs that the value may use.
    pub(super) uses: u16,
    /// The range to which the values are clamped; `None` if every value has a meaning.
    pub range: Option<FieldRange>,
    /// The description on the language's page.
    pub doc: &'static str,
}

/// The type of a field's value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Holds {
    /// One number.
    Number,
    /// Three numbers.
    Vector,
    /// A place in the picture, two numbers.
    Place,
    /// The name of a tone map, kept as its number.
    ToneMap,
    /// The name of a material.
    Material,
    /// A text in quotes.
    Text,
    /// A range of two numbers, such as `0.2 .. 0.6`.
    Range,
    /// The name of a transition between scenes, a [`TransitionStyle`](super::TransitionStyle).
    TransitionStyle,
    /// The distance to a shape, a number at each point.
    Shape,
}

impl Field {
    /// Returns a field without a range, whose default is unused. A shape uses the point and the frame, a number the
    /// frame, and all else nothing.
    pub(super) const fn of(name: &'static str, holds: Holds, doc: &'static str) -> Self {
        let uses = match holds {
            Holds::Shape => uses::POINT | uses::FRAME,
            Holds::Number => uses::FRAME,
            _ => uses::NOTHING,
        };
        Self { name, holds, uses, default: DefaultValue::Each(0.0), range: None, doc }
    }

    /// True if the field's three numbers are the colour of light or of a surface.
    pub fn is_color(&self) -> bool {
        self.holds == Holds::Vector
            && matches!(self.name, "color" | "ambient" | "emission" | "glow" | "absorb")
    }
}

impl Holds {
    /// Returns the count of numbers in a value.
    pub const fn parts(self) -> usize {
        match self {
            Holds::Vector => 3,
            Holds::Range | Holds::Place => 2,
            _ => 1,
        }
    }
}

/// The Rust types of the fields' values. `N` is the type of a number: a node in a scene, an f32 in a frame.
pub(super) mod of {
    pub(crate) type Number<N> = N;
    pub(crate) type Vector<N> = [N; 3];
    pub(crate) type Place<N> = [N; 2];
    pub(crate) type ToneMap<N> = N;
    pub(crate) type Shape<N> = N;
}

/// The value of a field that a scene does not set.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DefaultValue {
    /// This number; for a vector, in all three components.
    Each(f32),
    /// This vector.
    Parts([f32; 3]),
    /// The result of this library function for the ray's direction.
    Library(&'static str),
}

impl fmt::Display for DefaultValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Each(number) => write!(f, "{number}"),
            Self::Parts([x, y, z]) => write!(f, "vec3({x}, {y}, {z})"),
            Self::Library(name) => write!(f, "{name}(direction)"),
        }
    }
}

/// A range to which the values of fields are clamped.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FieldRange {
    /// The least value.
    pub least: f32,
    /// The largest value; infinite for none.
    pub most: f32,
}

impl FieldRange {
    pub(super) const FRACTION: Self = Self::of(0.0, 1.0);
    /// Light, or a length in a material.
    pub(super) const LIGHT: Self = Self::of(0.0, 1e6);
    pub(super) const FROM_0: Self = Self::of(0.0, f32::INFINITY);
    /// A refractive index.
    pub(super) const INDEX: Self = Self::of(0.3, 4.0);
    /// A direction of scattering. At 1 all light would go straight on.
    pub(super) const PHASE: Self = Self::of(-0.95, 0.95);
    /// A vertical field of view, in degrees.
    pub(super) const FOV: Self = Self::of(1.0, 170.0);
    /// The radius of a lens.
    pub(super) const LENS: Self = Self::of(0.0, 1e6);
    pub(super) const EXPOSURE: Self = Self::of(0.0, 1000.0);
    /// Grain, in steps of 1/255.
    pub(super) const GRAIN: Self = Self::of(0.0, 16.0);
    pub(super) const DECAY: Self = Self::of(0.0, FEEDBACK_DECAY_MAX);
    /// The blur of trails in a frame, in heights of the picture: nine taps are not enough for more.
    pub(super) const BLUR: Self = Self::of(0.0, 0.02);

    const fn of(least: f32, most: f32) -> Self {
        Self { least, most }
    }

    /// Returns the value in the range that is nearest to `value`; a NaN stays.
    pub fn clamp(self, value: f32) -> f32 {
        value.clamp(self.least, self.most)
    }
}

impl fmt::Display for FieldRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.most.is_finite() {
            true => write!(f, "from {} to {}", self.least, self.most),
            false => write!(f, "of at least {}", self.least),
        }
    }
}

pub(super) trait Parts<N> {
    fn from_numbers(numbers: &mut impl Iterator<Item = N>) -> Self;
    fn put(self, numbers: &mut Vec<N>);
    fn map(self, new: impl FnMut(N) -> N) -> Self;
}

impl<N: Default> Parts<N> for N {
    fn from_numbers(numbers: &mut impl Iterator<Item = N>) -> Self {
        numbers.next().unwrap_or_default()
    }

    fn put(self, numbers: &mut Vec<N>) {
        numbers.push(self);
    }

    fn map(self, mut new: impl FnMut(N) -> N) -> Self {
        new(self)
    }
}

impl<N: Default, const COUNT: usize> Parts<N> for [N; COUNT] {
    fn from_numbers(numbers: &mut impl Iterator<Item = N>) -> Self {
        std::array::from_fn(|_| N::from_numbers(numbers))
    }

    fn put(self, numbers: &mut Vec<N>) {
        numbers.extend(self);
    }

    fn map(self, new: impl FnMut(N) -> N) -> Self {
        self.map(new)
    }
}

/// Defines a section. The braces contain the members of its struct that are not fields. A row is `name: type = default,
/// allowed inputs, range if values are clamped, "description";`.
macro_rules! section {
    (
        $(#[$about:meta])*
        $section:ident { $($(#[$reported:meta])* $own:ident: $type:ty,)* }
        $($field:ident: $holds:ident = $default:expr, $uses:expr, $($range:ident,)? $doc:literal;)+
    ) => {
        $(#[$about])*
        #[derive(Debug, Clone, PartialEq)]
        pub struct $section<N = $crate::graph::NodeId> {
            $($(#[$reported])* pub $own: $type,)*
            $(#[doc = $doc] pub $field: $crate::lang::fields::of::$holds<N>,)+
        }

        impl $section {
            /// The fields, in the order of [`Self::numbers`].
            pub const FIELDS: &'static [$crate::lang::fields::Field] = &[$($crate::lang::fields::Field {
                name: stringify!($field),
                holds: $crate::lang::fields::Holds::$holds,
                default: $default,
                uses: $uses,
                range: $crate::lang::fields::section!(@range $($range)?),
                doc: $doc,
            },)+];
            /// The count of numbers in all fields.
            pub const NUMBERS: usize = 0 $(+ $crate::lang::fields::Holds::$holds.parts())+;
        }

        impl<N: Copy + Default> $section<N> {
            /// Returns the numbers of all fields, each vector as three numbers.
            pub fn numbers(&self) -> Vec<N> {
                let mut numbers = Vec::new();
                $($crate::lang::fields::Parts::put(self.$field, &mut numbers);)+
                numbers
            }

            /// Builds the section from its numbers, in the order of [`Self::numbers`]. Missing numbers are 0.
            pub fn of($($own: $type,)* numbers: impl IntoIterator<Item = N>) -> Self {
                let mut numbers = numbers.into_iter();
                Self { $($own,)* $($field: $crate::lang::fields::Parts::from_numbers(&mut numbers),)+ }
            }

            /// Returns the section with every number of a field that has a range clamped to it by `clamp`.
            #[allow(dead_code, unused_mut, unused_variables, reason = "some sections have no ranges")]
            pub fn in_ranges(self, mut clamp: impl FnMut(N, $crate::lang::fields::FieldRange) -> N) -> Self {
                Self {
                    $($own: self.$own,)*
                    $($field: $crate::lang::fields::section!(@clamped self.$field, clamp $(, $range)?),)+
                }
            }
        }
    };
    (@range) => { None };
    (@range $range:ident) => { Some($crate::lang::fields::FieldRange::$range) };
    (@clamped $value:expr, $clamp:ident) => { $value };
    (@clamped $value:expr, $clamp:ident, $range:ident) => {
        $crate::lang::fields::Parts::map($value, |number| {
            $clamp(number, $crate::lang::fields::FieldRange::$range)
        })
    };
}

pub(super) use section;

/// Defines the choices of a field, each with its name in scenes.
macro_rules! choices {
    ($(#[$about:meta])* $choice:ident { $($(#[$documentation:meta])* $one:ident, $name:literal;)+ }) => {
        $(#[$about])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        pub enum $choice { $($(#[$documentation])* $one,)+ }

        impl $choice {
            /// All choices, in the order of their numbers.
            pub const ALL: [Self; [$($name),+].len()] = [$(Self::$one,)+];

            /// Returns the name in scenes and shows.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$one => $name,)+ }
            }

            /// Returns the number that represents the choice in a section.
            pub const fn number(self) -> f32 {
                self as u8 as f32
            }

            /// Returns the choice with this name.
            pub fn named(name: &str) -> Option<Self> {
                Self::ALL.into_iter().find(|one| one.name() == name)
            }

            /// Returns the choice with this number.
            pub fn numbered(number: f32) -> Option<Self> {
                Self::ALL.into_iter().find(|one| one.number() == number)
            }
        }
    };
}

pub(super) use choices;
