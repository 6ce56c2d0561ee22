//! A checked scene: one graph, and which of its nodes mean what.
//!
//! **Bounds and estimates.** A shape may leave parts out: of 32 bars only two are measured. An object's `bound` says
//! how far away everything else is at least, and rays step by the lesser of the two. Penumbras and occlusion use the
//! shape alone because a bound would cast shadows of things that do not exist (Abt 2022, figure 12); beyond the bound
//! the estimate grows until it casts none.

use std::sync::Arc;

use super::about::About;
use super::builtin::uses::{DIRECTION, EYE, FRAME, NOTHING, TEXTURE};
use super::fields::DefaultValue::{Each, Library, Parts};
use super::fields::section;
use super::material::Material;
use super::origins::Origins;
use super::source::Span;
use crate::graph::{Graph, NodeId};

/// A scene without mistakes. All [`NodeId`]s are of [`Scene::graph`].
#[derive(Debug, Clone)]
pub struct Scene {
    /// The expressions.
    pub graph: Graph,
    /// At least one.
    pub objects: Vec<Object>,
    /// The union of all objects: the least of their shapes. Depends on the point and the frame.
    pub distance: NodeId,
    /// What objects are made of.
    pub materials: Vec<Material>,
    /// What the scene is lit by; at least one.
    pub lights: Vec<Light>,
    /// Where the scene is seen from.
    pub camera: Camera,
    /// Further places to see it from, with their names.
    pub cameras: Vec<(String, Camera)>,
    /// The background, where rays hit nothing.
    pub sky: Sky,
    /// Whether the text says what colour the sky has.
    pub has_own_sky: bool,
    /// How the scene's light becomes the picture.
    pub picture: Picture,
    /// What it says of itself.
    pub about: About,
    /// Sliders; `Input::Param(i)` is the i-th.
    pub params: Vec<Param>,
    /// Textures; texture i of the graph is the i-th.
    pub textures: Vec<TextureRef>,
    /// Paths of the files that were included, in the order in which they were read.
    pub includes: Vec<String>,
    /// Which parts of the text they come from; of a scene between two scenes nothing is known.
    pub origins: Arc<Origins>,
}

/// A shape with its material.
#[derive(Debug, Clone, PartialEq)]
pub struct Object {
    /// Its name; `shape` for a bare expression.
    pub name: String,
    /// Where it was declared.
    pub span: Span,
    /// Its distance function. Depends on the point and the frame.
    pub shape: NodeId,
    /// Where the shape leaves something out (of many bars it may measure only the two that are nearest in x),
    /// everything left out is at least this far away. Rays step by the lesser of bound and shape; shadows and
    /// occlusion, which need actual surfaces, use the shape alone.
    pub bound: Option<NodeId>,
    /// Index into [`Scene::materials`].
    pub material: usize,
}

