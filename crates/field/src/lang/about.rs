//! What a scene says of itself: who made it, and what a show that chooses scenes should know.

use super::builtin::uses::{FRAME, NOTHING, POINT};
use super::fields::{DefaultValue, Field, Holds};
use crate::graph::NodeId;

/// Makes [`Way`] from rows: documentation, way, and its name in scenes and shows.
macro_rules! define_ways {
    ($( $(#[$documentation:meta])* $way:ident, $name:literal; )*) => {
        /// How one scene gives way to another.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        pub enum Way { $( $(#[$documentation])* $way, )* }

        impl Way {
            /// All of them, in the order of their numbers.
            pub const ALL: [Self; [$($name),*].len()] = [$( Self::$way, )*];

            /// Its name in scenes and shows.
            pub const fn name(self) -> &'static str {
                match self { $( Self::$way => $name, )* }
            }
        }
    };
}

// A new way of mixing worlds takes four places: its row here, its kind and names in `world::blend`, the mixing itself
// (`World::blend`), and its kind of transition in shows (`mariana_show::TransitionKind`).
define_ways! {
    /// From one picture to the next.
    Cut, "cut";
    /// The pictures are mixed in linear light.
    Fade, "fade";
    /// The worlds are mixed: surfaces flow into each other.
    Melt, "melt";
    /// The other world appears inside a growing shape.
    Portal, "portal";
}

impl Way {
    /// The way of this name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|way| way.name() == name)
    }

    /// The way of a number; none where there is none.
    pub(super) fn numbered(number: f32) -> Option<Self> {
        Self::ALL.into_iter().find(|way| f32::from(*way as u8) == number)
    }
}

/// What a scene says of itself in its block `about`.
#[derive(Debug, Clone, PartialEq)]
pub struct About {
    /// The name for people; none where it is that of the file.
    pub title: Option<String>,
    /// Who made it.
    pub author: Option<String>,
    /// Under which licence it may be used.
    pub license: Option<String>,
    /// For how much energy of the music it is made, least and most, 0..1; the energy of a song's loudest moments is 1.
    pub energy: (f32, f32),
    /// Words for what it feels like. Scenes that follow each other should share few.
    pub moods: Vec<String>,
    /// How it likes to come.
    pub enter: Option<Way>,
    /// How it likes to go.
    pub leave: Option<Way>,
    /// The distance to the shape in which it may appear, as seen from its front: x to the right, y up, z towards the
    /// eye. At the middle of the transition 1 is as long as the way from the eye to the camera's target.
    pub portal: Option<NodeId>,
}

impl Default for About {
    /// A scene that says nothing fits all music.
    fn default() -> Self {
        Self {
            title: None,
            author: None,
            license: None,
            energy: (0.0, 1.0),
            moods: Vec::new(),
            enter: None,
            leave: None,
            portal: None,
        }
    }
}

impl About {
    /// The fields of the block.
    pub const FIELDS: &'static [Field] = &[
        of_about("title", Holds::Text, "Its name for people, in quotes."),
        of_about("author", Holds::Text, "Who made it, in quotes."),
        of_about("license", Holds::Text, "The licence under which it may be used, in quotes."),
        of_about(
            "energy",
            Holds::Range,
            "For how much energy of the music it is made, `0.2 .. 0.6`; 1 is a song's loudest.",
        ),
        of_about("moods", Holds::Text, "Words for what it feels like, in quotes, with commas between them."),
        of_about("enter", Holds::Way, "How it likes to come: `cut`, `fade`, `melt` or `portal`."),
        of_about("leave", Holds::Way, "How it likes to go."),
        Field {
            uses: POINT | FRAME,
            ..of_about(
                "portal",
                Holds::Shape,
                "The distance to the shape in which it comes through a `portal shape`: `p.x` to the right, `p.y` up, `p.z` \
                 towards the eye; it grows from nothing, and at the middle 1 is as far as the camera's target.",
            )
        },
    ];
}

const fn of_about(name: &'static str, holds: Holds, doc: &'static str) -> Field {
    Field { name, holds, uses: NOTHING, default: DefaultValue::Each(0.0), range: None, doc }
}
