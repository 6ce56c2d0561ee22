//! The block `about`: a scene's title and author, and the facts by which a show chooses scenes.

use super::fields::{Field, Holds, choices};
use crate::graph::NodeId;

// A new style needs four changes: a row here, a kind and names in `world::blend`, the blending itself (`World::blend`),
// and a kind of transition in shows (`mariana_show::TransitionKind`).
choices! {
    /// The transition from one scene to another.
    TransitionStyle {
        /// The next frame shows the new scene.
        Cut, "cut";
        /// The images are mixed in linear light.
        Fade, "fade";
        /// The worlds are mixed: surfaces flow into each other.
        Melt, "melt";
        /// The new scene appears inside a growing shape.
        Portal, "portal";
    }
}

/// The contents of a scene's block `about`.
#[derive(Debug, Clone, PartialEq)]
pub struct About {
    /// The title for people; `None` if the file's name is used.
    pub title: Option<String>,
    /// The author.
    pub author: Option<String>,
    /// The licence of the scene.
    pub license: Option<String>,
    /// The minimum and maximum energy of the music for which the scene is made, from 0 (calm) to 1 (intense).
    pub energy: (f32, f32),
    /// Words that describe the mood. Successive scenes should have few of these words in common.
    pub moods: Vec<String>,
    /// Words for what moves the scene most: `bass`, `onsets`, `level` or `tones`.
    pub follows: Vec<String>,
    /// The preferred transition to this scene.
    pub enter: Option<TransitionStyle>,
    /// The preferred transition from this scene.
    pub leave: Option<TransitionStyle>,
    /// The distance to the shape in which a portal shows the scene. The shape is seen from its front: x right, y up, z
    /// towards the eye. Halfway through, a unit of the shape is the distance from the eye to the camera's target.
    pub portal: Option<NodeId>,
}

impl Default for About {
    /// Returns the values for a scene without a block `about`. Such a scene fits all music.
    fn default() -> Self {
        Self {
            title: None,
            author: None,
            license: None,
            energy: (0.0, 1.0),
            moods: Vec::new(),
            follows: Vec::new(),
            enter: None,
            leave: None,
            portal: None,
        }
    }
}

impl About {
    /// The fields of the block.
    pub const FIELDS: &'static [Field] = &[
        Field::of("title", Holds::Text, "The title for people, in quotes."),
        Field::of("author", Holds::Text, "The author, in quotes."),
        Field::of("license", Holds::Text, "The licence of the scene, in quotes."),
        Field::of(
            "energy",
            Holds::Range,
            "The energy of the music for which the scene is made, as in `0.2 .. 0.6`, from 0 (calm) to 1 (intense).",
        ),
        Field::of("moods", Holds::Text, "Words for the scene's mood, in quotes, separated by commas."),
        Field::of(
            "follows",
            Holds::Text,
            "What moves the scene most, in quotes, separated by commas: `bass`, `onsets`, `level` or `tones`.",
        ),
        Field::of(
            "enter",
            Holds::TransitionStyle,
            "The preferred transition to this scene: `cut`, `fade`, `melt` or `portal`.",
        ),
        Field::of("leave", Holds::TransitionStyle, "The preferred transition from this scene."),
        Field::of(
            "portal",
            Holds::Shape,
            "The distance to the shape in which a `portal shape` opens this scene: `p.x` to the right, `p.y` up, \
             `p.z` towards the eye. The shape grows during the transition; halfway through, 1 is the distance from \
             the eye to the camera's target.",
        ),
    ];
}