/// Makes [`LightKind`] from rows: documentation, kind, the name in shaders, and the field that says where it is.
macro_rules! define_light_kinds {
    ($( $(#[$documentation:meta])* $kind:ident, $name:literal, $place:ident; )*) => {
        /// Where a light's rays come from.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum LightKind { $( $(#[$documentation])* $kind, )* }

        impl LightKind {
            /// Every kind with its name in shaders, in the order of their numbers, which begin with 1.
            pub const ALL: [(Self, &'static str); [$($name),*].len()] = [$( (Self::$kind, $name), )*];
        }

        impl Light<f32> {
            /// Where it is, or which way its rays travel if it is infinitely far away.
            pub fn place(&self) -> [f32; 3] {
                match self.kind { $( LightKind::$kind => self.$place, )* }
            }
        }
    };
}

// A new kind takes three places: its row here (and the fields of [`Light`] that it alone has), the fields that make it one in
// `lower::lights`, and its rays in `shaders/light.glsl`, which refuses to compile for a number of kinds that it does not know.
define_light_kinds! {
    /// A point or, with a radius, a ball. Its light falls with the square of the distance.
    Lamp, "LAMP", position;
    /// From infinitely far away, in one direction.
    Sun, "SUN", direction;
    /// A rectangle. It shines to the side of the cross product of its sides.
    Panel, "PANEL", position;
}

section! {
    /// A light: functions of the frame alone.
    Light {
        /// Where its rays come from.
        kind: LightKind,
    }
    position: Vector = Each(0.0), FRAME, "Where it is; the centre of a panel. Unused for a sun.";
    direction: Vector = Each(0.0), FRAME, "In which direction a sun's rays travel, of any length but 0.";
    color: Vector = Each(1.0), FRAME,
        "Its strength in red, green and blue: the light that arrives at distance 1 or, for a sun, everywhere. For a \
         panel its brightness, in the units of `emission`.";
    radius: Number = Each(0.0), FRAME,
        "Radius of the shining ball (for a sun: the tangent of its half angle); softens shadows.";
    range: Number = Each(0.0), FRAME, "Distance at which its light has faded to nothing; 0 for no limit.";
    shadow: Number = Each(1.0), FRAME, "Share of its light that shadows remove, 0..1.";
    right: Vector = Each(0.0), FRAME, "From a panel's centre to the middle of its right side; else 0.";
    up: Vector = Each(0.0), FRAME, "From a panel's centre to the middle of its upper side; else 0.";
}

section! {
    /// The camera: functions of the frame alone. Where a scene says nothing, it shows the unit ball at the origin and
    /// the ball of the thesis at (1, 1, 6).
    Camera {}
    position: Vector = Parts([0.0, 2.0, -5.0]), FRAME, "The eye.";
    target: Vector = Parts([0.0, 0.5, 0.0]), FRAME, "The point it looks at.";
    fov: Number = Each(45.0), FRAME, "Vertical field of view in degrees.";
    roll: Number = Each(0.0), FRAME,
        "Roll around the line of sight in radians; positive values turn the picture clockwise.";
    aperture: Number = Each(0.0), FRAME, "Radius of the lens; 0 is sharp everywhere.";
    focus: Number = Each(f32::INFINITY), FRAME,
        "Distance that is in focus; where it is not finite, that of the target.";
    keep: Number = Each(0.0), FRAME,
        "Width at the target that is always in the picture: in a narrow window the eye steps back to keep it there. 0 \
         asks for none.";
}

section! {
    /// The background. Where a scene says nothing, it is dusk, brightest at the horizon, so that no ray ends in black.
    Sky {}
    color: Vector = Library("default_sky"), DIRECTION | TEXTURE | FRAME | EYE, "Light from a direction.";
    ambient: Vector = Library("default_ambient"), DIRECTION | FRAME | EYE,
        "Light from everywhere on a surface with its normal in that direction.";
    reach: Number = Each(1.1), FRAME,
        "Distance from a surface within which other things block that light and give their own.";
}

section! {
    /// How the scene's light becomes the picture: functions of the frame alone. Where a scene says nothing, there is a
    /// slight glow around bright places, and grain too weak to be seen.
    Picture {}
    exposure: Number = Each(1.0), FRAME, "Factor by which light is multiplied.";
    bloom: Number = Each(0.04), FRAME, "Share of the light that is scattered around its place, 0..1.";
    vignette: Number = Each(0.0), FRAME, "Share of the light that a wide lens loses in the corners, 0..1.";
    grain: Number = Each(1.0), FRAME, "Strength of the grain, in steps of 1/255.";
    tone_map: ToneMap = Each(ToneMap::Agx.number()), NOTHING,
        "How light becomes a colour of the screen: the number of a [`ToneMap`].";
}

/// How light becomes a colour of the screen.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum ToneMap {
    /// AgX (Troy Sobotka): a film's curve, in which bright colours fade to white.
    #[default]
    Agx,
    /// ACES, fitted (Stephen Hill): more contrast, colours turn as they get brighter.
    Aces,
    /// Extended Reinhard on luminance (Abt 2022, section 3.2): colours stay the same until they are clipped.
    Reinhard,
    /// None: light of 0..1 unchanged, brighter light clipped to 1.
    None,
}

impl ToneMap {
    /// All of them, in the order of their numbers in `shaders/tone_map.glsl`.
    pub const ALL: [ToneMap; 4] = [ToneMap::Agx, ToneMap::Aces, ToneMap::Reinhard, ToneMap::None];

    /// Its number among the numbers of a scene.
    pub const fn number(self) -> f32 {
        self as u8 as f32
    }

    /// The tone map of a number; the default where there is none.
    pub fn numbered(number: f32) -> Self {
        Self::ALL.into_iter().find(|map| map.number() == number).unwrap_or_default()
    }

    /// Its name in scenes.
    pub const fn name(self) -> &'static str {
        match self {
            ToneMap::Agx => "agx",
            ToneMap::Aces => "aces",
            ToneMap::Reinhard => "reinhard",
            ToneMap::None => "none",
        }
    }
}

/// A number that the user sets.
#[derive(Debug, Clone, PartialEq)]
pub struct Param {
    /// Its name.
    pub name: String,
    /// Its value at the start; `min <= default <= max`, all finite.
    pub default: f32,
    /// Least value.
    pub min: f32,
    /// Largest value.
    pub max: f32,
    /// Whether it is a number of the text that is being changed. Such a parameter has no name and comes behind all
    /// others; it has one value, or a range while it is being turned.
    pub is_number: bool,
    /// Where it was declared; of a number of the text, where it begins.
    pub span: Span,
}

/// A texture that a scene reads.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TextureRef {
    /// Its path below the scene's folder, with `/` between folders; never leads out of it.
    pub name: String,
    /// Where it was first named.
    pub span: Span,
}
